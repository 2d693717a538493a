"""world: robots see and touch each other, and a restored simulation repeats exactly."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator._core import stays_clear
from mobile_robot_simulator.physics import constrained_motion, world
from mobile_robot_simulator.physics.constrained_motion import ConstrainedMotion
from mobile_robot_simulator.physics.crowd import Crowd
from simulations import drive, hall, pair, simulation


def test_robots_see_and_touch_each_other():
    sim = pair(robot_radius=0.25)
    sim.run_for(0.1)
    assert sim.latest("/robot1/scan").ranges[30] == pytest.approx(3.75, abs=1e-6)
    assert sim.latest("/robot2/scan").ranges[30] == pytest.approx(3.75, abs=1e-6)
    for name in sim.robots:
        drive(sim, 1.0, topic=f"/{name}/cmd_vel")
    sim.run_for(5.0)
    gap = sim.robots["robot2"].pose.x - sim.robots["robot1"].pose.x
    assert 0.5 <= gap < 0.5 + 0.02
    assert sim.robots["robot1"].truth.contacts[0].what == "robot robot2"
    assert sim.robots["robot1"].truth.clearance == pytest.approx(gap - 0.5, abs=1e-6)


def test_everything_repeats_after_a_restore():
    sim = pair(robot_radius=0.25, contact="slide", odometry_alphas=(0.1, 0.01, 0.01, 0.1, 0.01, 0.01))
    sim.add_obstacle(mrs.Shape.disc(0.3), [(0, 7, 13, 0), (5, 7, 8, 0)])
    for name in sim.robots:
        drive(sim, 0.8, 0.1, topic=f"/{name}/cmd_vel")
    sim.run_for(1.237)
    state, ends = sim.save(), []
    for _ in range(2):
        sim.run_for(6.0)
        messages = [sim.latest(f"/{name}/{topic}") for name in sim.robots for topic in ("odom", "scan")]
        contacts = [robot.truth.contacts for robot in sim.robots.values()]
        ends.append((messages, contacts, [tuple(robot.pose) for robot in sim.robots.values()]))
        sim.add_obstacle(mrs.Shape.disc(0.1), (15, 15, 0))
        sim.restore(state)
    assert ends[0] == ends[1] and ends[0][1][0]


def test_a_map_can_be_replaced_and_is_restored():
    sim = pair(robot_radius=0.25)
    world, before = sim._world, sim._world.grid
    state = sim.save()
    wall = np.zeros((20, 20), np.int8)
    wall[:, 7] = 100
    world.use_map(mrs.OccupancyGrid(wall, resolution=1.0))
    drive(sim, 1.0, topic="/robot1/cmd_vel")
    sim.run_for(5.0)
    assert sim.robots["robot1"].pose.x == pytest.approx(7.0 - 0.25, abs=1e-6)
    sim.restore(state)
    assert world.grid is before


def test_a_wall_is_not_taken_for_an_obstacle():
    sim = pair(robot_radius=0.25)
    wall = np.zeros((20, 20), np.int8)
    wall[:, 7] = 100
    sim._world.use_map(mrs.OccupancyGrid(wall, resolution=1.0))
    sim.add_obstacle(mrs.Shape.disc(0.3), (12, 12, 0), name="pillar")
    shape = mrs.Shape.disc(0.25)
    sim._world.check_place("start", mrs.Pose(2.0, 2.0, 0.0), shape)
    with pytest.raises(ValueError, match="start must leave the robot room beside walls"):
        sim._world.check_place("start", mrs.Pose(8.1, 2.0, 0.0), shape)
    with pytest.raises(ValueError, match="start must leave the robot room beside obstacle pillar"):
        sim._world.check_place("start", mrs.Pose(12.2, 12.0, 0.0), shape)


def test_adding_an_obstacle_reads_no_other_trajectory():
    sim, reads = pair(robot_radius=0.25), []

    def trajectory(time):
        reads.append(time)
        return 15.0, 15.0, 0.0

    for _ in range(50):
        sim.add_obstacle(mrs.Shape.disc(0.1), trajectory)
    assert len(reads) == 50
    drive(sim, 1.0, topic="/robot1/cmd_vel")
    sim.run_for(20.0)
    assert sim.robots["robot1"].truth.contacts[0].what == "robot robot2"


def test_an_obstacle_whose_trajectory_fails_is_not_added():
    sim = pair(robot_radius=0.25)
    with pytest.raises(TypeError, match="must return poses"):
        sim.add_obstacle(mrs.Shape.disc(0.1), lambda time: "here")
    sim.add_obstacle(mrs.Shape.disc(0.1), (15, 15, 0))
    sim.run_for(1.0)
    assert len(sim._world.obstacles) == 1


def test_robots_that_get_a_footprint_one_after_another_touch_each_other():
    sim = pair()
    for name, each in sim.robots.items():
        each.robot.set_parameters(robot_radius=0.25)
        drive(sim, 1.0, topic=f"/{name}/cmd_vel")
        sim.run_for(0.5)
    sim.run_for(5.0)
    first, second = sim.robots.values()
    assert second.pose.x - first.pose.x == pytest.approx(0.5, abs=0.02)
    assert first.pose.x == pytest.approx(7.0, abs=0.3) and second.truth.contacts


def test_clearances_of_the_past_take_each_obstacle_where_it_was():
    """A standing obstacle at 3 m, then a second one that is moved: each clearance equals that of its own surroundings."""
    sim = mrs.Simulation(hall(), parameters={"robot_radius": 0.2, "velocity_timeout": 0}, start=(5.0, 5.0, 0.0))
    sim.add_obstacle(mrs.Shape.disc(0.5), (8.7, 5.0, 0.0))
    drive(sim, 0.5)
    sim.run_for(2.0)
    assert sim.truth.clearances(sim.truth.path)[[0, -1]] == pytest.approx([3.0, 2.0])
    assert sim.robot.motion.is_stepped and not sim.truth.contacts
    sim.add_obstacle(mrs.Shape.disc(0.5), (6.0, 6.7, 0.0), name="second")
    assert sim.truth.clearances(sim.truth.path)[-1] == pytest.approx(1.0)
    sim.move_obstacle("second", (9.0, 9.0, 0.0))
    sim.run_for(1.0)
    path = sim.truth.path
    found = sim.truth.clearances(path)
    assert found[path[:, 0] == 2.0][-1] == pytest.approx(2.0)
    assert found[path[:, 0] < 2.0][-1] == pytest.approx(np.hypot(*(path[path[:, 0] < 2.0][-1][1:3] - [6.0, 6.7])) - 0.7)
    assert found[-1] == pytest.approx(1.5)
    sim.move_obstacle("second", (7.5, 5.0, 0.0))
    sim.run_for(2.0)
    assert [contact.what for contact in sim.truth.contacts] == ["obstacle second"]


def _wandered(contact: str, seed: int, limits: bool) -> tuple[list[object], int]:
    """Returns what a robot measures that drives by random commands among obstacles, and its number of contacts."""
    rng = np.random.default_rng(seed)
    more = {"acceleration_limits": [1.5, 1.0, 2.0]} if limits else {}
    sim = simulation(
        (6.0, 6.0, 0.4),
        robot_radius=0.3,
        contact=contact,
        publish_rate=float(rng.choice([7.0, 10.0, 50.0])),
        velocity_timeout=0.31,
        **more,
    )
    for _ in range(12):
        sim.add_obstacle(mrs.Shape.rectangle(*rng.uniform(0.1, 0.9, 2)), (*rng.uniform(7.0, 12.0, 2), rng.uniform(-3, 3)))
    seen: list[object] = []
    for step in range(80):
        drive(sim, rng.uniform(0.0, 2.0), rng.uniform(-0.5, 0.9), vy=rng.uniform(-0.3, 0.3))
        sim.run_for(float(rng.uniform(0.01, 0.7)))
        seen += [tuple(sim.pose), sim.truth.velocity, sim.truth.distance, sim.latest("/odom"), sim.latest("/scan")]
        if step == 40:
            state = sim.save()
            sim.run_for(1.0)
            sim.restore(state)
            sim.robot.slip(0.3)
    return [*seen, list(sim.truth.contacts)], len(sim.truth.contacts)


@pytest.mark.parametrize("contact", ["stop", "slide", "report"])
@pytest.mark.parametrize("limits", [False, True])
def test_steps_without_a_look_for_contact_change_no_bit(contact, limits, monkeypatch):
    """The oracle looks for contact in each time step."""
    looks = {True: 0, False: 0}
    skip = ConstrainedMotion.skip

    def counted(motion: ConstrainedMotion, time_ns: int) -> bool:
        skipped = skip(motion, time_ns)
        looks[skipped] += 1
        return skipped

    for seed in (1, 2):
        monkeypatch.setattr(ConstrainedMotion, "skip", counted)
        found, contacts = _wandered(contact, seed, limits)
        monkeypatch.setattr(ConstrainedMotion, "skip", lambda motion, time_ns: False)
        assert (found, contacts) == _wandered(contact, seed, limits) and contacts > 0
    assert looks[True] > 100 and looks[False] > 100


def _slowly(seed: int) -> tuple[list[object], int]:
    """Returns where a robot is that drives in circles while one thing after another appears near it, and its contacts."""
    rng = np.random.default_rng(seed)
    sim = simulation((6.0, 6.0, 0.4), robot_radius=0.2, contact="slide", velocity_timeout=0.0)
    seen: list[object] = []
    ball = None
    for step in range(160):
        drive(sim, 0.2 if step % 40 < 30 else 1.5, 0.8)
        sim.run_for(0.1 if seed else 0.03)
        seen.append((tuple(sim.pose), len(sim.truth.contacts)))
        x, y, yaw = sim.pose
        ahead = (x + 0.24 * np.cos(yaw), y + 0.24 * np.sin(yaw), 0.0)
        change = rng.integers(0, 60)
        if change == 0:
            ball = sim.add_obstacle(mrs.Shape.disc(0.02), ahead)
        elif change == 1 and ball is not None:
            sim.move_obstacle(ball, ahead)
        elif change == 2:
            with suppress(ValueError):  # The new cells may be there.
                sim.set_pose((0.35, 8.0, 3.0))
        elif change in (3, 6):
            # The owner of the map may also change it without a word to the simulation.
            owner = sim if change == 3 else sim.grid
            owner.set_cells(*(round(ahead[axis] / sim.grid.resolution) for axis in (1, 0)), np.array([[100]], np.int8))
        elif change == 4:
            sim.restore(sim.save())
        elif change == 5:
            sim.robot.set_parameters(robot_radius=float(rng.uniform(0.15, 0.22)))
    return seen, len(sim.truth.contacts)


@pytest.mark.parametrize("seed", range(6))
def test_a_look_for_contact_holds_until_something_changes(seed, monkeypatch):
    """The oracle looks in each time step. Looks count as one for a second in which nothing changes."""
    skip, looks, skips = ConstrainedMotion.skip, [], []
    monkeypatch.setattr(
        constrained_motion, "stays_clear", lambda *args, **more: looks.append(1) or stays_clear(*args, **more)
    )
    monkeypatch.setattr(ConstrainedMotion, "skip", lambda motion, time_ns: skips.append(1) or skip(motion, time_ns))
    found = _slowly(seed)
    monkeypatch.setattr(ConstrainedMotion, "skip", lambda motion, time_ns: False)
    assert found == _slowly(seed) and found[1] > 0
    assert len(looks) < 0.9 * len(skips)


def test_a_faster_command_needs_another_look():
    """The robot creeps, then crosses a gap of 0.5 m at 2 m/s."""
    sim = simulation((6.0, 6.0, 0.0), robot_radius=0.2, velocity_timeout=0.0)
    sim.add_obstacle(mrs.Shape.disc(0.1), (6.8, 6.0, 0.0))
    drive(sim, 0.05)
    sim.run_for(0.2)
    drive(sim, 2.0)
    sim.run_for(0.4)
    (contact,) = sim.truth.contacts
    assert contact.time == pytest.approx(0.2 + 0.49 / 2.0, abs=1e-6)


def test_a_leap_between_two_time_steps_needs_another_look():
    """The robot creeps, leaps 0.48 m of a gap of 0.5 m within a time step, and creeps on until it touches."""
    sim = simulation((6.0, 6.0, 0.0), robot_radius=0.2, velocity_timeout=0.0)
    sim.add_obstacle(mrs.Shape.disc(0.1), (6.8, 6.0, 0.0))
    for speed, duration in ((0.05, 0.102), (30.0, 0.016), (0.05, 0.001), (0.04, 0.8)):
        drive(sim, speed)
        sim.run_for(duration)
    (contact,) = sim.truth.contacts
    assert contact.time == pytest.approx(0.119 + (0.5 - 0.0051 - 0.48 - 0.00005) / 0.04, abs=1e-4)


def test_a_second_in_the_open_takes_one_look(monkeypatch):
    looks = []
    monkeypatch.setattr(
        constrained_motion, "stays_clear", lambda *args, **more: looks.append(1) or stays_clear(*args, **more)
    )
    sim = simulation((6.0, 6.0, 0.0), robot_radius=0.2, velocity_timeout=0.0)
    drive(sim, 0.2, 1.0)
    sim.run_for(0.1)
    looks.clear()
    for _ in range(100):
        drive(sim, 0.2, 1.0)
        sim.run_for(0.1)
    assert 10 <= len(looks) <= 12


class PlainCrowd(Crowd[Any]):
    """A crowd that tells the core about every thing each time: the plain way."""

    def around(self, thing: Any) -> Any:
        # Something far away keeps the indices of the others.
        far = mrs.Pose(1e5, 1e5, 0.0)
        return [(placed[0], far) if other is thing else placed for other, placed in self.things]


@pytest.mark.parametrize("contact", ["stop", "slide", "report"])
def test_many_robots_do_what_they_do_if_the_core_is_told_everything_each_time(
    monkeypatch: pytest.MonkeyPatch, contact: str
) -> None:
    grid = mrs.OccupancyGrid(cells=np.pad(np.zeros((160, 160), np.int8), 2, constant_values=100), resolution=0.05)
    rng = np.random.default_rng(3)
    places = [(0.6 + index % 8, 0.8 + 0.8 * (index // 8), 6.28 * rng.random()) for index in range(72)]
    robots = {f"r{index}": place for index, place in enumerate(places)}
    commands = {name: (rng.uniform(0.2, 0.8), rng.uniform(-0.5, 0.5)) for name in robots}

    def ends() -> tuple[list[object], int]:
        parameters = {"robot_radius": 0.15, "velocity_timeout": 0.0, "laser_beam_count": 61, "contact": contact}
        sim = mrs.Simulation(grid, parameters=parameters, robots=robots, seed=1)
        sim.add_obstacle(mrs.Shape.rectangle(0.3, 0.2), [(0.0, 0.4, 0.4, 0.0), (3.0, 7.6, 7.6, 3.0)])
        sim.add_obstacle(mrs.Shape.disc(0.1), (1.1, 1.2, 0.0))
        for name, (speed, turn) in commands.items():
            drive(sim, speed, turn, topic=f"/{name}/cmd_vel")
        sim.run_for(1.507)
        sim.move_obstacle(sim.obstacles[1], (2.5, 2.0, 0.0), velocity=(0.3, 0.0, 0.0))
        state = sim.save()
        sim.run_for(0.7)
        sim.restore(state)
        sim.run_for(0.8)
        found = [(tuple(robot.pose), robot.truth.contacts, robot.truth.clearance) for robot in sim.robots.values()]
        scans = [sim.latest(f"/{name}/scan").ranges.tobytes() for name in robots]
        return [*found, *scans], sum(len(contacts) for _, contacts, _ in found)

    fast, contacts = ends()
    monkeypatch.setattr(world, "Crowd", PlainCrowd)
    monkeypatch.setattr(world.World, "_find_free", lambda *_: None)
    assert ends() == (fast, contacts)
    assert contacts > 50


@pytest.mark.parametrize("seed", range(4))
def test_robots_for_which_nobody_looks_do_what_they_do_if_somebody_does(monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    """Thirty robots that now and then speed up, are pushed or moved, or get a new obstacle or a wall in their way."""
    seen: list[int] = []

    def ends() -> tuple[list[object], int]:
        rng = np.random.default_rng(seed)
        cells = np.pad(np.zeros((236, 236), np.int8), 2, constant_values=100)
        grid = mrs.OccupancyGrid(cells=cells, resolution=0.05)
        places = [(1.0 + 2.0 * (index % 6), 1.0 + 2.2 * (index // 6), 6.28 * rng.random()) for index in range(30)]
        robots = {f"r{index}": place for index, place in enumerate(places)}
        parameters = {"robot_radius": 0.15, "velocity_timeout": 0.7, "laser_beam_count": 31, "publish_rate": 30.0}
        if seed % 2:
            parameters["acceleration_limits"] = (0.5, 0.5, 1.0)
        sim = mrs.Simulation(grid, parameters=parameters, robots=robots, seed=1)
        for turn in range(60):
            name = f"r{rng.integers(30)}"
            for other in rng.choice(list(robots), 8):
                speed = rng.uniform(0.0, 0.2) if turn % 7 else rng.uniform(0.4, 0.9)
                drive(sim, speed, rng.uniform(-1.0, 1.0), topic=f"/{other}/cmd_vel")
            x, y = rng.uniform(1.0, 11.0, 2)
            with suppress(ValueError):
                if turn % 10 == 3:
                    sim.add_obstacle(mrs.Shape.disc(0.1), (x, y, 0.0))
                elif turn % 10 == 5:
                    sim.robots[name].robot.push((rng.uniform(-1.0, 1.0), 0.5) if turn % 20 == 15 else None)
                elif turn % 10 == 7:
                    sim.set_pose((x, y, 1.0), robot=name)
                elif turn % 20 == 9:
                    sim.set_cells(int(20 * y), int(20 * x), np.full((6, 6), 100, np.int8))
            sim.run_for(rng.uniform(0.01, 0.2))
            seen.append(len(sim._world._free))
        found = [(tuple(robot.pose), robot.truth.contacts, robot.truth.distance) for robot in sim.robots.values()]
        scans = [sim.latest(f"/{name}/scan").ranges.tobytes() for name in robots]
        return [*found, *scans], sum(len(contacts) for _, contacts, _ in found)

    fast, contacts = ends()
    assert max(seen) > 10 and min(seen) == 0 and sum(seen) > 100
    monkeypatch.setattr(world.World, "_find_free", lambda *_: None)
    assert ends() == (fast, contacts)
    assert contacts > 0


@pytest.mark.parametrize("wait", [0.02, 0.05, 0.13, 0.19])
def test_a_robot_that_speeds_up_meets_another_where_it_is_now(monkeypatch: pytest.MonkeyPatch, wait: float) -> None:
    grid = mrs.OccupancyGrid(cells=np.zeros((100, 200), np.int8), resolution=0.1)

    def end() -> tuple[object, ...]:
        robots = {"fast": (3.9, 5.0, 0.0), "slow": (5.0, 5.0, 0.0)}
        sim = mrs.Simulation(grid, parameters={"robot_radius": 0.2, "velocity_timeout": 0.0}, robots=robots)
        drive(sim, 0.5, topic="/slow/cmd_vel")
        sim.run_for(0.3)
        for name in robots:
            sim.robots[name].robot.set_pose(mrs.Pose(*robots[name]))
        sim.run_for(wait)
        sim._world.now_ns()
        free.append(len(sim._world._free))
        drive(sim, 60.0, topic="/fast/cmd_vel")
        sim.run_for(0.5)
        return sim.robots["fast"].truth.contacts[0], *(tuple(robot.pose) for robot in sim.robots.values())

    free: list[int] = []
    fast = end()
    assert free[0] == 2
    monkeypatch.setattr(world.World, "_find_free", lambda *_: None)
    assert end() == fast


@pytest.mark.parametrize("step", [0.0, 0.02, 0.1, 0.033])
def test_robots_that_come_one_by_one_do_what_they_do_if_everything_is_looked_at_again(
    monkeypatch: pytest.MonkeyPatch, step: float
) -> None:
    grid = mrs.OccupancyGrid(cells=np.pad(np.zeros((80, 80), np.int8), 2, constant_values=100), resolution=0.05)

    def ends() -> tuple[list[object], int]:
        rng, refused = np.random.default_rng(5), 0
        sim = mrs.Simulation(grid, parameters={"velocity_timeout": 0.0, "laser_beam_count": 31}, robots={}, seed=1)
        sim.add_obstacle(mrs.Shape.disc(0.1), [(0.0, 0.4, 0.4, 0.0), (3.0, 3.6, 3.6, 3.0)])
        for index in range(30):
            radius = {} if index % 10 == 3 else {"robot_radius": 0.15}
            try:
                sim.add_robot(f"r{index}", start=(*rng.uniform(0.0, 4.0, 2), index), parameters=radius)
            except ValueError:
                refused += 1
            for name in sim.robots:
                drive(sim, rng.uniform(0.2, 0.8), rng.uniform(-0.5, 0.5), topic=f"/{name}/cmd_vel")
            sim.run_for(step)
        sim.run_for(1.0)
        found = [(tuple(robot.pose), robot.truth.contacts, robot.truth.clearance) for robot in sim.robots.values()]
        assert sum(len(contacts) for _, contacts, _ in found) > 5
        return [*found, *(sim.latest(f"/{name}/scan").ranges.tobytes() for name in sim.robots)], refused

    def join(self: world.World, body: Any) -> None:
        self.now_ns()
        self._bodies.append(body)
        self.changed()

    found, refused = ends()
    assert refused > 5
    monkeypatch.setattr(world.World, "join", join)
    assert ends() == (found, refused)
