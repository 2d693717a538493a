"""Nodes on the bus, with the method names of rclpy, so that code written for rclpy runs on the bus unchanged."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar

from ..handle import Handle, check_callback
from ..messages import Message
from ..nodes.interface import M, QoS
from ..quoting import quoted
from .bus import Bus
from .clock import BusClock
from .current import using
from .logger import BusLogger
from .parameter import Parameter, ParameterStore, SetParametersCallback, SetParametersResult
from .service import BusClient, BusService
from .task import plain_callback
from .timer import BusTimer
from .topic import BusPublisher, BusSubscription, NoCopyPublisher

LATCHED_DURABILITY = "TRANSIENT_LOCAL"
"""Name of the durability that makes a topic latched, in QoS profiles of rclpy."""


@dataclass(frozen=True)
class NodeSnapshot:
    """Saved state of a node.

    Attributes:
        attributes: Deep copies of all attributes, including those of subclasses. Instances of `Handle`, such as the bus and
            publishers, are shared instead of copied.
        logger: State of the node's logger.
    """

    attributes: Mapping[str, Any]
    logger: dict[str, int]


class BusNode(Handle):
    """A node on the bus, with the method names of rclpy.

    `save` and `restore` deep-copy all attributes, including those of subclasses. A subclass with an attribute that cannot be
    copied must override both.

    Args:
        bus: Bus to join.
        name: Name of the node.
        namespace: Prefix of relative names. For topics and services, `scan` becomes `<namespace>/scan`, `~/scan` becomes
            `<namespace>/<name>/scan`, and `/scan` stays as it is.
        parameters: Values that replace the defaults when the node declares its parameters.

    Raises:
        ValueError: The name is empty or contains a slash.
        TypeError: The name or the namespace is not a text, or the parameters are not a mapping.
        RuntimeError: The bus is closed.
    """

    publisher_class: ClassVar[type[BusPublisher[Any]]] = BusPublisher
    """Class of the publishers that the node creates."""

    def __init__(self, bus: Bus, name: str, *, namespace: str = "/", parameters: Mapping[str, Any] | None = None) -> None:
        if not isinstance(name, str):
            raise TypeError(f"a node's name must be a text, got {quoted(name)}")
        if not isinstance(namespace, str):
            raise TypeError(f"a node's namespace must be a text such as /robot1, got {quoted(namespace)}")
        if not isinstance(parameters, Mapping | None):
            raise TypeError(f"a node's parameters must be a mapping from names to values, got {quoted(parameters)}")
        if not name or "/" in name:
            raise ValueError(f"a node's name must not be empty or contain a slash, got {quoted(name)}")
        bus.check_open()
        self._bus, self._name, self._namespace = bus, name, "/" + namespace.strip("/")
        self._clock = BusClock(bus)
        self._logger = BusLogger(self._clock, name)
        self._parameters = ParameterStore(name, parameters or {})
        self._handles: dict[Any, Callable[[], object]] = {}
        bus.nodes.append(self)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.get_fully_qualified_name()!r})"

    # --- names and time ---

    def resolve_topic_name(self, topic: str) -> str:
        """Returns the absolute name of a topic. An empty name stays empty."""
        if topic.startswith("/"):
            return topic
        if topic.startswith("~/"):
            return f"{self.get_fully_qualified_name()}/{topic[2:]}"
        return f"{self._namespace.rstrip('/')}/{topic}" if topic.strip("/") else topic

    def resolve_service_name(self, service: str) -> str:
        """Returns the absolute name of a service. An empty name stays empty."""
        return self.resolve_topic_name(service)

    def get_name(self) -> str:
        """Returns the node's name."""
        return self._name

    def get_namespace(self) -> str:
        """Returns the node's namespace."""
        return self._namespace

    def get_fully_qualified_name(self) -> str:
        """Returns the node's namespace and name, such as `/robot1/talker`."""
        return f"{self._namespace.rstrip('/')}/{self._name}"

    def get_clock(self) -> BusClock:
        """Returns the clock of the bus."""
        return self._clock

    def set_speed(self, factor: float) -> None:
        """Has no effect, because simulated time on the bus is not tied to wall time."""

    def get_logger(self) -> BusLogger:
        """Returns the node's logger, which forwards to Python's `logging`."""
        return self._logger

    # --- topics, timers, services ---

    def create_publisher(
        self,
        msg_type: type[M],
        topic: str,
        qos_profile: Any = QoS.DEFAULT,
        *,
        publisher_class: type[BusPublisher[Any]] | None = None,
        **_: Any,
    ) -> BusPublisher[M]:
        """Creates a publisher for a topic. Other keywords of rclpy are ignored.

        Args:
            msg_type: Message class.
            topic: Name of the topic.
            qos_profile: A `QoS`, or a QoS profile of rclpy. The bus only uses whether it is latched.
            publisher_class: Class of the publisher. By default, that of the node.

        Raises:
            TypeError: The type is not a message class, or the existing topic has another type.
            ValueError: The name is empty.
        """
        found = self._bus.topic(self.resolve_topic_name(topic), msg_type)
        publisher = (publisher_class or self.publisher_class)(self._bus, found, _is_latched(qos_profile))
        found.publishers = (*found.publishers, publisher)
        found.latched = found.latched or publisher.latched
        self._handles[publisher] = partial(self.destroy_publisher, publisher)
        return publisher

    def create_subscription(
        self, msg_type: type[M], topic: str, callback: Callable[[M], None], qos_profile: Any = QoS.DEFAULT, **_: Any
    ) -> BusSubscription[M]:
        """Calls the callback with every message sent to a topic from now on, and with the last of each latched publisher.

        As on ROS 2, a subscription with a depth, or with a QoS profile of rclpy that is not `TRANSIENT_LOCAL`, does not
        receive messages that were sent before it. Other keywords of rclpy are ignored.

        Args:
            msg_type: Message class.
            topic: Name of the topic.
            callback: Called with each message, which it must not change. It can be a coroutine function.
            qos_profile: A `QoS`, a depth, or a QoS profile of rclpy. The bus only uses whether it excludes earlier messages.

        Raises:
            TypeError: The callback is not callable, the type is not a message class, or the existing topic has another type.
            ValueError: The name is empty.
        """
        found = self._bus.topic(self.resolve_topic_name(topic), msg_type)
        check_callback(callback)
        subscription = found.subscribe(plain_callback(self._bus, callback))
        for message, _time_ns in found.kept.values() if _takes_latched(qos_profile) else ():
            self._bus.schedule(self._bus.time_ns, partial(subscription.deliver, message))
        self._handles[subscription] = partial(self.destroy_subscription, subscription)
        return subscription

    def create_subscription_of_either(
        self, callbacks: Mapping[type[Message], Callable[[Any], None]], topic: str, qos_profile: Any = QoS.DEFAULT
    ) -> BusSubscription[Any]:
        """Subscribes to a topic with the first of several types. On the bus, a topic has one type."""
        msg_type, callback = next(iter(callbacks.items()))
        return self.create_subscription(msg_type, topic, callback, qos_profile)

    def create_timer(
        self, timer_period_sec: float, callback: Callable[[], object], *_: Any, autostart: bool = True, **__: Any
    ) -> BusTimer:
        """Calls the callback periodically, for the first time after one period. Other arguments of rclpy are ignored.

        Args:
            timer_period_sec: Period [s].
            callback: Called without arguments. It can be a coroutine function.
            autostart: If False, the timer starts when its method `reset` is called.

        Raises:
            ValueError: The period is below 1 ns or not finite.
            TypeError: The callback is not callable.
        """
        check_callback(callback)
        timer = BusTimer(self._bus, timer_period_sec, plain_callback(self._bus, callback))
        if not autostart:
            timer.cancel()
        self._handles[timer] = partial(self.destroy_timer, timer)
        return timer

    def create_wall_timer(self, timer_period_sec: float, callback: Callable[[], None]) -> BusTimer:
        """Same as `create_timer`: nothing on the bus depends on wall time."""
        return self.create_timer(timer_period_sec, callback)

    def create_rate(self, frequency: float, clock: Any = None) -> None:
        """Always raises an error, because a callback that sleeps would sleep forever.

        Raises:
            RuntimeError: Always.
        """
        raise RuntimeError("a rate needs a thread that sleeps, which the bus does not have: use create_timer")

    def create_service(self, srv_type: Any, srv_name: str, callback: Callable[[Any, Any], Any], **_: Any) -> BusService:
        """Offers a service. Other keywords of rclpy are ignored.

        Args:
            srv_type: Service class with `Request` and `Response`.
            srv_name: Name of the service.
            callback: Takes the request and an empty response, and returns the response. It can be a coroutine function.

        Raises:
            TypeError: The callback is not callable, or the existing service has another type.
            ValueError: A node already offers the service, or the name is empty.
        """
        service = self._bus.service(self.resolve_service_name(srv_name), srv_type)
        check_callback(callback)
        if service.handler is not None:
            raise ValueError(f"{service.name} is already offered by a node")
        service.handler = plain_callback(self._bus, callback)
        self._handles[service] = partial(self.destroy_service, service)
        return service

    def create_client(self, srv_type: Any, srv_name: str, **_: Any) -> BusClient:
        """Creates a client for a service. A node can start to offer the service later. Other keywords of rclpy are ignored.

        Args:
            srv_type: Service class with `Request` and `Response`.
            srv_name: Name of the service.

        Raises:
            TypeError: The existing service has another type.
            ValueError: The name is empty.
        """
        return BusClient(self._bus.call, self._bus.service(self.resolve_service_name(srv_name), srv_type), self._bus.waiting)

    def destroy_publisher(self, publisher: BusPublisher[Any]) -> bool:
        """Destroys a publisher. Later subscriptions no longer receive its last message. Returns True, as rclpy does."""
        self._handles.pop(publisher, None)
        publisher.topic.remove_publisher(publisher)
        return True

    def destroy_subscription(self, subscription: BusSubscription[Any]) -> bool:
        """Removes a subscription and discards the pending messages to it.

        Returns:
            True if it was a subscription of this node. Otherwise, nothing changes.
        """
        if self._handles.pop(subscription, None) is None:
            return False
        subscription.topic.unsubscribe(subscription)
        return True

    def destroy_timer(self, timer: BusTimer) -> bool:
        """Cancels and removes a timer.

        Returns:
            True if it was a timer of this node. Otherwise, nothing changes.
        """
        if self._handles.pop(timer, None) is None:
            return False
        timer.cancel()
        self._bus.timers.pop(timer, None)
        return True

    def destroy_service(self, service: BusService) -> bool:
        """Stops offering a service.

        Returns:
            True if this node offered the service. Otherwise, nothing changes.
        """
        if self._handles.pop(service, None) is None:
            return False
        service.handler = None
        return True

    def destroy_client(self, client: BusClient) -> bool:
        """Has no effect, because the bus keeps no data about clients. Returns True, as rclpy does."""
        return True

    def destroy_node(self) -> None:
        """Removes the node from the bus, with its subscriptions, timers and services."""
        for destroy in tuple(self._handles.values()):
            destroy()
        if self in self._bus.nodes:
            self._bus.nodes.remove(self)

    def count_publishers(self, topic_name: str) -> int:
        """Returns the number of publishers of a topic."""
        found = self._bus.find_topic(self.resolve_topic_name(topic_name))
        return len(found.publishers) if found else 0

    def count_subscribers(self, topic_name: str) -> int:
        """Returns the number of subscriptions of a topic."""
        found = self._bus.find_topic(self.resolve_topic_name(topic_name))
        return len(found.subscriptions) if found else 0

    # --- parameters ---

    def declare_parameter(self, name: str, value: Any = None, descriptor: Any = None, *_: Any, **__: Any) -> Parameter:
        """Declares a parameter with a default value. A value passed to the node's constructor replaces the default.

        Args:
            name: Name of the parameter.
            value: Default value.
            descriptor: A `ParameterDescriptor` of `rcl_interfaces`. The bus checks `read_only` and the ranges.

        Raises:
            ParameterAlreadyDeclaredException: The parameter is already declared. It is a ValueError.
            InvalidParameterValueException: The value is out of the descriptor's range. It is a ValueError.
        """
        return self._parameters.declare(name, value, descriptor)

    def declare_parameters(self, namespace: str, parameters: Sequence[tuple[Any, ...]], **_: Any) -> list[Parameter]:
        """Declares several parameters.

        Args:
            namespace: Prefix of the names, followed by a dot. Empty for none.
            parameters: For each parameter a tuple of its name, its default value and its descriptor. The last two can be
                missing.

        Raises:
            ParameterAlreadyDeclaredException: The parameter is already declared. It is a ValueError.
        """
        prefix = f"{namespace}." if namespace else ""
        return [self.declare_parameter(prefix + item[0], *item[1:3]) for item in parameters]

    def has_parameter(self, name: str) -> bool:
        """Returns True if the parameter is declared."""
        return self._parameters.has(name)

    def get_parameter(self, name: str) -> Parameter:
        """Returns a declared parameter.

        Raises:
            ParameterNotDeclaredException: The parameter is not declared; the message suggests a similar name. It is a
                ValueError.
        """
        return self._parameters.get(name)

    def get_parameters(self, names: Sequence[str]) -> list[Parameter]:
        """Returns several parameters. Raises the error of `get_parameter`."""
        return [self._parameters.get(name) for name in names]

    def get_parameter_or(self, name: str, alternative_value: Any = None) -> Any:
        """Returns a parameter, or the alternative if it is not declared."""
        return self._parameters.get(name) if self._parameters.has(name) else alternative_value

    def set_parameters(self, parameter_list: Sequence[Parameter]) -> list[SetParametersResult]:
        """Sets each parameter, unless a callback added with `add_on_set_parameters_callback` refuses it.

        Returns:
            One result per parameter.

        Raises:
            ParameterNotDeclaredException: A parameter is not declared; those before it are set. It is a ValueError.
        """
        return self._parameters.set(parameter_list)

    def set_parameters_atomically(self, parameter_list: Sequence[Parameter]) -> SetParametersResult:
        """Sets all parameters, or none if a descriptor or a callback refuses one of them.

        Returns:
            The first refusal, or success.

        Raises:
            ParameterNotDeclaredException: A parameter is not declared; none is set. It is a ValueError.
        """
        return self._parameters.set_together(parameter_list)

    def undeclare_parameter(self, name: str) -> None:
        """Removes a parameter.

        Raises:
            ParameterNotDeclaredException: The parameter is not declared. It is a ValueError.
            ParameterImmutableException: The parameter is read-only. It is a ValueError.
        """
        self._parameters.undeclare(name)

    def describe_parameter(self, name: str) -> Any:
        """Returns the descriptor with which a parameter was declared; one with only its name if there was none.

        Raises:
            ParameterNotDeclaredException: The parameter is not declared. It is a ValueError.
        """
        return self._parameters.describe(name)

    def describe_parameters(self, names: Sequence[str]) -> list[Any]:
        """Returns the descriptors of several parameters. Raises the error of `describe_parameter`."""
        return [self._parameters.describe(name) for name in names]

    def add_on_set_parameters_callback(self, callback: SetParametersCallback) -> None:
        """Adds a callback that can refuse new values of parameters."""
        self._parameters.add_check(callback)

    # --- saving ---

    def save(self) -> Any:
        """Returns the state that `restore` takes: a `NodeSnapshot`, unless a subclass overrides both.

        Raises:
            TypeError: An attribute cannot be copied; the message names it.
        """
        memo: dict[int, Any] = {}
        attributes = {}
        for name, value in vars(self).items():
            try:
                attributes[name] = copy.deepcopy(value, memo)
            except TypeError as error:
                raise TypeError(f"{name} of node {self._name} cannot be saved: {error}; define save and restore") from error
        return NodeSnapshot(attributes, self._logger.save())

    def restore(self, state: Any) -> None:
        """Puts the node back into a saved state. Attributes that it did not have then are removed."""
        vars(self).clear()
        vars(self).update(copy.deepcopy(state.attributes))
        self._logger.restore(state.logger)


