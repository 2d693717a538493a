"""ClientTopics: clients publish on topics that are there, and on new ones; `test_server.py` has a real client."""

from __future__ import annotations

import pytest

from mobile_robot_simulator.foxglove.client_topics import Announced, ClientTopics
from mobile_robot_simulator.messages import OccupancyGrid, PointStamped, Twist
from mobile_robot_simulator.recording.serialization import to_ros2_bytes
from simulations import open_field

TWIST = "geometry_msgs/msg/Twist"


def test_each_client_has_channels_of_its_own() -> None:
    simulation = open_field()
    bus, node = simulation._bus, simulation.create_node("foxglove")
    topics, seen = ClientTopics(bus, node), list[Twist]()
    simulation.create_node("listener").create_subscription(Twist, "/a", seen.append)
    topics.announce(1, 5, Announced("/a", TWIST, "json"))
    topics.announce(2, 5, Announced("/b", TWIST, "json"))
    topics.publish(1, 5, b'{"linear": {"x": 1}}')
    topics.publish(2, 5, b'{"linear": {"x": 2}}')
    simulation.run_for(0.0)
    assert [each.linear.x for each in seen] == [1]
    topics.withdraw(1, 5)
    topics.withdraw(1, 5)
    with pytest.raises(ValueError, match="must announce a topic before it publishes, got a message on its channel 5"):
        topics.publish(1, 5, b"{}")
    topics.publish(2, 5, b"{}")


def test_a_channel_that_is_announced_again_goes_to_the_new_topic() -> None:
    simulation = open_field()
    topics = ClientTopics(simulation._bus, simulation.create_node("foxglove"))
    topics.announce(1, 5, Announced("/a", TWIST, "cdr"))
    topics.announce(1, 5, Announced("/b", "geometry_msgs/PointStamped", "cdr"))
    topics.publish(1, 5, bytes(to_ros2_bytes(PointStamped())))
    assert simulation.latest("/b") == PointStamped() and simulation.latest("/a") is None
    assert len(simulation._bus.topic("/a", Twist).publishers) == 0
    assert len(simulation._bus.topic("/b", PointStamped).publishers) == 1


def test_a_topic_that_a_restore_has_removed_comes_back_with_the_next_message() -> None:
    simulation, seen = open_field(), list[PointStamped]()
    topics = ClientTopics(simulation._bus, simulation.create_node("foxglove"))
    state = simulation.save()
    topics.announce(1, 1, Announced("/goal", PointStamped.ros_type, "json"))
    simulation.restore(state)
    simulation.subscribe("/goal", PointStamped, seen.append)
    topics.publish(1, 1, b'{"point": {"x": 2}}')
    simulation.run_for(0.0)
    assert [each.point.x for each in seen] == [2]


def test_a_map_of_a_client_is_kept_for_later_subscribers() -> None:
    simulation, seen = open_field(), list[OccupancyGrid]()
    topics = ClientTopics(simulation._bus, simulation.create_node("foxglove"))
    topics.announce(1, 1, Announced("/map", OccupancyGrid.ros_type, "json"))
    topics.publish(1, 1, b'{"info": {"width": 1, "height": 1}, "data": [100]}')
    simulation.subscribe("/map", OccupancyGrid, seen.append)
    simulation.run_for(0.0)
    assert [each.data.tolist() for each in seen if each.info.width == 1] == [[100]]
