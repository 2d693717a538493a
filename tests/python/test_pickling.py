"""pickling: every object of the core survives every pickle protocol, `copy.copy` and `copy.deepcopy`."""

from __future__ import annotations

import copy
import inspect
import math
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import _core

READINGS = np.array([4.9, 5.0, 5.1, 8.0], np.float32)

CAR = mrs.Drive.ackermann(
    wheelbase=2.5, track=1.5, wheel_radius=(0.3, 0.31), steering_limit=0.6, steering_rate=0.5, wheel_speed_limit=40.0
)
FLEET = mrs.Fleet(
    mrs.OccupancyGrid(np.array([[0, 0, 100], [0, 0, 0]], np.int8), resolution=1.0),
    [(0.5, 0.5, 0.0), (0.5, 1.5, 0.3)],
    seeds=np.array([3, 2**63], np.uint64),
    footprint=mrs.Shape.disc(0.1),
    contact="slide",
    limits=[mrs.Limits(acceleration=(1.0, 1.0, 1.0)), mrs.Limits(velocity=(2.0, 2.0, 2.0))],
    drive=CAR,
    slip=[0.1, 0.0],
    scanner=mrs.LaserScanner(beam_count=5),
    noise=mrs.BeamModel(),
    clearance=0.05,
)
STEP = FLEET.step([(3.0, 0.2, 0.0), (1.0, 0.0, 1.0)], 3.017)

OBJECTS = [
    mrs.BeamModel.fit(np.full(4, 5.0, np.float32), READINGS, 8.0),
    mrs.BeamModel(sigma_hit=0.02, lambda_short=1.5, z_hit=4.0, z_short=2.0, z_max=1.0, z_rand=1.0),
    mrs.BeamModel(
        range_offset=-0.1, range_sigma_base=0.01, range_sigma_per_metre=0.02, range_step=0.001, range_step_share=0.01
    ),
    mrs.SurfaceModel(incidence_sigma=0.5, incidence_limit=1.4, incidence_bias=0.03, correlation=0.25, reference_range=9.0),
    mrs.SurfaceModel(beam_divergence=0.01, edge_depth=0.2, mixing_length=0.3),
    mrs.Contact(point=(1.0, -0.0), normal=(0.6, 0.8), fraction=0.25, obstacle=3),
    mrs.Contact(point=(0.0, 1e-300), normal=(0.0, 0.0), fraction=1.0),
    CAR,
    mrs.Drive.differential(track=0.4, wheel_radius=(0.1, 0.11)),
    mrs.Drive.omni(wheelbase=0.3, track=0.4, wheel_radius=0.1, wheel_speed_limit=math.inf),
    FLEET,
    FLEET.save([False, True]),
    STEP,
    mrs.LaserScanner(fov=3.0, beam_count=7, min_range=0.1, max_range=9.0, mount=(0.1, 0.2, 0.3)),
    mrs.Material("glass", reflectivity=0.2, return_chance=0.3, return_angle=0.4),
    mrs.LikelihoodField(sigma_hit=0.1, z_hit=3.0, z_rand=1.0, max_distance=0.7),
    mrs.Limits(velocity=(1.0, 0.0, 2.0), acceleration=(0.5, math.inf, 0.1)),
    mrs.MotionNoise(alpha1=0.1, alpha2=0.2, alpha3=0.3, alpha4=0.4, alpha5=0.5, alpha6=0.6, reference_step=0.01),
    mrs.OccupancyGrid(
        np.array([[0, 100, -1], [50, 7, 99]], np.int8),
        resolution=0.1,
        origin=(1.0, 2.0, 0.5),
        occupied_threshold=50,
        unknown="occupied",
    ),
    mrs.Obstacles([(mrs.Shape.disc(0.3), (0.1, 2.0, 0.5)), (mrs.Shape.rectangle(0.6, 0.4), (1.0, 0.0, 0.0))]).without(1),
    mrs.Pose(0.1, -0.0, math.pi),
    mrs.RandomStream(2**64 - 1, next_index=12),
    mrs.Shape.disc(0.3),
    mrs.Shape.rectangle(0.6, 0.4),
    mrs.WheelMotion(CAR, (0.5, 0.0, 0.0), (1.0, 0.0, 0.0), limits=mrs.Limits(), steering_angle=0.1, steering_goal=-0.2),
    mrs.Shape.polygon([(0.1, 0.0), (2.0, 0.3), (2.0, 1.0)]),
]


def through_pickle(protocol: int) -> Callable[[Any], Any]:
    return lambda thing: pickle.loads(pickle.dumps(thing, protocol))


def content(thing: Any) -> Any:
    """Everything that an object tells about itself."""
    data = {name for name, member in vars(type(thing)).items() if inspect.isgetsetdescriptor(member)}
    values = {name: getattr(thing, name) for name in data}
    return {
        name: (repr(value), value.tobytes() if isinstance(value, np.ndarray) else None) for name, value in values.items()
    }


def test_every_class_of_the_core_is_here() -> None:
    classes = {getattr(_core, name) for name in _core.__all__ if inspect.isclass(getattr(_core, name))}
    assert {type(thing) for thing in OBJECTS} == classes


@pytest.mark.parametrize("thing", OBJECTS, ids=repr)
@pytest.mark.parametrize(
    "duplicate",
    [
        copy.copy,
        copy.deepcopy,
        *(pytest.param(through_pickle(n), id=f"protocol {n}") for n in range(pickle.HIGHEST_PROTOCOL + 1)),
    ],
)
def test_a_duplicate_is_equal(thing: Any, duplicate: Callable[[Any], Any]) -> None:
    found = duplicate(thing)
    assert type(found) is type(thing) and repr(found) == repr(thing)
    assert content(found) == content(thing) != {}
    if type(thing).__eq__ is not object.__eq__:
        assert found == thing
