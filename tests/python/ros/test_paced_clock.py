"""PacedClock and Loop: time without jumps, timers that follow it, callbacks one at a time."""

from __future__ import annotations

import signal
import threading
import time

import pytest

from mobile_robot_simulator.ros.executor import Loop
from mobile_robot_simulator.ros.paced_clock import PacedClock


def test_speed_counts_from_the_moment_of_the_change() -> None:
    wall = [1_000]
    clock = PacedClock(lambda: wall[0])
    seen = [clock.now().nanoseconds]
    for speed, step in ((1.0, 10), (4.0, 10), (0.5, 20)):
        clock.set_speed(speed)
        assert clock.now().nanoseconds == seen[-1]
        wall[0] += step
        seen.append(clock.now().nanoseconds)
    assert seen == [1_000, 1_010, 1_050, 1_060]


def test_timers_follow_the_speed() -> None:
    loop, clock, fired = Loop(), PacedClock(), list[float]()
    loop.create_timer(clock, 0.1, lambda: fired.append(time.monotonic()))
    clock.set_speed(10.0)
    loop.notify()
    time.sleep(0.5)
    loop.end()
    assert 35 <= len(fired) <= 51


def test_timers_fire_together_at_multiples_of_their_periods() -> None:
    wall, fired = [1_007_000_000], list[str]()
    loop, clock = Loop(), PacedClock(lambda: wall[0])
    time.sleep(0.003)
    for name, period in (("fast", 0.01), ("slow", 0.02), ("other", 0.025)):
        loop.create_timer(clock, period, lambda name=name: fired.append(name))
    for wall[0], expected in (
        (1_009_999_999, []),
        (1_010_000_000, ["fast"]),
        (1_020_000_001, ["fast", "slow"]),
        # What was missed in between is made up for once.
        (1_050_000_000, ["fast", "slow", "other"]),
        (1_060_000_000, ["fast", "slow"]),
        # Time goes back.
        (505_000_000, []),
        (510_000_000, ["fast"]),
    ):
        fired.clear()
        loop.notify()
        time.sleep(0.05)
        assert fired == expected
    loop.end()


def test_callbacks_take_turns() -> None:
    loop, inside, most = Loop(), [0], [0]

    def work() -> None:
        inside[0] += 1
        most[0] = max(most[0], inside[0])
        time.sleep(0.002)
        inside[0] -= 1

    threads = [threading.Thread(target=lambda: [loop.in_turn(work)() for _ in range(20)]) for _ in range(4)]
    loop.create_timer(PacedClock(), 0.001, work)
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    loop.end()
    assert most == [1]


def test_what_a_timer_raises_comes_out_of_wait(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(signal, "signal", lambda *_: None)
    loop = Loop()

    def fail() -> None:
        raise ZeroDivisionError

    loop.create_timer(PacedClock(), 0.01, fail)
    with pytest.raises(ZeroDivisionError):
        loop.wait()
