"""BusNode: what a node may ask of the bus, under rclpy's names, so that code written for rclpy runs on it unchanged."""

from __future__ import annotations

import copy
import difflib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import partial
from typing import Any

from ..handle import Handle, check_callback
from ..messages import copied
from ..nodes.future import Future
from ..nodes.interface import M, QoS
from .bus import Bus, FreshPublisher, Publisher, Service, Subscription
from .clock import Clock
from .logger import Logger
from .parameter import Parameter, ParameterAlreadyDeclaredException, ParameterNotDeclaredException, SetParametersResult
from .timer import Timer

LATCHED_DURABILITY = "TRANSIENT_LOCAL"


@dataclass(eq=False)
class Client(Handle):
    """Calls a service."""

    bus: Bus
    service: Service

    def service_is_ready(self) -> bool:
        """Whether anyone answers."""
        return self.service.handler is not None

    def wait_for_service(self, timeout_sec: float | None = None) -> bool:
        """Whether anyone answers; time on the bus does not pass while somebody waits."""
        return self.service_is_ready()

    def call_async(self, request: Any) -> Future:
        """Ask; the answer comes at the same moment, after the caller has returned. If nobody answers, it never comes."""
        if not isinstance(request, self.service.srv_type.Request):
            expected = self.service.srv_type.Request.__name__
            raise TypeError(f"{self.service.name} takes a {expected}, got {type(request).__name__}")
        return self.bus.call(self.service, copied(request))

    def call(self, request: Any) -> Any:
        """Not on the bus, where a callback that waits would wait for ever. raises: RuntimeError."""
        raise RuntimeError(f"a callback must not wait for {self.service.name}: use call_async and add_done_callback")


class BusNode(Handle):
    """A node on the bus, under rclpy's names.

    name, namespace: topics and services of names that do not start with `/` are in the namespace, those that start with `~/`
    in the node's own below it. parameters: values that take the place of defaults when a parameter is declared.

    Attributes that a subclass keeps are saved and restored with the bus, as deep copies; a subclass that keeps something
    that cannot be copied defines `save` and `restore` itself.
    """

    def __init__(self, bus: Bus, name: str, *, namespace: str = "/", parameters: Mapping[str, Any] | None = None) -> None:
        if not name or "/" in name:
            raise ValueError(f"a node's name must not be empty or hold a slash, got {name!r}")
        self._bus, self._name, self._namespace = bus, name, "/" + namespace.strip("/")
        self._clock = Clock(bus)
        self._logger = Logger(self._clock, name)
        self._overrides = dict(parameters or {})
        self._parameters: dict[str, Parameter] = {}
        self._on_set: list[Callable[[list[Parameter]], Any]] = []
        self._handles: dict[Any, Callable[[], object]] = {}
        bus.nodes.append(self)

    # --- names and time ---

    def get_name(self) -> str:
        """The node's name."""
        return self._name

    def get_namespace(self) -> str:
        """The node's namespace."""
        return self._namespace

    def get_fully_qualified_name(self) -> str:
        """The node's name, its namespace before it."""
        return f"{self._namespace.rstrip('/')}/{self._name}"

    def get_clock(self) -> Clock:
        """The bus's clock."""
        return self._clock

    def set_speed(self, factor: float) -> None:
        """Nothing: time on the bus goes on as it is run."""

    def get_logger(self) -> Logger:
        """Where notes go: the standard library's logging, under the node's name."""
        return self._logger

    # --- topics, timers, services ---

    def create_publisher(self, msg_type: type[M], topic: str, qos_profile: Any = QoS.DEFAULT, **_: Any) -> Publisher[M]:
        """A publisher to a topic."""
        found = self._bus.topic(self._resolve(topic), msg_type)
        found.latched |= _is_latched(qos_profile)
        return Publisher(self._bus, found)

    def create_subscription(
        self, msg_type: type[M], topic: str, callback: Callable[[M], None], qos_profile: Any = QoS.DEFAULT, **_: Any
    ) -> Subscription[M]:
        """Have every message of a topic handed to the callback; of a latched one also the last message there was."""
        found = self._bus.topic(self._resolve(topic), msg_type)
        check_callback(callback)
        subscription = Subscription(found, callback)
        found.subscriptions = (*found.subscriptions, subscription)
        if found.latched and found.latest is not None:
            self._bus.schedule(self._bus.time_ns, partial(subscription.hand, found.latest))
        self._handles[subscription] = partial(self.destroy_subscription, subscription)
        return subscription

    def create_timer(self, timer_period_sec: float, callback: Callable[[], None], *_: Any, **__: Any) -> Timer:
        """Have the callback called once a period, first after one period."""
        timer = Timer(self._bus, timer_period_sec, callback)
        self._handles[timer] = partial(self.destroy_timer, timer)
        return timer

    def create_service(self, srv_type: Any, srv_name: str, callback: Callable[[Any, Any], Any], **_: Any) -> Service:
        """Answer requests with what the callback makes of the request and an empty response."""
        service = self._bus.service(self._resolve(srv_name), srv_type)
        check_callback(callback)
        if service.handler is not None:
            raise ValueError(f"{service.name} is answered already")
        service.handler = callback
        self._handles[service] = partial(self.destroy_service, service)
        return service

    def create_client(self, srv_type: Any, srv_name: str, **_: Any) -> Client:
        """A client of a service."""
        return Client(self._bus, self._bus.service(self._resolve(srv_name), srv_type))

    def destroy_publisher(self, publisher: Publisher[Any]) -> bool:
        """Take a publisher away."""
        return True

    def destroy_subscription(self, subscription: Subscription[Any]) -> bool:
        """Take a subscription away: messages on their way no longer reach it."""
        subscription.active = False
        topic = subscription.topic
        topic.subscriptions = tuple(other for other in topic.subscriptions if other is not subscription)
        return self._handles.pop(subscription, None) is not None

    def destroy_timer(self, timer: Timer) -> bool:
        """Take a timer away."""
        timer.cancel()
        self._bus.timers.pop(timer, None)
        return self._handles.pop(timer, None) is not None

    def destroy_service(self, service: Service) -> bool:
        """No longer answer requests."""
        service.handler = None
        return self._handles.pop(service, None) is not None

    def destroy_client(self, client: Client) -> bool:
        """Take a client away."""
        return True

    def destroy_node(self) -> None:
        """Take everything away that the node has on the bus."""
        for destroy in tuple(self._handles.values()):
            destroy()
        if self in self._bus.nodes:
            self._bus.nodes.remove(self)

    # --- parameters ---

    def declare_parameter(self, name: str, value: Any = None, *_: Any, **__: Any) -> Parameter:
        """A parameter of a default value, or of the value the node was given for it.

        raises: ParameterAlreadyDeclaredException, a ValueError.
        """
        if name in self._parameters:
            raise ParameterAlreadyDeclaredException(f"parameter {name!r} is declared already")
        self._parameters[name] = Parameter(name, value=self._overrides.get(name, value))
        return self._parameters[name]

    def declare_parameters(self, namespace: str, parameters: Sequence[tuple[Any, ...]], **_: Any) -> list[Parameter]:
        """Several parameters, each given by its name and default."""
        prefix = f"{namespace}." if namespace else ""
        return [self.declare_parameter(prefix + item[0], *item[1:2]) for item in parameters]

    def has_parameter(self, name: str) -> bool:
        """Whether a parameter was declared."""
        return name in self._parameters

    def get_parameter(self, name: str) -> Parameter:
        """A parameter that was declared. raises: ParameterNotDeclaredException, a ValueError, that suggests the nearest."""
        if name not in self._parameters:
            near = difflib.get_close_matches(name, self._parameters, n=1)
            hint = f"; did you mean {near[0]!r}?" if near else ""
            raise ParameterNotDeclaredException(f"parameter {name!r} of {self._name} is not declared{hint}")
        return self._parameters[name]

    def get_parameter_or(self, name: str, alternative_value: Any = None) -> Any:
        """A parameter, or the alternative if it was not declared."""
        return self._parameters.get(name, alternative_value)

    def set_parameters(self, parameter_list: Sequence[Parameter]) -> list[SetParametersResult]:
        """Set parameters, each unless a callback of `add_on_set_parameters_callback` objects."""
        results = []
        for parameter in parameter_list:
            self.get_parameter(parameter.name)
            refusals = (answer for answer in (check([parameter]) for check in self._on_set) if not answer.successful)
            result = next(refusals, SetParametersResult())
            if result.successful:
                self._parameters[parameter.name] = parameter
            results.append(result)
        return results

    def add_on_set_parameters_callback(self, callback: Callable[[list[Parameter]], Any]) -> None:
        """Have parameters checked before they are set."""
        self._on_set.append(callback)

    # --- saving ---

    def save(self) -> Any:
        """Copies of all attributes. raises: TypeError that names one that cannot be copied."""
        memo: dict[int, Any] = {}
        state = {}
        for name, value in vars(self).items():
            try:
                state[name] = copy.deepcopy(value, memo)
            except TypeError as error:
                raise TypeError(f"{name} of node {self._name} cannot be saved: {error}; define save and restore") from error
        return state, self._logger.save()

    def restore(self, state: Any) -> None:
        """Attributes as they were saved."""
        attributes, logger = state
        vars(self).clear()
        vars(self).update(copy.deepcopy(attributes))
        self._logger.restore(logger)

    def _resolve(self, name: str) -> str:
        if name.startswith("/"):
            return name
        if name.startswith("~/"):
            return f"{self.get_fully_qualified_name()}/{name[2:]}"
        return f"{self._namespace.rstrip('/')}/{name}" if name.strip("/") else name


