"""TransformBuffer: lookups between frames at a time, with extrapolation."""

from __future__ import annotations

import math

import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import messages
from mobile_robot_simulator.nodes.transforms import TransformBuffer

SECOND = 1_000_000_000


def link(
    parent: str, child: str, pose: mrs.Pose | tuple[float, float, float], seconds: float = 0.0
) -> mrs.messages.TransformStamped:
    header = mrs.messages.Header(mrs.messages.Time.from_nanoseconds(round(seconds * SECOND)), parent)
    return mrs.messages.TransformStamped(header, child, messages.Transform.from_planar(mrs.Pose(*pose)))


def close(found: mrs.Pose | None, expected: mrs.Pose | tuple[float, float, float]) -> bool:
    assert found is not None
    return tuple(found) == pytest.approx(tuple(expected), abs=1e-12)


@pytest.fixture
def buffer() -> TransformBuffer:
    return TransformBuffer()


def test_a_chain_is_looked_up_both_ways(buffer: TransformBuffer) -> None:
    map_from_odom, odom_from_base, base_from_laser = mrs.Pose(1, 2, 0.3), mrs.Pose(-4, 0.5, 1.0), mrs.Pose(0.2, 0.0, math.pi)
    buffer.add(link("map", "odom", map_from_odom))
    buffer.add(link("odom", "base_link", odom_from_base))
    buffer.add(link("base_link", "laser", base_from_laser), static=True)
    map_from_laser = map_from_odom * odom_from_base * base_from_laser
    assert close(buffer.lookup("map", "laser", 0), map_from_laser)
    assert close(buffer.lookup("laser", "map", 0), map_from_laser.inverse())
    assert close(buffer.lookup("odom", "laser", 0), odom_from_base * base_from_laser)
    assert close(buffer.lookup("odom", "odom", 0), mrs.Pose())


def test_sibling_frames_are_connected_through_their_parent(buffer: TransformBuffer) -> None:
    buffer.add(link("base", "left", (0, 1, math.pi / 2)))
    buffer.add(link("base", "right", (1, -1, 0)))
    assert close(buffer.lookup("left", "right", 0), (-2, -1, -math.pi / 2))


@pytest.mark.parametrize(("target", "source"), [("map", "laser"), ("base", "moon"), ("moon", "base"), ("a", "base")])
def test_frames_that_are_not_connected_give_none(buffer: TransformBuffer, target: str, source: str) -> None:
    buffer.add(link("odom", "base", (1, 0, 0)))
    buffer.add(link("a", "b", (1, 0, 0)))
    assert buffer.lookup(target, source, 0) is None


def test_a_leading_slash_is_ignored(buffer: TransformBuffer) -> None:
    buffer.add(link("/odom", "/base", (1, 0, 0)))
    assert close(buffer.lookup("odom", "/base", 0), (1, 0, 0))


def test_a_frame_moves_on_the_arc_through_its_last_two_transforms(buffer: TransformBuffer) -> None:
    twist = (0.7, -0.2, 1.1)
    for seconds in (0.0, 0.1, 0.2):
        buffer.add(link("odom", "base", mrs.Pose(1, 2, 3).integrate(twist, seconds).wrapped(), seconds))
    for seconds in (0.0, 0.03, 0.1, 0.155, 0.2, 0.23, 1.2):
        found = buffer.lookup("odom", "base", round(seconds * SECOND))
        assert close(found.wrapped(), mrs.Pose(1, 2, 3).integrate(twist, seconds).wrapped())


def test_a_lookup_at_the_last_stamp_returns_its_pose_exactly(buffer: TransformBuffer) -> None:
    for count in range(5):
        pose = mrs.Pose(0.1 * count, math.sin(count), 0.3 * count).wrapped()
        buffer.add(link("odom", "base", pose, count))
        found = buffer.lookup("odom", "base", count * SECOND)
        assert (found.x, found.y) == (pose.x, pose.y)


@pytest.mark.parametrize("seconds", [1.99, 4.01])
def test_lookups_far_from_the_last_stamp_give_none(buffer: TransformBuffer, seconds: float) -> None:
    for stamp in (0.0, 1.0, 2.0, 3.0):
        buffer.add(link("odom", "base", (stamp, 0, 0), stamp))
    assert buffer.lookup("odom", "base", round(seconds * SECOND)) is None


def odometry(child: str, vx: float, wz: float) -> mrs.messages.Odometry:
    message = mrs.messages.Odometry(child_frame_id=child)
    message.twist.twist = mrs.messages.Twist(mrs.messages.Vector3(vx), mrs.messages.Vector3(z=wz))
    return message


@pytest.mark.parametrize("seconds", [-0.4, 0.0, 0.3, 1.0])
def test_odometry_extrapolates_a_frame_from_its_last_transform(buffer: TransformBuffer, seconds: float) -> None:
    buffer.add(link("odom", "base", (9, 9, 9), 4.5))  # A jump of the robot, not a motion.
    buffer.add_twist(odometry("base", 0.7, 1.1))
    buffer.add(link("odom", "base", (1, 2, 3), 5.0))
    found = buffer.lookup("odom", "base", round((5.0 + seconds) * SECOND))
    assert close(found.wrapped(), mrs.Pose(1, 2, 3).integrate((0.7, 0.0, 1.1), seconds).wrapped())


