"""simulation: map, nodes and bus in one object; the same calls give the same messages."""

from __future__ import annotations

import math
import traceback
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import messages, plotting

SECOND = 1_000_000_000


def twist(vx: float = 0.0, vy: float = 0.0, wz: float = 0.0) -> mrs.messages.Twist:
    return mrs.messages.Twist(linear=mrs.messages.Vector3(x=vx, y=vy), angular=mrs.messages.Vector3(z=wz))


def test_the_example_of_the_front_page(room: mrs.OccupancyGrid) -> None:
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


def test_a_command_is_held_for_half_a_second(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room)
    sim.publish("/cmd_vel", twist(0.5))
    sim.run_for(10.0)
    assert tuple(sim.pose) == (0.25, 0.0, 0.0)


def test_at_first_there_is_nothing_but_the_map(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room, start=(1.0, 2.0, 0.5))
    assert sim.time == 0.0
    assert tuple(sim.pose) == pytest.approx((1.0, 2.0, 0.5), abs=1e-15)
    assert sim.latest("/scan") is None and sim.latest("/odom") is None
    assert sim.latest("/map").info.width == 200
    assert sim.grid is room


def test_the_start_pose_is_where_scans_are_from(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room, start=(1.0, 2.0, 0.5), parameters={"apply_noise": False})
    sim.run_for(0.1)
    expected = mrs.LaserScanner().mark_invalid(mrs.LaserScanner().scan(room, (1.0, 2.0, 0.5)))
    assert np.allclose(sim.latest("/scan").ranges, expected, rtol=0.0, atol=1e-5)


@pytest.mark.parametrize("map_transform", [True, False])
def test_scans_equal_a_batch_at_the_published_poses(room: mrs.OccupancyGrid, map_transform: bool) -> None:
    """Byte for byte, with the seed and the index of the scan."""
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
def test_scans_between_odometry_are_from_where_the_robot_is(room: mrs.OccupancyGrid, rate: float) -> None:
    """From the first one on: a scan may be missing, but none is from another place."""
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


def test_an_initial_pose_is_no_motion(room: mrs.OccupancyGrid) -> None:
    """A robot that is put elsewhere was not on the way there, and does not go on from there."""
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


def test_a_stopped_robot_is_not_seen_to_move(room: mrs.OccupancyGrid) -> None:
    """Its timeout came between two transforms: scans after it are from where it stands."""
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
        "/tf": 40,
        "/scan": topics.count("/scan"),
    }
    times = [time_ns for _, _, time_ns in first]
    assert times == sorted(times)


def test_late_subscribers_get_the_map(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room)
    sim.run_for(3.0)
    seen: list[Any] = []
    sim.subscribe("/map", messages.OccupancyGrid, seen.append)
    sim.run_for(0.0)
    assert seen == [sim.latest("/map")]
    assert seen[0].data.tolist() == room.cells.reshape(-1).tolist()


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


def test_a_callback_may_drive(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room)
    sim.subscribe(
        "/scan", mrs.messages.LaserScan, lambda scan: sim.publish("/cmd_vel", twist(1.0 if min(scan.ranges) > 0.5 else 0.0))
    )
    sim.run_for(30.0)
    # From (0, 0) along x to half a metre before the wall at 9.9.
    assert 9.2 < sim.pose.x < 9.45


def test_a_callback_that_raises_stops_the_run_and_the_run_can_go_on(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room)
    seen: list[Any] = []

    def complain(scan: mrs.messages.LaserScan) -> None:
        seen.append(scan)
        if len(seen) == 3:
            raise RuntimeError("too dark")

    sim.subscribe("/scan", mrs.messages.LaserScan, complain)
    with pytest.raises(RuntimeError, match="too dark") as caught:
        sim.run_for(1.0)
    assert "complain" in [frame.name for frame in traceback.extract_tb(caught.value.__traceback__)]
    assert sim.time == pytest.approx(0.3)
    sim.run_for(0.7)
    assert (len(seen), sim.time) == (10, 1.0)


def test_a_callback_that_answers_itself_for_ever_is_an_error(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room)
    sim.subscribe("/cmd_vel", mrs.messages.Twist, lambda message: sim.publish("/cmd_vel", message))
    sim.publish("/cmd_vel", twist(1.0))
    with pytest.raises(RuntimeError, match="time stands still"):
        sim.run_for(1.0)


def test_a_callback_must_not_run_the_simulation(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room)
    sim.subscribe("/scan", mrs.messages.LaserScan, lambda scan: sim.run_for(1.0))
    with pytest.raises(RuntimeError, match="must not run"):
        sim.run_for(1.0)


def test_who_unsubscribes_gets_no_more(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room)
    seen: list[Any] = []
    subscription = sim.subscribe("/scan", mrs.messages.LaserScan, seen.append)
    sim.run_for(0.3)
    sim.unsubscribe(subscription)
    sim.unsubscribe(subscription)
    sim.run_for(0.3)
    assert len(seen) == 3


