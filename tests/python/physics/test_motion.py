"""motion: commands are integrated exactly, the state can be read at any time, and snapshots restore everything."""

from __future__ import annotations

import math

import pytest

from mobile_robot_simulator import Pose
from mobile_robot_simulator.physics import motion as motion_module
from mobile_robot_simulator.physics.motion import Motion
from mobile_robot_simulator.physics.velocity_profile import STANDING

SECOND = 1_000_000_000


def driving(timeout: float = 0.0) -> Motion:
    """A robot that starts at (1, 2, 0) in a frame at (10, 0, 0) of the map and drives forward at 1 m/s."""
    motion = Motion(0, timeout, Pose(10.0), Pose(1.0, 2.0))
    motion.command((1.0, 0.0, 0.0), 0)
    return motion


def test_poses_are_exact_at_any_time_and_in_both_frames() -> None:
    motion = driving()
    motion.command((math.pi / 2, 0.0, math.pi / 2), SECOND)  # A quarter circle with a radius of 1 m.
    assert tuple(motion.pose(2 * SECOND)) == pytest.approx((3.0, 3.0, math.pi / 2))
    assert tuple(motion.map_pose(2 * SECOND)) == pytest.approx((13.0, 3.0, math.pi / 2))
    assert tuple(motion.map_pose_at(SECOND // 2)) == pytest.approx((11.5, 2.0, 0.0))
    assert motion.distance(2 * SECOND) == pytest.approx(1.0 + math.pi / 2)


def test_a_command_ends_at_its_timeout_and_a_repeated_one_extends_it() -> None:
    motion = driving(timeout=0.5)
    motion.command((1.0, 0.0, 0.0), SECOND // 4)
    assert motion.velocity(3 * SECOND // 4 - 1) == (1.0, 0.0, 0.0)
    assert motion.velocity(3 * SECOND // 4) == STANDING
    assert motion.pose(SECOND).x == pytest.approx(1.75)
    assert len(motion.trajectory(SECOND)) == 1


def test_slip_slows_the_robot_and_not_its_wheels() -> None:
    motion = driving()
    motion.slip(0.25, SECOND)
    assert motion.slipped
    assert motion.velocity(2 * SECOND) == (0.75, 0.0, 0.0) and motion.wheel_velocity(2 * SECOND) == (1.0, 0.0, 0.0)
    assert motion.pose(2 * SECOND).x == pytest.approx(2.75) and motion.wheel_pose(2 * SECOND).x == pytest.approx(3.0)


def test_moving_the_frame_moves_the_robot_in_the_map_only() -> None:
    motion = driving()
    motion.move_frame(Pose(20.0), SECOND)
    assert motion.pose(SECOND).x == 2.0 and motion.map_pose(SECOND).x == 22.0
    assert motion.map_pose(2 * SECOND).x == 23.0


def test_a_restored_motion_equals_the_saved_one() -> None:
    motion = driving(timeout=0.5)
    motion.slip(0.5, SECOND // 4)
    state = motion.save()
    motion.set_timeout(9.0, SECOND // 4)
    motion.stop(SECOND)
    motion.restore(state)
    assert motion.save() == state
    assert motion.velocity(SECOND // 2) == STANDING and motion.pose(SECOND).x == pytest.approx(1.375)


def test_a_continuing_motion_keeps_the_past() -> None:
    before = driving()
    motion = Motion(SECOND, 0.0, Pose(10.0), before.pose(SECOND)).continuing(before)
    assert motion.distance(SECOND) == 1.0 and motion.trajectory(SECOND)[0].start_ns == 0
    assert motion.map_pose_at(SECOND // 2).x == 11.5


def carry(motion: Motion, pose: Pose, time_ns: int) -> None:
    """Carries the robot to a pose in the map."""
    motion.move_frame(pose * motion.pose(time_ns).inverse(), time_ns)


def wandering(count: int) -> Motion:
    """A robot that changes its velocity every 0.1 s, and is moved to another place once."""
    motion = Motion(0, 0.0, Pose(), Pose())
    for nth in range(count):
        motion.command((0.5, 0.0, 0.4 * math.sin(nth)), nth * SECOND // 10)
        if nth == 100:
            carry(motion, Pose(50.0), nth * SECOND // 10)
    return motion


def test_a_long_trajectory_is_thinned_and_its_points_stay_exact(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = wandering(3000)
    monkeypatch.setattr(motion_module, "MAX_SEGMENTS", 200)
    thin = wandering(3000)
    assert len(whole.segments) == 3001 and len(thin.segments) <= 200
    assert thin.pose(300 * SECOND) == whole.pose(300 * SECOND) and thin.distance(300 * SECOND) == whole.distance(
        300 * SECOND
    )
    exact = {(segment.start_ns, tuple(segment.pose)) for segment in whole.segments}
    assert {(segment.start_ns, tuple(segment.pose)) for segment in thin.segments} <= exact
    assert thin.segments[0].start_ns == 0 and thin.segments[-1] == whole.segments[-1]
    # The jump to another place at 10 s is kept: just before it the robot is near the origin.
    assert thin.map_pose_at(10 * SECOND - 1).x < 6.0 and thin.map_pose_at(10 * SECOND).x == pytest.approx(50.0)
    assert thin.segments[-95:] == whole.segments[-95:]


def winding(count: int) -> Motion:
    """A robot that winds its way at 0.5 m/s, with a new command every 0.1 s."""
    motion = Motion(0, 0.0, Pose(), Pose())
    for nth in range(count):
        motion.command((0.5, 0.0, 0.3 * math.sin(0.02 * nth)), nth * SECOND // 10)
    return motion


def test_thinning_keeps_the_shape_of_the_oldest_part_too(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = winding(5000)
    monkeypatch.setattr(motion_module, "MAX_SEGMENTS", 400)
    thin = winding(5000)
    times = range(0, 500 * SECOND, SECOND // 3)
    assert len(thin.segments) <= 400 and whole.pose(500 * SECOND).y > 100.0
    far = [math.dist(tuple(thin.map_pose_at(time))[:2], tuple(whole.map_pose_at(time))[:2]) for time in times]
    assert max(far) < 0.3


def test_the_robot_is_at_rest_where_thinning_loses_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(motion_module, "MAX_SEGMENTS", 80)
    motion = Motion(0, 0.0, Pose(), Pose())
    for nth in range(20):  # A square corner each second, then a long time of going to and fro by a hair.
        motion.command((0.0, 1.0, 0.0) if nth % 2 else (1.0, 0.0, 0.0), nth * SECOND)
    for nth in range(20, 500):
        motion.command((1e-4 * (-1) ** nth, 0.0, 0.0), nth * SECOND)
    assert [tuple(motion.map_pose_at(nth * SECOND))[:2] for nth in range(20)] == [
        (float((nth + 1) // 2), float(nth // 2)) for nth in range(20)
    ]


def test_the_memory_of_a_long_drive_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(motion_module, "MAX_SEGMENTS", 1000)
    sizes = [len(wandering(count).segments) for count in (900, 5_000, 50_000)]
    assert sizes[0] == 901 and max(sizes[1:]) <= 1000


def test_a_robot_that_is_moved_again_and_again_keeps_the_latest_part(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(motion_module, "MAX_SEGMENTS", 800)
    calls: list[int] = []
    original = motion_module.thinned
    monkeypatch.setattr(motion_module, "thinned", lambda segments: calls.append(1) or original(segments))
    motion = Motion(0, 0.0, Pose(), Pose())
    for nth in range(1, 5001):
        carry(motion, Pose(float(nth)), nth * SECOND)
    assert len(motion.segments) <= 800 and motion.map_pose_at(4999 * SECOND).x == 4999.0
    # Each call makes room for at least a hundred segments, so the time of a long loop grows in proportion to its length.
    assert len(calls) <= 5000 // 100