class NoCopyNode(BusNode):
    """A node whose publishers send messages without copying them.

    The simulator's own nodes use it. That is safe because they create a new message each time they publish.
    """

    publisher_class = NoCopyPublisher


@dataclass(frozen=True)
class SpawnContext:
    """Arguments that `Simulation.spawn` passes to each `Node` it creates; see `BusNode` for their meaning."""

    bus: Bus
    namespace: str
    parameters: Mapping[str, Any]


_spawn_context: ContextVar[SpawnContext | None] = ContextVar("spawn_context", default=None)


class Node(BusNode):
    """Replaces `rclpy.node.Node`. `Simulation.spawn` creates instances of its subclasses on the simulation's bus.

    Args:
        node_name: Name of the node.
        namespace: Prefix of relative names. If None or empty, the namespace given to `Simulation.spawn`.
        parameter_overrides: Values that replace the defaults when the node declares its parameters. Values given to
            `Simulation.spawn` have priority over these.

    Raises:
        RuntimeError: The node was not created by `Simulation.spawn`.
        ValueError: The name is empty or contains a slash.
    """

    def __init__(
        self,
        node_name: str,
        *,
        namespace: str | None = None,
        parameter_overrides: Sequence[Parameter] | None = None,
        **_: Any,
    ) -> None:
        context = _spawn_context.get()
        if context is None:
            raise RuntimeError(f"node {quoted(node_name)} has no bus to run on: create it with Simulation.spawn")
        overrides = {parameter.name: parameter.value for parameter in parameter_overrides or ()}
        super().__init__(
            context.bus,
            node_name,
            namespace=namespace or context.namespace,
            parameters={**overrides, **context.parameters},
        )


@contextmanager
def spawn_context(bus: Bus, namespace: str, parameters: Mapping[str, Any]) -> Iterator[None]:
    """Puts every `Node` that is created inside the `with` block on a bus.

    Args:
        bus: Bus to join.
        namespace: Namespace of nodes that are created without one.
        parameters: Values that replace the defaults when the nodes declare their parameters.
    """
    token = _spawn_context.set(SpawnContext(bus, namespace, parameters))
    try:
        with using(bus):
            yield
    finally:
        _spawn_context.reset(token)


def _takes_latched(qos_profile: Any) -> bool:
    """Returns True if a subscription receives messages that were sent before it."""
    return isinstance(qos_profile, QoS) or _is_latched(qos_profile)


def _is_latched(qos_profile: Any) -> bool:
    return qos_profile is QoS.LATCHED or getattr(getattr(qos_profile, "durability", None), "name", "") == LATCHED_DURABILITY
