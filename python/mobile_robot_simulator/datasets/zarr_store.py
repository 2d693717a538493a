"""Zarr: a data set as a Zarr v3 store with sharding. A group for each split, an array for each column."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from importlib.metadata import version
from math import prod
from pathlib import Path, PurePosixPath
from typing import Any, TypeVar

import numpy as np
import zarr
from numpy.typing import NDArray
from zarr.abc.store import ByteRequest
from zarr.codecs import BloscCodec
from zarr.core.buffer import Buffer, BufferPrototype
from zarr.storage import LocalStore, MemoryStore

from .formats import damaged_file, formats, missing_file
from .job import Arrays, Files, Job, Shard
from .plan import Plan
from .scenes import Column, columns_of

__all__ = [
    "COMPLETE",
    "arrays_of",
    "attributes_of",
    "final_files",
    "identity_of",
    "read_rows",
    "read_shard",
    "records_of",
    "shard_files",
    "shard_paths",
    "versions",
]

COMPLETE = formats()["zarr"]
"""File that is written last. A folder without it is not a Zarr store."""

LARGEST_CHUNK = 2**21
"""Largest size of the numbers that are compressed together [bytes]. It fits into the cache of a core."""


class _Files(LocalStore):
    """The files of a complete data set, for reading. Every shard has a file, so that a missing one does not mean zeros."""

    async def get(
        self, key: str, prototype: BufferPrototype | None = None, byte_range: ByteRequest | None = None
    ) -> Buffer | None:
        found = await super().get(key, prototype, byte_range)
        if not found and PurePosixPath(key).name.startswith("c."):
            raise missing_file(self.root / key)
        return found


def versions() -> dict[str, str]:
    """Returns the versions of the packages that write the files."""
    return {name: version(name) for name in ("zarr", "numcodecs")}


def shard_paths(plan: Plan, shard: Shard) -> dict[str, str]:
    """Returns the path in the store of the file of each column of a shard."""
    return {
        name: f"{shard.split}/{name}/{_file_name(shard.index, 1 + len(column.shape))}"
        for name, column in columns_of(plan).items()
    }


def shard_files(plan: Plan, shard: Shard, arrays: Arrays) -> Files:
    """Returns the files of a shard, by their path in the store."""
    files: dict[str, NDArray[np.uint8]] = {}
    paths = shard_paths(plan, shard)
    for name, array in arrays.items():
        column = Column(array.shape[1:], array.dtype.name, {})
        content: dict[str, Any] = {}
        made = _create(MemoryStore(content), "", plan, column, shard.count, {})
        made[...] = array
        (encoded,) = [data for key, data in content.items() if not key.endswith("zarr.json")]
        files[paths[name]] = encoded.as_numpy_array()
    return files


def final_files(job: Job, records: Iterable[Mapping[str, Any]], maps: list[dict[str, Any]]) -> dict[str, bytes]:
    """Returns the files that make a folder with all shards a Zarr store; the last of them is `COMPLETE`.

    Args:
        job: The job.
        records: What is known about each shard, in the order of the shards. It becomes an attribute of its split.
        maps: Name, split and digest of each map.
    """
    content: dict[str, Any] = {}
    store, by_split = MemoryStore(content), {split: [] for split in job.counts}  # type: ignore[var-annotated]
    for record in records:
        by_split[record["split"]].append({key: value for key, value in record.items() if key not in ("split", "sizes")})
    attributes = {"format_version": 1, "made_from": job.identity, "maps": maps}
    zarr.create_group(store, attributes=attributes)
    for split, total in job.counts.items():
        zarr.create_group(store, path=split, attributes={"shards": by_split[split]})
        for name, column in columns_of(job.plan).items():
            _create(store, f"{split}/{name}", job.plan, column, total, column.attributes)
    ordered = sorted(content, key=lambda path: (path == COMPLETE, path))
    return {path: content[path].to_bytes() for path in ordered}


def attributes_of(folder: Path) -> dict[str, Any]:
    """Returns the attributes of a store."""
    return dict(_described(folder, "", lambda store: zarr.open_group(store, mode="r", zarr_format=3).attrs.asdict()))


def arrays_of(folder: Path, split: str) -> dict[str, Any]:
    """Returns the arrays of a split by name, for reading.

    Raises:
        FileNotFoundError: A description is missing.
        ValueError: A description is damaged.
    """
    return {name: _array(folder, f"{split}/{name}") for name in sorted(records_of(folder, split)[0]["blake3"])}


def identity_of(folder: Path) -> dict[str, Any]:
    """Returns what a complete store was made from: plan, maps and versions.

    Raises:
        ValueError: The folder is no data set.
    """
    attributes = attributes_of(folder)
    if "made_from" not in attributes:
        raise ValueError(f"{folder / COMPLETE}: this Zarr store is not a data set of this package, or is damaged")
    return dict(attributes["made_from"])


def records_of(folder: Path, split: str) -> list[dict[str, Any]]:
    """Returns what is known about each shard of a split: first scan, count, seed, digests."""

    def records(store: _Files) -> list[dict[str, Any]]:
        shards: Any = zarr.open_group(store, path=split, mode="r", zarr_format=3).attrs["shards"]
        return list(shards)

    return _described(folder, split, records)


def read_shard(folder: Path, job: Job, shard: Shard) -> dict[str, NDArray[Any]]:
    """Returns the arrays of a shard of a complete store.

    Raises:
        FileNotFoundError: A file is missing.
        ValueError: A file is damaged.
    """
    rows = slice(shard.first, shard.first + shard.count)
    return {name: read_rows(_array(folder, f"{shard.split}/{name}"), rows) for name in columns_of(job.plan)}


def read_rows(array: Any, rows: int | slice) -> NDArray[Any]:
    """Returns rows of an array, all from one shard.

    Raises:
        FileNotFoundError: The file is missing.
        ValueError: The file is damaged.
    """
    try:
        return np.asarray(array[rows])
    except (ValueError, RuntimeError) as error:
        first = rows if isinstance(rows, int) else rows.start
        path = f"{array.path}/{_file_name(first // array.shards[0], array.ndim)}"
        raise damaged_file(array.store.root / path, error) from error


def _array(folder: Path, path: str) -> zarr.Array[Any]:
    return _described(folder, path, lambda store: zarr.open_array(store, path=path, mode="r", zarr_format=3))


_T = TypeVar("_T")


def _described(folder: Path, path: str, read: Callable[[_Files], _T]) -> _T:
    """Returns what a function makes of the description of a group or an array. The error of a bad one names its file."""
    file = folder / path / COMPLETE
    advice = "restore it from a copy, or make the data set again in a new folder"
    if not file.is_file():
        raise FileNotFoundError(2, f"this description of a data set in Zarr is missing; {advice}", str(file))
    try:
        return read(_Files(folder, read_only=True))
    except (ValueError, TypeError, LookupError, AttributeError, FileNotFoundError) as error:
        raise ValueError(f"{file}: this description of a data set in Zarr is damaged: {error}; {advice}") from error


def _file_name(shard: int, dimensions: int) -> str:
    return ".".join(["c", str(shard), *["0"] * (dimensions - 1)])


def _create(
    store: MemoryStore, path: str, plan: Plan, column: Column, length: int, attributes: dict[str, Any]
) -> zarr.Array[Any]:
    codec = BloscCodec(cname=plan.compression, clevel=1, shuffle="bitshuffle") if plan.compression != "none" else None
    rest = column.shape
    return zarr.create_array(
        store,
        name=path or None,
        shape=(length, *rest),
        chunks=(_scans_per_chunk(plan.scans_per_shard, column), *rest),
        shards=(plan.scans_per_shard, *rest),
        dtype=column.dtype,
        compressors=codec,
        attributes=attributes,
        dimension_names=["scan", *[f"dim_{index}" for index in range(len(rest))]],
        chunk_key_encoding={"name": "default", "separator": "."},
        # Otherwise a chunk of zeros would have no file.
        config={"write_empty_chunks": True},
    )


def _scans_per_chunk(scans_per_shard: int, column: Column) -> int:
    """Returns the number of rows that are compressed together: the largest part of a shard of at most `LARGEST_CHUNK`."""
    most = max(1, LARGEST_CHUNK // (np.dtype(column.dtype).itemsize * prod(column.shape)))
    return next(n for n in range(min(most, scans_per_shard), 0, -1) if scans_per_shard % n == 0)
