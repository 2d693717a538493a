"""Fleets: any threads and any split give the same bytes; reset, save, restore; goals; wrong calls."""

from __future__ import annotations

import math
import pickle
import re
import threading
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import mobile_robot_simulator as mrs
from simulations import hall

COUNT = 60
MAPS = [mrs.floor_plan("office", seed=1), mrs.floor_plan("maze", seed=2), hall(8.0)]
GRID_OF = np.arange(COUNT) % 3


def options() -> dict[str, Any]:
    return {
        "footprint": mrs.Shape.rectangle(0.5, 0.3),
        "contact": "slide",
        "limits": mrs.Limits(acceleration=(1.0, 1.0, 3.0), deceleration=(2.0, 2.0, 6.0)),
        "scanner": mrs.LaserScanner(beam_count=90),
        "noise": mrs.BeamModel(sigma_hit=0.05, z_hit=0.9, z_rand=0.1),
        "odometry_noise": mrs.MotionNoise(alpha1=0.02, alpha4=0.02, reference_step=0.1),
        "obstacles": [(mrs.Shape.disc(0.3), (5.0, 5.0, 0.0)), (mrs.Shape.rectangle(1.0, 0.2), [(0, 2, 2, 0), (9, 6, 6, 6)])],
        "clearance": 0.05,
        "clearance_limit": 2.0,
    }


def fleet_of(robots: slice, **changes: Any) -> mrs.Fleet:
    """Returns the fleet of some of the robots."""
    return mrs.Fleet(MAPS, seeds=np.arange(COUNT)[robots] + 100, grid_of=GRID_OF[robots], **{**options(), **changes})


def commands_of(step: int) -> NDArray[np.float64]:
    return np.random.default_rng(step).uniform((-0.2, -0.2, -1.5), (1.5, 0.2, 1.5), (COUNT, 3))


ARRAYS = (
    "poses",
    "velocities",
    "contacts",
    "contact_points",
    "contact_obstacles",
    "contact_robots",
    "odometry",
    "ranges",
    "clearances",
)


def content(step: mrs.FleetStep) -> list[NDArray[Any]]:
    return [getattr(step, name) for name in ARRAYS]


def bytes_of(step: mrs.FleetStep, robots: slice = slice(None)) -> list[bytes]:
    return [array[robots].tobytes() for array in content(step)]


def test_threads_and_splits_change_no_byte() -> None:
    whole, parts = fleet_of(slice(None)), [slice(0, 1), slice(1, 37), slice(37, None)]
    others = [(slice(None), fleet_of(slice(None)), 1), (slice(None), fleet_of(slice(None)), 3)]
    others += [(part, fleet_of(part), 2) for part in parts]
    touched = 0
    for index in range(40):
        commands = commands_of(index)
        step = whole.step(commands, 0.1)
        touched += int(step.contacts.sum())
        for robots, fleet, threads in others:
            assert bytes_of(fleet.step(commands[robots], 0.1, threads=threads)) == bytes_of(step, robots)
    assert touched > 100 and not step.contacts.all()


def test_a_step_moves_as_the_parts_of_it_that_end_at_multiples_of_20_ms() -> None:
    """A command that does not change may be split without any change of the motion."""
    whole, split = fleet_of(slice(None)), fleet_of(slice(None))
    for index in range(10):
        once = whole.step(commands_of(index), 0.24, scan=False)
        for _ in range(3):
            part = split.step(commands_of(index), 0.08, scan=False)
        assert np.abs(once.poses[:, :2] - part.poses[:, :2]).max() < 1e-5
        assert once.ranges is None


def test_scans_and_clearances_are_those_of_the_functions_for_them() -> None:
    fleet = fleet_of(slice(None))
    for index in range(3):
        step = fleet.step(commands_of(index), 0.1)
        for robot in range(COUNT):
            scan = options()["scanner"].scan_batch(
                MAPS[GRID_OF[robot]],
                step.poses[robot : robot + 1],
                noise=options()["noise"],
                seed=100 + robot,
                first_index=index,
                obstacles=[at(obstacle, 0.1 * (index + 1)) for obstacle in options()["obstacles"]],
            )
            assert step.ranges is not None and scan.tobytes() == step.ranges[robot].tobytes()
            obstacles = [at(obstacle, 0.1 * (index + 1)) for obstacle in options()["obstacles"]]
            nearest = mrs.clearance(
                MAPS[GRID_OF[robot]], options()["footprint"], step.poses[robot], limit=2.0, obstacles=obstacles
            )
            assert step.clearances is not None and step.clearances[robot] == nearest
    mask = np.arange(COUNT) % 7 == 0
    assert fleet.scan(mask).tobytes() == fleet_after(3).scan()[mask].tobytes()


