"""Simulation: what it publishes, its arguments, and its errors."""

from __future__ import annotations

import doctest
import math
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import messages
from mobile_robot_simulator.bus.node import Node
from mobile_robot_simulator.bus.parameter import Parameter
from mobile_robot_simulator.simulation import simulation
from simulations import small_room, twist

SECOND = 1_000_000_000
GRID = mrs.OccupancyGrid(np.zeros((50, 50), np.int8), resolution=0.1)
DISC = mrs.Shape.disc(0.2)


def test_the_example_of_the_readme(room: mrs.OccupancyGrid) -> None:
    seen: list[mrs.messages.LaserScan] = []
    sim = mrs.Simulation(room, parameters={"laser_beam_count": 181, "velocity_timeout": 0.0}, seed=7)
    sim.subscribe("/scan", mrs.messages.LaserScan, seen.append)
    sim.publish("/cmd_vel", mrs.messages.Twist(linear=mrs.messages.Vector3(x=0.5), angular=mrs.messages.Vector3(z=0.1)))
    sim.run_for(10.0)
    assert sim.time == 10.0
    assert (sim.pose.x, sim.pose.y, sim.pose.yaw) == pytest.approx((5 * math.sin(1), 5 * (1 - math.cos(1)), 1.0), abs=1e-12)
    assert len(seen) == 100
    assert sim.latest("/scan") is seen[-1]
    assert all(scan.ranges.shape == (181,) for scan in seen)
    assert sim.latest("/odom").pose.pose.to_planar().x == pytest.approx(sim.pose.x, abs=1e-12)


def test_a_command_holds_for_half_a_second(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room)
    sim.publish("/cmd_vel", twist(0.5))
    sim.run_for(10.0)
    assert tuple(sim.pose) == (0.25, 0.0, 0.0)


def test_before_the_first_run_only_the_map_is_published(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room, start=(1.0, 2.0, 0.5))
    assert sim.time == 0.0
    assert tuple(sim.pose) == pytest.approx((1.0, 2.0, 0.5), abs=1e-15)
    assert sim.latest("/scan") is None and sim.latest("/odom") is None
    assert sim.latest("/map").info.width == 200
    assert sim.grid is room


def test_the_first_scan_is_taken_from_the_start_pose(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room, start=(1.0, 2.0, 0.5), parameters={"apply_noise": False})
    sim.run_for(0.1)
    expected = mrs.LaserScanner().mark_invalid(mrs.LaserScanner().scan(room, (1.0, 2.0, 0.5)))
    assert np.allclose(sim.latest("/scan").ranges, expected, rtol=0.0, atol=1e-5)


@pytest.mark.parametrize("map_transform", [True, False])
def test_scans_equal_a_batch_at_the_published_poses(room: mrs.OccupancyGrid, map_transform: bool) -> None:
    """They are equal byte for byte, because the noise depends only on the seed and the index of the scan."""
    sim = mrs.Simulation(room, seed=5, parameters={"publish_map_transform": map_transform, "sigma_hit": 0.03, "z_rand": 0.1})
    scans: list[mrs.messages.LaserScan] = []
    poses: list[mrs.Pose] = []

    def follow(message: mrs.messages.TFMessage) -> None:
        links = {transform.child_frame_id: transform.transform.to_planar() for transform in message.transforms}
        poses.append(links.get("odom", mrs.Pose()) * links["base_link"])

    sim.subscribe("/tf", mrs.messages.TFMessage, follow)
    sim.subscribe("/scan", mrs.messages.LaserScan, scans.append)
    for _ in range(10):
        sim.publish("/cmd_vel", twist(0.5, 0.1, 0.4))
        sim.run_for(0.3)
    laser, noise = mrs.LaserScanner(), mrs.BeamModel(sigma_hit=0.03, z_rand=0.1)
    batch = laser.scan_batch(room, np.array([tuple(pose) for pose in poses]), noise=noise, seed=5)
    assert len(scans) == len(poses) == 30
    assert np.array_equal(np.array([scan.ranges for scan in scans]), laser.mark_invalid(batch))


