"""Disturbances: what faults need of a ROS process. They act on its messages, robots and nodes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Protocol, TypeVar

from ..messages import Message
from ..nodes.interface import M, Publisher, QoS
from ..nodes.laser import LaserScannerSimulator
from ..nodes.map_server import MapFileServer
from ..nodes.message_filters import Filter, filtered
from ..nodes.robot import MobileRobotSimulator
from ..nodes.steady_time import SteadyTime
from ..parameters import is_topic_name
from ..quoting import quoted
from .event_clock import EventClock
from .executor import Executor
from .intra_process import IntraProcessTopic, IntraProcessTopics

N = TypeVar("N")

READING_PERIOD = 1.0
"""Time between two readings of the clock of the faults [s]."""


class ProcessFault(Protocol):
    """A fault that can be added to a process."""

    def add_to(self, simulation: Any, bus: Any, /) -> None:
        """Connects the fault to the process, on which it then acts."""


ReadFaults = Callable[[Iterable[str]], Sequence[ProcessFault]]
"""Reads faults that are written as text, and puts those of the command line in front."""


class FaultyNode(Protocol):
    """The part of a node on ROS that faults use."""

    def create_publisher(self, msg_type: type[M], topic: str, qos_profile: QoS, /) -> Publisher[M]:
        """Creates a publisher."""

    def resolve_topic_name(self, topic: str, /) -> str:
        """Returns the full name of a topic."""


@dataclass(eq=False)
class ProcessRobot:
    """The nodes of one robot that a process runs.

    Attributes:
        name: Name of the robot; empty for the only one.
        running_robot: The node that moves it, None if another process has it.
        running_scanners: The nodes of its scanners, by their topics. Empty if other processes have them.
    """

    name: str
    running_robot: MobileRobotSimulator | None = None
    running_scanners: dict[str, LaserScannerSimulator] = field(default_factory=dict)

    @property
    def robot(self) -> MobileRobotSimulator:
        """The node that moves the robot. Raises ValueError if another process has it."""
        return _needed(self.running_robot, "the robot")

    @property
    def scanners(self) -> dict[str, LaserScannerSimulator]:
        """The nodes of its scanners. Raises ValueError if other processes have them."""
        return _needed(self.running_scanners or None, "the laser")


class Disturbances:
    """The faults of one process, and what they act on.

    A fault of messages acts on the messages that the process publishes on a topic. On a topic that the process only
    receives, it acts on what the process receives. The time starts when the first fault is added. It follows the clock of
    the process, but does not jump with it.

    Args:
        executor: Runs the callbacks of the process.
        topics: Topics of the process.

    Attributes:
        filters: Functions that replace, delay or drop messages, in the order in which they apply.
        faults: All faults.
        robots: Robots by name.
        running_map_server: The map server, None if the process has none.
    """

    def __init__(self, executor: Executor, topics: IntraProcessTopics) -> None:
        self._executor, self._topics = executor, topics
        self.filters: list[Filter] = []
        self.faults: list[Any] = []
        self.robots: dict[str, ProcessRobot] = {}
        self.running_map_server: MapFileServer | None = None
        self._node: FaultyNode | None = None
        self._publishers: dict[str, Any] = {}

    def add(self, faults: Iterable[ProcessFault], node: FaultyNode, clock: EventClock) -> None:
        """Adds faults. Must be called once, after the nodes have started.

        Args:
            faults: The faults.
            node: Node whose namespace the faults' relative names of topics are in.
            clock: Clock of the process.

        Raises:
            ValueError: A fault names a topic, robot or node that the process does not have, or cannot act on ROS.
            TypeError: A topic has messages of a type that the fault cannot change.
        """
        self._node, self._clock, self._time = node, clock, SteadyTime(clock)
        self._start_ns = self._time()
        # A clock that nobody reads for an hour counts as one that has jumped.
        self._executor.create_timer(clock, READING_PERIOD, self._read_clock)
        for fault in faults:
            fault.add_to(self, self)
            self.faults.append(fault)

    def robot_named(self, name: str) -> ProcessRobot:
        """Returns the robot with this name. Creates it, without nodes, if it does not exist."""
        return self.robots.setdefault(name, ProcessRobot(name))

    def pass_on(self, topic: str, message: Message, send: Callable[[Any], None]) -> None:
        """Sends what the faults make of a message.

        Args:
            topic: Full name of the topic.
            message: The message.
            send: Called with each message to send, at once or later.
        """
        for delay_ns, replacement in filtered(self.filters, topic, message):
            if delay_ns <= 0:
                send(replacement)
            else:
                self.schedule(self.time_ns + delay_ns, partial(send, replacement))

    # --- what faults call ---

    @property
    def time_ns(self) -> int:
        """Time since the faults were added [ns]."""
        return self._time() - self._start_ns

    def schedule(self, time_ns: int, action: Callable[[], None]) -> None:
        """Runs an action as an event of its own, once `time_ns` has reached a time [ns]."""
        self._executor.create_alarm(self._clock, max(0, time_ns - self.time_ns), partial(self._act, time_ns, action))

    def find_topic(self, name: str) -> IntraProcessTopic | None:
        """Returns a topic on which the process publishes or receives messages, or None.

        Raises:
            ValueError: Several nodes of the process receive the topic, and none publishes it.
        """
        assert self._node is not None
        if not is_topic_name(name):
            return None
        full_name = self._node.resolve_topic_name(name)
        found = next((topic for topic in self._topics.used() if topic.name == full_name), None)
        if found is not None and not found.publisher_count and found.receiver_count > 1:
            raise ValueError(
                f"a fault on a topic that the process only receives needs one receiver, {full_name} has "
                f"{found.receiver_count} in this process: run the nodes in processes of their own"
            )
        return found

    def topic_names(self) -> list[str]:
        """Returns the full names of all topics of the process, sorted."""
        return sorted({topic.name for topic in self._topics.used()})

    def publisher(self, name: str, msg_type: type[M]) -> Publisher[M]:
        """Returns a publisher on a topic. There is one for each name."""
        if name not in self._publishers:
            assert self._node is not None
            self._publishers[name] = self._node.create_publisher(msg_type, name, QoS.DEFAULT)
        publisher: Publisher[M] = self._publishers[name]
        return publisher

    @property
    def map_server(self) -> MapFileServer:
        """The map server. Raises ValueError if the process has none."""
        return _needed(self.running_map_server, "a map server")

    def named(self, name: str | None) -> ProcessRobot:
        """Returns the robot with this name, or the first if the name is None.

        Raises:
            ValueError: The process has no such robot.
        """
        if not self.robots:
            raise ValueError("this process runs no robot and no laser")
        if name is None:
            return next(iter(self.robots.values()))
        if name not in self.robots:
            known = "the only robot has no name" if "" in self.robots else f"there are {', '.join(self.robots)}"
            raise ValueError(f"unknown robot {quoted(name)}; {known}")
        return self.robots[name]

    def _read_clock(self) -> None:
        self._time()

    def _act(self, time_ns: int, action: Callable[[], None]) -> None:
        """Runs an action, or waits on if the clock has jumped forward, which takes no time."""
        if self.time_ns < time_ns:
            self.schedule(time_ns, action)
        else:
            action()


def _needed(node: N | None, what: str) -> N:
    if node is None:
        raise ValueError(f"this process does not run {what}, so the fault cannot act on it")
    return node
