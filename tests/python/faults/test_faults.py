"""Faults: each does what it says, when it says, the same each time, and the recording shows it."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import faults
from mobile_robot_simulator.messages import String

SEED = 5


@pytest.fixture
def sim() -> mrs.Simulation:
    return simulation()


def simulation(**parameters) -> mrs.Simulation:
    cells = np.zeros((200, 200), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    quiet = {"velocity_timeout": 0, "laser_beam_count": 61, "laser_fov": 3.0}
    return mrs.Simulation(
        mrs.OccupancyGrid(cells, resolution=0.1), parameters={**quiet, **parameters}, seed=SEED, start=(5, 5, 0)
    )


def drive(sim: mrs.Simulation, vx: float = 0.5, wz: float = 0.0) -> None:
    sim.publish("/cmd_vel", mrs.messages.Twist(linear=mrs.messages.Vector3(x=vx), angular=mrs.messages.Vector3(z=wz)))


def arrivals(sim: mrs.Simulation, topic: str, seconds: float) -> list[tuple[float, float]]:
    """When messages went out, and their stamps [s]."""
    times: list[tuple[float, float]] = []

    def tap(name, message, time_ns):
        if name == topic and time_ns > began:
            times.append((time_ns / 1e9, message.header.stamp.nanoseconds / 1e9))

    began = round(sim.time * 1e9)
    sim.record(tap)
    sim.run_for(seconds)
    sim.stop_recording(tap)
    return times


def notes(sim: mrs.Simulation, seconds: float) -> list[str]:
    texts: list[str] = []
    subscription = sim.subscribe("/faults", String, lambda message: texts.append(message.data))
    sim.run_for(seconds)
    sim.unsubscribe(subscription)
    return texts


def test_dropped_messages_are_missing_in_their_window(sim):
    sim.add_fault(faults.Drop("/scan", probability=0.5, seed=1, start=1.0, end=3.0))
    times = [time for time, _ in arrivals(sim, "/scan", 4.0)]
    assert len([time for time in times if not 1.0 <= time < 3.0]) == 20
    assert 4 <= len([time for time in times if 1.0 <= time < 3.0]) <= 16
    again = simulation()
    again.add_fault(faults.Drop("/scan", probability=0.5, seed=1, start=1.0, end=3.0))
    assert [time for time, _ in arrivals(again, "/scan", 4.0)] == times


def test_the_recording_shows_what_went_wrong(sim):
    sim.add_fault(faults.Drop("/scan", start=1.0, end=1.35))
    assert notes(sim, 2.0) == ["drop /scan"] * 4
    assert sim.latest("/faults") == String("drop /scan")


def test_delayed_messages_come_late_with_their_own_stamps(sim):
    sim.add_fault(faults.Delay("/scan", 0.25))
    assert [round(time - stamp, 9) for time, stamp in arrivals(sim, "/scan", 1.0)] == [0.25] * 7
    jittery = simulation()
    jittery.add_fault(faults.Delay("/scan", 0.1, jitter=0.3, seed=2))
    late = [time - stamp for time, stamp in arrivals(jittery, "/scan", 5.0)]
    assert min(late) < 0.15 and max(late) > 0.35 and all(0.1 <= value <= 0.4 for value in late)


def test_duplicated_messages_come_twice(sim):
    sim.add_fault(faults.Duplicate("/odom", after=0.05))
    times = np.array(arrivals(sim, "/odom", 0.32))
    assert times == pytest.approx(np.array([(0.1, 0.1), (0.15, 0.1), (0.2, 0.2), (0.25, 0.2), (0.3, 0.3)]))


def test_reordered_messages_come_after_the_next(sim):
    sim.add_fault(faults.Reorder("/odom", start=0.15, end=0.45))
    assert [stamp for _, stamp in arrivals(sim, "/odom", 0.6)] == pytest.approx([0.1, 0.3, 0.2, 0.5, 0.6])
    spared = simulation()
    spared.add_fault(faults.Reorder("/odom", probability=0.3, seed=3))
    stamps = [stamp for _, stamp in arrivals(spared, "/odom", 5.0)]
    assert sorted(stamps) == pytest.approx(np.arange(1, len(stamps) + 1) / 10) and stamps != sorted(stamps)


def test_a_blackout_silences_the_scanner_alone(sim):
    sim.add_fault(faults.Blackout(start=0.5, end=1.5))
    assert len(arrivals(sim, "/scan", 2.0)) == 10
    assert sim.latest("/odom").header.stamp.nanoseconds == 2_000_000_000


def test_stuck_ranges_stay_while_stamps_go_on(sim):
    drive(sim)
    sim.add_fault(faults.StuckRanges(start=0.45, end=1.0))
    scans = []
    sim.subscribe("/scan", mrs.messages.LaserScan, scans.append)
    sim.run_for(1.2)
    ranges = [scan.ranges for scan in scans]
    assert all(np.array_equal(later, ranges[4]) for later in ranges[5:9])
    assert not np.array_equal(ranges[3], ranges[4]) and not np.array_equal(ranges[9], ranges[4])
    assert len({scan.header.stamp.nanoseconds for scan in scans}) == 12


def test_a_blocked_sector_reads_what_blocks_it(sim):
    sim.add_fault(faults.BlockedSector(-0.501, 0.501, distance=0.2))
    sim.run_for(0.1)
    scan = sim.latest("/scan")
    angles = scan.angle_min + np.arange(61) * scan.angle_increment
    assert np.all(scan.ranges[np.abs(angles) <= 0.501] == np.float32(0.2)) and np.all(scan.ranges[np.abs(angles) > 0.51] > 1)
    near = simulation()
    near.add_fault(faults.BlockedSector(-0.5, 0.5))
    near.run_for(0.1)
    assert near.latest("/scan").ranges[30] == -math.inf


def test_slip_leads_the_robot_less_far_than_it_believes(sim):
    drive(sim, 0.5)
    sim.add_fault(faults.Slip(0.4, start=1.0, end=2.0))
    sim.run_for(3.0)
    assert sim.pose.x == pytest.approx(5.0 + 1.3) and sim.robot.believed_pose.x == pytest.approx(1.5)
    odometry, (to_odom, to_base) = sim.latest("/odom"), sim.latest("/tf").transforms
    assert odometry.pose.pose.position.x == pytest.approx(1.5) and odometry.twist.twist.linear.x == 0.5
    assert to_odom.transform.translation.x + to_base.transform.translation.x == pytest.approx(6.3)


def test_slip_holds_for_robots_with_a_footprint_too():
    sim = simulation(robot_radius=0.2)
    drive(sim, 0.5)
    sim.add_fault(faults.Slip(0.4, start=1.0, end=2.0))
    sim.run_for(3.0)
    assert sim.pose.x == pytest.approx(5.0 + 1.3) and sim.robot.believed_pose.x == pytest.approx(1.5)


def test_drift_agrees_with_its_covariance():
    """The normalised error squared of 400 drives is chi-squared with 3 degrees of freedom: its mean is in its 99 % band."""
    alphas, count = (0.02, 0.01, 0.01, 0.02, 0.005, 0.005), 400
    errors = []
    sim = simulation(laser_frequency=0.01)
    sim.run_for(0.05)
    state = sim.save()
    for seed in range(count):
        sim.restore(state)
        sim.add_fault(faults.OdometryDrift(alphas, seed=seed))
        drive(sim, 0.6, 0.3)
        sim.run_for(3.05)
        drive(sim, 0.5, -0.4)
        sim.run_for(2.0)
        odometry = sim.latest("/odom")
        believed = odometry.pose.pose.to_planar()
        true = sim.robot.motion.pose(round(sim.time * 1e9))
        error = np.array([believed.x - true.x, believed.y - true.y, math.remainder(believed.yaw - true.yaw, math.tau)])
        covariance = odometry.pose.covariance.reshape(6, 6)[np.ix_([0, 1, 5], [0, 1, 5])]
        errors.append(error @ np.linalg.solve(covariance, error))
    spread = 2.576 * math.sqrt(2 * 3 / count)
    assert 3 - spread < np.mean(errors) < 3 + spread
    assert 0.05 < np.mean(np.array(errors) > 6.251) < 0.15


def test_without_drift_odometry_is_exact_and_says_so(sim):
    drive(sim, 0.6, 0.3)
    sim.run_for(1.0)
    odometry = sim.latest("/odom")
    assert odometry.pose.covariance.reshape(6, 6)[0, 0] == 1e-9
    assert tuple(odometry.pose.pose.to_planar()) == pytest.approx(tuple(mrs.Pose().integrate((0.6, 0, 0.3), 1.0)), abs=1e-12)


def test_a_parameter_makes_odometry_drift_as_well():
    sim = simulation(odometry_alphas=(0.1, 0.1, 0.1, 0.1, 0.1, 0.1))
    drive(sim)
    sim.run_for(2.0)
    believed = sim.latest("/odom").pose
    assert abs(believed.pose.position.x - 1.0) > 1e-3 and believed.covariance[0] > 1e-4
    map_from_odom, odom_from_base = (link.transform.to_planar() for link in sim.latest("/tf").transforms)
    assert tuple(map_from_odom * odom_from_base) == pytest.approx(tuple(sim.pose), abs=1e-9)


def test_a_clock_that_jumps_takes_stamps_along_but_not_the_robot(sim):
    drive(sim, 0.5)
    sim.add_fault(faults.ClockJump(-0.75, at=1.0))
    node = sim.create_node("clerk")
    sim.run_for(2.0)
    assert sim.pose.x == pytest.approx(6.0)
    assert node.get_clock().now().nanoseconds == 1_250_000_000
    assert sim.latest("/clock").clock.nanoseconds == sim.latest("/scan").header.stamp.nanoseconds == 1_250_000_000
    assert "the clock jumps by -0.75 s" in sim.latest("/faults").data


def test_nodes_stop_and_come_back(sim):
    drive(sim, 0.5)
    sim.add_fault(faults.Outage("laser", start=0.55, end=1.05))
    sim.add_fault(faults.Outage("robot", start=2.0, end=3.0))
    times = [time for time, _ in arrivals(sim, "/scan", 2.0)]
    assert times == pytest.approx([0.1, 0.2, 0.3, 0.4, 0.5, 1.15, 1.25, 1.35, 1.45, 1.55, 1.65, 1.75, 1.85, 1.95])
    assert arrivals(sim, "/odom", 1.05) == []
    assert sim.pose.x == pytest.approx(6.0)
    drive(sim, 0.5)
    sim.run_for(1.0)
    assert sim.pose.x == pytest.approx(6.5) and sim.latest("/odom").header.stamp.nanoseconds > 3_000_000_000


def test_faults_of_one_topic_act_in_turn(sim):
    sim.add_fault(faults.Duplicate("/odom"))
    sim.add_fault(faults.Delay("/odom", 0.05))
    assert np.array(arrivals(sim, "/odom", 0.2)) == pytest.approx(np.array([(0.15, 0.1), (0.15, 0.1)]))


def test_faults_are_saved_and_restored(sim):
    sim.add_fault(faults.Drop("/scan", probability=0.5, seed=1))
    sim.add_fault(faults.Reorder("/odom", probability=0.5, seed=2))
    sim.add_fault(faults.Slip(0.5, start=2.0, end=3.0))
    drive(sim)
    sim.run_for(1.55)
    state = sim.save()
    runs = []
    for _ in range(2):
        runs.append((arrivals(sim, "/scan", 2.0), arrivals(sim, "/odom", 2.0), tuple(sim.pose)))
        sim.add_fault(faults.Blackout())
        sim.restore(state)
    assert runs[0] == runs[1]
    assert len(arrivals(sim, "/scan", 1.0)) > 1


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: faults.Drop("/scan", probability=1.5), "probability must be in 0..1, got 1.5"),
        (lambda: faults.Drop("/scan", start=2.0, end=1.0), "end after that, got start 2.0 and end 1.0"),
        (lambda: faults.Delay("/scan", -1.0), "seconds must be finite and at least 0, got -1"),
        (lambda: faults.Slip(2.0), "share must be in 0..1"),
        (lambda: faults.OdometryDrift((0.1, 0.2)), "alphas must be six numbers, got 2"),
        (lambda: faults.ClockJump(math.nan), "must be finite"),
        (lambda: faults.Outage("lidar"), "robot, laser or map_server, got 'lidar'"),
        (lambda: faults.BlockedSector(1.0, 0.0), "greater than the first"),
        (lambda: faults.Drop("/scam"), r"unknown topic '/scam'; did you mean /scan\?"),
        (lambda: faults.Slip(0.1, robot="r2"), "unknown robot 'r2'"),
    ],
)
def test_bad_faults_are_refused(sim, make, message):
    with pytest.raises(ValueError, match=message):
        sim.add_fault(make())


def test_a_fault_is_added_once(sim):
    fault = sim.add_fault(faults.Drop("/scan"))
    with pytest.raises(ValueError, match="Drop is added already"):
        simulation().add_fault(fault)


@pytest.mark.parametrize(
    "make", [lambda: faults.StuckRanges("/odom"), lambda: faults.BlockedSector(0.0, 1.0, topic="/odom")]
)
def test_a_scanners_fault_needs_scans(sim, make):
    with pytest.raises(TypeError, match="needs a topic of LaserScan, /odom carries Odometry"):
        sim.add_fault(make())
    sim.run_for(1.0)


@pytest.mark.parametrize("seed", [None, "1", 1.0])
def test_a_fault_without_a_seed_would_not_repeat(seed):
    with pytest.raises(TypeError, match="interpreted as an integer"):
        faults.Drop("/odom", seed=seed)


def test_slips_that_overlap_are_multiplied_and_end_each_by_itself(sim):
    drive(sim, 0.5)
    sim.add_fault(faults.Slip(0.5, start=0.5, end=3.1))
    sim.add_fault(faults.Slip(0.2, start=1.1, end=2.1))
    speeds = []
    for seconds in (0.2, 0.4, 1.0, 1.0, 1.0):
        sim.run_for(seconds)
        speeds.append(sim.truth.velocity[0])
    assert speeds == pytest.approx([0.5, 0.25, 0.2, 0.25, 0.5])


def test_a_node_comes_back_after_the_last_of_its_outages(sim):
    sim.add_fault(faults.Outage("laser", start=0.55, end=2.1))
    sim.add_fault(faults.Outage("laser", start=0.75, end=1.1))
    sim.add_fault(faults.Outage("robot", start=0.85, end=3.0))
    times = [time for time, _ in arrivals(sim, "/scan", 2.4)]
    assert times == pytest.approx([0.1, 0.2, 0.3, 0.4, 0.5, 2.2, 2.3, 2.4])


def test_odometry_drifts_in_one_way_at_a_time(sim):
    alphas = (0.1,) * 6
    sim.add_fault(faults.OdometryDrift(alphas, start=1.0, end=2.0))
    sim.add_fault(faults.OdometryDrift(alphas, start=2.0, end=3.0))
    with pytest.raises(ValueError, match="does from 1 s to 2 s already"):
        sim.add_fault(faults.OdometryDrift(alphas, start=1.5))
    assert len(sim.faults) == 2


@pytest.mark.parametrize("radius", [0.0, 0.2])
def test_a_reset_ends_no_fault(radius):
    sim = simulation(robot_radius=radius)
    sim.add_fault(faults.Slip(0.4, end=3.0))
    sim.add_fault(faults.OdometryDrift((0.1,) * 6, end=3.0))
    sim.run_for(1.0)
    sim.reset()
    drive(sim, 0.5)
    sim.run_for(1.0)
    assert sim.truth.velocity[0] == pytest.approx(0.3) and sim.pose.x == pytest.approx(5.3)
    assert sim.latest("/odom").pose.covariance[0] > 1e-6
    sim.run_for(1.5)
    assert sim.truth.velocity[0] == pytest.approx(0.5) and sim.latest("/odom").pose.covariance[0] < 1e-6


@pytest.mark.parametrize(
    ("make", "texts"),
    [
        (lambda: faults.Drop("/odom", end=0.15), {"drop /odom"}),
        (lambda: faults.Delay("/odom", 0.05, end=0.15), {"delay /odom by 0.05 s"}),
        (lambda: faults.Duplicate("/odom", end=0.15), {"duplicate /odom"}),
        (lambda: faults.Reorder("/odom", end=0.15), {"reorder /odom"}),
        (lambda: faults.Blackout(end=0.15), {"blackout of /scan"}),
        (lambda: faults.StuckRanges(end=0.15), {"ranges of /scan stuck"}),
        (lambda: faults.BlockedSector(-0.1, 0.1, end=0.15), {"4 beams of /scan blocked"}),
        (lambda: faults.Slip(0.25, end=0.15), {"the robot slips by 0.25", "the robot slips by 0"}),
        (
            lambda: faults.OdometryDrift([0.1] * 6, end=0.15),
            {"odometry of the robot drifts", "odometry of the robot is exact"},
        ),
        (lambda: faults.ClockJump(2.0, at=0.1), {"the clock jumps by 2 s"}),
        (lambda: faults.Outage("laser", start=0.05, end=0.15), {"laser stops", "laser is back"}),
    ],
)
def test_each_fault_is_seen_in_the_recording(sim, make, texts):
    fault = make()
    sim.add_fault(fault)
    assert set(notes(sim, 0.3)) == texts


def test_a_wall_before_what_blocks_the_scanner_is_seen(sim):
    sim.set_pose((0.5, 5.0, math.pi))
    sim.add_fault(faults.BlockedSector(-0.1, 0.1, distance=3.0))
    sim.run_for(0.1)
    assert sim.latest("/scan").ranges[30] == pytest.approx(0.4, abs=0.01)


def test_an_outage_of_a_robot_with_a_footprint_ends_its_command():
    sim = simulation(robot_radius=0.2)
    drive(sim, 0.5)
    sim.add_fault(faults.Outage("robot", start=1.0, end=2.0))
    sim.run_for(3.0)
    assert sim.pose.x == pytest.approx(5.5) and sim.truth.velocity == (0.0, 0.0, 0.0)


def test_the_seed_of_the_simulation_names_the_drift_of_its_odometry():
    def believed(seed):
        sim = mrs.Simulation(simulation().grid, parameters={"odometry_alphas": (0.1,) * 6}, seed=seed, start=(5, 5, 0))
        drive(sim, 0.5)
        sim.run_for(1.0)
        return tuple(sim.robot.believed_pose)

    assert believed(1) == believed(1) != believed(2)
