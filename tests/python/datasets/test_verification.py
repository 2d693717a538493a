"""verification: a byte that changes in a file, and a map that changes, are found."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("zarr", reason="the extra `datasets` is not installed, or has no Zarr for this Python")

import zarr

import mobile_robot_simulator as mrs
from datasets.small_plans import files_of, small
from mobile_robot_simulator.datasets import generate, verify


def test_a_data_set_that_is_as_it_was_made(tmp_path: Path) -> None:
    generate(small(), out=tmp_path)
    seen: list[tuple[int, int]] = []
    assert verify(tmp_path, progress=lambda done, total: seen.append((done, total))) == (8, [], [])
    assert seen == [(done, 8) for done in range(9)]
    assert verify(tmp_path, sample=3) == (3, [], [])
    assert verify(tmp_path, sample=99) == (8, [], [])


@pytest.mark.parametrize("compression", ["none", "lz4", "zstd"])
def test_a_byte_that_changes(compression: str, tmp_path: Path) -> None:
    generate(small(compression=compression), out=tmp_path)
    file = tmp_path / "train/ranges/c.3.0"
    data = bytearray(file.read_bytes())
    data[len(data) // 3] ^= 1
    file.write_bytes(data)
    ((shard, problem),) = verify(tmp_path).differences
    assert shard == "train-000003" and f"{file}" in problem
    assert problem.endswith("give the command that made the data set again")


@pytest.mark.parametrize("damage", ["short", "changed"])
def test_a_damaged_file_is_repaired_as_the_message_says(damage: str, tmp_path: Path) -> None:
    generate(small(compression="none"), out=tmp_path)
    before, file = files_of(tmp_path), tmp_path / "train/ranges/c.3.0"
    data = bytearray(file.read_bytes())
    data[len(data) // 3] ^= 1
    file.write_bytes(data if damage == "changed" else data[: len(data) // 2])
    ((_, problem),) = verify(tmp_path).differences
    assert problem.startswith(
        f"stored numbers do not have their digest: ranges; remove {file} and give the command that made the data set again"
        if damage == "changed"
        else f"{file}: this file of the data set is damaged: "
    )
    assert problem.endswith("and give the command that made the data set again")
    assert generate(small(compression="none"), out=tmp_path).made == 0
    file.unlink()
    assert generate(small(compression="none"), out=tmp_path).made == 1
    assert files_of(tmp_path) == before and verify(tmp_path).differences == []


def test_no_repair_is_promised_if_a_map_has_changed(tmp_path: Path) -> None:
    mrs.save_map(mrs.floor_plan("maze", seed=1, size=(10.0, 8.0), resolution=0.1), tmp_path / "map.yaml")
    plan = small(maps=[{"files": "map.yaml"}], splits={"train": 1}, count=32, compression="none", folder=tmp_path)
    generate(plan, out=tmp_path / "data")
    file = tmp_path / "data/train/ranges/c.0.0"
    file.write_bytes(bytes([file.read_bytes()[0] ^ 1]) + file.read_bytes()[1:])
    mrs.save_map(mrs.floor_plan("maze", seed=2, size=(10.0, 8.0), resolution=0.1), tmp_path / "map.yaml")
    first, _ = verify(tmp_path / "data", folder=tmp_path).differences
    assert first.problem == "stored numbers do not have their digest: ranges"


def test_a_file_that_is_missing(tmp_path: Path) -> None:
    generate(small(), out=tmp_path)
    missing = tmp_path / "test/poses/c.1.0"
    missing.unlink()
    problem = f"{missing}: this file of the data set is missing or empty; give the command that made the data set again"
    assert verify(tmp_path).differences == [("test-000001", problem)]


def test_a_map_that_changes(tmp_path: Path) -> None:
    def save(seed: int) -> None:
        mrs.save_map(mrs.floor_plan("maze", seed=seed, size=(10.0, 8.0), resolution=0.1), tmp_path / "map.yaml")

    save(1)
    generate(small(maps=[{"files": "map.yaml"}], splits={"train": 1}, folder=tmp_path), out=tmp_path / "data")
    assert verify(tmp_path / "data", folder=tmp_path).differences == []
    save(2)
    found = verify(tmp_path / "data", folder=tmp_path, sample=2)
    assert found.notes == ["map.yaml: the map is not what it was"]
    assert all(
        problem.startswith("made again, other numbers come out: ") and "ranges" in problem
        for _, problem in found.differences
    )
    assert len({shard for shard, _ in found.differences}) == 2


def test_a_folder_that_is_no_data_set(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="no such folder"):
        verify(tmp_path / "missing")
    with pytest.raises(ValueError, match=r"must be the folder of a data set, got none of zarr.json, dataset.json"):
        verify(tmp_path)
    zarr.create_group(tmp_path / "other")
    with pytest.raises(ValueError, match="this Zarr store is not a data set of this package"):
        verify(tmp_path / "other")
    with pytest.raises(ValueError, match="sample must be at least 1, got 0"):
        verify(tmp_path, sample=0)
