"""World: walls, obstacles and other robots push back, and scanners see what moves."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import faults
from mobile_robot_simulator.physics.obstacles import Obstacle

SEED = 11


def hall(size: float = 20.0) -> mrs.OccupancyGrid:
    """A hall whose walls' inner faces are at 0.1 and size - 0.1."""
    cells = np.zeros((round(size * 10),) * 2, np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    return mrs.OccupancyGrid(cells, resolution=0.1)


def simulation(start=(2.0, 2.0, 0.0), **parameters) -> mrs.Simulation:
    quiet = {"apply_noise": False, "velocity_timeout": 0, "laser_beam_count": 61, "laser_fov": 2 * math.pi}
    return mrs.Simulation(hall(), parameters={**quiet, **parameters}, seed=SEED, start=start)


def drive(sim: mrs.Simulation, vx: float, wz: float = 0.0, vy: float = 0.0, topic: str = "/cmd_vel") -> None:
    sim.publish(topic, mrs.messages.Twist(linear=mrs.messages.Vector3(x=vx, y=vy), angular=mrs.messages.Vector3(z=wz)))


# --- contact ---


def test_a_robot_stops_at_the_wall_and_says_where_and_when():
    sim = simulation(robot_radius=0.3)
    drive(sim, -1.0)
    sim.run_for(5.0)
    assert sim.pose.x == pytest.approx(0.4, abs=2e-6) and sim.pose.x >= 0.4
    assert sim.truth.velocity == (0.0, 0.0, 0.0)
    (contact,) = sim.truth.contacts
    assert contact.time == pytest.approx(1.6, abs=2e-6) and contact.what == "a wall" and contact.speed == 1.0
    assert contact.point == pytest.approx((0.1, 2.0), abs=2e-6)
    assert tuple(contact.pose) == pytest.approx((0.4, 2.0, 0.0), abs=2e-6)
    assert sim.truth.distance == pytest.approx(1.6, abs=1e-5)
    assert sim.truth.clearance == pytest.approx(0.0, abs=2e-6)
    drive(sim, 1.0)
    sim.run_for(1.0)
    assert sim.pose.x == pytest.approx(1.4, abs=1e-4)


def test_a_robot_slides_along_the_wall_and_goes_through_it_when_contact_is_only_reported():
    for contact, end in (("slide", (0.4, 3.0)), ("report", (-1.0, 3.0))):
        sim = simulation(robot_radius=0.3, contact=contact)
        drive(sim, -1.0, vy=1 / 3)
        sim.run_for(3.0)
        assert (sim.pose.x, sim.pose.y) == pytest.approx(end, abs=1e-5)
        assert [contact.what for contact in sim.truth.contacts] == ["a wall"]


def test_contact_in_steps_agrees_with_a_slow_exact_reference():
    """Along an arc, in steps of 10 microseconds, the first pose at which the footprint touches."""
    shape = [[0.5, 0.2], [-0.3, 0.2], [-0.3, -0.2], [0.5, -0.2]]
    rng = np.random.default_rng(SEED)
    outline = mrs.Shape.polygon(shape)
    for _ in range(5):
        start = (*rng.uniform(1.5, 18.5, 2), rng.uniform(-3, 3))
        twist = (rng.uniform(0.5, 2.0), 0.0, rng.uniform(-0.05, 0.05))
        sim = simulation(start=start, footprint=str(shape))
        drive(sim, twist[0], twist[2])
        sim.run_until(lambda sim: sim.truth.contacts, 60.0)
        found = sim.truth.contacts[0].time
        before, after = (mrs.Pose(*start).integrate(twist, found + offset) for offset in (-1e-5, 1e-5))
        assert not mrs.touches(sim.grid, outline, before) and mrs.touches(sim.grid, outline, after)


def test_without_contact_a_footprint_changes_nothing_to_the_last_bit():
    plain, round_ = simulation(), simulation(robot_radius=0.3)
    for sim in (plain, round_):
        for index in range(20):
            drive(sim, 0.3 + 0.1 * (index % 3), 0.4 * (-1) ** (index // 2))
            sim.run_for(0.333)
    assert tuple(plain.pose) == tuple(round_.pose) and plain.latest("/scan") == round_.latest("/scan")
    assert plain.latest("/odom") == round_.latest("/odom") and plain.truth.distance == round_.truth.distance


def test_a_command_that_runs_out_ends_at_the_same_time_with_and_without_a_footprint():
    plain, round_ = simulation(velocity_timeout=0.333), simulation(velocity_timeout=0.333, robot_radius=0.3)
    for sim in (plain, round_):
        drive(sim, 1.0, 0.3)
        sim.run_for(1.0)
    assert tuple(plain.pose) == tuple(round_.pose)


def test_asking_between_steps_changes_nothing():
    def run(ask: bool) -> mrs.Simulation:
        sim = simulation(robot_radius=0.3, contact="slide")
        sim.add_obstacle(mrs.Shape.disc(0.5), [(0, 8, 2.2, 0), (4, 3, 2.2, 0)])
        drive(sim, 1.0, 0.05)
        for _ in range(300):
            sim.run_for(0.0171)
            if ask:
                sim.pose, sim.truth.velocity, sim.truth.clearance, sim.truth.distance  # noqa: B018
        return sim

    asked, left = run(True), run(False)
    assert tuple(asked.pose) == tuple(left.pose) and asked.truth.contacts == left.truth.contacts != []


def test_limits_hold_back_velocity_and_its_growth():
    sim = simulation(velocity_limits=(0.5, 0.0, 1.0), acceleration_limits=(1.0, 1.0, 1.0))
    drive(sim, 2.0)
    sim.run_for(0.2)
    assert sim.truth.velocity[0] == pytest.approx(0.2)
    sim.run_for(0.8)
    assert sim.truth.velocity == (0.5, 0.0, 0.0)
    drive(sim, 0.0)
    sim.run_for(0.3)
    assert sim.truth.velocity[0] == pytest.approx(0.2)
    assert sim.latest("/odom").twist.twist.linear.x == pytest.approx(sim.truth.velocity[0])


# --- obstacles ---


def ranges(sim: mrs.Simulation) -> np.ndarray:
    return np.asarray(sim.latest("/scan").ranges, np.float64)


def test_a_disc_that_moves_is_seen_where_it_is_by_the_closed_form():
    sim = simulation(start=(10.0, 10.0, 0.3))
    sim.add_obstacle(mrs.Shape.disc(0.7), lambda time: (10.0 + 3.0 * math.cos(time), 10.0 + 3.0 * math.sin(time), 0.0))
    angles = np.linspace(-math.pi, math.pi, 61, endpoint=False) + 0.3
    for _ in range(20):
        sim.run_for(0.1)
        center = 3.0 * np.exp(1j * sim.time) * np.exp(-1j * angles)
        hits = np.abs(center.imag) < 0.7 - 1e-9
        hits &= center.real > 0
        expected = center.real[hits] - np.sqrt(0.49 - center.imag[hits] ** 2)
        assert hits.sum() >= 3 and ranges(sim)[hits] == pytest.approx(expected, abs=1e-6)
        assert ranges(sim)[~hits].min() > 3.0


def test_a_polygon_that_moves_is_seen_by_the_closed_form():
    sim = simulation(start=(10.0, 10.0, 0.0))
    sim.add_obstacle(mrs.Shape.rectangle(0.2, 2.0), [(0.0, 12.0, 10.0, 0.0), (10.0, 17.0, 10.0, 0.0)])
    for _ in range(5):
        sim.run_for(1.0)
        assert ranges(sim)[30:32].min() == pytest.approx(1.9 + 0.5 * sim.time, rel=2e-3)


@pytest.mark.parametrize("limits", [{}, {"acceleration_limits": (2.0, 2.0, 2.0)}])
@pytest.mark.parametrize("map_transform", [True, False])
def test_what_slides_is_as_fast_as_it_moves(limits, map_transform):
    """Headed into the lower wall at 0.4 rad, far from the origin: along it remains the cosine's share."""
    start = (4.0, 0.6, -0.4)
    sim = simulation(start, robot_radius=0.3, contact="slide", publish_map_transform=map_transform, **limits)
    drive(sim, 0.5)
    sim.run_for(3.0)
    speeds = []
    for _ in range(7):
        before = sim.truth.pose
        sim.run_for(0.033)
        after, (vx, vy, wz) = sim.truth.pose, sim.truth.velocity
        speeds.append((after.x - before.x) / 0.033)
        assert math.hypot(vx, vy) == pytest.approx(speeds[-1], rel=0.02 if limits else 1e-6)
        assert wz == pytest.approx(0.0, abs=1e-9)
        assert sim.truth.path[-1, 1:] == pytest.approx(tuple(after), abs=1e-9)
    if not limits:
        assert speeds == pytest.approx([0.5 * math.cos(0.4)] * 7)
    steps = np.diff(sim.truth.path[:, 1:3], axis=0)
    assert sim.truth.distance == pytest.approx(np.hypot(*steps.T).sum())


def test_between_two_steps_the_truth_is_of_one_mind():
    """From (10, 10) towards a disc whose edge is 0.509 m before the footprint's, so that they meet within a step."""
    sim = simulation((10.0, 10.0, 0.0), robot_radius=0.3)
    sim.add_obstacle(mrs.Shape.disc(0.3), (11.109, 10.0, 0.0))
    drive(sim, 1.0)
    for moment in (0.009, 0.507, 0.515):
        sim.run_for(moment - sim.time)
        expected = (10.0 + min(moment, 0.509), 10.0, 0.0)
        assert tuple(sim.truth.pose) == pytest.approx(expected, abs=2e-6)
        assert sim.truth.path[-1] == pytest.approx([moment, *sim.truth.pose], abs=1e-12)
        assert tuple(sim.truth.pose_at(moment)) == pytest.approx(tuple(sim.truth.pose), abs=1e-12)
        assert sim.truth.pose_at(moment - 0.004).x == pytest.approx(10.0 + min(moment - 0.004, 0.509), abs=2e-6)
    (contact,) = sim.truth.contacts
    sim.run_for(0.1)
    assert sim.truth.contacts == [contact] and contact.time == pytest.approx(0.509, abs=1e-5)


def test_an_obstacle_on_whole_cells_looks_like_the_grid():
    sim = simulation(start=(10.0, 10.0, 0.1))
    sim.add_obstacle(mrs.Shape.rectangle(0.5, 0.3), (12.25, 10.45, 0.0))
    cells = hall().cells.copy()
    cells[103:106, 120:125] = 100
    drawn = mrs.Simulation(
        mrs.OccupancyGrid(cells, resolution=0.1),
        parameters={name: getattr(sim.laser.parameters, name) for name in ("apply_noise", "laser_beam_count", "laser_fov")},
        start=(10.0, 10.0, 0.1),
    )
    sim.run_for(0.1)
    drawn.run_for(0.1)
    assert ranges(sim) == pytest.approx(ranges(drawn), abs=1e-6)


def test_a_robot_stops_before_an_obstacle_and_is_met_by_one_that_comes():
    sim = simulation(robot_radius=0.3)
    sim.add_obstacle(mrs.Shape.disc(0.5), (5.0, 2.0, 0.0), name="pillar")
    drive(sim, 1.0)
    sim.run_for(5.0)
    assert sim.pose.x == pytest.approx(4.2, abs=1e-5)
    drive(sim, 0.0)
    sim.set_pose((10.0, 10.0, 0.0))
    sim.add_obstacle(mrs.Shape.rectangle(1.0, 1.0), [(5.0, 14.0, 10.0, 0.0), (9.0, 10.0, 10.0, 0.0)], name="cart")
    sim.run_until(lambda sim: len(sim.truth.contacts) == 2, 10.0)
    pillar, cart = sim.truth.contacts
    assert (pillar.what, cart.what) == ("obstacle pillar", "obstacle cart")
    assert cart.time == pytest.approx(8.2, abs=0.03)


def test_a_robot_that_something_came_over_can_drive_away():
    sim = simulation(start=(10.0, 10.0, 0.0), robot_radius=0.3)
    sim.add_obstacle(mrs.Shape.rectangle(1.0, 1.0), [(0.0, 8.0, 10.0, 0.0), (2.0, 9.3, 10.0, 0.0)], name="cart")
    sim.run_for(3.0)
    assert [contact.what for contact in sim.truth.contacts] == ["obstacle cart"] and sim.truth.clearance == 0.0
    drive(sim, 0.5)
    sim.run_for(2.0)
    assert sim.pose.x == pytest.approx(11.0, abs=0.02) and sim.truth.velocity[0] == pytest.approx(0.5)


def test_what_holds_a_robot_back_can_change_while_it_runs():
    sim = simulation(start=(10.0, 10.0, 0.0))
    drive(sim, 1.0)
    sim.run_for(1.0)
    sim.robot.set_parameters(robot_radius=0.5)
    sim.add_obstacle(mrs.Shape.disc(0.5), (14.0, 10.0, 0.0))
    drive(sim, 1.0)
    sim.run_for(4.0)
    assert sim.pose.x == pytest.approx(13.0, abs=1e-5) and len(sim.truth.contacts) == 1
    assert sim.truth.distance == pytest.approx(3.0, abs=1e-5) and sim.truth.path[0, 1] == 10.0


def test_waypoints_and_functions():
    obstacle = Obstacle("x", mrs.Shape.disc(1.0), [(1.0, 0.0, 0.0, 0.0), (3.0, 4.0, 2.0, 1.0)])
    assert [tuple(obstacle.pose(round(time * 1e9))) for time in (0, 1, 2, 3, 4)] == [
        (0, 0, 0),
        (0, 0, 0),
        (2, 1, 0.5),
        (4, 2, 1),
        (4, 2, 1),
    ]
    with pytest.raises(ValueError, match="times of waypoints must increase"):
        Obstacle("x", mrs.Shape.disc(1.0), [(1.0, 0, 0, 0), (1.0, 1, 1, 1)])
    with pytest.raises(ValueError, match=r"a waypoint must be four finite numbers \(time, x, y, yaw\)"):
        Obstacle("x", mrs.Shape.disc(1.0), [(1.0, 0, 0), (2.0, 1, 1)])


# --- several robots ---


def pair(**parameters) -> mrs.Simulation:
    quiet = {"apply_noise": False, "velocity_timeout": 0, "laser_beam_count": 60, "laser_fov": 2 * math.pi}
    robots = {"robot1": (5.0, 10.0, 0.0), "robot2": (9.0, 10.0, math.pi)}
    return mrs.Simulation(hall(), parameters={**quiet, **parameters}, seed=SEED, robots=robots)


def test_robots_have_topics_frames_and_services_of_their_own():
    sim = pair()
    sim.run_for(0.2)
    scan, odometry = sim.latest("/robot2/scan"), sim.latest("/robot2/odom")
    assert scan.header.frame_id == "robot2/base_link"
    assert (odometry.header.frame_id, odometry.child_frame_id) == ("robot2/odom", "robot2/base_link")
    links = {(transform.header.frame_id, transform.child_frame_id) for transform in sim.latest("/tf").transforms}
    assert links == {("map", "robot2/odom"), ("robot2/odom", "robot2/base_link")}
    with pytest.raises(ValueError, match="unknown topic '/scan'"):
        sim.latest("/scan")
    clocks = []
    sim.subscribe("/clock", mrs.messages.Clock, clocks.append)
    sim.run_for(1.0)
    assert len(clocks) == 10
    sim.publish(
        "/robot2/initialpose",
        mrs.messages.PoseWithCovarianceStamped(
            pose=mrs.messages.PoseWithCovariance(mrs.messages.Pose.from_planar(mrs.Pose(3, 3, 1)))
        ),
    )
    sim.run_for(0.1)
    assert tuple(sim.robots["robot2"].pose) == pytest.approx((3, 3, 1))
    assert sim.named("robot1").pose.x == 5.0


def test_robots_see_and_meet_one_another():
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


def test_a_robots_noise_does_not_hang_on_the_others():
    both = pair(apply_noise=True)
    alone = mrs.Simulation(
        hall(),
        parameters={"laser_beam_count": 60, "laser_fov": 2 * math.pi, "robot_radius": 0},
        seed=SEED,
        robots={"robot2": (9.0, 10.0, math.pi)},
    )
    for sim in (both, alone):
        sim.run_for(0.3)
    seen, free = both.latest("/robot2/scan").ranges, alone.latest("/robot2/scan").ranges
    assert np.sum(seen != free) < 6
    assert not np.array_equal(both.latest("/robot1/scan").ranges, seen)


def test_names_of_robots():
    sim = pair()
    for name in ("robot1", "", "1st", "a b"):
        with pytest.raises(ValueError, match="name"):
            sim.add_robot(name, start=(2, 2, 0))
    with pytest.raises(ValueError, match="room beside walls"):
        sim.add_robot("robot3", start=(0.2, 2.0, 0.0))
    assert sim.add_robot("robot3", start=(3, 3, 0), parameters={"robot_radius": 0.4}).robot.parameters.robot_radius == 0.4


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"robot_radius": -1}, "robot_radius must be"),
        ({"footprint": "[[0, 0], [1, 1]]"}, "footprint must be"),
        ({"footprint": [[0, 0], [1, 0], [0, 1]], "robot_radius": 1.0}, "one of robot_radius and footprint"),
        ({"contact": "bounce"}, "contact must be"),
        ({"velocity_limits": (1.0, -1.0, 0.0)}, "velocity_limits"),
        ({"odometry_alphas": (0.1,) * 5}, "odometry_alphas"),
    ],
)
def test_bad_parameters_are_refused(values, message):
    with pytest.raises(ValueError, match=message):
        simulation(**values)


