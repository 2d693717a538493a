"""Generated messages: every definition gives a class that can be sent, copied and recorded, and checks what it is given."""

from __future__ import annotations

import copy
import sys

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.messages import copied
from mobile_robot_simulator.recording.serialization import to_ros2_bytes
from mobile_robot_simulator.testing import stand_in
from mobile_robot_simulator.testing.ros_messages import generated_packages, register_definitions
from simulations import small_room

with stand_in(
    {
        "test_msgs_of_ours/msg/Speeds": "float64 left\nfloat64 right\nuint8 FAST=3",
        "test_msgs_of_ours/srv/Ask": "string a\n---\nbool b",
    }
):
    from diagnostic_msgs.msg import DiagnosticStatus
    from geometry_msgs.msg import Pose, PoseArray, PoseStamped, TwistWithCovarianceStamped
    from nav_msgs.msg import Path
    from sensor_msgs.msg import Image, Imu, LaserScan
    from std_msgs.msg import Bool, Float64, Header
    from std_srvs.srv import Empty, SetBool
    from test_msgs_of_ours.msg import Speeds
    from test_msgs_of_ours.srv import Ask
    from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint
    from visualization_msgs.msg import Marker, MarkerArray

MESSAGES = [
    kind for module, names in sorted(generated_packages().items()) if module.endswith(".msg") for kind in names.values()
]


@pytest.mark.parametrize("kind", MESSAGES, ids=lambda kind: kind.ros_type)
def test_the_default_of_every_message_can_be_copied_and_recorded(kind):
    message = kind()
    assert copied(message) == message == copy.deepcopy(message)
    assert len(to_ros2_bytes(message)) >= 4


def test_the_fields_are_those_of_the_ros_definition():
    assert JointTrajectory.get_fields_and_field_types() == {
        "header": "std_msgs/Header",
        "joint_names": "sequence<string>",
        "points": "sequence<trajectory_msgs/JointTrajectoryPoint>",
    }
    assert JointTrajectoryPoint.get_fields_and_field_types()["velocities"] == "sequence<double>"
    assert Imu.get_fields_and_field_types()["angular_velocity_covariance"] == "double[9]"
    assert (Marker.ARROW, Marker.LINE_STRIP, Marker.DELETEALL, Speeds.FAST) == (0, 4, 3, 3)


def test_the_classes_of_the_nodes_are_the_fields_of_generated_classes():
    pose = PoseStamped(header=Header(frame_id="map"), pose=Pose())
    assert (Pose, Header, LaserScan) == (mrs.messages.Pose, mrs.messages.Header, mrs.messages.LaserScan)
    assert pose.pose.orientation.w == 1.0 and PoseStamped().pose is not PoseStamped().pose


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: SetBool.Request(data=1), r"SetBool_Request\.data must be a bool, got 1"),
        (lambda: Float64(data=1), r"Float64\.data must be a float, got 1"),
        (
            lambda: TwistWithCovarianceStamped(twist=PoseStamped()),
            r"TwistWithCovarianceStamped\.twist must be a TwistWithCovariance, got PoseStamped",
        ),
        (lambda: Path(poses=[Pose()]), r"Path\.poses\[\] must be a PoseStamped, got Pose"),
        (lambda: JointTrajectory(joint_names="abc"), r"JointTrajectory\.joint_names must be a list, got 'abc'"),
        (
            lambda: JointTrajectoryPoint(positions=["a"]),
            r"JointTrajectoryPoint\.positions must be a sequence of float64, got \['a'\]",
        ),
        (lambda: JointTrajectoryPoint(positions=[[1.0], [2.0, 3.0]]), r"must be a sequence of float64"),
        (lambda: Image(data=[256]), r"Image\.data must be a sequence of uint8, got \[256\]"),
        (lambda: Image(height=-1), r"Image\.height must be between 0 and 4294967295, got -1"),
        (lambda: Imu(orientation_covariance=[1.0]), r"must be of length 9, got 1"),
    ],
)
def test_a_value_of_the_wrong_type_is_refused_as_in_rclpy(make, message):
    with pytest.raises(AssertionError, match=message):
        make()


def test_an_unknown_field_is_refused():
    with pytest.raises(TypeError, match="speed"):
        Bool(speed=1.0)
    with pytest.raises(AttributeError, match="speed"):
        Bool().speed = 1.0


def test_sequences_become_arrays_and_bytes_become_numbers():
    assert JointTrajectoryPoint(positions=(1, 2)).positions.dtype == np.float64
    assert Image(data=b"\x00\xff").data.tolist() == [0, 255]
    assert DiagnosticStatus(level=b"\x02").level == DiagnosticStatus.ERROR


@pytest.mark.parametrize("message", [PoseArray(poses=[Pose()]), MarkerArray(markers=[Marker(id=7)]), Speeds(left=0.5)])
def test_a_node_receives_what_another_sends(message):
    sim, seen = small_room(), []
    node = sim.create_node("talker")
    node.create_subscription(type(message), "topic", seen.append, 10)
    node.create_publisher(type(message), "topic", 10).publish(message)
    sim.run_for(0.1)
    assert seen == [message] and seen[0] is not message


def test_a_service_of_a_generated_type_answers():
    def answer(request, response):
        response.success, response.message = request.data, "ok"
        return response

    sim = small_room()
    node = sim.create_node("clerk")
    node.create_service(SetBool, "switch", answer)
    future = node.create_client(SetBool, "switch").call_async(SetBool.Request(data=True))
    sim.run_for(0.1)
    assert future.result() == SetBool.Response(success=True, message="ok")
    assert Empty.Request() == Empty.Request() and Ask.Request(a="x").a == "x" and Ask.Response().b is False


@pytest.mark.parametrize(
    ("definitions", "message"),
    [
        ({"Speeds": "float64 left"}, "a ROS type is package/msg/Name"),
        ({"test_msgs_of_ours/msg/Speeds": "float64 other"}, "already has another definition"),
        ({"std_msgs/msg/Bool": "bool data"}, "common type"),
        ({"test_msgs_of_ours/msg/Bad": "float64 3x"}, "wrong definition of test_msgs_of_ours/msg/Bad"),
        ({"test_msgs_of_ours/msg/Lost": "test_msgs_of_ours/Nowhere x"}, "test_msgs_of_ours/msg/Nowhere has no definition"),
        ({"test_msgs_of_ours/srv/Half": "float64 x"}, "must have lines '---' between Request, Response, got 1"),
        ({"test_msgs_of_ours/action/Half": "---"}, "must have lines '---' between Goal, Result, Feedback, got 2 parts"),
        ({"test_msgs_of_ours/action/Bad": "---\n---\nNowhere x"}, "test_msgs_of_ours/msg/Nowhere has no definition"),
    ],
)
def test_a_wrong_definition_is_refused(definitions, message):
    with pytest.raises(ValueError, match=message):
        register_definitions(definitions)


def test_without_rosbags_the_simulators_own_messages_are_left(monkeypatch):
    monkeypatch.setitem(sys.modules, "mobile_robot_simulator.recording.serialization", None)
    assert generated_packages() == {}
    with stand_in():
        from geometry_msgs.msg import Twist

        with pytest.raises(ImportError, match="has no PoseArray"):
            from geometry_msgs.msg import PoseArray  # noqa: F401
    assert Twist is mrs.messages.Twist
    with pytest.raises(ImportError):
        register_definitions({"test_msgs_of_ours/msg/Other": "float64 x"})
