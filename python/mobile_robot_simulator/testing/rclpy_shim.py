"""A replacement for rclpy: imports of rclpy and of message packages give the nodes and messages of the in-process bus.

A file with `from rclpy.node import Node` and `from geometry_msgs.msg import Twist` runs on the bus unchanged, whether ROS is
installed or not:

    with stand_in():
        from follower import Follower
    simulation.spawn(Follower)

The module `rclpy_modules` defines which names are available. `Simulation` runs the nodes, so `rclpy.spin` and executors
raise an error.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from types import ModuleType

from .rclpy_modules import module_contents


@contextmanager
def stand_in() -> Iterator[None]:
    """Replaces rclpy and the message packages in a `with` block.

    In the block, imports of these packages give the classes of the in-process bus. After the block, the modules that were
    imported before it are available again.
    """
    modules = _modules(module_contents())
    packages = {name for name in modules if "." not in name}
    before = {name: sys.modules.pop(name) for name in _imported(packages)}
    sys.modules.update(modules)
    try:
        yield
    finally:
        for name in _imported(packages):
            del sys.modules[name]
        sys.modules.update(before)


def _imported(packages: set[str]) -> list[str]:
    """Returns the names of the imported modules that belong to the given packages."""
    return [name for name in sys.modules if name.split(".")[0] in packages]


def _modules(contents: Mapping[str, Mapping[str, object]]) -> dict[str, ModuleType]:
    """Returns a module for each name in `contents`, and a package for each of their parents, by name."""
    modules: dict[str, ModuleType] = {}
    for name in sorted(contents):
        package, _, submodule = name.partition(".")
        for missing in {package, name} - modules.keys():
            modules[missing] = ModuleType(missing)
        modules[package].__path__ = []
        vars(modules[name]).update(contents[name])
        if submodule:
            setattr(modules[package], submodule, modules[name])
    return modules
