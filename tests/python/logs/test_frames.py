"""frames: parents, loops and static transforms."""

from __future__ import annotations

import pytest

from mobile_robot_simulator.logs.frames import Frames
from mobile_robot_simulator.nodes.rigid_transform import RigidTransform


def at(x: float) -> RigidTransform:
    return RigidTransform((x, 0.0, 0.0))


def chain() -> Frames:
    """map -> odom (a correction) -> base (moves) -> laser (static)."""
    frames = Frames()
    frames.add_pose("base", "laser", 0, at(100.0), static=True)
    for second in range(3):
        frames.add_pose("odom", "base", second * 10**9, at(1.0 * second))
    frames.add_pose("map", "odom", 0, at(10.0))
    return frames


def test_poses_are_multiplied_on_the_way_up() -> None:
    frames = chain()
    assert frames.pose("map", "laser", 1_500_000_000) == at(111.5)
    assert frames.pose("odom", "base", 500_000_000) == at(0.5)
    assert frames.pose("base", "laser", 99 * 10**9) == at(100.0)
    assert frames.pose("map", "laser", 2_000_000_001) is None
    assert frames.pose("elsewhere", "laser", 0) is None


def test_the_way_up() -> None:
    frames = chain()
    assert (frames.root_of("laser"), frames.base_of("laser"), frames.base_of("base")) == ("map", "base", "base")
    assert frames.has_above("laser", "odom") and not frames.has_above("odom", "laser")


def test_a_second_parent_is_refused() -> None:
    with pytest.raises(ValueError, match="a frame must have one parent, got map and odom for base"):
        chain().add_pose("map", "base", 0, at(0.0))


def test_loops_end() -> None:
    frames = Frames()
    frames.add_pose("a", "b", 0, at(1.0), static=True)
    frames.add_pose("b", "a", 0, at(1.0), static=True)
    assert frames.pose("c", "a", 0) is None and not frames.has_above("a", "c")
    assert frames.root_of("a") in ("a", "b") and frames.base_of("a") in ("a", "b")
