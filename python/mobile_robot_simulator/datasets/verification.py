"""Verification: makes shards of a complete data set again and compares them."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from .formats import format_of
from .job import Job, digests_of, job_of
from .map_pool import MapPool
from .plan import Plan
from .reader import identity_of

__all__ = ["Difference", "Verified", "verify"]


class Difference(NamedTuple):
    """What is wrong with a shard."""

    shard: str
    """Split and number of the shard, such as train-000003."""

    problem: str
    """What is wrong."""


class Verified(NamedTuple):
    """The result of a verification."""

    shards: int
    """Number of shards that were made again."""

    differences: list[Difference]
    """What is wrong; empty if nothing is."""

    notes: list[str]
    """What may explain a difference, such as other versions."""


def verify(
    path: str | os.PathLike[str],
    *,
    sample: int | None = None,
    seed: int = 0,
    folder: str | os.PathLike[str] = ".",
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Verified:
    """Makes shards of a complete data set again and compares them with what is stored, and with the stored digests.

    Args:
        path: Folder of the data set.
        sample: Number of shards, chosen by the seed. None means all.
        seed: Seed of the choice.
        folder: Folder that the names of map files in the plan are relative to: that of the plan's file.
        progress: Called with the number of shards that are done and their total.

    Raises:
        ImportError: The extra `datasets` is not installed.
        OSError: The folder or a map cannot be read.
        ValueError: The folder is no complete data set, a map is invalid, or `sample` is below 1.
    """
    if sample is not None and sample < 1:
        raise ValueError(f"sample must be at least 1, got {sample}")
    job, store, notes = stored_job(Path(path), Path(folder))
    shards = job.shards
    if sample is not None and sample < len(shards):
        order = sorted(shards, key=lambda shard: hashlib.sha256(f"{seed}/{shard.name}".encode()).digest())
        shards = sorted(order[:sample])
    records = {split: store.records_of(Path(path), split) for split in job.counts}
    differences, pool = [], MapPool()
    for done, shard in enumerate(shards):
        progress(done, len(shards))
        recorded: dict[str, str] = records[shard.split][shard.index]["blake3"]
        again = digests_of(job.make(shard, pool)[0])
        changed = [name for name in recorded if again.get(name) != recorded[name]]
        try:
            stored = digests_of(store.read_shard(Path(path), job, shard))
            wrong = [name for name in recorded if stored.get(name) != recorded[name]]
            if wrong:
                problem = f"stored numbers do not have their digest: {', '.join(wrong)}"
                if not changed and not notes:
                    paths = store.shard_paths(job.plan, shard)
                    files = ", ".join(dict.fromkeys(f"{Path(path) / paths[name]}" for name in wrong))
                    problem += f"; remove {files} and give the command that made the data set again"
                differences.append(Difference(shard.name, problem))
        except (ValueError, OSError) as error:
            problem = f"{error.filename}: {error.strerror}" if isinstance(error, OSError) and error.filename else f"{error}"
            differences.append(Difference(shard.name, problem))
        if changed:
            differences.append(Difference(shard.name, f"made again, other numbers come out: {', '.join(changed)}"))
    progress(len(shards), len(shards))
    return Verified(len(shards), differences, notes)


def stored_job(path: Path, folder: Path) -> tuple[Job, Any, list[str]]:
    """Returns the job of a complete data set, the module of its format, and notes about what has changed since."""
    identity, store = identity_of(path)
    plan = Plan(**identity["plan"], folder=folder)
    job = job_of(plan, format_of(plan.format).versions())
    notes = [
        f"{name} was {identity['versions'].get(name)}, now it is {now}"
        for name, now in job.versions.items()
        if identity["versions"].get(name) != now
    ]
    now = {entry["name"]: entry for entry in job.identity["maps"]}
    notes += [
        f"{entry['name']}: the map is not what it was" for entry in identity["maps"] if now.get(entry["name"]) != entry
    ]
    return job, store, notes
