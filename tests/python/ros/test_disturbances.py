"""Disturbances: faults act on the topics, the robots and the nodes of a ROS process, on the time of its clock."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from mobile_robot_simulator import faults
from mobile_robot_simulator.faults.reading import read_fault
from mobile_robot_simulator.instant import Instant
from mobile_robot_simulator.messages import LaserScan, String
from mobile_robot_simulator.nodes.interface import QoS
from mobile_robot_simulator.ros.conversion import MessageConverter
from mobile_robot_simulator.ros.node import RosNode, RosProcess
from mobile_robot_simulator.ros.publisher import RosPublisher

SECOND = 1_000_000_000


class Watch:
    """A clock that shows what it is set to."""

    def __init__(self) -> None:
        self.ns = 0

    def now(self) -> Instant:
        return Instant(self.ns)


class Wire(RosPublisher):
    """Keeps what goes through ROS."""

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments, is_latched=False)
        self.sent: list[Any] = []

    def _send_through_ros(self, message: Any) -> None:
        self.sent.append(message)


class FakeNode(RosNode):
    """A node in the namespace /here. `wires` has its publishers, `arrive` what ROS calls with a message, by topic."""

    converter = MessageConverter(lambda values, _: values)

    def __init__(self, process: RosProcess, clock: Any) -> None:
        super().__init__(process, clock)
        self.wires: dict[str, Wire] = {}
        self.arrive: dict[str, Callable[[Any], None]] = {}

    def create_publisher(self, msg_type: Any, topic: str, qos: QoS) -> Wire:
        own_topic = self._topics.advertise(self.resolve_topic_name(topic), msg_type)
        wire = self.wires[topic] = Wire(own_topic, self._disturbances)
        return wire

    def get_logger(self) -> Any:
        raise NotImplementedError

    def resolve_service_name(self, service: str) -> str:
        return service

    def resolve_topic_name(self, topic: str) -> str:
        if " " in topic:
            raise RuntimeError("rclpy refuses such a name")
        return topic if topic.startswith("/") else f"/here/{topic}"

    def _subscribe_through_ros(self, msg_type: Any, topic: str, receive: Any, qos: QoS) -> Callable[[], object]:
        self.arrive[topic] = receive
        return lambda: None

    def _find_service_type(self, ros_type: str) -> Any:
        raise ImportError

    def _offer_service(self, ros_type: Any, srv_name: str, answer: Any) -> Any:
        raise NotImplementedError


class Rig:
    """A process with one node, on a watch."""

    def __init__(self) -> None:
        self.process, self.watch = RosProcess(), Watch()
        self.clock = self.process.executor.follow(self.watch)
        self.node = FakeNode(self.process, self.clock)
        self.disturbances = self.process.disturbances

    def add(self, *added: Any) -> None:
        self.process.executor.serialized(self.disturbances.add)(added, self.node, self.clock)

    def pass_time(self, seconds: float) -> None:
        self.watch.ns += round(seconds * SECOND)
        self.process.executor.serialized(lambda: None)()

    def reports(self) -> list[str]:
        return [message.data for message in self.node.wires["faults"].sent]


def test_a_fault_acts_on_what_the_process_publishes_between_its_times() -> None:
    rig = Rig()
    wire = rig.node.create_publisher(String, "chatter", QoS.DEFAULT)
    rig.add(faults.Drop("chatter", start=1.0, end=2.0))
    for text in ("before", "during", "after"):
        wire.publish(String(text))
        rig.pass_time(1.0)
    assert [message.data for message in wire.sent] == ["before", "after"]
    assert rig.reports() == ["drop /here/chatter"]


def test_a_fault_acts_on_what_the_process_only_receives() -> None:
    rig, received = Rig(), list[String]()
    subscription = rig.node.create_subscription(String, "chatter", received.append, QoS.DEFAULT)
    rig.add(faults.Delay("/here/chatter", 0.5))
    rig.node.arrive["chatter"](String("late"))
    rig.pass_time(0.4)
    assert received == []
    rig.pass_time(0.1)
    assert received == [String("late")]
    rig.node.arrive["chatter"](String("never"))
    rig.node.destroy_subscription(subscription)
    rig.pass_time(1.0)
    assert received == [String("late")]


def test_messages_of_the_process_that_come_back_through_ros_meet_the_fault_once() -> None:
    rig, received = Rig(), list[String]()
    wire = rig.node.create_publisher(String, "chatter", QoS.DEFAULT)
    rig.node.create_subscription(String, "chatter", received.append, QoS.LATCHED)
    rig.add(faults.Duplicate("chatter"))
    wire.publish(String("a"))
    for message in wire.sent:
        rig.node.arrive["chatter"](message)
    assert received == [String("a")] * 2


def test_the_same_seed_drops_the_same_messages_as_in_a_simulation() -> None:
    dropped = []
    for _ in range(2):
        rig = Rig()
        wire = rig.node.create_publisher(String, "chatter", QoS.DEFAULT)
        rig.add(faults.Drop("chatter", probability=0.5, seed=7))
        for index in range(100):
            wire.publish(String(str(index)))
        dropped.append([message.data for message in wire.sent])
    alone = faults.Drop("chatter", probability=0.5, seed=7)._random
    assert dropped[0] == dropped[1] == [str(index) for index in range(100) if alone.random() >= 0.5]


def test_planned_actions_wait_for_the_time_of_the_faults_which_does_not_jump_with_the_clock() -> None:
    rig, done = Rig(), list[float]()
    rig.watch.ns = 50 * SECOND
    rig.add()
    rig.disturbances.schedule(2 * SECOND, lambda: done.append(rig.disturbances.time_ns / SECOND))
    rig.pass_time(1.0)
    assert rig.disturbances.time_ns == SECOND
    rig.pass_time(100_000.0)
    rig.pass_time(-100_000.0)
    assert done == []
    rig.pass_time(1.0)
    assert done == [2.0]


def test_planned_actions_come_even_if_nothing_else_happens_for_hours() -> None:
    rig, done = Rig(), list[float]()
    rig.add()
    rig.disturbances.schedule(7_200 * SECOND, lambda: done.append(rig.disturbances.time_ns / SECOND))
    for _ in range(7_199):
        rig.pass_time(1.0)
    assert done == []
    rig.pass_time(1.0)
    assert done == [7_200.0]


@pytest.mark.parametrize("topic", ["'scan'", "'/here/scan'", ""])
def test_names_and_the_default_topic_are_in_the_namespace_of_the_process(topic: str) -> None:
    rig = Rig()
    wire = rig.node.create_publisher(LaserScan, "scan", QoS.DEFAULT)
    rig.add(read_fault(f"Blackout({topic})"))
    wire.publish(LaserScan())
    assert wire.sent == []
    assert rig.reports() == ["blackout of /here/scan"]


class Machine:
    """Stands for a node of a robot."""

    def __init__(self) -> None:
        self.log: list[Any] = []

    body_name = "b"

    def slip(self, share: float | None) -> None:
        self.log.append(share)

    def start(self) -> None:
        self.log.append("start")

    def stop(self) -> None:
        self.log.append("stop")


def test_faults_act_on_the_robots_and_nodes_of_the_process() -> None:
    rig, robot, laser, map_server = Rig(), Machine(), Machine(), Machine()
    rig.disturbances.robot_named("a")
    rig.disturbances.robot_named("b").running_robot = robot  # type: ignore[assignment]
    rig.disturbances.robot_named("b").running_scanners["scan"] = laser  # type: ignore[assignment]
    rig.disturbances.running_map_server = map_server  # type: ignore[assignment]
    rig.add(
        faults.Slip(0.5, robot="b", end=3.0),
        faults.Outage("laser", robot="b", start=1.0, end=2.0),
        faults.Outage("map_server", start=1.0),
    )
    rig.pass_time(0.5)
    rig.pass_time(5.0)
    assert robot.log == [0.5, None] and laser.log == ["stop", "start"] and map_server.log == ["stop"]
    assert rig.reports() == ["b slips by 0.5", "laser stops", "map_server stops", "laser is back", "b slips by 0"]


@pytest.mark.parametrize(
    ("fault", "error", "message"),
    [
        (faults.Drop("/chatter"), ValueError, "unknown topic '/chatter'; did you mean /here/chatter?"),
        (faults.Drop("no name"), ValueError, "unknown topic 'no name'; there are /here/chatter, /here/scan, /here/twice"),
        (faults.Drop("twice"), ValueError, "needs one receiver, /here/twice has 2 in this process"),
        (faults.StuckRanges("chatter"), TypeError, "StuckRanges needs a topic of LaserScan, /here/chatter carries String"),
        (faults.ClockJump(1.0), ValueError, "needs the simulated clock of a Simulation; on ROS, clocks cannot jump"),
        (faults.Slip(0.1, robot="b"), ValueError, "unknown robot 'b'; there are a"),
        (faults.Slip(0.1), ValueError, "this process does not run the robot"),
        (faults.Outage("laser"), ValueError, "this process does not run the laser"),
        (faults.Outage("map_server"), ValueError, "this process does not run a map server"),
    ],
)
def test_what_the_process_does_not_have_is_an_error(fault: faults.Fault, error: Any, message: str) -> None:
    rig = Rig()
    rig.node.create_publisher(String, "chatter", QoS.DEFAULT)
    rig.node.create_publisher(LaserScan, "scan", QoS.DEFAULT)
    for _ in range(2):
        rig.node.create_subscription(String, "twice", lambda _: None, QoS.DEFAULT)
    rig.disturbances.robot_named("a")
    with pytest.raises(error) as raised:
        rig.add(fault)
    assert message in str(raised.value)
    assert rig.disturbances.filters == [] and rig.disturbances.faults == []


def test_without_robots_there_is_nothing_to_slip() -> None:
    with pytest.raises(ValueError, match="this process runs no robot and no laser"):
        Rig().add(faults.Slip(0.1))
