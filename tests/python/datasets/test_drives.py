"""drives: the poses are those of a robot that a policy drives."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from datasets.policies import Recorder
from datasets.small_plans import small
from datasets.test_scenes import GRID, scene
from mobile_robot_simulator.datasets.drives import policy_of
from mobile_robot_simulator.datasets.job import job_of

HERE = "datasets.policies"


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


def test_a_policy_sees_the_noise_of_surfaces() -> None:
    plan = small(poses={"kind": "drives", "clearance": 0.2}, labels=["commands"], noise={"sigma_hit": 0.01})
    seeing = small(
        poses={"kind": "drives", "clearance": 0.2},
        labels=["commands"],
        noise={"sigma_hit": 0.01},
        surfaces={"incidence_bias": 0.5, "beam_divergence": 0.05},
    )
    assert not np.array_equal(scene(plan, 60)["commands"], scene(seeing, 60)["commands"])


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
        (f"{HERE}:__name__", ValueError, "must be module:name of a class or function, got"),
        (f"{HERE}:missing", ValueError, "must be module:name of a class or function, got"),
        (
            "no.such.module:x",
            ModuleNotFoundError,
            "poses.policy 'no.such.module:x': No module named 'no', neither in . nor else",
        ),
    ],
)
def test_a_wrong_policy(policy: str, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        policy_of(policy, Path())


def test_a_command_that_is_not_finite() -> None:
    plan = small(poses={"kind": "drives", "policy": f"{HERE}:wrong", "clearance": 0.2})
    with pytest.raises(ValueError, match=r"poses.policy 'datasets.policies:wrong': a command must be finite, got"):
        scene(plan, 3)


def test_commands_and_distances_to_the_goal() -> None:
    labels = ["commands", "goals", "goal_distances", "twists"]
    plan = small(poses={"kind": "drives", "policy": f"{HERE}:Recorder", "clearance": 0.2}, labels=labels)
    found = scene(plan, 9)
    assert found["commands"].tolist() == [[0.2, 0.1 * count] for count in range(1, 10)]
    assert np.allclose(found["goal_distances"], np.hypot(*(found["goals"] - found["poses"][:, :2]).T), rtol=1e-14, atol=0.0)
    # The robot follows a command after the scan.
    assert found["twists"][0].tolist() == [0.0, 0.0, 0.0] and (found["twists"][1:, 0] == 0.2).all()


def test_a_policy_knows_its_goal_by_odometry() -> None:
    # The encoders see a tenth more than the wheels turn.
    robot = {"odometry_alphas": [0.0, 0.0, 0.05, 0.0, 0.0, 0.0]}
    poses = {"kind": "drives", "policy": f"{HERE}:Recorder", "clearance": 0.2}
    seen = {}
    for name, parameters in {"exact": {}, "noisy": robot}.items():
        found = scene(small(poses={**poses, "robot": parameters}, labels=["goals"]), 20)
        places = [
            mrs.Pose(*pose).inverse() * mrs.Pose(*goal) for pose, goal in zip(found["poses"], found["goals"], strict=True)
        ]
        seen[name] = np.hypot(*(np.array(Recorder.goals) - [(place.x, place.y) for place in places]).T)
    assert seen["exact"].max() < 1e-9
    assert seen["noisy"][0] < 1e-9 and seen["noisy"][-1] > 1e-3


def test_a_policy_may_be_beside_the_plan(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "path", [*sys.path])
    (tmp_path / "policy_beside_the_plan.py").write_text("def make():\n    return lambda observation: (0.0, 0.5)\n")
    plan = small(
        poses={"kind": "drives", "policy": "policy_beside_the_plan:make", "clearance": 0.2},
        labels=["twists"],
        folder=tmp_path,
    )
    assert (scene(plan, 5)["twists"][1:] == [0.0, 0.0, 0.5]).all()
    (tmp_path / "other").mkdir()
    (tmp_path / "other/policy_beside_the_plan.py").write_text("")
    with pytest.raises(
        ValueError, match=r"other/policy_beside_the_plan.py cannot be imported, because .* has the same name"
    ):
        policy_of("policy_beside_the_plan:make", tmp_path / "other")


def test_a_policy_that_is_missing_is_found_before_anything_is_made() -> None:
    with pytest.raises(ModuleNotFoundError, match=r"poses.policy 'no_such_policy:x': No module named 'no_such_policy'"):
        job_of(small(poses={"kind": "drives", "policy": "no_such_policy:x"}))
