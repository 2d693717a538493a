"""scenes: each row is what the scanner measures from its pose, and what the labels say is true."""

from __future__ import annotations

import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from datasets.small_plans import small
from mobile_robot_simulator.datasets import Plan
from mobile_robot_simulator.datasets.scenes import columns_of, fill_scene

GRID = mrs.floor_plan("maze", seed=1, size=(10.0, 8.0), resolution=0.1)


def scene(
    plan: Plan, count: int, name: str = "train/0", first: int = 0, check: Callable[[], None] = lambda: None
) -> dict[str, np.ndarray]:
    arrays = {key: np.zeros((count, *column.shape), column.dtype) for key, column in columns_of(plan).items()}
    fill_scene(plan, GRID, name, first=first, rows=slice(0, count), arrays=arrays, check=check)
    return arrays


def test_true_ranges_are_those_of_the_scanner_and_readings_have_its_noise() -> None:
    arrays = scene(small(labels=["true_ranges"]), 2000)
    laser = mrs.LaserScanner(beam_count=31, max_range=6.0)
    assert np.array_equal(arrays["true_ranges"], [laser.scan(GRID, pose) for pose in arrays["poses"]])
    hit = (arrays["true_ranges"] < 5.0) & (arrays["ranges"] < 6.0) & (arrays["true_ranges"] > 0.5)
    (sigma,) = set(arrays["drawn"][:, 0])
    assert 0.01 <= sigma <= 0.05
    errors = (arrays["ranges"].astype(float) - arrays["true_ranges"])[hit] / sigma
    assert abs(errors.mean()) < 4 / np.sqrt(len(errors)) and abs(errors.std() - 1.0) < 4 / np.sqrt(2 * len(errors))


def test_readings_have_the_noise_of_surfaces() -> None:
    numbers = {"incidence_bias": [0.1, 0.2], "correlation": 0.4, "beam_divergence": 0.02, "reference_range": [4.0, 5.0]}
    plan = small(noise={"sigma_hit": 0.02}, surfaces=numbers)
    arrays, plain = scene(plan, 50), scene(small(noise={"sigma_hit": 0.02}), 50)
    assert columns_of(plan)["drawn"].attributes["columns"] == ["surfaces.incidence_bias", "surfaces.reference_range"]
    assert np.array_equal(arrays["poses"], plain["poses"]) and not np.array_equal(arrays["ranges"], plain["ranges"])
    bias, reference_range = arrays["drawn"][0]
    assert 0.1 <= bias <= 0.2 and 4.0 <= reference_range <= 5.0
    surfaces = mrs.SurfaceModel(incidence_bias=bias, correlation=0.4, beam_divergence=0.02, reference_range=reference_range)
    seed = random.Random("5/train/0/noise").getrandbits(63)
    laser = mrs.LaserScanner(beam_count=31, max_range=6.0)
    expected = laser.scan_batch(GRID, arrays["poses"], noise=mrs.BeamModel(sigma_hit=0.02), surfaces=surfaces, seed=seed)
    assert np.array_equal(arrays["ranges"], expected)


def test_long_scenes_are_cast_in_pieces_with_noise_of_their_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    np.save(tmp_path / "poses.npy", np.tile([5.0, 4.0, 0.0], (3000, 1)))
    plan = small(poses={"kind": "file", "file": "poses.npy"}, splits={"train": 1}, folder=tmp_path)
    ranges = scene(plan, 2500)["ranges"]
    assert len(np.unique(ranges, axis=0)) == 2500
    asked: list[int] = []
    monkeypatch.setattr("mobile_robot_simulator.datasets.scenes.PIECE", 31 * 300 + 5)
    assert np.array_equal(scene(plan, 1100, check=lambda: asked.append(1))["ranges"], ranges[:1100])
    assert len(asked) == 4


def test_poses_are_clear_of_walls_and_obstacles() -> None:
    found = scene(
        small(obstacles={"count": 6, "radius": [0.2, 0.4]}, poses={"clearance": 0.25}, labels=["true_ranges"]), 300
    )
    without = scene(small(poses={"clearance": 0.25}, labels=["true_ranges"]), 300)
    disc = mrs.Shape.disc(0.25)
    assert (mrs.clearance_batch(GRID, disc, found["poses"], limit=1.0) > 0.0).all()
    # A robot with clear poses has no reading of an obstacle below its clearance, and sees obstacles at all.
    laser = mrs.LaserScanner(beam_count=31, max_range=6.0)
    plain = laser.scan_batch(GRID, found["poses"])
    assert (found["true_ranges"] <= plain).all() and (found["true_ranges"] < plain).mean() > 0.05
    assert found["true_ranges"].min() > 0.25 and np.array_equal(
        without["true_ranges"], laser.scan_batch(GRID, without["poses"])
    )


