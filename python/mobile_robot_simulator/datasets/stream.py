"""Stream: endless batches of scans for training without a disk."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .job import job_of
from .map_pool import KEPT, MapPool, sources_by_split
from .plan import Plan, load_plan

__all__ = ["load_maps", "stream"]


def load_maps(plan: Plan | str | os.PathLike[str], *, split: str | None = None) -> MapPool:
    """Returns the maps of a split in memory, with the tables that scans and free places need, for `stream`.

    Processes that are forked afterwards share them, so that many workers hold one copy. A process that is spawned, or gets
    them by pickle, loads the maps itself.

    Args:
        plan: The plan, or its YAML file.
        split: Split whose maps are loaded. None means the first.

    Raises:
        OSError: A file cannot be read.
        ValueError: The plan is invalid, there is no such split, or a map has no free place.
    """
    plan = plan if isinstance(plan, Plan) else load_plan(Path(plan))
    sources = sources_by_split(plan)[_split_of(plan, split)]
    pool = MapPool(len(sources))
    for source in sources:
        grid, _ = pool.grid(source)
        grid.prepare()
        grid.draw_free_pose(radius=plan.poses.clearance, seed=0)
    return pool


def stream(
    plan: Plan | str | os.PathLike[str],
    batch_size: int,
    *,
    split: str | None = None,
    worker: int = 0,
    start: int = 0,
    kept: int = KEPT,
    maps: MapPool | None = None,
) -> Iterator[dict[str, NDArray[Any]]]:
    """Returns endless batches of scans, made while they are read.

    Batch i of a worker depends only on the plan with its seed, the split, the worker and i. So several workers give
    different batches, and a run can go on from any batch. A batch consists of scenes of `scans_per_scene` scans, each with a
    map of the split that is drawn at random; for batches with many maps, let the plan have small scenes. `count` of the plan
    has no effect.

    Args:
        plan: The plan, or its YAML file. Its poses must not be those of a file.
        batch_size: Number of scans in a batch.
        split: Split whose maps are used. None means the first.
        worker: Number of the worker, such as that of a data loader.
        start: Number of the first batch.
        kept: Number of maps that stay in memory. If the split has more, the least recently used ones are loaded again when
            they are needed.
        maps: Maps that are in memory, from `load_maps`, instead of loading them when they are needed.

    Yields:
        The rows of each array by name, as in a data set; `scene` counts the scenes of the worker.

    Raises:
        OSError: A file cannot be read.
        ValueError: The plan is invalid, a number is negative, or there is no such split.

    Example:
        >>> from mobile_robot_simulator import datasets
        >>> plan = datasets.Plan(count=1, maps=[{"floor_plan": "office"}], scans_per_scene=16, scans_per_shard=16)
        >>> batches = datasets.stream(plan, 32, worker=3)
        >>> next(batches)["ranges"].shape
        (32, 541)
    """
    plan = plan if isinstance(plan, Plan) else load_plan(Path(plan))
    for name, value, least in (("batch_size", batch_size, 1), ("worker", worker, 0), ("start", start, 0), ("kept", kept, 1)):
        if value < least:
            raise ValueError(f"{name} must be at least {least}, got {value}")
    if plan.poses.kind == "file":
        raise ValueError("an endless stream must draw its poses, got a plan with poses of a file")
    pool = MapPool(kept) if maps is None else maps
    return _batches(plan, batch_size, _split_of(plan, split), worker, start, pool)


def _split_of(plan: Plan, split: str | None) -> str:
    name = next(iter(plan.splits)) if split is None else split
    if name not in plan.splits:
        raise ValueError(f"split must be one of {', '.join(plan.splits)}, got {name!r}")
    return name


def _batches(
    plan: Plan, batch_size: int, split: str, worker: int, start: int, pool: MapPool
) -> Iterator[dict[str, NDArray[Any]]]:
    # A stream needs no scans in every split.
    job = job_of(plan.model_copy(update={"count": 2**40}))
    scenes, index = -(-batch_size // plan.scans_per_scene), start
    while True:
        sizes = [min(plan.scans_per_scene, batch_size - n * plan.scans_per_scene) for n in range(scenes)]
        parts = [job.endless_scene(split, worker, index * scenes + n, size, pool) for n, size in enumerate(sizes)]
        yield {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
        index += 1
