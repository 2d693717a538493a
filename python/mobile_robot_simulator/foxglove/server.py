"""FoxgloveServer: shows a simulation to clients of the Foxglove WebSocket protocol, and does what they ask."""

from __future__ import annotations

import math
import time
from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeoutError
from functools import partial
from typing import TYPE_CHECKING, Any

from ..messages import Message
from ..quoting import shortened
from .client_topics import Announced, ClientTopics
from .encoding import CDR, ENCODINGS, decoded, definition_of, encoded
from .mailbox import LONGEST_WAIT, Mailbox
from .node_parameters import NodeParameters

try:
    from foxglove.websocket import Capability

    from foxglove import (
        Channel,
        Context,
        MessageSchema,
        Schema,
        Service,
        ServiceRequest,
        ServiceSchema,
        StatusLevel,
        start_server,
    )

    from .listener import Listener, parameters_of
except ImportError as error:
    raise ImportError("Foxglove needs foxglove-sdk: pip install 'mobile-robot-simulator[foxglove]'") from error

if TYPE_CHECKING:
    from ..bus.service import BusService
    from ..simulation.simulation import Simulation

PORT = 8765
"""Port that the Foxglove app suggests."""

TURN = 0.02
"""Wall time between two turns of `run` [s]."""

LONGEST_TURN = 0.1
"""Longest wall time that one turn of `run` makes up for [s]. If the machine is slower than that, time falls behind."""

_CAPABILITIES = [Capability.ClientPublish, Capability.Parameters, Capability.Services, Capability.Time]