@pytest.mark.parametrize("is_one", [True, False])
def test_scans_have_the_noise_of_surfaces(is_one: bool) -> None:
    models = [
        mrs.SurfaceModel(incidence_sigma=0.5, incidence_bias=0.3, correlation=0.5, beam_divergence=0.02),
        mrs.SurfaceModel(),
        mrs.SurfaceModel(reference_range=6.0),
    ]
    surfaces = [models[0] if is_one else models[robot // 5 % 3] for robot in range(COUNT)]
    fleet = fleet_of(slice(None), surfaces=models[0] if is_one else surfaces)
    for index in range(2):
        step = fleet.step(commands_of(index), 0.1)
        for robot in range(COUNT):
            scan = options()["scanner"].scan_batch(
                MAPS[GRID_OF[robot]],
                step.poses[robot : robot + 1],
                noise=options()["noise"],
                surfaces=surfaces[robot],
                seed=100 + robot,
                first_index=index,
                obstacles=[at(obstacle, 0.1 * (index + 1)) for obstacle in options()["obstacles"]],
            )
            assert step.ranges is not None and scan.tobytes() == step.ranges[robot].tobytes()
    threads = [fleet_of(slice(None), surfaces=surfaces).step(commands_of(0), 0.1, threads=count) for count in (1, 3)]
    assert threads[0].ranges is not None and threads[1].ranges is not None
    assert threads[0].ranges.tobytes() == threads[1].ranges.tobytes()
    copy = pickle.loads(pickle.dumps(fleet))
    assert repr(copy.surfaces) == repr(fleet.surfaces) and copy.scan().tobytes() == fleet.scan().tobytes()


def test_surfaces_need_noise_and_a_scanner_that_is_not_tilted() -> None:
    with pytest.raises(ValueError, match="surfaces need noise, a BeamModel, got None"):
        fleet_of(slice(None), noise=None, surfaces=mrs.SurfaceModel())
    with pytest.raises(ValueError, match="surfaces must have 60 elements, got 59"):
        fleet_of(slice(None), surfaces=[mrs.SurfaceModel()] * 59)
    with pytest.raises(TypeError, match="surfaces must be one SurfaceModel or a sequence"):
        fleet_of(slice(None), surfaces=0.5)
    tilted = mrs.LaserScanner(beam_count=9, mount=(0.0, 0.0, 1.0, 0.0, 0.3, 0.0))
    fleet = fleet_of(slice(None), scanner=tilted, surfaces=mrs.SurfaceModel(correlation=0.5))
    poses = fleet.poses.tobytes()
    with pytest.raises(ValueError, match="tilted"):
        fleet.step(commands_of(0), 0.1)
    assert fleet.poses.tobytes() == poses


def at(obstacle: tuple[mrs.Shape, Any], time: float) -> tuple[mrs.Shape, tuple[float, ...]]:
    """Returns an obstacle of the options with its pose at a time [s]."""
    shape, trajectory = obstacle
    rows = np.array(trajectory, np.float64)
    if rows.ndim == 1:
        return shape, tuple(rows)
    (before, *start), (after, *end) = rows.tolist()
    share = (time - before) / (after - before)
    return shape, tuple(low + share * (high - low) for low, high in zip(start, end, strict=True))


def fleet_after(steps: int) -> mrs.Fleet:
    fleet = fleet_of(slice(None))
    for index in range(steps):
        fleet.step(commands_of(index), 0.1)
    return fleet


def test_rollouts_are_steps() -> None:
    fleet, commands = fleet_after(4), np.random.default_rng(5).uniform((0.2, -0.3, -1.0), (1.8, 0.3, 1.0), (7, 25, 3))
    before = fleet.save().words.tobytes()
    poses, contacts = fleet.rollout(commands, 0.15, robot=8)
    assert fleet.save().words.tobytes() == before and contacts.any() and not contacts.all()
    assert fleet.rollout(commands, 0.15, robot=8, threads=1)[0].tobytes() == poses.tobytes()
    for row in range(7):
        other = fleet_after(4)
        for index in range(25):
            step = other.step(np.tile(commands[row, index], (COUNT, 1)), 0.15, scan=False)
            assert step.poses[8].tobytes() == poses[row, index].tobytes()
            assert step.contacts[8] == contacts[row, index]


def test_robots_that_share_a_world_touch_and_see_each_other() -> None:
    ahead, back = (2.0, 4.0, 0.0), (5.0, 4.0, math.pi)
    for world_of in ([7, 7, 1], [1, 2, 3]):
        fleet = mrs.Fleet(
            hall(8.0),
            [ahead, back, ahead],
            world_of=world_of,
            footprint=mrs.Shape.disc(0.4),
            scanner=mrs.LaserScanner(beam_count=1, max_range=20.0),
        )
        first = fleet.scan()[:, 0].tolist()
        step = fleet.step([(1.0, 0.0, 0.0)] * 3, 1.4)
        together = world_of[0] == world_of[1]
        assert first == pytest.approx([2.6, 2.6, 5.9] if together else [5.9, 4.9, 5.9], abs=1e-6)
        assert step.contacts.tolist() == [together, together, False]
        assert step.contact_robots.tolist() == ([1, 0, -1] if together else [-1] * 3)
        assert (step.contact_obstacles == -1).all()
        gap = step.poses[1, 0] - step.poses[0, 0]
        assert 0.8 <= gap < 0.8 + 1e-5 if together else gap < 0.3


def test_an_obstacle_of_one_world_is_only_there() -> None:
    obstacles = [(mrs.Shape.disc(0.5), (5.0, 4.0, 0.0), 4), (mrs.Shape.disc(0.5), (6.0, 4.0, 0.0))]
    arguments = {"world_of": [4, 5], "obstacles": obstacles, "footprint": mrs.Shape.disc(0.5)}
    fleet = mrs.Fleet(hall(8.0), [(2.0, 4.0, 0.0)] * 2, **arguments)
    step = fleet.step([(1.0, 0.0, 0.0)] * 2, 5.0)
    assert step.contact_obstacles.tolist() == [0, 1] and step.poses[:, 0].tolist() == pytest.approx([4.0, 5.0], abs=1e-5)


def test_a_robot_in_a_shared_world_is_reset_into_its_time() -> None:
    fleet = mrs.Fleet(hall(8.0), [(2.0, 2.0, 0.0), (2.0, 6.0, 0.0), (6.0, 6.0, 0.0)], world_of=[1, 1, 2])
    fleet.step(np.zeros((3, 3)), 0.5)
    fleet.reset([True, False, True])
    assert fleet.times.tolist() == [0.5, 0.5, 0.0]
    fleet.reset([True, True, False])
    assert fleet.times.tolist() == [0.0, 0.0, 0.0]
    state = fleet.save([True, False, False])
    fleet.step(np.zeros((3, 3)), 0.5)
    with pytest.raises(ValueError, match=r"must be at the same time, got 0\.5 s for robot 1 and 0 s"):
        fleet.restore(state)
    assert fleet.times.tolist() == [0.5, 0.5, 0.5]


def test_true_ranges_without_noise_and_true_motion_without_a_footprint() -> None:
    fleet = fleet_of(slice(None), noise=None, footprint=None, limits=None)
    start = fleet.poses
    step = fleet.step(commands_of(0), 0.5)
    assert not step.contacts.any() and np.isnan(step.contact_points).all()
    assert np.allclose(step.poses[:, :2], mrs.integrate_twist(start, commands_of(0), 0.5)[:, :2], atol=1e-12)
    assert np.array_equal(step.velocities, commands_of(0))
    for robot in range(5):
        obstacles = [at(obstacle, 0.5) for obstacle in options()["obstacles"]]
        true = options()["scanner"].scan(MAPS[GRID_OF[robot]], step.poses[robot], obstacles=obstacles)
        assert step.ranges is not None and true.tobytes() == step.ranges[robot].tobytes()


def test_contact_is_reported_where_it_is() -> None:
    # The wall of the hall starts at x = 7.9 m.
    fleet = mrs.Fleet(hall(8.0), [(6.0, 4.0, 0.0), (6.0, 4.0, math.pi)], footprint=mrs.Shape.disc(0.5))
    step = fleet.step([(1.0, 0.0, 0.0)] * 2, 2.0)
    assert step.contacts.tolist() == [True, False]
    assert np.allclose(step.contact_points[0], (7.9, 4.0), atol=1e-9) and np.isnan(step.contact_points[1]).all()
    assert np.allclose(step.poses[:, 0], [7.4, 4.0], atol=1e-6) and step.velocities[:, 0].tolist() == [0.0, 1.0]


def test_out_takes_the_results() -> None:
    fleet, again = fleet_of(slice(None)), fleet_of(slice(None))
    arrays = [np.full_like(array, 1) for array in content(fleet_of(slice(None)).step(commands_of(0), 0.1))]
    own = mrs.FleetStep(**dict(zip(ARRAYS, arrays, strict=True)))
    for index in range(2):
        assert fleet.step(commands_of(index), 0.1, out=own) is own
        assert [array.tobytes() for array in arrays] == bytes_of(again.step(commands_of(index), 0.1))


def test_a_reset_begins_anew() -> None:
    fleet, fresh = fleet_after(5), fleet_of(slice(None))
    fleet.reset(seeds=np.arange(COUNT) + 100)
    assert fleet.times.max() == 0.0 and not fleet.velocities.any()
    for index in range(5):
        assert bytes_of(fleet.step(commands_of(index), 0.1)) == bytes_of(fresh.step(commands_of(index), 0.1))


def test_a_reset_of_some_leaves_the_others_alone() -> None:
    fleet, same, mask = fleet_after(5), fleet_after(5), np.arange(COUNT) < 7
    fleet.reset(mask, poses=np.where(mask[:, np.newaxis], (1.0, 1.0, 0.5), np.nan), grids=np.full(COUNT, 2))
    assert (fleet.poses[mask] == (1.0, 1.0, 0.5)).all()
    assert fleet.grid_of.tolist() == np.where(mask, 2, GRID_OF).tolist()
    step, expected = fleet.step(commands_of(5), 0.1), same.step(commands_of(5), 0.1)
    assert bytes_of(step, slice(7, None)) == bytes_of(expected, slice(7, None))
    assert np.isclose(fleet.times, np.where(mask, 0.1, 0.6)).all()


def test_drawn_poses_are_those_of_draw_free_poses() -> None:
    fleet = fleet_of(slice(None))
    radius = options()["footprint"].reach + options()["clearance"]
    for draw in range(3):
        for robot in range(0, COUNT, 9):
            drawn = MAPS[GRID_OF[robot]].draw_free_poses(1, radius=radius, seed=100 + robot, first_index=draw)
            assert drawn[0].tolist() == pytest.approx(fleet.poses[robot].tolist(), abs=1e-12)
        fleet.reset()


def test_saved_robots_go_on_as_if_nothing_had_happened() -> None:
    fleet, mask = fleet_after(4), np.arange(COUNT) % 2 == 0
    state, even = fleet.save(mask), slice(0, None, 2)
    expected = [bytes_of(fleet.step(commands_of(index), 0.07), even) for index in range(3)]
    assert len(state) == COUNT // 2 and state.robots.tolist() == list(range(0, COUNT, 2))
    fleet.restore(mrs.FleetState(state.words))
    assert [bytes_of(fleet.step(commands_of(index), 0.07), even) for index in range(3)] == expected


def test_one_state_goes_to_many_robots() -> None:
    fleet, imagined = fleet_after(4), fleet_of(slice(None))
    only = np.arange(COUNT) == 8
    imagined.restore(fleet.save(only), np.ones(COUNT, bool))
    command = np.tile(commands_of(9)[8], (COUNT, 1))
    expected = fleet.step(command, 0.1)
    step = imagined.step(command, 0.1)
    for robot in range(COUNT):
        assert bytes_of(step, slice(robot, robot + 1)) == bytes_of(expected, slice(8, 9))


CAR = mrs.Drive.ackermann(wheelbase=0.4, track=0.3, wheel_radius=0.1, steering_limit=0.6, steering_rate=0.8)
WIDE = mrs.Drive.ackermann(wheelbase=0.5, track=0.4, wheel_radius=0.1, steering_limit=0.5, wheel_speed_limit=9.0)
DRIVES = [[CAR, WIDE][robot % 2] for robot in range(COUNT)]


def wheels_of(fleet: mrs.Fleet, robots: slice = slice(None)) -> list[bytes]:
    """Returns what the wheels of some of the robots do, as bytes."""
    return [array[robots].tobytes() for array in (*fleet.joints(), fleet.steering)]


@pytest.mark.parametrize("columns", [[0, 1, 2], [0, 2]])
def test_threads_and_splits_change_no_byte_of_robots_on_wheels(columns: list[int]) -> None:
    whole, parts = fleet_of(slice(None), drive=DRIVES), [slice(0, 1), slice(1, 37), slice(37, None)]
    others = [(part, fleet_of(part, drive=DRIVES[part]), 2) for part in parts]
    others.append((slice(None), fleet_of(slice(None), drive=DRIVES), 1))
    touched = 0
    for index in range(40):
        commands = commands_of(index)[:, columns]
        step = whole.step(commands, 0.1)
        touched += int(step.contacts.sum())
        for robots, fleet, threads in others:
            assert bytes_of(fleet.step(commands[robots], 0.1, threads=threads)) == bytes_of(step, robots)
            assert wheels_of(fleet) == wheels_of(whole, robots)
    assert touched > 100 and np.abs(whole.steering).max() > 0.4


@pytest.mark.parametrize("columns", [[0, 1, 2], [0, 2]])
def test_rollouts_on_wheels_are_steps_while_the_others_go_on(columns: list[int]) -> None:
    together = {"drive": DRIVES, "world_of": np.arange(COUNT) % 12}
    commands = np.random.default_rng(5).uniform((0.2, -0.3, -1.0), (1.8, 0.3, 1.0), (4, 25, 3))[:, :, columns]

    def begun() -> mrs.Fleet:
        fleet = fleet_of(slice(None), **together)
        for index in range(3):
            fleet.step(commands_of(index)[:, columns], 0.1)
        return fleet

    fleet, last = begun(), commands_of(2)[:, columns]
    before = fleet.save().words.tobytes()
    poses, contacts = fleet.rollout(commands, 0.15, robot=8)
    assert fleet.save().words.tobytes() == before and contacts.any() and not contacts.all()
    for row in range(4):
        other = begun()
        for index in range(25):
            last[8] = commands[row, index]
            step = other.step(last, 0.15, scan=False)
            assert step.poses[8].tobytes() == poses[row, index].tobytes()
            assert step.contacts[8] == contacts[row, index]


def test_another_car_goes_on_in_its_circle_during_a_rollout() -> None:
    def begun() -> mrs.Fleet:
        poses = [(4.6, 6.5, -math.pi / 2), (4.0, 4.0, 0.0)]
        fleet = mrs.Fleet(hall(8.0), poses, footprint=mrs.Shape.disc(0.3), drive=CAR, world_of=[0, 0])
        fleet.step([(0.0, 0.0), (0.5, 0.6)], 0.1)
        return fleet

    poses, contacts = begun().rollout([[(0.5, 0.0)] * 12], 0.3)
    fleet = begun()
    steps = [fleet.step([(0.5, 0.0), (0.5, 0.6)], 0.3) for _ in range(12)]
    assert np.array([step.poses[0] for step in steps]).tobytes() == poses[0].tobytes()
    assert [bool(step.contacts[0]) for step in steps] == contacts[0].tolist()
    assert contacts.any() and not contacts.all()  # It meets the car in its circle.


def test_saved_robots_on_wheels_go_on_as_if_nothing_had_happened() -> None:
    fleet = fleet_of(slice(None), drive=DRIVES)
    for index in range(4):
        fleet.step(commands_of(index), 0.07)
    state, copy = fleet.save(), pickle.loads(pickle.dumps(fleet))
    expected = [(bytes_of(fleet.step(commands_of(index), 0.07)), wheels_of(fleet)) for index in range(9)]
    assert copy.drive == DRIVES
    fleet.restore(mrs.FleetState(state.words))
    for again in (fleet, copy):
        assert [(bytes_of(again.step(commands_of(index), 0.07)), wheels_of(again)) for index in range(9)] == expected
    for drive in (None, WIDE):
        with pytest.raises(ValueError, match="the state of robot 0 must be of a robot with the same drive, got one with"):
            fleet_of(slice(None), drive=drive).restore(state)


def test_wheels_that_still_steer_lead_a_robot_away_from_the_wall() -> None:
    grid = mrs.OccupancyGrid(np.pad(np.zeros((40, 40), np.int8), 1, constant_values=100), resolution=0.1)
    slow = mrs.Drive.ackermann(wheelbase=0.4, track=0.3, wheel_radius=0.1, steering_limit=0.6, steering_rate=0.2)
    # Its front left corner is 5 mm from a wall to its left.
    body = mrs.Shape.polygon([(-0.1, -0.2), (0.6, -0.2), (0.6, 0.2), (-0.1, 0.2)])
    fleet = mrs.Fleet(grid, [(1.0, 3.895, 0.0)], footprint=body, drive=slow)
    assert fleet.step([(0.2, 0.6)], 3.0).contacts[0]
    pressed = fleet.poses
    assert fleet.step([(0.2, -0.6)], 2.0).contacts[0] and fleet.poses.tobytes() == pressed.tobytes()
    # After 3 s, the wheels steer to the right.
    fleet.step([(0.2, -0.6)], 1.1)
    assert not fleet.step([(0.2, -0.6)], 4.0).contacts[0]
    assert fleet.poses[0, 0] > 1.2 and fleet.poses[0, 1] < 3.9


def test_wrong_commands_of_robots_on_wheels_are_refused() -> None:
    car = fleet_of(slice(None), drive=CAR)
    cases: list[tuple[mrs.Fleet, Any, str]] = [
        (car, np.zeros((2, 2)), "commands must have shape (60, 3) or (60, 2), got (2, 2)"),
        (car, np.zeros((COUNT, 4)), "commands must have shape (60, 3) or (60, 2), got (60, 4)"),
        (car, np.full((COUNT, 2), np.nan), "the command of robot 0 must be finite and at most 1000 on each axis, got [NaN"),
        (fleet_of(slice(None)), np.zeros((COUNT, 2)), "commands must be rows (vx, vy, wz) for robots without an Acker"),
    ]
    for fleet, commands, message in cases:
        before = fleet.save().words.tobytes()
        with pytest.raises(ValueError, match=re.escape(message)):
            fleet.step(commands, 0.1)
        assert fleet.save().words.tobytes() == before
    with pytest.raises(ValueError, match="without an Ackermann drive"):
        fleet_of(slice(None)).rollout(np.zeros((1, 3, 2)), 0.1)
    with pytest.raises(ValueError, match=r"commands must have shape \(K, T, 3\) or \(K, T, 2\), got \(3, 2\)"):
        car.rollout(np.zeros((3, 2)), 0.1)


def test_a_steering_angle_that_a_drive_cannot_have_is_no_state() -> None:
    drive = mrs.Drive.differential(track=0.3, wheel_radius=0.1)
    fleet = mrs.Fleet(MAPS[0], [(1.0, 1.0, 0.0)], drive=drive)
    words = fleet.save().words.copy()
    # The steering angle of the profile is two words before its rate, which is infinite for this drive.
    (rate, *_) = np.flatnonzero(words[0] == np.float64(np.inf).view(np.uint64))
    assert words[0, rate - 4 : rate].tolist() == [1, 0, 0, 0]
    words[0, rate - 2] = np.float64(0.2).view(np.uint64)
    with pytest.raises(ValueError, match="saved state, got a steering angle that the drive cannot have"):
        mrs.FleetState(words)
    words[0, rate - 2] = 0
    mrs.FleetState(words)
    words[0, -8] = 0  # no drive
    with pytest.raises(ValueError, match="saved state, got a steering angle that the drive cannot have"):
        mrs.FleetState(words)


def test_rates_of_joints_that_are_no_numbers_are_refused() -> None:
    tiny = mrs.Drive.differential(track=0.3, wheel_radius=1e-308)
    fleet = mrs.Fleet(MAPS[0], [(1.0, 1.0, 0.0)], drive=tiny)
    fleet.step([(5.0, 0.0, 0.0)], 1e-3)
    with pytest.raises(ValueError, match="the resulting rates must be finite, got inf in row 0"):
        fleet.joints()


def test_the_time_of_a_world_is_bounded() -> None:
    fleet = mrs.Fleet(hall(4.0), [(2.0, 2.0, 0.0)])
    state = fleet.save().words
    state[0, 1] = 2**62 - 1_000_000_000  # the time of the robot [ns]
    fleet.restore(mrs.FleetState(state))
    fleet.step(np.zeros((1, 3)), 0.5)
    with pytest.raises(ValueError, match=r"the time of a world must be below 4\.6e9 s, got 4611686018\.5"):
        fleet.step(np.zeros((1, 3)), 0.6)


def test_goals_are_seen_from_the_robot() -> None:
    fleet = mrs.Fleet(hall(8.0), [(1.0, 1.0, math.pi / 2), (2.0, 1.0, math.pi), (4.0, 4.0, 0.0)])
    seen = fleet.relative([(1.0, 4.0), (2.0, 3.0), (4.0, 4.0)])
    assert np.allclose(seen, [(3.0, 0.0), (2.0, -math.pi / 2), (0.0, 0.0)], atol=1e-12)
    goals = np.random.default_rng(1).uniform(0, 8, (COUNT, 2))
    fleet = fleet_of(slice(None))
    (dx, dy), yaw = (goals - fleet.poses[:, :2]).T, fleet.poses[:, 2]
    turned = np.exp(1j * (np.arctan2(dy, dx) - yaw))
    assert np.allclose(fleet.relative(goals), np.stack([np.hypot(dx, dy), np.angle(turned)], axis=1), atol=1e-9)


def test_goals_are_seen_from_chosen_robots_only() -> None:
    fleet, goals = fleet_of(slice(None)), np.random.default_rng(1).uniform(0, 8, (COUNT, 2))
    all_seen, mask = fleet.relative(goals), np.arange(COUNT) % 7 == 2
    goals[~mask] = np.nan
    assert fleet.relative(goals, mask).tobytes() == all_seen[mask].tobytes()
    assert fleet.relative(goals, np.zeros(COUNT, np.bool_)).shape == (0, 2)
    with pytest.raises(ValueError, match=r"goals must be finite, got NaN in row 3"):
        fleet.relative(goals, mask | (np.arange(COUNT) == 3))


def test_replaced_obstacles_are_those_of_a_fleet_made_with_them() -> None:
    rng, disc = np.random.default_rng(4), mrs.Shape.disc(0.3)

    def obstacles() -> list[Any]:
        ways = rng.uniform(1.0, 7.0, (COUNT, 3, 2))
        whole = [np.insert(np.pad(way, ((0, 0), (0, 1))), 0, [0.0, 1.5, 3.0], axis=1) for way in ways]
        some = [whole[index] if index % 3 else None if index % 2 else whole[index][0, 1:] for index in range(COUNT)]
        return [(mrs.Shape.disc(0.2 + 0.01 * (index % 7)), way, index) for index, way in enumerate(some)]

    before, after = obstacles(), obstacles()
    common = [(disc, (4.0, 4.0, 0.0))]
    fleet, other = fleet_of(slice(None), obstacles=common + before), fleet_of(slice(None), obstacles=common + after)
    for index in range(8):
        fleet.step(commands_of(index), 0.1)
    # The obstacles of some worlds only.
    chosen = np.arange(COUNT) % 4 != 1
    fleet.replace_obstacles([(1 + world, shape, way) for shape, way, world in after if chosen[world]])
    fleet.reset(poses=other.poses, seeds=other.seeds)
    untouched = fleet_of(slice(None), obstacles=common + before)
    copy, met = pickle.loads(pickle.dumps(fleet)), 0
    for index in range(40):
        step = fleet.step(commands_of(index), 0.1)
        others, old = other.step(commands_of(index), 0.1), untouched.step(commands_of(index), 0.1)
        for array, one, two in zip(content(step), content(others), content(old), strict=True):
            assert array[chosen].tobytes() == one[chosen].tobytes() and array[~chosen].tobytes() == two[~chosen].tobytes()
        assert bytes_of(copy.step(commands_of(index), 0.1)) == bytes_of(step)
        met += int((step.contact_obstacles > 0).sum())
    assert met > 10


def test_a_robot_goes_on_when_what_it_is_pressed_against_is_gone() -> None:
    disc = mrs.Shape.disc(0.5)
    fleet = mrs.Fleet(hall(8.0), [(2.0, 4.0, 0.0)], footprint=disc, obstacles=[(disc, (4.0, 4.0, 0.0), 0)])
    for _ in range(3):
        step = fleet.step([(1.0, 0.0, 0.0)], 1.0)
    assert step.contacts[0] and step.poses[0, 0] == pytest.approx(3.0, abs=1e-5)
    fleet.replace_obstacles([(0, disc, None)])
    step = fleet.step([(1.0, 0.0, 0.0)], 1.0)
    assert not step.contacts[0] and step.poses[0, 0] == pytest.approx(4.0, abs=1e-5)
    assert fleet.obstacles[0][1:] == (None, 0)
    fleet.replace_obstacles([(0, disc, (6.0, 4.0, 0.0))])
    step = fleet.step([(1.0, 0.0, 0.0)], 2.0)
    assert step.contacts[0] and step.poses[0, 0] == pytest.approx(5.0, abs=1e-5)


def test_a_robot_looks_for_contact_in_time_however_fast_obstacles_are() -> None:
    """A robot that is not alone looks in each time step. Its companion stands behind a wall, from x = 8 m to 8.1 m."""
    cells, rng, disc = np.zeros((80, 90), np.int8), np.random.default_rng(3), mrs.Shape.rectangle(0.6, 0.3)
    cells[:, 80] = 100
    grid, touched = mrs.OccupancyGrid(cells, resolution=0.1), 0
    for _ in range(30):
        times, places = np.cumsum(rng.uniform(0.1, 1.5, 6)), rng.uniform(0.5, 7.5, (6, 2))
        way = np.column_stack([times, places, rng.uniform(-9.0, 9.0, 6)])
        arguments = {"footprint": mrs.Shape.disc(0.2), "contact": "slide", "obstacles": [(disc, way)]}
        alone = mrs.Fleet(grid, [(4.0, 4.0, 0.0)], **arguments)
        two = mrs.Fleet(grid, [(4.0, 4.0, 0.0), (8.5, 4.0, 0.0)], world_of=[0, 0], **arguments)
        for duration in (0.01, 0.7, 0.3, 0.037, 1.2, 2.0, 0.05):
            command = rng.uniform((-0.5, 0.0, -1.0), (1.0, 0.0, 1.0))
            one = alone.step([command], duration)
            other = two.step([command, (0.0, 0.0, 0.0)], duration)
            for name in ("poses", "velocities", "contacts", "contact_points", "contact_obstacles", "odometry"):
                assert getattr(one, name)[0].tobytes() == getattr(other, name)[0].tobytes()
            touched += int(one.contact_obstacles[0] == 0)
    assert touched >= 20


@pytest.mark.parametrize(
    "obstacles, kind, message",
    [
        ([(1, mrs.Shape.disc(0.1), (1, 1, 0)), (2, mrs.Shape.disc(0.1), None)], ValueError, "must be below 2, got 2"),
        (
            [(1, mrs.Shape.disc(0.1), (1, 1, 0)), (0, mrs.Shape.disc(0.1), None)],
            ValueError,
            "got obstacle 0, which",
        ),
        ([(-1, mrs.Shape.disc(0.1), None)], ValueError, "the index of an obstacle must be at least 0, got -1"),
        (
            [(1, mrs.Shape.disc(0.1), (math.nan, 0, 0))],
            ValueError,
            "must be three finite numbers (x, y, yaw), got (nan, 0, 0)",
        ),
        ([(1, 0.1, None)], TypeError, "obstacles must be (index, Shape, trajectory)"),
        ([(1, mrs.Shape.disc(0.1))], TypeError, "obstacles must be (index, Shape, trajectory)"),
        (3, TypeError, "obstacles must be (index, Shape, trajectory)"),
    ],
)
def test_bad_replacements_change_nothing(obstacles: Any, kind: type[Exception], message: str) -> None:
    given = [(mrs.Shape.disc(0.2), (1.0, 1.0, 0.0)), (mrs.Shape.disc(0.3), (5.0, 5.0, 0.0), 0)]
    fleet = mrs.Fleet(hall(8.0), [(2.0, 4.0, 0.0)], obstacles=given)
    with pytest.raises(kind, match=re.escape(message)):
        fleet.replace_obstacles(obstacles)
    assert [way.tolist() for _, way, _ in fleet.obstacles] == [[[0, 1, 1, 0]], [[0, 5, 5, 0]]]


def test_changed_cells_are_met() -> None:
    grid = hall(8.0)
    fleet = mrs.Fleet(grid, [(2.0, 4.0, 0.0)], footprint=mrs.Shape.disc(0.2), scanner=mrs.LaserScanner(beam_count=1))
    grid.set_cells(0, 40, np.full((80, 1), 100, np.int8))
    step = fleet.step([(1.0, 0.0, 0.0)], 3.0)
    assert step.poses[0, 0] == pytest.approx(3.8, abs=1e-6)
    assert step.ranges is not None and step.ranges[0, 0] == pytest.approx(0.2, abs=1e-6)


def test_a_robot_that_is_pressed_against_a_wall_moves_on_when_the_wall_is_gone() -> None:
    grid = hall(8.0)
    fleet = mrs.Fleet(grid, [(6.0, 4.0, 0.0)], footprint=mrs.Shape.disc(0.5))
    ahead = [(1.0, 0.0, 0.0)]
    assert fleet.step(ahead, 3.0).contacts[0] and fleet.step(ahead, 1.0).contacts[0]
    state = fleet.save()
    assert fleet.step(ahead, 1.0).poses[0, 0] == pytest.approx(7.4, abs=1e-5)
    grid.set_cells(0, 79, np.zeros((80, 1), np.int8))
    assert fleet.step(ahead, 1.0).poses[0, 0] == pytest.approx(8.4, abs=1e-5)
    fleet.restore(state)
    step = fleet.step(ahead, 1.0)
    assert step.poses[0, 0] == pytest.approx(8.4, abs=1e-5) and not step.contacts[0]


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda fleet: fleet.step(np.zeros((2, 3)), 0.1), ValueError, "commands must have shape (60, 3), got (2, 3)"),
        (
            lambda fleet: fleet.step(np.where(np.arange(COUNT)[:, np.newaxis] == 7, np.nan, np.zeros((COUNT, 3))), 0.1),
            ValueError,
            "the command of robot 7 must be finite and at most 1000 on each axis, got [NaN, NaN, NaN]",
        ),
        (
            lambda fleet: fleet.step(np.full((COUNT, 3), 2000.0), 0.1),
            ValueError,
            "the command of robot 0 must be finite and at most 1000 on each axis, got [2000.0, 2000.0, 2000.0]",
        ),
        (
            lambda fleet: fleet.step(np.zeros((COUNT, 3)), 0.0),
            ValueError,
            "duration must be at least 1e-9 and at most 1e6, got 0",
        ),
        (lambda fleet: fleet.reset(np.ones(3, bool)), ValueError, "mask must have shape (60,), got (3,)"),
        (lambda fleet: fleet.reset(np.ones(COUNT)), TypeError, "mask must have dtype bool, got float64"),
        (lambda fleet: fleet.reset(seeds=np.full(COUNT, -1)), ValueError, "seeds must be at least 0, got -1 in row 0"),
        (lambda fleet: fleet.reset(grids=np.full(COUNT, 3)), ValueError, "grid of robot 0 must be below 3, got 3"),
        (
            lambda fleet: fleet.reset(poses=np.full((COUNT, 3), np.inf)),
            ValueError,
            "poses must be finite, got [inf, inf, inf] in row 0",
        ),
        (lambda fleet: fleet.restore(3), TypeError, "state must be a FleetState, got int"),
        (
            lambda fleet: fleet.restore(fleet.save(np.arange(COUNT) < 2), np.ones(COUNT, bool)),
            ValueError,
            "the state must have 60 elements, got 2",
        ),
        (
            lambda fleet: fleet.rollout(np.where(np.arange(12).reshape(3, 4, 1) == 6, np.nan, np.zeros((3, 4, 3))), 0.1),
            ValueError,
            "command 2 of rollout 1 must be finite and at most 1000 on each axis, got [NaN, NaN, NaN]",
        ),
        (lambda fleet: fleet.rollout(np.zeros((3, 3)), 0.1), ValueError, "commands must have shape (K, T, 3), got (3, 3)"),
        (lambda fleet: fleet.rollout(np.zeros((1, 3, 3)), 0.1, robot=60), ValueError, "the robot must be below 60, got 60"),
        (
            lambda fleet: fleet.relative(np.where(np.arange(COUNT)[:, np.newaxis] == 7, np.nan, np.zeros((COUNT, 2)))),
            ValueError,
            "goals must be finite, got NaN in row 7",
        ),
        (lambda fleet: fleet.relative(np.zeros((3, 2))), ValueError, "goals must have shape (60, 2), got (3, 2)"),
        (
            lambda fleet: mrs.FleetState(np.ones((1, 2), np.uint64)),
            ValueError,
            "the words must be those of a saved state, got too few words",
        ),
    ],
)
def test_wrong_calls_say_what_is_wrong_and_change_nothing(
    call: Callable[[mrs.Fleet], object], error: type[Exception], message: str
) -> None:
    fleet = fleet_after(1)
    before = fleet.save().words.tobytes()
    with pytest.raises(error) as caught:
        call(fleet)
    assert message in str(caught.value)
    assert fleet.save().words.tobytes() == before


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"seeds": np.zeros(0, np.int64)}, ValueError, "the number of robots must be at least 1, got 0"),
        ({}, ValueError, "a fleet needs poses or seeds, got neither"),
        ({"seeds": [1, 2]}, ValueError, "grid_of must be given for 2 robots on 3 maps, got None"),
        ({"seeds": [1], "grid_of": [3]}, ValueError, "grid of robot 0 must be below 3, got 3"),
        ({"seeds": [1, 2, 3], "limits": [mrs.Limits()] * 2}, ValueError, "limits must have 3 elements, got 2"),
        ({"seeds": [1, 2, 3], "limits": 3.0}, TypeError, "limits must be one Limits or a sequence of them, got 3.0"),
        ({"seeds": [1, 2, 3], "drive": 3.0}, TypeError, "drive must be one Drive or a sequence of them, got 3.0"),
        ({"seeds": [1, 2, 3], "drive": "omni"}, TypeError, "drive must be one Drive or a sequence of them, got 'omni'"),
        ({"seeds": [1, 2, 3], "drive": [CAR] * 2}, ValueError, "drive must have 3 elements, got 2"),
        (
            {"seeds": [1, 2, 3], "drive": [CAR, WIDE, mrs.Drive.differential(track=0.3, wheel_radius=0.1)]},
            ValueError,
            "the drives of a fleet must be of one kind, got another one for robot 2",
        ),
        ({"seeds": [1, 2, 3], "slip": True}, TypeError, "slip must have dtype float64, got bool"),
        ({"seeds": [1, 2, 3], "slip": [0.1, np.nan, 0.2]}, ValueError, "slip must be in 0..1, got NaN"),
        ({"seeds": [1, 2, 3], "slip": 2.0}, ValueError, "slip must be in 0..1, got 2"),
        ({"seeds": [1, 2, 3], "noise": mrs.BeamModel()}, ValueError, "noise needs a scanner, got scanner=None"),
        ({"seeds": [1, 2, 3], "clearance": 50.0}, ValueError, "no known free place for a disc of radius 50 m"),
        (
            {"seeds": [1, 2, 3], "world_of": [1, 1, 2]},
            ValueError,
            "robots that share a world must be on the same grid, got robots 0 and 1",
        ),
        ({"seeds": [1, 2, 3], "obstacles": 3}, TypeError, "obstacles must be (Shape, trajectory)"),
        (
            {"seeds": [1, 2, 3], "obstacles": [(mrs.Shape.disc(0.1), [(1, 0, 0, 0), (1, 0, 0, 0)])]},
            ValueError,
            "the times of waypoints must increase, got 1 after 1 in row 1",
        ),
        (
            {"seeds": [1, 2, 3], "obstacles": [(mrs.Shape.disc(0.1), (math.nan, 0, 0))]},
            ValueError,
            "the pose of an obstacle must be three finite numbers (x, y, yaw), got (nan, 0, 0)",
        ),
        (
            {"seeds": [1, 2, 3], "obstacles": [(mrs.Shape.disc(0.1), (1, 0, 0)), (mrs.Shape.disc(0.1), (1, 0, 0), 7)]},
            ValueError,
            "obstacle 1 must be in the world of a robot, got world 7, which has none",
        ),
        ({"seeds": [1, 2, 3], "clearance_limit": 0.0}, ValueError, "clearance_limit must be positive, got 0"),
        ({"seeds": [1, 2, 3], "contact": "bounce"}, ValueError, "contact must be 'stop', 'slide' or 'report', got 'bounce'"),
    ],
)
def test_wrong_fleets_say_what_is_wrong(arguments: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error) as caught:
        mrs.Fleet(MAPS, **arguments)
    assert message in str(caught.value)


def test_a_fleet_is_used_by_one_thread_at_a_time() -> None:
    fleet = mrs.Fleet(hall(8.0), np.full((200, 3), 4.0), footprint=mrs.Shape.disc(0.3))
    state, errors = fleet.save(), []
    runner = threading.Thread(target=lambda: fleet.step(np.full((200, 3), 1.0), 200.0, threads=1))
    runner.start()
    while runner.is_alive() and not errors:
        try:
            fleet.restore(state)
        except RuntimeError as error:
            errors.append(str(error))
    runner.join()
    assert errors == ["a fleet must be used by one thread at a time, got a call during another one"]
