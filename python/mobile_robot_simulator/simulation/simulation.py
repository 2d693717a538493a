"""Simulation: a map, robots and the bus in one object, to be run, looked into, saved and put back."""

from __future__ import annotations

import copy
import difflib
import math
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from .._core import OccupancyGrid, Pose, Shape, touches
from ..bus.bus import Bus, Tap
from ..bus.node import BusNode, NoCopyNode, spawn_context
from ..bus.topic import BusSubscription, absolute
from ..handle import Handle
from ..instant import NANOSECONDS
from ..messages import LaserScan, Message, TFMessage
from ..nodes.interface import M, QoS
from ..nodes.laser import LaserScannerSimulator
from ..nodes.map_messages import with_unknown
from ..nodes.map_server import MapServer
from ..nodes.robot import MobileRobotSimulator
from ..nodes.transforms import TransformBuffer, TransformListener
from ..parameters import LaserParameters, RobotParameters, check_names, for_node
from ..physics.obstacles import Obstacle, PoseLike, Trajectory
from ..physics.world import World
from .fault import Fault
from .ground_truth import GroundTruth
from .namespaces import of_namespace
from .robots import SimulatedRobot
from .snapshot import Kept, Snapshot

T = TypeVar("T")
F = TypeVar("F", bound=Fault)


