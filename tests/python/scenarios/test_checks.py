"""checks: wrong arguments of spaces and worlds are named as the caller gave them, with what is needed."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.scenarios import FaultRange, Free, Moving, Range, Space, World, WorldMap
from mobile_robot_simulator.scenarios.checks import to_goal, to_place

ROOM = WorldMap()


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: Space("room"), TypeError, "maps must be a sequence of scenarios.WorldMap, got 'room'"),
        (lambda: Space(ROOM), TypeError, "maps must be a sequence of scenarios.WorldMap, got WorldMap(kind='room', "),
        (lambda: Space(["room"]), TypeError, "maps[0] must be a scenarios.WorldMap, got 'room'"),
        (lambda: Space([]), ValueError, "maps must be one or more of scenarios.WorldMap, got none"),
        (
            lambda: Space(parameters={"robot_raduis": 1.0}),
            ValueError,
            "unknown parameter 'robot_raduis'; did you mean 'robot_radius'?",
        ),
        (lambda: Space(start=3), TypeError, "start must be three numbers (x, y, yaw), got 3"),
        (lambda: Space(start=(1, 2)), ValueError, "start must be three finite numbers (x, y, yaw), got (1, 2)"),
        (
            lambda: Space(start=(1, 2, math.nan)),
            ValueError,
            "start must be three finite numbers (x, y, yaw), got (1, 2, nan)",
        ),
        (lambda: Space(start=None), TypeError, "start must be three numbers (x, y, yaw), got None"),
        (lambda: Space(goal=(1, 2, 3)), ValueError, "goal must be two finite numbers (x, y), got (1, 2, 3)"),
        (lambda: Space(goal=(1, math.inf)), ValueError, "goal must be two finite numbers (x, y), got (1, inf)"),
        (lambda: Space(goal="here"), TypeError, "goal must be two finite numbers (x, y), got 'here'"),
        (lambda: Space(goal=mrs.Pose()), TypeError, "goal must be two finite numbers (x, y), got Pose(0.0, 0.0, 0.0)"),
        (lambda: Space(obstacles=3), TypeError, "obstacles must be a scenarios.Moving or None, got 3"),
        (lambda: Space(faults=3), TypeError, "faults must be a sequence of scenarios.FaultRange, got 3"),
        (lambda: Space(faults=["Drop"]), TypeError, "faults[0] must be a scenarios.FaultRange, got 'Drop'"),
        (lambda: Space(parameters=[3]), TypeError, "parameters must be a mapping from names to values, got [3]"),
        (lambda: Space(duration="1"), TypeError, "duration must be a number, got '1'"),
        (lambda: Space(duration=0), ValueError, "duration must be positive, got 0 s"),
        (lambda: Space(tolerance=-1), ValueError, "tolerance must be finite and at least 0, got -1"),
        (lambda: Space(is_noisy=1), TypeError, "is_noisy must be True or False, got 1"),
        (lambda: Free("a"), TypeError, "radius must be a number, got 'a'"),
        (lambda: Free(1.0, 3.0), TypeError, "yaw must be a scenarios.Range, got 3.0"),
        (lambda: Moving("a"), TypeError, "at_most must be an integer, got 'a'"),
        (lambda: Moving(2.0), TypeError, "at_most must be an integer, got 2.0"),
        (lambda: Moving(2, at_least=-1), ValueError, "at_least must be at least 0, got -1"),
        (lambda: Moving(2, radius=0.1), TypeError, "radius must be a scenarios.Range, got 0.1"),
        (lambda: Moving(2, speed=None), TypeError, "speed must be a scenarios.Range, got None"),
        (lambda: Range(0, 1, 3), TypeError, "unit must be a text, got 3"),
        (lambda: FaultRange(3), TypeError, "kind must be the name of a fault such as 'Drop', got 3"),
        (lambda: FaultRange("Drop", 3), TypeError, "arguments must be a mapping from names to values, got 3"),
        (lambda: FaultRange("Drop", duration=3), TypeError, "duration must be a scenarios.Range or None, got 3"),
        (
            lambda: FaultRange("Drop", {"topc": "/scan"}),
            ValueError,
            "fault \"Drop(topc='/scan')\": unknown argument of Drop 'topc'; did you mean 'topic'?",
        ),
        (
            lambda: FaultRange("Drop", {"topic": "/scan", "probability": Range(0.5, 2.0)}),
            ValueError,
            "fault \"Drop(topic='/scan', probability=2.0)\": ",
        ),
        (lambda: World(ROOM, "here"), TypeError, "start must be three numbers (x, y, yaw), got 'here'"),
        (lambda: World(ROOM, (1, 2, 3), (1,)), ValueError, "goal must be two finite numbers (x, y), got (1,)"),
    ],
)
def test_wrong_arguments_are_named(make, error, message):
    with pytest.raises(error) as caught:
        make()
    assert str(caught.value).startswith(message)


@pytest.mark.parametrize("start", [mrs.Pose(1, 2, 0.5), (1, 2, 0.5), [1.0, 2.0, 0.5], np.array([1.0, 2.0, 0.5])])
def test_starts_are_poses_tuples_or_arrays(start):
    assert to_place(start) == (1.0, 2.0, 0.5) and all(type(number) is float for number in to_place(start))
    world = Space(start=start, goal=np.array([3, 4]), is_noisy=False).world([])
    assert world == World(ROOM, (1.0, 2.0, 0.5), (3.0, 4.0)) == World(ROOM, start, [3, 4])
    assert World.from_json(world.to_json()) == world and tuple(world.simulation().pose) == (1.0, 2.0, 0.5)
    assert to_goal([3, 4]) == (3.0, 4.0)


def test_numbers_of_numpy_are_kept():
    fault = FaultRange("Drop", {"topic": "/scan", "probability": np.float64(0.5)}, chance=1.0)
    parameters = {"laser_beam_count": np.int64(9), "acceleration_limits": np.array([1.0, 1.0, 2.0])}
    world = Space(start=(1, 1, 0), goal=None, faults=(fault,), parameters=parameters, is_noisy=False).world([])
    again = World.from_json(world.to_json())
    assert again.faults == ("Drop(topic='/scan', probability=0.5)",)
    assert again.parameters == {"laser_beam_count": 9, "acceleration_limits": [1.0, 1.0, 2.0]}
    assert len(again.simulation().laser.scanner.angles) == 9
    with pytest.raises(TypeError, match="parameters of a world must be numbers, texts or sequences of them, got <object"):
        World(ROOM, (1, 1, 0), parameters={"a": object()}).to_json()
