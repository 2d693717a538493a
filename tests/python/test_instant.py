"""instant: arithmetic of instants and durations is exact in nanoseconds."""

from __future__ import annotations

import pickle

import pytest

from mobile_robot_simulator.instant import Duration, Instant
from mobile_robot_simulator.messages import Time


def test_a_duration_adds_seconds_and_nanoseconds() -> None:
    assert Duration(seconds=1.5, nanoseconds=2) == Duration(nanoseconds=1_500_000_002)
    assert Duration(seconds=0.1) < Duration(seconds=0.2)
    assert pickle.loads(pickle.dumps(Duration(seconds=1.5))) == Duration(seconds=1.5)


def test_instants_and_durations_add_and_subtract() -> None:
    instant = Instant(5, seconds=1.0)
    assert instant.nanoseconds == 1_000_000_005
    assert instant + Duration(nanoseconds=3) == Instant(1_000_000_008)
    assert instant - Duration(nanoseconds=5) == Instant(seconds=1.0)
    assert instant - Instant(5) == Duration(seconds=1.0)


@pytest.mark.parametrize("nanoseconds", [0, 1, 999_999_999, 1_000_000_000, 12_345_678_901])
def test_messages_convert_there_and_back(nanoseconds: int) -> None:
    instant = Instant(nanoseconds)
    assert instant.to_msg() == Time(*instant.seconds_nanoseconds())
    assert Instant.from_msg(instant.to_msg()) == instant


@pytest.mark.parametrize(("nanoseconds", "parts"), [(1_500_000_000, (1, 500_000_000)), (-1, (-1, 999_999_999))])
def test_durations_convert_there_and_back(nanoseconds: int, parts: tuple[int, int]) -> None:
    message = Duration(nanoseconds=nanoseconds).to_msg()
    assert (message.sec, message.nanosec) == parts and Duration.from_msg(message) == Duration(nanoseconds=nanoseconds)
