"""hostile arguments: whatever a function of the core gets, it returns or raises TypeError, ValueError or OverflowError."""

from __future__ import annotations

import inspect
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import _core

ALLOWED = (TypeError, ValueError, OverflowError)


class Trap(Exception):
    """Raised by objects that break when they are looked at. The core may hand it on."""


class Liar(np.ndarray):
    """An array whose attributes are wrong."""

    shape = (10**9, 3)  # type: ignore[assignment]
    ndim = 2  # type: ignore[assignment]
    dtype = np.dtype(np.float64)
    strides = (0, 0)
    size = 10**12
    flags = None

    def astype(self, *_: Any, **__: Any) -> Any:
        return "no array"

    copy = reshape = astype

    def __array__(self, *_: Any, **__: Any) -> Any:
        return "no array"


class Raises:
    """An object each of whose conversions raises."""

    def trap(self, *_: Any, **__: Any) -> Any:
        raise Trap

    __array__ = __dlpack__ = __dlpack_device__ = __float__ = __index__ = __int__ = __len__ = __getitem__ = __iter__ = trap
    __eq__ = __repr__ = __str__ = __bool__ = trap  # type: ignore[assignment]
    __hash__ = None  # type: ignore[assignment]


class Wrong:
    """An object each of whose conversions returns something of the wrong type."""

    def wrong(self, *_: Any, **__: Any) -> Any:
        return "wrong"

    __array__ = __dlpack__ = __float__ = __index__ = __iter__ = __getitem__ = wrong

    def __len__(self) -> int:
        return 2**62


class Huge:
    """An integer and a sequence that are far too large."""

    def __index__(self) -> int:
        return 10**400

    def __len__(self) -> int:
        return 2**63 - 1

    def __getitem__(self, index: int) -> float:
        return 0.0


class Looped(list):  # type: ignore[type-arg]
    """A list that holds itself."""

    def __init__(self) -> None:
        super().__init__()
        self.append(self)


def frozen(array: Any) -> Any:
    array.setflags(write=False)
    return array


HOSTILE: dict[str, Any] = {
    "none": None,
    "true": True,
    "text": "\udcff\0" * 100,
    "bytes": b"\x00" * 24,
    "empty tuple": (),
    "dict": {"x": 1.0},
    "set": {1.0, 2.0, 3.0},
    "class": dict,
    "object": object(),
    "zero": 0,
    "minus one": -1,
    "huge": 10**400,
    "minus huge": -(10**400),
    "2**64": 2**64,
    "2**63": 2**63,
    "2**63 - 1": 2**63 - 1,
    "nan": math.nan,
    "inf": math.inf,
    "largest": 1.7e308,
    "smallest": 5e-324,
    "complex": 1j,
    "nan triple": (math.nan, math.nan, math.nan),
    "large triple": (1.7e308, -1.7e308, 1.7e308),
    "text triple": "123",
    "ragged": [[1.0], [1.0, 2.0, 3.0]],
    "triple of huge": (10**400, 0, 0),
    "looped": Looped(),
    "pairs of nothing": [(None, None)],
    "pair without pose": [(mrs.Shape.disc(1.0), None)],
    "liar": np.zeros((2, 3)).view(Liar),
    "liar of int8": np.zeros((2, 3), np.int8).view(Liar),
    "liar of float32": np.zeros((2, 3), np.float32).view(Liar),
    "raises": Raises(),
    "wrong": Wrong(),
    "too large": Huge(),
    "scalar array": np.array(1.0),
    "no rows": np.zeros((0, 3)),
    "no columns": np.zeros((3, 0)),
    "no cells": np.zeros((0, 0), np.int8),
    "32 dimensions": np.zeros((1,) * 32),
    "objects": np.array([None, "a", 1], object),
    "strings": np.array([["a", "b", "c"]]),
    "times": np.zeros((1, 3), "M8[s]"),
    "records": np.zeros(3, [("a", np.float64), ("b", np.int8)]),
    "float16": np.zeros((1, 3), np.float16),
    "long double": np.zeros((1, 3), np.longdouble),
    "complex array": np.zeros((1, 3), np.complex128),
    "other byte order": np.zeros((1, 3), ">f8"),
    "read-only": frozen(np.zeros((1, 3))),
    "backwards": np.zeros((4, 3))[::-2, ::-1],
    "one number as a billion rows": np.lib.stride_tricks.as_strided(np.zeros(3), (1, 3), (0, 8)),
    "masked": np.ma.masked_array(np.zeros((1, 3)), mask=True),
}
for _type in (np.float64, np.float32, np.int8):
    for _count in (33, 64):
        try:
            HOSTILE[f"{_count} dimensions of {_type.__name__}"] = np.zeros((1,) * _count, _type)
        except ValueError:  # NumPy 1 has at most 32 dimensions.
            HOSTILE[f"{_count} nested lists of {_type.__name__}"] = np.zeros((1,) * 32, _type).tolist()


