"""RosNode: what ROS 1 and ROS 2 share, tested on a fake ROS that records calls."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from mobile_robot_simulator.instant import Instant
from mobile_robot_simulator.messages import String, Trigger
from mobile_robot_simulator.nodes.interface import Clock, QoS
from mobile_robot_simulator.parameters import LaserParameters, RobotParameters
from mobile_robot_simulator.ros.conversion import MessageConverter
from mobile_robot_simulator.ros.node import RosNode, RosProcess
from mobile_robot_simulator.ros.paced_clock import PacedClock


class Noon:
    """A clock of ROS that stands still."""

    def now(self) -> Instant:
        return Instant(12)


class FakeRosNode(RosNode):
    """Records subscriptions through ROS and log messages. Knows only the given service types, by name."""

    converter = MessageConverter(lambda values, _: values)

    def __init__(self, process: RosProcess, clock: Clock | None = None, **service_types: Any) -> None:
        super().__init__(process, process.executor.follow(clock or PacedClock()))
        self.log: list[str] = []
        self.receivers: dict[str, Callable[[Any], None]] = {}
        self.service_types = service_types

    def get_logger(self) -> Any:
        return self

    def info(self, message: str) -> None:
        self.log.append(message)

    def resolve_service_name(self, service: str) -> str:
        return f"/{service}"

    def resolve_topic_name(self, topic: str) -> str:
        return f"/robot/{topic}"

    def _subscribe_through_ros(self, msg_type: Any, topic: str, receive: Any, qos: QoS) -> Callable[[], object]:
        self.receivers[topic] = receive
        return lambda: self.receivers.pop(topic)

    def _find_service_type(self, ros_type: str) -> Any:
        if ros_type.rpartition("/")[2] not in self.service_types:
            raise ImportError(ros_type)
        return self.service_types[ros_type.rpartition("/")[2]]

    def _offer_service(self, ros_type: Any, srv_name: str, answer: Any) -> Any:
        return answer


@pytest.mark.parametrize(
    ("parameters", "use_sim_time", "is_paced"),
    [
        (RobotParameters(publish_clock=True), True, True),
        (RobotParameters(publish_clock=False), True, False),
        (RobotParameters(publish_clock=False), False, True),
        (LaserParameters(), True, False),
        (LaserParameters(), False, True),
    ],
)
def test_a_node_is_paced_unless_it_follows_the_clock_of_ros(parameters: Any, use_sim_time: bool, is_paced: bool) -> None:
    clock = RosProcess().clock_for(parameters, Noon(), use_sim_time=use_sim_time)
    assert isinstance(clock.source, PacedClock if is_paced else Noon)


def test_nodes_created_after_one_that_publishes_the_clock_share_its_clock() -> None:
    process = RosProcess()
    clock = process.clock_for(RobotParameters(publish_clock=True), Noon(), use_sim_time=True)
    for use_sim_time in (True, False):
        assert process.clock_for(LaserParameters(), Noon(), use_sim_time=use_sim_time) is clock


def test_nodes_that_follow_ros_share_one_clock() -> None:
    """On ROS 2 each node receives /clock on its own. A scan would be measured at another time than that of the robot."""
    process = RosProcess()
    clock = process.clock_for(RobotParameters(publish_clock=False), Noon(), use_sim_time=True)
    assert process.clock_for(LaserParameters(), Noon(), use_sim_time=True) is clock


def test_all_robots_of_a_process_move_in_one_world_on_the_clock_of_the_first() -> None:
    process = RosProcess()
    clock = PacedClock(lambda: 5)
    world = process.world_for(FakeRosNode(process, clock))  # type: ignore[arg-type]
    assert world.now_ns() == 5
    assert process.world_for(FakeRosNode(process)) is world  # type: ignore[arg-type]
    assert world.grid is None


def test_set_speed_changes_only_a_paced_clock() -> None:
    clock = PacedClock()
    paced, following = FakeRosNode(RosProcess(), clock), FakeRosNode(RosProcess(), Noon())
    paced.set_speed(3.0)
    following.set_speed(3.0)
    assert clock.speed == 3.0
    assert following.get_clock().now() == Noon().now()


def test_a_subscription_receives_converted_messages_until_it_is_destroyed() -> None:
    node, received = FakeRosNode(RosProcess()), list[String]()
    subscription = node.create_subscription(String, "chatter", received.append, QoS.DEFAULT)
    assert subscription.topic.name == "/robot/chatter"
    node.receivers["chatter"](String("hello"))
    assert received == [String("hello")]
    node.destroy_subscription(subscription)
    assert not node.receivers


def test_a_service_answers_converted_requests() -> None:
    node = FakeRosNode(RosProcess(), Trigger=Trigger)

    def succeed(request: Any, response: Any) -> Any:
        response.success = True
        return response

    answer = node.create_service(Trigger, "/reset", succeed)
    ros_response = Trigger.Response()
    assert answer(Trigger.Request(), ros_response) is ros_response
    assert ros_response.success


def test_a_service_whose_type_is_not_installed_is_not_offered() -> None:
    node = FakeRosNode(RosProcess())
    assert node.create_service(Trigger, "/reset", lambda request, response: response) is None
    assert node.log == ["service /reset is not offered, because std_srvs/srv/Trigger is not installed"]


def test_a_service_of_the_other_version_of_ros_is_not_missed() -> None:
    node = FakeRosNode(RosProcess())
    node.other_packages = ("std_srvs/",)  # type: ignore[misc]
    assert node.create_service(Trigger, "/reset", lambda request, response: response) is None
    assert node.log == []
