"""zarr_store: the files are those that Zarr writes when it writes the whole arrays at once."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("zarr", reason="the extra `datasets` is not installed, or has no Zarr for this Python")

import zarr

from datasets.small_plans import files_of, small
from mobile_robot_simulator.datasets import generate
from mobile_robot_simulator.datasets.job import job_of
from mobile_robot_simulator.datasets.map_pool import MapPool


@pytest.mark.parametrize("compression", ["none", "zstd"])
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