def grid() -> mrs.OccupancyGrid:
    return mrs.OccupancyGrid(np.array([[0, 0, 100], [0, -1, 0]], np.int8), resolution=1.0)


def good() -> dict[str, Any]:
    """A good value for each parameter of the core, by its name."""
    ranges = np.ones(5, np.float32)
    return {
        **dict.fromkeys(("x", "y", "yaw", "qx", "qy", "qz", "dt", "radius", "limit", "length", "width", "fraction"), 0.25),
        "scan_duration": 0.25,
        "temper": 0.25,
        "max_distance": 2.5,
        "step": 0.25,
        "ranges": ranges,
        "beams": [1, 3],
        "times": np.array([0.0, 0.5]),
        **dict.fromkeys(
            ("range_offset", "range_sigma_base", "range_sigma_per_metre", "range_step", "range_step_share"), 0.1
        ),
        **dict.fromkeys(("incidence_sigma", "incidence_limit", "incidence_bias", "correlation", "reference_range"), 0.5),
        **dict.fromkeys(("beam_divergence", "edge_depth", "mixing_length"), 0.1),
        **dict.fromkeys(("sigma_hit", "lambda_short", "z_hit", "z_short", "z_max", "z_rand", "resolution", "grip"), 0.5),
        **dict.fromkeys(("alpha1", "alpha2", "alpha3", "alpha4", "alpha5", "alpha6", "reference_step", "qw"), 0.5),
        **dict.fromkeys(("origin", "mount", "pose", "other", "twist", "wanted", "current", "command"), (0.5, 0.5, 0.0)),
        **dict.fromkeys(("velocity", "acceleration", "deceleration"), (1.0, 1.0, 1.0)),
        **dict.fromkeys(("seed", "row", "col", "n", "count", "index", "first_index", "next_index", "threads"), 1),
        **dict.fromkeys(("poses", "rays", "twists"), np.full((2, 3), 0.5)),
        **dict.fromkeys(("wheelbase", "track", "wheel_speed_limit", "left_radius", "right_radius"), 0.5),
        **dict.fromkeys(("steering_limit", "steering_rate", "steering_goal", "steering_angle", "time"), 0.5),
        "steering": [0.1, 0.2],
        "rates": [0.1, 0.2],
        "drive": CAR,
        "wheel_radius": [0.5, 0.5],
        "wheels": np.ones((2, 4)),
        "states": np.full((2, 4), 0.1),
        **dict.fromkeys(("before", "after"), np.ones(4)),
        "actions": np.full((2, 2), 0.5),
        "max_velocity": np.array([0.5, 1.0]),
        "elapsed": np.ones(2, np.int64),
        "weights": (1.0, 10.0, -10.0, -0.1, 0.0),
        "goal_radius": 0.25,
        "step_limit": 10,
        "ticks": 360.0,
        "fov": 1.0,
        **dict.fromkeys(("angle_min", "angle_max", "angle_increment"), None),
        "beam_count": 5,
        "min_range": 0.1,
        "max_range": 5.0,
        "cells": np.array([[0]], np.int8),
        "occupied_threshold": 50,
        "unknown": "free",
        "materials": np.zeros((1, 1), np.uint8),
        **{key: ["wall", mrs.Material("glass")] for key in ("material_table", "table")},
        **dict.fromkeys(("material", "kind"), "glass"),
        **dict.fromkeys(("reflectivity", "return_chance", "return_angle"), 0.5),
        "obstacles": [(mrs.Shape.disc(0.1), (0.5, 0.5, 0.0))],
        "placed": [(mrs.Shape.disc(0.1), (0.5, 0.5, 0.0))],
        "obstacle": None,
        "shape": mrs.Shape.disc(0.1),
        "noise": mrs.BeamModel(),
        "model": mrs.BeamModel(),
        "name": "hokuyo_utm30lx",
        "surfaces": mrs.SurfaceModel(incidence_sigma=0.5),
        "log_likelihood": -1.0,
        "iterations": 3,
        "has_converged": True,
        "standard_errors": {"sigma_hit": 0.1},
        "unidentified": ["lambda_short"],
        "out": None,
        "ax": None,
        "no_return": "max",
        "scans": [(mrs.LaserScanner(beam_count=5), grid(), (0.5, 0.5, 0.0), (), None, None, 0, 0)],
        "mode": "slide",
        "readings": ranges,
        "true_ranges": ranges,
        "incidences": ranges,
        "offset": None,
        "fit_offset": False,
        "covariance": np.eye(3),
        "points": [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)],
        "point": (0.0, 0.0),
        "normal": (1.0, 0.0),
        "grid": grid(),
        "footprint": mrs.Shape.disc(0.1),
        "grids": None,
        **dict.fromkeys(("seeds", "grid_of", "mask", "limits", "slip", "scanner"), None),
        **dict.fromkeys(("odometry_noise", "world_of", "clearance_limit"), None),
        "robot": 1,
        "contact": "stop",
        "clearance": 0.1,
        "commands": np.full((2, 3), 0.5),
        "duration": 0.25,
        "scan": True,
        "state": fleet().save(),
        "words": fleet().save().words,
        "goals": np.zeros((2, 2)),
        **dict.fromkeys(("velocities",), np.zeros((2, 3))),
        "contacts": np.zeros(2, bool),
        "contact_points": np.zeros((2, 2)),
        **dict.fromkeys(("contact_obstacles", "contact_robots"), np.zeros(2, np.int64)),
        "odometry": np.zeros((2, 3)),
        "clearances": None,
    }


