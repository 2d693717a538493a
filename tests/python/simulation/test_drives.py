"""drives: robots on wheels in a simulation, with their commands, joints, odometry, contact and snapshots."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.bus import BusNode
from mobile_robot_simulator.messages import AckermannDrive, AckermannDriveStamped, JointState
from simulations import SEED, drive, hall, simulation

DIFFERENTIAL: dict[str, Any] = {"drive": "differential", "track": 0.4, "wheel_radius": 0.1}
OMNI: dict[str, Any] = {"drive": "omni", "wheelbase": 0.4, "track": 0.3, "wheel_radius": 0.1}
CAR: dict[str, Any] = {
    "drive": "ackermann",
    "wheelbase": 0.5,
    "track": 0.4,
    "wheel_radius": 0.1,
    "steering_limit": 0.6,
    "steering_rate": 0.5,
}
START = mrs.Pose(2.0, 2.0, 0.0)


def steer(sim: mrs.Simulation, speed: float, angle: float, rate: float = 0.0, topic: str = "/ackermann_cmd") -> None:
    sim.publish(topic, AckermannDriveStamped(drive=AckermannDrive(angle, rate, speed)))


def close(left: mrs.Pose, right: mrs.Pose) -> bool:
    return tuple(left) == pytest.approx(tuple(right), abs=1e-12)


def test_a_differential_drive_ignores_sideways_commands() -> None:
    sim = simulation(**DIFFERENTIAL)
    drive(sim, 0.5, 0.3, vy=0.4)
    sim.run_for(2.0)
    assert sim.pose == START.integrate((0.5, 0.0, 0.3), 2.0)
    assert sim.truth.velocity == (0.5, 0.0, 0.3)


def test_an_omni_drive_moves_in_any_direction() -> None:
    sim = simulation(**OMNI)
    drive(sim, 0.5, 0.3, vy=0.4)
    sim.run_for(2.0)
    assert sim.pose == START.integrate((0.5, 0.4, 0.3), 2.0)


def test_wheels_that_cannot_turn_faster_slow_the_robot_down_on_its_path() -> None:
    sim = simulation(**DIFFERENTIAL, wheel_speed_limit=5.0)
    drive(sim, 1.0, 2.5)  # The right wheel would turn at 15 rad/s.
    sim.run_for(1.5)
    assert close(sim.pose, START.integrate((1.0, 0.0, 2.5), 0.5))


def test_a_car_takes_a_twist_as_a_curvature() -> None:
    sim = simulation(**CAR)
    drive(sim, 0.5, 0.25)  # A circle of radius 2 m: the angle is atan(0.25), reached after 0.49 s.
    sim.run_for(3.0)
    motion = mrs.WheelMotion(sim.robot.parameters.wheels, (0, 0, 0), (0.5, 0.0, 0.0), steering_goal=math.atan(0.25))
    assert close(sim.pose, motion.integrate(START, 3.0)) and sim.pose != START.integrate((0.5, 0.0, 0.25), 3.0)
    assert sim.truth.velocity == (0.5, 0.0, pytest.approx(0.25))
    # It cannot turn in place, and keeps its steering.
    drive(sim, 0.0, 1.0)
    before = sim.pose
    sim.run_for(1.0)
    assert sim.pose == before and sim.robot.motion.steering_at(0) == pytest.approx(0.0)
    drive(sim, 0.5, 0.25)
    sim.run_for(1.0)
    assert close(sim.pose, before.integrate((0.5, 0.0, 0.25), 1.0))


def test_a_car_takes_speed_and_steering_angle() -> None:
    sim = simulation(**CAR)
    steer(sim, 0.0, -0.4)  # It steers while it stands.
    sim.run_for(1.0)
    assert sim.pose == START
    steer(sim, -0.5, -0.4)
    sim.run_for(2.0)
    turn = -0.5 * math.tan(-0.4) / 0.5
    assert close(sim.pose, START.integrate((-0.5, 0.0, turn), 2.0))
    assert sim.truth.velocity == (-0.5, 0.0, pytest.approx(turn))
    # The rate of the command holds if it is below that of the car.
    steer(sim, 0.0, 0.0, rate=0.1)
    sim.run_for(1.0)
    assert sim.latest("/joint_states").velocity[4:] == pytest.approx([0.1, 0.1], rel=0.3)
    assert sim.robot.motion.steering_at(round(sim.time * 1e9)) == pytest.approx(-0.3)


def test_a_steering_command_that_is_no_number_is_refused() -> None:
    sim = simulation(**CAR)
    steer(sim, 0.5, 0.0)
    sim.run_for(0.5)
    steer(sim, math.nan, 0.0)
    steer(sim, 0.5, math.inf)
    sim.run_for(0.5)
    assert sim.pose == START.integrate((0.5, 0.0, 0.0), 1.0)


def test_only_a_car_has_a_topic_for_steering() -> None:
    with pytest.raises(ValueError, match="unknown topic '/ackermann_cmd'"):
        steer(simulation(**DIFFERENTIAL), 0.5, 0.1)
    with pytest.raises(ValueError, match="unknown topic '/joint_states'"):
        simulation().latest("/joint_states")


def test_joint_states_are_the_wheels_and_the_steering() -> None:
    sim = simulation(**DIFFERENTIAL)
    drive(sim, 0.5, 0.5)
    sim.run_for(2.0)
    joints = sim.latest("/joint_states")
    assert joints.name == ["left_wheel_joint", "right_wheel_joint"] and joints.header.stamp.sec == 2
    assert joints.position == pytest.approx([8.0, 12.0]) and joints.velocity == pytest.approx([4.0, 6.0])
    sim = simulation(**CAR)
    drive(sim, 0.5, 0.0)
    steer(sim, 0.5, 0.2)
    sim.run_for(2.0)
    joints, car = sim.latest("/joint_states"), sim.robot.parameters.wheels
    assert joints.name[0] == "front_left_wheel_joint" and joints.name[4:] == list(sim.robot.parameters.joints[4:])
    assert joints.position[4:].tolist() == car.steering_angles([0.2])[0].tolist() and not joints.velocity[4:].any()
    assert joints.velocity[:4] == pytest.approx(car.wheels_of_twist([sim.truth.velocity])[0])
    assert 0.1 * 0.5 * (joints.position[2] + joints.position[3]) == pytest.approx(1.0)
    assert 0.1 * (joints.position[3] - joints.position[2]) / 0.4 == pytest.approx(sim.pose.yaw)
    named = simulation(**DIFFERENTIAL, joint_names=["a", "b"])
    named.run_for(1.0)
    assert named.latest("/joint_states").name == ["a", "b"]


@pytest.mark.parametrize("kind", [DIFFERENTIAL, OMNI, CAR], ids=lambda kind: kind["drive"])
@pytest.mark.parametrize("limits", [None, [0.5, 0.5, 0.5]])
def test_a_footprint_changes_nothing_while_nothing_is_touched(kind: dict[str, Any], limits: list[float] | None) -> None:
    free = simulation(**kind, acceleration_limits=limits, wheel_speed_limit=9.0)
    footed = simulation(**kind, acceleration_limits=limits, wheel_speed_limit=9.0, robot_radius=0.2)
    for vx, wz in [(0.8, 0.5), (1.2, -0.9), (-0.4, 0.2), (0.0, 0.0)]:
        for sim in (free, footed):
            drive(sim, vx, wz)
            sim.run_for(0.73)
        assert free.pose == footed.pose
        np.testing.assert_array_equal(free.latest("/joint_states").position, footed.latest("/joint_states").position)
    assert free.truth.distance == footed.truth.distance > 1.0


def test_a_car_stalls_at_a_wall_and_steers_there() -> None:
    sim = simulation((2.0, 2.0, math.pi), **CAR, robot_radius=0.3, contact_topic="contacts", stalled_topic="stalled")
    drive(sim, 1.0)
    sim.run_for(3.0)
    assert sim.latest("/stalled").data and sim.pose.x == pytest.approx(0.4, abs=1e-5)
    assert sim.latest("/contacts").point.x == pytest.approx(0.1, abs=1e-5)
    standing = sim.latest("/joint_states")
    assert standing.velocity[:4].tolist() == [0.0] * 4
    # Its wheels have turned for the way that it has driven.
    assert 0.1 * standing.position[2] == pytest.approx(1.6, abs=1e-4)
    steer(sim, 1.0, 0.4)
    sim.run_for(1.0)
    assert sim.latest("/stalled").data
    assert sim.latest("/joint_states").position[4] > 0.4 > sim.latest("/joint_states").position[5] > 0.2
    before = sim.pose
    steer(sim, -0.5, 0.4)
    sim.run_for(1.0)
    assert not sim.latest("/stalled").data
    assert tuple(sim.pose) == pytest.approx(tuple(before.integrate((-0.5, 0.0, -math.tan(0.4)), 1.0)), abs=1e-5)


def test_odometry_comes_from_the_wheels_if_they_are_wrong() -> None:
    sim = simulation(**DIFFERENTIAL, track_multiplier=1.25, publish_map_transform=False)
    drive(sim, 0.5, 0.5)
    sim.run_for(4.0)
    odometry = sim.latest("/odom")
    assert close(odometry.pose.pose.to_planar(), START.integrate((0.5, 0.0, 0.4), 4.0))
    assert odometry.twist.twist.angular.z == pytest.approx(0.4) and close(sim.pose, START.integrate((0.5, 0.0, 0.5), 4.0))
    # map -> odom corrects what the wheels get wrong.
    sim = simulation(**DIFFERENTIAL, track_multiplier=1.25)
    drive(sim, 0.5, 0.5)
    sim.run_for(4.0)
    links = {link.child_frame_id: link.transform.to_planar() for link in sim.latest("/tf").transforms}
    assert tuple(links["odom"] * links["base_link"]) == pytest.approx(tuple(sim.pose), abs=1e-12)


def test_slipping_wheels_turn_and_the_odometry_counts_them() -> None:
    sim = simulation(**DIFFERENTIAL, wheel_slip=0.5, encoder_ticks=1024, publish_map_transform=False)
    drive(sim, 0.5)
    sim.run_for(4.0)
    assert sim.pose.x == pytest.approx(3.0) and sim.latest("/joint_states").position.tolist() == pytest.approx([20.0, 20.0])
    count = 0.1 * 2.0 * math.pi / 1024
    assert 0.0 <= 4.0 - sim.latest("/odom").pose.pose.position.x < count


def test_a_change_of_calibration_goes_on_from_what_the_robot_believes() -> None:
    sim = simulation(**DIFFERENTIAL, publish_map_transform=False)
    drive(sim, 0.5)
    sim.run_for(1.0)
    sim.robot.set_parameters(left_wheel_radius_multiplier=1.2, right_wheel_radius_multiplier=1.2)
    sim.run_for(1.0)
    assert sim.latest("/odom").pose.pose.position.x == pytest.approx(2.0 + 0.5 + 0.6)
    sim.robot.set_parameters(**CAR)  # It stands until the next command.
    sim.run_for(1.0)
    assert sim.pose.x == pytest.approx(3.0)
    steer(sim, 0.5, 0.0)
    sim.run_for(1.0)
    assert sim.pose.x == pytest.approx(3.5) and len(sim.latest("/joint_states").name) == 6
    sim.robot.set_parameters(steering_limit=0.3)
    steer(sim, 0.0, 0.6)
    sim.run_for(2.0)
    assert sim.robot.motion.steering_at(round(sim.time * 1e9)) == 0.3
    sim.robot.set_parameters(drive="planar")
    sim.run_for(0.5)
    assert sim.pose.x == pytest.approx(3.5)


def test_a_restored_simulation_goes_on_as_before() -> None:
    sim = simulation(**CAR, robot_radius=0.2, encoder_ticks=256, acceleration_limits=[0.5, 0.5, 0.5])
    drive(sim, 0.8, 0.3)
    sim.run_for(1.234)
    saved = sim.save()
    ends = []
    for _ in range(2):
        steer(sim, 0.4, -0.3)
        sim.run_for(2.0)
        ends.append((sim.pose, sim.latest("/odom"), sim.latest("/joint_states")))
        sim.restore(saved)
    assert ends[0] == ends[1]


def test_cars_of_several_robots_have_topics_of_their_own() -> None:
    robots = {"a": (5.0, 5.0, 0.0), "b": (9.0, 5.0, 0.0)}
    sim = mrs.Simulation(hall(), parameters={**CAR, "velocity_timeout": 0}, seed=SEED, robots=robots)
    steer(sim, 0.5, 0.0, topic="/a/ackermann_cmd")
    sim.run_for(1.0)
    assert (sim.robots["a"].pose.x, sim.robots["b"].pose.x) == (5.5, 9.0)
    assert sim.latest("/a/joint_states").position[0] == pytest.approx(5.0)


def test_what_a_drive_needs_must_be_given() -> None:
    with pytest.raises(ValueError, match="track must be given for the drive differential, got none"):
        simulation(drive="differential", wheel_radius=0.1)
    with pytest.raises(ValueError, match="wheelbase must be given for the drive ackermann, got none"):
        simulation(drive="ackermann", track=0.3, wheel_radius=0.1)
    with pytest.raises(ValueError, match="joint_names must be 2 names for the drive differential, got "):
        simulation(**DIFFERENTIAL, joint_names=["a"])
    with pytest.raises(ValueError, match="drive must be "):
        simulation(drive="tracks")


def test_where_ackermann_msgs_is_not_installed_a_car_takes_twists(monkeypatch: pytest.MonkeyPatch) -> None:
    subscribe = BusNode.create_subscription

    def create_subscription(self: BusNode, msg_type: Any, *arguments: Any) -> Any:
        if msg_type is AckermannDriveStamped:
            raise ImportError
        return subscribe(self, msg_type, *arguments)

    monkeypatch.setattr(BusNode, "create_subscription", create_subscription)
    sim = simulation(**CAR)
    drive(sim, 0.5)
    sim.run_for(1.0)
    assert sim.pose.x == 2.5


@pytest.mark.parametrize("format", ["mcap", "bag"])
def test_commands_and_joints_can_be_recorded(tmp_path: Path, format: Any) -> None:
    pytest.importorskip("rosbags", reason="the extra `recording` is not installed")
    from mobile_robot_simulator.recording import Recorder
    from mobile_robot_simulator.recording.bag import Bag

    sim = simulation(**CAR)
    with Recorder(tmp_path / "drive", format=format) as recorder:
        sim.record(recorder.write)
        steer(sim, 0.5, 0.25)
        sim.run_for(1.0)
    types = [AckermannDriveStamped.ros_type, JointState.ros_type]
    read = [message.content for message in Bag(recorder.path).messages(types)]
    assert len(read) == 11
    assert (read[0].drive.speed, read[0].drive.steering_angle) == (0.5, 0.25)
    assert list(read[-1].name) == list(sim.robot.parameters.joints)
    assert read[-1].position.tolist() == sim.latest("/joint_states").position.tolist()
