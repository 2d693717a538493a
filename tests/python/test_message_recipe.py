"""MessageRecipe: the message that it builds has the values that it gives."""

from __future__ import annotations

import itertools
from typing import Any

import pytest

from mobile_robot_simulator import messages as ros
from mobile_robot_simulator.message_recipe import MessageRecipe, recipe

pytest.importorskip("rosbags")

from recordings import KINDS, filled, values_of


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_every_value_comes_to_its_field(kind: type[ros.Message]) -> None:
    message = filled(kind, itertools.count(1))
    built = MessageRecipe(kind, values_of)(message)
    assert type(built) is kind and built == message


def test_a_message_and_its_inner_messages_are_new_each_time() -> None:
    @recipe(ros.PointStamped)
    def point(x: float, frame: str = "map") -> tuple[Any, ...]:
        """Returns a point."""
        return 1, 2, frame, x, 0.0, 0.0

    first, second = point(0.5), point(0.5)
    assert first == ros.PointStamped(ros.Header(ros.Time(1, 2), "map"), ros.Point(0.5)) == second
    second.point.x = second.header.stamp.sec = 7
    assert first == point(0.5) and first != second
    assert point.__doc__ == "Returns a point." and point(0.5, "odom").header.frame_id == "odom"


def test_a_wrong_number_of_values_is_refused() -> None:
    with pytest.raises(ValueError, match="not enough values"):
        MessageRecipe(ros.Point, lambda: (0.0, 0.0))()


def test_a_recipe_can_say_what_its_messages_have_in_common() -> None:
    def split(stamp_ns: int, frame: str, x: float) -> tuple[str, tuple[float, ...]]:
        return frame, (*divmod(stamp_ns, 10**9), 2.0 * x)

    @recipe(ros.PointStamped, split)
    def point(frame: str, sec: int, nanosec: int, x: float) -> tuple[Any, ...]:
        """Returns a point."""
        return sec, nanosec, frame, x, x, 0.0

    assert point.values(5_000_000_007, "map", 0.5) == (5, 7, "map", 1.0, 1.0, 0.0)
    assert point(5_000_000_007, "map", 0.5) == ros.PointStamped(ros.Header(ros.Time(5, 7), "map"), ros.Point(1.0, 1.0))
    assert point.split is split and point.join("a", 1, 2, 3.0) == (1, 2, "a", 3.0, 3.0, 0.0)