CAR = mrs.Drive.ackermann(wheelbase=2.5, track=1.5, wheel_radius=0.3, steering_limit=0.6)


def fleet() -> mrs.Fleet:
    obstacles = [(mrs.Shape.disc(0.1), None, 1)]
    return mrs.Fleet(grid(), np.full((2, 3), 0.5), scanner=mrs.LaserScanner(beam_count=5), obstacles=obstacles)


def instances() -> list[Any]:
    return [
        mrs.BeamModel(),
        mrs.SurfaceModel(),
        mrs.LikelihoodField(),
        mrs.BeamModel.fit(np.full(4, 5.0, np.float32), np.float32([4.9, 5.0, 5.1, 8.0]), 8.0),
        mrs.Contact(point=(0.0, 0.0), normal=(1.0, 0.0), fraction=0.5),
        CAR,
        fleet(),
        fleet().save(),
        fleet().step(np.zeros((2, 3)), 0.1),
        mrs.LaserScanner(fov=1.0, beam_count=5, max_range=5.0),
        mrs.Limits(),
        mrs.Material(),
        mrs.MotionNoise(),
        grid(),
        mrs.Obstacles([(mrs.Shape.disc(0.1), (0.5, 0.5, 0.0))]),
        mrs.Pose(),
        mrs.RandomStream(1),
        mrs.Shape.disc(0.1),
        mrs.WheelMotion(CAR, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),
    ]


