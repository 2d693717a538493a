"""RosPublisher: it publishes what faults make of a message, within the process and through ROS, until it is destroyed."""

from __future__ import annotations

from mobile_robot_simulator.messages import Message, String
from mobile_robot_simulator.nodes.interface import QoS
from mobile_robot_simulator.ros.node import RosProcess
from mobile_robot_simulator.ros.publisher import RosPublisher


class Wire(RosPublisher):
    """Keeps what goes through ROS."""

    def __init__(self, process: RosProcess) -> None:
        super().__init__(process.topics.advertise("/chatter", String), process.disturbances, is_latched=False)
        self.sent: list[Message] = []

    def _send_through_ros(self, message: Message) -> None:
        self.sent.append(message)


def test_a_filter_changes_what_others_and_what_this_process_receive() -> None:
    process, inside = RosProcess(), list[String]()
    wire = Wire(process)
    process.topics.topic("/chatter", String).subscribe(QoS.DEFAULT, inside.append, lambda: lambda: None)
    wire.publish_lazily(String, "plain")
    process.disturbances.filters.append(lambda topic, message: [(0, String(f"{topic} {message.data}"))] * 2)  # type: ignore[attr-defined]
    wire.publish(String("twice"))
    assert wire.sent == inside == [String("plain"), String("/chatter twice"), String("/chatter twice")]


def test_a_destroyed_publisher_sends_nothing() -> None:
    process = RosProcess()
    wire = Wire(process)
    wire.retire()
    wire.publish(String("late"))
    assert wire.sent == [] and wire.topic.publisher_count == 0