def test_a_node_of_ones_own(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room)
    node = sim.create_node("mine")
    publisher = node.create_publisher(mrs.messages.Twist, "/cmd_vel")
    node.create_timer(0.1, lambda: publisher.publish(twist(1.0)))
    sim.run_for(2.0)
    assert sim.pose.x == pytest.approx(1.9, abs=1e-12)


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (
            lambda sim: sim.subscribe("/scam", mrs.messages.LaserScan, print),
            ValueError,
            "unknown topic '/scam'; did you mean /scan",
        ),
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
        (lambda sim: sim.publish("/cmd_vel", (1.0, 0.0)), TypeError, "message class"),
        (lambda sim: sim.run_for(-1.0), ValueError, "at least 0 s, got -1.0"),
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


def test_a_callback_that_is_none_is_refused_at_once(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room)
    with pytest.raises(TypeError, match="callback"):
        sim.subscribe("/scan", mrs.messages.LaserScan, None)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ({"parameters": {"laser_beams": 5}}, ValueError, "unknown parameter 'laser_beams'; did you mean 'laser_beam_count'"),
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


def test_the_seed_comes_before_the_parameter(room: mrs.OccupancyGrid) -> None:
    for seed in (0, 5):
        assert mrs.Simulation(room, seed=seed, parameters={"seed": 6}).laser.parameters.seed == seed
    assert mrs.Simulation(room, parameters={"seed": 6}).laser.parameters.seed == 6


@pytest.mark.parametrize(("options", "blocks"), [({}, False), ({"unknown": "occupied"}, True), ({"unknown": "free"}, False)])
@pytest.mark.parametrize("grid_says", ["free", "occupied"])
def test_the_parameter_unknown_comes_before_the_grids(options: dict[str, str], blocks: bool, grid_says: str) -> None:
    cells = np.full((10, 40), -1, np.int8)
    cells[:, :20] = 0
    grid = mrs.OccupancyGrid(cells, resolution=0.1, unknown=grid_says)
    sim = mrs.Simulation(grid, start=(0.5, 0.5, 0.0), parameters={"laser_beam_count": 1, "apply_noise": False, **options})
    sim.run_for(0.1)
    blocks = blocks if options else grid_says == "occupied"
    assert sim.latest("/scan").ranges[0] == (1.5 if blocks else math.inf)


def test_the_grids_threshold_holds() -> None:
    cells = np.zeros((10, 40), np.int8)
    cells[:, 20] = 30
    for threshold, expected in ((30, 1.5), (31, math.inf)):
        grid = mrs.OccupancyGrid(cells, resolution=0.1, occupied_threshold=threshold)
        sim = mrs.Simulation(grid, start=(0.5, 0.5, 0.0), parameters={"laser_beam_count": 1, "apply_noise": False})
        sim.run_for(0.1)
        assert sim.latest("/scan").ranges[0] == expected


def test_stamped_commands_if_asked_for(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room, parameters={"cmd_vel_stamped": True})
    sim.publish("/cmd_vel", mrs.messages.TwistStamped(twist=twist(1.0)))
    sim.run_for(1.0)
    assert sim.pose.x == 0.5


def test_ten_minutes_take_no_time(room: mrs.OccupancyGrid) -> None:
    """6000 scans and as many transforms: nothing waits."""
    sim = mrs.Simulation(room, parameters={"laser_beam_count": 31})
    sim.run_for(600.0)
    assert sim.latest("/scan").header.stamp == mrs.messages.Time(600, 0)


def test_the_picture_is_of_all_robots_and_of_the_scan_where_it_was_taken(
    room: mrs.OccupancyGrid, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: dict[str, Any] = {}
    monkeypatch.setattr(plotting, "plot_drive", lambda file, grid, path, **how: drawn.update(how, path=path))
    robots = {"one": (0.0, 0.0, 0.0), "two": (0.0, 3.0, 0.0), "three": (0.0, -3.0, 0.0)}
    parameters = {"velocity_timeout": 0, "laser_frame_id": "laser", "laser_mount": (0.2, 0.0, 0.0), "apply_noise": False}
    sim = mrs.Simulation(room, robots=robots, parameters=parameters)
    box = sim.add_obstacle(mrs.Shape.rectangle(1.0, 1.0), (-5.0, 0.0, 0.0))
    for name, speed in (("one", 1.0), ("two", 0.5)):
        sim.publish(f"/{name}/cmd_vel", twist(speed))
    sim.run_for(2.05)
    sim.draw(tmp_path / "drive.png")
    assert drawn["path"][-1] == pytest.approx([2.05, 0.0, 0.0]) and list(drawn["others"]) == ["two", "three"]
    assert drawn["others"]["two"][-1] == pytest.approx([1.025, 3.0, 0.0])
    assert drawn["shapes"][0] == (box.shape, mrs.Pose(-5.0, 0.0, 0.0)) and len(drawn["shapes"]) == 4
    assert tuple(drawn["laser_pose"]) == pytest.approx((2.2, 0.0, 0.0))
    assert drawn["scan_points"][:, 0].max() == pytest.approx(9.9)  # the wall


def test_a_simulation_that_has_seen_nothing_can_be_drawn(room: mrs.OccupancyGrid, tmp_path: Path) -> None:
    mrs.Simulation(room).draw(tmp_path / "new" / "drive.png")
    assert (tmp_path / "new" / "drive.png").exists()