@pytest.mark.parametrize("rate", [40.0, 25.0, 3.0])
def test_scans_between_odometry_messages_are_taken_from_the_true_pose(room: mrs.OccupancyGrid, rate: float) -> None:
    """This includes the first scans: some of them can be missing, but none is taken from a wrong pose."""
    sim = mrs.Simulation(room, parameters={"laser_frequency": rate, "apply_noise": False, "velocity_timeout": 0.0})
    sim.publish("/cmd_vel", twist(2.0, 0.0, 0.9))
    scans: list[mrs.messages.LaserScan] = []
    sim.subscribe("/scan", mrs.messages.LaserScan, scans.append)
    sim.run_for(2.0)
    assert len(scans) >= 2 * rate - 0.1 * rate - 1
    laser = mrs.LaserScanner()
    for scan in scans:
        seconds = scan.header.stamp.nanoseconds / SECOND
        exact = laser.mark_invalid(laser.scan(room, mrs.Pose().integrate((2.0, 0.0, 0.9), seconds)))
        assert np.isclose(scan.ranges, exact, rtol=0.0, atol=1e-4).mean() > 0.95, f"at {seconds} s"


def initial_pose(x: float, y: float, yaw: float) -> mrs.messages.PoseWithCovarianceStamped:
    message = mrs.messages.PoseWithCovarianceStamped(mrs.messages.Header(frame_id="map"))
    message.pose.pose = messages.Pose.from_planar(mrs.Pose(x, y, yaw))
    return message


def test_an_initial_pose_is_not_a_motion(room: mrs.OccupancyGrid) -> None:
    """Scans are taken from the old pose or from the new one, and from no pose in between or beyond."""
    sim = mrs.Simulation(room, parameters={"laser_frequency": 40.0, "apply_noise": False})
    scans: list[mrs.messages.LaserScan] = []
    sim.subscribe("/scan", mrs.messages.LaserScan, scans.append)
    sim.run_for(0.5)
    sim.publish("/initialpose", initial_pose(4.0, -3.0, 1.0))
    sim.run_for(0.5)
    assert tuple(sim.pose) == pytest.approx((4.0, -3.0, 1.0), abs=1e-12)
    laser = mrs.LaserScanner()
    old, new = (laser.mark_invalid(laser.scan(room, pose)) for pose in ((0.0, 0.0, 0.0), (4.0, -3.0, 1.0)))
    for scan in scans:
        close = [np.isclose(scan.ranges, exact, rtol=0.0, atol=1e-4).mean() > 0.95 for exact in (old, new)]
        assert any(close), f"at {scan.header.stamp.nanoseconds / SECOND} s"
    assert np.isclose(scans[-1].ranges, new, rtol=0.0, atol=1e-4).mean() > 0.95


def test_scans_of_a_stopped_robot_are_taken_from_where_it_stopped(room: mrs.OccupancyGrid) -> None:
    """The command times out between two transforms. Later scans are taken from where the robot stands."""
    sim = mrs.Simulation(room, parameters={"laser_frequency": 40.0, "apply_noise": False})
    sim.publish("/cmd_vel", twist(2.0))
    sim.run_for(2.0)
    laser = mrs.LaserScanner()
    exact = laser.mark_invalid(laser.scan(room, (1.0, 0.0, 0.0)))
    assert np.isclose(sim.latest("/scan").ranges, exact, rtol=0.0, atol=1e-4).mean() > 0.95


def run(room: mrs.OccupancyGrid, seed: int, piece: float) -> list[tuple[str, Any, int]]:
    sim = mrs.Simulation(room, seed=seed, parameters={"laser_beam_count": 31, "laser_frequency": 15.0})
    sent: list[tuple[str, Any, int]] = []
    sim.record(lambda *event: sent.append(event))
    for _ in range(4):
        sim.publish("/cmd_vel", twist(0.5, 0.0, 0.3))
        for _ in range(round(1.0 / piece)):
            sim.run_for(piece)
    return sent


def test_the_same_run_twice_gives_the_same_messages(room: mrs.OccupancyGrid) -> None:
    first = run(room, 3, 1.0)
    assert first == run(room, 3, 1.0)
    assert first == run(room, 3, 0.125)
    assert first != run(room, 4, 1.0)
    topics = [topic for topic, _, _ in first]
    assert {topic: topics.count(topic) for topic in set(topics)} == {
        "/map": 1,
        "/cmd_vel": 4,
        "/clock": 40,
        "/odom": 40,
        # 40 with odometry, 40 at the stamps of other scans.
        "/tf": 80,
        "/scan": topics.count("/scan"),
    }
    times = [time_ns for _, _, time_ns in first]
    assert times == sorted(times)


def test_the_map_is_served(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room)
    future = (
        sim.create_node("client").create_client(mrs.messages.GetMap, "/static_map").call_async(mrs.messages.GetMap.Request())
    )
    sim.run_for(0.0)
    assert future.result().map == sim.latest("/map")


def test_the_clock_is_published(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room)
    sim.run_for(1.0)
    assert sim.latest("/clock") == mrs.messages.Clock(mrs.messages.Time(1, 0))


