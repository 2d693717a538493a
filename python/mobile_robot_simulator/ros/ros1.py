"""The nodes on ROS 1, through rospy."""

from __future__ import annotations

import logging
import socket
import time
from collections.abc import Callable
from dataclasses import dataclass
from threading import Thread
from typing import Any
from urllib.parse import urlsplit

import numpy as np

from ..instant import Instant
from ..messages import Message
from ..nodes.future import Future
from ..nodes.interface import Logger, M, QoS
from ..parameters import MapParameters, Parameters, RobotParameters
from .configuration import Behaviour, behaviour_of, change, models_of, resolve, split, warn_of_unknown
from .conversion import Dialect
from .executor import Loop, Timer
from .intra_process import LocalTopics, Subscription, Topic
from .nav2_loopback_names import SYNONYMS
from .paced_clock import PacedClock

try:
    import rosgraph
    import rospy
    from rospy.numpy_msg import numpy_msg
except ImportError as error:
    raise ImportError(
        f"ROS 1 is missing ({error}): source a distribution, as in source /opt/ros/noetic/setup.bash, and install this "
        "package for its Python; docs/ros.md says how to have ROS 1 from Debian"
    ) from error

DEFAULTS: dict[type[Parameters], dict[str, Any]] = {RobotParameters: {"publish_clock": False, "clock_rate": 100.0}}
"""Where ROS 1 has other defaults: there, /clock comes from elsewhere or not at all, unless it is asked for."""

LOOKED_AT_EVERY = 1.0
"""How often the master is asked for changes of parameters and of who publishes what [s]."""

REACHED_WITHIN = 0.5
"""How long a node may take to answer before it counts as gone [s]."""


class Ros1Node:
    """The surroundings of a node on ROS 1, of which there is one in a process.

    loop: where callbacks take turns. topics: those of the process. clock: what the node goes by, if not by rospy's time.
    """

    def __init__(self, loop: Loop, topics: LocalTopics, clock: PacedClock | None = None) -> None:
        self._loop, self._topics, self._clock = loop, topics, clock

    def get_clock(self) -> PacedClock | _RosClock:
        """The clock that stamps are taken from."""
        return self._clock or _RosClock()

    def set_speed(self, factor: float) -> None:
        """Have the clock go so many times as fast as the wall's."""
        if self._clock is not None:
            self._clock.set_speed(factor)
            self._loop.notify()

    def get_logger(self) -> Logger:
        """Where notes go: to the console and to /rosout."""
        return logging.getLogger("rosout")

    def create_publisher(self, msg_type: type[M], topic: str, qos_profile: QoS) -> _Publisher:
        """A publisher to a topic."""
        kind = ROS1.find_message(msg_type.ros_type)
        is_latched = qos_profile is QoS.LATCHED
        publisher = rospy.Publisher(topic, kind, queue_size=10, latch=is_latched)
        return _Publisher(kind(), publisher, self._topics.advertise(publisher.resolved_name, msg_type), is_latched)

    def create_subscription(
        self, msg_type: type[M], topic: str, callback: Callable[[M], None], qos_profile: QoS
    ) -> Subscription:
        """Have every message of a topic handed to the callback."""
        take = self._loop.in_turn(callback)

        def receive(message: Any) -> None:
            take(ROS1.from_ros(message, msg_type))

        def listen() -> Callable[[], object]:
            kind = ROS1.find_message(msg_type.ros_type)
            subscriber = rospy.Subscriber(topic, kind, receive, queue_size=100, buff_size=2**24, tcp_nodelay=True)
            unregister: Callable[[], object] = subscriber.unregister
            return unregister

        return self._topics.topic(rospy.resolve_name(topic), msg_type).subscribe(qos_profile, take, listen)

    def create_timer(self, timer_period_sec: float, callback: Callable[[], None]) -> Timer:
        """Have the callback called once a period of the node's clock."""
        return self._loop.create_timer(self.get_clock(), timer_period_sec, callback)

    def create_service(self, srv_type: Any, srv_name: str, callback: Callable[[Any, Any], Any]) -> Any:
        """Answer requests; None, with a note, where the service's type is not installed."""
        try:
            kind = _service(srv_type.ros_type)
        except ImportError:
            self.get_logger().info(f"no service {srv_name}: {srv_type.ros_type} is not installed")
            return None
        handle = self._loop.in_turn(callback)

        def answer(request: Any) -> Any:
            return ROS1.to_ros(handle(ROS1.from_ros(request, srv_type.Request), srv_type.Response()), kind._response_class)

        return rospy.Service(srv_name, kind, answer)

    def create_client(self, srv_type: Any, srv_name: str) -> _Client:
        """A client of a service."""
        return _Client(srv_type, rospy.ServiceProxy(srv_name, _service(srv_type.ros_type)), self._loop)

    def destroy_publisher(self, publisher: _Publisher) -> None:
        """Take a publisher away."""
        publisher.topic.publishers -= 1
        publisher.publisher.unregister()

    def destroy_subscription(self, subscription: Subscription) -> None:
        """Take a subscription away."""
        subscription.topic.unsubscribe(subscription)

    def destroy_timer(self, timer: Timer) -> None:
        """Take a timer away."""
        self._loop.destroy_timer(timer)

    def destroy_service(self, service: Any) -> None:
        """Take a service away."""
        if service is not None:
            service.shutdown("taken away")

    def destroy_client(self, client: _Client) -> None:
        """Take a client away."""
        client.proxy.close()


