"""intensities: the light that comes back to each beam."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs

SEED = 20
AHEAD = mrs.LaserScanner(beam_count=1, max_range=100.0)
LASER = mrs.LaserScanner(fov=6.2, beam_count=97, max_range=12.0)


def row(*materials: int) -> mrs.OccupancyGrid:
    """Returns a row of cells of 1 m: -1 is free, and other numbers are those of materials."""
    numbers = np.array([materials])
    cells = np.where(numbers < 0, 0, 100).astype(np.int8)
    return mrs.OccupancyGrid(cells, resolution=1.0, materials=np.maximum(numbers, 0).astype(np.uint8))


def test_walls_return_light_by_reflectivity_and_distance() -> None:
    for material, reflectivity in ((0, 1.0), (3, 0.024)):
        grid = row(-1, -1, -1, -1, material)
        for x in (0.5, 2.0, 3.5):
            found = AHEAD.intensities(grid, [(x, 0.5, 0.0)])
            assert found == pytest.approx(reflectivity / (4.0 - x) ** 2, rel=1e-6)


def test_light_falls_with_the_angle_of_incidence() -> None:
    cells = np.zeros((100, 20), np.int8)
    cells[:, 10] = 100
    grid = mrs.OccupancyGrid(cells, resolution=1.0)
    plate = mrs.Shape.rectangle(0.2, 50.0).with_material("dark")
    for angle in (0.0, 0.3, 1.0, 1.3):
        length = 8.0 / math.cos(angle)
        assert AHEAD.intensities(grid, [(2.0, 50.5, angle)]) == pytest.approx(math.cos(angle) / length**2, rel=1e-6)
        turned = [(plate, (5.1, 50.5, 0.0))]
        expected = 0.024 * math.cos(angle) / (3.0 / math.cos(angle)) ** 2
        assert AHEAD.intensities(grid, [(2.0, 50.5, angle)], obstacles=turned) == pytest.approx(expected, rel=1e-6)


def test_mirrors_and_glass_take_light_on_the_way_there_and_back() -> None:
    # 3 m to the mirror, and 6 m back to the wall.
    assert AHEAD.intensities(row(0, -1, -1, -1, -1, -1, -1, 2), [(4.0, 0.5, 0.0)]) == pytest.approx(0.9**2 / 81.0)
    pane = row(-1, -1, 1, -1, 0).with_materials(
        np.array([[0, 0, 1, 0, 0]], np.uint8), table=["wall", mrs.Material("glass", reflectivity=0.25, return_chance=0.0)]
    )
    assert AHEAD.intensities(pane, [(1.0, 0.5, 0.0)]) == pytest.approx(0.75**2 / 9.0)


def test_no_return_and_a_laser_inside_have_none() -> None:
    assert AHEAD.intensities(row(-1, -1), [(0.5, 0.5, 0.0)]) == 0.0
    for material in range(4):
        assert AHEAD.intensities(row(material, material), [(0.5, 0.5, 0.0)]) == 0.0


def room() -> mrs.OccupancyGrid:
    grid = mrs.floor_plan("office", seed=1)
    numbers = np.random.default_rng(SEED).integers(0, 4, grid.shape).astype(np.uint8)
    return grid.with_materials(numbers)


def test_light_never_grows_and_is_there_where_a_beam_returns() -> None:
    grid = room()
    poses = grid.draw_free_poses(50, radius=0.1, seed=SEED)
    ranges, found = LASER.scan_batch(grid, poses), LASER.intensities(grid, poses)
    assert np.all((found > 0.0) == (ranges < LASER.max_range))
    assert np.all(found <= 1.001 / ranges.astype(np.float64) ** 2)


def test_the_same_bytes_for_threads_chunks_and_scans_that_take_no_time() -> None:
    grid = room()
    poses = grid.draw_free_poses(20, radius=0.1, seed=SEED)
    whole = LASER.intensities(grid, poses, seed=SEED, threads=1)
    assert LASER.intensities(grid, poses, seed=SEED, threads=5).tobytes() == whole.tobytes()
    parts = [LASER.intensities(grid, poses[a:b], seed=SEED, first_index=a) for a, b in ((0, 3), (3, 20))]
    assert np.concatenate(parts).tobytes() == whole.tobytes()
    assert LASER.intensities(grid, poses, seed=SEED, scan_duration=0.0).tobytes() == whole.tobytes()
    assert LASER.intensities(grid, poses).tobytes() != whole.tobytes()  # other panes return


def test_panes_return_the_beams_that_the_noise_of_the_same_seed_says() -> None:
    grid = row(-1, -1, -1, -1, 1, -1, -1, 0)
    laser = mrs.LaserScanner(fov=1e-6, beam_count=200, max_range=100.0)
    noise = mrs.BeamModel(sigma_hit=1e-3, z_hit=1.0, z_max=0.0)
    readings = laser.scan_batch(grid, [(1.0, 0.5, 0.0)], noise=noise, seed=SEED)
    found = laser.intensities(grid, [(1.0, 0.5, 0.0)], seed=SEED)
    is_pane = np.abs(readings - 3.0) < 0.1
    assert 0 < np.sum(~is_pane) < 60
    np.testing.assert_allclose(found, np.where(is_pane, 0.08 / 9.0, 0.92**2 / 36.0), rtol=1e-5)


def test_bad_arguments_are_rejected() -> None:
    tilted = mrs.LaserScanner(beam_count=1, mount=(0.0, 0.0, 0.5, 0.0, 0.5, 0.0))
    with pytest.raises(ValueError, match="the scanner must not be tilted"):
        tilted.intensities(row(-1, 0), [(0.5, 0.5, 0.0)])
    with pytest.raises(ValueError, match="out must have shape"):
        AHEAD.intensities(row(-1, 0), [(0.5, 0.5, 0.0)], out=np.zeros((2, 2), np.float32))


@pytest.mark.parametrize("duration", [0.0, 0.05])
def test_scans_of_a_simulation_have_intensities_if_they_are_asked_for(duration: float) -> None:
    values = {"laser_beam_count": 1, "apply_noise": False, "laser_scan_duration": duration}
    grid = mrs.OccupancyGrid(np.pad(np.zeros((40, 40), np.int8), 1, constant_values=np.int8(100)), resolution=0.1)
    for is_asked in (False, True):
        sim = mrs.Simulation(grid, parameters={**values, "laser_intensities": is_asked}, start=(2.1, 2.1, 0.0))
        sim.run_for(0.25)
        scan = sim.latest("/scan")
        assert scan.intensities.tolist() == ([pytest.approx(1.0 / 4.0, rel=1e-5)] if is_asked else [])
