"""datasets: PyTorch's data loaders give the numbers of a data set, and LeRobot opens what is exported."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from loaders import LASER, Scans, Shuffled, Streams
from torch.utils.data import DataLoader

import mobile_robot_simulator as mrs
from mobile_robot_simulator import datasets

# Python 3.12 and later warn of forks with threads; this package is made for them.
pytestmark = pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")

both = pytest.mark.parametrize("method", ["fork", "spawn"])

PLAN = datasets.Plan(
    seed=5,
    count=200,
    maps=[{"floor_plan": "maze", "seeds": [1, 3], "size": [10, 8], "resolution": 0.1}],
    splits={"train": 2, "test": 1},
    scanner={"beam_count": 31, "max_range": 6.0},
    noise={"sigma_hit": [0.01, 0.05]},
    poses={"kind": "drives", "clearance": 0.2},
    labels=["commands", "goals", "goal_distances", "surfaces"],
    scans_per_scene=8,
    scans_per_shard=32,
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("torch") / "data"
    datasets.generate(PLAN, out=out)
    return out


def rows_of(batches: Any) -> dict[str, np.ndarray]:
    batches = list(batches)
    return {name: np.concatenate([np.asarray(batch[name]) for batch in batches]) for name in batches[0]}


@both
def test_a_split_is_a_data_set_of_pytorch(method: str, folder: Path) -> None:
    split = datasets.open(folder)["train"]
    found = rows_of(DataLoader(split, batch_size=32, num_workers=2, multiprocessing_context=method))
    assert found.keys() == split.arrays.keys()
    for name, array in split.arrays.items():
        assert np.array_equal(found[name], array[:]) and found[name].dtype == array.dtype, name
    torch.manual_seed(3)
    mixed = rows_of(DataLoader(split, batch_size=32, shuffle=True, num_workers=2, multiprocessing_context=method))
    order = np.argsort(mixed["scene"], kind="stable")
    assert not np.array_equal(mixed["scene"], found["scene"]) and np.array_equal(mixed["scene"][order], found["scene"])


@both
def test_workers_share_the_shards_of_an_epoch(method: str, folder: Path) -> None:
    scans = Shuffled(folder, "train", 16)
    found = rows_of(DataLoader(scans, batch_size=None, num_workers=2, multiprocessing_context=method))
    alone = rows_of(DataLoader(scans, batch_size=None))
    assert len(found["ranges"]) == 133 and not np.array_equal(found["poses"], alone["poses"])
    for rows in (found, alone):
        order = np.lexsort(rows["ranges"].T)
        rows.update({name: array[order] for name, array in rows.items()})
    assert all(np.array_equal(found[name], alone[name]) for name in alone)


@both
def test_each_worker_has_a_stream_of_its_own(method: str) -> None:
    # The streams end, because PyTorch can abort a worker that still makes batches when its loader goes away.
    loader = DataLoader(Streams(PLAN, 8, 3), batch_size=None, num_workers=2, multiprocessing_context=method)
    streams = [datasets.stream(PLAN, 8, worker=worker) for worker in (0, 1)]
    batches = list(loader)
    assert len(batches) == 6
    for index, found in enumerate(batches):
        expected = next(streams[index % 2])
        assert all(np.array_equal(found[name], expected[name]) for name in expected), index


def test_a_hundred_loaders_are_forked_after_the_parent_scanned_on_threads() -> None:
    cells = (np.random.default_rng(1).random((200, 300)) < 0.01).astype(np.int8) * 100
    grid = mrs.OccupancyGrid(cells, resolution=0.05)
    poses = np.random.default_rng(2).uniform(1.0, 9.0, (200, 3))
    expected = LASER.scan_batch(grid, poses, threads=2)
    for turn in range(100):
        assert np.array_equal(LASER.scan_batch(grid, poses, threads=2), expected)
        loader = DataLoader(Scans(grid, poses), batch_size=None, num_workers=2, multiprocessing_context="fork", timeout=60)
        assert np.array_equal(np.concatenate(list(loader)), expected), turn


def test_lerobot_opens_the_drives_as_episodes(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("lerobot", reason="LeRobot needs Python 3.12 or later")
    # Nothing is looked up on a network, and nothing is kept at home.
    monkeypatch.setenv("HF_HUB_OFFLINE", "1")
    monkeypatch.setenv("HF_HOME", f"{tmp_path}/home")
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    stored = datasets.open(folder)
    assert datasets.export(folder, format="lerobot", out=tmp_path / "out") == {"train": 17, "test": 9}
    for name, split in stored.items():
        found = LeRobotDataset(f"local/{name}", root=tmp_path / "out" / name, video_backend="pyav")
        assert (found.num_episodes, found.num_frames, found.fps) == (len({*split.arrays["scene"][:]}), len(split), 10)
        assert found.meta.info.codebase_version == "v3.0"
        assert found.meta.features["observation.state"]["names"] == ["x", "y", "yaw"]
        features = {"poses": "observation.state", "commands": "action"}
        columns = {key: features.get(key, f"observation.{key}") for key in split.arrays if key != "scene"}
        assert set(columns.values()) <= found.features.keys()
        for index in range(len(split)):
            item = found[index]
            for key, feature in columns.items():
                expected = split.arrays[key][index]
                expected = expected.astype(np.float32) if expected.dtype == np.float64 else expected
                assert np.array_equal(item[feature].numpy().reshape(expected.shape), expected), (index, key)
            assert int(item["episode_index"]) == split.arrays["scene"][index] and item["task"] == "roam"
            assert float(item["timestamp"]) == pytest.approx(int(item["frame_index"]) / 10)


def test_lerobot_needs_a_whole_number_of_scans_in_a_second(folder: Path, tmp_path: Path) -> None:
    pytest.importorskip("lerobot", reason="LeRobot needs Python 3.12 or later")
    poses = {"kind": "drives", "clearance": 0.2, "period": 0.15}
    datasets.generate(datasets.Plan(**{**PLAN.content, "poses": poses, "count": 20}), out=tmp_path / "data")
    with pytest.raises(ValueError, match=r"LeRobot needs a whole number of scans in a second, got poses.period 0.15 s"):
        datasets.export(tmp_path / "data", format="lerobot", out=tmp_path / "out")
    assert [path.name for path in tmp_path.iterdir()] == ["data"]


def test_hugging_face_reads_the_parquet_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HF_HUB_OFFLINE", "1")
    library = pytest.importorskip("datasets", reason="LeRobot, which brings it, needs Python 3.12 or later")
    plan = datasets.Plan(**{**PLAN.content, "format": "parquet"})
    datasets.generate(plan, out=tmp_path / "data")
    datasets.generate(PLAN, out=tmp_path / "zarr")
    for name, split in datasets.open(tmp_path / "zarr").items():
        found = library.load_dataset(
            "parquet", data_dir=str(tmp_path / "data" / name), split="train", cache_dir=str(tmp_path / "cache")
        )
        assert len(found) == len(split) and set(found.column_names) == set(split.arrays)
        for column, rows in found[:].items():
            assert np.array_equal(rows, split.arrays[column][:]), column
