"""Robots: the robots of a simulation, each with its nodes, its ground truth and its namespace."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from .._core import OccupancyGrid, Pose, Shape
from ..bus.bus import Bus
from ..bus.node import BusNode, NoCopyNode
from ..handle import Handle, Handles
from ..namespaces import of_namespace
from ..nodes.laser import LaserScannerSimulator, LaserSnapshot
from ..nodes.robot import MobileRobotSimulator, RobotSnapshot
from ..nodes.scan_batch import ScanBatch
from ..nodes.transforms import TransformBuffer, TransformListener
from ..parameters import LaserParameters, RobotParameters, for_node
from ..physics.obstacles import PoseLike
from ..physics.world import World
from ..quoting import quoted
from ..scanners import check_robot_names, of_scanner, scanner_names, split
from .arguments import to_pose
from .ground_truth import GroundTruth


@dataclass(frozen=True, repr=False)
class SimulatedRobot(Handle):
    """A robot of a simulation.

    Attributes:
        name: Name of the robot and of its namespace. Empty if the simulation has one robot without a name.
        robot: The node that moves it.
        scanners: The nodes of its laser scanners by name. One scanner without a name has the key ''.
        truth: Its true pose, velocity, path and contacts.
    """

    name: str
    robot: MobileRobotSimulator
    scanners: Mapping[str, LaserScannerSimulator]
    truth: GroundTruth

    @property
    def laser(self) -> LaserScannerSimulator:
        """The node of its first laser scanner."""
        return next(iter(self.scanners.values()))

    def __repr__(self) -> str:
        return f"SimulatedRobot({self.title} {self.place})"

    @property
    def pose(self) -> Pose:
        """Current true pose in the map frame."""
        return self.robot.pose

    @property
    def title(self) -> str:
        """The robot's name in log and error messages: `robot <name>`, or `the robot` if it has no name."""
        return f"robot {self.name}" if self.name else "the robot"

    @property
    def place(self) -> str:
        """Current pose as a text: `at (x, y, yaw)`."""
        x, y, yaw = self.pose
        return f"at ({x:.2f}, {y:.2f}, {yaw:.2f})"

    @property
    def status(self) -> str:
        """Current pose and velocity as a text."""
        vx, vy, wz = self.truth.velocity
        velocity = f"moving at ({vx:.2f} m/s, {vy:.2f} m/s, {wz:.2f} rad/s)" if any((vx, vy, wz)) else "at rest"
        return f"{self.title} {self.place}, {velocity}"


@dataclass(frozen=True)
class SimulatedRobotSnapshot:
    """Saved state of a robot.

    Attributes:
        robot: The robot itself.
        node: State of the node that moves it.
        lasers: States of its laser scanners.
    """

    robot: SimulatedRobot
    node: RobotSnapshot
    lasers: tuple[LaserSnapshot, ...]


@dataclass(frozen=True)
class RobotsSnapshot:
    """Saved state of all robots.

    Attributes:
        robots: The robots, in the order in which they were added.
        listener: Subscriptions of the transform listener that they share, None while it is stopped.
    """

    robots: tuple[SimulatedRobotSnapshot, ...]
    listener: Handles | None


def _check_name(name: object) -> None:
    """Checks that a robot's name is valid in the names of its topics."""
    needed = "a robot's name must consist of letters, digits and _, and not begin with a digit"
    if not isinstance(name, str):
        raise TypeError(f"{needed}, got {quoted(name)}")
    if not re.fullmatch(r"[A-Za-z_]\w*(/[A-Za-z_]\w*)*", name, re.ASCII):
        raise ValueError(f"{needed}, got {quoted(name)}")


