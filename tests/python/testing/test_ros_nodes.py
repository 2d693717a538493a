"""Nodes in the style of tutorials and packages, in the folder ros_nodes, run unchanged on the bus."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from mobile_robot_simulator.testing import stand_in
from simulations import drive, small_room

OWN_MESSAGES = {"my_robot_msgs/msg/ScanSummary": "float64 x\nfloat32 nearest"}


@pytest.fixture
def nodes(monkeypatch):
    """A function that imports a module of the folder under the stand-in."""
    monkeypatch.syspath_prepend(str(Path(__file__).parent / "ros_nodes"))

    def imported(name: str):
        monkeypatch.delitem(sys.modules, name, raising=False)
        with stand_in(OWN_MESSAGES):
            module = __import__(name)
        monkeypatch.delitem(sys.modules, name)
        return module

    return imported


def test_a_listener_hears_a_talker_and_the_main_says_who_runs_nodes(nodes):
    sim, module = small_room(), nodes("talker_listener")
    listener = sim.spawn(module.Listener)
    sim.spawn(module.Talker)
    sim.run_for(1.2)
    assert listener.heard == ["Hello World: 0", "Hello World: 1"]
    with pytest.raises(RuntimeError, match=r"nodes are run by the simulation: spawn the node, then call sim\.run_for"):
        sim.spawn(module.main)


def test_a_safety_stop_stops_in_front_of_the_wall(nodes):
    sim = small_room()
    sim.set_pose((2.5, 2.5, -1.5707963))
    sim.spawn(nodes("safety_stop").SafetyStop, parameters={"distance": 0.5})
    sim.run_for(1.0)
    assert sim.truth.velocity[0] == 0.5
    sim.run_for(9.0)
    assert sim.truth.velocity[0] == 0.0 and 0.5 < sim.pose.y < 0.65


def test_odometry_is_relayed_to_tf(nodes):
    sim = small_room()
    node = sim.spawn(nodes("odom_to_tf").OdomToTf)
    drive(sim, 0.5)
    sim.run_for(2.05)
    assert node.failures == 0 and node.seen.z == pytest.approx(0.4)
    assert node.seen.x == pytest.approx(1.0 + 0.5 * 2.0, abs=0.03)


def test_parameters_have_ranges_and_can_be_refused(nodes):
    sim, module = small_room(), nodes("speed_parameters")
    node = sim.spawn(module.SpeedParameters, parameters={"gain": 2.0})
    assert node.missing and [it.value for it in node.get_parameters(["gain", "max_speed"])] == [2.0, 1.0]
    assert node.try_to_set("max_speed", 1.5).successful and node.get_parameter("max_speed").value == 1.5
    for name, value, reason in [
        ("max_speed", 2.5, "parameter 'max_speed' must be from 0.0 to 2.0, got 2.5"),
        ("frame", "map", "parameter 'frame' is read-only"),
        ("gain", -1.0, "gain must be positive"),
    ]:
        before = node.get_parameter(name).value
        result = node.try_to_set(name, value)
        assert (result.successful, result.reason) == (False, reason) and node.get_parameter(name).value == before
    with pytest.raises(ValueError, match=r"'max_speed' of speed_parameters must be from 0\.0 to 2\.0, got 3\.0"):
        sim.spawn(module.SpeedParameters, parameters={"max_speed": 3.0})


def test_a_service_answers_an_async_timer_and_a_constructor(nodes):
    sim, module = small_room(), nodes("docking")
    docker = sim.spawn(module.AsyncDocker)
    sim.run_for(3.0)
    assert docker.answers == []
    dock = sim.spawn(module.Dock)
    sim.run_for(3.0)
    assert docker.answers == ["docked"] and dock.docked
    assert sim.spawn(module.Undocker).answer == "undocked" and not dock.docked


def test_scans_and_odometry_are_paired_in_a_message_of_the_users_package(nodes):
    sim = small_room()
    sim.set_pose((1.0, 1.0, -1.5707963))
    sim.spawn(nodes("scan_and_odom").ScanAndOdom)
    sim.run_for(1.0)
    summary = sim.latest("/scan_and_odom/summary")
    assert type(summary).__module__ == "my_robot_msgs.msg" and summary.nearest == pytest.approx(0.9, abs=0.05)


def test_a_late_map_listener_receives_the_map(nodes):
    sim = small_room()
    sim.run_for(1.0)
    node = sim.spawn(nodes("map_listener").MapListener)
    sim.run_for(0.1)
    assert node.walls == 50


def test_an_action_gives_feedback_a_result_and_can_be_canceled(nodes):
    sim, module = small_room(), nodes("fibonacci")
    sim.spawn(module.FibonacciServer)
    client = sim.spawn(module.FibonacciClient)
    client.send_goal(5)
    sim.run_for(2.5)
    assert client.accepted and client.partial == [[0, 1, 1], [0, 1, 1, 2], [0, 1, 1, 2, 3]] and client.status is None
    sim.run_for(2.0)
    assert client.succeeded and client.sequence == [0, 1, 1, 2, 3, 5]
    client.send_goal(5)
    sim.run_for(1.5)
    client.cancel()
    sim.run_for(1.0)
    assert (client.canceling, client.status, client.sequence) == (1, 5, [])
    client.send_goal(0)
    sim.run_for(0.1)
    assert not client.accepted


def test_a_lifecycle_node_talks_only_while_it_is_active(nodes):
    sim = small_room()
    node = sim.spawn(nodes("lifecycle_talker").LifecycleTalker)
    heard = []
    assert node.trigger_configure().name == "SUCCESS"
    sim.subscribe("/lifecycle_chatter", node._pub.topic.msg_type, lambda message: heard.append(message.data))
    sim.run_for(2.5)
    assert heard == [] and node.trigger_activate().name == "SUCCESS"
    sim.run_for(1.0)
    assert heard == ["Lifecycle HelloWorld #3"] and node.trigger_deactivate().name == "SUCCESS"
    sim.run_for(2.0)
    assert len(heard) == 1 and [node.trigger_cleanup().name, node.trigger_shutdown().name] == ["SUCCESS"] * 2
