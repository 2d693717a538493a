"""NodeParameters: the parameters of a simulation's nodes by name, as on ROS."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from ..nodes.laser import LaserScannerSimulator
from ..nodes.robot import MobileRobotSimulator
from ..quoting import nearest, quoted

if TYPE_CHECKING:
    from ..parameters import Parameters
    from ..simulation.simulation import Simulation

LARGEST_INTEGER = 2**63
"""Integers from here on are sent as texts, because clients have 64 bits with a sign."""


class NodeParameters:
    """Parameters of all robots and scanners of a simulation.

    A name is that of the node and that of the parameter, with a dot between them, such as
    `/mobile_robot_simulator_node.velocity_timeout`. The node of a scanner with a name has it in front, as on ROS:
    `/robot1/front_laser_scanner_simulator_node.beam_count`.

    Args:
        simulation: The simulation.
    """

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._seen: dict[str, Parameters] = {}

    def values(self, names: Iterable[str] = ()) -> dict[str, Any]:
        """Returns values by name, of all parameters if no names are given. Unknown names are left out."""
        found = {
            f"{node}.{name}": _value_of(value)
            for node, behaviour in self._nodes().items()
            for name, value in behaviour.parameters
        }
        return {name: found[name] for name in names if name in found} if (names := list(names)) else found

    def set(self, name: str, value: Any) -> None:
        """Changes a parameter.

        Raises:
            ValueError: There is no such parameter, or the node refuses the value. The message says why. Nothing changes.
            TypeError: As ValueError.
        """
        node, _, own = name.rpartition(".")
        nodes = self._nodes()
        if node not in nodes or own not in type(nodes[node].parameters).model_fields:
            near = nearest(name, list(self.values()))
            raise ValueError(f"unknown parameter {quoted(name)}" + (f"; did you mean {near[0]}?" if near else ""))
        nodes[node].set_parameters(**{own: value})

    def changed(self) -> dict[str, Any]:
        """Returns the values that have changed since the last call, by name. At the first call, there are none."""
        nodes, changed = self._nodes(), dict[str, Any]()
        for node, behaviour in nodes.items():
            before, now = self._seen.get(node), behaviour.parameters
            if before is not None and before is not now:
                changed |= {f"{node}.{name}": _value_of(value) for name, value in now if value != getattr(before, name)}
        self._seen = {node: behaviour.parameters for node, behaviour in nodes.items()}
        return changed

    def _nodes(self) -> dict[str, MobileRobotSimulator | LaserScannerSimulator]:
        nodes: dict[str, MobileRobotSimulator | LaserScannerSimulator] = {}
        for robot in self._simulation.robots.values():
            namespace = f"/{robot.name}".rstrip("/")
            nodes[f"{namespace}/{robot.robot.parameters.node_name}"] = robot.robot
            for name, laser in robot.scanners.items():
                prefix = f"{name}_" if name else ""
                nodes[f"{namespace}/{prefix}{laser.parameters.node_name}"] = laser
        return nodes


def _value_of(value: Any) -> Any:
    """Returns a value of the kinds that clients know. JSON has no infinite numbers, so they are texts."""
    if isinstance(value, (tuple, list)):
        return [_value_of(each) for each in value]
    if isinstance(value, float) and not math.isfinite(value):
        return f"{value}"
    if isinstance(value, int) and not isinstance(value, bool) and abs(value) >= LARGEST_INTEGER:
        return f"{value}"
    return value