class Robots(Handle):
    """The robots of one simulation, by name and in the order in which they were added.

    Args:
        bus: The bus on which the robots' nodes run.
        world: The world in which the robots move.
        grid: The map.
        values: Parameters that all robots share, by name.
        node: The node that listens to transforms.
    """

    def __init__(self, bus: Bus, world: World, grid: OccupancyGrid, values: Mapping[str, Any], node: BusNode) -> None:
        self._bus, self._world, self._grid, self._values = bus, world, grid, values
        self._listener = TransformListener(node, TransformBuffer())
        self._batch = ScanBatch(lambda: bus.time_ns, self._scanners_due)
        self._robots: dict[str, SimulatedRobot] = {}

    def __len__(self) -> int:
        return len(self._robots)

    def __iter__(self) -> Iterator[SimulatedRobot]:
        return iter(self._robots.values())

    @property
    def by_name(self) -> dict[str, SimulatedRobot]:
        """The robots by name, in a new dict."""
        return dict(self._robots)

    @property
    def first(self) -> SimulatedRobot:
        """The robot that was added first.

        Raises:
            ValueError: There is no robot.
        """
        if not self._robots:
            raise ValueError("the simulation has no robot yet: add one with add_robot")
        return next(iter(self._robots.values()))

    def named(self, name: str | None) -> SimulatedRobot:
        """Returns the robot with this name, or the first robot if the name is None.

        Raises:
            ValueError: There is no such robot.
        """
        if name is None:
            return self.first
        if name not in self._robots:
            known = f"there are {', '.join(self._robots)}" if self._robots else "there are none"
            raise ValueError(
                f"unknown robot {quoted(name)}; {'the only robot has no name' if '' in self._robots else known}"
            )
        return self._robots[name]

    def add(self, name: str, start: PoseLike | None, parameters: Mapping[str, Any]) -> SimulatedRobot:
        """Adds a robot and starts its nodes, as described for `Simulation.add_robot`."""
        if name != "":
            _check_name(name)
        if name in self._robots or (self._robots and not name) or "" in self._robots:
            raise ValueError(
                "each robot must have a name, different from all others, "
                f"got {quoted(name)} beside {quoted(sorted(self._robots))}"
            )
        values = self._values_of(parameters)
        values = of_namespace(name, values)
        robot_parameters = for_node(RobotParameters, values)
        scanners = {scanner: for_node(LaserParameters, of_scanner(scanner, values)) for scanner in scanner_names(values)}
        if any(split(key)[1].rpartition(":")[2] == "unknown" for key in values):
            self._check_unknown(robot_parameters, *scanners.values())
        pose = to_pose(robot_parameters.initial_pose if start is None else start, "start")
        self._check_place("start", pose, robot_parameters.shape)
        robot = MobileRobotSimulator(
            NoCopyNode(self._bus, robot_parameters.node_name, namespace=f"/{name}"),
            robot_parameters,
            start_pose=None if start is None else pose,
            world=self._world,
            name=name,
        )
        with Handles() as undo:
            undo.add(self._world.leave, robot)
            lasers = {
                scanner: LaserScannerSimulator(
                    NoCopyNode(self._bus, parameters.node_name, namespace=f"/{name}"),
                    parameters,
                    grid=self._grid,
                    carrier=robot,
                    listener=self._listener,
                    batch=self._batch,
                )
                for scanner, parameters in scanners.items()
            }
            added = SimulatedRobot(name, robot, lasers, GroundTruth(self._world, robot))
            robot.start()
            undo.add(robot.stop)
            for laser in lasers.values():
                laser.start()
                undo.add(laser.stop)
        self._robots[name] = added
        self._batch.scanner_count += len(lasers)
        return added

    def set_pose(self, pose: PoseLike, name: str | None) -> None:
        """Moves a robot to another pose, as described for `Simulation.set_pose`."""
        place, robot = to_pose(pose, "the pose"), self.named(name).robot
        self._check_place("the pose", place, robot.footprint, robot)
        robot.set_pose(place)

    def reset(self) -> None:
        """Moves all robots back to their start poses and stops them."""
        for robot in self:
            robot.robot.reset()

    def save(self) -> RobotsSnapshot:
        """Returns the state that `restore` takes."""
        robots = (
            SimulatedRobotSnapshot(robot, robot.robot.save(), tuple(laser.save() for laser in robot.scanners.values()))
            for robot in self
        )
        return RobotsSnapshot(tuple(robots), self._listener.save())

    def restore(self, state: RobotsSnapshot) -> None:
        """Puts the robots back into a saved state. Robots added later are removed."""
        self._batch.forget()
        self._batch.scanner_count = sum(len(each.lasers) for each in state.robots)
        self._robots = {each.robot.name: each.robot for each in state.robots}
        for each in state.robots:
            each.robot.robot.restore(each.node)
            for laser, saved in zip(each.robot.scanners.values(), each.lasers, strict=True):
                laser.restore(saved)
        self._listener.restore(state.listener)

    def _scanners_due(self) -> list[LaserScannerSimulator]:
        """Returns the scanners whose turn comes later at this time, if to look at them changes nothing."""
        if not self._world.has_looked:
            return []
        owners = (getattr(timer.callback, "__self__", None) for timer in self._bus.due_timers)
        return [owner for owner in owners if isinstance(owner, LaserScannerSimulator)]

    def _values_of(self, parameters: Mapping[str, Any]) -> dict[str, Any]:
        """Returns the parameters of a new robot. Only the first robot publishes the clock."""
        values = {**self._values, **parameters}
        check_robot_names(values)
        if self._robots:
            values["publish_clock"] = False
        return values

    def _check_unknown(self, *parameters: RobotParameters | LaserParameters) -> None:
        """Raises ValueError unless both nodes of a robot treat unknown cells as the map does, which all robots share."""
        for each in parameters:
            if each.unknown != self._grid.unknown:
                raise ValueError(
                    f"unknown must be {self._grid.unknown!r}, as for all nodes that share the map of the simulation, "
                    f"got {each.unknown!r} for {each.node_name}"
                )

    def _check_place(self, what: str, pose: Pose, shape: Shape | None, robot: MobileRobotSimulator | None = None) -> None:
        """Raises ValueError if a robot cannot stand at a pose. Warns if the pose is off the map."""
        self._world.check_place(what, pose, shape, robot)
        if self._grid.cell_at(pose.x, pose.y) is None:
            message = f"{what} ({pose.x:g}, {pose.y:g}) is off the map, where there is nothing to touch and nothing to see"
            warnings.warn(message, stacklevel=4)
