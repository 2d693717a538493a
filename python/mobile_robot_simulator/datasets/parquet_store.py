"""Parquet: a data set as a folder of Parquet files for each split, a file for each shard, a row for each scan."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from ..user_files import read_text
from .formats import damaged_file, formats, missing_file
from .job import Arrays, Job, Shard
from .plan import Plan
from .scenes import Column, columns_of

__all__ = ["COMPLETE", "final_files", "identity_of", "read_shard", "records_of", "shard_files", "shard_paths", "versions"]

COMPLETE = formats()["parquet"]
"""File that is written last: what the data set was made from, and what is known about each shard."""

_LARGEST = 2**30


def versions() -> dict[str, str]:
    """Returns the versions of the packages that write the files."""
    return {"pyarrow": version("pyarrow")}


def shard_paths(plan: Plan, shard: Shard) -> dict[str, str]:
    """Returns the path in the folder of the file of each column of a shard: it is the same file for all."""
    return dict.fromkeys(columns_of(plan), _path(shard))


def shard_files(plan: Plan, shard: Shard, arrays: Arrays) -> dict[str, bytes]:
    """Returns the file of a shard, by its path in the folder."""
    columns = columns_of(plan)
    schema = pa.schema([_field(name, column) for name, column in columns.items()])
    table = pa.table([_as_arrow(arrays[name], schema.field(name).type) for name in columns], schema=schema)
    sink = pa.BufferOutputStream()
    pq.write_table(
        table,
        sink,
        row_group_size=plan.scans_per_chunk,
        compression=plan.compression,
        compression_level=1 if plan.compression == "zstd" else None,
        use_dictionary=False,
        # The bytes of a float apart: signs and exponents compress well.
        use_byte_stream_split=True,
    )
    return {_path(shard): sink.getvalue().to_pybytes()}


def final_files(job: Job, records: Iterable[Mapping[str, Any]], maps: list[dict[str, Any]]) -> dict[str, bytes]:
    """Returns the file that makes a folder with all shards a data set.

    Args:
        job: The job.
        records: What is known about each shard, in the order of the shards.
        maps: Name, split and digest of each map.
    """
    shards: dict[str, list[dict[str, Any]]] = {split: [] for split in job.counts}
    for record in records:
        shards[record["split"]].append({key: value for key, value in record.items() if key not in ("split", "sizes")})
    content = {"format_version": 1, "made_from": job.identity, "maps": maps, "shards": shards}
    return {COMPLETE: json.dumps(content, indent=1).encode()}


def identity_of(folder: Path) -> dict[str, Any]:
    """Returns what a complete data set was made from: plan, maps and versions.

    Raises:
        ValueError: The folder is no data set.
    """
    return dict(_content(folder)["made_from"])


def records_of(folder: Path, split: str) -> list[dict[str, Any]]:
    """Returns what is known about each shard of a split: first scan, count, seed, digests."""
    return list(_content(folder)["shards"][split])


def read_shard(folder: Path, job: Job, shard: Shard) -> dict[str, NDArray[Any]]:
    """Returns the arrays of a shard of a complete data set.

    Raises:
        OSError: The file is missing, or cannot be read.
        ValueError: The file is damaged.
    """
    file = folder / _path(shard)
    if not file.is_file():
        raise missing_file(file)
    try:
        table = pq.read_table(file, partitioning=None)
        return {
            name: _as_numpy(table.column(name).combine_chunks(), column) for name, column in columns_of(job.plan).items()
        }
    except (pa.ArrowException, KeyError, OSError) as error:
        if isinstance(error, OSError) and error.errno is not None:  # It is not the content.
            raise
        raise damaged_file(file, error) from error


def _content(folder: Path) -> dict[str, Any]:
    try:
        content = json.loads(read_text(folder / COMPLETE, _LARGEST))
    except ValueError as error:
        raise ValueError(f"{folder / COMPLETE}: must be JSON: {error}") from None
    if not isinstance(content, dict) or not {"made_from", "shards", "maps"} <= content.keys():
        raise ValueError(f"{folder / COMPLETE}: this is not a data set of this package, or is damaged")
    return content


def _path(shard: Shard) -> str:
    return f"{shard.split}/{shard.index:06d}.parquet"


def _field(name: str, column: Column) -> Any:
    kind = pa.from_numpy_dtype(np.dtype(column.dtype))
    for size in reversed(column.shape):
        kind = pa.list_(kind, size)
    return pa.field(
        name, kind, nullable=False, metadata={key: json.dumps(value) for key, value in column.attributes.items()}
    )


def _as_arrow(array: NDArray[Any], kind: Any) -> Any:
    values = pa.array(np.ascontiguousarray(array).reshape(-1))
    kinds = []
    while pa.types.is_fixed_size_list(kind):
        kinds.append(kind)
        kind = kind.value_type
    for each in reversed(kinds):
        values = pa.FixedSizeListArray.from_arrays(values, type=each)
    return values


def _as_numpy(values: Any, column: Column) -> NDArray[Any]:
    for _ in column.shape:
        values = values.flatten()
    return np.asarray(values.to_numpy(zero_copy_only=False), column.dtype).reshape(-1, *column.shape)