class _RosClock:
    """The time of rospy, which follows /clock with use_sim_time."""

    def now(self) -> Instant:
        return Instant(rospy.get_rostime().to_nsec())


# --- Messages ---


class _Block(np.ndarray[Any, Any]):
    """An array that rospy can send: the name that its messages have for `tobytes` is gone from NumPy."""

    tostring = np.ndarray.tobytes


ROS1 = Dialect(lambda values, _: np.ascontiguousarray(values).view(_Block), "secs", "nsecs", numpy_msg)


def _service(ros_type: str) -> Any:
    """The installation's service, whose messages hold arrays as NumPy's."""
    kind = ROS1.find(ros_type)
    blocks = {name: numpy_msg(getattr(kind, name)) for name in ("_request_class", "_response_class")}
    return type(kind.__name__, (kind,), blocks)


@dataclass
class _Publisher:
    """message: what is sent each time, filled anew."""

    message: Any
    publisher: Any
    topic: Topic
    is_latched: bool

    def publish(self, message: Message) -> None:
        self.topic.hand(message)
        try:
            if self.is_latched or self.publisher.get_num_connections() > 0:
                self.publisher.publish(ROS1.fill(self.message, message))
        except rospy.ROSException:
            # The node is being shut down.
            if not rospy.is_shutdown():
                raise


@dataclass
class _Client:
    srv_type: Any
    proxy: Any
    loop: Loop

    def service_is_ready(self) -> bool:
        try:
            rosgraph.Master(rospy.get_name()).lookupService(self.proxy.resolved_name)
        except (rosgraph.MasterException, OSError):
            return False
        return True

    def call_async(self, request: Message) -> Future:
        """Ask from a thread of its own; if nobody answers after all, the answer never comes."""
        future = Future()
        answer = self.loop.in_turn(future.set_result)

        def call() -> None:
            try:
                response = self.proxy(ROS1.to_ros(request, self.proxy.request_class))
            except (rospy.ServiceException, rospy.ROSException, OSError) as error:
                rospy.logwarn(f"no answer from {self.proxy.resolved_name}: {error}")
            else:
                answer(ROS1.from_ros(response, self.srv_type.Response))

        Thread(target=call, daemon=True).start()
        return future


# --- Running ---