class OwnNode(BusNode):
    """A node of the simulator's own: it makes each message anew, so that none need be copied when it is sent."""

    def create_publisher(self, msg_type: type[M], topic: str, qos_profile: Any = QoS.DEFAULT, **_: Any) -> Publisher[M]:
        """A publisher to a topic."""
        return FreshPublisher(self._bus, super().create_publisher(msg_type, topic, qos_profile).topic)


_surroundings: ContextVar[tuple[Bus, str, Mapping[str, Any]] | None] = ContextVar("surroundings", default=None)


class Node(BusNode):
    """Stands in for `rclpy.node.Node`: subclasses are made by `Simulation.spawn`, which puts them on its bus."""

    def __init__(
        self,
        node_name: str,
        *,
        namespace: str | None = None,
        parameter_overrides: Sequence[Parameter] | None = None,
        **_: Any,
    ) -> None:
        surroundings = _surroundings.get()
        if surroundings is None:
            raise RuntimeError(f"node {node_name!r} has no bus to live on: make it with Simulation.spawn")
        bus, outer, values = surroundings
        overrides = {parameter.name: parameter.value for parameter in parameter_overrides or ()}
        super().__init__(bus, node_name, namespace=namespace or outer, parameters={**overrides, **values})


@contextmanager
def surroundings(bus: Bus, namespace: str, parameters: Mapping[str, Any]) -> Iterator[None]:
    """Where a `Node` made meanwhile lives, and the parameters that it is given."""
    token = _surroundings.set((bus, namespace, parameters))
    try:
        yield
    finally:
        _surroundings.reset(token)


def _is_latched(qos_profile: Any) -> bool:
    return qos_profile is QoS.LATCHED or getattr(getattr(qos_profile, "durability", None), "name", "") == LATCHED_DURABILITY
