"""Message filters: each takes what the previous ones return."""

from __future__ import annotations

from mobile_robot_simulator.messages import Message, String
from mobile_robot_simulator.nodes.message_filters import filtered


def test_without_filters_a_message_is_sent_at_once() -> None:
    message = String("a")
    assert filtered([], "/topic", message) == [(0, message)]


def test_filters_apply_in_order_and_delays_add_up() -> None:
    def twice(topic: str, message: Message) -> list[tuple[int, Message]] | None:
        return [(1, message), (2, String("copy"))] if topic == "/topic" else None

    def drop_copies(topic: str, message: Message) -> list[tuple[int, Message]] | None:
        return [] if message == String("copy") else [(10, message)]

    message = String("a")
    assert filtered([twice, drop_copies], "/topic", message) == [(11, message)]
    assert filtered([drop_copies, twice], "/topic", message) == [(11, message), (12, String("copy"))]
    assert filtered([twice], "/other", message) == [(0, message)]
