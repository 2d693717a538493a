"""drives: the poses are those of a robot that a policy drives."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from datasets.small_plans import small
from datasets.test_scenes import GRID, scene
from mobile_robot_simulator.benchmarks import Observation
from mobile_robot_simulator.datasets.drives import policy_of


class TowardsGoal:
    """Turns to the goal, and drives slowly."""

    def __call__(self, observation: Observation) -> tuple[float, float]:
        x, y = observation.goal
        assert len(observation.scan.ranges) == 31
        return 0.3, max(-1.0, min(1.0, 2.0 * math.atan2(y, x)))


def wrong() -> object:
    return lambda observation: (math.nan, 0.0)


HERE = "datasets.test_drives"


def test_a_drive_follows_the_policy_to_its_goal() -> None:
    plan = small(
        poses={"kind": "drives", "policy": f"{HERE}:TowardsGoal", "clearance": 0.2},
        labels=["twists", "goals", "true_ranges"],
        obstacles={"count": 2, "radius": 0.1},
    )
    found, again, other = scene(plan, 60), scene(plan, 60), scene(plan, 60, "train/1")
    assert all(np.array_equal(found[name], again[name]) for name in found)
    assert not np.array_equal(found["goals"], other["goals"]) and (found["goals"] == found["goals"][0]).all()
    # Between two scans without contact, the robot follows its twist exactly.
    steps = [
        np.array(mrs.Pose(*pose).integrate(twist, 0.1))
        for pose, twist in zip(found["poses"][:-1], found["twists"][1:], strict=True)
    ]
    follows = np.isclose(steps, found["poses"][1:], atol=1e-9).all(axis=1)
    assert follows.mean() > 0.5 and (found["twists"][1:, 0] == 0.3)[follows].any()
    assert (mrs.clearance_batch(GRID, mrs.Shape.disc(0.19), found["poses"], limit=1.0) > 0.0).all()


def test_without_a_policy_the_robot_roams() -> None:
    plan = small(poses={"kind": "drives", "clearance": 0.2}, labels=["twists"])
    found, again, other = scene(plan, 100), scene(plan, 100), scene(plan, 100, "train/1")
    assert all(np.array_equal(found[name], again[name]) for name in found)
    assert not np.array_equal(found["poses"], other["poses"])
    moves = np.hypot(*np.diff(found["poses"][:, :2], axis=0).T)
    assert moves.sum() > 0.5 and (np.abs(found["twists"][:, 0]) <= 0.8).all()
    assert (mrs.clearance_batch(GRID, mrs.Shape.disc(0.19), found["poses"], limit=1.0) > 0.0).all()


@pytest.mark.parametrize(
    ("policy", "error", "message"),
    [
        (f"{HERE}:HERE", ValueError, "must be module:name of a class or function, got"),
        (f"{HERE}:missing", ValueError, "must be module:name of a class or function, got"),
        ("no.such.module:x", ModuleNotFoundError, "no"),
    ],
)
def test_a_wrong_policy(policy: str, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        policy_of(policy)


def test_a_command_that_is_not_finite() -> None:
    plan = small(poses={"kind": "drives", "policy": f"{HERE}:wrong", "clearance": 0.2})
    with pytest.raises(ValueError, match="a command of the policy must be finite, got"):
        scene(plan, 3)
