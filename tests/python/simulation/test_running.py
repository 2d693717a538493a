"""Running: for a time, until something holds, or to the next moment; what stops a run says why."""

from __future__ import annotations

import numpy as np
import pytest

import mobile_robot_simulator as mrs


@pytest.fixture
def sim() -> mrs.Simulation:
    cells = np.zeros((50, 50), np.int8)
    cells[0] = 100
    grid = mrs.OccupancyGrid(cells, resolution=0.1)
    return mrs.Simulation(grid, parameters={"velocity_timeout": 0, "laser_beam_count": 11}, start=(1, 1, 0))


def drive(sim: mrs.Simulation, speed: float = 0.5) -> None:
    sim.publish("/cmd_vel", mrs.messages.Twist(linear=mrs.messages.Vector3(x=speed)))


def test_run_until_stops_at_the_moment_at_which_it_holds(sim):
    drive(sim)
    assert sim.run_until(lambda sim: sim.pose.x >= 2.0, 10.0) == 2.0
    assert sim.time == 2.0


def test_run_until_asks_before_time_goes_on(sim):
    assert sim.run_until(lambda sim: True, 0.0) == 0.0


def test_a_predicate_that_never_holds_says_what_was_last_seen(sim):
    drive(sim)

    def home(sim):
        return sim.pose.x if sim.pose.x < 0 else None

    with pytest.raises(TimeoutError) as raised:
        sim.run_until(home, 1.55)
    text = str(raised.value)
    assert sim.time == 1.55
    for part in ("home did not hold within 1.55 s, from 0 s on", "gave None", "(1.77, 1.00, 0.00)", "0.50, 0.00 m/s"):
        assert part in text
    assert "/odom 1.5 s" in text and "/initialpose never" in text


def test_step_goes_to_the_next_moment(sim):
    assert sim.step() == 0.0  # the map and the first messages
    assert sim.step() == pytest.approx(0.1)
    assert sim.latest("/odom") is not None and sim.latest("/scan") is not None
    assert sim.step() == pytest.approx(0.2)


@pytest.mark.parametrize("seconds", [-1.0, float("nan"), float("inf")])
def test_times_that_are_none_are_refused(sim, seconds):
    with pytest.raises(ValueError, match="the timeout must be finite"):
        sim.run_until(lambda sim: False, seconds)
    with pytest.raises(ValueError, match="the duration must be finite"):
        sim.run_for(seconds)


def test_set_pose_and_reset(sim):
    drive(sim)
    sim.run_for(1.0)
    sim.set_pose((3.0, 3.0, 1.0))
    assert tuple(sim.pose) == pytest.approx((3.0, 3.0, 1.0))
    with pytest.raises(ValueError, match="inside a wall"):
        sim.set_pose((1.0, 0.05, 0.0))
    sim.reset()
    assert tuple(sim.pose) == (1.0, 1.0, 0.0)
    assert sim.truth.distance == 0.0 and sim.truth.velocity == (0.0, 0.0, 0.0)
    with pytest.raises(ValueError, match="unknown robot 'x'"):
        sim.set_pose((3.0, 3.0, 1.0), "x")


def test_callbacks_publish_set_timers_and_call_services(sim):
    node, seen = sim.create_node("clerk"), []
    client = node.create_client(mrs.messages.GetMap, "static_map")

    def on_scan(scan):
        if not seen:
            seen.append("scan")
            drive(sim)
            node.create_timer(0.25, lambda: seen.append(f"timer {sim.time:g}"))
            client.call_async(mrs.messages.GetMap.Request()).add_done_callback(
                lambda future: seen.append(f"map {future.result().map.info.width}")
            )

    sim.subscribe("/scan", mrs.messages.LaserScan, on_scan)
    sim.run_for(0.4)
    assert seen == ["scan", "map 50", "timer 0.35"]
    assert sim.pose.x == pytest.approx(1.15)


def test_a_callback_that_raises_comes_out_with_its_traceback_and_the_run_can_go_on(sim):
    def on_scan(scan):
        raise KeyError("mine")

    subscription = sim.subscribe("/scan", mrs.messages.LaserScan, on_scan)
    with pytest.raises(KeyError, match="mine") as raised:
        sim.run_for(1.0)
    assert raised.traceback[-1].name == "on_scan"
    sim.unsubscribe(subscription)
    sim.run_for(1.0)
    assert sim.time == pytest.approx(1.1)


def test_time_that_does_not_go_on_is_an_error(sim):
    node = sim.create_node("clerk")
    with pytest.raises(ValueError, match="period must be at least a nanosecond"):
        node.create_timer(0.0, lambda: None)
    publisher = node.create_publisher(mrs.messages.Twist, "/ping")
    node.create_subscription(mrs.messages.Twist, "/ping", publisher.publish)
    publisher.publish(mrs.messages.Twist())
    with pytest.raises(RuntimeError, match="time stands still at 0"):
        sim.run_for(1.0)


def test_unknown_topics_and_wrong_types_are_refused(sim):
    with pytest.raises(ValueError, match=r"unknown topic '/scam'; did you mean /scan\?"):
        sim.latest("/scam")
    with pytest.raises(TypeError, match="/scan carries LaserScan, got Twist"):
        sim.subscribe("/scan", mrs.messages.Twist, print)
    with pytest.raises(TypeError, match="/cmd_vel carries Twist, got Odometry"):
        sim.publish("/cmd_vel", mrs.messages.Odometry())


