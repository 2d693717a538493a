"""crowd: things with a place, which the core gets once."""

from __future__ import annotations

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.physics.crowd import Crowd

DISC = mrs.Shape.disc(0.5)
OPEN = mrs.OccupancyGrid(cells=np.zeros((1, 1), np.int8), resolution=1.0)


def gap(crowd: Crowd[str], thing: str) -> float:
    """Distance from the origin to the nearest of all others, as the core sees it."""
    return mrs.clearance(OPEN, mrs.Shape.disc(0.1), (0.0, 0.0, 0.0), limit=50.0, obstacles=crowd.around(thing)) + 0.6


def test_everything_but_one_thing_is_around_it_wherever_the_others_go():
    crowd = Crowd([("a", (DISC, mrs.Pose(2.0))), ("b", (DISC, mrs.Pose(4.0)))])
    assert (gap(crowd, "a"), gap(crowd, "b"), gap(crowd, "c")) == pytest.approx((4.0, 2.0, 2.0))
    around = crowd.around("a")
    crowd.move(1, mrs.Pose(3.0))
    assert crowd.around("a") is around and gap(crowd, "a") == pytest.approx(3.0)
    assert crowd.things == [("a", (DISC, mrs.Pose(2.0))), ("b", (DISC, mrs.Pose(3.0)))]


def test_a_thing_that_comes_moves_the_others_up():
    crowd: Crowd[str] = Crowd()
    crowd.insert(0, "b", (DISC, mrs.Pose(4.0)))
    around = crowd.around("a")
    crowd.insert(0, "a", (DISC, mrs.Pose(2.0)))
    assert [crowd.index_of(name) for name in "abc"] == [0, 1, None]
    assert crowd.around("a") is not around and gap(crowd, "b") == pytest.approx(2.0)


def test_a_thing_that_comes_last_is_around_the_others_but_not_around_what_was_asked_before():
    crowd = Crowd([("a", (DISC, mrs.Pose(4.0)))])
    assert crowd.index_of("a") == 0
    crowd.insert(1, "b", (DISC, mrs.Pose(3.0)))
    assert crowd.index_of("b") == 1 and gap(crowd, "a") == pytest.approx(3.0)
    around = crowd.around("a")
    crowd.insert(2, "c", (DISC, mrs.Pose(2.0)))
    assert len(around) == 2 and len(crowd.around("a")) == 3 and gap(crowd, "a") == pytest.approx(2.0)


def test_a_shape_touches_things_in_their_order():
    crowd = Crowd([(name, (DISC, mrs.Pose(x))) for name, x in (("a", 1.0), ("b", 9.0), ("c", 0.5))])
    assert crowd.touches(DISC, mrs.Pose(0.3)) == ["a", "c"]
    assert crowd.touches(DISC, mrs.Pose(0.3), "a") == ["c"] and crowd.touches(DISC, mrs.Pose(0.3), "d") == ["a", "c"]
    assert crowd.touches(DISC, mrs.Pose(5.0)) == [] == Crowd[str]().touches(DISC, mrs.Pose())
