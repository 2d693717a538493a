"""Runs the nodes on ROS 2, through rclpy."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from threading import Thread
from typing import Any

from ..messages import Message
from ..nodes.future import Future
from ..nodes.interface import Logger, M, QoS
from ..parameter_files import is_for_ros
from ..parameters import LaserParameters, Parameters, RobotParameters, WorldParameters
from ..quoting import shortened
from .configuration import (
    ONLY_ALL,
    Behaviour,
    Fleet,
    ParameterResolver,
    change_parameters,
    check_options_follow,
    create_behaviour,
    faults_in,
    models_of,
    split_arguments,
    warn_about_scanners,
    warn_about_unknown,
)
from .conversion import MessageConverter
from .disturbances import Disturbances, ReadFaults
from .event_clock import EventClock
from .executor import Executor
from .intra_process import IntraProcessTopic
from .node import RosNode, RosProcess
from .publisher import RosPublisher

try:
    import rclpy
    from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
    from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
    from rclpy.parameter import Parameter
    from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
    from rclpy.signals import SignalHandlerOptions
except ImportError as error:
    raise ImportError(
        f"ROS 2 is missing ({error}): source a ROS 2 installation, for example with `source /opt/ros/jazzy/setup.bash`, "
        "and install this package for its Python; docs/guides/ros.md explains how to install ROS 2 from PyPI"
    ) from error

DEFAULTS: dict[type[Parameters], dict[str, Any]] = {RobotParameters: {"cmd_vel_stamped": True, "clock_rate": 100.0}}
"""Defaults that differ on ROS 2."""

MARKER = "--ros-args"
"""Argument that begins the arguments for ROS 2."""

FORM = f"{MARKER} -p NAME:=VALUE -r FROM:=TO"
"""What ROS 2 arguments look like."""

OPTIONS = ("-p", "--param", "-r", "--remap", "--params-file", "-e", "--enclave", "--log-level")
"""Options that ROS 2 reads after `MARKER` only."""

POLL_PERIOD = 0.2
"""Seconds between checks for other publishers."""

ALTERNATIVE_SERVICES = {"robot_localization/srv/SetPose": "nav2_msgs/srv/SetInitialPose"}
"""For a service type that may not be installed: a type with the same fields."""


def _pack_array(values: Any, present: Any) -> Any:
    return array(present.typecode, values.tobytes()) if isinstance(present, array) else values


ROS2 = MessageConverter(_pack_array)


class Ros2Node(RosNode):
    """The node interface on ROS 2.

    Args:
        node: The rclpy node.
        process: What all nodes of the process share.
        clock: Clock of the node.
    """

    converter = ROS2
    other_packages = ("gazebo_msgs/",)

    def __init__(self, node: Any, process: RosProcess, clock: EventClock) -> None:
        super().__init__(process, clock)
        self._node = node

    def get_logger(self) -> Logger:
        """Returns the node's logger. It writes to the console and to /rosout."""
        logger: Logger = self._node.get_logger()
        return logger

    def create_publisher(self, msg_type: type[M], topic: str, qos_profile: QoS) -> _Publisher:
        """Creates a publisher of messages of one type."""
        ros_class = ROS2.find_message_type(msg_type.ros_type)
        with _refusals_as_type_errors(topic, msg_type):
            publisher = self._node.create_publisher(ros_class, topic, _offered_qos(qos_profile))
        own_topic = self._topics.advertise(publisher.topic_name, msg_type)
        is_latched = qos_profile is QoS.LATCHED
        return _Publisher(ros_class(), publisher, own_topic, self._disturbances, is_latched=is_latched)

    def destroy_publisher(self, publisher: _Publisher) -> None:
        """Destroys a publisher."""
        publisher.retire()
        self._node.destroy_publisher(publisher.publisher)

    def destroy_service(self, service: Any) -> None:
        """Stops offering a service."""
        if service is not None:
            self._node.destroy_service(service)

    def create_client(self, srv_type: Any, srv_name: str) -> _Client:
        """Creates a client of a service."""
        client = self._node.create_client(self._find_service_type(srv_type.ros_type), srv_name)
        return _Client(srv_type, client, self._executor)

    def destroy_client(self, client: _Client) -> None:
        """Destroys a client."""
        self._node.destroy_client(client.client)

    def resolve_topic_name(self, topic: str) -> str:
        """Returns the full name of a topic, after namespaces and remapping."""
        return str(self._node.resolve_topic_name(topic))

    def resolve_service_name(self, service: str) -> str:
        """Returns the full name of a service, after namespaces and remapping."""
        return str(self._node.resolve_service_name(service))

    def _subscribe_through_ros(
        self, msg_type: type[M], topic: str, receive: Callable[[Any], None], qos: QoS
    ) -> Callable[[], object]:
        ros_class = ROS2.find_message_type(msg_type.ros_type)
        with _refusals_as_type_errors(topic, msg_type):
            subscription = self._node.create_subscription(ros_class, topic, receive, _requested_qos(qos))
        return partial(self._node.destroy_subscription, subscription)

    def _find_service_type(self, ros_type: str) -> Any:
        try:
            return ROS2.find_type(ros_type)
        except ImportError:
            if ros_type not in ALTERNATIVE_SERVICES:
                raise
            return ROS2.find_type(ALTERNATIVE_SERVICES[ros_type])

    def _offer_service(self, ros_type: Any, srv_name: str, answer: Callable[[Any, Any], Any]) -> Any:
        return self._node.create_service(ros_type, srv_name, answer)


