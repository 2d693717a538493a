"""RosNode: the part of the node interface that ROS 1 and ROS 2 share."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from typing import Any, ClassVar

from ..messages import Message
from ..nodes.interface import Clock, Logger, M, Node, QoS
from ..nodes.robot import MobileRobotSimulator
from ..nodes.steady_time import SteadyTime
from ..parameters import Parameters
from ..physics.world import World
from .conversion import MessageConverter
from .disturbances import Disturbances
from .either_subscription import EitherSubscription
from .event_clock import EventClock, EventTimer
from .executor import Executor
from .intra_process import IntraProcessSubscription, IntraProcessTopics
from .paced_clock import PacedClock


class RosProcess:
    """The executor, the topics, the clocks and the world that all nodes of a process share.

    Attributes:
        executor: Runs the callbacks of all nodes, one at a time.
        topics: Topics between the nodes of this process.
        disturbances: The faults, and what they act on.
        robots: Robots of this process, by name; the only robot has an empty name.
    """

    def __init__(self) -> None:
        self.executor = Executor()
        self.topics = IntraProcessTopics()
        self.disturbances = Disturbances(self.executor, self.topics)
        self.robots: dict[str, MobileRobotSimulator] = {}
        self._paced_clock: EventClock | None = None
        self._ros_clock: EventClock | None = None
        self._world: World | None = None

    @property
    def clock(self) -> EventClock:
        """The clock of the nodes. There must be a node."""
        clock = self._paced_clock or self._ros_clock
        assert clock is not None
        return clock

    def world_for(self, node: Node) -> World:
        """Returns the world in which all robots of the process move. Its time is that of the node that asks first."""
        self._world = self._world or World(SteadyTime(node.get_clock()))
        return self._world

    def clock_for(self, parameters: Parameters, ros_clock: Clock, *, use_sim_time: bool) -> EventClock:
        """Returns the clock for a new node: the paced clock of the process, or the clock of ROS of its first node.

        A node that publishes /clock uses the paced clock, because it cannot also follow /clock. Without `use_sim_time`,
        every node uses the paced clock. Once one node of the process uses it, all nodes created later use it too.

        Args:
            parameters: Parameters of the node.
            ros_clock: The node's clock of ROS.
            use_sim_time: True if the clock of ROS follows /clock.
        """
        if getattr(parameters, "publish_clock", False) or not use_sim_time:
            self._paced_clock = self._paced_clock or self.executor.follow(PacedClock())
        if self._paced_clock is not None:
            return self._paced_clock
        self._ros_clock = self._ros_clock or self.executor.follow(ros_clock)
        return self._ros_clock


class RosNode(ABC):
    """Node interface on ROS: callbacks run one at a time, and messages within the process are delivered directly.

    Args:
        process: What all nodes of the process share.
        clock: Clock of the node, from `RosProcess.clock_for`.
    """

    converter: ClassVar[MessageConverter]

    other_packages: ClassVar[tuple[str, ...]] = ()
    """Packages of services that belong to the other version of ROS: nobody misses them."""

    def __init__(self, process: RosProcess, clock: EventClock) -> None:
        self._executor, self._topics, self._disturbances = process.executor, process.topics, process.disturbances
        self._clock = clock

    def get_clock(self) -> Clock:
        """Returns the clock that message stamps are taken from."""
        return self._clock

    def set_speed(self, factor: float) -> None:
        """Sets the simulated seconds per wall second from now on. Has no effect on a node that follows the clock of ROS."""
        if isinstance(self._clock.source, PacedClock):
            self._clock.source.set_speed(factor)
            self._executor.wake()

    @abstractmethod
    def get_logger(self) -> Logger:
        """Returns the node's logger. It writes to the console and to /rosout."""

    def create_subscription(
        self, msg_type: type[M], topic: str, callback: Callable[[M], None], qos_profile: QoS
    ) -> IntraProcessSubscription:
        """Calls a callback with every message of a topic. Returns a handle for `destroy_subscription`."""
        own_topic = self._topics.topic(self.resolve_topic_name(topic), msg_type)
        disturbances = self._disturbances

        def take(message: M) -> None:
            # What this process publishes has met the faults on its way out.
            if disturbances.filters and not own_topic.publisher_count:
                disturbances.pass_on(own_topic.name, message, take_unless_ended)
            else:
                callback(message)

        def take_unless_ended(message: M) -> None:
            if subscription.is_active:
                callback(message)

        serialized = self._executor.serialized(take)

        def receive(ros_message: Any) -> None:
            serialized(self.converter.from_ros(ros_message, msg_type))

        def subscribe_through_ros() -> Callable[[], object]:
            return self._subscribe_through_ros(msg_type, topic, receive, qos_profile)

        subscription = own_topic.subscribe(qos_profile, self._executor.serialized(callback), subscribe_through_ros)
        return subscription

    def create_subscription_of_either(
        self, callbacks: Mapping[type[Message], Callable[[Any], None]], topic: str, qos_profile: QoS
    ) -> EitherSubscription:
        """Calls a callback with every message of a topic, of whichever type others publish."""
        subscription = EitherSubscription(
            self.resolve_topic_name(topic),
            callbacks,
            lambda kind, callback: self.create_subscription(kind, topic, callback, qos_profile),
            self.destroy_subscription,
            self.get_logger(),
        )
        self._topics.either.append(subscription)
        return subscription

    def destroy_subscription(self, subscription: IntraProcessSubscription | EitherSubscription) -> None:
        """Destroys a subscription."""
        if isinstance(subscription, EitherSubscription):
            self._topics.either.remove(subscription)
            subscription.destroy()
        else:
            subscription.topic.unsubscribe(subscription)

    def create_timer(self, timer_period_sec: float, callback: Callable[[], None]) -> EventTimer:
        """Calls a callback at every multiple of the period [s] on the node's clock."""
        return self._executor.create_timer(self._clock, timer_period_sec, callback)

    def create_wall_timer(self, timer_period_sec: float, callback: Callable[[], None]) -> EventTimer:
        """Calls a callback at every multiple of the period [s] of wall time."""
        return self._executor.create_timer(self._executor.wall_clock, timer_period_sec, callback)

    def destroy_timer(self, timer: EventTimer) -> None:
        """Destroys a timer."""
        self._executor.destroy_timer(timer)

    def create_service(self, srv_type: Any, srv_name: str, callback: Callable[[Any, Any], Any]) -> Any:
        """Offers a service, and returns its handle. If its type is not installed, logs that and returns None."""
        try:
            ros_type = self._find_service_type(srv_type.ros_type)
        except ImportError:
            if srv_type.ros_type.startswith(self.other_packages):
                return None
            self.get_logger().info(f"service {srv_name} is not offered, because {srv_type.ros_type} is not installed")
            return None
        serialized = self._executor.serialized(callback)

        def answer(ros_request: Any, ros_response: Any) -> Any:
            response = serialized(self.converter.from_ros(ros_request, srv_type.Request), srv_type.Response())
            return self.converter.fill(ros_response, response)

        return self._offer_service(ros_type, srv_name, answer)

    @abstractmethod
    def resolve_topic_name(self, topic: str) -> str:
        """Returns the full name of a topic, after namespaces and remapping."""

    @abstractmethod
    def resolve_service_name(self, service: str) -> str:
        """Returns the full name of a service, after namespaces and remapping."""

    @abstractmethod
    def _subscribe_through_ros(
        self, msg_type: type[M], topic: str, receive: Callable[[Any], None], qos: QoS
    ) -> Callable[[], object]:
        """Calls `receive` with every ROS message of a topic. Returns a function that ends the subscription."""

    @abstractmethod
    def _find_service_type(self, ros_type: str) -> Any:
        """Returns the class of a service in the ROS installation. Raises ImportError if it is not installed."""

    @abstractmethod
    def _offer_service(self, ros_type: Any, srv_name: str, answer: Callable[[Any, Any], Any]) -> Any:
        """Offers a service; `answer` takes the ROS request and an empty ROS response, and returns the response."""