class FoxgloveServer:
    """Shows a simulation to clients of the Foxglove WebSocket protocol, and does what they ask. Several can connect.

    Clients see all topics of the simulation, call its services, read and change the parameters of its nodes, follow its
    time, and publish on topics. Everything happens in the thread that calls `run` or `turn`, which is the only one that
    touches the simulation. Use the server as a context manager, which stops it.

    Whoever can connect can control the simulation. So listen on other addresses than 127.0.0.1 only in a network that you
    trust.

    Args:
        simulation: The simulation.
        host: Address to listen on.
        port: Port; 0 chooses a free one.

    Raises:
        OSError: The server cannot listen on this address and port.
        ValueError: The port is not in 0..65535.
    """

    def __init__(self, simulation: Simulation, *, host: str = "127.0.0.1", port: int = PORT) -> None:
        if not 0 <= port <= 65535:
            raise ValueError(f"the port must be in 0..65535, got {port}")
        self._simulation = simulation
        self._node = node = simulation.create_node("foxglove")
        self._bus = node._bus
        self._client_topics = ClientTopics(self._bus, node)
        self._parameters = NodeParameters(simulation)
        self._mailbox = Mailbox()
        self._context = Context()
        self._channels: dict[str, Channel | None] = {}
        self._services: dict[str, BusService] = {}
        self._sent_ns = -1
        try:
            self._server = start_server(
                name="mobile-robot-simulator",
                host=host,
                port=port,
                capabilities=_CAPABILITIES,
                server_listener=Listener(self._mailbox, self),
                supported_encodings=list(ENCODINGS),
                context=self._context,
            )
        except RuntimeError as error:
            node.destroy_node()
            raise OSError(f"cannot listen on {host}, port {port}: {error}") from None
        self._host, self._is_open = host, True
        simulation.record(self._forward)
        self.turn()

    @property
    def url(self) -> str:
        """Address to connect to, such as ws://127.0.0.1:8765."""
        host = f"[{self._host}]" if ":" in self._host else self._host
        return f"ws://{host}:{self._server.port}"

    def run(self, seconds: float = math.inf) -> None:
        """Runs the simulation at the pace of the wall clock, times `speed_factor`, for a wall time or until Ctrl-C.

        Args:
            seconds: Wall time [s].

        Raises:
            KeyboardInterrupt: Somebody has pressed Ctrl-C.
        """
        last = time.monotonic()
        end = last + seconds
        while last < end:
            time.sleep(max(0.0, min(last + TURN, end) - time.monotonic()))
            now = time.monotonic()
            self._simulation.run_for(min(LONGEST_TURN, now - last) * self._speed())
            last = now
            self.turn()

    def turn(self) -> None:
        """Does what clients have asked for since the last turn, and tells them the time and what has changed.

        For programs that run the simulation themselves: call it often, such as 50 times per second.
        """
        self._mailbox.empty()
        self._offer_topics()
        self._offer_services()
        if changed := self._parameters.changed():
            self._server.publish_parameter_values(parameters_of(changed))
        now_ns = self._bus.time_ns
        if now_ns < self._sent_ns:
            self._server.clear_session()  # so that clients forget what comes later
        if now_ns != self._sent_ns:
            self._server.broadcast_time(now_ns)
            self._sent_ns = now_ns

    def close(self) -> None:
        """Stops the server. Clients are disconnected. Closing twice has no effect."""
        if not self._is_open:
            return
        self._is_open = False
        self._mailbox.close()
        if self._forward in self._bus.taps:
            self._simulation.stop_recording(self._forward)
        self._node.destroy_node()
        for channel in filter(None, self._channels.values()):
            channel.close()
        self._server.stop()

    def __enter__(self) -> FoxgloveServer:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # --- to clients ---

    def _speed(self) -> float:
        robots = self._simulation.robots
        return next(iter(robots.values())).robot.parameters.speed_factor if robots else 1.0

    def _offer_topics(self) -> None:
        for topic in self._bus.topics():
            self._channel(topic.name, topic.msg_type)
        for name in [name for name in self._channels if self._bus.find_topic(name) is None]:  # after a restore
            if (channel := self._channels.pop(name)) is not None:
                channel.close()

    def _channel(self, topic: str, kind: type[Message]) -> Channel | None:
        """Returns the channel of a topic, or None if its messages cannot be shown."""
        if topic not in self._channels:
            try:
                schema = _schema(kind)
                self._channels[topic] = Channel(topic, schema=schema, message_encoding=CDR, context=self._context)
            except ValueError as error:
                self._channels[topic] = None
                self._node.get_logger().warning(f"{topic} is not shown: {error}")
        return self._channels[topic]

    def _forward(self, topic: str, message: Message, time_ns: int) -> None:
        channel = self._channel(topic, type(message))
        if channel is None or not channel.has_sinks():
            return
        try:
            channel.log(encoded(message), log_time=time_ns)
        except (ValueError, TypeError) as error:
            self._tell(f"{topic}: {error}")

    def _offer_services(self) -> None:
        offered = {service.name: service for service in self._bus.services()}
        if offered == self._services:
            return
        if gone := [name for name, service in self._services.items() if offered.get(name) is not service]:
            self._server.remove_services(gone)
        for name, service in offered.items():
            if self._services.get(name) is not service:
                try:
                    schema = ServiceSchema(
                        service.srv_type.ros_type,
                        request=MessageSchema(encoding=CDR, schema=_schema(service.srv_type.Request)),
                        response=MessageSchema(encoding=CDR, schema=_schema(service.srv_type.Response)),
                    )
                except ValueError as error:
                    self._node.get_logger().warning(f"{name} is not offered: {error}")
                    continue
                self._server.add_services([Service(name, schema=schema, handler=partial(self._answer, service))])
        self._services = offered

    def _tell(self, warning: str) -> None:
        self._server.publish_status(shortened(warning), StatusLevel.Warning)

    # --- from clients: calls in the thread of the simulation, except `_answer` ---

    def show_latched(self, topic: str) -> None:
        """Sends the messages again that a new subscriber of a latched topic receives."""
        for name, message, time_ns in self._bus.latched():
            if name == topic:
                self._forward(name, message, time_ns)

    def announce(self, client: int, channel: int, announced: Announced) -> None:
        """Makes a client ready to publish on a topic."""
        try:
            self._client_topics.announce(client, channel, announced)
        except (ValueError, TypeError) as error:
            self._tell(f"{error}")

    def withdraw(self, client: int, channel: int) -> None:
        """Ends what `announce` has begun."""
        self._client_topics.withdraw(client, channel)

    def publish(self, client: int, channel: int, data: bytes) -> None:
        """Publishes a message of a client."""
        try:
            self._client_topics.publish(client, channel, data)
        except (ValueError, TypeError) as error:
            self._tell(f"{error}")

    def get_parameters(self, names: list[str]) -> dict[str, Any]:
        """Returns values of parameters by name."""
        return self._parameters.values(names)

    def set_parameters(self, values: dict[str, Any]) -> dict[str, Any]:
        """Changes parameters, and returns their values after that by name. Tells clients why a value is refused."""
        for name, value in values.items():
            try:
                self._parameters.set(name, value)
            except (ValueError, TypeError) as error:
                self._tell(f"{error}")
        return self._parameters.values(values) if values else {}

    def _answer(self, service: BusService, request: ServiceRequest) -> bytes:
        """Calls a service and returns its response. In a thread of the server, which waits for that of the simulation."""
        answer: Future[bytes] = Future()
        self._mailbox.ask(partial(self._call, service, decoded(request.payload, service.srv_type.Request, CDR), answer))
        try:
            return answer.result(LONGEST_WAIT)
        except FutureTimeoutError:
            raise RuntimeError(f"{service.name} did not respond within {LONGEST_WAIT:g} s") from None

    def _call(self, service: BusService, request: Any, answer: Future[bytes]) -> None:
        called = self._node.create_client(service.srv_type, service.name).call_async(request)
        called.add_done_callback(lambda done: answer.set_result(encoded(done.result())))
        self._simulation.run_for(0.0)  # the response arrives at the same simulated time


def _schema(kind: type[Message]) -> Schema:
    """Returns the definition of a message class as clients read it."""
    return Schema(name=kind.ros_type, encoding="ros2msg", data=definition_of(kind).encode())