@contextmanager
def _refusals_as_type_errors(topic: str, msg_type: type[Message]) -> Iterator[None]:
    """Raises TypeError where rclpy refuses a topic, for example because it has messages of another type in this process."""
    try:
        yield
    except RuntimeError as error:
        raise TypeError(f"topic {shortened(topic)} cannot have messages of type {msg_type.ros_type}: {error}") from None


def _offered_qos(qos: QoS) -> QoSProfile:
    """Returns the profile of a publisher. It is reliable, so reliable and best-effort subscriptions are both compatible."""
    return QoSProfile(
        depth=1 if qos in (QoS.LATCHED, QoS.CLOCK) else 10,
        reliability=ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if qos is QoS.LATCHED else DurabilityPolicy.VOLATILE,
    )


def _requested_qos(qos: QoS) -> QoSProfile:
    """Returns the profile of a subscription. Where losses are harmless, it also receives from best-effort publishers."""
    return QoSProfile(
        depth=1 if qos is QoS.CLOCK else 100,
        reliability=ReliabilityPolicy.BEST_EFFORT if qos in (QoS.SENSOR_DATA, QoS.CLOCK) else ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if qos is QoS.LATCHED else DurabilityPolicy.VOLATILE,
    )


class _Publisher(RosPublisher):
    """Publishes messages by filling one ROS message, `message`, again each time."""

    def __init__(
        self, message: Any, publisher: Any, topic: IntraProcessTopic, disturbances: Disturbances, *, is_latched: bool
    ) -> None:
        super().__init__(topic, disturbances, is_latched=is_latched)
        self.message, self.publisher = message, publisher

    def _send_through_ros(self, message: Message) -> None:
        if self.is_latched or self.publisher.get_subscription_count() > 0:
            self.publisher.publish(ROS2.fill(self.message, message))


class _Client:
    def __init__(self, srv_type: Any, client: Any, executor: Executor) -> None:
        self.srv_type, self.client, self.executor = srv_type, client, executor

    def service_is_ready(self) -> bool:
        return bool(self.client.service_is_ready())

    def call_async(self, request: Message) -> Future:
        future = Future()

        def end(ros_future: Any) -> None:
            error = ros_future.exception()
            if error is None:
                future.set_result(ROS2.from_ros(ros_future.result(), self.srv_type.Response))
            else:
                future.set_exception(error)

        ros_future = self.client.call_async(ROS2.to_ros(request, self.client.srv_type.Request))
        ros_future.add_done_callback(self.executor.serialized(end))
        return future


