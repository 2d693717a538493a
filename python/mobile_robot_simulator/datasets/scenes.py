"""Scenes: scans with the same map, obstacles, scanner and noise, and what is known about them."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._core import BeamModel, OccupancyGrid, Pose, Shape, SurfaceModel, clearance_batch
from .drives import drive
from .plan import Plan, Poses, Twist, draw

__all__ = ["Column", "columns_of", "fill_scene", "poses_of_file"]

ROUNDS = 200
"""Number of times that poses are drawn until all are clear of obstacles."""

PIECE = 2**16
"""Number of beams that are cast without a look at whether to end: a few milliseconds, or 0.1 s with many obstacles."""

_Obstacles = list[tuple[Shape, Pose]]


class Column(NamedTuple):
    """An array of a data set, of which each scan has a row."""

    shape: tuple[int, ...]
    """Shape of a row."""

    dtype: str
    attributes: dict[str, Any]
    """What the numbers mean: units, frames, names of columns."""


def columns_of(plan: Plan) -> dict[str, Column]:
    """Returns the arrays of a data set by name."""
    beams = plan.scanner.beam_count
    pose = {"units": ["m", "m", "rad"], "columns": ["x", "y", "yaw"], "frame": "map"}
    ranges: dict[str, Any] = {"units": "m", "no_return": "max_range of the scanner"}
    result = {
        "ranges": Column((beams,), "float32", {**ranges, "meaning": "readings, with noise if the plan has any"}),
        "poses": Column((3,), "float64", {**pose, "meaning": "pose of the robot at beam 0"}),
        "map": Column((), "int32", {"meaning": "index of the map in the attribute maps of the store"}),
        "scene": Column((), "int64", {"meaning": "number of the scene in this split; with drives, of the episode"}),
    }
    if plan.quantization:
        result["ranges"].attributes["largest_step"] = plan.quantization
    drawn = drawn_names(plan)
    if drawn:
        meaning = "numbers that were drawn for the scene, in the units of the plan"
        result["drawn"] = Column((len(drawn),), "float64", {"columns": drawn, "meaning": meaning})
    twist = {"units": ["m/s", "m/s", "rad/s"], "columns": ["vx", "vy", "wz"], "frame": "robot"}
    labels = {
        "true_ranges": Column((beams,), "float32", {**ranges, "meaning": "ranges without noise"}),
        "twists": Column((3,), "float64", {**twist, "meaning": "velocity of the robot during the scan"}),
        "beam_poses": Column((beams, 3), "float64", {**pose, "meaning": "pose of the robot at each beam"}),
        "goals": Column(
            (2,), "float64", {"units": "m", "columns": ["x", "y"], "frame": "map", "meaning": "goal of the drive"}
        ),
        "goal_distances": Column(
            (), "float64", {"units": "m", "meaning": "length of the straight line from the robot to the goal of the drive"}
        ),
        "commands": Column(
            (2,),
            "float64",
            {
                "units": ["m/s", "rad/s"],
                "columns": ["speed", "turn_rate"],
                "frame": "robot",
                "meaning": "command that the policy gave after the scan, until the next one",
            },
        ),
        "surfaces": Column((beams,), "int32", {"meaning": "-1: no return; 0: a wall; k: obstacle k of the scene"}),
        "incidences": Column(
            (beams,),
            "float32",
            {"units": "rad", "meaning": "angle between the beam and the normal of its surface; NaN if none"},
        ),
    }
    return result | {name: labels[name] for name in plan.labels}


def drawn_names(plan: Plan) -> list[str]:
    """Returns the numbers of the scanner and the noise that are drawn for each scene, not given."""
    names = []
    if plan.scanner.max_range[0] < plan.scanner.max_range[1]:
        names.append("scanner.max_range")
    names += [f"scanner.mount[{index}]" for index, (low, high) in enumerate(plan.scanner.mount) if low < high]
    for part, numbers in (("noise", plan.noise), ("surfaces", plan.surfaces)):
        names += [f"{part}.{name}" for name, (low, high) in (numbers or ()) if low < high]
    return names


def fill_scene(
    plan: Plan,
    grid: OccupancyGrid,
    name: str,
    *,
    first: int,
    rows: slice,
    arrays: Mapping[str, NDArray[Any]],
    check: Callable[[], None] = lambda: None,
) -> None:
    """Writes the scans of a scene and what is known about them to arrays; not the columns `map` and `scene`.

    Args:
        plan: The plan.
        grid: Map of the scene.
        name: Name of the scene. Each random number is named by the seed of the plan, by this, and by what is drawn.
        first: Number of the scene's first scan, for poses of a file.
        rows: Rows of the arrays to write.
        arrays: The arrays by name.
        check: Called many times a second. An exception of it ends the work.

    Raises:
        ValueError: There is no free place for a pose, or the file of poses is invalid.
    """
    count = rows.stop - rows.start

    def seed(what: str) -> int:
        return random.Random(f"{plan.seed}/{name}/{what}").getrandbits(63)

    dice = random.Random(f"{plan.seed}/{name}/draw")
    scanner = plan.scanner.made(dice)
    noise = None if plan.noise is None else plan.noise.drawn(dice)
    model = None if noise is None else BeamModel(**noise)
    # Drawn from its own dice, so that obstacles and twists do not depend on it.
    surfaces = None if plan.surfaces is None else plan.surfaces.drawn(random.Random(f"{plan.seed}/{name}/surfaces"))
    surface_model = None if surfaces is None else SurfaceModel(**surfaces)
    obstacles = _drawn_obstacles(plan, grid, dice, seed("obstacles"))
    twists: NDArray[np.float64] | None = None
    if plan.poses.kind == "drives":
        driven = drive(plan, grid, scanner, (model, surface_model), obstacles, count, seed, check)
        poses, twists = driven.poses, driven.twists
        known = {"goals": driven.goal, "goal_distances": driven.goal_distances, "commands": driven.commands}
        for label in known.keys() & arrays.keys():
            arrays[label][rows] = known[label]
    elif plan.poses.kind == "file":
        poses = poses_of_file(plan.folder / plan.poses.file)[first : first + count]
    else:
        poses = _free_poses(plan.poses, grid, obstacles, count, seed("poses"))
        twists = _drawn_twists(plan.poses.twist, count, dice)
    # A robot that stands gives the same scan, whatever time it takes.
    duration = plan.scanner.scan_duration or None if twists is not None else None
    step = max(1, PIECE // plan.scanner.beam_count)
    for start in range(0, count, step):
        check()
        piece = slice(start, min(start + step, count))
        written = slice(rows.start + piece.start, rows.start + piece.stop)
        moving: dict[str, Any] = {} if duration is None else {"twists": twists[piece], "scan_duration": duration}  # type: ignore[index]
        fixed: dict[str, Any] = {**moving, "obstacles": obstacles, "threads": 1}
        ranges = arrays["ranges"][written]
        stream: dict[str, Any] = {}
        if model is not None:
            stream = {"noise": model, "surfaces": surface_model, "seed": seed("noise"), "first_index": start}
        scanner.scan_batch(grid, poses[piece], **fixed, **stream, out=ranges)
        if plan.quantization:
            scanner.quantize(ranges, plan.quantization, out=ranges)
        if "surfaces" in arrays or "incidences" in arrays:
            check()
            places = poses[piece] if duration is None else scanner.beam_poses(poses[piece], twists[piece], duration)  # type: ignore[index]
            met, incidences = scanner.hits(grid, places, obstacles=obstacles, threads=1)
            if "surfaces" in arrays:
                arrays["surfaces"][written] = met
            if "incidences" in arrays:
                arrays["incidences"][written] = incidences
        if "true_ranges" in arrays:
            check()
            scanner.scan_batch(grid, poses[piece], **fixed, out=arrays["true_ranges"][written])
    arrays["poses"][rows] = poses
    if "twists" in arrays:
        arrays["twists"][rows] = 0.0 if twists is None else twists
    if "beam_poses" in arrays:
        still = np.zeros((count, 3)) if twists is None else twists
        arrays["beam_poses"][rows] = scanner.beam_poses(poses, still, plan.scanner.scan_duration)
    if "drawn" in arrays:
        values = {"scanner.max_range": scanner.max_range}
        mount = scanner.mount_in_space if len(plan.scanner.mount) == 6 else tuple(scanner.mount)
        values |= {f"scanner.mount[{index}]": value for index, value in enumerate(mount)}
        for part, numbers in (("noise", noise), ("surfaces", surfaces)):
            values |= {f"{part}.{key}": value for key, value in (numbers or {}).items()}
        arrays["drawn"][rows] = [values[key] for key in drawn_names(plan)]


def _drawn_obstacles(plan: Plan, grid: OccupancyGrid, dice: random.Random, seed: int) -> _Obstacles:
    """Returns discs in the free space of a grid, which may overlap each other."""
    low, high = plan.obstacles.count
    count = low + int((high - low + 1) * dice.random())
    radii = [draw(plan.obstacles.radius, dice) for _ in range(count)]
    if not count:
        return []
    # With another radius, the grid would build another table of free places.
    places = grid.draw_free_poses(count, radius=plan.poses.clearance, seed=seed, threads=1)
    return [(Shape.disc(radius), Pose(*place)) for radius, place in zip(radii, places.tolist(), strict=True)]


def _free_poses(wanted: Poses, grid: OccupancyGrid, obstacles: _Obstacles, count: int, seed: int) -> NDArray[np.float64]:
    """Returns poses that are uniform where a disc is free of walls and obstacles.

    Poses are drawn where the disc is free of walls; those that are too close to an obstacle are dropped.
    """
    radius = wanted.clearance
    if not obstacles:
        return grid.draw_free_poses(count, radius=radius, seed=seed, threads=1)
    robot, kept, missing = Shape.disc(max(radius, 1e-3)), [], count
    for turn in range(ROUNDS):
        poses = grid.draw_free_poses(count, radius=radius, seed=seed, first_index=turn * count, threads=1)
        clear = clearance_batch(grid, robot, poses, limit=1e-3, obstacles=obstacles, threads=1) > 0.0
        kept.append(poses[clear][:missing])
        missing -= len(kept[-1])
        if not missing:
            return np.concatenate(kept)
    raise ValueError(
        f"poses.clearance must leave room between {len(obstacles)} obstacles, got {radius} m: "
        f"of {ROUNDS * count} poses, only {count - missing} were clear; {count} are needed"
    )


def _drawn_twists(wanted: Twist, count: int, dice: random.Random) -> NDArray[np.float64] | None:
    """Returns a velocity for each scan, None if the robot stands."""
    bounds = (wanted.vx, wanted.vy, wanted.wz)
    if bounds == ((0.0, 0.0),) * 3:
        return None
    return np.array([[draw(each, dice) for each in bounds] for _ in range(count)])


def poses_of_file(path: Path) -> NDArray[np.float64]:
    """Returns the poses of a .npy file, which stays on disk.

    Raises:
        OSError: The file cannot be read.
        ValueError: The file is not an array of finite poses.
    """
    try:
        poses = np.load(path, mmap_mode="r", allow_pickle=False)
    except (ValueError, EOFError) as error:
        raise ValueError(f"{path}: poses must be an array in a .npy file: {error}") from None
    if not isinstance(poses, np.ndarray) or poses.ndim != 2 or poses.shape[1] != 3 or poses.dtype != np.float64:
        got = f"{poses.dtype} {poses.shape}" if isinstance(poses, np.ndarray) else "an archive"
        raise ValueError(f"{path}: poses must be a float64 array of shape (N, 3), got {got}")
    return poses
