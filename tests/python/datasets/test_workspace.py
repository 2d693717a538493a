"""workspace: a shard counts only if its record and all its files are there."""

from __future__ import annotations

from pathlib import Path

import pytest

from datasets.small_plans import small
from mobile_robot_simulator.datasets.job import job_of
from mobile_robot_simulator.datasets.workspace import Workspace

pytest.importorskip("filelock", reason="the extra `datasets` is not installed")


def test_a_shard_counts_when_its_record_and_all_files_are_there(tmp_path: Path) -> None:
    job, space = job_of(small()), Workspace(tmp_path, "done")
    shard, files = job.shards[0], {"train/a/c.0": b"12", "train/b/c.0": b"345"}
    with space.locked():
        space.begin(job)
        assert space.record_of(shard) is None
        space.add(shard, files, {"first": 0})
        sizes = {path: len(data) for path, data in files.items()}
        assert space.record_of(shard) == {"first": 0, "sizes": sizes} and space.record_of(job.shards[1]) is None
        (tmp_path / "train/b/c.0").write_bytes(b"34")
        assert space.record_of(shard) is None
        (tmp_path / "train/b/c.0").unlink()
        assert space.record_of(shard) is None
        space.finish({"x/y": b"1", "done": b""})
    assert space.is_complete and sorted(path.name for path in tmp_path.iterdir()) == ["done", "train", "x"]


def test_the_record_comes_after_the_files(tmp_path: Path) -> None:
    job, space = job_of(small()), Workspace(tmp_path, "done")
    with space.locked():
        space.begin(job)
        (tmp_path / "train/a/c.0").mkdir(parents=True)  # No file can be moved there.
        with pytest.raises(OSError):
            space.add(job.shards[0], {"train/b/c.0": b"1", "train/a/c.0": b"12"}, {"first": 0})
        assert space.record_of(job.shards[0]) is None


def test_a_folder_that_is_refused_stays_as_it_was(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("x")
    space = Workspace(tmp_path, "done")
    with space.locked(), pytest.raises(FileExistsError):
        space.begin(job_of(small()))
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]
    # Also a new folder, if nothing is begun.
    with Workspace(tmp_path / "new", "done").locked():
        pass
    assert not (tmp_path / "new").exists()
    # A complete data set of another plan.
    complete = Workspace(tmp_path / "old", "done")
    with complete.locked():
        complete.begin(job_of(small()))
        complete.finish({"done": b""})
    with complete.locked(), pytest.raises(ValueError, match="another plan"):
        complete.begin(job_of(small(seed=6)), job_of(small()).identity)
    assert [path.name for path in (tmp_path / "old").iterdir()] == ["done"]


def test_a_folder_that_is_begun_stays(tmp_path: Path) -> None:
    space = Workspace(tmp_path / "data", "done")
    with pytest.raises(KeyboardInterrupt), space.locked():
        space.begin(job_of(small()))
        raise KeyboardInterrupt
    assert (tmp_path / "data/.unfinished/dataset.json").exists()


def test_many_changes_are_cut(tmp_path: Path) -> None:
    space = Workspace(tmp_path, "done")
    with space.locked():
        space.begin(job_of(small()))
        other = small(
            seed=6, count=9, noise=None, quantization=0.1, compression="none", scans_per_scene=4, labels=["twists"]
        )
        with pytest.raises(ValueError, match=r"seed: 5 -> 6; count: 200 -> 9; .*; and \d+ more$"):
            space.begin(job_of(other))
