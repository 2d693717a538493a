"""Action clients: goals, feedback, waiting for a server, errors."""

from __future__ import annotations

import pytest

from mobile_robot_simulator.recording.serialization import to_ros2_bytes
from mobile_robot_simulator.testing import stand_in
from simulations import small_room

with stand_in():
    import rclpy
    from example_interfaces.action import Fibonacci
    from rclpy.action import ActionClient, ActionServer
    from rclpy.node import Node
    from unique_identifier_msgs.msg import UUID


def execute(goal):
    goal.publish_feedback(Fibonacci.Feedback(sequence=[goal.request.order]))
    goal.succeed()
    return Fibonacci.Result(sequence=[goal.request.order])


@pytest.fixture
def sim():
    return small_room()


def test_a_constructor_waits_for_a_server_and_a_result(sim):
    class Asker(Node):
        def __init__(self):
            super().__init__("asker")
            client = ActionClient(self, Fibonacci, "count")
            self.found = client.wait_for_server(timeout_sec=1.0)
            if self.found:
                sent = client.send_goal_async(Fibonacci.Goal(order=8))
                rclpy.spin_until_future_complete(self, sent)
                got = sent.result().get_result_async()
                rclpy.spin_until_future_complete(self, got)
                self.sequence = list(got.result().result.sequence)

    assert not sim.spawn(Asker).found and sim.time == 1.0
    ActionServer(sim.create_node("server"), Fibonacci, "count", execute)
    assert sim.spawn(Asker).sequence == [8]


def test_feedback_goes_to_the_callback_of_its_goal_which_can_be_async(sim):
    seen = []

    async def see(message):
        seen.append(("second", list(message.feedback.sequence)))

    ActionServer(sim.create_node("server"), Fibonacci, "count", execute)
    client = ActionClient(sim.create_node("client"), Fibonacci, "count")
    other = ActionClient(sim.create_node("other"), Fibonacci, "count")
    client.send_goal_async(Fibonacci.Goal(order=1), lambda message: seen.append(("first", list(message.feedback.sequence))))
    other.send_goal_async(Fibonacci.Goal(order=2), feedback_callback=see)
    sim.run_for(0.0)
    assert seen == [("first", [1]), ("second", [2])]
    assert len(to_ros2_bytes(sim.latest("/count/_action/feedback"))) == 28


def test_a_goal_is_copied_and_can_have_an_identifier(sim):
    ActionServer(sim.create_node("server"), Fibonacci, "count", execute)
    client, goal = ActionClient(sim.create_node("client"), Fibonacci, "count"), Fibonacci.Goal(order=1)
    name = UUID(uuid=range(16))
    sent = [client.send_goal_async(goal, goal_uuid=name)]
    goal.order = 2
    sent.append(client.send_goal_async(goal, goal_uuid=name))
    sim.run_for(0.0)
    assert [it.result().accepted for it in sent] == [True, False]
    got = sent[0].result().get_result_async()
    sim.run_for(0.0)
    assert sim._bus.save().calls == {}
    assert list(got.result().result.sequence) == [1] and sent[0].result().goal_id == name


def test_a_goal_on_its_way_is_saved(sim):
    ActionServer(sim.create_node("server"), Fibonacci, "count", execute)
    client = ActionClient(sim.create_node("client"), Fibonacci, "count")
    seen = []
    sent = client.send_goal_async(Fibonacci.Goal(order=1), seen.append)
    saved = sim.save()
    for count in (1, 2):
        other = client.send_goal_async(Fibonacci.Goal(order=1), seen.append)
        sim.run_for(0.0)
        assert sent.done() and sent.result().status == 4 and len(seen) == 2 * count
        sim.restore(saved)
        assert not sent.done() and bytes(other.result().goal_id.uuid) not in client._callbacks


def test_mistakes_are_errors(sim):
    node = sim.create_node("client")
    client = ActionClient(node, Fibonacci, "count")
    with pytest.raises(TypeError, match="/count takes a Fibonacci_Goal, got Fibonacci_Result"):
        client.send_goal_async(Fibonacci.Result())
    with pytest.raises(TypeError, match="must be callable, got 1"):
        client.send_goal_async(Fibonacci.Goal(), feedback_callback=1)
    with pytest.raises(RuntimeError, match="use send_goal_async"):
        client.send_goal(Fibonacci.Goal())
    with pytest.raises(TypeError, match="without Goal"):
        ActionClient(node, UUID, "count")
    with pytest.raises(RuntimeError, match=r"waited for action /count for 300 s of simulated time: spawn the node"):
        client.wait_for_server()
    ActionServer(sim.create_node("server"), Fibonacci, "count", execute)
    sent = client.send_goal_async(Fibonacci.Goal())
    sim.run_for(0.0)
    with pytest.raises(RuntimeError, match="use get_result_async"):
        sent.result().get_result()
    with pytest.raises(RuntimeError, match="use cancel_goal_async"):
        sent.result().cancel_goal()


def test_a_destroyed_client_gets_no_feedback(sim):
    seen = []
    ActionServer(sim.create_node("server"), Fibonacci, "count", execute)
    node = sim.create_node("client")
    client = ActionClient(node, Fibonacci, "count")
    client.send_goal_async(Fibonacci.Goal(order=1), seen.append)
    node.destroy_node()
    sim.run_for(0.0)
    assert seen == [] and client not in sim._bus.nodes
