"""Simulation: a map, robots, obstacles and faults on a virtual clock, in one object."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from .._core import OccupancyGrid, Pose, Shape
from ..bus.bus import Bus
from ..bus.node import BusNode, NoCopyNode, spawn_context
from ..bus.topic import BusSubscription, LazyTap, Tap
from ..handle import Handle
from ..instant import NANOSECONDS
from ..messages import Message, TFMessage
from ..nodes.interface import M, QoS
from ..nodes.laser import LaserScannerSimulator
from ..nodes.map_messages import with_unknown
from ..nodes.map_server import MapServer
from ..nodes.robot import MobileRobotSimulator
from ..parameters import LaserParameters, for_node
from ..physics.obstacles import Obstacle, PoseLike, Trajectory
from ..physics.world import World
from ..quoting import quoted
from ..scanners import check_robot_names
from .arguments import check_parameters, to_nanoseconds, to_pose, to_velocity
from .fault import F, Fault, FaultList
from .ground_truth import GroundTruth
from .kept import Kept
from .picture import picture_of
from .robots import Robots, SimulatedRobot
from .snapshot import Parts, Snapshot
from .topics import Topics

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..live import LiveView

T = TypeVar("T")

DEFAULTS: Mapping[str, Any] = {
    "publish_map_transform": True,
    "cmd_vel_stamped": False,
    "ground_truth_topic": "",
    "contact_topic": "",
    "stalled_topic": "",
}
"""Defaults of parameters that differ in a simulation. The ground truth is there in Python already: `Simulation.truth`."""


class Simulation(Handle):
    """One or more robots with laser scanners in a map, on a virtual clock that starts at 0.

    The same arguments and the same calls give the same messages, byte for byte.

    A simulation has one robot without a name, or robots with names (`robots`). The topics, services and nodes of a robot
    named `robot1` are in the namespace `/robot1`, and the names of its frames start with `robot1/`. Properties such as
    `pose` and `truth` refer to the first robot.

    Args:
        grid: The map.
        parameters: Values of the nodes' parameters by name. Some defaults differ in a simulation; their
            descriptions in the list of parameters say so.
        seed: Seed of the noise. Replaces the parameter `seed`.
        start: Start pose (x [m], y [m], yaw [rad]) of the only robot, in the map frame. Default: the parameter
            `initial_pose`, which is (0, 0, 0) by default.
        robots: Start poses of several robots by their names, instead of `start`.

    Attributes:
        picture: File in which a failed assertion of `mobile_robot_simulator.testing` saves a picture, or None.
        goal: Goal (x, y) or (x, y, yaw) in the map frame that pictures show, or None. `assert_reaches` sets it.

    Raises:
        ValueError: A parameter is unknown or out of range, or a start pose is inside a wall or another robot.
        TypeError: The map is not an `OccupancyGrid`, `parameters` or `robots` is not a mapping, or a robot's name is not a
            text.

    Warns:
        UserWarning: A start pose is off the map, where there is nothing to touch and nothing to see.

    Example:
        >>> import numpy as np
        >>> import mobile_robot_simulator as mrs
        >>> sim = mrs.Simulation(mrs.OccupancyGrid(np.zeros((100, 100), np.int8), resolution=0.1), start=(5.0, 5.0, 0.0))
        >>> sim.publish("/cmd_vel", mrs.messages.Twist(linear=mrs.messages.Vector3(x=0.5)))
        >>> sim.run_for(1.0)
        >>> sim
        Simulation(at 1 s, 1 robot at (5.25, 5.00, 0.00), map 100x100 cells)
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
        check_parameters(parameters)
        starts = _starts(start, robots)
        values = {**DEFAULTS, **(parameters or {})}
        if seed is not None:
            values["seed"] = seed
        check_robot_names(values)
        laser = for_node(LaserParameters, values)
        values.setdefault("odometry_seed", laser.seed)
        if any(key.rpartition(":")[2] == "unknown" for key in values):
            values.setdefault("unknown", laser.unknown)
            grid = with_unknown(grid, laser.unknown) if laser.unknown != grid.unknown else grid
        self._grid = grid
        self._bus = bus = Bus()
        self._node = BusNode(bus, "simulation")
        self._topics = Topics(bus, self._node)
        self._world = World(lambda: bus.time_ns, grid)
        self._robots = Robots(bus, self._world, grid, values, self._node)
        self._faults, self._kept = FaultList(), Kept()
        self._map_server = MapServer(
            NoCopyNode(bus, "map_server"), grid, service=laser.map_service, frame_id=laser.map_frame_id
        )
        self._parts = Parts(grid, bus, self._world, self._robots, self._faults, self._map_server, self._kept)
        self.picture: Path | None = None
        self.goal: tuple[float, ...] | None = None
        self._view: LiveView | None = None
        self._map_server.start()
        self._node.create_publisher(TFMessage, "/tf_static", QoS.LATCHED)
        try:
            for name, pose in starts.items():
                self.add_robot(name, start=pose)
        except ValueError as error:
            if start is not None or robots is not None or not str(error).startswith("start "):
                raise
            hint = "no start was given; give one, such as start=grid.draw_free_pose(radius=0.3, seed=1)"
            raise ValueError(f"{error}; {hint}") from None

    def __repr__(self) -> str:
        robots = list(self._robots)
        if len(robots) == 1:
            shown = f"1 robot {robots[0].place}"
        else:
            shown = f"{len(robots)} robots{': ' if robots else ''}{', '.join(f'{one.name} {one.place}' for one in robots)}"
        height, width = self._grid.shape
        return f"Simulation(at {self.time:g} s, {shown}, map {width}x{height} cells)"

    # --- parts and state ---

    @property
    def grid(self) -> OccupancyGrid:
        """The map."""
        return self._grid

    @property
    def robots(self) -> Mapping[str, SimulatedRobot]:
        """The robots by name. A robot without a name has the key ''."""
        return self._robots.by_name

    @property
    def faults(self) -> Sequence[Fault]:
        """All faults, in the order in which they were added."""
        return self._faults.all

    @property
    def robot(self) -> MobileRobotSimulator:
        """The node that moves the first robot."""
        return self._robots.first.robot

    @property
    def laser(self) -> LaserScannerSimulator:
        """The node of the first robot's first laser scanner."""
        return self._robots.first.laser

    @property
    def map_server(self) -> MapServer:
        """The node that serves the map."""
        return self._map_server

    @property
    def truth(self) -> GroundTruth:
        """True pose, velocity, path and contacts of the first robot."""
        return self._robots.first.truth

    @property
    def time(self) -> float:
        """Simulated time since the start [s]."""
        return self._bus.time_ns / NANOSECONDS

    @property
    def pose(self) -> Pose:
        """Current true pose of the first robot in the map frame."""
        return self._robots.first.pose

    # --- robots, obstacles, faults ---

    def named(self, name: str | None) -> SimulatedRobot:
        """Returns the robot with this name, or the first robot if the name is None.

        Raises:
            ValueError: There is no such robot.
        """
        return self._robots.named(name)

    def add_robot(
        self, name: str, *, start: PoseLike | None = None, parameters: Mapping[str, Any] | None = None
    ) -> SimulatedRobot:
        """Adds a robot, in the namespace of its name.

        Args:
            name: Name of the robot.
            start: Start pose (x [m], y [m], yaw [rad]) in the map frame. Default: the parameter `initial_pose`.
            parameters: Parameters by name. They replace those of the simulation for this robot.

        Raises:
            TypeError: The name is not a text, the parameters are not a mapping, or a topic of the robot carries messages of
                another type. Then there is no new robot.
            ValueError: The name is empty, taken or not valid in ROS, a parameter is unknown or out of range, or the start
                pose is inside a wall, an obstacle or another robot.
        """
        check_parameters(parameters)
        return self._robots.add(name, start, parameters or {})

    def add_obstacle(self, shape: Shape, trajectory: Trajectory, name: str | None = None) -> Obstacle:
        """Adds a standing or moving obstacle. Scanners see it, and robots with a footprint collide with it.

        Args:
            shape: Outline of the obstacle.
            trajectory: Poses in the map frame: one pose (x [m], y [m], yaw [rad]), waypoints (time [s], x, y, yaw), or a
                function that returns the pose at a time [s]. See `Obstacle`.
            name: Name of the obstacle, also in contact events. Default: its number, from 1. If several obstacles have
                one name, it stands for the first of them.

        Raises:
            TypeError: The shape is not a `Shape`, or the name is not a text.
            ValueError: The waypoints are empty, or their times do not increase.
        """
        if not isinstance(shape, Shape):
            raise TypeError(f"an obstacle's shape must be a Shape, got {type(shape).__name__}")
        if not isinstance(name, str | None):
            raise TypeError(f"an obstacle's name must be a text, got {quoted(name)}")
        obstacle = Obstacle(f"{self._world.placed + 1}" if name is None else name, shape, trajectory)
        self._world.place(obstacle)
        return obstacle

    @property
    def obstacles(self) -> Sequence[Obstacle]:
        """All obstacles, in the order in which they were added."""
        return tuple(self._world.obstacles)

    def move_obstacle(
        self,
        obstacle: Obstacle | str,
        pose: PoseLike | None = None,
        *,
        velocity: tuple[float, float, float] | None = None,
    ) -> None:
        """Moves an obstacle from now on. It does not stop at walls or robots; robots collide with it.

        Args:
            obstacle: The obstacle, or its name.
            pose: Pose (x [m], y [m], yaw [rad]) in the map frame to move to at once. Default: where it is.
            velocity: Velocity (vx [m/s], vy [m/s], wz [rad/s]) from now on, in its own frame: forward, left and
                counter-clockwise. Default: as before.

        Raises:
            ValueError: There is no such obstacle, it follows waypoints or a function, or a number is not finite.
        """
        found = self._world.obstacle(obstacle) if isinstance(obstacle, str) else obstacle
        place = None if pose is None else to_pose(pose, "the pose")
        self._world.move(found, place, None if velocity is None else to_velocity(velocity, "the velocity"))

    def remove_obstacle(self, obstacle: Obstacle | str) -> None:
        """Removes an obstacle.

        Args:
            obstacle: The obstacle, or its name.

        Raises:
            ValueError: There is no such obstacle.
        """
        self._world.remove(self._world.obstacle(obstacle) if isinstance(obstacle, str) else obstacle)

    def set_cells(self, row: int, col: int, cells: NDArray[np.int8]) -> None:
        """Changes cells of the map, and publishes the changed map on `/map`.

        Robots collide with the new cells from now on, and scanners see them.

        Args:
            row: Row of the lower-left changed cell.
            col: Column of the lower-left changed cell.
            cells: (h, w) int8, -1 for unknown cells, otherwise the occupancy 0 to 100.

        Raises:
            ValueError: The cells do not fit into the map, or a value is out of range. Nothing changes.
            TypeError: The cells are not int8. Nothing changes.
        """
        self._grid.set_cells(row, col, cells)
        self._world.use_map(self._grid)
        self._map_server.serve(self._grid)

    def add_fault(self, fault: F) -> F:
        """Adds a fault from `mobile_robot_simulator.faults`. Returns the fault.

        Raises:
            ValueError: The fault was added before, or names a topic or robot that does not exist.
            TypeError: It is not a fault, or the topic carries messages of a type that the fault cannot change.
        """
        return self._faults.add(fault, self, self._bus)

    def set_pose(self, pose: PoseLike, robot: str | None = None) -> None:
        """Moves a robot to another pose immediately.

        Args:
            pose: Pose (x [m], y [m], yaw [rad]) in the map frame.
            robot: Name of the robot; None for the first.

        Raises:
            ValueError: The pose is inside a wall, or the footprint touches a wall, an obstacle or another robot there, or
                there is no such robot. The robot stays where it is.

        Warns:
            UserWarning: The pose is off the map, where there is nothing to touch and nothing to see.
        """
        self._robots.set_pose(pose, robot)

    def reset(self) -> None:
        """Moves all robots back to their start poses and stops them. Time does not go back, unlike with `restore`."""
        self._robots.reset()

    # --- time ---

    def run_for(self, seconds: float) -> None:
        """Runs the simulation for a duration, as fast as possible.

        An exception in a callback ends the run and is raised here with its traceback. Another run can follow. Durations that
        follow one another add up before the time is rounded to nanoseconds: 30 runs of 1/30 s end at 1 s.

        Args:
            seconds: Simulated duration [s].

        Raises:
            ValueError: The duration is negative, not finite or longer than 146 years.
        """
        to_nanoseconds(seconds, "the duration")
        self._bus.run_for(seconds)

    def run_until(self, predicate: Callable[[Simulation], Any], timeout: float) -> float:
        """Runs the simulation until a condition holds.

        Args:
            predicate: Function that takes the simulation and returns a true value if the condition holds. It is called now,
                and again after the events of each time.
            timeout: Longest simulated time to wait [s].

        Returns:
            The simulated time at which the condition held [s].

        Raises:
            TimeoutError: The condition did not hold before the timeout. The message gives the last value of the predicate,
                the state of each robot and the time of the last message on each topic.
            TypeError: The predicate is not callable.
            ValueError: The timeout is negative or not finite.
        """
        if not callable(predicate):
            raise TypeError(f"the predicate must be a function of the simulation, got {quoted(predicate)}")
        start_ns = self._bus.time_ns
        end_ns = start_ns + to_nanoseconds(timeout, "the timeout")
        while not (answer := predicate(self)):
            next_ns = self._bus.next_ns()
            if self._bus.time_ns >= end_ns and next_ns != end_ns:
                raise TimeoutError(
                    f"{_called(predicate)} did not hold within {timeout:g} s, from {start_ns / NANOSECONDS:g} s to "
                    f"{self.time:g} s: it last returned {quoted(answer)}; "
                    f"{'; '.join(robot.status for robot in self._robots)}; "
                    f"last messages: {self._topics.last_times()}"
                )
            self._bus.run_until(end_ns if next_ns is None else min(next_ns, end_ns))
        return self.time

    def step(self) -> float:
        """Runs the simulation to the time of the next event. Has no effect if there is none.

        Returns:
            The new simulated time [s].
        """
        next_ns = self._bus.next_ns()
        if next_ns is not None:
            self._bus.run_until(next_ns)
        return self.time

    # --- saving ---

    def keep(self, thing: T) -> T:
        """Adds an object that is saved and restored with the simulation. Returns the object.

        If the object has the methods `save()` and `restore(state)`, they are called. Otherwise its attributes are
        deep-copied. Nodes created by `spawn` are always saved. Variables that callbacks capture are never saved.
        """
        self._kept.add(thing)
        return thing

    def save(self) -> Snapshot:
        """Returns a snapshot of the simulation.

        It contains the cells of the map, the time, pending messages, timers, subscriptions, latest messages, robots,
        scanners with their positions in the random streams, faults, obstacles, nodes, and objects passed to `keep`.
        Callbacks are shared, not copied. Recordings are not part of it and continue after a restore.

        Raises:
            RuntimeError: Called from a callback.
            TypeError: An attribute of a node or of a kept object cannot be copied.
        """
        return Snapshot(self, self.time, self._parts.save())

    def restore(self, state: Snapshot) -> None:
        """Puts the simulation back into a saved state. The same calls then give the same messages again, byte for byte.

        Args:
            state: Snapshot of this simulation. It can be restored again.

        Raises:
            ValueError: The snapshot is of another simulation.
            TypeError: The state is not a snapshot.
            RuntimeError: Called from a callback.
        """
        if not isinstance(state, Snapshot):
            raise TypeError(f"the state must be a Snapshot from save(), got {type(state).__name__}")
        if state.simulation is not self:
            raise ValueError(f"the snapshot must be of this simulation, got one of another, saved at {state.time:g} s")
        self._parts.restore(state.parts)
        self._topics.forget_publishers()

    # --- topics and nodes ---

    def publish(self, topic: str, message: Message) -> None:
        """Publishes a copy of a message. Subscribers receive it when the simulation runs.

        Raises:
            ValueError: The topic does not exist, or an array in the message has a length that ROS does not allow.
            TypeError: The topic carries messages of another type, or a field of the message holds a value of a wrong type.
            RuntimeError: The simulation is closed.
        """
        self._topics.publish(topic, message)

    def subscribe(self, topic: str, msg_type: type[M], callback: Callable[[M], None]) -> BusSubscription[M]:
        """Calls a function with every message on a topic from now on.

        Args:
            topic: Name of the topic. If there is none yet, a node can start to publish on it later. If there is one of a
                similar name, the first subscription logs a warning, because the name may be a misspelling.
            msg_type: Type of its messages.
            callback: Function that takes the message. It can publish, create timers and call services.

        Raises:
            ValueError: The name is empty.
            TypeError: The topic carries messages of another type, or the callback is not callable.
            RuntimeError: The simulation is closed.
        """
        return self._topics.subscribe(topic, msg_type, callback)

    def unsubscribe(self, subscription: BusSubscription[Any]) -> None:
        """Ends a subscription. Its callback is no longer called. Has no effect on one that has ended.

        Raises:
            TypeError: It is not a subscription.
            ValueError: It is a subscription of a node or of another simulation.
        """
        self._topics.unsubscribe(subscription)

    def latest(self, topic: str) -> Any:
        """Returns the last message published on a topic, or None if there was none.

        Raises:
            ValueError: The topic does not exist.
            RuntimeError: The simulation is closed.
        """
        return self._topics.latest(topic)

    def create_node(self, name: str, *, namespace: str = "/", parameters: Mapping[str, Any] | None = None) -> BusNode:
        """Returns a new node with the interface of an rclpy node: topics, timers, services and parameters.

        Args:
            name: Name of the node.
            namespace: Prefix of its relative topic and service names, such as `/robot1`.
            parameters: Values that replace the defaults when the node declares its parameters.

        Raises:
            ValueError: The name is empty or contains a slash.
            TypeError: The name or the namespace is not a text, or the parameters are not a mapping.
            RuntimeError: The simulation is closed.
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
        """Creates a node of a class derived from `bus.Node` and runs it on the bus. Returns the node.

        Args:
            node_type: The class.
            *args: Positional arguments of the class.
            namespace: Prefix of its relative topic and service names, such as `/robot1`.
            parameters: Values that replace the defaults when the node declares its parameters.
            **kwargs: Keyword arguments of the class.

        Raises:
            TypeError: The class is not callable, or creates no node.
            RuntimeError: The simulation is closed.
        """
        if not callable(node_type):
            raise TypeError(
                f"spawn needs a class derived from bus.Node, or a function that creates one, got {quoted(node_type)}"
            )
        check_parameters(parameters)
        count = len(self._bus.nodes)
        with spawn_context(self._bus, namespace, parameters or {}):
            node = node_type(*args, **kwargs)
        if not isinstance(node, BusNode) and len(self._bus.nodes) == count:
            raise TypeError(
                f"spawn needs a class derived from bus.Node, or a function that creates one, "
                f"got {quoted(node_type)}, which created none"
            )
        return node

    def record(self, tap: Tap) -> None:
        """Calls `tap(topic, message, time_ns)` for every message that is published, and now for each latched message.

        `time_ns` is the simulated time at which the message was sent [ns]. The tap must not change the messages.

        Raises:
            TypeError: The tap is not callable.
            RuntimeError: The simulation is closed.
        """
        self._topics.record(tap)

    def record_lazily(self, tap: LazyTap) -> None:
        """Calls a tap as `record` does, but with the call that builds a message, if nobody else needs the message.

        The simulator builds most messages only if somebody receives them, so a tap that keeps all and reads few
        costs far less this way.

        Args:
            tap: Called as `tap(topic, message, time_ns)`. The message can be a `functools.partial`, which returns the
                message when it is called, also later, and a new one each time.

        Raises:
            TypeError: The tap is not callable.
            RuntimeError: The simulation is closed.
        """
        self._topics.record_lazily(tap)

    def stop_recording(self, tap: Tap | LazyTap) -> None:
        """Stops calling a tap.

        Raises:
            ValueError: The tap was not recording.
        """
        self._topics.stop_recording(tap)

    # --- pictures, and the end ---

    def draw(self, file: str | os.PathLike[str]) -> None:
        """Saves a picture of the map, the true paths of all robots, the obstacles, and the first robot's last scan.

        It also shows the `goal`, and where each robot first touched something.

        Args:
            file: File to write. Its extension (.png, .pdf or .svg) selects the format. An existing file is replaced.

        Raises:
            ImportError: Matplotlib is not installed.
            ValueError: The file has another extension, or there is no robot.
            OSError: The folder does not exist or cannot be written.
        """
        picture_of(self._grid, self._bus, self._world, self._robots, self.goal).save(file)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draws the map, the true paths of all robots, the obstacles, and the first robot's last scan; returns the axes.

        Args:
            ax: Matplotlib axes to draw in. None opens a new pyplot figure.

        Raises:
            ImportError: Matplotlib is not installed.
            ValueError: There is no robot.
        """
        return picture_of(self._grid, self._bus, self._world, self._robots, self.goal).plot(ax)

    def show(
        self, *, host: str = "127.0.0.1", port: int = 0, folder: str | os.PathLike[str] = "live", speed: float = 1.0
    ) -> LiveView:
        """Shows the simulation in the browser. Returns at once.

        The page shows every run of the simulation as it happens, at `speed` times real time; viewers can change the speed,
        stop the time and drive. Between the runs, time stands still, unless `LiveView.run` hands the simulation over to the
        page. In a notebook, the page can also let time run between the cells.

        Args:
            host: Address to listen on. With another one than 127.0.0.1 or localhost, the address contains a token.
            port: Port; 0 chooses a free one.
            folder: Folder for recordings that viewers make.
            speed: Simulated seconds per second of wall time.

        Returns:
            The view. Its `url` is the address of the page. A view that is open already is returned again.

        Raises:
            ImportError: NiceGUI is not installed.
            ValueError: `speed` is not positive and finite, or `port` is not in 0..65535.
            TypeError: `speed` is not a number.
            OSError: The address cannot be used.
            RuntimeError: The simulation is closed.
        """
        from ..live import LiveView

        self._bus.check_open()
        if not isinstance(speed, Real):
            raise TypeError(f"the speed must be a number, got {quoted(speed)}")
        if not 0.0 < speed < math.inf:
            raise ValueError(f"the speed must be positive and finite, got {quoted(speed)}")
        if self._view is None or self._view.is_closed:
            self._view = LiveView(self, host=host, port=port, folder=Path(folder))
            self._view.session.pace.speed = speed
            self._view.follow()
        return self._view

    def _repr_png_(self) -> bytes | None:
        """Returns the picture of `draw` as a PNG image for notebooks; None without Matplotlib or without a robot."""
        if not len(self._robots):
            return None
        try:
            picture = picture_of(self._grid, self._bus, self._world, self._robots, self.goal)
        except ImportError:
            return None
        return picture.to_png()

    def close(self) -> None:
        """Drops all recordings, callbacks, nodes and topics. Closing twice has no effect.

        Afterwards, what needs a topic or time raises RuntimeError. The map, the robots' poses and pictures stay.
        """
        if self._view is not None:
            self._view.close()
        self._bus.close()
        self._topics.forget_publishers()

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _starts(start: PoseLike | None, robots: Mapping[str, PoseLike] | None) -> Mapping[str, PoseLike | None]:
    """Returns the start poses of all robots by name. If `robots` is None, the only robot has the name ''."""
    if robots is None:
        return {"": start}
    if not isinstance(robots, Mapping):
        raise TypeError(f"robots must be a mapping from names to start poses, got {type(robots).__name__}")
    if start is not None:
        raise ValueError(f"start and robots must not both be given, got {quoted(start)} and {quoted(robots)}")
    return robots


def _called(predicate: Callable[..., Any]) -> str:
    name = getattr(predicate, "__name__", "")
    return f"the predicate {name}" if name and name != "<lambda>" else "the predicate"
