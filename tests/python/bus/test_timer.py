"""Timers: when they fire, and how they are cancelled and reset."""

from __future__ import annotations

import math

import pytest

from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.node import BusNode

SECOND = 1_000_000_000


@pytest.mark.parametrize(("rate", "seconds"), [(10.0, 60), (3.0, 1000), (30.0, 600), (7.0, 700), (1000.0, 5), (0.1, 1000)])
def test_timers_fire_at_multiples_of_their_period_without_drift(bus: Bus, node: BusNode, rate: float, seconds: int) -> None:
    fired: list[int] = []
    node.create_timer(1.0 / rate, lambda: fired.append(bus.time_ns))
    bus.run_until(seconds * SECOND)
    assert fired == [round(count / rate * SECOND) for count in range(1, round(seconds * rate) + 1)]


def test_periods_count_from_the_creation_of_the_timer(bus: Bus, node: BusNode) -> None:
    fired: list[int] = []
    bus.run_until(7)
    node.create_timer(1.0, lambda: fired.append(bus.time_ns))
    bus.run_until(3 * SECOND)
    assert fired == [SECOND + 7, 2 * SECOND + 7]


def test_a_cancelled_timer_does_not_fire(bus: Bus, node: BusNode) -> None:
    fired: list[str] = []
    timer = node.create_timer(1.0, lambda: fired.append("one"))
    other = node.create_timer(1.0, lambda: (fired.append("two"), node.destroy_timer(other)))
    third = node.create_timer(1.0, lambda: fired.append("three"))
    node.create_timer(0.5, third.cancel)
    timer.cancel()
    assert timer.is_canceled()
    bus.run_until(5 * SECOND)
    assert fired == ["two"]


def test_a_timer_can_be_cancelled_and_reset(bus: Bus, node: BusNode) -> None:
    fired: list[float] = []
    timer = node.create_timer(0.4, lambda: fired.append(bus.time_ns / SECOND))
    bus.run_until(SECOND)
    timer.reset()
    assert timer.time_until_next_call() == timer.timer_period_ns == 400_000_000
    bus.run_until(1_500_000_000)
    timer.cancel()
    assert timer.is_canceled() and timer.time_until_next_call() is None
    bus.run_until(2_500_000_000)
    timer.reset()
    bus.run_until(3 * SECOND)
    assert fired == pytest.approx([0.4, 0.8, 1.4, 2.9])


@pytest.mark.parametrize("period", [0.0, -1.0, math.nan, 1e-10, math.inf])
def test_a_period_that_is_too_short_or_not_finite_is_refused(node: BusNode, period: float) -> None:
    with pytest.raises(ValueError, match="period"):
        node.create_timer(period, lambda: None)


def test_timers_of_one_time_fire_in_the_order_of_their_creation_whatever_their_periods(bus: Bus, node: BusNode) -> None:
    fired: list[tuple[int, int]] = []
    periods = [0.3, 0.1, 0.2, 0.6, 0.1, 0.3]
    for index, period in enumerate(periods):
        node.create_timer(period, lambda index=index: fired.append((bus.time_ns, index)))
    bus.run_until(6 * SECOND)
    times = {index: round(period * SECOND) for index, period in enumerate(periods)}
    due = [(time_ns, index) for index, period in times.items() for time_ns in range(period, 6 * SECOND + 1, period)]
    assert fired == sorted(due)


def test_the_bus_tells_which_timers_fire_next_at_this_time(bus: Bus, node: BusNode) -> None:
    due: list[list[str]] = []
    names = {}
    for name, period in (("first", 1.0), ("never", 1.0), ("slow", 2.0), ("last", 0.5)):
        timer = node.create_timer(period, lambda: due.append([names[timer] for timer in bus.due_timers]))
        names[timer] = name
        if name == "never":
            timer.cancel()
    bus.run_until(SECOND)
    assert due == [[], ["never", "last"], []]
    due.clear()
    bus.run_until(2 * SECOND)
    assert due == [[], ["slow", "last"], ["last"], []]


def test_after_an_exception_the_other_timers_of_that_time_still_fire_also_on_a_restored_bus(bus: Bus, node: BusNode) -> None:
    fired: list[str] = []

    def fail() -> None:
        raise ArithmeticError

    node.create_timer(1.0, lambda: fired.append("first"))
    failing = node.create_timer(1.0, fail)
    node.create_timer(0.5, lambda: fired.append("last"))
    with pytest.raises(ArithmeticError):
        bus.run_until(SECOND)
    assert fired == ["last", "first"] and bus.next_ns() == bus.time_ns == SECOND
    state = bus.save()
    failing.cancel()
    for _ in range(2):
        fired.clear()
        bus.run_until(2 * SECOND)
        assert fired == ["last", "last", "first", "last"]
        bus.restore(state)
        failing.cancel()


def test_a_timer_that_is_reset_twice_fires_once(bus: Bus, node: BusNode) -> None:
    fired: list[int] = []
    timer = node.create_timer(1.0, lambda: fired.append(bus.time_ns))
    bus.run_until(SECOND // 2)
    timer.reset()
    timer.reset()
    bus.run_until(2 * SECOND)
    assert fired == [3 * SECOND // 2]
