"""Listener: what the threads of the server do when a client asks for something."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import Any, Protocol

from foxglove.websocket import ChannelView, Client, ClientChannel, ServerListener

from foxglove import Parameter

from .client_topics import Announced
from .mailbox import Mailbox


class Simulated(Protocol):
    """What a listener needs. All methods are called in the thread of the simulation."""

    def show_latched(self, topic: str) -> None:
        """Sends the messages again that a new subscriber of a latched topic receives."""

    def announce(self, client: int, channel: int, announced: Announced) -> None:
        """Makes a client ready to publish on a topic."""

    def withdraw(self, client: int, channel: int) -> None:
        """Ends what `announce` has begun."""

    def publish(self, client: int, channel: int, data: bytes) -> None:
        """Publishes a message of a client."""

    def get_parameters(self, names: list[str]) -> dict[str, Any]:
        """Returns values of parameters by name."""

    def set_parameters(self, values: dict[str, Any]) -> dict[str, Any]:
        """Changes parameters, and returns their values after that by name."""


class Listener(ServerListener):
    """Leaves what clients ask for to the thread of the simulation.

    What comes while too much waits, or after the end of the server, is lost, as on a topic.

    Args:
        mailbox: Takes the work.
        simulated: Does it.
    """

    def __init__(self, mailbox: Mailbox, simulated: Simulated) -> None:
        self._mailbox, self._simulated = mailbox, simulated

    def on_subscribe(self, client: Client, channel: ChannelView) -> None:
        """Sends what is latched."""
        self._leave(self._simulated.show_latched, channel.topic)

    def on_client_advertise(self, client: Client, channel: ClientChannel) -> None:
        """Makes the client ready to publish."""
        announced = Announced(channel.topic, channel.schema_name, channel.encoding)
        self._leave(self._simulated.announce, client.id, channel.id, announced)

    def on_client_unadvertise(self, client: Client, client_channel_id: int) -> None:
        """Ends what `on_client_advertise` has begun, also when the client goes."""
        self._leave(self._simulated.withdraw, client.id, client_channel_id)

    def on_message_data(self, client: Client, client_channel_id: int, data: bytes) -> None:
        """Publishes a message."""
        self._leave(self._simulated.publish, client.id, client_channel_id, data)

    def on_get_parameters(self, client: Client, param_names: list[str], request_id: str | None = None) -> list[Parameter]:
        """Returns parameters; all if no names are given."""
        return self._ask(self._simulated.get_parameters, param_names)

    def on_set_parameters(
        self, client: Client, parameters: list[Parameter], request_id: str | None = None
    ) -> list[Parameter]:
        """Changes parameters. Returns them as they are then, so the client sees what was refused."""
        return self._ask(self._simulated.set_parameters, {each.name: each.get_value() for each in parameters})

    def _leave(self, method: Callable[..., None], *arguments: Any) -> None:
        with suppress(RuntimeError):
            self._mailbox.leave(partial(method, *arguments))

    def _ask(self, method: Callable[[Any], dict[str, Any]], argument: Any) -> list[Parameter]:
        try:
            values = self._mailbox.ask(partial(method, argument))
        except RuntimeError:
            return []
        return parameters_of(values)


def parameters_of(values: dict[str, Any]) -> list[Parameter]:
    """Returns parameters with these values, by name."""
    return [Parameter(name, value=value) for name, value in values.items()]
