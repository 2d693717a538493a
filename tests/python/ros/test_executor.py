"""Executor: callbacks one at a time, and timers that follow their clock."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Iterator
from contextlib import suppress

import pytest

from mobile_robot_simulator.instant import Instant
from mobile_robot_simulator.ros.executor import Executor
from mobile_robot_simulator.ros.paced_clock import PacedClock


def test_timers_follow_the_speed_of_their_clock() -> None:
    executor, fired, began = Executor(), threading.Event(), time.monotonic_ns()
    clock = PacedClock(lambda: time.monotonic_ns() - began)
    executor.create_timer(executor.follow(clock), 1000.0, fired.set)
    time.sleep(0.05)  # Now the executor waits for 1000 s.
    assert not fired.is_set()
    clock.set_speed(1e6)
    executor.wake()
    assert fired.wait(60.0)
    executor.shutdown()


def test_timers_fire_together_at_multiples_of_their_periods() -> None:
    wall, fired = [1_007_000_000], list[str]()
    executor = Executor()
    clock = executor.follow(PacedClock(lambda: wall[0]))
    for name, period in (("fast", 0.01), ("slow", 0.02), ("other", 0.025)):
        executor.create_timer(clock, period, lambda name=name: fired.append(name))
    for time_ns, expected in (
        (1_009_999_999, []),
        (1_010_000_000, ["fast"]),
        (1_020_000_001, ["fast", "slow"]),
        # Several multiples were missed: each timer fires once, in the order of the last ones: 1.04, 1.05 and 1.05.
        (1_050_000_000, ["slow", "fast", "other"]),
        (1_060_000_000, ["fast", "slow"]),
        # The clock jumps back.
        (505_000_000, []),
        (510_000_000, ["fast"]),
    ):
        fired.clear()
        wall[0] = time_ns
        executor.serialized(lambda: None)()
        assert fired == expected
    executor.shutdown()


def test_a_callback_runs_after_the_timers_that_were_due_before_it() -> None:
    """Otherwise it would move the robot to a time that is later than that of the timers."""
    wall, seen = [1_000_000_000], list[tuple[str, int]]()
    executor = Executor()
    clock = executor.follow(PacedClock(lambda: wall[0]))

    def see(name: str) -> None:
        seen.append((name, clock.now().nanoseconds))
        # Time passes while a callback runs, but it does not see that.
        wall[0] += 1_000_000
        seen.append((name, clock.now().nanoseconds))

    def set_wall_and_call_twice() -> None:
        wall[0] = 1_100_200_000
        inner = executor.serialized(see)
        executor.serialized(lambda: [inner("message"), inner("nested")])()

    # Nothing fires the timers in the meantime.
    with executor._callback_lock:
        executor.create_timer(clock, 0.1, lambda: see("robot"))
        executor.create_timer(clock, 0.05, lambda: see("laser"))
        set_wall_and_call_twice()
    executor.shutdown()
    timers = [(name, 1_100_000_000) for name in ("robot", "laser") for _ in range(2)]
    assert seen == timers + [(name, 1_100_200_000) for name in ("message", "nested") for _ in range(2)]


def test_a_timer_of_many_centuries_does_not_stop_the_others() -> None:
    executor, fired = Executor(), threading.Event()
    executor.create_timer(executor.wall_clock, 1e12, lambda: None)
    time.sleep(0.05)
    executor.create_timer(executor.wall_clock, 0.01, fired.set)
    assert fired.wait(60.0)
    executor.shutdown()


def test_a_clock_that_fails_ends_the_executor() -> None:
    class Broken:
        readings = 0

        def now(self) -> Instant:
            self.readings += 1
            if self.readings > 2:
                raise RuntimeError("the clock is broken")
            return Instant(0)

    executor = Executor()
    executor.create_timer(executor.follow(Broken()), 0.01, lambda: None)
    with pytest.raises(RuntimeError, match="the clock is broken"):
        executor.wait()


def test_callbacks_run_one_at_a_time() -> None:
    executor, running, most = Executor(), [0], [0]

    def work() -> None:
        running[0] += 1
        most[0] = max(most[0], running[0])
        time.sleep(0.002)
        running[0] -= 1

    threads = [threading.Thread(target=lambda: [executor.serialized(work)() for _ in range(20)]) for _ in range(4)]
    executor.create_timer(executor.wall_clock, 0.001, work)
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    executor.shutdown()
    assert most == [1]


def test_wait_raises_what_a_timer_raised() -> None:
    executor = Executor()

    def fail() -> None:
        raise ZeroDivisionError

    executor.create_timer(executor.wall_clock, 0.01, fail)
    with pytest.raises(ZeroDivisionError):
        executor.wait()


@pytest.fixture
def restore_signal_handlers() -> Iterator[None]:
    handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    yield
    for number, handler in handlers.items():
        signal.signal(number, handler)


@pytest.mark.usefixtures("restore_signal_handlers")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_block(number: signal.Signals) -> None:
    executor = Executor()
    with executor.until_signalled():
        signal.raise_signal(number)
        pytest.fail("the block went on")
    executor.wait()
    assert signal.getsignal(number) == signal.SIG_IGN


@pytest.mark.usefixtures("restore_signal_handlers")
def test_a_signal_ends_the_wait_even_if_other_code_has_caught_its_exception() -> None:
    executor, ended = Executor(), list[bool]()
    with executor.until_signalled():
        with suppress(BaseException):
            signal.raise_signal(signal.SIGINT)
        waiting = threading.Thread(target=lambda: (executor.wait(), ended.append(True)), daemon=True)
        waiting.start()
        waiting.join(10.0)
    assert ended == [True]


def test_a_serialized_callback_may_call_another_one() -> None:
    executor = Executor()
    inner = executor.serialized(lambda value: value + 1)
    assert executor.serialized(lambda value: 2 * inner(value))(3) == 8
    executor.shutdown()


def test_a_destroyed_timer_does_not_fire() -> None:
    executor, fired, ended = Executor(), list[str](), threading.Event()
    # Nothing fires the timers in the meantime.
    with executor._callback_lock:
        destroyed = executor.create_timer(executor.wall_clock, 0.05, lambda: fired.append("destroyed"))
        executor.create_timer(executor.wall_clock, 0.05, ended.set)
        executor.destroy_timer(destroyed)
    assert ended.wait(60.0)
    executor.shutdown()
    assert not fired


def test_nothing_fires_within_an_event() -> None:
    executor, fired, wall = Executor(), list[int](), [1_000_000_000]
    clock = executor.follow(PacedClock(lambda: wall[0]))
    with executor.event():
        executor.create_timer(clock, 0.01, lambda: fired.append(wall[0]))
        wall[0] += 20_000_000
        with executor.event():
            executor.serialized(lambda: None)()
        assert fired == []
    executor.serialized(lambda: None)()
    assert fired == [1_020_000_000]
    executor.shutdown()