def test_the_path_is_exact_at_each_point(sim):
    sim.publish("/cmd_vel", mrs.messages.Twist(linear=mrs.messages.Vector3(x=1.0), angular=mrs.messages.Vector3(z=1.0)))
    sim.run_for(0.75)
    sim.publish("/cmd_vel", mrs.messages.Twist())
    sim.run_for(0.5)
    path = sim.truth.path
    assert path.shape[1] == 4 and np.all(np.diff(path[:, 0]) >= 0.0) and np.diff(path[:, 0]).max() <= 0.1 + 1e-12
    turned = np.minimum(path[:, 0], 0.75)
    assert path[:, 1] == pytest.approx(1.0 + np.sin(turned))
    assert path[:, 2] == pytest.approx(2.0 - np.cos(turned))
    assert path[-1] == pytest.approx([1.25, *sim.truth.pose])
    assert sim.truth.distance == pytest.approx(0.75)


def test_a_message_that_is_changed_and_sent_again_arrives_as_it_was_each_time(sim):
    node, got = sim.create_node("clerk"), []
    twist, speeds = mrs.messages.Twist(), node.create_publisher(mrs.messages.Twist, "/speeds")
    sim.subscribe("/speeds", mrs.messages.Twist, lambda message: got.append(message.linear.x))
    for speed in (1.0, 2.0):
        twist.linear.x = speed
        speeds.publish(twist)
    twist.linear.x = 0.5
    sim.publish("/cmd_vel", twist)
    twist.linear.x = 9.0
    sim.run_for(1.0)
    assert got == [1.0, 2.0] and sim.latest("/speeds").linear.x == 2.0
    assert sim.pose.x == pytest.approx(1.5)
    scan = mrs.messages.LaserScan(ranges=np.ones(3, np.float32))
    node.create_publisher(mrs.messages.LaserScan, "/scan").publish(scan)
    scan.ranges[0] = 7.0
    assert sim.latest("/scan").ranges[0] == 1.0


def test_a_request_that_is_changed_after_arrives_as_it_was(sim):
    request = mrs.messages.SetPose.Request()
    position = request.pose.pose.pose.position
    position.x, position.y = 3.0, 2.0
    sim.create_node("clerk").create_client(mrs.messages.SetPose, "/set_pose").call_async(request)
    position.x = 4.0
    sim.run_for(0.1)
    assert tuple(sim.pose) == (3.0, 2.0, 0.0)


def test_closing_twice_does_no_harm(sim):
    with sim:
        sim.close()
    with pytest.raises(RuntimeError, match="the simulation is closed"):
        sim.run_for(1.0)


GRID = mrs.OccupancyGrid(np.zeros((50, 50), np.int8), resolution=0.1)
DISC = mrs.Shape.disc(0.2)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"grid": np.zeros((5, 5), np.int8)}, TypeError, "the map must be an OccupancyGrid, got ndarray"),
        ({"robots": ["one"]}, TypeError, "robots must be poses by the robots' names, got list"),
        ({"start": (1, 1, 0), "robots": {"one": (2, 2, 0)}}, ValueError, "one of start and robots must be left out"),
        ({"robots": {"one": (2, 2, 0), "two": (2.3, 2, 0)}}, ValueError, "start must leave the robot room beside robot one"),
    ],
)
def test_what_makes_no_simulation_is_refused(arguments, error, message):
    with pytest.raises(error, match=message):
        mrs.Simulation(**{"grid": GRID, **arguments})


@pytest.mark.parametrize(
    ("deed", "error", "message"),
    [
        (lambda sim: sim.run_until(True, 1.0), TypeError, "predicate must be a function of the simulation, got True"),
        (lambda sim: sim.add_fault("drop"), TypeError, "a fault must be one of faults, got str"),
        (lambda sim: sim.add_obstacle(0.2, (1, 1, 0)), TypeError, "an obstacle's shape must be a Shape, got float"),
        (lambda sim: sim.add_obstacle(DISC, []), ValueError, "there must be at least one waypoint, got none"),
        (
            lambda sim: sim.add_obstacle(DISC, lambda time: None, "cat"),
            TypeError,
            "trajectory of obstacle cat must return poses .* None",
        ),
        (lambda sim: sim.truth.pose_at(float("inf")), ValueError, r"time must be in 0\.\.0 s, got inf"),
    ],
)
def test_what_cannot_be_done_is_refused(sim, deed, error, message):
    with pytest.raises(error, match=message):
        deed(sim)
        sim.run_for(1.0)


def test_a_robot_starts_where_no_obstacle_is(sim):
    sim = mrs.Simulation(GRID, robots={"one": (1, 1, 0)})
    sim.add_obstacle(DISC, [(0.0, 3.0, 3.0, 0.0), (1.0, 4.0, 3.0, 0.0)], "cat")
    with pytest.raises(ValueError, match="beside obstacle cat"):
        sim.add_robot("two", start=(3.3, 3.0, 0.0))
    sim.run_for(1.0)
    sim.add_robot("two", start=(3.3, 3.0, 0.0))


def test_run_until_sees_what_happens_at_its_last_moment(sim):
    seen = []
    sim.subscribe("/cmd_vel", mrs.messages.Twist, seen.append)
    drive(sim)
    assert sim.run_until(lambda sim: seen, 0.0) == 0.0
    assert sim.run_until(lambda sim: sim.latest("/scan") is not None, 0.1) == pytest.approx(0.1)