class Simulation(Handle):
    """A robot with a laser scanner in a map, or several, on a virtual clock that starts at 0.

    grid: the map. parameters: values of the nodes' parameters by name; unless they say otherwise, the map transform is
    published and commands are plain Twist. seed: seed of the noise, before the parameter of that name. start: pose (x, y,
    yaw) of the robot in the map frame at first, (0, 0, 0) if None. robots: several robots instead of the one, each by its
    name with its pose at first: topics, services and nodes of robot1 are in the namespace /robot1, its frames begin with
    robot1/.

    The same arguments and the same calls give the same messages, byte by byte.

    raises: ValueError for unknown parameters, values out of range, a start inside a wall or another robot.
    """

    def __init__(
        self,
        grid: OccupancyGrid,
        *,
        parameters: Mapping[str, Any] | None = None,
        seed: int | None = None,
        start: PoseLike | None = None,
        robots: Mapping[str, PoseLike] | None = None,
    ) -> None:
        if not isinstance(grid, OccupancyGrid):
            raise TypeError(f"the map must be an OccupancyGrid, got {type(grid).__name__}")
        if robots is not None and not isinstance(robots, Mapping):
            raise TypeError(f"robots must be poses by the robots' names, got {type(robots).__name__}")
        if robots is not None and start is not None:
            raise ValueError(f"one of start and robots must be left out, got {start!r} and {robots!r}")
        self._values = {"publish_map_transform": True, "cmd_vel_stamped": False, **(parameters or {})}
        if seed is not None:
            self._values["seed"] = seed
        check_names(self._values)
        laser = for_node(LaserParameters, self._values)
        self._values.setdefault("odometry_seed", laser.seed)
        if any(key.rpartition(":")[2] == "unknown" for key in self._values) and laser.unknown != grid.unknown:
            grid = with_unknown(grid, laser.unknown)
        self._grid = grid
        self._bus = Bus()
        self._node = BusNode(self._bus, "simulation")
        self._world = World(lambda: self._bus.time_ns, grid)
        self._transforms = TransformBuffer()
        self._listener = TransformListener(self._node, self._transforms)
        self._robots: dict[str, SimulatedRobot] = {}
        self._kept = Kept()
        self._faults: list[Fault] = []
        self.picture: Path | None = None
        """Where an assertion that fails leaves a picture of the drive, if anywhere."""
        self._map_server = MapServer(
            NoCopyNode(self._bus, "map_server"), grid, service=laser.map_service, frame_id=laser.map_frame_id
        )
        self._map_server.start()
        self._node.create_publisher(TFMessage, "/tf_static", QoS.LATCHED)
        if robots is None:
            robots = {"": (0.0, 0.0, 0.0) if start is None else start}
        for name, pose in robots.items():
            self.add_robot(name, start=pose)

    # --- what there is ---

    @property
    def grid(self) -> OccupancyGrid:
        """The map."""
        return self._grid

    @property
    def robots(self) -> Mapping[str, SimulatedRobot]:
        """The robots by their names; the one robot of a simulation without names is called ''."""
        return dict(self._robots)

    @property
    def faults(self) -> Sequence[Fault]:
        """The faults added so far."""
        return tuple(self._faults)

    @property
    def robot(self) -> MobileRobotSimulator:
        """The robot's node, the first one's if there are several."""
        return self._first.robot

    @property
    def laser(self) -> LaserScannerSimulator:
        """The scanner's node, the first robot's if there are several."""
        return self._first.laser

    @property
    def map_server(self) -> MapServer:
        """The node that hands out the map."""
        return self._map_server

    @property
    def truth(self) -> GroundTruth:
        """What really happens to the robot, the first if there are several."""
        return self._first.truth

    @property
    def time(self) -> float:
        """Simulated seconds since the start."""
        return self._bus.time_ns / NANOSECONDS

    @property
    def pose(self) -> Pose:
        """Where the robot is now, in the map frame; the first if there are several."""
        return self.robot.pose

    def named(self, name: str | None) -> SimulatedRobot:
        """The robot of a name, the first if None. raises: ValueError for a name that none has."""
        if name is None:
            return self._first
        if name not in self._robots:
            raise ValueError(f"unknown robot {name!r}; there are {', '.join(map(repr, self._robots))}")
        return self._robots[name]

    def add_robot(
        self, name: str, *, start: PoseLike = (0.0, 0.0, 0.0), parameters: Mapping[str, Any] | None = None
    ) -> SimulatedRobot:
        """Another robot, in the namespace of its name.

        parameters: values that differ from those of the simulation.
        raises: ValueError for a name that is taken or none, unknown parameters, a start inside a wall or another.
        """
        if name in self._robots or (self._robots and not name) or "" in self._robots:
            raise ValueError(f"robots must have names of their own, got {name!r} beside {sorted(self._robots)}")
        values = {**self._values, **(parameters or {})}
        check_names(values)
        if self._robots:
            values["publish_clock"] = False
        values = of_namespace(name, values)
        robot_parameters, laser_parameters = for_node(RobotParameters, values), for_node(LaserParameters, values)
        pose, shape = _pose(start, "start"), robot_parameters.shape
        if shape is not None and touches(self._grid, shape, pose):
            raise ValueError(f"start must leave the robot room beside walls, got ({pose.x}, {pose.y}, {pose.yaw})")
        if not self._grid.is_free_disc(pose.x, pose.y, 0.0):
            raise ValueError(f"start must not be inside a wall, got ({pose.x}, {pose.y}, {pose.yaw})")
        touched = None if shape is None else self._world.touched(shape, pose)
        if touched is not None:
            raise ValueError(f"start must leave the robot room beside {touched}, got ({pose.x}, {pose.y}, {pose.yaw})")
        namespace = f"/{name}"
        robot = MobileRobotSimulator(
            NoCopyNode(self._bus, robot_parameters.node_name, namespace=namespace),
            robot_parameters,
            start_pose=pose,
            world=self._world,
            name=name,
        )
        laser = LaserScannerSimulator(
            NoCopyNode(self._bus, laser_parameters.node_name, namespace=namespace),
            laser_parameters,
            grid=self._grid,
            carrier=robot,
            transforms=self._transforms,
        )
        if laser_parameters.laser_frame_id != laser_parameters.base_link_frame:
            self._listener.start(laser_parameters.odometry_topic)
        added = self._robots[name] = SimulatedRobot(name, robot, laser, GroundTruth(self._world, robot))
        robot.start()
        laser.start()
        return added

    def add_obstacle(self, shape: Shape, trajectory: Trajectory, name: str | None = None) -> Obstacle:
        """Something that stands or moves in the map, that scanners see and robots with a footprint bump into.

        trajectory: a pose, waypoints (time, x, y, yaw), or a function of the time that gives the pose, as for `Obstacle`.
        name: what contacts call it; its number if not given.
        """
        if not isinstance(shape, Shape):
            raise TypeError(f"an obstacle's shape must be a Shape, got {type(shape).__name__}")
        obstacle = Obstacle(f"{len(self._world.obstacles) + 1}" if name is None else name, shape, trajectory)
        self._world.place(obstacle)
        return obstacle

    def add_fault(self, fault: F) -> F:
        """Have something go wrong; returns it. See `faults`.

        raises: ValueError for a fault that was added before, or one of a topic or robot that does not exist.
        """
        if not isinstance(fault, Fault):
            raise TypeError(f"a fault must be one of faults, got {type(fault).__name__}")
        fault.add_to(self, self._bus)
        self._faults.append(fault)
        return fault

    # --- time ---

    def run_for(self, seconds: float) -> None:
        """Let simulated time go on; no sleeping.

        What a callback raises comes out here with its traceback; the run can go on afterwards.
        raises: ValueError for a duration that is negative or not finite.
        """
        self._bus.run_until(self._bus.time_ns + _span(seconds, "the duration"))

    def run_until(self, predicate: Callable[[Simulation], Any], timeout: float) -> float:
        """Let simulated time go on until `predicate(simulation)` holds; asked now, and after each moment anything happens.

        returns: the time then [s].
        raises: TimeoutError that says what was last seen, if it does not hold within `timeout` simulated seconds; ValueError
        for a timeout that is negative or not finite.
        """
        if not callable(predicate):
            raise TypeError(f"the predicate must be a function of the simulation, got {predicate!r}")
        began_ns = self._bus.time_ns
        end_ns = began_ns + _span(timeout, "the timeout")
        while not (answer := predicate(self)):
            if self._bus.time_ns >= end_ns and self._bus.next_ns() != end_ns:
                raise TimeoutError(
                    f"{_called(predicate)} did not hold within {timeout:g} s, from {began_ns / NANOSECONDS:g} s on: "
                    f"it last gave {answer!r}; {self._last_seen()}"
                )
            next_ns = self._bus.next_ns()
            self._bus.run_until(end_ns if next_ns is None else min(next_ns, end_ns))
        return self.time

    def step(self) -> float:
        """Let everything happen that happens at the next moment at which anything does. returns: the time then [s]."""
        next_ns = self._bus.next_ns()
        if next_ns is not None:
            self._bus.run_until(next_ns)
        return self.time

    def set_pose(self, pose: PoseLike, robot: str | None = None) -> None:
        """Put a robot somewhere in the map, the first if none is named.

        raises: ValueError for a pose inside a wall, or an unknown robot.
        """
        place = _pose(pose, "the pose")
        if not self._grid.is_free_disc(place.x, place.y, 0.0):
            raise ValueError(f"the pose must not be inside a wall, got ({place.x}, {place.y}, {place.yaw})")
        self.named(robot).robot.set_pose(place)

    def reset(self) -> None:
        """Put all robots back to where they were at first, at rest. Time goes on; `restore` takes it back too."""
        for robot in self._robots.values():
            robot.robot.reset()

    # --- saving ---

    def keep(self, thing: T) -> T:
        """Save and restore something of one's own with the simulation; returns it.

        By its methods `save()` and `restore(state)`, if it has both, else by deep copies of its attributes. Nodes made by
        `spawn` are kept without asking; variables of functions are not, whoever calls them.
        """
        self._kept.add(thing)
        return thing

    def save(self) -> Snapshot:
        """All that is needed to put the simulation back as it is now.

        Saved are the map's cells, the time, what is under way on the bus, timers, subscriptions, latest messages, robots,
        scanners with their place in the random streams, faults, obstacles, nodes, and what is in `keep`. Callbacks are not
        saved but called again as they are, and recordings go on.
        raises: RuntimeError if called from a callback; TypeError for something kept that cannot be copied.
        """
        robots = {name: (robot, robot.robot.save(), robot.laser.save()) for name, robot in self._robots.items()}
        faults = [(fault, fault.save()) for fault in self._faults]
        grid = copy.copy(self._grid)  # which costs nothing until one of the two changes
        parts = (grid, self._bus.save(), self._world.save(), robots, faults, self._map_server.save(), self._kept.save())
        return Snapshot(self, self.time, parts)

    def restore(self, state: Snapshot) -> None:
        """Be as when the state was saved; from there on everything repeats, byte by byte. A state can be used again.

        raises: ValueError for another simulation's state; RuntimeError if called from a callback.
        """
        if not isinstance(state, Snapshot):
            raise TypeError(f"the state must come from save(), got {type(state).__name__}")
        if state.simulation is not self:
            raise ValueError(f"the state must be of this simulation, got another's, saved at {state.time} s")
        grid, bus, world, robots, faults, map_server, kept = state.parts
        self._bus.restore(bus)
        if not np.array_equal(grid.cells, self._grid.cells):
            self._grid.set_cells(0, 0, grid.cells)
        self._robots = {name: robot for name, (robot, _, _) in robots.items()}
        for robot, robot_state, laser_state in robots.values():
            robot.robot.restore(robot_state)
            robot.laser.restore(laser_state)
        self._world.restore(world)
        self._map_server.restore(map_server)
        for fault in self._faults:
            fault.forget()
        self._faults = [fault for fault, _ in faults]
        for fault, fault_state in faults:
            fault.restore(fault_state)
        self._kept.restore(kept)

    # --- topics and nodes ---

    def publish(self, topic: str, message: Message) -> None:
        """Send a message; it arrives when time goes on.

        raises: ValueError for a topic that does not exist; TypeError for a message of another type than the topic's.
        """
        self._check_topic(topic)
        self._node.create_publisher(type(message), topic).publish(message)

    def subscribe(self, topic: str, msg_type: type[M], callback: Callable[[M], None]) -> BusSubscription[M]:
        """Have every message of a topic handed to a callback, which may publish, set timers and call services.

        raises: ValueError for a topic that does not exist; TypeError for another type than the topic's.
        """
        self._check_topic(topic)
        return self._node.create_subscription(msg_type, topic, callback)

    def unsubscribe(self, subscription: BusSubscription[Any]) -> None:
        """Hand no more messages to a subscription's callback."""
        self._node.destroy_subscription(subscription)

    def latest(self, topic: str) -> Any:
        """The message last published to a topic, None if there was none yet.

        raises: ValueError for a topic that does not exist.
        """
        self._check_topic(topic)
        return self._bus.latest(topic)

    def create_node(self, name: str, *, namespace: str = "/", parameters: Mapping[str, Any] | None = None) -> BusNode:
        """A node of one's own, for topics, timers and services under rclpy's names.

        parameters: values that take the place of the defaults when the node declares its parameters.
        """
        return BusNode(self._bus, name, namespace=namespace, parameters=parameters)

    def spawn(
        self,
        node_type: Callable[..., T],
        *args: Any,
        namespace: str = "/",
        parameters: Mapping[str, Any] | None = None,
        **kwargs: Any,
    ) -> T:
        """A node of a class derived from `Node`, made with these arguments and put on the bus.

        namespace: for instance /robot1; relative names of topics are in it. parameters: as in `create_node`.
        """
        with spawn_context(self._bus, namespace, parameters or {}):
            return node_type(*args, **kwargs)

    def record(self, tap: Tap) -> None:
        """Call `tap(topic, message, time_ns)` for every message published, and at once for the latched ones so far."""
        for topic, message, time_ns in self._bus.latched():
            tap(topic, message, time_ns)
        self._bus.taps.append(tap)

    def stop_recording(self, tap: Tap) -> None:
        """Call a tap no more. raises: ValueError if it was not called before."""
        self._bus.taps.remove(tap)

    # --- pictures, and the end ---

    def draw(self, file: str | os.PathLike[str]) -> None:
        """Save a picture of the map, the ways that the robots really drove, what else is there, and the first's last scan.

        raises: ImportError without matplotlib.
        """
        from ..plotting import plot_drive

        first, *others = [self._first, *list(self._robots.values())[1:]]
        scans = self._bus.topic(first.laser.parameters.laser_topic, LaserScan)
        taken, scanner = first.robot.motion.map_pose_at(scans.latest_ns), first.laser.scanner
        points = scanner.end_points(taken, scans.latest.ranges) if isinstance(scans.latest, LaserScan) else None
        path = Path(file)
        path.parent.mkdir(parents=True, exist_ok=True)
        plot_drive(
            path,
            self._grid,
            first.truth.path[:, 1:],
            others={robot.name: robot.truth.path[:, 1:] for robot in others},
            shapes=[placed for _, placed in self._world.everybody()],
            scan_points=points,
            laser_pose=taken * scanner.mount,
        )

    def close(self) -> None:
        """Let go of recordings, callbacks and nodes; time no longer goes on. The second time, nothing happens."""
        self._bus.close()

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def _first(self) -> SimulatedRobot:
        if not self._robots:
            raise ValueError("the simulation has no robot yet: add one with add_robot")
        return next(iter(self._robots.values()))

    def _check_topic(self, name: str) -> None:
        names = self._bus.topic_names()
        if absolute(name) not in names:
            near = difflib.get_close_matches(absolute(name), names, n=1)
            hint = f"did you mean {near[0]}?" if near else f"there are {', '.join(names)}"
            raise ValueError(f"unknown topic {name!r}; {hint}")

    def _last_seen(self) -> str:
        """Where the robots are, and when each topic last had a message."""
        robots = []
        for name, robot in self._robots.items():
            x, y, yaw = robot.pose
            vx, vy, wz = robot.truth.velocity
            moving = f"moving at {vx:.2f}, {vy:.2f} m/s, {wz:.2f} rad/s" if any((vx, vy, wz)) else "standing"
            robots.append(f"{name or 'the robot'} at ({x:.2f}, {y:.2f}, {yaw:.2f}), {moving}")
        topics = [
            f"{topic.name} {f'{topic.latest_ns / NANOSECONDS:g} s' if topic.latest is not None else 'never'}"
            for topic in self._bus.topics()
        ]
        return f"at {self.time:g} s {'; '.join(robots)}; last messages: {', '.join(topics)}"


def _pose(pose: PoseLike, what: str) -> Pose:
    if isinstance(pose, Pose):
        return pose
    try:
        x, y, yaw = map(float, pose)
    except (TypeError, ValueError):
        raise ValueError(f"{what} must be three numbers (x, y, yaw), got {pose!r}") from None
    return Pose(x, y, yaw)


def _span(seconds: float, what: str) -> int:
    if not 0.0 <= seconds < math.inf:
        raise ValueError(f"{what} must be finite and at least 0 s, got {seconds}")
    return round(seconds * NANOSECONDS)


def _called(predicate: Callable[..., Any]) -> str:
    name = getattr(predicate, "__name__", "")
    return f"the predicate {name}" if name and name != "<lambda>" else "the predicate"
