"""track: poses between poses."""

from __future__ import annotations

from mobile_robot_simulator.logs.track import LONGEST_GAP_NS, Track
from mobile_robot_simulator.nodes.rigid_transform import RigidTransform


def at(x: float) -> RigidTransform:
    return RigidTransform((x, 0.0, 0.0))


def track(*poses: tuple[int, float]) -> Track:
    made = Track()
    for stamp, x in poses:
        made.add(stamp, at(x))
    return made


def test_between_two_poses_in_any_order() -> None:
    assert track((200, 3.0), (100, 1.0)).at(150, moving=True) == at(2.0)


def test_a_later_pose_of_a_stamp_replaces_the_first() -> None:
    assert track((100, 1.0), (100, 5.0)).at(100, moving=True) == at(5.0)


def test_outside_there_is_none_unless_a_correction_stays() -> None:
    poses = track((100, 1.0), (200, 3.0))
    assert poses.at(99, moving=True) is None and poses.at(99, moving=False) is None
    assert poses.at(201, moving=True) is None and poses.at(201, moving=False) == at(3.0)


def test_a_gap_is_bridged_only_by_corrections() -> None:
    for length, is_short in ((LONGEST_GAP_NS, True), (LONGEST_GAP_NS + 2, False)):
        poses = track((0, 0.0), (length, 2.0))
        assert (poses.at(length // 2, moving=True) == at(1.0)) is is_short
        assert poses.at(length // 2, moving=False) == at(1.0)
