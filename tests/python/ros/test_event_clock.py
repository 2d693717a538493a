"""EventClock: a clock that goes from event to event, and the timers that follow it."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mobile_robot_simulator.instant import Instant
from mobile_robot_simulator.ros.event_clock import POLL_PERIOD, EventClock
from mobile_robot_simulator.ros.paced_clock import PacedClock

MS = 1_000_000
START = 1_700_000_000_000 * MS


class Watch:
    """A clock that shows what it is set to."""

    def __init__(self, ns: int = START) -> None:
        self.ns = ns

    def now(self) -> Instant:
        return Instant(self.ns)


class Log(list[tuple[str, int]]):
    """The callbacks of timers, each with the time that it reads [ms since the start]."""

    def __init__(self, watch: Watch) -> None:
        super().__init__()
        self.watch = watch
        self.clock = EventClock(watch)

    def create_timer(self, name: str, period: float, *, takes_ms: float = 0.0) -> None:
        def fire() -> None:
            self.append((name, self.read()))
            self.watch.ns += round(takes_ms * MS)

        self.clock.create_timer(period, fire)

    def read(self) -> float:
        return (self.clock.now().nanoseconds - START) / MS

    def advance_to(self, ms: float) -> list[tuple[str, float]]:
        """Sets the watch, and returns the callbacks of the next call of `advance`."""
        self.clear()
        self.watch.ns = START + round(ms * MS)
        self.clock.advance()
        return list(self)


def test_timers_read_the_multiples_of_their_periods() -> None:
    log = Log(Watch())
    log.create_timer("robot", 0.1, takes_ms=3.0)
    log.create_timer("laser", 0.05, takes_ms=3.0)
    assert log.advance_to(49.9) == []
    assert log.read() == 49.9
    assert log.advance_to(50.3) == [("laser", 50.0)]
    assert log.read() == 50.3
    assert log.advance_to(100.3) == [("robot", 100.0), ("laser", 100.0)]


def test_between_two_events_the_time_stands_still() -> None:
    log = Log(Watch())
    log.advance_to(10.0)
    log.watch.ns += 5 * MS
    assert log.read() == 10.0


def test_a_timer_that_has_missed_multiples_reads_the_last_one() -> None:
    log = Log(Watch())
    for name, period in (("fast", 0.01), ("slow", 0.1), ("laser", 0.025)):
        log.create_timer(name, period)
    # In the order of these times.
    assert log.advance_to(299.0) == [("slow", 200.0), ("laser", 275.0), ("fast", 290.0)]
    assert log.advance_to(299.9) == []
    assert log.advance_to(300.0) == [("fast", 300.0), ("slow", 300.0), ("laser", 300.0)]


def test_after_a_jump_timers_go_on_with_the_next_multiple() -> None:
    log = Log(Watch())
    log.create_timer("robot", 0.1)
    assert log.advance_to(100.1) == [("robot", 100.0)]
    assert log.advance_to(-5_020.0) == []
    assert log.read() == -5_020.0
    assert log.advance_to(-5_000.0) == [("robot", -5_000.0)]
    assert log.advance_to(7_000_010.0) == [("robot", 7_000_000.0)]


def test_a_timer_of_a_thirtieth_of_a_second_fires_at_every_full_second_of_the_clock() -> None:
    """An hour at wall time: with a period rounded to nanoseconds, the timer would be 36 microseconds early."""
    log = Log(Watch())
    log.create_timer("camera", 1 / 30)
    for second in (1, 3600):
        log.advance_to(second * 1e3 - 1.0)
        assert log.advance_to(second * 1e3) == [("camera", second * 1e3)]
        assert log.advance_to(second * 1e3) == []


def test_a_timer_fires_once_at_a_time_that_is_rounded_to_nanoseconds() -> None:
    log = Log(Watch())
    log.create_timer("camera", 1 / 30)
    assert log.advance_to(33.333_333) == []
    assert [len(log.advance_to(33.333_334)) for _ in range(3)] == [1, 0, 0]
    # The time up to the next multiple is 33,333,333 ns or 33,333,334 ns. The latter is no jump.
    log.advance_to(100.0)
    assert log.clock.due_in() == POLL_PERIOD


def test_a_timer_that_a_callback_creates_starts_after_the_present() -> None:
    log = Log(Watch())
    log.clock.create_timer(0.1, lambda: log.create_timer("new", 0.004))
    log.create_timer("other", 0.1)
    assert log.advance_to(109.0) == [("other", 100.0)]
    # Not at 104 ms or 108 ms, because the clock has passed these times.
    assert log.advance_to(109.5) == []
    assert log.advance_to(112.0) == [("new", 112.0)]


@given(st.lists(st.tuples(st.floats(0.0, 300.0), st.booleans()), max_size=30))
def test_the_time_never_decreases(steps: list[tuple[float, bool]]) -> None:
    log = Log(Watch())
    seen = list[float]()
    for name, period, takes_ms in (("a", 0.1, 20.0), ("b", 0.03, 1.0), ("c", 1 / 30, 0.1), ("d", 0.1, 7.0)):
        log.create_timer(name, period, takes_ms=takes_ms)
    for milliseconds, creates_a_timer in steps:
        seen += [time for _, time in log.advance_to((log.watch.ns - START) / MS + milliseconds)]
        seen.append(log.read())
        if creates_a_timer:
            log.create_timer("new", 0.01)
    assert all(after >= before for before, after in pairwise(seen))


def test_the_wall_time_until_a_timer_is_due() -> None:
    wall = [START]
    paced = PacedClock(lambda: wall[0])
    clock = EventClock(paced)
    assert clock.due_in() == math.inf
    clock.create_timer(0.1, lambda: None)
    assert clock.due_in() == 0.1
    paced.set_speed(4.0)
    assert clock.due_in() == 0.025
    wall[0] += 50 * MS
    assert clock.due_in() == 0.0


@pytest.mark.parametrize(("ms", "due_in"), [(0.0, POLL_PERIOD), (99.0, 0.001), (101.0, 0.0), (-500.0, 0.0)])
def test_a_clock_of_ros_is_read_often_because_it_may_jump(ms: float, due_in: float) -> None:
    watch = Watch()
    clock = EventClock(watch)
    assert clock.due_in() == math.inf
    clock.create_timer(0.1, lambda: None)
    watch.ns += round(ms * MS)
    assert clock.due_in() == due_in


def test_an_alarm_goes_off_once_at_its_time_in_order_with_the_timers() -> None:
    log = Log(Watch())
    log.create_timer("timer", 0.1)
    log.clock.create_alarm(150 * MS, lambda: log.append(("alarm", log.read())))
    assert log.advance_to(140.0) == [("timer", 100.0)]
    assert log.clock.due_in() == pytest.approx(POLL_PERIOD)
    assert log.advance_to(260.0) == [("alarm", 150.0), ("timer", 200.0)]
    assert log.advance_to(290.0) == []


def test_an_alarm_goes_off_if_the_clock_jumps_back_to_before_it_was_set() -> None:
    log = Log(Watch())
    log.clock.create_alarm(150 * MS, lambda: log.append(("alarm", log.read())))
    assert log.advance_to(-20.0) == [("alarm", -20.0)]
    assert log.advance_to(200.0) == []