OF_ITS_OWN = {
    "Fleet": {"grids": grid(), "noise": None, "surfaces": None},
    "Fleet.replace_obstacles": {"obstacles": [(0, mrs.Shape.disc(0.1), (0.5, 0.5, 0.0))]},
    "Fleet.rollout": {"commands": np.full((2, 4, 3), 0.5)},
    "judge_steps": dict.fromkeys(("before", "after"), np.ones((2, 2))),
    "Material.named": {"name": "glass"},
    "OccupancyGrid.with_materials": {"materials": np.zeros(grid().shape, np.uint8)},
    "FleetStep": {"ranges": np.zeros((2, 5), np.float32)},
}
"""Good values of parameters that mean something else elsewhere."""
SPECIAL = {"__getitem__": ("index",), "__mul__": ("other",), "__rmul__": ("other",), "__eq__": ("other",)}
# It hands its argument to Matplotlib.
NOT_OURS = {"OccupancyGrid.plot"}


def functions() -> Iterator[tuple[str, Any, tuple[str, ...]]]:
    """Name, callable and parameters of every public function, constructor and method of the core."""
    for name in _core.__all__:
        thing = getattr(_core, name)
        if callable(thing) and (parameters := tuple(inspect.signature(thing).parameters)):
            yield name, thing, parameters
    for owner in instances():
        kind = type(owner)
        for name in vars(kind):
            call, full = getattr(owner, name), f"{kind.__name__}.{name}"
            if not name.startswith("_") and callable(call) and full not in NOT_OURS:
                yield full, call, tuple(inspect.signature(call).parameters)
            elif name in SPECIAL:
                yield full, call, SPECIAL[name]


FUNCTIONS = {name: (call, parameters) for name, call, parameters in functions()}


@pytest.mark.parametrize("name", [name for name in FUNCTIONS if "__" not in name])
def test_good_arguments_are_good(name: str) -> None:
    """Otherwise the hostile ones would not be reached."""
    call, parameters = FUNCTIONS[name]
    given = good() | OF_ITS_OWN.get(name, {})
    call(**{parameter: given[parameter] for parameter in parameters})


POSES = ("origin", "mount", "pose", "other")
NUMBERS = [
    (name, parameter, type(good()[parameter]))
    for name, (_, parameters) in FUNCTIONS.items()
    if "__" not in name
    for parameter in parameters
    if isinstance(good()[parameter], (float, tuple)) and parameter not in POSES
]


@pytest.mark.parametrize(("name", "parameter", "kind"), NUMBERS)
def test_an_argument_that_is_no_number_is_named(name: str, parameter: str, kind: type) -> None:
    call, parameters = FUNCTIONS[name]
    given = {other: (good() | OF_ITS_OWN.get(name, {}))[other] for other in parameters}
    count = {"point": "two", "normal": "two", "weights": "five"}.get(parameter, "three")
    needed = f"^{parameter} must be " + ("a number" if kind is float else f"{count} numbers")
    with pytest.raises(TypeError, match=f"{needed}, got 'far'$"):
        call(**given | {parameter: "far"})
    with pytest.raises(ValueError, match=f"{needed}, got "):
        call(**given | {parameter: 10**400 if kind is float else (1.0,)})


@pytest.mark.parametrize("name", [name for name, (_, parameters) in FUNCTIONS.items() if "footprint" in parameters])
def test_a_footprint_that_is_no_shape_is_named(name: str) -> None:
    call, parameters = FUNCTIONS[name]
    with pytest.raises(TypeError, match=r"^footprint must be a Shape, got float; make one with Shape\.disc"):
        call(**{other: (good() | OF_ITS_OWN.get(name, {}))[other] for other in parameters} | {"footprint": 0.3})


@pytest.mark.parametrize("name", FUNCTIONS)
def test_hostile_arguments_raise_no_other_error(name: str) -> None:
    call, parameters = FUNCTIONS[name]
    for parameter in parameters:
        for what, value in HOSTILE.items():
            given = good() | OF_ITS_OWN.get(name, {})
            try:
                if "__" in name:
                    call(value)
                else:
                    call(**{other: given[other] for other in parameters} | {parameter: value})
            except (*ALLOWED, Trap):
                pass
            except IndexError:
                assert name == "Pose.__getitem__"
            except MemoryError:
                assert what in ("too large", "wrong")  # They claim a length for which there is no memory.
            except BaseException as error:  # A panic is no Exception.
                pytest.fail(f"{name}({parameter}={what}) raised {type(error).__name__}: {str(error)[:300]}")