def test_a_callback_can_drive_the_robot(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room)
    sim.subscribe(
        "/scan", mrs.messages.LaserScan, lambda scan: sim.publish("/cmd_vel", twist(1.0 if min(scan.ranges) > 0.5 else 0.0))
    )
    sim.run_for(30.0)
    # The robot drives from (0, 0) along x until it is half a metre from the wall at x = 9.9.
    assert 9.2 < sim.pose.x < 9.45


def test_a_node_of_the_user_can_drive_the_robot(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room)
    node = sim.create_node("mine")
    publisher = node.create_publisher(mrs.messages.Twist, "/cmd_vel")
    node.create_timer(0.1, lambda: publisher.publish(twist(1.0)))
    sim.run_for(2.0)
    assert sim.pose.x == pytest.approx(1.9, abs=1e-12)


def test_spawn_passes_namespace_and_parameters_to_the_node(room: mrs.OccupancyGrid) -> None:
    class Talker(Node):
        def __init__(self) -> None:
            super().__init__("talker", parameter_overrides=[Parameter("a", value=1), Parameter("b", value=2)])
            self.a, self.b = (self.declare_parameter(name).value for name in "ab")
            self.topic = self.create_publisher(mrs.messages.String, "~/said", 1).topic_name

    talker = mrs.Simulation(room).spawn(Talker, namespace="/robot1", parameters={"b": 3})
    assert (talker.a, talker.b, talker.topic) == (1, 3, "/robot1/talker/said")


def test_a_request_can_be_changed_after_the_call(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room)
    request = mrs.messages.SetPose.Request()
    position = request.pose.pose.pose.position
    position.x, position.y = 3.0, 2.0
    sim.create_node("clerk").create_client(mrs.messages.SetPose, "/set_pose").call_async(request)
    position.x = 4.0
    sim.run_for(0.1)
    assert tuple(sim.pose) == (3.0, 2.0, 0.0)


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda sim: sim.publish("/cmd_vle", twist()), ValueError, "unknown topic '/cmd_vle'; did you mean /cmd_vel"),
        (lambda sim: sim.latest("/odometry"), ValueError, "unknown topic '/odometry'"),
        (lambda sim: sim.latest(""), ValueError, "must have a name"),
        (
            lambda sim: sim.subscribe("/scan", mrs.messages.Odometry, print),
            TypeError,
            "/scan carries LaserScan, got Odometry",
        ),
        (lambda sim: sim.subscribe("/scan", "LaserScan", print), TypeError, "message class"),
        (
            lambda sim: sim.publish("/cmd_vel", mrs.messages.TwistStamped()),
            TypeError,
            "/cmd_vel carries Twist, got TwistStamped",
        ),
        (lambda sim: sim.publish("/cmd_vel", (1.0, 0.0)), TypeError, "carries Twist, got"),
        (lambda sim: sim.run_for(-1.0), ValueError, "at least 0 s, got -1.0"),
        (lambda sim: sim.run_for(1e300), ValueError, "at most 4.612e+09 s, got 1e+300"),
        (lambda sim: sim.run_for(math.nan), ValueError, "finite"),
        (lambda sim: sim.run_for(math.inf), ValueError, "finite"),
        (lambda sim: sim.run_for("10"), TypeError, ""),
    ],
)
def test_bad_calls_are_refused_and_change_nothing(
    room: mrs.OccupancyGrid, call: Any, error: type[Exception], words: str
) -> None:
    sim = mrs.Simulation(room)
    with pytest.raises(error) as caught:
        call(sim)
    assert words in str(caught.value)
    sim.run_for(1.0)
    assert (sim.time, len(sim.latest("/scan").ranges)) == (1.0, 541)


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ({"parameters": {"laser_beam": 5}}, ValueError, "unknown parameter 'laser_beam'; did you mean 'laser_beam_count'"),
        ({"parameters": {"laser_beam_count": 0}}, ValueError, "laser_beam_count must be"),
        ({"parameters": {"publish_rate": math.nan}}, ValueError, "publish_rate must be"),
        ({"parameters": {"laser_topic": ""}}, ValueError, "laser_topic"),
        ({"seed": -1}, ValueError, "seed must be"),
        ({"seed": 2**64}, ValueError, "seed must be"),
        ({"seed": "x"}, ValueError, "seed must be"),
        ({"start": (2.5, 2.5, 0.0)}, ValueError, "start must not be inside a wall, got (2.5, 2.5, 0.0)"),
        ({"start": (-9.95, 0.0, 0.0)}, ValueError, "wall"),
        ({"start": (math.nan, 0.0, 0.0)}, ValueError, "finite"),
        ({"start": (0.0, 0.0)}, (ValueError, TypeError), ""),
        ({"start": "here"}, (ValueError, TypeError), ""),
    ],
)
def test_bad_simulations_are_refused(room: mrs.OccupancyGrid, options: dict[str, Any], error: Any, words: str) -> None:
    with pytest.raises(error) as caught:
        mrs.Simulation(room, **options)
    assert words in str(caught.value)


