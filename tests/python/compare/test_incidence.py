"""incidence: walls whose direction is known."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.compare import incidence
from mobile_robot_simulator.compare.beams import Beams
from mobile_robot_simulator.compare.incidence import incidence_of

ORIGIN = mrs.Pose(3.0, -1.0, 0.4)
SIZE = 240


def of_wall(yaw_deg: float, thickness: float, *, value: int = 100, unknown: str = "free") -> tuple[np.ndarray, np.ndarray]:
    """Returns the incidence of beams on a wall with its normal at `yaw_deg` in the grid, and the right one [rad]."""
    yaw = math.radians(yaw_deg)
    rows, cols = np.mgrid[:SIZE, :SIZE] + 0.5
    depth = (cols - SIZE / 2) * math.cos(yaw) + (rows - SIZE / 2) * math.sin(yaw) - 40.0
    cells = np.where((depth >= 0.0) & (depth < thickness), value, 0).astype(np.int8)
    grid = mrs.OccupancyGrid(cells, resolution=0.05, origin=ORIGIN, unknown=unknown)
    beams = Beams(np.linspace(-1.2, 1.2, 121), 30.0)
    x, y, turn = ORIGIN * mrs.Pose(SIZE / 2 * 0.05, SIZE / 2 * 0.05, yaw)
    (ranges,) = beams.cast(grid, np.array([[x, y, turn]]))
    hits = ranges < 30.0
    directions = turn + beams.angles[hits]
    ends = np.array([x, y]) + ranges[hits, None] * np.column_stack([np.cos(directions), np.sin(directions)])
    return incidence_of(grid, ends, directions), np.abs(beams.angles[hits])


@pytest.mark.parametrize("yaw_deg", [0, 10, 20, 30, 45, 63, 90, 200])
@pytest.mark.parametrize(("thickness", "usual", "large"), [(99.0, 1.5, 2.5), (3.0, 2.0, 4.0), (1.5, 4.0, 7.0)])
def test_walls_of_any_direction(yaw_deg: float, thickness: float, usual: float, large: float) -> None:
    found, right = of_wall(yaw_deg, thickness)
    errors = np.degrees(np.abs(found - right))
    assert len(errors) > 80 and np.median(errors) < usual and np.percentile(errors, 90) < large


def test_unknown_cells_are_walls_where_they_block() -> None:
    found, right = of_wall(30.0, 9.0, value=-1, unknown="occupied")
    assert np.degrees(np.median(np.abs(found - right))) < 2.0


def test_an_end_without_a_wall_has_none(monkeypatch: pytest.MonkeyPatch) -> None:
    grid = mrs.OccupancyGrid(np.eye(30, dtype=np.int8) * 100, resolution=1.0)
    ends = np.array([[20.0, 5.0], [-40.0, 900.0], [0.5, 1.0], [15.0, 15.0]])
    found = incidence_of(grid, ends, np.zeros(4))
    assert np.isnan(found[:2]).all() and np.isfinite(found[2:]).all()
    monkeypatch.setattr(incidence, "_CHUNK", 3)
    shares: list[float] = []
    np.testing.assert_array_equal(incidence_of(grid, ends, np.zeros(4), progress=shares.append), found)
    assert shares == [0.75, 1.0]
