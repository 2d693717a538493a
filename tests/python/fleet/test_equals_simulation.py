"""One robot of a fleet equals a robot of a `Simulation` that gets the same commands, byte by byte."""

from __future__ import annotations

import random
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import mobile_robot_simulator as mrs
from simulations import hall

BEAMS = 61
NOISE = {"sigma_hit": 0.03, "lambda_short": 0.2, "z_hit": 0.85, "z_short": 0.05, "z_max": 0.05, "z_rand": 0.05}
LIMITS = {
    "velocity_limits": [0.8, 0.3, 1.5],
    "acceleration_limits": [0.6, 0.5, 2.0],
    "deceleration_limits": [1.2, 0.9, 3.0],
}
DIFFERENTIAL = {"drive": "differential", "track": 0.4, "wheel_radius": 0.1, "wheel_speed_limit": 9.0}
OMNI = {"drive": "omni", "wheelbase": 0.4, "track": 0.3, "wheel_radius": 0.08, "wheel_speed_limit": 11.0}
ACKERMANN = {
    "drive": "ackermann",
    "wheelbase": 0.4,
    "track": 0.3,
    "wheel_radius": 0.1,
    "wheel_speed_limit": 9.0,
    "steering_limit": 0.7,
    "steering_rate": 0.9,
}
POLYGON = [[-0.3, -0.2], [0.35, -0.2], [0.45, 0.0], [0.35, 0.2], [-0.3, 0.2]]


def office() -> mrs.OccupancyGrid:
    """Returns a furnished office, so that a random drive meets walls often."""
    return mrs.floor_plan("office", seed=3)


def commands_of(seed: int, duration: float) -> NDArray[np.float64]:
    """Returns random commands (vx, vy, wz) for steps of a duration [s]: some are held, some are faster than limits allow."""
    dice, steps, hold = random.Random(seed), round(15.0 / duration), round(0.1 / duration)
    rows: list[tuple[float, float, float]] = []
    while len(rows) < steps:
        command = (dice.uniform(-0.5, 1.2), dice.choice([0.0, dice.uniform(-0.4, 0.4)]), dice.uniform(-2.0, 2.0))
        rows += [dice.choice([command, command, (0.0, 0.0, 0.0)])] * (hold * dice.randrange(1, 6))
    return np.array(rows[:steps])


def twist_of(command: list[float]) -> mrs.messages.Twist:
    """Returns the message of a command (vx, vy, wz)."""
    vx, vy, wz = command
    return mrs.messages.Twist(linear=mrs.messages.Vector3(x=vx, y=vy), angular=mrs.messages.Vector3(z=wz))


def drive_of(command: list[float]) -> mrs.messages.AckermannDriveStamped:
    """Returns the message of a command (speed, steering angle)."""
    speed, angle = command
    return mrs.messages.AckermannDriveStamped(drive=mrs.messages.AckermannDrive(speed=speed, steering_angle=angle))


def simulated(
    grid: mrs.OccupancyGrid,
    start: tuple[float, float, float],
    commands: NDArray[np.float64],
    duration: float,
    seed: int,
    parameters: dict[str, Any],
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float32], list[Any], list[Any]]:
    """Returns pose, velocity, odometry, scan and joints after each command, and the contacts, of a `Simulation`.

    A command of two numbers is a speed and a steering angle.
    """
    rate = 1.0 / duration
    rates = {"velocity_timeout": 0, "laser_frequency": rate, "publish_rate": rate}
    quiet = {**rates, "laser_beam_count": BEAMS, **parameters}
    sim = mrs.Simulation(grid, parameters=quiet, seed=seed, start=start)
    scans: list[Any] = []
    sim.subscribe("/scan", mrs.messages.LaserScan, scans.append)
    poses, velocities, odometry, joints = [], [], [], []
    for command in commands.tolist():
        if len(command) == 3:
            sim.publish("/cmd_vel", twist_of(command))
        else:
            sim.publish("/ackermann_cmd", drive_of(command))
        sim.run_for(duration)
        if parameters.get("drive", "planar") != "planar":
            motion, now_ns = sim.robot.motion, round(sim.time * 1e9)
            joints.append((*motion.joints(now_ns), motion.steering_at(now_ns)))
        poses.append(tuple(sim.robot.pose))
        velocities.append(sim.robot.velocity)
        odometry.append(tuple(sim.robot.believed_pose))
    assert len(scans) == len(commands)
    ranges = np.array([scan.ranges for scan in scans], np.float32)
    return np.array(poses), np.array(velocities), np.array(odometry), ranges, joints, list(sim.robot.motion.contacts)