def test_the_argument_seed_takes_precedence_over_the_parameter(room: mrs.OccupancyGrid) -> None:
    for seed in (0, 5):
        assert mrs.Simulation(room, seed=seed, parameters={"seed": 6}).laser.parameters.seed == seed
    assert mrs.Simulation(room, parameters={"seed": 6}).laser.parameters.seed == 6


@pytest.mark.parametrize(("options", "blocks"), [({}, False), ({"unknown": "occupied"}, True), ({"unknown": "free"}, False)])
@pytest.mark.parametrize("grid_says", ["free", "occupied"])
def test_the_parameter_unknown_takes_precedence_over_the_grid(options: dict[str, str], blocks: bool, grid_says: str) -> None:
    cells = np.full((10, 40), -1, np.int8)
    cells[:, :20] = 0
    grid = mrs.OccupancyGrid(cells, resolution=0.1, unknown=grid_says)
    sim = mrs.Simulation(grid, start=(0.5, 0.5, 0.0), parameters={"laser_beam_count": 1, "apply_noise": False, **options})
    sim.run_for(0.1)
    blocks = blocks if options else grid_says == "occupied"
    assert sim.latest("/scan").ranges[0] == (1.5 if blocks else math.inf)


def test_the_occupied_threshold_of_the_grid_is_used() -> None:
    cells = np.zeros((10, 40), np.int8)
    cells[:, 20] = 30
    for threshold, expected in ((30, 1.5), (31, math.inf)):
        grid = mrs.OccupancyGrid(cells, resolution=0.1, occupied_threshold=threshold)
        sim = mrs.Simulation(grid, start=(0.5, 0.5, 0.0), parameters={"laser_beam_count": 1, "apply_noise": False})
        sim.run_for(0.1)
        assert sim.latest("/scan").ranges[0] == expected


def test_stamped_commands_are_an_option(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room, parameters={"cmd_vel_stamped": True})
    sim.publish("/cmd_vel", mrs.messages.TwistStamped(twist=twist(1.0)))
    sim.run_for(1.0)
    assert sim.pose.x == 0.5


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"grid": np.zeros((5, 5), np.int8)}, TypeError, "the map must be an OccupancyGrid, got ndarray"),
        ({"robots": ["one"]}, TypeError, "robots must be a mapping from names to start poses, got list"),
        ({"start": (1, 1, 0), "robots": {"one": (2, 2, 0)}}, ValueError, "start and robots must not both be given"),
        ({"robots": {"one": (2, 2, 0), "two": (2.3, 2, 0)}}, ValueError, "start must leave the robot room beside robot one"),
    ],
)
def test_bad_maps_and_robots_are_refused(arguments, error, message):
    with pytest.raises(error, match=message):
        mrs.Simulation(**{"grid": GRID, **arguments})


@pytest.mark.parametrize(
    ("shape", "way", "error", "message"),
    [
        (0.2, (1, 1, 0), TypeError, "an obstacle's shape must be a Shape, got float"),
        (DISC, [], ValueError, "a trajectory must have at least one waypoint, got none"),
        (DISC, lambda time: None, TypeError, "trajectory of obstacle cat must return poses .* None"),
        (DISC, lambda time: (time,), TypeError, r"trajectory of obstacle cat must return poses .* \(0\.0,\)"),
        (DISC, lambda time: (1.0, 2.0), TypeError, r"trajectory of obstacle cat must return poses .* \(1\.0, 2\.0\)"),
        (DISC, lambda time: (1, 2, "3"), TypeError, "trajectory of obstacle cat must return poses .* '3'"),
    ],
)
def test_bad_obstacles_are_refused(room, shape, way, error, message):
    sim = mrs.Simulation(room)
    with pytest.raises(error, match=message):
        sim.add_obstacle(shape, way, "cat")
        sim.run_for(1.0)


def test_the_repr_shows_time_robots_and_map(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room, start=(1.0, 2.0, 0.5))
    sim.run_for(10.0)
    assert repr(sim) == "Simulation(at 10 s, 1 robot at (1.00, 2.00, 0.50), map 200x160 cells)"
    sim = mrs.Simulation(room, robots={})
    assert repr(sim) == "Simulation(at 0 s, 0 robots, map 200x160 cells)"
    sim.add_robot("one")
    sim.add_robot("two", start=(-2.0, 3.0, 0.0))
    assert repr(sim) == (
        "Simulation(at 0 s, 2 robots: one at (0.00, 0.00, 0.00), two at (-2.00, 3.00, 0.00), map 200x160 cells)"
    )