def run(name: str, arguments: list[str], read_faults: ReadFaults) -> None:
    """Runs a node, or all nodes in one process, until SIGINT (Ctrl-C) or SIGTERM.

    Args:
        name: `robot`, `laser`, `map` or `all`.
        arguments: A map file for `map` and `all`, then `--ros-args` and the ROS 2 arguments that may follow it.
        read_faults: Reads the faults in the parameter `faults`, and adds those of the command line.

    Raises:
        ValueError: An argument, a parameter or a fault is invalid.
        OSError: The map file cannot be read.
    """
    check_options_follow(MARKER, OPTIONS, arguments)
    map_file, ros_arguments = split_arguments(name, arguments, lambda argument: argument == MARKER, FORM)
    try:
        rclpy.init(args=["mobile-robot-simulator", *ros_arguments], signal_handler_options=SignalHandlerOptions.NO)
    except RuntimeError as error:
        raise ValueError(f"ROS 2 rejected its arguments: {error}") from None
    context = rclpy.get_default_context()
    process, resolver = RosProcess(), ParameterResolver(name, DEFAULTS, map_file)
    nodes, spinning = list[Any](), list[_SpinningNode]()
    try:
        with process.executor.until_signalled():
            fleet, ready = Fleet({}), list[tuple[Any, Parameters, str]]()
            # The world comes first, because its parameters name the robots, and starts last.
            for model in sorted(models_of(name), key=lambda model: model is not WorldParameters):
                for robot, scanner in fleet.owners_of(model):
                    node = _create_node(model, robot, nodes[0].get_namespace() if nodes else "/", scanner)
                    nodes.append(node)
                    if model is WorldParameters:
                        fleet = Fleet(_given_to(node))
                    elif name != "all" and "robots" in _given_to(node):
                        node.get_logger().warning(ONLY_ALL)
                    resolve = nodes[0].resolve_topic_name
                    parameters = _declare_parameters(node, model, resolver, fleet, robot, scanner, resolve)
                    if parameters is None:
                        nodes.pop().destroy_node()
                    else:
                        fleet.add(robot, parameters)
                        ready.append((node, parameters, robot))
            faults = read_faults(faults_in(_given_to(nodes[0])))
            starting = sorted(ready, key=lambda item: isinstance(item[1], WorldParameters))
            # In one event, so that no timer fires before the faults act.
            with process.executor.event():
                for node, parameters, robot in starting:
                    _start_behaviour(node, parameters, process, robot, fleet)
                if faults:
                    process.disturbances.add(faults, Ros2Node(nodes[0], process, process.clock), process.clock)
            spinning += [_SpinningNode(node, process.executor) for node, _, _ in starting]
            first = spinning[0].node
            check_publishers = partial(
                process.topics.update, partial(_has_other_publishers, first), partial(_published_types, first)
            )
            process.executor.create_timer(process.executor.wall_clock, POLL_PERIOD, check_publishers)
            process.executor.wait()
    finally:
        rclpy.try_shutdown()
        for each in spinning:
            each.join()
        for node in nodes:
            node.destroy_node()
        context.destroy()


def _create_node(model: type[Parameters], robot: str, outside: str, scanner: str) -> Any:
    """Creates the rclpy node of a behaviour, in the namespace of its robot if that has a name.

    Args:
        model: Parameter class of the node.
        robot: Name of the robot.
        outside: Namespace of the nodes that belong to no robot.
        scanner: Name of the scanner, for the node of one of several.
    """
    # A namespace on the command line would replace the argument `namespace` of the node, but not its own remapping.
    own = ["--ros-args", "-r", f"__ns:={outside.rstrip('/')}/{robot}"] if robot else None
    name = f"{scanner}_{model.node_name}" if scanner else model.node_name
    return rclpy.create_node(name, cli_args=own, automatically_declare_parameters_from_overrides=True)


