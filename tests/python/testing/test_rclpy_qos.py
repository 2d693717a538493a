"""Quality-of-service profiles: their defaults, and the durability that the bus uses."""

from __future__ import annotations

import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.testing.rclpy_qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy, qos_contents
from simulations import small_room


def test_the_defaults_are_those_of_rclpy():
    assert QoSProfile() == QoSProfile(10, ReliabilityPolicy.RELIABLE, DurabilityPolicy.VOLATILE)
    sensor_data = qos_contents()["qos_profile_sensor_data"]
    assert (sensor_data.depth, sensor_data.reliability) == (5, ReliabilityPolicy.BEST_EFFORT)
    assert qos_contents()["QoSPresetProfiles"].SENSOR_DATA.value is sensor_data


@pytest.mark.parametrize(("durability", "count"), [(DurabilityPolicy.TRANSIENT_LOCAL, 1), (DurabilityPolicy.VOLATILE, 0)])
def test_a_transient_local_topic_keeps_its_last_message(durability, count):
    sim, seen = small_room(), []
    node = sim.create_node("clerk")
    node.create_publisher(mrs.messages.String, "/text", QoSProfile(1, durability=durability)).publish(
        mrs.messages.String("x")
    )
    sim.run_for(0.1)
    sim.subscribe("/text", mrs.messages.String, seen.append)
    sim.run_for(0.1)
    assert len(seen) == count


@pytest.mark.parametrize(
    ("qos", "count"),
    [
        (10, 0),
        (QoSProfile(depth=1), 0),
        (QoSProfile(depth=1, durability=DurabilityPolicy.SYSTEM_DEFAULT), 0),
        (QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL), 1),
    ],
)
def test_only_a_transient_local_subscription_receives_the_map(qos, count):
    sim, maps = small_room(), []
    sim.run_for(1.0)
    sim.create_node("late").create_subscription(mrs.messages.OccupancyGrid, "/map", maps.append, qos)
    sim.run_for(1.0)
    assert len(maps) == count
    sim.subscribe("/map", mrs.messages.OccupancyGrid, maps.append)
    sim.run_for(0.0)
    assert len(maps) == count + 1