def test_surfaces_and_incidences_are_those_of_each_beam() -> None:
    labels = ["surfaces", "incidences", "true_ranges", "beam_poses"]
    plan = small(
        scanner={"beam_count": 31, "max_range": 4.0, "scan_duration": 0.1},
        poses={"twist": {"vx": 1.0}},
        obstacles={"count": 4, "radius": 0.3},
        labels=labels,
    )
    arrays = scene(plan, 200)
    laser, surfaces = mrs.LaserScanner(beam_count=31, max_range=4.0), arrays["surfaces"]
    assert set(np.unique(surfaces)) == {-1, 0, 1, 2, 3, 4}
    assert np.array_equal(surfaces == -1, arrays["true_ranges"] == 4.0)
    assert np.array_equal(np.isnan(arrays["incidences"]), surfaces == -1)
    walls = laser.scan_batch(GRID, arrays["beam_poses"])
    assert np.array_equal(walls[surfaces == 0], arrays["true_ranges"][surfaces == 0])
    assert (walls > arrays["true_ranges"])[surfaces > 0].all()


def test_no_room_between_obstacles() -> None:
    crowd = small(obstacles={"count": 400, "radius": 2.0})
    with pytest.raises(ValueError, match=r"poses.clearance must leave room between 400 obstacles, got 0.3 m"):
        scene(crowd, 8)


def test_scans_that_take_time_have_a_pose_for_each_beam() -> None:
    plan = small(
        scanner={"beam_count": 31, "max_range": 6.0, "scan_duration": 0.05},
        poses={"twist": {"vx": [0.5, 1.0], "wz": [-1, 1]}},
        labels=["twists", "beam_poses", "true_ranges"],
    )
    arrays = scene(plan, 50)
    twists, laser = arrays["twists"], mrs.LaserScanner(beam_count=31, max_range=6.0)
    assert (
        ((twists[:, 0] >= 0.5) & (twists[:, 0] <= 1.0)).all()
        and (twists[:, 1] == 0.0).all()
        and len(set(twists[:, 2])) == 50
    )
    step = laser.time_increment(0.05)
    for pose, twist, poses, ranges in zip(arrays["poses"], twists, arrays["beam_poses"], arrays["true_ranges"], strict=True):
        for beam in (0, 7, 30):
            there = mrs.Pose(*pose).integrate(twist, beam * step)
            assert np.array_equal(poses[beam], there) and ranges[beam] == laser.scan(GRID, there)[beam]


def test_what_is_drawn_is_stored() -> None:
    plan = small(
        scanner={"beam_count": 31, "max_range": [3.0, 5.0], "mount": [[0.0, 0.2], 0.1, 0]},
        noise={"sigma_hit": [0.01, 0.02], "z_max": 0.5},
        labels=["true_ranges"],
    )
    scenes = [scene(plan, 3, f"train/{index}") for index in range(20)]
    assert columns_of(plan)["drawn"].attributes["columns"] == ["scanner.max_range", "scanner.mount[0]", "noise.sigma_hit"]
    drawn = np.array([each["drawn"] for each in scenes])
    assert (drawn == drawn[:, :1]).all() and all(len(set(drawn[:, 0, column])) == 20 for column in range(3))
    assert ((drawn[..., 0] >= 3.0) & (drawn[..., 0] <= 5.0)).all()
    for each in scenes:
        max_range, x, _ = each["drawn"][0]
        laser = mrs.LaserScanner(beam_count=31, max_range=max_range, mount=(x, 0.1, 0.0))
        assert np.array_equal(each["true_ranges"], laser.scan_batch(GRID, each["poses"]))


def test_quantized_readings() -> None:
    exact, rounded = scene(small(), 50)["ranges"], scene(small(quantization=0.001), 50)["ranges"]
    assert np.array_equal(rounded, mrs.LaserScanner(max_range=6.0).quantize(exact, 0.001)) and not np.array_equal(
        exact, rounded
    )


def test_poses_of_a_file(tmp_path: Path) -> None:
    poses = GRID.draw_free_poses(40, radius=0.2, seed=1)
    np.save(tmp_path / "poses.npy", poses)
    plan = small(poses={"kind": "file", "file": "poses.npy"}, splits={"train": 1}, folder=tmp_path)
    assert np.array_equal(scene(plan, 8, first=16)["poses"], poses[16:24])


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (np.zeros((3, 2)), r"must be a float64 array of shape \(N, 3\), got float64 \(3, 2\)"),
        (np.zeros((3, 3), np.float32), r"got float32 \(3, 3\)"),
        (np.array([None]), "must be an array in a .npy file"),
    ],
)
def test_a_file_without_poses(content: Any, message: str, tmp_path: Path) -> None:
    np.save(tmp_path / "poses.npy", content)
    plan = small(poses={"kind": "file", "file": "poses.npy"}, splits={"train": 1}, folder=tmp_path)
    with pytest.raises(ValueError, match=message):
        scene(plan, 2)
