"""LocalTopics: which way messages take between the nodes of one ROS process."""

from __future__ import annotations

from collections.abc import Callable

from mobile_robot_simulator.messages import Clock, String
from mobile_robot_simulator.nodes.interface import QoS
from mobile_robot_simulator.ros.intra_process import LocalTopics


class Listening:
    """Counts who listens through ROS."""

    def __init__(self) -> None:
        self.count = 0

    def __call__(self) -> Callable[[], object]:
        self.count += 1
        return self.end

    def end(self) -> None:
        self.count -= 1


def test_messages_go_directly_until_others_publish_the_topic() -> None:
    topics, seen, ros = LocalTopics(), list[String](), Listening()
    topic = topics.advertise("/tf", String)
    topics.topic("/tf", String).subscribe(QoS.DEFAULT, seen.append, ros)
    topic.hand(String("direct"))
    assert (seen, ros.count) == ([String("direct")], 0)
    topics.look(lambda it: it.name == "/tf")
    topic.hand(String("not twice"))
    assert (seen, ros.count) == ([String("direct")], 1)
    topics.look(lambda it: False)
    topic.hand(String("direct again"))
    assert (seen[1:], ros.count) == ([String("direct again")], 0)


def test_what_nobody_here_publishes_comes_through_ros_until_somebody_does() -> None:
    topics, seen, ros = LocalTopics(), list[String](), Listening()
    topics.topic("/tf", String).subscribe(QoS.DEFAULT, seen.append, ros)
    topics.look(lambda it: False)
    assert ros.count == 1
    topic = topics.advertise("/tf", String)
    topics.look(lambda it: False)
    topic.hand(String("direct"))
    assert (seen, ros.count) == ([String("direct")], 0)
    topic.publishers -= 1
    topics.look(lambda it: False)
    assert ros.count == 1


def test_latched_topics_and_other_types_of_the_same_name_go_through_ros() -> None:
    topics, seen, ros = LocalTopics(), list[object](), Listening()
    topic = topics.advertise("/map", String)
    topics.topic("/map", String).subscribe(QoS.LATCHED, seen.append, ros)
    topics.topic("/map", Clock).subscribe(QoS.DEFAULT, seen.append, ros)
    topics.look(lambda it: False)
    topic.hand(String("the map"))
    assert (seen, ros.count) == ([], 2)


def test_who_unsubscribes_hears_nothing_either_way() -> None:
    topics, seen, ros = LocalTopics(), list[String](), Listening()
    topic = topics.advertise("/tf", String)
    for is_shared in (False, True):
        subscription = topic.subscribe(QoS.DEFAULT, seen.append, ros)
        topics.look(lambda it, is_shared=is_shared: is_shared)
        topic.unsubscribe(subscription)
        topic.hand(String("unheard"))
    topics.look(lambda it: False)
    assert (seen, ros.count) == ([], 0)