def run(name: str, arguments: list[str]) -> None:
    """Run a node, or `all` of them as one, until Ctrl-C.

    arguments: a map's YAML file, where there is a map to serve, and what ROS 1 takes: _name:=value, from:=to, __name:=name.
    raises: ValueError for arguments and parameters that cannot be.
    """
    map_file, ros_arguments = split(name, arguments, lambda argument: ":=" in argument)
    models = models_of(name)
    if not rosgraph.is_master_online():
        raise OSError(f"no ROS master at {rosgraph.get_master_uri()}: start roscore first")
    own_name = models[0].node_name if len(models) == 1 else "mobile_robot_simulator"
    rospy.init_node(own_name, argv=["mobile-robot-simulator", *ros_arguments], disable_signals=True)
    loop, topics = Loop(), LocalTopics()
    try:
        given = _given()
        warn_of_unknown(given, logging.getLogger("rosout"))
        announced: set[str] = set()
        clock: PacedClock | None = None
        behaviours = []
        for model in models:
            own = {**given, "yaml_filename": map_file} if map_file else given
            values = {**DEFAULTS.get(model, {}), **resolve(model, own, logging.getLogger("rosout"), announced)}
            if model is MapParameters and "yaml_filename" not in values:
                if name == "all":
                    continue
                raise ValueError("map needs a map: give MAP.yaml, or the parameter _yaml_filename")
            parameters = model.checked(values)
            if getattr(parameters, "publish_clock", False) or not rospy.get_param("/use_sim_time", False):
                clock = clock or PacedClock()
            behaviours.append(loop.in_turn(behaviour_of)(parameters, Ros1Node(loop, topics, clock)))
        for behaviour in behaviours:
            loop.in_turn(behaviour.start)()
        _Watch(behaviours, given, loop, topics)
        rospy.on_shutdown(loop.end)
        loop.wait()
    except KeyboardInterrupt:
        pass
    finally:
        rospy.signal_shutdown("done")


def _given() -> dict[str, Any]:
    """The node's private parameters on the parameter server."""
    found = rospy.get_param("~", {})
    return dict(found) if isinstance(found, dict) else {}


def _runs(node: str) -> bool:
    """Whether a node can be reached; the master knows on of those that were killed."""
    try:
        uri = urlsplit(rosgraph.Master(rospy.get_name()).lookupNode(node))
        socket.create_connection((uri.hostname, uri.port), REACHED_WITHIN).close()
    except (OSError, rosgraph.MasterException):
        return False
    return True


class _Watch:
    """Notices parameters that change on the server, where those that are refused are set back, and who else publishes."""

    def __init__(self, behaviours: list[Behaviour], given: dict[str, Any], loop: Loop, topics: LocalTopics) -> None:
        self._behaviours, self._seen, self._loop, self._topics = behaviours, given, loop, topics
        Thread(target=self._run, name="master", daemon=True).start()

    def _run(self) -> None:
        while not rospy.is_shutdown():
            time.sleep(LOOKED_AT_EVERY)
            try:
                self._look_for_publishers()
                self._look_for_parameters()
            except (OSError, rosgraph.MasterException):
                # The master is away, and nothing changes meanwhile.
                continue

    def _look_for_publishers(self) -> None:
        published, _, _ = rosgraph.Master(rospy.get_name()).getSystemState()
        names = self._topics.names
        others = {topic: set(nodes) - {rospy.get_name()} for topic, nodes in published if topic in names}
        shared = {topic for topic, nodes in others.items() if any(map(_runs, nodes))}
        self._loop.in_turn(self._topics.look)(lambda topic: topic.name in shared)

    def _look_for_parameters(self) -> None:
        given = _given()
        changed = {name: value for name, value in given.items() if self._seen.get(name, _UNSEEN) != value}
        if changed:
            logger = logging.getLogger("rosout")
            warn_of_unknown(changed, logger)
            for name, value in changed.items():
                for behaviour in self._behaviours:
                    if name in SYNONYMS or name in type(behaviour.parameters).model_fields:
                        self._loop.in_turn(self._take)(behaviour, name, value, logger)
            given = _given()
        self._seen = given

    @staticmethod
    def _take(behaviour: Behaviour, name: str, value: Any, logger: Logger) -> None:
        try:
            change(behaviour, {name: value})
        except (ValueError, TypeError, OSError) as error:
            logger.warning(f"change of a parameter refused: {error}")
            if name in type(behaviour.parameters).model_fields:
                rospy.set_param(f"~{name}", getattr(behaviour.parameters, name))


_UNSEEN = object()
