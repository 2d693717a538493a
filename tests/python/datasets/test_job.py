"""job: shards cover the scans, and a shard depends on nothing but the plan."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from datasets.small_plans import small
from mobile_robot_simulator.datasets.job import digests_of, job_of
from mobile_robot_simulator.datasets.map_pool import MapPool


def test_shards_cover_the_scans_of_each_split() -> None:
    job = job_of(small())
    assert job.counts == {"train": 133, "test": 67}
    for split, total in job.counts.items():
        shards = [shard for shard in job.shards if shard.split == split]
        assert [shard.index for shard in shards] == list(range(len(shards)))
        assert [n for shard in shards for n in range(shard.first, shard.first + shard.count)] == list(range(total))
    assert [shard.count for shard in job.shards] == [32, 32, 32, 32, 5, 32, 32, 3]
    assert job.shards[5].name == "test-000000"


def test_the_scans_do_not_depend_on_the_size_of_shards() -> None:
    pool, parts = MapPool(), []
    for size in (32, 64, 8):
        job = job_of(small(scans_per_shard=size))
        parts.append([job.make(shard, pool)[0] for shard in job.shards])
    for name in parts[0][0]:
        whole = [np.concatenate([part[name] for part in each]) for each in parts]
        assert np.array_equal(whole[0], whole[1]) and np.array_equal(whole[0], whole[2])


def test_scenes_are_shared_among_the_maps_and_each_has_its_own_poses() -> None:
    job, pool = job_of(small()), MapPool()
    made = [job.make(shard, pool) for shard in job.shards]
    maps = np.concatenate([arrays["map"] for arrays, _ in made])
    assert set(maps[:133]) == {0, 1} and set(maps[133:]) == {2} and abs(int((maps == 0).sum()) - 67) < 8
    poses = np.concatenate([arrays["poses"] for arrays, _ in made])
    assert len(np.unique(poses, axis=0)) == 200
    scenes = np.concatenate([arrays["scene"] for arrays, _ in made])
    assert np.array_equal(scenes, [*(n // 8 for n in range(133)), *(n // 8 for n in range(67))])
    laser = mrs.LaserScanner(beam_count=31, max_range=6.0)
    for index, (_, source) in enumerate(job.maps):
        rows = np.flatnonzero(maps == index)
        true = laser.scan_batch(source.load(), poses[rows])
        ranges = np.concatenate([arrays["ranges"] for arrays, _ in made])[rows]
        assert np.median(np.abs(ranges - true)) < 0.05


class GivenUp(Exception):
    pass


def test_work_is_given_up_when_asked() -> None:
    job, asked = job_of(small()), []

    def check() -> None:
        asked.append(1)
        if len(asked) == 3:
            raise GivenUp

    with pytest.raises(GivenUp):
        job.make(job.shards[0], MapPool(), check)


def test_scans_of_many_beams_look_often_whether_to_give_up() -> None:
    sizes = {"count": 40, "scans_per_scene": 40, "scans_per_shard": 40, "scanner": {"beam_count": 20_000}}
    plan = small(**sizes, splits={"all": 1}, labels=["true_ranges", "surfaces"])
    job, asked = job_of(plan), []
    job.make(job.shards[0], MapPool(), lambda: asked.append(1))
    # At most 2¹⁶ beams at a time, for each of the three arrays of the beams.
    assert len(asked) >= 3 * 40 * 20_000 / 2**16


def test_fewer_scans_than_splits() -> None:
    with pytest.raises(ValueError, match="count must give each split at least one scan, got 1 for train, test"):
        job_of(small(count=1))


def test_fewer_poses_than_scans_or_more_maps_than_one(tmp_path: Path) -> None:
    np.save(tmp_path / "poses.npy", np.zeros((7, 3)))
    plan = small(poses={"kind": "file", "file": "poses.npy"}, splits={"train": 1}, folder=tmp_path)
    with pytest.raises(ValueError, match="poses of a file need one map, got 3"):
        job_of(plan)
    with pytest.raises(ValueError, match=r"poses.npy: there must be a pose for each of 200 scans, got 7"):
        job_of(small(**{**plan.content, "maps": [{"floor_plan": "maze"}], "folder": tmp_path}))


def test_a_digest_is_that_of_the_numbers_in_c_order() -> None:
    pytest.importorskip("blake3", reason="the extra `datasets` is not installed")
    from blake3 import blake3

    numbers = np.arange(6.0, dtype="<f4").reshape(2, 3)
    whole = blake3(numbers.tobytes()).hexdigest()
    changed = np.where(numbers == 3.0, np.float32(3.0000002), numbers)
    found = digests_of({"a": numbers, "b": np.asfortranarray(numbers), "c": changed, "d": numbers[:0]})
    assert found["a"] == found["b"] == whole and found["c"] != whole
    # The digest of no bytes, from the paper of BLAKE3.
    assert found["d"] == "af1349b9f5f9a1a6a0404dea36dcc9499bcb25c9adc112b7cc9a93cae41f3262"