CASES: dict[str, dict[str, Any]] = {
    "free": {},
    "limits": LIMITS,
    "disc": {"robot_radius": 0.3},
    "polygon": {"footprint": POLYGON},
    "disc, limits": {"robot_radius": 0.3, **LIMITS},
    "polygon, limits, slide": {"footprint": POLYGON, "contact": "slide", **LIMITS},
    "disc, slide": {"robot_radius": 0.3, "contact": "slide"},
    "polygon, report": {"footprint": POLYGON, "contact": "report"},
    "disc, limits, slip": {"robot_radius": 0.3, "wheel_slip": 0.25, **LIMITS},
    "drift": {"robot_radius": 0.3, "odometry_alphas": [0.02, 0.01, 0.01, 0.02, 0.001, 0.001], **LIMITS},
    "drift and slip": {"odometry_alphas": [0.02, 0.01, 0.01, 0.02, 0.001, 0.001], "wheel_slip": 0.3},
    "slip": {"wheel_slip": 0.5},
    "no grip": {"robot_radius": 0.3, "wheel_slip": 1.0},
    "differential": DIFFERENTIAL,
    "differential, polygon, limits": {"footprint": POLYGON, **DIFFERENTIAL, **LIMITS},
    "differential, disc, drift": {"robot_radius": 0.3, "odometry_alphas": [0.02, 0.01, 0.01, 0.02, 0, 0], **DIFFERENTIAL},
    "omni, slip": {"wheel_slip": 0.3, **OMNI},
    "omni, disc, limits, slide": {"robot_radius": 0.3, "contact": "slide", **OMNI, **LIMITS},
    "ackermann": ACKERMANN,
    "ackermann, limits, slip": {"wheel_slip": 0.2, **ACKERMANN, **LIMITS},
    "ackermann, polygon": {"footprint": POLYGON, **ACKERMANN},
    "ackermann, polygon, limits": {"footprint": POLYGON, **ACKERMANN, **LIMITS},
    "ackermann, disc, limits, slide": {"robot_radius": 0.3, "contact": "slide", **ACKERMANN, **LIMITS},
    "ackermann, polygon, report, slip": {"footprint": POLYGON, "contact": "report", "wheel_slip": 0.25, **ACKERMANN},
}


def fleet_like(
    grid: mrs.OccupancyGrid, start: tuple[float, float, float], seed: int, parameters: dict[str, Any]
) -> mrs.Fleet:
    """Returns a fleet of one robot that is what the parameters of a `Simulation` say."""
    parsed = mrs.parameters.RobotParameters(**parameters)
    return mrs.Fleet(
        grid,
        [start],
        seeds=[seed],
        footprint=parsed.shape,
        contact=parsed.contact,
        limits=parsed.limits,
        drive=parsed.wheels,
        slip=parsed.wheel_slip,
        scanner=mrs.LaserScanner(beam_count=BEAMS),
        noise=mrs.BeamModel(**NOISE),
        odometry_noise=parsed.motion_noise,
    )


TWISTS = [(case, False) for case in CASES]
STEERED = [(case, True) for case in CASES if case.startswith("ackermann")]


@pytest.mark.parametrize("duration", [0.1, 0.033])
@pytest.mark.parametrize(("case", "is_steered"), TWISTS + STEERED)
def test_one_robot_equals_a_simulation(case: str, duration: float, is_steered: bool) -> None:
    grid, parameters, touched = office(), CASES[case], 0
    for seed, start in enumerate(grid.draw_free_poses(4, radius=0.5, seed=5).tolist()):
        commands = commands_of(seed, duration)
        if is_steered:  # It often steers without a change of speed.
            commands = np.stack([0.5 * np.sign(commands[:, 0]), commands[:, 2]], axis=1)
        expected = simulated(grid, tuple(start), commands, duration, seed, {**parameters, **NOISE})
        poses, velocities, odometry, scans, joints, contacts = expected
        fleet, was_touching, begun = fleet_like(grid, tuple(start), seed, parameters), False, []
        for index, command in enumerate(commands):
            step = fleet.step(command[np.newaxis], duration)
            where = f"{case}, drive {seed}, step {index}"
            assert step.poses.tobytes() == poses[index].tobytes(), where
            assert step.velocities.tobytes() == velocities[index].tobytes(), where
            assert step.odometry.tobytes() == odometry[index].tobytes(), where
            if joints:
                positions, rates = fleet.joints()
                found = positions.tobytes(), rates.tobytes(), float(fleet.steering[0])
                expected_positions, expected_rates, angle = joints[index]
                assert found == (expected_positions.tobytes(), expected_rates.tobytes(), angle), where
            assert fleet.scanner is not None and step.ranges is not None
            assert fleet.scanner.mark_invalid(step.ranges[0]).tobytes() == scans[index].tobytes(), where
            if step.contacts[0] and not was_touching:
                begun.append(tuple(step.contact_points[0].tolist()))
            was_touching = bool(step.contacts[0])
        assert set(begun) <= {event.point for event in contacts}
        touched += len(begun)
    can_touch = ("robot_radius" in parameters or "footprint" in parameters) and parameters.get("wheel_slip") != 1.0
    assert touched > 1 if can_touch else touched == 0


