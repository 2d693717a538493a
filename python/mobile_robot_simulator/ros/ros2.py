"""The nodes on ROS 2, through rclpy."""

from __future__ import annotations

from array import array
from collections.abc import Callable
from functools import partial
from threading import Thread
from typing import Any

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
    import rclpy
    from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
    from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
    from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
    from rclpy.signals import SignalHandlerOptions
except ImportError as error:
    raise ImportError(
        f"ROS 2 is missing ({error}): source a distribution, as in source /opt/ros/jazzy/setup.bash, and install this "
        "package for its Python; docs/ros.md says how to have ROS 2 from PyPI"
    ) from error

DEFAULTS: dict[type[Parameters], dict[str, Any]] = {RobotParameters: {"cmd_vel_stamped": True, "clock_rate": 100.0}}
"""Where ROS 2 has other defaults."""

LOOKED_AT_EVERY = 0.2
"""How often it is looked at who publishes what [s]."""

ALIASES = {"robot_localization/srv/SetPose": "nav2_msgs/srv/SetInitialPose"}
"""Services of the same fields, for where the first is not installed."""


class Ros2Node:
    """The surroundings of a node on ROS 2.

    loop: where callbacks take turns. topics: those of the process. clock: what the node goes by, if not by the clock of its
    ROS node.
    """

    def __init__(self, node: Any, loop: Loop, topics: LocalTopics, clock: PacedClock | None = None) -> None:
        self._node, self._loop, self._topics, self._clock = node, loop, topics, clock

    def get_clock(self) -> Any:
        """The clock that stamps are taken from."""
        return self._clock or self._node.get_clock()

    def set_speed(self, factor: float) -> None:
        """Have the clock go so many times as fast as the wall's."""
        if self._clock is not None:
            self._clock.set_speed(factor)
            self._loop.notify()

    def get_logger(self) -> Logger:
        """Where notes go: to the console and to /rosout."""
        logger: Logger = self._node.get_logger()
        return logger

    def create_publisher(self, msg_type: type[M], topic: str, qos_profile: QoS) -> _Publisher:
        """A publisher to a topic."""
        kind = ROS2.find(msg_type.ros_type)
        publisher = self._node.create_publisher(kind, topic, _offered(qos_profile))
        own = self._topics.advertise(publisher.topic_name, msg_type)
        return _Publisher(kind(), publisher, own, is_latched=qos_profile is QoS.LATCHED)

    def create_subscription(
        self, msg_type: type[M], topic: str, callback: Callable[[M], None], qos_profile: QoS
    ) -> Subscription:
        """Have every message of a topic handed to the callback."""
        kind, take = ROS2.find(msg_type.ros_type), self._loop.in_turn(callback)

        def receive(message: Any) -> None:
            take(ROS2.from_ros(message, msg_type))

        def listen() -> Callable[[], object]:
            subscription = self._node.create_subscription(kind, topic, receive, _requested(qos_profile))
            return partial(self._node.destroy_subscription, subscription)

        return self._topics.topic(self._node.resolve_topic_name(topic), msg_type).subscribe(qos_profile, take, listen)

    def create_timer(self, timer_period_sec: float, callback: Callable[[], None]) -> Timer:
        """Have the callback called once a period of the node's clock."""
        return self._loop.create_timer(self.get_clock(), timer_period_sec, callback)

    def create_service(self, srv_type: Any, srv_name: str, callback: Callable[[Any, Any], Any]) -> Any:
        """Answer requests; None, with a note, where the service's type is not installed."""
        kind, handle = self._find_service(srv_type), self._loop.in_turn(callback)
        if kind is None:
            self.get_logger().info(f"no service {srv_name}: {srv_type.ros_type} is not installed")
            return None

        def answer(request: Any, response: Any) -> Any:
            return ROS2.fill(response, handle(ROS2.from_ros(request, srv_type.Request), srv_type.Response()))

        return self._node.create_service(kind, srv_name, answer)

    def create_client(self, srv_type: Any, srv_name: str) -> _Client:
        """A client of a service."""
        return _Client(srv_type, self._node.create_client(self._find_service(srv_type), srv_name), self._loop)

    def destroy_publisher(self, publisher: _Publisher) -> None:
        """Take a publisher away."""
        publisher.topic.publishers -= 1
        self._node.destroy_publisher(publisher.publisher)

    def destroy_subscription(self, subscription: Subscription) -> None:
        """Take a subscription away."""
        subscription.topic.unsubscribe(subscription)

    def destroy_timer(self, timer: Timer) -> None:
        """Take a timer away."""
        self._loop.destroy_timer(timer)

    def destroy_service(self, service: Any) -> None:
        """Take a service away."""
        if service is not None:
            self._node.destroy_service(service)

    def destroy_client(self, client: _Client) -> None:
        """Take a client away."""
        self._node.destroy_client(client.client)

    @staticmethod
    def _find_service(srv_type: Any) -> Any:
        for name in (srv_type.ros_type, ALIASES.get(srv_type.ros_type)):
            try:
                return name and ROS2.find(name)
            except ImportError:
                continue
        return None


# --- Messages ---


def _pack(values: Any, present: Any) -> Any:
    return array(present.typecode, values.tobytes()) if isinstance(present, array) else values


ROS2 = Dialect(_pack)


def _offered(qos: QoS) -> QoSProfile:
    """All that can be, so that every subscriber matches."""
    return QoSProfile(
        depth=1 if qos in (QoS.LATCHED, QoS.CLOCK) else 10,
        reliability=ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if qos is QoS.LATCHED else DurabilityPolicy.VOLATILE,
    )


