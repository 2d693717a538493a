"""alignment: logs whose frame is shifted and turned by a known pose."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from compare.simulated_logs import free_poses, log_of, office
from mobile_robot_simulator.compare.alignment import align_log, moved

GRID = office()
POSES = free_poses(GRID, 40)
NOISE = mrs.BeamModel(sigma_hit=0.03, z_hit=0.9, z_short=0.05, z_max=0.02, z_rand=0.03)
CENTRE = mrs.Pose(*POSES[:, :2].mean(axis=0), 0.0)


def said_with(shift: tuple[float, float], yaw: float) -> np.ndarray:
    """Returns the poses turned by `-yaw` about their centre, then moved by `-shift`."""
    turn = CENTRE * mrs.Pose(0.0, 0.0, -yaw) * CENTRE.inverse()
    return moved(POSES, mrs.Pose(-shift[0], -shift[1], 0.0) * turn)


def test_moved_poses_are_the_product_of_poses() -> None:
    transform = mrs.Pose(0.3, -2.0, 2.5)
    expected = [tuple(transform * tuple(pose)) for pose in POSES]
    np.testing.assert_allclose(np.sin(moved(POSES, transform)[:, 2]), [math.sin(yaw) for _, _, yaw in expected], atol=1e-12)
    np.testing.assert_allclose(moved(POSES, transform)[:, :2], [(x, y) for x, y, _ in expected], atol=1e-12)


@pytest.mark.parametrize("shift", [(0.0, 0.0), (0.3, -0.2), (-0.93, 0.88), (0.013, 0.027)])
@pytest.mark.parametrize("yaw", [0.0, 0.004, -0.19])
def test_a_shift_and_a_yaw_are_recovered(shift: tuple[float, float], yaw: float) -> None:
    said = said_with(shift, yaw)
    found = align_log(GRID, log_of(GRID, POSES, noise=NOISE, said=said))
    np.testing.assert_allclose(moved(said, found.map_from_log)[:, :2], POSES[:, :2], atol=0.006)
    assert found.shift == pytest.approx(shift, abs=0.006)
    assert found.yaw == pytest.approx(yaw, abs=0.001) and not found.is_at_limit
    assert found.error_after <= found.error_before and found.error_after < 0.045


def test_the_error_without_an_error_is_not_changed() -> None:
    found = align_log(GRID, log_of(GRID, POSES))
    assert found.map_from_log == mrs.Pose() and found.error_before == found.error_after == 0.0


@pytest.mark.slow
def test_a_log_of_another_frame_is_found_with_a_large_reach() -> None:
    said = said_with((-6.5, 4.0), 2.9)
    found = align_log(GRID, log_of(GRID, POSES, noise=NOISE, said=said), reach=(8.0, math.pi))
    np.testing.assert_allclose(moved(said, found.map_from_log)[:, :2], POSES[:, :2], atol=0.006)


@pytest.mark.parametrize(("shift", "yaw"), [((0.25, 0.0), 0.0), ((0.0, 0.0), 0.04)])
def test_what_lies_beyond_the_reach_is_said(shift: tuple[float, float], yaw: float) -> None:
    said = said_with(shift, yaw)
    assert align_log(GRID, log_of(GRID, POSES, said=said), reach=(0.1, 0.02)).is_at_limit


def test_no_reach_changes_nothing() -> None:
    said = said_with((0.2, 0.0), 0.0)
    assert align_log(GRID, log_of(GRID, POSES, said=said), reach=(0.0, 0.0)).map_from_log == mrs.Pose()


def test_progress_ends_at_1() -> None:
    shares: list[float] = []
    align_log(GRID, log_of(GRID, POSES), progress=shares.append)
    assert shares == sorted(shares) and shares[-1] == 1.0 and len(shares) > 5


@pytest.mark.parametrize("reach", [(-0.1, 0.1), (math.inf, 0.1), (1.0, 4.0), (1.0, math.nan)])
def test_a_wrong_reach(reach: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match=r"reach must be at least 0 m and 0 to π rad, got "):
        align_log(GRID, log_of(GRID, POSES), reach=reach)


def test_a_reach_that_would_take_for_ever() -> None:
    with pytest.raises(ValueError, match=r"reach must need at most 12000000 poses, got 10000.0, 0.1, which needs \d+"):
        align_log(GRID, log_of(GRID, POSES), reach=(1e4, 0.1))
