"""Runs the nodes on ROS 1, through rospy."""

from __future__ import annotations

import logging
import socket
import time
import xmlrpc.client
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from http.client import HTTPException
from threading import Thread
from typing import Any
from urllib.parse import urlsplit

import numpy as np

from ..instant import Instant
from ..messages import Message
from ..nav2_loopback_names import SYNONYMS
from ..nodes.future import Future
from ..nodes.interface import Logger, M, QoS
from ..parameters import Parameters, RobotParameters
from ..scanners import DERIVED as DERIVED_OF_SCANNERS
from ..scanners import split
from .configuration import (
    DERIVED,
    ONLY_ALL,
    Behaviour,
    Fleet,
    ParameterResolver,
    change_everywhere,
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
    import rosgraph
    import rospy
    from rospy.numpy_msg import numpy_msg
except ImportError as error:
    raise ImportError(
        f"ROS 1 is missing ({error}): source the setup.bash of a ROS 1 installation and install this package for its Python "
        "(CPython 3.10 or later); docs/guides/ros.md explains how to install ROS 1 from Debian"
    ) from error

DEFAULTS: dict[type[Parameters], dict[str, Any]] = {
    RobotParameters: {"publish_clock": False, "clock_rate": 100.0, "cmd_vel_stamped": False}
}
"""Defaults that differ on ROS 1. There, /clock usually does not exist, or another node publishes it; commands are Twists."""

POLL_PERIOD = 1.0
"""Seconds between two queries to the master for changed parameters and for other publishers."""

CONNECTION_TIMEOUT = 0.5
"""Seconds after which a node that does not accept a connection counts as gone."""


class _NumpyBlock(np.ndarray[Any, Any]):
    """An array that rospy can serialize. rospy calls `tostring`, which NumPy has renamed to `tobytes`."""

    tostring = np.ndarray.tobytes


ROS1 = MessageConverter(lambda array, _: np.ascontiguousarray(array).view(_NumpyBlock), "secs", "nsecs", numpy_msg)


class Ros1Node(RosNode):
    """The node interface on ROS 1. A ROS 1 process is one ROS node, so all `Ros1Node` objects share its name and parameters.

    Args:
        process: What all nodes of the process share.
        clock: Clock of the node.
        namespace: Namespace of relative names in that of the process; empty for none.
    """

    converter = ROS1
    other_packages = ("simulation_interfaces/",)

    def __init__(self, process: RosProcess, clock: EventClock, namespace: str = "") -> None:
        super().__init__(process, clock)
        self._namespace = namespace

    def get_logger(self) -> Logger:
        """Returns the logger of the process. It writes to the console and to /rosout."""
        return _logger()

    def create_publisher(self, msg_type: type[M], topic: str, qos_profile: QoS) -> _Publisher:
        """Creates a publisher of messages of one type."""
        ros_class = ROS1.find_message_type(msg_type.ros_type)
        is_latched = qos_profile is QoS.LATCHED
        publisher = rospy.Publisher(self._named(topic), ros_class, queue_size=10, latch=is_latched)
        _check_type(publisher, ros_class)
        own_topic = self._topics.advertise(publisher.resolved_name, msg_type)
        return _Publisher(ros_class(), publisher, own_topic, self._disturbances, is_latched=is_latched)

    def destroy_publisher(self, publisher: _Publisher) -> None:
        """Destroys a publisher."""
        publisher.retire()
        publisher.publisher.unregister()

    def destroy_service(self, service: Any) -> None:
        """Stops offering a service."""
        if service is not None:
            service.shutdown("destroyed")

    def create_client(self, srv_type: Any, srv_name: str) -> _Client:
        """Creates a client of a service."""
        proxy = rospy.ServiceProxy(self._named(srv_name), self._find_service_type(srv_type.ros_type))
        return _Client(srv_type, proxy, self._executor)

    def destroy_client(self, client: _Client) -> None:
        """Destroys a client."""
        client.proxy.close()

    def resolve_topic_name(self, topic: str) -> str:
        """Returns the full name of a topic, after namespaces and remapping."""
        return str(rospy.resolve_name(self._named(topic)))

    def resolve_service_name(self, service: str) -> str:
        """Returns the full name of a service, after namespaces and remapping."""
        return str(rospy.resolve_name(self._named(service)))

    def _named(self, name: str) -> str:
        """Returns the name of a topic or service in the namespace of the process."""
        return f"{self._namespace}/{name}" if self._namespace and name[:1] not in "/~" else name

    def _subscribe_through_ros(
        self, msg_type: type[M], topic: str, receive: Callable[[Any], None], qos: QoS
    ) -> Callable[[], object]:
        ros_class = ROS1.find_message_type(msg_type.ros_type)
        subscriber = rospy.Subscriber(
            self._named(topic), ros_class, receive, queue_size=100, buff_size=2**24, tcp_nodelay=True
        )
        _check_type(subscriber, ros_class)
        unregister: Callable[[], object] = subscriber.unregister
        return unregister

    def _find_service_type(self, ros_type: str) -> Any:
        """Returns a service class whose requests and responses hold arrays as NumPy arrays."""
        ros_class = ROS1.find_type(ros_type)
        parts = {name: numpy_msg(getattr(ros_class, name)) for name in ("_request_class", "_response_class")}
        return type(ros_class.__name__, (ros_class,), parts)

    def _offer_service(self, ros_type: Any, srv_name: str, answer: Callable[[Any, Any], Any]) -> Any:
        return rospy.Service(self._named(srv_name), ros_type, lambda request: answer(request, ros_type._response_class()))


def _check_type(endpoint: Any, ros_class: Any) -> None:
    """Ends a publisher or subscriber and raises TypeError if this process has its topic with another type already.

    rospy would let both share one connection, and send messages of one type as those of the other.
    """
    present = endpoint.impl.data_class._type
    if present != ros_class._type:
        name = endpoint.resolved_name
        endpoint.unregister()
        raise TypeError(f"topic {name} cannot have messages of type {ros_class._type}: this process has {present} there")


class _RosClock:
    """The time of rospy: wall time, or the time on /clock if `use_sim_time` is set."""

    def now(self) -> Instant:
        return Instant(rospy.get_rostime().to_nsec())


class _Publisher(RosPublisher):
    """Publishes messages by filling one ROS message, `message`, again each time."""

    def __init__(
        self, message: Any, publisher: Any, topic: IntraProcessTopic, disturbances: Disturbances, *, is_latched: bool
    ) -> None:
        super().__init__(topic, disturbances, is_latched=is_latched)
        self.message, self.publisher = message, publisher

    def _send_through_ros(self, message: Message) -> None:
        try:
            if self.is_latched or self.publisher.get_num_connections() > 0:
                self.publisher.publish(ROS1.fill(self.message, message))
        except rospy.ROSException:
            # Expected only while the node shuts down.
            if not rospy.is_shutdown():
                raise


@dataclass
class _Client:
    srv_type: Any
    proxy: Any
    executor: Executor

    def service_is_ready(self) -> bool:
        try:
            rosgraph.Master(rospy.get_name()).lookupService(self.proxy.resolved_name)
        except (rosgraph.MasterException, OSError):
            return False
        return True

    def call_async(self, request: Message) -> Future:
        """Calls the service on a new thread. If the call fails, the future holds the exception."""
        future = Future()
        set_result, set_exception = map(self.executor.serialized, (future.set_result, future.set_exception))

        def call() -> None:
            try:
                response = self.proxy(ROS1.to_ros(request, self.proxy.request_class))
            except (rospy.ServiceException, rospy.ROSException, OSError) as error:
                set_exception(error)
            else:
                set_result(ROS1.from_ros(response, self.srv_type.Response))

        Thread(target=call, daemon=True).start()
        return future


def run(name: str, arguments: list[str], read_faults: ReadFaults) -> None:
    """Runs a node, or all nodes in one process, until SIGINT (Ctrl-C) or SIGTERM.

    Args:
        name: `robot`, `laser`, `map` or `all`.
        arguments: A map file for `map` and `all`, then ROS 1 arguments: _name:=value, from:=to, __name:=name.
        read_faults: Reads the faults in the parameter `faults`, and adds those of the command line.

    Raises:
        ValueError: An argument, a parameter or a fault is invalid.
        OSError: There is no ROS master, or the map file cannot be read.
    """
    map_file, ros_arguments = split_arguments(name, arguments, lambda argument: ":=" in argument, "_NAME:=VALUE or FROM:=TO")
    if not rosgraph.is_master_online():
        raise OSError(f"no ROS master at {rosgraph.get_master_uri()}: start roscore first")
    models = models_of(name)
    node_name = models[0].node_name if len(models) == 1 else "mobile_robot_simulator"
    process = RosProcess()
    try:
        with process.executor.until_signalled():
            rospy.init_node(node_name, argv=["mobile-robot-simulator", *ros_arguments], disable_signals=True)
            rospy.on_shutdown(process.executor.shutdown)
            given = _private_parameters()
            faults = read_faults(faults_in(given))
            fleet = Fleet(given if name == "all" else {})
            if name != "all" and "robots" in given:
                _logger().warning(ONLY_ALL)
            warn_about_unknown(given, _logger(), fleet)
            resolver = ParameterResolver(name, DEFAULTS, map_file)
            # In one event, so that no timer fires before the faults act.
            with process.executor.event():
                behaviours = _create_behaviours(models, resolver, given, process, fleet)
                for *_, behaviour in behaviours:
                    behaviour.start()
                if faults:
                    process.disturbances.add(faults, Ros1Node(process, process.clock), process.clock)
            _MasterMonitor(behaviours, resolver, given, process, fleet)
            process.executor.wait()
    finally:
        rospy.signal_shutdown("done")


def _create_behaviours(
    models: list[type[Parameters]],
    resolver: ParameterResolver,
    given: dict[str, Any],
    process: RosProcess,
    fleet: Fleet,
) -> list[tuple[str, str, Behaviour]]:
    """Returns the behaviours of all nodes, each with the names of its robot and its scanner."""
    behaviours = []
    follows_clock = rospy.get_param("/use_sim_time", False)
    for model in models:
        for robot, scanner in fleet.owners_of(model):
            values = fleet.given_to(robot, given, rospy.resolve_name, scanner)
            parameters = resolver.resolve(model, values, _logger())
            if parameters is not None:
                fleet.add(robot, parameters)
                clock = process.clock_for(parameters, _RosClock(), use_sim_time=follows_clock)
                node = Ros1Node(process, clock, robot)
                behaviours.append((robot, scanner, create_behaviour(parameters, node, process, robot)))
    warn_about_scanners(given, _logger(), fleet)
    return behaviours


def _logger() -> Logger:
    """Returns the logger that rospy itself uses."""
    return logging.getLogger("rosout")


def _private_parameters() -> dict[str, Any]:
    """Returns the private parameters on the parameter server, by name; `~robot1/NAME` has the name `robot1.NAME`."""
    found = rospy.get_param("~", {})
    return dict(_flat(found)) if isinstance(found, dict) else {}


def _flat(found: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in found.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value


def _is_reachable(node: str) -> bool:
    """Returns True if a node accepts connections. The master alone cannot tell, because it still lists killed nodes."""
    try:
        uri = urlsplit(rosgraph.Master(rospy.get_name()).lookupNode(node))
        socket.create_connection((uri.hostname, uri.port), CONNECTION_TIMEOUT).close()
    except (OSError, rosgraph.MasterException):
        return False
    return True


class _TimedTransport(xmlrpc.client.Transport):
    """Calls through XML-RPC that give up after `CONNECTION_TIMEOUT`."""

    def make_connection(self, host: Any) -> Any:
        connection = super().make_connection(host)
        connection.timeout = CONNECTION_TIMEOUT
        return connection


def _published_types(node: str, topic: str) -> set[str]:
    """Returns the types with which a node publishes a topic, such as geometry_msgs/msg/Twist. Empty if it does not answer.

    Asks the node itself, because the master keeps only the type of the last publisher of a topic.
    """
    try:
        uri = rosgraph.Master(rospy.get_name()).lookupNode(node)
        proxy: Any = xmlrpc.client.ServerProxy(uri, transport=_TimedTransport())
        with proxy:
            _, _, publications = proxy.getPublications(rospy.get_name())
    except (OSError, HTTPException, xmlrpc.client.Error, rosgraph.MasterException):
        return set()
    return {ros_type.replace("/", "/msg/") for name, ros_type in publications if name == topic}


class _MasterMonitor:
    """Watches the master for changed parameters and for other publishers.

    If a parameter changes on the parameter server, it is changed in the nodes. If it is deleted there, it gets its default.
    If a node refuses, the value of the nodes is written back. While other ROS nodes publish a topic, its messages come
    through ROS.

    rospy has no callback for these changes, so a thread queries the master once per `POLL_PERIOD`.
    """

    def __init__(
        self,
        behaviours: list[tuple[str, str, Behaviour]],
        resolver: ParameterResolver,
        given: dict[str, Any],
        process: RosProcess,
        fleet: Fleet,
    ) -> None:
        self._behaviours, self._resolver, self._last_given = behaviours, resolver, dict(given)
        self._fleet = fleet
        self._executor, self._topics = process.executor, process.topics
        Thread(target=self._run, name="master", daemon=True).start()

    def _run(self) -> None:
        while not rospy.is_shutdown():
            time.sleep(POLL_PERIOD)
            try:
                self._check_publishers()
                self._check_parameters()
            except (OSError, HTTPException, xmlrpc.client.Error, rosgraph.MasterException, rospy.ROSException):
                # The master cannot be reached. Try again later.
                continue
            except Exception as error:
                # Without this thread changes go unnoticed, so the process must end.
                self._executor.shutdown(error)
                return

    def _check_publishers(self) -> None:
        published, _, _ = rosgraph.Master(rospy.get_name()).getSystemState()
        others = {topic: set(nodes) - {rospy.get_name()} for topic, nodes in published}
        shared = {topic for topic in self._topics.names if any(map(_is_reachable, others.get(topic, ())))}
        names = {subscription.topic for subscription in tuple(self._topics.either)}
        types = {name: {each for node in others.get(name, ()) for each in _published_types(node, name)} for name in names}
        update = self._executor.serialized(self._topics.update)
        update(lambda topic: topic.name in shared, lambda name: types.get(name, set()))

    def _check_parameters(self) -> None:
        given = _private_parameters()
        changed = {name: value for name, value in given.items() if self._last_given.get(name, _ABSENT) != value}
        deleted = [name for name in self._last_given if name not in given and name not in SYNONYMS]
        if changed or deleted:
            warn_about_unknown(changed, _logger(), self._fleet)
            change = self._executor.serialized(self._change)
            for name, value in changed.items():
                self._last_given[name] = value
                change(name, lambda _, value=value: value)
            for name in deleted:
                del self._last_given[name]
                _, own_name = split(self._fleet.owner_of(name)[1])
                change(name, lambda model, name=own_name: self._resolver.defaults_of(model)[name])

    def _is_given(self, robot: str, scanner: str, name: str) -> bool:
        """Returns True if a parameter is given for one scanner."""
        own = f"{scanner}.{name}"
        return scanner != "" and not self._last_given.keys().isdisjoint((own, f"{robot}.{own}"))

    def _change(self, name: str, value_for: Callable[[type[Parameters]], Any]) -> None:
        owner, own_name = self._fleet.owner_of(name)
        of_scanner, own_name = split(own_name)
        # The value of a robot or a scanner counts more than the common one.
        behaviours = [
            behaviour
            for robot, scanner, behaviour in self._behaviours
            if (owner == robot or (not owner and f"{robot}.{name}" not in self._last_given))
            and (of_scanner == scanner or (not of_scanner and not self._is_given(robot, scanner, own_name)))
        ]
        has_scanners = any(scanner for robot, scanner, _ in self._behaviours if owner in ("", robot))
        if has_scanners and not of_scanner and own_name in DERIVED_OF_SCANNERS:
            refusal: str | None = f"with several scanners, {own_name} can only be set at startup, or for one scanner"
        elif self._fleet.names != ("",) and own_name in DERIVED:
            refusal = f"with several robots, {own_name} can only be set at startup"
        else:
            refusal = change_everywhere(behaviours, own_name, value_for)
        if refusal is None:
            return
        _logger().warning(f"parameter change refused: {refusal}")
        on_server = f"~{name.replace('.', '/')}"
        for behaviour in behaviours if owner or own_name not in DERIVED else ():
            value = getattr(behaviour.parameters, own_name, None)
            if value is not None:
                rospy.set_param(on_server, value)
                self._last_given[name] = value
                return
        if rospy.has_param(on_server):
            rospy.delete_param(on_server)
        self._last_given.pop(name, None)


_ABSENT = object()
