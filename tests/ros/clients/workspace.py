"""Programs of other ROS packages: where they are installed, and the environment that they need."""

from __future__ import annotations

import os
from pathlib import Path

import pytest


def find_program(package: str, program: str) -> str:
    """Returns the path of a program. Skips the test if `ROS_PACKAGE_PATH` and `CMAKE_PREFIX_PATH` do not lead to it."""
    import rospkg
    from roslib.packages import find_node

    try:
        found = find_node(package, program)
    except rospkg.ResourceNotFound:
        found = []
    if not found:
        pytest.skip(f"no {package}/{program} on ROS_PACKAGE_PATH; source the workspace or the distribution that has it")
    return str(found[0])


def client_environment(environment: dict[str, str]) -> dict[str, str]:
    """Returns the environment with the libraries and Python modules of each workspace on `CMAKE_PREFIX_PATH`.

    `make test-ros` clears the variables that hold these, because they would also change the nodes under test.
    """
    prefixes = [Path(prefix) for prefix in environment.get("CMAKE_PREFIX_PATH", "").split(os.pathsep) if prefix]

    def extend(variable: str, folder: str) -> str:
        paths = [str(prefix / folder) for prefix in prefixes if (prefix / folder).is_dir()]
        return os.pathsep.join([*paths, *filter(None, [environment.get(variable)])])

    return {
        **environment,
        "LD_LIBRARY_PATH": extend("LD_LIBRARY_PATH", "lib"),
        "PYTHONPATH": extend("PYTHONPATH", "lib/python3/dist-packages"),
    }
