"""The commands `ros1` and `ros2`: nodes on the real ROS."""

from __future__ import annotations

import os
import sys
from enum import Enum
from functools import partial
from typing import Annotated, NoReturn

import typer

from .options import FaultTexts, read_faults


class RosNode(str, Enum):
    """Nodes that run on ROS."""

    robot = "robot"
    laser = "laser"
    map = "map"
    all = "all"


NodeName = Annotated[RosNode, typer.Argument(metavar="NODE", help="robot, laser, map, or all: the three in one process.")]


def ros1(context: typer.Context, node: NodeName, fault: FaultTexts = None) -> None:
    """Run a node on ROS 1. Arguments: NODE [MAP.yaml] [_NAME:=VALUE] [FROM:=TO]."""
    from ..ros.ros1 import run

    run(node.value, context.args, partial(read_faults, fault))
    _exit_at_once()


def ros2(context: typer.Context, node: NodeName, fault: FaultTexts = None) -> None:
    """Run a node on ROS 2. Arguments: NODE [MAP.yaml] [--ros-args -p NAME:=VALUE -r FROM:=TO --params-file FILE]."""
    from ..ros.ros2 import run

    run(node.value, context.args, partial(read_faults, fault))
    _exit_at_once()


def _exit_at_once() -> NoReturn:
    """Ends the process without the interpreter's cleanup, which can take seconds. The node is shut down already."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0)
