"""Generation: makes a data set, or goes on with one that was not completed."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Generator, Mapping
from contextlib import closing
from pathlib import Path
from typing import Any, Literal, NamedTuple

from .engines import MadeShard, made, make_on_threads
from .formats import format_of
from .job import Job, Shard, job_of
from .map_pool import MapPool
from .plan import Plan, load_plan
from .scenes import columns_of
from .workspace import Workspace

__all__ = ["Estimate", "Progress", "Report", "estimate", "generate"]


class Progress(NamedTuple):
    """How far a data set is made."""

    scans: int
    """Number of scans that are on disk."""

    total: int
    """Number of scans of the data set."""

    shards: int
    """Number of shards that are on disk."""

    total_shards: int
    """Number of shards of the data set."""


class Report(NamedTuple):
    """A data set that is complete."""

    path: Path
    """Its folder."""

    scans: int
    """Number of its scans."""

    shards: int
    """Number of its shards."""

    made: int
    """Number of shards that this call made. The others were there."""

    seconds: float
    """Time that this call took [s]."""


class Estimate(NamedTuple):
    """What a data set will be, from its first shard."""

    scans: dict[str, int]
    """Number of scans of each split."""

    maps: dict[str, int]
    """Number of maps of each split."""

    shards: int
    """Number of shards."""

    raw_bytes: int
    """Size of all numbers without compression [bytes]."""

    stored_bytes: int
    """Size of the files [bytes], if all shards compress like the first."""

    seconds: float
    """Time on this machine [s], if all shards take as long as the first and the disk does not slow it down."""


def generate(
    plan: Plan | str | os.PathLike[str],
    *,
    out: str | os.PathLike[str],
    threads: int | None = None,
    engine: Literal["threads", "ray"] = "threads",
    address: str | None = None,
    progress: Callable[[Progress], None] = lambda _: None,
) -> Report:
    """Makes a data set in a folder. If the folder has a part of it, only what is missing is made.

    The finished folder has the same bytes, however often the work was killed and started again, and for any number of
    threads. A shard appears as a whole or not at all. Until all shards are there, the folder is not a store that can be
    opened. Of a complete data set, files that are missing or empty are made again; `verify` finds files with other damage.
    Memory grows by about 7 kB for each shard only.

    Args:
        plan: The plan, or its YAML file.
        out: Folder of the data set. A new one is made; one that exists must be empty or have a part of this data set.
        threads: Number of threads; None means one per core.
        engine: What makes the shards: "threads" of this process, or the workers of a "ray" cluster, which needs the extra
            `ray`. The workers need this package in the same version, and map files at the same paths.
        address: Address of the Ray cluster, as for `ray.init`. None starts one on this machine, unless this process is
            connected to one.
        progress: Called when a shard is written, and at the start.

    Returns:
        What was made.

    Raises:
        ImportError: The extra `datasets` is not installed, or that of the engine or the format.
        OSError: A file cannot be read or written, the folder has other files, or another process makes this data set.
        ValueError: The plan is invalid, the folder has data of another plan, a scene is not possible, or the missing part of
            a complete data set cannot be made again with the same numbers.

    Example:
        >>> import tempfile
        >>> from mobile_robot_simulator import datasets
        >>> maps = [{"floor_plan": "office", "seeds": [1, 4]}]
        >>> plan = datasets.Plan(count=1000, maps=maps, splits={"train": 3, "test": 1})
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     report = datasets.generate(plan, out=folder)
        >>> report.scans, report.shards
        (1000, 2)
    """
    began = time.perf_counter()
    _check_threads(threads)
    if engine not in ("threads", "ray"):
        raise ValueError(f"engine must be 'threads' or 'ray', got {engine!r}")
    if engine == "threads" and address is not None:
        raise ValueError(f"only the engine ray has an address, got {address!r}")
    if engine == "ray" and threads is not None:
        raise ValueError(f"the engine ray takes the CPUs of its cluster, got threads={threads}")
    plan = plan if isinstance(plan, Plan) else load_plan(Path(plan))
    store, folder = format_of(plan.format), Path(out)
    job = job_of(plan, store.versions())
    if folder.exists() and not folder.is_dir():
        raise NotADirectoryError(20, "the place of a data set must be a folder", str(folder))
    workspace = Workspace(folder, store.COMPLETE)
    with workspace.locked():
        was_complete = workspace.is_complete
        workspace.begin(job, store.identity_of(folder) if was_complete else None)
        if was_complete:
            missing = [shard for shard in job.shards if not workspace.has(store.shard_paths(plan, shard).values())]
            recorded = {split: store.records_of(folder, split) for split in sorted({shard.split for shard in missing})}
        else:
            missing = [shard for shard in job.shards if workspace.record_of(shard) is None]
        scans, shards = plan.count - sum(shard.count for shard in missing), len(job.shards) - len(missing)
        progress(Progress(scans, plan.count, shards, len(job.shards)))

        def write(result: MadeShard) -> None:
            if was_complete:
                _check_same(result, recorded[result.shard.split][result.shard.index], folder)
            workspace.add(result.shard, result.files, result.record)

        written: Generator[Shard, None, None]
        if engine == "ray" and missing:
            from .ray_engine import make_on_ray

            written = make_on_ray(job, missing, write, address)
        else:
            written = make_on_threads(job, missing, write, threads)
        try:
            with closing(written):
                for shard in written:
                    scans, shards = scans + shard.count, shards + 1
                    progress(Progress(scans, plan.count, shards, len(job.shards)))
            if not was_complete:
                _finish(job, workspace)
        finally:
            if was_complete:
                workspace.clean()
    return Report(folder, plan.count, len(job.shards), len(missing), time.perf_counter() - began)


def _check_same(result: MadeShard, recorded: Mapping[str, Any], folder: Path) -> None:
    """Raises if a shard of a complete data set has other numbers than before."""
    now: dict[str, str] = result.record["blake3"]
    if wrong := [name for name, digest in recorded["blake3"].items() if now.get(name) != digest]:
        raise ValueError(
            f"{folder}: files of shard {result.shard.name} are missing, and made again, other numbers come out: "
            f"{', '.join(wrong)}; nothing was written. Make the data set in a new folder"
        )


def _finish(job: Job, workspace: Workspace) -> None:
    records: list[dict[str, Any]] = []
    digests: dict[str, str] = {}
    for shard in job.shards:
        record = workspace.record_of(shard)
        if record is None:
            raise OSError(f"shard {shard.name} has disappeared; give the same command to make it again")
        records.append(record)
        digests |= record["maps"]
    # A map that no scene needed has no digest if it is a floor plan.
    maps = [
        {"name": source.name, "split": split, "sha256": digests.get(f"{index}", source.digest)}
        for index, (split, source) in enumerate(job.maps)
    ]
    workspace.finish(format_of(job.plan.format).final_files(job, records, maps))


def estimate(plan: Plan | str | os.PathLike[str], *, threads: int | None = None) -> Estimate:
    """Returns what a data set will be. Makes its first shard, and writes nothing.

    Args:
        plan: The plan, or its YAML file.
        threads: Number of threads; None means one per core.

    Raises:
        ImportError: The extra `datasets` is not installed.
        OSError: A file cannot be read.
        ValueError: The plan is invalid, or a scene is not possible.
    """
    _check_threads(threads)
    plan = plan if isinstance(plan, Plan) else load_plan(Path(plan))
    job = job_of(plan, format_of(plan.format).versions())
    began = time.perf_counter()
    first = made(job, next(job.each_shard()), MapPool())
    taken = time.perf_counter() - began
    share = plan.count / first.shard.count
    row = sum(_bytes(column.shape, column.dtype) for column in columns_of(plan).values())
    return Estimate(
        dict(job.counts),
        {split: len(sources) for split, sources in job.sources.items()},
        job.shard_count,
        plan.count * row,
        round(share * sum(map(len, first.files.values()))),
        share * taken / min(threads or os.cpu_count() or 1, job.shard_count),
    )


def _check_threads(threads: int | None) -> None:
    if threads is not None and not 1 <= threads <= 1024:
        raise ValueError(f"threads must be in 1..1024, got {threads}")


def _bytes(shape: tuple[int, ...], dtype: str) -> int:
    import numpy as np

    return int(np.prod(shape, dtype=np.int64)) * np.dtype(dtype).itemsize