def test_everything_repeats_after_a_restore_in_the_middle():
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


def test_a_wall_that_is_left_and_met_again_is_met_twice():
    sim = simulation((1.0, 10.0, math.pi), robot_radius=0.3)
    for speed in (1.0, -0.5, 1.0):
        drive(sim, speed)
        sim.run_for(1.0)
    first, second = sim.truth.contacts
    assert first.what == second.what == "a wall" and second.time > first.time + 1.0


def test_contact_that_is_only_reported_changes_nothing_to_the_last_bit():
    ways = []
    for parameters in ({"robot_radius": 0.3, "contact": "report"}, {}):
        sim = simulation((0.7, 3.0, -2.0), **parameters)
        drive(sim, 0.6, wz=0.1)
        sim.run_for(2.01)
        ways.append((tuple(sim.truth.pose), sim.truth.velocity, sim.truth.distance))
    assert ways[0] == ways[1]


def test_what_slides_on_wheels_that_slip_believes_that_they_turned():
    sim = simulation((4.0, 0.6, -0.4), robot_radius=0.3, contact="slide")
    sim.add_fault(faults.Slip(0.5))
    drive(sim, 0.5)
    sim.run_for(3.0)
    vx, vy, _ = sim.truth.velocity
    assert math.hypot(vx, vy) == pytest.approx(0.25 * math.cos(0.4))
    assert sim.robot.motion.wheel_velocity(3_000_000_000)[:2] == pytest.approx((2 * vx, 2 * vy))


