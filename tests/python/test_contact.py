"""contact: footprints stop at walls and obstacles, slide along them, and measure their distance."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs

DISC = mrs.Shape.disc(0.5)
AHEAD = (1.0, 0.0, 0.0)


def test_a_robot_stops_slides_or_passes_through(post: mrs.OccupancyGrid) -> None:
    # The only wall is the square from (2, 2) to (3, 3).
    start = mrs.Pose(0.0, 2.5, 0.0)
    end, contact = mrs.advance(post, DISC, start, AHEAD, 3.0)
    assert contact is not None
    assert 1.5 - 1e-6 <= end.x < 1.5
    assert end.y == 2.5
    assert contact.fraction == pytest.approx(0.5, abs=1e-6)
    assert contact.point == pytest.approx((2.0, 2.5))
    assert contact.normal == pytest.approx((-1.0, 0.0))
    assert contact.obstacle is None
    assert repr(contact) == (
        f"Contact(point={contact.point}, normal={contact.normal}, fraction={contact.fraction}, obstacle=None)"
    )
    assert mrs.advance(post, DISC, start, AHEAD, 3.0, mode="report") == (mrs.Pose(3.0, 2.5, 0.0), contact)
    end, _ = mrs.advance(post, DISC, start, (1.0, 0.1, 0.0), 3.0, mode="slide")
    assert 1.5 - 1e-6 <= end.x < 1.5
    assert end.y == pytest.approx(2.8)


def test_without_contact_the_motion_equals_that_of_the_pose(post: mrs.OccupancyGrid) -> None:
    pose = mrs.Pose(-3.0, 1.0, 0.3)
    assert mrs.advance(post, DISC, pose, (0.4, 0.1, 0.7), 0.5) == (pose.integrate((0.4, 0.1, 0.7), 0.5), None)


def test_a_robot_stops_at_another_robot(post: mrs.OccupancyGrid) -> None:
    others = [(DISC, (-5.0, 0.0, 0.0)), (mrs.Shape.rectangle(2.0, 2.0), (4.0, -5.0, 0.0))]
    end, contact = mrs.advance(post, DISC, (0.0, -5.0, 0.0), AHEAD, 9.0, obstacles=others)
    assert contact is not None
    assert contact.obstacle == 1
    assert end.x == pytest.approx(2.5, abs=1e-6)
    assert "obstacle=1" in repr(contact)


def test_clearance_and_touches_agree_with_hand_derived_distances(post: mrs.OccupancyGrid) -> None:
    assert mrs.clearance(post, DISC, (0.0, 2.5, 0.0), limit=9.0) == pytest.approx(1.5)
    assert mrs.clearance(post, DISC, (0.0, 2.5, 0.0), limit=1.0) == 1.0
    assert mrs.clearance(post, DISC, (50.0, 2.5, 0.0), limit=1e300) == pytest.approx(46.5)
    assert mrs.clearance(post, DISC, (0.0, 2.5, 0.0), limit=9.0, obstacles=[(DISC, (-1.5, 2.5, 0.0))]) == pytest.approx(0.5)
    assert mrs.touches(post, DISC, (1.6, 2.5, 0.0))
    assert not mrs.touches(post, DISC, (1.4, 2.5, 0.0))


def test_a_batch_of_clearances_equals_single_ones(post: mrs.OccupancyGrid) -> None:
    poses = np.column_stack([np.linspace(-4.0, 9.0, 6000), np.linspace(1.0, 4.0, 6000), np.linspace(0.0, 9.0, 6000)])
    box, obstacles = mrs.Shape.rectangle(0.7, 0.4), [(DISC, (6.0, 3.0, 0.0))]
    single = [mrs.clearance(post, box, tuple(pose), limit=3.0, obstacles=obstacles) for pose in poses]
    for threads in (None, 1, 2):
        batch = mrs.clearance_batch(post, box, poses, limit=3.0, obstacles=obstacles, threads=threads)
        assert batch.dtype == np.float64 and batch.tolist() == single
    assert mrs.clearance_batch(post, DISC, np.zeros((0, 3)), limit=1.0).shape == (0,)
    with pytest.raises(ValueError, match=r"poses must have shape \(N, 3\), got \(3,\)"):
        mrs.clearance_batch(post, DISC, (0.0, 0.0, 0.0), limit=1.0)
    with pytest.raises(ValueError, match=r"poses must be finite, got \[0.0, inf, 0.0\] in row 1"):
        mrs.clearance_batch(post, DISC, [(0.0, 0.0, 0.0), (0.0, math.inf, 0.0)], limit=1.0)
    with pytest.raises(ValueError, match="limit must be positive, got -1"):
        mrs.clearance_batch(post, DISC, [(0.0, 0.0, 0.0)], limit=-1.0)
    with pytest.raises(ValueError, match=r"threads must be in 1\.\.1024, got 0"):
        mrs.clearance_batch(post, DISC, [(0.0, 0.0, 0.0)], limit=1.0, threads=0)


def test_invalid_steps_are_rejected(post: mrs.OccupancyGrid) -> None:
    with pytest.raises(ValueError, match="mode must be 'stop', 'slide' or 'report', got 'bounce'"):
        mrs.advance(post, DISC, (0, 0, 0), AHEAD, 1.0, mode="bounce")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="vx must be finite, got NaN"):
        mrs.advance(post, DISC, (0, 0, 0), (math.nan, 0.0, 0.0), 1.0)
    with pytest.raises(ValueError, match="dt must be at least 0, got -1"):
        mrs.advance(post, DISC, (0, 0, 0), AHEAD, -1.0)
    with pytest.raises(ValueError, match="dt must be short enough"):
        mrs.advance(post, DISC, (0, 0, 0), AHEAD, 1e300)
    with pytest.raises(ValueError, match="limit must be positive, got 0"):
        mrs.clearance(post, DISC, (0, 0, 0), limit=0.0)
    with pytest.raises(TypeError):
        mrs.touches(post, "disc", (0, 0, 0))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"point": (math.nan, 0.0)}, "point x must be finite, got NaN"),
        ({"normal": (1.0, 0.1)}, "length of normal must be at most 1, got 1.00"),
        ({"fraction": 1.5}, "fraction must be in 0..1, got 1.5"),
        ({"obstacle": -1}, "obstacle must be at least 0, got -1"),
    ],
)
def test_a_contact_can_be_made_of_its_numbers(changed: dict[str, Any], message: str) -> None:
    numbers: dict[str, Any] = {"point": (2.0, 2.5), "normal": (-1.0, 0.0), "fraction": 0.5, "obstacle": 1}
    contact = mrs.Contact(**numbers)
    assert {name: getattr(contact, name) for name in numbers} == numbers
    with pytest.raises(ValueError, match=message):
        mrs.Contact(**numbers | changed)


def test_every_contact_can_be_made_anew(post: mrs.OccupancyGrid) -> None:
    outlines = [DISC, mrs.Shape.rectangle(0.7, 0.3), mrs.Shape.polygon([(0.5, 0.0), (-0.3, 0.4), (-0.1, -0.4)])]
    obstacles = [(mrs.Shape.disc(0.4), (1.0, 1.0, 0.0))]
    found = 0
    for number in range(600):
        start, twist = (number % 17 / 4, number % 19 / 4, number / 7), (1.0, number % 5 / 5, number % 3 - 1.0)
        _, contact = mrs.advance(post, outlines[number % 3], start, twist, 2.0, mode="report", obstacles=obstacles)
        if contact is not None:
            found += 1
            names = ("point", "normal", "fraction", "obstacle")
            assert mrs.Contact(**{name: getattr(contact, name) for name in names}) == contact
    assert found > 200