STARTS = {"a": (2.0, 2.0, 0.5), "b": (3.5, 2.5, 2.0), "c": (3.0, 4.0, -1.0)}
PILLAR = (mrs.Shape.disc(0.4), (4.5, 4.5, 0.0))
CART = (mrs.Shape.rectangle(0.8, 0.5), [(0.5, 1.0, 5.0, 0.0), (4.0, 4.5, 1.5, 1.0), (9.0, 2.0, 3.0, 7.0)])


@pytest.mark.parametrize("duration", [0.1, 0.033])
@pytest.mark.parametrize(
    "case",
    [
        "disc",
        "polygon, limits, slide",
        "polygon, report",
        "disc, limits, slip",
        "differential, polygon, limits",
        "omni, disc, limits, slide",
        "ackermann, polygon",
    ],
)
def test_robots_of_one_world_equal_those_of_a_simulation(case: str, duration: float) -> None:
    grid, parameters = hall(6.0), CASES[case]
    rates = {"velocity_timeout": 0, "laser_frequency": 1.0 / duration, "laser_beam_count": BEAMS}
    sim = mrs.Simulation(grid, parameters={**rates, **parameters, **NOISE}, seed=4, robots=STARTS)
    for shape, trajectory in (PILLAR, CART):
        sim.add_obstacle(shape, trajectory)
    scans: dict[str, list[Any]] = {name: [] for name in STARTS}
    for name in STARTS:
        sim.subscribe(f"/{name}/scan", mrs.messages.LaserScan, scans[name].append)
    parsed = mrs.parameters.RobotParameters(**parameters)
    fleet = mrs.Fleet(
        grid,
        list(STARTS.values()),
        seeds=np.array([sim.robots[name].laser.parameters.seed for name in STARTS], np.uint64),
        footprint=parsed.shape,
        contact=parsed.contact,
        limits=parsed.limits,
        drive=parsed.wheels,
        slip=parsed.wheel_slip,
        scanner=mrs.LaserScanner(beam_count=BEAMS),
        noise=mrs.BeamModel(**NOISE),
        world_of=[5, 5, 5],
        obstacles=[PILLAR, CART],
    )
    commands = [commands_of(robot, duration) for robot in range(3)]
    met: set[str] = set()
    for index in range(len(commands[0])):
        for robot, name in enumerate(STARTS):
            sim.publish(f"/{name}/cmd_vel", twist_of(commands[robot][index].tolist()))
        sim.run_for(duration)
        step = fleet.step([rows[index] for rows in commands], duration)
        for robot, name in enumerate(STARTS):
            where = f"{case}, robot {name}, step {index}"
            assert step.poses[robot].tobytes() == np.array(tuple(sim.robots[name].pose)).tobytes(), where
            assert step.velocities[robot].tobytes() == np.array(sim.robots[name].robot.velocity).tobytes(), where
            assert fleet.scanner is not None and step.ranges is not None
            ranges = fleet.scanner.mark_invalid(step.ranges[robot])
            assert ranges.tobytes() == np.array(scans[name][index].ranges, np.float32).tobytes(), where
            if step.contacts[robot]:
                what = step.contact_obstacles[robot], step.contact_robots[robot]
                met.add("robot" if what[1] >= 0 else "obstacle" if what[0] >= 0 else "wall")
    # Robots on slow wheels do not come as far as the others.
    assert len(met) >= (1 if "drive" in parameters else 2), met