def _given_to(node: Any) -> dict[str, Any]:
    """Returns the parameters that were given on the command line or in a file, which rclpy has already declared."""
    return {name: parameter.value for name, parameter in node.get_parameters_by_prefix("").items()}


def _declare_parameters(
    node: Any,
    model: type[Parameters],
    resolver: ParameterResolver,
    fleet: Fleet,
    robot: str,
    scanner: str,
    resolve: Callable[[str], str],
) -> Parameters | None:
    """Declares the parameters of a node and returns them. Returns None if `ParameterResolver.resolve` does.

    Those that rclpy has already declared are set to their checked values.
    """
    given = _given_to(node)
    from_user = [name for name in given if not is_for_ros(name)]
    warn_about_unknown(from_user, node.get_logger(), fleet)
    if model is LaserParameters:
        warn_about_scanners(from_user, node.get_logger(), fleet)
    parameters = resolver.resolve(model, fleet.given_to(robot, given, resolve, scanner), node.get_logger())
    if parameters is None:
        return None
    for name, info in model.model_fields.items():
        value = getattr(parameters, name)
        # Dynamic typing, because the parameter classes check types themselves. They accept 30 for 30.0.
        descriptor = ParameterDescriptor(name=name, description=info.description or "", dynamic_typing=True)
        if name in given:
            node.set_descriptor(name, descriptor)
            node.set_parameters([Parameter(name, value=value)])
        else:
            node.declare_parameter(name, value, descriptor)
    return parameters


def _start_behaviour(node: Any, parameters: Parameters, process: RosProcess, robot: str, fleet: Fleet) -> None:
    clock = process.clock_for(parameters, node.get_clock(), use_sim_time=node.get_parameter("use_sim_time").value)
    behaviour = create_behaviour(parameters, Ros2Node(node, process, clock), process, robot)
    node.add_on_set_parameters_callback(process.executor.serialized(partial(_change_parameters, behaviour, robot, fleet)))
    behaviour.start()


def _change_parameters(behaviour: Behaviour, robot: str, fleet: Fleet, changes: list[Any]) -> Any:
    try:
        for parameter in changes:
            fleet.check_change(parameter.name, robot, type(behaviour.parameters).model_fields)
    except ValueError as error:
        return SetParametersResult(successful=False, reason=str(error))
    refusal = change_parameters(behaviour, {parameter.name: parameter.value for parameter in changes})
    return SetParametersResult(successful=refusal is None, reason=refusal or "")


def _has_other_publishers(node: Any, topic: IntraProcessTopic) -> bool:
    return bool(node.count_publishers(topic.name) > topic.publisher_count)


def _published_types(node: Any, topic: str) -> set[str]:
    return {publisher.topic_type for publisher in node.get_publishers_info_by_topic(topic)}


class _SpinningNode:
    """A node and the thread that receives its messages.

    Each node has its own rclpy executor, because the work per message of an rclpy executor grows with its number of
    subscriptions, timers and services.
    """

    def __init__(self, node: Any, executor: Executor) -> None:
        self.node, self._executor = node, executor
        self._thread = Thread(target=self._spin, name=node.get_name(), daemon=True)
        self._thread.start()

    def join(self) -> None:
        """Waits until the thread has ended, at most 1 s."""
        self._thread.join(1.0)

    def _spin(self) -> None:
        ros_executor = SingleThreadedExecutor()
        try:
            ros_executor.add_node(self.node)
            ros_executor.spin()
        except ExternalShutdownException:
            self._executor.shutdown()
        except BaseException as error:
            # During a shutdown, rclpy can fail with any exception.
            self._executor.shutdown(error if rclpy.ok() else None)
        finally:
            ros_executor.shutdown()
