"""learning: plans to train on are other ones than plans to test on."""

from __future__ import annotations

import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.learning import training_plans, unseen_plans

SIZE = (10.0, 8.0)


def test_training_and_unseen_plans_have_different_seeds():
    training, unseen = (plans(3, "cave", size=SIZE, resolution=0.1) for plans in (training_plans, unseen_plans))
    everything = [mrs.floor_plan("cave", seed=seed, size=SIZE, resolution=0.1) for seed in range(6)]
    assert [plan.cells.tobytes() for plan in training] == [plan.cells.tobytes() for plan in everything[::2]]
    assert [plan.cells.tobytes() for plan in unseen] == [plan.cells.tobytes() for plan in everything[1::2]]


def test_bad_arguments():
    with pytest.raises(ValueError, match="count must be at least 1, got 0"):
        unseen_plans(0)
    with pytest.raises(ValueError, match="kind must be one of"):
        training_plans(1, "castle")
