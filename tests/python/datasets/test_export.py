"""export: Minari opens what is exported, with the numbers of the data set. tests/torch does so with LeRobot."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("zarr", reason="the extra `datasets` is not installed, or has no Zarr for this Python")
pytest.importorskip("minari", reason="the extra `minari` is not installed, or has no Minari for this Python")

import minari

from datasets.small_plans import DRIVES, files_of, small
from mobile_robot_simulator.datasets import export, generate, open


def test_minari_opens_the_drives_as_episodes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    generate(small(**DRIVES), out=tmp_path / "data")
    stored = open(tmp_path / "data")
    # 133 scans of 8 in a drive, and 67; the last drives have 5 and 3.
    assert export(tmp_path / "data", format="minari", out=tmp_path / "out") == {"train": 17, "test": 9}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["data", "out"]
    assert (tmp_path / "out").stat().st_mode == (tmp_path / "data").stat().st_mode
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path / "out"))
    assert sorted(minari.list_local_datasets()) == ["test-v0", "train-v0"]
    for name, split in stored.items():
        found, first = minari.load_dataset(f"{name}-v0"), 0
        assert found.total_steps == len(split) - found.total_episodes
        for episode in found.iterate_episodes():
            count = len(episode) + 1
            rows = slice(first, first + count)
            assert np.array_equal(episode.actions, split.arrays["commands"][first : first + count - 1])
            assert episode.observations.keys() == split.arrays.keys() - {"commands", "scene"}
            for key, observed in episode.observations.items():
                assert np.array_equal(observed.reshape(split.arrays[key][rows].shape), split.arrays[key][rows]), key
                assert observed.dtype == split.arrays[key].dtype
            for index in range(count):
                assert found.observation_space.contains({key: each[index] for key, each in episode.observations.items()})
            assert (episode.rewards == 0.0).all() and not episode.terminations.any()
            assert episode.truncations.tolist() == [False] * (count - 2) + [True]
            first += count
        assert first == len(split)
    metadata = next(iter(found.storage.get_episode_metadata([1])))
    assert metadata["options"] == {"scene": 1, "map": stored.attributes["maps"][2]["name"]}
    assert found.storage.metadata["made_from"]["plan"] == stored.plan.content


def test_a_drive_of_one_scan_is_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)  # Relative paths work too.
    generate(small(**DRIVES, count=17, splits={"train": 1}), out=tmp_path / "data")
    assert export("data", format="minari", out="out") == {"train": 2}


def test_what_cannot_be_exported(tmp_path: Path) -> None:
    generate(small(count=20), out=tmp_path / "free")
    with pytest.raises(ValueError, match="only drives are episodes, got poses of kind free"):
        export(tmp_path / "free", format="minari", out=tmp_path / "out")
    generate(small(count=20, poses={"kind": "drives", "clearance": 0.2}), out=tmp_path / "blind")
    with pytest.raises(ValueError, match=r"the actions of an episode are its commands; the plan needs labels: \[commands\]"):
        export(tmp_path / "blind", format="minari", out=tmp_path / "out")
    with pytest.raises(ValueError, match="format must be one of minari, lerobot, got 'csv'"):
        export(tmp_path / "free", format="csv", out=tmp_path / "out")  # type: ignore[arg-type]
    assert not (tmp_path / "out").exists()


def test_a_folder_that_has_files_is_left_alone(tmp_path: Path) -> None:
    generate(small(**DRIVES, count=20), out=tmp_path / "data")
    (tmp_path / "out").mkdir()
    assert export(tmp_path / "data", format="minari", out=tmp_path / "out") == {"train": 2, "test": 1}
    before = files_of(tmp_path)
    with pytest.raises(FileExistsError, match="the folder of an export must be new or empty"):
        export(tmp_path / "data", format="minari", out=tmp_path / "out")
    with pytest.raises(FileExistsError, match="the folder of an export must be new or empty"):
        export(tmp_path / "data", format="minari", out=tmp_path / "data/zarr.json")
    assert files_of(tmp_path) == before


def test_an_export_that_fails_leaves_nothing(tmp_path: Path) -> None:
    generate(small(**DRIVES, count=20), out=tmp_path / "data")
    file = tmp_path / "data/test/commands/c.0.0"
    file.write_bytes(file.read_bytes()[:20])
    with pytest.raises((OSError, ValueError, RuntimeError)):
        export(tmp_path / "data", format="minari", out=tmp_path / "out")
    assert [path.name for path in tmp_path.iterdir()] == ["data"]


def test_a_library_that_is_missing(tmp_path: Path) -> None:
    generate(small(**DRIVES, count=20), out=tmp_path)
    code = f"""
import sys
sys.modules["minari"] = None
from mobile_robot_simulator import datasets
try:
    datasets.export({str(tmp_path)!r}, format="minari", out={str(tmp_path / "out")!r})
except ImportError as error:
    print(error)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.startswith("minari needs pip install 'mobile-robot-simulator[minari]': "), done
