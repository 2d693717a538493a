"""MobileRobotSimulator: exact motion from commands, and the times and contents of what it publishes."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import messages
from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.node import NoCopyNode
from mobile_robot_simulator.nodes.interface import QoS
from mobile_robot_simulator.nodes.map_messages import to_message
from mobile_robot_simulator.parameters import LaserParameters, RobotParameters
from mobile_robot_simulator.physics.world import World
from robot_rigs import Rig, close, twist

SECOND = 1_000_000_000
PI = math.pi


# --- motion -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("velocity", "seconds", "expected"),
    [
        ((1.0, 0.0, 0.0), 3.0, (3.0, 0.0, 0.0)),
        ((0.0, -0.5, 0.0), 2.0, (0.0, -1.0, 0.0)),
        ((1.0, 0.0, 1.0), PI / 2, (1.0, 1.0, PI / 2)),
        ((1.0, 0.0, -1.0), PI / 2, (1.0, -1.0, -PI / 2)),
        ((1.0, 0.0, 1.0), 2 * PI, (0.0, 0.0, 0.0)),
        ((0.5, 0.0, 0.25), 4 * PI, (0.0, 4.0, PI)),
        ((0.0, 0.0, 1.0), 4.0, (0.0, 0.0, 4.0 - 2 * PI)),
        ((1.0, 0.0, 1e-9), 2.0, (2.0, 2e-9, 2e-9)),
    ],
)
def test_arcs_are_exact(velocity: tuple[float, float, float], seconds: float, expected: tuple[float, float, float]) -> None:
    rig = Rig()
    rig.drive(seconds, *velocity)
    # The duration is rounded to nanoseconds.
    assert (rig.robot.pose.x, rig.robot.pose.y) == pytest.approx(expected[:2], abs=2e-9)
    assert math.remainder(rig.robot.pose.yaw - expected[2], 2 * PI) == pytest.approx(0.0, abs=2e-9)


@pytest.mark.parametrize("rate", [1.0, 3.0, 10.0, 33.0, 100.0])
def test_the_pose_does_not_depend_on_the_publishing_rate(rate: float) -> None:
    reference, rig = Rig(publish_rate=0.1), Rig(publish_rate=rate)
    for each in (reference, rig):
        each.drive(1.7, 0.8, 0.1, 0.6)
        each.drive(3.1, 0.2, 0.0, -1.3, every=0.37)
    assert tuple(rig.robot.pose) == tuple(reference.robot.pose)


def test_the_yaw_stays_wrapped() -> None:
    rig = Rig()
    rig.drive(20.0, 0.0, 0.0, 1.0)
    for odometry in rig.all("/odom"):
        assert -PI <= odometry.pose.pose.to_planar().yaw <= PI
    assert -PI < rig.robot.pose.yaw <= PI


def test_a_command_holds_until_its_timeout() -> None:
    rig = Rig(publish_rate=100.0)
    rig.run_to(1.0)
    rig.command(1.0)
    rig.run_to(1.499_999_999)
    assert rig.robot.velocity == (1.0, 0.0, 0.0)
    assert rig.robot.pose.x == pytest.approx(0.499_999_999, abs=1e-15)
    rig.run_to(1.5)
    assert rig.robot.velocity == (0.0, 0.0, 0.0)
    assert rig.robot.pose.x == 0.5
    rig.run_to(5.0)
    assert rig.robot.pose.x == 0.5
    moving = [message for message in rig.all("/odom") if message.twist.twist != twist()]
    assert [moving[0].header.stamp.nanoseconds, moving[-1].header.stamp.nanoseconds] == [1_010_000_000, 1_490_000_000]
    assert rig.all("/odom")[-1].pose.pose.position.x == 0.5


@pytest.mark.parametrize(
    ("timeout", "distance"), [(0.25, 0.25), (2.0, 2.0), (0.333, 0.333), (1e-9, 1e-9), (1e300, 60.0), (0.0, 60.0)]
)
def test_the_timeout_is_a_parameter(timeout: float, distance: float) -> None:
    """0 disables the timeout, as in ros2_controllers."""
    rig = Rig(velocity_timeout=timeout, publish_rate=1.0)
    rig.command(1.0)
    rig.run_to(60.0)
    assert rig.robot.pose.x == pytest.approx(distance, rel=1e-12)


def test_a_new_command_replaces_the_last_at_once() -> None:
    rig = Rig()
    rig.command(1.0)
    rig.run_to(0.3)
    rig.command(0.0, 2.0)
    rig.run_to(0.4)
    close(rig.robot.pose, 0.3, 0.2, 0.0)
    rig.command()
    rig.run_to(0.45)
    assert rig.robot.velocity == (0.0, 0.0, 0.0)
    close(rig.robot.pose, 0.3, 0.2, 0.0)


def test_other_axes_of_a_command_are_ignored() -> None:
    rig = Rig()
    message = mrs.messages.Twist(mrs.messages.Vector3(1.0, 0.0, 9.0), mrs.messages.Vector3(9.0, 9.0, 0.0))
    rig.node.create_publisher(mrs.messages.Twist, "/cmd_vel").publish(message)
    rig.run_to(0.5)
    close(rig.robot.pose, 0.5, 0.0, 0.0)


def test_stamped_commands_are_taken_if_the_parameter_is_set() -> None:
    rig = Rig(cmd_vel_stamped=True)
    with pytest.raises(TypeError, match="TwistStamped"):
        rig.command(1.0)
    rig.node.create_publisher(mrs.messages.TwistStamped, "/cmd_vel").publish(
        mrs.messages.TwistStamped(twist=twist(1.0, 0.0, 1.0))
    )
    rig.run_to(0.5)
    close(rig.robot.pose, math.sin(0.5), 1.0 - math.cos(0.5), 0.5)


@pytest.mark.parametrize("stamped", [False, True])
@pytest.mark.parametrize(
    "bad",
    [
        twist(math.nan),
        twist(0.0, math.inf),
        twist(0.0, 0.0, -math.inf),
        twist(1e300),
        twist(0.0, -1e12),
        twist(0.0, 0.0, 1e300),
    ],
)
def test_commands_that_are_too_large_or_not_finite_are_refused_with_a_warning(
    caplog: pytest.LogCaptureFixture, stamped: bool, bad: mrs.messages.Twist
) -> None:
    rig = Rig(cmd_vel_stamped=stamped)
    wrap: Callable[[mrs.messages.Twist], Any] = (
        (lambda message: mrs.messages.TwistStamped(twist=message)) if stamped else (lambda message: message)
    )
    publisher = rig.node.create_publisher(mrs.messages.TwistStamped if stamped else mrs.messages.Twist, "/cmd_vel")
    publisher.publish(wrap(twist(1.0)))
    rig.run_to(0.2)
    assert not caplog.records
    publisher.publish(wrap(bad))
    rig.run_to(0.3)
    (record,) = caplog.records
    assert record.levelname == "WARNING" and "velocity" in record.getMessage()
    # The valid command before it still holds until its own timeout.
    assert rig.robot.velocity == (1.0, 0.0, 0.0)
    rig.run_to(2.0)
    close(rig.robot.pose, 0.5, 0.0, 0.0)


# --- set_pose and initialpose -----------------------------------------------------------------------------------------


def test_an_initial_pose_changes_the_map_transform_but_not_the_odometry() -> None:
    rig = Rig(publish_map_transform=True)
    rig.command(1.0, 0.0, 0.5)
    rig.run_to(0.3)
    before = mrs.Pose().integrate((1.0, 0.0, 0.5), 0.3)
    rig.place(5.0, -2.0, 2.0)
    rig.run_to(0.3)
    close(rig.robot.pose, 5.0, -2.0, 2.0)
    rig.run_to(0.4)
    odom_from_base = before.integrate((1.0, 0.0, 0.5), 0.1)
    close(rig.all("/odom")[-1].pose.pose.to_planar(), *odom_from_base)
    links = {transform.child_frame_id: transform.transform.to_planar() for transform in rig.all("/tf")[-1].transforms}
    close(links["odom"] * links["base_link"], *mrs.Pose(5.0, -2.0, 2.0).integrate((1.0, 0.0, 0.5), 0.1))


def test_without_the_map_transform_initialpose_is_not_subscribed() -> None:
    rig = Rig()
    assert "/initialpose" not in rig.bus.topic_names()


def test_the_initial_pose_is_where_the_robot_starts_and_where_a_reset_puts_it() -> None:
    rig = Rig(initial_pose=(1.0, 2.0, 0.5), publish_map_transform=True)
    rig.drive(1.0, 1.0)
    assert rig.robot.pose != mrs.Pose(1.0, 2.0, 0.5)
    rig.robot.reset()
    assert rig.robot.pose == mrs.Pose(1.0, 2.0, 0.5)
    rig.robot.set_parameters(initial_pose=(3.0, 2.0, 0.5))
    assert rig.robot.pose == mrs.Pose(1.0, 2.0, 0.5)
    rig.robot.reset()
    assert rig.robot.pose == mrs.Pose(3.0, 2.0, 0.5)


@pytest.mark.parametrize("map_transform", [False, True])
def test_set_pose_does_not_prolong_a_command(map_transform: bool) -> None:
    """A command holds until the next one or until its timeout."""
    rig = Rig(publish_map_transform=map_transform)
    rig.command(1.0)
    rig.run_to(0.4)
    rig.robot.set_pose(mrs.Pose(10.0, 0.0, 0.0))
    rig.run_to(2.0)
    close(rig.robot.pose, 10.1, 0.0, 0.0)


@pytest.mark.parametrize("frame", ["", "map", "/map"])
def test_an_initial_pose_is_in_the_map_frame(frame: str) -> None:
    rig = Rig(publish_map_transform=True)
    rig.place(1.0, 2.0, 0.5, frame)
    rig.run_to(0.1)
    close(rig.robot.pose, 1.0, 2.0, 0.5)


def test_an_initial_pose_in_another_frame_is_refused(caplog: pytest.LogCaptureFixture) -> None:
    rig = Rig(publish_map_transform=True)
    rig.place(1.0, 2.0, 0.5, "odom")
    rig.run_to(0.1)
    close(rig.robot.pose, 0.0, 0.0, 0.0)
    assert [record.levelname for record in caplog.records] == ["WARNING"]
    assert "map, got odom" in caplog.text


@pytest.mark.parametrize(
    ("part", "axis", "value"),
    [
        ("position", "x", math.nan),
        ("position", "y", math.inf),
        ("orientation", "z", math.nan),
        ("orientation", "w", math.inf),
        ("orientation", "w", 0.0),
    ],
)
def test_an_invalid_initial_pose_is_refused(caplog: pytest.LogCaptureFixture, part: str, axis: str, value: float) -> None:
    """In the last case the quaternion has length zero."""
    rig = Rig(publish_map_transform=True, start_pose=mrs.Pose(1.0, 2.0, 0.5))
    message = mrs.messages.PoseWithCovarianceStamped(mrs.messages.Header(frame_id="map"))
    setattr(getattr(message.pose.pose, part), axis, value)
    rig.node.create_publisher(mrs.messages.PoseWithCovarianceStamped, "/initialpose").publish(message)
    rig.run_to(0.1)
    assert [record.levelname for record in caplog.records] == ["WARNING"]
    close(rig.robot.pose, 1.0, 2.0, 0.5)


# --- start and stop ---------------------------------------------------------------------------------------------------


def test_nothing_is_published_before_the_start() -> None:
    rig = Rig(started=False)
    rig.command(1.0)
    rig.run_to(2.0)
    assert [topic for topic, _, _ in rig.sent] == ["/cmd_vel"]
    close(rig.robot.pose, 0.0, 0.0, 0.0)


def test_a_stopped_robot_stands_still_and_publishes_nothing() -> None:
    rig = Rig(velocity_timeout=0.0)
    rig.command(1.0)
    rig.run_to(1.0)
    rig.robot.stop()
    count = len(rig.sent)
    rig.run_to(2.0)
    rig.command(1.0)
    rig.run_to(3.0)
    close(rig.robot.pose, 1.0, 0.0, 0.0)
    assert rig.robot.velocity == (0.0, 0.0, 0.0)
    assert [topic for topic, _, _ in rig.sent[count:]] == ["/cmd_vel"]


def test_a_restarted_robot_continues_from_its_pose() -> None:
    rig = Rig()
    rig.drive(1.0, 1.0)
    rig.robot.stop()
    rig.run_to(2.0)
    rig.robot.start()
    rig.run_to(2.5)
    close(rig.robot.pose, 1.0, 0.0, 0.0)
    rig.drive(3.0, 0.0, 1.0)
    close(rig.robot.pose, 1.0, 0.5, 0.0)
    stamps = [message.header.stamp.nanoseconds for message in rig.all("/odom")]
    assert stamps == [count * SECOND // 10 for count in [*range(1, 11), *range(21, 31)]]


def test_a_change_that_fails_at_the_restart_changes_nothing() -> None:
    rig = Rig()
    rig.command(1.0)
    rig.run_to(0.1)
    before, limits = rig.robot.parameters, {"velocity_limits": (0.1, 0.1, 0.1)}
    motion = rig.robot.motion
    with pytest.raises(TypeError, match=r"/cmd_vel carries Twist, got Odometry"):
        rig.robot.set_parameters(odometry_topic="/cmd_vel", velocity_timeout=9.0, robot_radius=0.2, **limits)
    assert rig.robot.parameters is before
    assert rig.robot.footprint is None and rig.robot.motion is motion
    rig.run_to(3.0)
    close(rig.robot.pose, 0.5, 0.0, 0.0)  # with the timeout of 0.5 s


def test_start_and_stop_may_be_called_twice() -> None:
    rig = Rig()
    rig.robot.start()
    rig.run_to(0.1)
    assert len(rig.all("/odom")) == 1
    rig.robot.stop()
    rig.robot.stop()
    rig.robot.start()
    rig.run_to(0.2)
    assert len(rig.all("/odom")) == 2
    assert len(rig.bus.topic("/cmd_vel", mrs.messages.Twist).subscriptions) == 1


def test_the_same_run_twice_gives_equal_messages() -> None:
    def drive() -> list[tuple[str, Any, int]]:
        rig = Rig(publish_map_transform=True)
        rig.drive(1.3, 0.8, 0.1, 0.6)
        rig.place(1.0, 2.0, 3.0)
        rig.drive(3.0, -0.2, 0.0, -1.3, every=0.4)
        return rig.sent

    assert drive() == drive()


# --- parameters and services in a simulation --------------------------------------------------------------------------

FORWARD = mrs.messages.Twist(linear=mrs.messages.Vector3(x=1.0))


def hall(side: int = 100) -> mrs.OccupancyGrid:
    cells = np.zeros((side, side), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    return mrs.OccupancyGrid(cells, resolution=0.1, origin=(-side / 20, -side / 20, 0.0))


def simulation(**parameters: Any) -> mrs.Simulation:
    return mrs.Simulation(hall(), parameters={"apply_noise": False, "laser_beam_count": 5, **parameters})


def call(sim: mrs.Simulation, service: Any, name: str, request: Any) -> Any:
    future = sim.create_node("client").create_client(service, name).call_async(request)
    sim.run_for(0.0)
    return future.result()


@pytest.mark.parametrize(("timeout", "moved"), [(2.0, 0.3 + 2.0), (0.1, 0.3 + 0.1)])
def test_a_new_timeout_applies_to_the_current_command_from_now(timeout: float, moved: float) -> None:
    sim = simulation()
    sim.publish("/cmd_vel", FORWARD)
    sim.run_for(0.3)
    sim.robot.set_parameters(velocity_timeout=timeout)
    assert sim.pose.x == pytest.approx(0.3)
    sim.run_for(3.0)
    assert sim.pose.x == pytest.approx(moved, abs=1e-12)


def test_a_new_timeout_does_not_revive_an_expired_command() -> None:
    sim = simulation()
    sim.publish("/cmd_vel", FORWARD)
    sim.run_for(1.0)
    sim.robot.set_parameters(velocity_timeout=10.0)
    sim.run_for(1.0)
    assert sim.pose.x == pytest.approx(0.5, abs=1e-12)


def test_rates_and_topics_change_at_once() -> None:
    sim = simulation(publish_rate=10.0)
    sim.run_for(1.0)
    sim.robot.set_parameters(publish_rate=50.0, odometry_topic="/moved")
    sim.laser.set_parameters(laser_beam_count=9, laser_topic="/front")
    counts = {"/moved": 0, "/odom": 0, "/front": 0}
    for topic, kind in (
        ("/moved", mrs.messages.Odometry),
        ("/odom", mrs.messages.Odometry),
        ("/front", mrs.messages.LaserScan),
    ):
        sim.subscribe(topic, kind, lambda _, topic=topic: counts.update({topic: counts[topic] + 1}))  # type: ignore[misc]
    sim.run_for(1.0)
    assert counts == {"/moved": 50, "/odom": 0, "/front": 10}
    assert len(sim.latest("/front").ranges) == 9


def test_reset_returns_to_the_start_pose() -> None:
    sim = mrs.Simulation(hall(), start=(1.0, 2.0, 0.5))
    sim.publish("/cmd_vel", FORWARD)
    sim.run_for(0.3)
    assert call(sim, messages.Trigger, "reset", messages.TriggerRequest()).success
    assert tuple(sim.pose) == (1.0, 2.0, 0.5)
    assert sim.robot.distance == 0.0
    sim.run_for(0.3)
    assert tuple(sim.pose) == (1.0, 2.0, 0.5)


def test_the_service_set_pose_moves_the_robot_or_refuses() -> None:
    sim = simulation()
    pose = messages.PoseWithCovariance(messages.Pose.from_planar(mrs.Pose(1.0, -2.0, 0.25)))
    for frame in ("somewhere", "map"):
        stamped = messages.PoseWithCovarianceStamped(messages.Header(frame_id=frame), pose)
        call(sim, messages.SetPose, "set_pose", messages.SetPoseRequest(stamped))
        assert tuple(sim.pose) == pytest.approx((1.0, -2.0, 0.25) if frame == "map" else (0.0, 0.0, 0.0))


def test_the_clock_can_have_its_own_rate_or_be_switched_off() -> None:
    sim = simulation(clock_rate=100.0)
    times: list[int] = []
    sim.subscribe("/clock", mrs.messages.Clock, lambda message: times.append(message.clock.nanoseconds))
    sim.run_for(1.0)
    assert len(times) == 100
    sim.robot.set_parameters(publish_clock=False)
    sim.run_for(1.0)
    assert len(times) == 100


@pytest.mark.parametrize("limits", [{}, {"velocity_limits": (1.0, 1.0, 1.0)}])
def test_a_robot_drives_on_after_a_jump_of_its_clock(limits: dict[str, Any]) -> None:
    rig = Rig(**limits)
    rig.drive(1.0, 0.5)
    for count, jump in enumerate((1_700_000_000, -1_700_003_600, 7_200), start=1):
        rig.bus.clock_offset_ns += jump * SECOND
        rig.drive(1.0 + count, 0.5)
        close(rig.robot.pose, 0.5 * (1 + count), 0.0, 0.0, 0.02)
    assert rig.all("/odom")[-1].twist.twist.linear.x == 0.5


# --- the map of a robot with a footprint ------------------------------------------------------------------------------


def field(wall: float) -> mrs.OccupancyGrid:
    """A map of 10 m around the origin with one wall, whose near side is at x = wall [m]."""
    cells = np.zeros((100, 100), np.int8)
    cells[:, round(10 * wall) + 50] = 100
    return mrs.OccupancyGrid(cells, resolution=0.1, origin=(-5.0, -5.0, 0.0))


def serve(rig: Rig, grid: mrs.OccupancyGrid, by: str = "both") -> None:
    """Offers a map by "topic", by "service" or by both."""
    topic, service = ("/map" if by != "service" else "/no_map"), ("/static_map" if by != "topic" else "/no_service")
    mrs.nodes.MapServer(NoCopyNode(rig.bus, "map_server"), grid, topic=topic, service=service).start()


@pytest.mark.parametrize("by", ["topic", "service"])
@pytest.mark.parametrize(
    ("footprint", "reach"), [({"robot_radius": 0.3}, 0.3), ({"footprint": "[[-0.5, -0.2], [0.4, -0.2], [0.4, 0.2]]"}, 0.4)]
)
def test_a_footprint_stops_at_a_wall_of_the_served_map(by: str, footprint: dict[str, Any], reach: float) -> None:
    rig = Rig(**footprint)
    serve(rig, field(1.0), by)
    rig.run_to(1.5)
    rig.drive(6.0, 0.5)
    assert rig.robot.pose.x == pytest.approx(1.0 - reach, abs=1e-6)
    assert [contact.what for contact in rig.robot.motion.contacts] == ["a wall"]
    assert rig.all("/odom")[-1].pose.pose.position.x == pytest.approx(1.0 - reach, abs=1e-6)


def test_a_robot_drives_the_same_path_with_a_served_map_as_in_a_simulation() -> None:
    values = {
        "robot_radius": 0.3,
        "contact": "slide",
        "acceleration_limits": (1.0, 1.0, 2.0),
        "publish_map_transform": True,
        "cmd_vel_stamped": False,
    }
    rig = Rig(**values)
    serve(rig, field(1.0))
    sim = mrs.Simulation(field(1.0), parameters=values)
    rig.run_to(0.1)
    sim.run_for(0.1)
    for wz in (0.2, 0.2, -0.5, 0.3) * 5:
        rig.command(0.6, 0.0, wz)
        sim.publish("/cmd_vel", twist(0.6, 0.0, wz))
        rig.run_to(sim.time + 0.4)
        sim.run_for(0.4)
    assert tuple(rig.robot.pose) == tuple(sim.pose)
    assert rig.robot.motion.contacts == list(sim.truth.contacts) != []


def test_a_footprint_waits_for_the_map_and_nothing_else_does() -> None:
    with_footprint, without = Rig(robot_radius=0.3), Rig(velocity_limits=(1.0, 1.0, 1.0))
    for rig in (with_footprint, without):
        rig.drive(1.0, 0.5)
    assert with_footprint.robot.pose.x == 0.0
    assert without.robot.pose.x == 0.5
    assert without.bus.find_topic("/map") is None
    serve(with_footprint, field(1.0))
    with_footprint.run_to(1.1)
    with_footprint.drive(1.6, 0.5)
    assert with_footprint.robot.pose.x == pytest.approx(0.25)


def test_a_changed_map_and_a_changed_footprint_apply_at_once() -> None:
    rig = Rig()
    serve(rig, field(1.0))
    rig.robot.set_parameters(robot_radius=0.3)
    rig.run_to(0.1)
    rig.drive(4.0, 0.5)
    assert rig.robot.pose.x == pytest.approx(0.7, abs=1e-6)
    rig.node.create_publisher(mrs.messages.OccupancyGrid, "/map", QoS.LATCHED).publish(to_message(field(2.0)))
    rig.run_to(4.1)
    rig.drive(8.0, 0.5)
    assert rig.robot.pose.x == pytest.approx(1.7, abs=1e-6)
    rig.robot.set_parameters(robot_radius=0.0)
    rig.drive(12.0, 0.5)
    assert rig.robot.pose.x == pytest.approx(1.7 + 2.0, abs=1e-6)


@pytest.mark.parametrize(("unknown", "x"), [("free", 1.5), ("occupied", 0.7)])
def test_a_footprint_collides_with_unknown_cells_if_they_are_occupied(unknown: str, x: float) -> None:
    cells = np.where(field(1.0).cells == 100, -1, 0).astype(np.int8)
    rig = Rig(robot_radius=0.3, unknown=unknown)
    serve(rig, mrs.OccupancyGrid(cells, resolution=0.1, origin=(-5.0, -5.0, 0.0)))
    rig.run_to(0.1)
    rig.drive(3.1, 0.5)
    assert rig.robot.pose.x == pytest.approx(x, abs=1e-6)


def test_a_map_with_a_wall_at_the_robot_is_warned_about(caplog: pytest.LogCaptureFixture) -> None:
    rig = Rig(robot_radius=0.3)
    serve(rig, field(0.0))
    rig.run_to(0.1)
    (warning,) = [record.message for record in caplog.records if record.levelname == "WARNING"]
    assert warning.startswith("the robot at (0.00, 0.00, 0.00) touches a wall of the map")


def test_robots_that_start_inside_one_another_can_part_and_then_touch() -> None:
    """On ROS, robots without `initial_pose` start at the origin, all of them."""
    bus = Bus()
    world = World(lambda: bus.time_ns, mrs.OccupancyGrid(np.zeros((100, 100), np.int8), resolution=0.1))
    values = {"robot_radius": 0.2, "initial_pose": (5.0, 5.0, 0.0), "velocity_timeout": 0.0, "cmd_vel_stamped": False}
    robots = {}
    for name in ("a", "b"):
        node = NoCopyNode(bus, "robot", namespace=f"/{name}")
        robots[name] = mrs.nodes.MobileRobotSimulator(node, RobotParameters.checked(values), world=world, name=name)
        robots[name].start()
    publisher = NoCopyNode(bus, "tester").create_publisher(mrs.messages.Twist, "/a/cmd_vel")
    publisher.publish(mrs.messages.Twist(linear=mrs.messages.Vector3(x=0.5)))
    bus.run_until(2 * SECOND)
    assert robots["a"].pose.x == pytest.approx(6.0) and robots["b"].pose == mrs.Pose(5.0, 5.0, 0.0)
    publisher.publish(mrs.messages.Twist(linear=mrs.messages.Vector3(x=-0.5)))
    bus.run_until(4 * SECOND)
    assert robots["a"].pose.x == pytest.approx(5.4, abs=1e-5)
    assert bus.latest("/a/stalled").data


def test_a_map_frame_may_have_the_slash_of_ros_1() -> None:
    bus = Bus()
    parameters = RobotParameters.checked(
        {"map_frame_id": "/map", "publish_map_transform": True, "initial_pose": (1.0, 2.0, 0.0)}
    )
    mrs.nodes.MobileRobotSimulator(NoCopyNode(bus, "robot"), parameters).start()
    laser = mrs.nodes.LaserScannerSimulator(
        NoCopyNode(bus, "laser"),
        LaserParameters.checked({"map_frame_id": "/map", "pose_source": "tf", "apply_noise": False}),
        grid=mrs.OccupancyGrid(np.zeros((50, 50), np.int8), resolution=0.1),
    )
    laser.start()
    pose = mrs.messages.PoseWithCovarianceStamped(mrs.messages.Header(frame_id="map"))
    bus.run_until(SECOND)
    assert bus.latest("/scan") is not None
    NoCopyNode(bus, "tester").create_publisher(mrs.messages.PoseWithCovarianceStamped, "/initialpose").publish(pose)
    bus.run_until(2 * SECOND)
    assert bus.latest("/tf").transforms[0].transform.translation.x == 0.0