def _requested(qos: QoS) -> QoSProfile:
    """No more than is needed, so that every publisher matches."""
    return QoSProfile(
        depth=1 if qos is QoS.CLOCK else 100,
        reliability=ReliabilityPolicy.BEST_EFFORT if qos in (QoS.SENSOR_DATA, QoS.CLOCK) else ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if qos is QoS.LATCHED else DurabilityPolicy.VOLATILE,
    )


class _Publisher:
    """message: what is sent each time, filled anew."""

    def __init__(self, message: Any, publisher: Any, topic: Topic, *, is_latched: bool) -> None:
        self.message, self.publisher, self.topic, self.is_latched = message, publisher, topic, is_latched

    def publish(self, message: Message) -> None:
        self.topic.hand(message)
        if self.is_latched or self.publisher.get_subscription_count() > 0:
            self.publisher.publish(ROS2.fill(self.message, message))


class _Client:
    def __init__(self, srv_type: Any, client: Any, loop: Loop) -> None:
        self.srv_type, self.client, self.loop = srv_type, client, loop

    def service_is_ready(self) -> bool:
        return bool(self.client.service_is_ready())

    def call_async(self, request: Message) -> Future:
        future = Future()

        def take(answered: Any) -> None:
            future.set_result(ROS2.from_ros(answered.result(), self.srv_type.Response))

        answer = self.client.call_async(ROS2.to_ros(request, self.client.srv_type.Request))
        answer.add_done_callback(self.loop.in_turn(take))
        return future


# --- Running ---


def run(name: str, arguments: list[str]) -> None:
    """Run a node, or `all`, until Ctrl-C.

    arguments: a map's YAML file, where there is a map to serve, and `--ros-args` with what ROS 2 takes after it.
    raises: ValueError for arguments and parameters that cannot be.
    """
    map_file, ros_arguments = split(name, arguments, lambda argument: argument == "--ros-args")
    try:
        rclpy.init(args=["mobile-robot-simulator", *ros_arguments], signal_handler_options=SignalHandlerOptions.NO)
    except RuntimeError as error:
        raise ValueError(f"ROS 2 refuses its arguments: {error}") from None
    context = rclpy.get_default_context()
    loop, topics, nodes, threads = Loop(), LocalTopics(), list[Any](), list[Thread]()
    try:
        clock: PacedClock | None = None
        announced: set[str] = set()
        for model in models_of(name):
            node, parameters = _node(model, {"yaml_filename": map_file} if map_file else {}, announced)
            if parameters is None:
                if name == "all":
                    continue
                raise ValueError("map needs a map: give MAP.yaml, or the parameter yaml_filename")
            if getattr(parameters, "publish_clock", False) or not node.get_parameter("use_sim_time").value:
                clock = clock or PacedClock()
            _start(node, parameters, Ros2Node(node, loop, topics, clock), loop)
            nodes.append(node)
            threads.append(Thread(target=_spin, args=(node, loop), name=model.node_name, daemon=True))
            threads[-1].start()
        loop.create_timer(PacedClock(), LOOKED_AT_EVERY, partial(topics.look, partial(_is_shared, nodes[0])))
        loop.wait()
    except KeyboardInterrupt:
        pass
    finally:
        rclpy.try_shutdown()
        for thread in threads:
            thread.join(1.0)
        for node in nodes:
            node.destroy_node()
        context.destroy()


def _spin(node: Any, loop: Loop) -> None:
    """Take in what comes for a node; each has an executor, whose work at every message grows with what is in it."""
    executor = SingleThreadedExecutor()
    try:
        executor.add_node(node)
        executor.spin()
    except ExternalShutdownException:
        loop.end()
    except BaseException as error:
        # What rclpy is in the middle of when it is shut down may fail in any way.
        loop.end(error if rclpy.ok() else None)
    finally:
        executor.shutdown()


def _node(model: type[Parameters], given: dict[str, Any], announced: set[str]) -> tuple[Any, Parameters | None]:
    """A ROS node with its parameters declared; no parameters for a map server that has no map.

    given: values that go before those given the ROS way.
    """
    node = rclpy.create_node(model.node_name, automatically_declare_parameters_from_overrides=True)
    overrides = {name: parameter.value for name, parameter in node.get_parameters_by_prefix("").items()}
    own = {"use_sim_time", "start_type_description_service"}
    foreign = [name for name in overrides if name not in own and not name.startswith("qos_overrides.")]
    warn_of_unknown(foreign, node.get_logger())
    values = {**DEFAULTS.get(model, {}), **resolve(model, {**overrides, **given}, node.get_logger(), announced)}
    if model is MapParameters and "yaml_filename" not in values:
        return node, None
    parameters = model.checked(values)
    for name, info in model.model_fields.items():
        if name in overrides:
            node.undeclare_parameter(name)
        # Types are checked with all else that is: 30 is as good as 30.0.
        descriptor = ParameterDescriptor(name=name, description=info.description or "", dynamic_typing=True)
        node.declare_parameter(name, getattr(parameters, name), descriptor, ignore_override=True)
    return node, parameters


def _is_shared(node: Any, topic: Topic) -> bool:
    return bool(node.count_publishers(topic.name) > topic.publishers)


def _start(node: Any, parameters: Parameters, surroundings: Ros2Node, loop: Loop) -> None:
    def start() -> None:
        behaviour = behaviour_of(parameters, surroundings)
        node.add_on_set_parameters_callback(loop.in_turn(lambda changes: _change(behaviour, changes)))
        behaviour.start()

    loop.in_turn(start)()


def _change(behaviour: Behaviour, changes: Any) -> Any:
    known = (*type(behaviour.parameters).model_fields, *SYNONYMS)
    try:
        change(behaviour, {item.name: item.value for item in changes if item.name in known})
    except (ValueError, TypeError, OSError) as error:
        return SetParametersResult(successful=False, reason=str(error))
    return SetParametersResult(successful=True)
