"""Job: a plan with its maps, divided into shards. What a worker needs to make any shard."""

from __future__ import annotations

import hashlib
import random
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import __version__
from .drives import policy_of
from .map_pool import MapPool, MapSource, shares, sources_by_split
from .plan import Plan
from .scenes import columns_of, fill_scene, poses_of_file

__all__ = ["Arrays", "Files", "Job", "Shard", "digests_of", "job_of", "versions_of"]

Arrays = Mapping[str, NDArray[Any]]

Files = Mapping[str, bytes | NDArray[np.uint8]]
"""Contents of files by their path in the folder of a data set."""


@dataclass(frozen=True, order=True)
class Shard:
    """A part of a split that is made and stored as a whole."""

    split: str
    index: int
    """Number in its split."""

    first: int
    """Number of its first scan in the split."""

    count: int
    """Number of its scans."""

    @property
    def name(self) -> str:
        """Name in messages and of its record."""
        return f"{self.split}-{self.index:06d}"


@dataclass(frozen=True)
class Job:
    """A plan with its maps, divided into shards."""

    plan: Plan
    sources: Mapping[str, list[MapSource]]
    """Maps of each split."""

    counts: Mapping[str, int]
    """Number of scans of each split."""

    versions: Mapping[str, str] = field(default_factory=dict)
    """Versions of the packages on which the bytes of the files depend."""

    poses_digest: str = ""
    """SHA-256 of the poses of a file."""

    @property
    def shard_count(self) -> int:
        """Number of shards."""
        return sum(-(-total // self.plan.scans_per_shard) for total in self.counts.values())

    def each_shard(self) -> Iterator[Shard]:
        """Yields all shards, split by split."""
        size = self.plan.scans_per_shard
        for split, total in self.counts.items():
            for index, first in enumerate(range(0, total, size)):
                yield Shard(split, index, first, min(size, total - first))

    @cached_property
    def shards(self) -> list[Shard]:
        """All shards, split by split."""
        return list(self.each_shard())

    @cached_property
    def maps(self) -> list[tuple[str, MapSource]]:
        """All maps with their splits. The column `map` has their indices."""
        return [(split, source) for split, sources in self.sources.items() for source in sources]

    @property
    def identity(self) -> dict[str, Any]:
        """All that the bytes of the files depend on, as JSON has it."""
        maps = [{"name": source.name, "split": split, "digest": source.digest} for split, source in self.maps]
        content = {"plan": self.plan.content, "maps": maps, "versions": dict(self.versions)}
        return content | ({"poses": self.poses_digest} if self.poses_digest else {})

    def make(
        self, shard: Shard, pool: MapPool, check: Callable[[], None] = lambda: None
    ) -> tuple[dict[str, NDArray[Any]], dict[int, str]]:
        """Returns the arrays of a shard, and the digest of each of its maps by index.

        Args:
            shard: The shard.
            pool: Maps that are in memory.
            check: Called many times a second. An exception of it ends the work.

        Raises:
            OSError: A map cannot be read.
            ValueError: A map has changed, or a scene is not possible, for example because there is no free place.
        """
        plan = self.plan
        arrays = {name: np.empty((shard.count, *column.shape), column.dtype) for name, column in columns_of(plan).items()}

        length, total, sources = plan.scans_per_scene, self.counts[shard.split], self.sources[shard.split]
        scenes = -(-total // length)
        offset = next(index for index, (split, _) in enumerate(self.maps) if split == shard.split)
        digests: dict[int, str] = {}
        for first in range(shard.first, shard.first + shard.count, length):
            check()
            scene = first // length
            # Scenes with the same map are neighbours, so that a shard has few maps.
            index = scene * len(sources) // scenes
            grid, digests[offset + index] = pool.grid(sources[index])
            rows = slice(first - shard.first, min(first - shard.first + length, shard.count))
            arrays["map"][rows], arrays["scene"][rows] = offset + index, scene
            try:
                fill_scene(plan, grid, f"{shard.split}/{scene}", first=first, rows=rows, arrays=arrays, check=check)
            except ValueError as error:
                raise ValueError(f"{sources[index].name}, scene {scene} of {shard.split}: {error}") from error
        return arrays, digests

    def endless_scene(self, split: str, worker: int, index: int, count: int, pool: MapPool) -> dict[str, NDArray[Any]]:
        """Returns a scene that is not part of the data set. It depends on the plan and on these numbers only.

        Args:
            split: Split from which the map comes.
            worker: Number of the worker.
            index: Number of the scene.
            count: Number of scans.
            pool: Maps that are in memory.
        """
        name, sources = f"{split}/worker {worker}/{index}", self.sources[split]
        chosen = int(random.Random(f"{self.plan.seed}/{name}/map").random() * len(sources))
        arrays = {name: np.zeros((count, *column.shape), column.dtype) for name, column in columns_of(self.plan).items()}
        offset = next(index for index, (other, _) in enumerate(self.maps) if other == split)
        arrays["map"][:], arrays["scene"][:] = offset + chosen, index
        grid, _ = pool.grid(sources[chosen])
        fill_scene(self.plan, grid, name, first=0, rows=slice(0, count), arrays=arrays)
        return arrays


def digests_of(arrays: Arrays) -> dict[str, str]:
    """Returns the BLAKE3 of the numbers of each array, little-endian and in C order; it does not depend on compression.

    Raises:
        ImportError: The extra `datasets` or `parquet` is not installed.
    """
    # Ten times as fast as SHA-256 where the processor has no instructions for that.
    from blake3 import blake3

    flat = {name: np.ascontiguousarray(array).reshape(-1).view(np.uint8) for name, array in arrays.items()}
    return {name: blake3(numbers.data).hexdigest() for name, numbers in flat.items()}


def job_of(plan: Plan, versions: Mapping[str, str] | None = None) -> Job:
    """Returns the job of a plan.

    Args:
        plan: The plan.
        versions: Versions of the packages that write the files.

    Raises:
        ImportError: The policy cannot be imported.
        OSError: A map file cannot be read.
        ValueError: A map or the policy is invalid, there are fewer maps than splits, or a file has fewer poses than scans.
    """
    if plan.poses.policy:
        policy_of(plan.poses.policy, plan.folder)
    sources = sources_by_split(plan)
    counts = shares(plan.count, list(plan.splits.values()))
    if 0 in counts:
        raise ValueError(f"count must give each split at least one scan, got {plan.count} for {', '.join(plan.splits)}")
    digest = ""
    if plan.poses.kind == "file":
        poses, found = poses_of_file(plan.folder / plan.poses.file), len(sources[next(iter(plan.splits))])
        if found > 1:
            raise ValueError(f"poses of a file need one map, got {found}")
        if len(poses) < plan.count:
            raise ValueError(f"{plan.poses.file}: there must be a pose for each of {plan.count} scans, got {len(poses)}")
        digest = hashlib.sha256(np.ascontiguousarray(poses).data).hexdigest()
    return Job(plan, sources, dict(zip(plan.splits, counts, strict=True)), versions_of(versions or {}), digest)


def versions_of(others: Mapping[str, str]) -> dict[str, str]:
    """Returns the version of this package with those of the packages that write the files."""
    return {"mobile_robot_simulator": __version__, **others}
