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
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from types import ModuleType

from ..quoting import nearest
from .rclpy_modules import module_contents
from .ros_messages import register_definitions


@contextmanager
def stand_in(definitions: Mapping[str, str] | None = None) -> Iterator[None]:
    r"""Replaces rclpy and the message packages in a `with` block.

    In the block, imports of these packages give the classes of the in-process bus. After the block, the modules that were
    imported before it are available again.

    Args:
        definitions: Messages, services and actions of your own: texts of `.msg`, `.srv` and `.action` files by ROS type,
            such as `{"my_msgs/msg/Speeds": "float64 left\nfloat64 right"}`. They need rosbags.

    Raises:
        ImportError: There are definitions, but rosbags is not installed.
        ValueError: A definition is wrong, or its type already has another definition.
    """
    register_definitions(definitions or {})
    modules = _modules(module_contents())
    packages = {name for name in modules if "." not in name}
    before = {name: sys.modules.pop(name) for name in _imported(packages)}
    sys.modules.update(modules)
    finder = _Refusal(packages, sorted(modules))
    sys.meta_path.insert(0, finder)
    try:
        yield
    finally:
        sys.meta_path.remove(finder)
        for name in _imported(packages):
            del sys.modules[name]
        sys.modules.update(before)


class _Refusal:
    """Import finder that says which modules of a replaced package there are, when another one is imported."""

    def __init__(self, packages: set[str], modules: list[str]) -> None:
        self._packages, self._modules = packages, modules

    def find_spec(self, name: str, path: object = None, target: object = None) -> None:
        package = name.partition(".")[0]
        if package in self._packages:
            there = ", ".join(other for other in self._modules if other.startswith(f"{package}."))
            raise ModuleNotFoundError(f"the stand-in has no module {name}; there are {there}", name=name)


def _refuse_names(module: ModuleType) -> Callable[[str], object]:
    """Returns a `__getattr__` for a module: it says which names there are, when another one is imported."""

    def refuse(name: str) -> object:
        if name.startswith("__"):
            raise AttributeError(name)
        there = sorted(other for other in vars(module) if not other.startswith("_"))
        near = nearest(name, there, 3)
        shown = f"did you mean {' or '.join(near)}?" if near else f"there are {', '.join(there)}"
        raise ImportError(f"the stand-in's {module.__name__} has no {name}; {shown}", name=module.__name__)

    return refuse


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
        vars(modules[name]).update(contents[name], __getattr__=_refuse_names(modules[name]))
        if submodule:
            setattr(modules[package], submodule, modules[name])
    return modules