def test_an_obstacle_may_be_driven_by_where_the_robot_is():
    """One that keeps 1 m before the robot, as it is when it asks."""
    sim = simulation((5.0, 10.0, 0.0), robot_radius=0.3)
    sim.add_obstacle(mrs.Shape.disc(0.2), lambda time: (sim.pose.x + 1.0, 10.0, 0.0))
    drive(sim, 0.5)
    sim.run_for(4.0)
    assert sim.pose.x == pytest.approx(7.0) and sim.truth.contacts == []
    assert ranges(sim).min() == pytest.approx(0.8, abs=0.01)


def test_robots_of_one_simulation_have_noise_of_their_own_and_are_reset_together():
    sim = pair(apply_noise=True)
    seeds = {robot.laser.parameters.seed for robot in sim.robots.values()}
    seeds |= {robot.robot.parameters.odometry_seed for robot in sim.robots.values()}
    assert len(seeds) >= 2 and SEED not in seeds
    assert len({robot.laser.parameters.seed for robot in sim.robots.values()}) == 2
    for name in sim.robots:
        drive(sim, 0.5, topic=f"/{name}/cmd_vel")
    sim.run_for(1.0)
    sim.reset()
    assert [tuple(robot.pose) for robot in sim.robots.values()] == [(5.0, 10.0, 0.0), (9.0, 10.0, math.pi)]


def test_clearances_are_told_apart_up_to_ten_metres():
    sim = mrs.Simulation(hall(30.0), start=(9.6, 15.0, 0.0))
    assert sim.truth.clearance == pytest.approx(9.5, abs=1e-5)
    sim.set_pose((15.0, 15.0, 0.0))
    assert sim.truth.clearance == 10.0
