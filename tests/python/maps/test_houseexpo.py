"""houseexpo: outlines become rooms, against plans written by hand and generated ones."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from maps.house_plans import generated

SEED = 22
L_SHAPE = [[0, 0], [0.2, 0], [0.2, 0.1], [0.1, 0.1], [0.1, 0.2], [0, 0.2]]


def write(folder: Path, verts: object, name: str = "0a1b.json") -> Path:
    path = folder / name
    plan = {"verts": verts, "id": "0a1b", "room_category": {"kitchen": [[0, 0, 1, 1]]}, "room_num": 1, "bbox": {}}
    path.write_text(json.dumps(plan))
    return path


def test_the_inside_is_free_and_the_outside_is_occupied(tmp_path: Path) -> None:
    grid = mrs.load_map(write(tmp_path, L_SHAPE))
    assert ["".join("#" if cell else "." for cell in row) for row in grid.cells[::-1]] == [
        "######",
        "#..###",
        "#..###",
        "#....#",
        "#....#",
        "######",
    ]
    assert grid.resolution == 0.05 and tuple(grid.origin) == (-0.05, -0.05, 0.0)


def test_a_room_is_as_wide_as_its_plan(tmp_path: Path) -> None:
    grid = mrs.load_map(write(tmp_path, [[-2, -3], [4, -3], [4, 1], [-2, 1]]), resolution=0.1)
    rays = np.array([[0.0, 0.0, angle] for angle in (0, np.pi / 2, np.pi, -np.pi / 2)])
    assert mrs.cast_rays(grid, rays, max_range=20.0) == pytest.approx([4, 1, 2, 3], abs=1e-6)


def test_every_free_cell_is_inside(tmp_path: Path) -> None:
    """A cell is free if and only if all four of its corners and its centre are in a room or its door."""
    random = np.random.default_rng(SEED)
    for _ in range(5):
        verts = [[round(20 * x) / 20, round(20 * y) / 20] for x, y in generated(random)]
        grid = mrs.load_map(write(tmp_path, verts))
        ring = np.array(verts)
        centres = np.argwhere(grid.cells >= 0) + 0.5
        x, y = (centres[:, 1] * 0.05 + grid.origin.x)[:, None], (centres[:, 0] * 0.05 + grid.origin.y)[:, None]
        (x0, y0), (x1, y1) = ring.T, np.roll(ring, -1, axis=0).T
        with np.errstate(all="ignore"):
            left = ((y0 <= y) != (y1 <= y)) & (x0 + (x1 - x0) * (y - y0) / (y1 - y0) < x)
        assert np.array_equal(left.sum(axis=1) % 2 == 1, grid.cells.ravel() == 0)


def test_a_robot_drives_through_the_doors(tmp_path: Path) -> None:
    grid = mrs.load_map(write(tmp_path, generated(np.random.default_rng(SEED))))
    assert mrs.Simulation(grid, seed=SEED, start=grid.draw_free_pose(radius=0.3, seed=SEED)).latest("/scan") is None
    assert len(grid.draw_free_poses(50, radius=0.3, seed=SEED)) == 50


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", ", line 1: not valid JSON: Expecting property name"),
        ("[" * 100_000, ": not valid JSON: nested too deeply"),
        ("[]", ": must have 'verts', a list of at least three corners [x, y], got []"),
        ("{}", ": must have 'verts', a list of at least three corners [x, y], got None"),
        (
            '{"verts": [[0, 0], [1, 0]]}',
            ": must have 'verts', a list of at least three corners [x, y], got [[0, 0], [1, 0]]",
        ),
        ('{"verts": [[0, 0], [1, 0], [1]]}', ": corner 2 of 'verts' must be two numbers [x, y], got [1]"),
        ('{"verts": [[0, 0], [1, "0"], [1, 1]]}', ": corner 1 of 'verts' must be two numbers [x, y], got [1, '0']"),
        ('{"verts": [[0, 0], [1, true], [1, 1]]}', ": corner 1 of 'verts' must be two numbers [x, y], got [1, True]"),
        ('{"verts": [[0, 0], [1, NaN], [1, 1]]}', ": the corners of 'verts' must be finite"),
        ('{"verts": [[0, 0], [1, 1e999], [1, 1]]}', ": the corners of 'verts' must be finite"),
        ('{"verts": [[0, 0], [1, 1' + "0" * 400 + "], [1, 1]]}", ": the corners of 'verts' must be finite"),
        ('{"verts": [[0, 0], [1e6, 0], [1, 1]]}', ": a grid must have at most"),
    ],
)
def test_malformed_plans_are_errors(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "0a1b.json"
    path.write_text(text)
    with pytest.raises(ValueError) as caught:
        mrs.load_map(path)
    assert str(caught.value).startswith(f"{path}{message}")


def test_generated_plans_are_loaded_and_scanned(tmp_path: Path) -> None:
    random, laser = np.random.default_rng(SEED), mrs.LaserScanner()
    for index in range(50):
        grid = mrs.load_map(write(tmp_path, generated(random), f"{index}.json"))
        assert 0.5 < laser.scan(grid, (1.0, 0.9, 0.0)).min() < 1.0