def test_a_twist_that_is_not_finite_counts_as_standing_still(buffer: TransformBuffer) -> None:
    buffer.add_twist(odometry("base", math.nan, 0.0))
    buffer.add(link("odom", "base", (1, 2, 3), 5.0))
    assert close(buffer.lookup("odom", "base", round(5.5 * SECOND)), (1, 2, 3))


def test_a_correction_of_the_map_frame_is_not_extrapolated(buffer: TransformBuffer) -> None:
    for stamp in (0.0, 1.0):
        buffer.add(link("map", "odom", (10 * stamp, 0, 0), stamp))
        buffer.add(link("odom", "base", (stamp, 0, 0), stamp))
    assert close(buffer.lookup("map", "base", round(1.5 * SECOND)), (11.5, 0, 0))


def test_a_static_transform_holds_at_any_time(buffer: TransformBuffer) -> None:
    buffer.add(link("base", "laser", (0.2, 0, 0), 5.0), static=True)
    for seconds in (0, 5, 10**6):
        assert close(buffer.lookup("base", "laser", seconds * SECOND), (0.2, 0, 0))
    buffer.add(link("base", "laser", (0.3, 0, 0), 1.0), static=True)
    assert close(buffer.lookup("base", "laser", 0), (0.3, 0, 0))


def test_a_frame_with_one_transform_does_not_move(buffer: TransformBuffer) -> None:
    buffer.add(link("odom", "base", (1, 2, 3), 1.0))
    assert close(buffer.lookup("odom", "base", round(1.3 * SECOND)), (1, 2, 3))


def test_a_second_transform_with_the_same_stamp_replaces_the_first(buffer: TransformBuffer) -> None:
    buffer.add(link("odom", "base", (0, 0, 0), 0.0))
    buffer.add(link("odom", "base", (1, 0, 0), 1.0))
    buffer.add(link("odom", "base", (2, 0, 0), 1.0))
    assert close(buffer.lookup("odom", "base", SECOND), (2, 0, 0))
    assert close(buffer.lookup("odom", "base", SECOND // 2), (1, 0, 0))


def test_an_earlier_stamp_or_another_parent_starts_a_new_history(buffer: TransformBuffer) -> None:
    buffer.add(link("odom", "base", (5, 0, 0), 9.0))
    buffer.add(link("odom", "base", (1, 0, 0), 1.0))
    assert close(buffer.lookup("odom", "base", SECOND), (1, 0, 0))
    assert buffer.lookup("odom", "base", 9 * SECOND) is None
    buffer.add(link("map", "base", (2, 0, 0), 2.0))
    assert buffer.lookup("odom", "base", 2 * SECOND) is None
    assert close(buffer.lookup("map", "base", 2 * SECOND), (2, 0, 0))


def test_loops_of_frames_do_not_hang(buffer: TransformBuffer) -> None:
    buffer.add(link("a", "b", (1, 0, 0)))
    buffer.add(link("b", "a", (1, 0, 0)))
    buffer.add(link("c", "c", (1, 0, 0)))
    assert close(buffer.lookup("a", "b", 0), (1, 0, 0)) or close(buffer.lookup("a", "b", 0), (-1, 0, 0))
    assert buffer.lookup("a", "c", 0) is None


def test_the_root_replaces_an_unknown_target(buffer: TransformBuffer) -> None:
    assert buffer.lookup_or_root("map", "base", 0) is None
    buffer.add(link("odom", "base", (1, 2, 0)))
    assert close(buffer.lookup_or_root("map", "base", 0), (1, 2, 0))
    buffer.add(link("map", "odom", (10, 0, 0)))
    assert close(buffer.lookup_or_root("map", "base", 0), (11, 2, 0))


def test_the_root_does_not_replace_a_known_target(buffer: TransformBuffer) -> None:
    buffer.add(link("odom", "base", (1, 2, 0)))
    buffer.add(link("map", "elsewhere", (0, 0, 0)))
    assert buffer.lookup_or_root("map", "base", 0) is None


@pytest.mark.parametrize("x", [math.nan, math.inf])
def test_a_transform_that_is_not_finite_is_refused(buffer: TransformBuffer, x: float) -> None:
    broken = link("odom", "base", (0, 0, 0))
    broken.transform.translation.x = x
    buffer.add(link("odom", "base", (1, 0, 0)))
    with pytest.raises(ValueError, match="finite"):
        buffer.add(broken)
    assert close(buffer.lookup("odom", "base", 0), (1, 0, 0))


def test_why_a_pose_is_missing(buffer: TransformBuffer) -> None:
    assert buffer.explain_missing("map", "base", 0) == "on topic /tf, where none has arrived"
    buffer.add(link("odom", "base", (1, 0, 0), seconds=5.0))
    late, early = 8 * SECOND, 2 * SECOND
    assert buffer.explain_missing("map", "wheel", late) == "on topic /tf, which has the frames base, odom"
    assert buffer.explain_missing("/map", "/base", late) == "but the last one from base to odom is 3.0 s old"
    assert buffer.explain_missing("map", "base", early) == "but the last one from base to odom is 3.0 s ahead of the clock"
    buffer.add(link("base", "odom", (1, 0, 0), seconds=5.0))
    assert buffer.explain_missing("map", "base", 5 * SECOND) == "but the transforms from odom to base and back form a loop"
    for number in range(20):
        buffer.add(link(f"a{number:02}", f"b{number:02}", (1, 0, 0)))
    assert buffer.explain_missing("map", "wheel", late).endswith(
        "the frames a00, a01, a02, a03, a04, a05, a06, a07, a08, a09, ..."
    )
