"""zarr_store: the files are those that Zarr writes when it writes the whole arrays at once."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("zarr", reason="the extra `datasets` is not installed, or has no Zarr for this Python")

import zarr

from datasets.small_plans import files_of, small
from mobile_robot_simulator.datasets import generate
from mobile_robot_simulator.datasets.job import job_of
from mobile_robot_simulator.datasets.map_pool import MapPool
from mobile_robot_simulator.datasets.zarr_store import final_files


@pytest.mark.parametrize("compression", ["none", "lz4", "zstd"])
def test_the_files_are_those_of_arrays_that_are_written_at_once(compression: str, tmp_path: Path) -> None:
    plan = small(compression=compression)
    generate(plan, out=tmp_path / "data")
    job, pool = job_of(plan), MapPool()
    made = [(shard.split, job.make(shard, pool)[0]) for shard in job.shards]
    for split in job.counts:
        for name in ("ranges", "poses", "map"):
            whole = np.concatenate([arrays[name] for own, arrays in made if own == split])
            like = zarr.open_array(tmp_path / "data", path=f"{split}/{name}", mode="r")
            assert np.array_equal(like[:], whole)
            copy = zarr.create_array(
                tmp_path / f"copy/{split}-{name}",
                shape=like.shape,
                chunks=like.chunks,
                shards=like.shards,
                dtype=like.dtype,
                compressors=like.compressors or None,
                chunk_key_encoding={"name": "default", "separator": "."},
                config={"write_empty_chunks": True},
            )
            copy[:] = whole
            files = {key: data for key, data in files_of(tmp_path / f"copy/{split}-{name}").items() if key != "zarr.json"}
            found = {key: data for key, data in files_of(tmp_path / f"data/{split}/{name}").items() if key != "zarr.json"}
            assert found == files


@pytest.mark.parametrize(
    ("shard", "beams", "chunk"), [(16384, 541, 512), (4096, 541, 512), (100, 541, 100), (1000, 1081, 250), (8, 100_000, 4)]
)
def test_a_chunk_of_ranges_is_the_largest_part_of_a_shard_that_has_at_most_two_megabytes(
    shard: int, beams: int, chunk: int
) -> None:
    plan = small(count=2 * shard, scanner={"beam_count": beams}, scans_per_shard=shard, scans_per_scene=shard)
    content = final_files(job_of(plan), [], [])
    chunks = {name: json.loads(content[f"train/{name}/zarr.json"]) for name in ("ranges", "poses")}
    inner = {name: each["codecs"][0]["configuration"]["chunk_shape"] for name, each in chunks.items()}
    assert inner == {"ranges": [chunk, beams], "poses": [shard, 3]}
