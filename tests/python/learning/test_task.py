"""learning: what a task refuses, and the numbers it derives."""

from __future__ import annotations

import re

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from learning.rooms import room, task
from mobile_robot_simulator.learning import NavigationEnv, NavigationTask
from mobile_robot_simulator.scenarios import Moving, Range

NAN = float("nan")


@pytest.mark.parametrize(
    "changes, kind, message",
    [
        ({"worlds": []}, TypeError, "worlds must be one or more OccupancyGrid, got []"),
        ({"worlds": ["map.yaml"]}, TypeError, "worlds must be one or more OccupancyGrid, got ['map.yaml']"),
        ({"worlds": 3}, TypeError, "worlds must be a sequence, got 3"),
        ({"obstacles": 3}, TypeError, "obstacles must be a Moving or None, got 3"),
        ({"obstacles": Moving(1, radius=Range(0.0, 1.0))}, ValueError, "obstacles.radius.low must be above 0, got 0"),
        ({"obstacles": Moving(1, speed=Range(0.0, 1e3))}, ValueError, "speed.high must be at most 100 m/s, got 1000"),
        ({"noise": 3}, TypeError, "noise must be a BeamModel or None, got 3"),
        ({"limits": 3}, TypeError, "limits must be a Limits or None, got 3"),
        ({"max_velocity": 3}, TypeError, "max_velocity must be a sequence, got 3"),
        ({"max_velocity": (1e4, 1.0)}, ValueError, "max_velocity must be above 0 and at most 1000, got 10000.0"),
        ({"rewards": 3}, TypeError, "rewards must be a dict, got 3"),
        ({"randomisation": 3}, TypeError, "randomisation must be a dict, got 3"),
        ({"randomisation": {"acceleration": (0.5, 1.0)}}, ValueError, "['acceleration'] needs limits, got limits=None"),
        ({"duration": 1e7}, ValueError, "duration must be at least 1e-9 and at most 1e6, got 10000000.0"),
        ({"scanner": 3}, TypeError, "scanner must be a LaserScanner, got 3"),
        ({"footprint": 0.2}, TypeError, "footprint must be a Shape, got 0.2"),
        ({"duration": 0.0}, ValueError, "duration must be at least 1e-9 and at most 1e6, got 0.0"),
        ({"duration": "long"}, TypeError, "duration must be a number, got 'long'"),
        ({"time_limit": NAN}, ValueError, "time_limit must be above 0, got nan"),
        ({"clearance": -0.1}, ValueError, "clearance must be at least 0, got -0.1"),
        ({"max_velocity": (1.0,)}, ValueError, "max_velocity must be (v, ω) or (vx, vy, ω), got 1 numbers"),
        ({"max_velocity": (1.0, -1.0)}, ValueError, "max_velocity must be above 0 and at most 1000, got -1.0"),
        ({"goal_distances": (3.0, 2.0)}, ValueError, "goal_distances must be (low, high) with low <= high, got (3.0, 2.0)"),
        ({"goal_distances": 3.0}, ValueError, "goal_distances must be two numbers (low, high), got 3.0"),
        ({"goal_distances": (0.2, 2.0)}, ValueError, "goals must be farther than goal_radius, 0.45 m, got"),
        ({"rewards": {"gaol": 1.0}}, ValueError, "rewards must be of progress, goal, contact, time, turning, got 'gaol'"),
        ({"rewards": {"goal": NAN}}, ValueError, "rewards['goal'] must be finite, got nan"),
        (
            {"randomisation": {"mass": (0.0, 1.0)}},
            ValueError,
            "range_step_share, velocity, acceleration, deceleration, slip, got 'mass'",
        ),
        ({"randomisation": {"slip": (0.5, 2.0)}}, ValueError, "randomisation['slip'] must be in 0..1, got 2.0"),
        ({"randomisation": {"sigma_hit": (0.0, 1.0)}}, ValueError, "sigma_hit must be"),
        ({"goal_distances": (50.0, 60.0)}, ValueError, "50 m to 60 m from its start; got none in 1024 draws in world 0"),
        ({"footprint": mrs.Shape.disc(3.0)}, ValueError, "free space for a robot of radius 3.05 m, got none in world 0"),
    ],
)
def test_bad_arguments(changes, kind, message):
    with pytest.raises(kind, match=re.escape(message)):
        NavigationEnv(**task(**changes))


def test_an_episode_has_as_many_steps_as_fit_into_its_time():
    assert NavigationTask(**task(duration=0.1, time_limit=3.0)).step_limit == 30
    assert NavigationTask(**task(duration=0.1, time_limit=3.05)).step_limit == 31
    assert NavigationTask(**task(duration=0.1, time_limit=0.01)).step_limit == 1


def test_one_world_may_be_given_alone_and_weights_in_part():
    one = NavigationTask(**task(worlds=room(), rewards={"goal": 3}))
    assert [world.shape for world in one.grids] == [(30, 40)]
    assert one.rewards == {"progress": 1.0, "goal": 3.0, "contact": -10.0, "time": -0.1, "turning": 0.0}


def test_without_worlds_there_are_eight_floors():
    assert len(NavigationTask().grids) == 8


def test_what_is_not_randomised_stays():
    base = NavigationTask(**task(noise=mrs.BeamModel(sigma_hit=0.2, z_hit=0.5, z_rand=0.5, z_max=0.0)))
    noise, slip, limits = base.disturbed({"sigma_hit": 0.1, "slip": 0.25})
    assert slip == 0.25 and noise is not None and limits is None
    assert (noise.sigma_hit, noise.z_hit, noise.z_rand) == (0.1, 0.5, 0.5)
    assert base.disturbed({}) == (base.noise, 0.0, None)
    silent, *_ = NavigationTask(**task(noise=None)).disturbed({"sigma_hit": 0.1})
    assert silent is not None and (silent.sigma_hit, silent.z_hit) == (0.1, 1.0)
    assert np.isfinite(silent.lambda_short)
