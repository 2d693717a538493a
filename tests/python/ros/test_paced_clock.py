"""PacedClock: simulated time without jumps."""

from __future__ import annotations

from mobile_robot_simulator.ros.paced_clock import PacedClock


def test_a_change_of_speed_does_not_make_the_time_jump() -> None:
    wall = [1_000]
    clock = PacedClock(lambda: wall[0])
    seen = [clock.now().nanoseconds]
    for speed, step in ((1.0, 10), (4.0, 10), (0.5, 20)):
        clock.set_speed(speed)
        assert clock.now().nanoseconds == seen[-1]
        wall[0] += step
        seen.append(clock.now().nanoseconds)
    assert seen == [1_000, 1_010, 1_050, 1_060]