def test_the_example_of_the_documentation_runs():
    results = doctest.testmod(simulation)
    assert results.attempted and not results.failed


def test_parts_of_a_simulation_say_what_they_are(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room, start=(1.0, 2.0, 0.5), parameters={"laser_beam_count": 9})
    assert repr(sim.robot) == "MobileRobotSimulator('', Pose(1.0, 2.0, 0.5))"
    assert repr(sim.laser) == f"LaserScannerSimulator({mrs.LaserScanner(beam_count=9)!r})"
    assert repr(sim.map_server) == "MapServer(topic='map', service='static_map')"
    assert repr(sim.create_node("mine", namespace="/a")) == "BusNode('/a/mine')"
    assert (
        repr(sim.add_obstacle(mrs.Shape.disc(0.25), (3.0, 1.0, 0.0), name="chair")) == "Obstacle('chair', Shape.disc(0.25))"
    )
    assert repr(sim.robots) == "{'': SimulatedRobot(the robot at (1.00, 2.00, 0.50))}"


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda sim: sim.run_for("1"), TypeError, "the duration must be a number of seconds, got '1'"),
        (lambda sim: sim.add_obstacle(mrs.Shape.disc(0.5), (1.0, 2.0)), ValueError, "must be three numbers (x, y, yaw)"),
        (lambda sim: sim.add_obstacle(mrs.Shape.disc(0.5), 5), TypeError, "a trajectory must be a pose (x, y, yaw)"),
        (lambda sim: sim.add_obstacle(mrs.Shape.disc(0.5), [None]), TypeError, "a waypoint must be four numbers"),
        (lambda sim: sim.add_fault(mrs.faults.OdometryDrift(0.1)), ValueError, "alphas must be six numbers, got 0.1"),
        (lambda sim: sim.latest("/foo"), ValueError, "unknown topic '/foo'; there are /"),
    ],
)
def test_messages_say_what_is_needed(call, error, message):
    with pytest.raises(error) as caught:
        call(small_room())
    assert message in str(caught.value)


def test_spawn_needs_a_class(room: mrs.OccupancyGrid) -> None:
    with pytest.raises(TypeError, match=r"spawn needs a class derived from bus\.Node, .* got 'talker'"):
        mrs.Simulation(room).spawn("talker")  # type: ignore[arg-type]


def stamps_of_scans_and_transforms(**rates: float) -> tuple[list[int], list[int]]:
    """Returns the stamps of the scans and of the transforms of one second [ms], in the order in which they were sent.

    The robot drives with drift and slip, and a scan may only follow a transform at its stamp.
    """
    sim = mrs.Simulation(GRID, start=(2.5, 2.5, 0.0), parameters={"odometry_alphas": [0.1] * 6, **rates}, seed=1)
    sim.robot.slip(0.2)
    scans, transforms = list[int](), list[int]()

    def take(topic: str, message: Any, _: int) -> None:
        if topic == "/scan":
            scans.append(message.header.stamp.nanoseconds // 1_000_000)
            assert transforms[-1] == scans[-1]
        elif topic == "/tf":
            map_from_odom, odom_from_base = (each.transform.to_planar() for each in message.transforms)
            assert tuple(map_from_odom * odom_from_base) == pytest.approx(tuple(sim.truth.pose), abs=1e-9)
            transforms.append(message.transforms[0].header.stamp.nanoseconds // 1_000_000)

    sim.record(take)
    sim.publish("/cmd_vel", twist(0.4))
    sim.run_for(1.0)
    return scans, transforms


@pytest.mark.parametrize(("publish_rate", "laser_frequency"), [(10.0, 40.0), (50.0, 40.0), (10.0, 3.0)])
def test_each_scan_has_a_transform_at_its_stamp(publish_rate: float, laser_frequency: float) -> None:
    scans, transforms = stamps_of_scans_and_transforms(publish_rate=publish_rate, laser_frequency=laser_frequency)
    every = {round(1000 * index / publish_rate) for index in range(1, round(publish_rate) + 1)}
    assert len(scans) == laser_frequency
    assert transforms == sorted({*scans, *every})


def test_rates_in_step_need_no_more_transforms() -> None:
    scans, transforms = stamps_of_scans_and_transforms()
    assert scans == transforms == list(range(100, 1001, 100))
