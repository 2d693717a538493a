"""parquet_store: the files open in pyarrow, with the numbers of the same plan in Zarr."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pyarrow", reason="the extra `parquet` is not installed")

import pyarrow.dataset as pads
import pyarrow.parquet as pq

from datasets.small_plans import files_of, small
from mobile_robot_simulator.datasets import Progress, generate, open, verify
from mobile_robot_simulator.datasets.job import job_of
from mobile_robot_simulator.datasets.map_pool import MapPool

PLAN = small(
    format="parquet",
    scanner={"beam_count": 31, "max_range": 6.0, "scan_duration": 0.1},
    poses={"twist": {"vx": [0.0, 1.0]}},
    labels=["beam_poses", "true_ranges"],
)


def test_the_files_have_the_numbers_of_the_plan(tmp_path: Path) -> None:
    generate(PLAN, out=tmp_path)
    job, pool = job_of(PLAN), MapPool()
    made = [(shard.split, job.make(shard, pool)[0]) for shard in job.shards]
    for split, total in job.counts.items():
        table = pads.dataset(tmp_path / split, format="parquet").to_table()
        assert len(table) == total
        for name in made[0][1]:
            whole = np.concatenate([arrays[name] for own, arrays in made if own == split])
            assert np.array_equal(np.array(table.column(name).to_pylist(), whole.dtype), whole), name
    field = pq.read_schema(tmp_path / "train/000000.parquet").field("poses")
    assert json.loads(field.metadata[b"units"]) == ["m", "m", "rad"]


@pytest.mark.parametrize("compression", ["none", "lz4", "zstd"])
def test_the_same_bytes_come_out_again_and_after_a_break(compression: str, tmp_path: Path) -> None:
    plan = small(format="parquet", compression=compression)
    generate(plan, out=tmp_path / "whole", threads=1)
    (tmp_path / "part").mkdir()

    def stop(progress: Progress) -> None:
        # Not decided by the files: other threads still write, and a folder can go away while this function looks into it.
        if progress.shards:
            raise InterruptedError

    with pytest.raises(InterruptedError):
        generate(plan, out=tmp_path / "part", progress=stop)
    assert any((tmp_path / "part").rglob("*.parquet"))
    assert not (tmp_path / "part/dataset.json").exists()
    generate(plan, out=tmp_path / "part", threads=2)
    assert files_of(tmp_path / "part") == files_of(tmp_path / "whole")
    content = json.loads((tmp_path / "whole/dataset.json").read_text())
    assert content["made_from"]["plan"] == plan.content and len(content["shards"]["train"]) == 5


def test_verification_finds_damage(tmp_path: Path) -> None:
    generate(PLAN, out=tmp_path)
    assert verify(tmp_path) == (8, [], [])
    file = tmp_path / "train/000002.parquet"
    data = bytearray(file.read_bytes())
    data[len(data) // 3] ^= 1
    file.write_bytes(data)
    (tmp_path / "test/000001.parquet").write_bytes(b"PAR1")
    assert [shard for shard, _ in verify(tmp_path).differences] == ["train-000002", "test-000001"]


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    generate(PLAN, out=tmp_path)
    missing = tmp_path / "train/000001.parquet"
    missing.unlink()
    ((shard, problem),) = verify(tmp_path).differences
    assert shard == "train-000001" and problem.startswith(f"{missing}: this file of the data set is missing or empty; ")


@pytest.mark.parametrize("damage", ["missing", "empty", "short", "changed"])
def test_a_file_is_repaired_as_the_messages_say(damage: str, tmp_path: Path) -> None:
    generate(PLAN, out=tmp_path)
    before, file = files_of(tmp_path), tmp_path / "train/000001.parquet"
    data = bytearray(file.read_bytes())
    if damage == "changed":
        data[len(data) // 3] ^= 1
    file.write_bytes(data if damage == "changed" else data[:-9] if damage == "short" else b"")
    if damage == "missing":
        file.unlink()
    ((shard, problem),) = verify(tmp_path).differences
    assert shard == "train-000001" and f"{file}" in problem
    assert problem.endswith("give the command that made the data set again")
    if damage in ("short", "changed"):
        assert generate(PLAN, out=tmp_path).made == 0 and "; remove " in problem
        file.unlink()
    assert generate(PLAN, out=tmp_path).made == 1
    assert files_of(tmp_path) == before and verify(tmp_path).differences == []


def test_it_is_not_opened_as_zarr(tmp_path: Path) -> None:
    generate(PLAN, out=tmp_path)
    with pytest.raises(ValueError, match="only data sets in Zarr are opened here"):
        open(tmp_path)


@pytest.mark.parametrize("content", ["[", "{}", "[1]"])
def test_a_description_that_is_damaged(content: str, tmp_path: Path) -> None:
    (tmp_path / "dataset.json").write_text(content)
    with pytest.raises(ValueError, match=r"dataset.json: "):
        verify(tmp_path)
