"""FoxgloveServer: a real client on a real socket sees and controls a simulation."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

import mobile_robot_simulator as mrs
from foxglove_client import Client, connected
from mobile_robot_simulator.foxglove import FoxgloveServer
from mobile_robot_simulator.messages import (
    LaserScan,
    Message,
    Pose,
    PoseStamped,
    PoseWithCovariance,
    PoseWithCovarianceStamped,
    Trigger,
    Twist,
    Vector3,
)
from mobile_robot_simulator.recording.serialization import to_ros2_bytes
from simulations import open_field, pair

ROBOT, LASER = "/mobile_robot_simulator_node", "/laser_scanner_simulator_node"
FORWARD = {"linear": {"x": 0.5}}
EMPTY = b"\x00\x01\x00\x00\x00"


@dataclass(slots=True, eq=False)
class Counted(Message):
    """A message with a field whose ROS type cannot be told."""

    ros_type = "my_msgs/msg/Counted"
    count: int = 0


class Shown:
    """A simulation on a server."""

    def __init__(self, simulation: mrs.Simulation) -> None:
        self.simulation = simulation
        self.server = FoxgloveServer(simulation, port=0)

    def turn(self) -> None:
        self.simulation.run_for(0.05)
        self.server.turn()


@pytest.fixture
def shown() -> Iterator[Shown]:
    it = Shown(open_field())
    with it.server:
        yield it


@pytest.fixture
def client(shown: Shown) -> Iterator[Client]:
    with connected(shown.server.url, shown.turn) as it:
        yield it


def read(definition: dict[str, Any], data: bytes) -> Any:
    """Returns a message, read with nothing but the definition that the server sends."""
    types = get_typestore(Stores.EMPTY)
    package, kind, name = definition["schemaName"].split("/")
    read = get_types_from_msg(definition["schema"], f"{package}/msg/{name}")
    types.register(
        {each.replace("/msg/", f"/{kind}/") if each.endswith(f"/{name}") else each: d for each, d in read.items()}
    )
    return types.deserialize_cdr(data, definition["schemaName"])


def pose_at(x: float, y: float, frame: str = "map") -> PoseWithCovarianceStamped:
    message = PoseWithCovarianceStamped(pose=PoseWithCovariance(Pose()))
    message.header.frame_id = frame
    message.pose.pose.position.x, message.pose.pose.position.y = x, y
    message.pose.pose.orientation.w = 1.0
    return message


def test_all_topics_are_offered_with_their_definitions(shown: Shown, client: Client) -> None:
    channels = client.channels("/scan", "/tf_static")
    assert {name: each["schemaName"] for name, each in channels.items()} == {
        topic.name: topic.msg_type.ros_type for topic in shown.simulation._bus.topics()
    }
    assert {each["encoding"] for each in channels.values()} == {"cdr"}
    assert {each["schemaEncoding"] for each in channels.values()} == {"ros2msg"}
    assert channels["/scan"]["schema"].startswith("std_msgs/Header header\nfloat32 angle_min\n")
    assert sorted(client.text("serverInfo")["supportedEncodings"]) == ["cdr", "json"]


def test_a_subscriber_gets_the_bytes_of_a_recording(shown: Shown, client: Client) -> None:
    sent: list[tuple[int, bytes]] = []
    scans: list[LaserScan] = []
    client.subscribe(7, "/odom")
    channel = client.subscribe(8, "/scan")
    client.data(8)

    def tap(topic: str, message: Message, time_ns: int) -> None:
        if isinstance(message, LaserScan):
            scans.append(message)
            sent.append((time_ns, bytes(to_ros2_bytes(message))))

    shown.simulation.record(tap)
    client.wait(lambda: len(sent) >= 5)
    shown.simulation.stop_recording(tap)
    received = client.data(8, len(client.data(8)) + 1)
    first = received.index(sent[0])
    assert received[first : first + len(sent)] == sent
    scan = read(channel, sent[-1][1])
    assert np.array_equal(scan.ranges, scans[-1].ranges) and len(scan.ranges) == 61
    assert scan.header.stamp.sec * 10**9 + scan.header.stamp.nanosec == sent[-1][0]


def test_a_new_subscriber_gets_what_is_latched(shown: Shown, client: Client) -> None:
    client.wait(lambda: shown.simulation.time > 1.0)
    channel = client.subscribe(1, "/map")
    time_ns, data = client.data(1)[0]
    assert time_ns == 0
    grid = read(channel, data)
    assert np.array_equal(grid.data.reshape(grid.info.height, grid.info.width), shown.simulation.grid.cells)


@pytest.mark.parametrize("encoding", ["json", "cdr"])
@pytest.mark.parametrize("ros_type", ["geometry_msgs/msg/Twist", "geometry_msgs/Twist"])
def test_a_published_velocity_moves_the_robot(shown: Shown, client: Client, encoding: str, ros_type: str) -> None:
    client.send("advertise", channels=[{"id": 4, "topic": "/cmd_vel", "encoding": encoding, "schemaName": ros_type}])
    cdr = bytes(to_ros2_bytes(Twist(Vector3(0.5))))
    client.publish(4, cdr if encoding == "cdr" else json.dumps(FORWARD).encode())
    client.wait(lambda: shown.simulation.truth.velocity == (0.5, 0.0, 0.0))
    before = shown.simulation.pose
    shown.simulation.run_for(2.0)
    after = shown.simulation.pose
    assert after.x == pytest.approx(before.x + 1.0, abs=1e-12) and (after.y, after.yaw) == (before.y, before.yaw)


def test_a_published_pose_places_the_robot(shown: Shown, client: Client) -> None:
    ros_type = "geometry_msgs/msg/PoseWithCovarianceStamped"
    client.send("advertise", channels=[{"id": 4, "topic": "/initialpose", "encoding": "cdr", "schemaName": ros_type}])
    client.publish(4, bytes(to_ros2_bytes(pose_at(3.0, 4.0))))
    client.wait(lambda: tuple(shown.simulation.pose) == (3.0, 4.0, 0.0))
    stamped = {"seq": 3, "stamp": {"sec": 1, "nsec": 2}, "frame_id": "map"}  # the header of a client that speaks ROS 1
    pose = {"pose": {"position": {"x": 6, "y": 7}, "orientation": {"w": 1}}}
    client.send("advertise", channels=[{"id": 5, "topic": "/initialpose", "encoding": "json", "schemaName": ros_type}])
    client.publish(5, json.dumps({"header": stamped, "pose": pose}).encode())
    client.wait(lambda: tuple(shown.simulation.pose) == (6.0, 7.0, 0.0))


def test_a_goal_reaches_a_node_that_listens_later(shown: Shown, client: Client) -> None:
    """A topic that nobody has yet is created, as on ROS."""
    goals: list[PoseStamped] = []
    ros_type = "geometry_msgs/msg/PoseStamped"
    client.send("advertise", channels=[{"id": 4, "topic": "/goal_pose", "encoding": "json", "schemaName": ros_type}])
    assert client.channels("/goal_pose")["/goal_pose"]["schemaName"] == ros_type
    shown.simulation.subscribe("/goal_pose", PoseStamped, goals.append)
    client.publish(4, b'{"pose": {"position": {"x": 2.5}}}')
    client.wait(lambda: goals)
    assert goals[0].pose.position.x == 2.5


@pytest.mark.parametrize(
    ("topic", "ros_type", "encoding", "reason"),
    [
        ("/cmd_vel", "geometry_msgs/msg/PoseStamped", "cdr", "/cmd_vel carries Twist, got PoseStamped"),
        ("/cmd_vel", "geometry_msgs/msg/Twits", "cdr", "unknown type 'geometry_msgs/msg/Twits'; did you mean"),
        ("/cmd_vel", "geometry_msgs/msg/Twist", "ros1", "messages must be encoded in cdr or json, got 'ros1'"),
        ("", "geometry_msgs/msg/Twist", "cdr", "must have a name"),
    ],
)
def test_a_topic_that_cannot_be_is_refused(client: Client, topic: str, ros_type: str, encoding: str, reason: str) -> None:
    client.send("advertise", channels=[{"id": 4, "topic": topic, "encoding": encoding, "schemaName": ros_type}])
    assert reason in client.text("status", level=1)["message"]


@pytest.mark.parametrize(
    ("encoding", "data", "reason"),
    [
        ("cdr", b"\x00\x01\x00\x00\x01", "/cmd_vel: not a geometry_msgs/msg/Twist"),
        ("cdr", b"", "/cmd_vel: not a geometry_msgs/msg/Twist"),
        ("json", b"{", "/cmd_vel: "),
        ("json", b"\xff", "/cmd_vel: "),
        ("json", b"[" * 100_000, "nested too deeply"),
        (
            "json",
            b'{"liner": {}}',
            "Twist.liner does not exist; geometry_msgs/msg/Twist has linear, angular",
        ),
        ("json", b'{"linear": 3}', "geometry_msgs/msg/Twist.linear must be an object, got 3"),
        ("json", b'{"linear": {"x": "fast"}}', "must be a float, got 'fast'"),
    ],
)
def test_a_message_that_is_none_is_refused_and_the_next_one_taken(
    shown: Shown, client: Client, encoding: str, data: bytes, reason: str
) -> None:
    twist = "geometry_msgs/msg/Twist"
    client.send("advertise", channels=[{"id": 4, "topic": "/cmd_vel", "encoding": encoding, "schemaName": twist}])
    client.publish(4, data)
    assert reason in client.text("status", level=1)["message"]
    client.publish(4, json.dumps(FORWARD).encode() if encoding == "json" else bytes(to_ros2_bytes(Twist(Vector3(0.5)))))
    client.wait(lambda: shown.simulation.truth.velocity == (0.5, 0.0, 0.0))


def test_parameters_are_read(shown: Shown, client: Client) -> None:
    client.send("getParameters", parameterNames=[f"{ROBOT}.velocity_timeout", "/nobody.knows"], id="one")
    assert client.text("parameterValues", id="one")["parameters"] == [
        {"name": f"{ROBOT}.velocity_timeout", "type": "float64", "value": 0.0}
    ]
    client.send("getParameters", parameterNames=[], id="all")
    values = {each["name"]: each.get("value") for each in client.text("parameterValues", id="all")["parameters"]}
    robot, laser = shown.simulation.robot.parameters, shown.simulation.laser.parameters
    known = [*((ROBOT, name, value) for name, value in robot), *((LASER, name, value) for name, value in laser)]
    assert set(values) == {f"{node}.{name}" for node, name, value in known if value is not None}
    assert values[f"{LASER}.laser_beam_count"] == 61
    assert values[f"{ROBOT}.initial_pose"] == [0.0, 0.0, 0.0]


def test_a_parameter_is_set_and_others_hear_of_it(shown: Shown, client: Client) -> None:
    name = f"{LASER}.laser_beam_count"
    with connected(shown.server.url, shown.turn) as other:
        other.send("subscribeParameterUpdates", parameterNames=[name])
        other.send("getParameters", parameterNames=[name], id="before")
        other.text("parameterValues", id="before")
        client.send("setParameters", parameters=[{"name": name, "value": 11}], id="set")
        assert client.text("parameterValues", id="set")["parameters"] == [{"name": name, "value": 11}]
        assert shown.simulation.laser.parameters.laser_beam_count == 11
        assert other.text("parameterValues")["parameters"] == [{"name": name, "value": 11}]
        shown.simulation.laser.set_parameters(laser_beam_count=12)
        assert other.text("parameterValues", parameters=[{"name": name, "value": 12}])


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        (f"{LASER}.laser_beam_count", -5, "laser_beam_count"),
        (f"{LASER}.laser_beam_count", "many", "laser_beam_count"),
        (f"{LASER}.laser_beam_count", {"a": [1]}, "laser_beam_count"),
        (f"{LASER}.laser_beam_cont", 5, f"did you mean {LASER}.laser_beam_count?"),
        ("", 5, "unknown parameter ''"),
    ],
)
def test_a_wrong_parameter_is_refused_with_the_reason(
    shown: Shown, client: Client, name: str, value: object, reason: str
) -> None:
    before = shown.simulation.laser.parameters
    client.send("setParameters", parameters=[{"name": name, "value": value}], id="set")
    assert reason in client.text("status", level=1)["message"]
    kept = [{"name": name, "value": 61}] if name.endswith("count") else []
    assert client.text("parameterValues", id="set")["parameters"] == kept
    assert shown.simulation.laser.parameters is before


def test_a_parameter_can_be_unset(shown: Shown, client: Client) -> None:
    name = f"{ROBOT}.velocity_limits"
    client.send("setParameters", parameters=[{"name": name, "value": [1, 0.5, 2]}], id="set")
    limits = {"name": name, "type": "float64_array", "value": [1.0, 0.5, 2.0]}
    assert client.text("parameterValues", id="set")["parameters"] == [limits]
    client.send("setParameters", parameters=[{"name": name}])
    client.wait(lambda: shown.simulation.robot.parameters.velocity_limits is None)


def test_services_are_offered_and_answer(shown: Shown, client: Client) -> None:
    services = client.services("/reset", "/set_pose", "/static_map")
    assert set(services) == {"/reset", "/set_pose", "/static_map"}
    assert services["/reset"]["type"] == "std_srvs/srv/Trigger"
    place = services["/set_pose"]
    assert place["request"]["schema"].startswith("geometry_msgs/PoseWithCovarianceStamped pose\n")
    client.call(place["id"], 1, bytes(to_ros2_bytes(pose_at(3.0, 4.0))))
    client.wait(lambda: client.responses)
    assert client.responses.pop() == (place["id"], 1, "cdr", EMPTY)
    assert tuple(shown.simulation.pose) == (3.0, 4.0, 0.0)
    client.call(services["/reset"]["id"], 2, EMPTY)
    client.wait(lambda: client.responses)
    service, call, _, data = client.responses.pop()
    response = read(services["/reset"]["response"], data)
    assert (service, call, response.success) == (services["/reset"]["id"], 2, True)
    assert tuple(shown.simulation.pose) == (5.0, 5.0, 0.0)
    client.call(services["/static_map"]["id"], 3, EMPTY)
    client.wait(lambda: client.responses)
    served = read(services["/static_map"]["response"], client.responses.pop()[3]).map
    assert np.array_equal(served.data.reshape(served.info.height, -1), shown.simulation.grid.cells)


def test_a_wrong_service_call_fails(client: Client) -> None:
    place = client.services("/set_pose")["/set_pose"]["id"]
    client.call(place, 1, b"\x00\x01\x00\x00\x01")
    failure = client.text("serviceCallFailure", callId=1)
    assert failure["serviceId"] == place and "not a robot_localization/srv/SetPose_Request" in failure["message"]


def test_while_time_stands_still_clients_are_answered() -> None:
    simulation = open_field()
    with FoxgloveServer(simulation, port=0) as server, connected(server.url, server.turn) as client:
        client.call(client.services("/set_pose")["/set_pose"]["id"], 1, bytes(to_ros2_bytes(pose_at(3.0, 4.0))))
        client.wait(lambda: client.responses)
        client.send("getParameters", parameterNames=[f"{ROBOT}.publish_rate"], id="a")
        assert client.text("parameterValues", id="a")["parameters"][0]["value"] == 10.0
    assert tuple(simulation.pose) == (3.0, 4.0, 0.0)
    assert simulation.time == 0.0


def test_services_come_and_go_and_may_raise(shown: Shown, client: Client) -> None:
    def fail(request: Any, response: Any) -> Any:
        raise RuntimeError("the gripper is stuck")

    gripper = shown.simulation.create_node("gripper")
    service = gripper.create_service(Trigger, "/open_gripper", fail)
    number = client.services("/open_gripper")["/open_gripper"]["id"]
    client.call(number, 9, EMPTY)
    assert "the gripper is stuck" in client.text("serviceCallFailure", callId=9)["message"]
    gripper.destroy_service(service)
    assert client.text("unadvertiseServices")["serviceIds"] == [number]


def test_clients_follow_the_simulated_time(shown: Shown, client: Client) -> None:
    state = shown.simulation.save()
    client.wait(lambda: len(client.times) > 5)
    assert client.times == sorted(client.times)
    assert all(time_ns % 50_000_000 == 0 for time_ns in client.times)
    shown.simulation.run_for(100.0)
    client.wait(lambda: client.times[-1] >= 100 * 10**9)
    session = client.text("serverInfo")["sessionId"]
    shown.simulation.restore(state)
    assert client.text("serverInfo")["sessionId"] != session
    client.wait(lambda: client.times[-1] < 10**9)


def test_a_restore_removes_topics_and_clients_go_on(shown: Shown, client: Client) -> None:
    state = shown.simulation.save()
    shown.simulation.create_node("talker").create_publisher(Twist, "/later")
    number = client.channels("/later")["/later"]["id"]
    shown.simulation.restore(state)
    assert client.text("unadvertise")["channelIds"] == [number]
    client.subscribe(3, "/scan")
    client.data(3, 2)


def test_several_clients_and_robots() -> None:
    it = Shown(pair(scanners=("front", "rear"), laser_mount=(0.1, 0.0, 0.0), laser_frame_id="laser"))
    with it.server, connected(it.server.url, it.turn) as one, connected(it.server.url, it.turn) as two:
        two.subscribe(1, "/robot2/odom")
        one.subscribe(1, "/robot1/front/scan")
        twist = "geometry_msgs/msg/Twist"
        for number, (client, speed) in enumerate([(one, 0.25), (two, 0.5)], 1):
            topic = f"/robot{number}/cmd_vel"
            client.send("advertise", channels=[{"id": 1, "topic": topic, "encoding": "json", "schemaName": twist}])
            client.publish(1, json.dumps({"linear": {"x": speed}}).encode())
        for name, speed in (("robot1", 0.25), ("robot2", 0.5)):
            one.wait(lambda name=name, speed=speed: it.simulation.named(name).truth.velocity[0] == speed)
        assert one.data(1, 3) and two.data(1, 3)
        one.send("getParameters", parameterNames=["/robot1/rear_laser_scanner_simulator_node.laser_topic"], id="a")
        assert one.text("parameterValues", id="a")["parameters"][0]["value"] == "/robot1/rear/scan"


def test_a_client_that_goes_does_not_stop_the_others(shown: Shown, client: Client) -> None:
    with connected(shown.server.url, shown.turn) as other:
        other.subscribe(1, "/scan")
        twist = "geometry_msgs/msg/Twist"
        other.send("advertise", channels=[{"id": 1, "topic": "/elsewhere", "encoding": "json", "schemaName": twist}])
        client.channels("/elsewhere")
        topic = shown.simulation._bus.find_topic("/elsewhere")
        assert topic is not None and len(topic.publishers) == 1
    client.wait(lambda: not topic.publishers)
    client.subscribe(2, "/scan")
    assert client.data(2, 3)


def test_topics_that_ros_does_not_know_are_left_out_with_a_warning(
    shown: Shown, client: Client, caplog: pytest.LogCaptureFixture
) -> None:
    publisher = shown.simulation.create_node("odd").create_publisher(Counted, "/odd")
    publisher.publish(Counted(3))
    client.wait(lambda: "/odd is not shown: my_msgs/msg/Counted is not part of ROS 2 Humble" in caplog.text)
    client.subscribe(1, "/scan")
    assert client.data(1, 2) and "/odd" not in client.channels("/scan")


def test_run_keeps_the_pace_of_the_wall_clock() -> None:
    simulation = open_field(speed_factor=2.0)
    with FoxgloveServer(simulation, port=0) as server:
        began = time.monotonic()
        server.run(0.3)
        assert 0.0 < simulation.time <= 2.0 * (time.monotonic() - began)


def test_the_server_ends_and_its_port_is_free_again(shown: Shown, client: Client) -> None:
    port, nodes = int(shown.server.url.rpartition(":")[2]), len(shown.simulation._bus.nodes)
    with pytest.raises(OSError, match=rf"cannot listen on 127\.0\.0\.1, port {port}: .*in use"):
        FoxgloveServer(shown.simulation, port=port)
    with pytest.raises(ValueError, match=r"the port must be in 0\.\.65535, got 65536"):
        FoxgloveServer(shown.simulation, port=65536)
    assert len(shown.simulation._bus.nodes) == nodes
    taps = len(shown.simulation._bus.taps)
    shown.server.close()
    shown.server.close()
    assert len(shown.simulation._bus.taps) == taps - 1
    shown.simulation.run_for(1.0)
    with FoxgloveServer(shown.simulation, port=port) as server:
        assert server.url.endswith(f":{port}")


def test_a_simulation_on_a_server_gives_the_same_messages() -> None:
    def messages(run: Callable[[mrs.Simulation], None]) -> list[bytes]:
        simulation, seen = open_field(), list[bytes]()
        simulation.record(lambda topic, message, time_ns: seen.append(bytes(to_ros2_bytes(message))))
        run(simulation)
        return seen

    def on_server(simulation: mrs.Simulation) -> None:
        def turn() -> None:
            if simulation.time < 2.0:
                simulation.run_for(0.02)
            server.turn()

        with FoxgloveServer(simulation, port=0) as server, connected(server.url, turn) as client:
            client.subscribe(1, "/scan")
            client.wait(lambda: simulation.time == 2.0)

    assert messages(on_server) == messages(lambda simulation: simulation.run_for(2.0))
