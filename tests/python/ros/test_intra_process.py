"""IntraProcessTopics: the route of messages between the nodes of one ROS process."""

from __future__ import annotations

from collections.abc import Callable

from mobile_robot_simulator.messages import Clock, String
from mobile_robot_simulator.nodes.interface import QoS
from mobile_robot_simulator.ros.intra_process import IntraProcessTopics


class RosSubscriptions:
    """Counts the subscriptions through ROS."""

    def __init__(self) -> None:
        self.count = 0

    def __call__(self) -> Callable[[], object]:
        self.count += 1
        return self.end

    def end(self) -> None:
        self.count -= 1


def test_messages_are_delivered_directly_until_another_process_publishes_the_topic() -> None:
    topics, seen, ros = IntraProcessTopics(), list[String](), RosSubscriptions()
    topic = topics.advertise("/tf", String)
    topics.topic("/tf", String).subscribe(QoS.DEFAULT, seen.append, ros)
    topic.deliver(String("direct"))
    assert (seen, ros.count) == ([String("direct")], 0)
    topics.update(lambda topic: topic.name == "/tf", lambda name: ())
    topic.deliver(String("not twice"))
    assert (seen, ros.count) == ([String("direct")], 1)
    topics.update(lambda topic: False, lambda name: ())
    topic.deliver(String("direct again"))
    assert (seen[1:], ros.count) == ([String("direct again")], 0)


def test_messages_come_through_ros_while_this_process_has_no_publisher() -> None:
    topics, seen, ros = IntraProcessTopics(), list[String](), RosSubscriptions()
    topics.topic("/tf", String).subscribe(QoS.DEFAULT, seen.append, ros)
    topics.update(lambda topic: False, lambda name: ())
    assert ros.count == 1
    topic = topics.advertise("/tf", String)
    topics.update(lambda topic: False, lambda name: ())
    topic.deliver(String("direct"))
    assert (seen, ros.count) == ([String("direct")], 0)
    topic.publisher_count -= 1
    topics.update(lambda topic: False, lambda name: ())
    assert ros.count == 1


def test_latched_topics_and_topics_of_another_type_come_through_ros() -> None:
    topics, seen, ros = IntraProcessTopics(), list[object](), RosSubscriptions()
    topic = topics.advertise("/map", String)
    topics.topic("/map", String).subscribe(QoS.LATCHED, seen.append, ros)
    topics.topic("/map", Clock).subscribe(QoS.DEFAULT, seen.append, ros)
    topics.update(lambda topic: False, lambda name: ())
    topic.deliver(String("the map"))
    assert (seen, ros.count) == ([], 2)


def test_no_message_arrives_on_either_route_after_unsubscribing() -> None:
    topics, seen, ros = IntraProcessTopics(), list[String](), RosSubscriptions()
    topic = topics.advertise("/tf", String)
    for is_shared in (False, True):
        subscription = topic.subscribe(QoS.DEFAULT, seen.append, ros)
        topics.update(lambda topic, is_shared=is_shared: is_shared, lambda name: ())
        topic.unsubscribe(subscription)
        topic.deliver(String("not received"))
    topics.update(lambda topic: False, lambda name: ())
    assert (seen, ros.count) == ([], 0)
