"""Action servers: states of goals, callbacks that accept and cancel, execution, saving."""

from __future__ import annotations

import time

import pytest

from mobile_robot_simulator.testing import stand_in
from mobile_robot_simulator.testing.action_server import TRANSITIONS, GoalStatus
from simulations import small_room

with stand_in({"lift_msgs/action/Lift": "float64 height\n---\nbool done\nfloat64 height\n---\nfloat64 height"}):
    from action_msgs.srv import CancelGoal
    from example_interfaces.action import Fibonacci
    from lift_msgs.action import Lift
    from nav2_msgs.action import NavigateToPose
    from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
    from rclpy.task import Future

ACCEPTED, EXECUTING, CANCELING, SUCCEEDED, CANCELED, ABORTED = range(1, 7)


@pytest.fixture
def sim():
    return small_room()


@pytest.fixture
def serve(sim):
    """A function that makes a server of Fibonacci."""

    def make(execute, **options):
        return ActionServer(sim.create_node("server"), Fibonacci, "/count", execute, **options)

    return make


@pytest.fixture
def send(sim):
    """A function that sends a goal and returns the client's handle, which tells the result as `got`."""
    client = ActionClient(sim.create_node("client"), Fibonacci, "/count")

    def sent(order=3, **options):
        future = client.send_goal_async(Fibonacci.Goal(order=order), **options)
        sim.run_for(0.0)
        goal = future.result()
        if goal.accepted:
            goal.got = goal.get_result_async()
            sim.run_for(0.0)
        return goal

    return sent


def succeed(goal):
    goal.succeed()
    return Fibonacci.Result(sequence=[goal.request.order])


def test_a_plain_callback_succeeds_and_its_feedback_arrives_before_its_result(sim, serve, send):
    seen = []

    def execute(goal):
        goal.publish_feedback(Fibonacci.Feedback(sequence=[7]))
        seen.append(goal.status)
        return succeed(goal)

    serve(execute)
    client = ActionClient(sim.create_node("other"), Fibonacci, "/count")

    def on_goal(future):
        future.result().get_result_async().add_done_callback(lambda future: seen.append(future.result().result))

    future = client.send_goal_async(Fibonacci.Goal(order=3), lambda message: seen.append(message.feedback))
    future.add_done_callback(on_goal)
    sim.run_for(0.0)
    assert seen[0] == EXECUTING and [list(message.sequence) for message in seen[1:]] == [[7], [3]]
    assert future.result().status == SUCCEEDED


def test_the_states_of_all_goals_are_published(sim, serve, send):
    serve(succeed)
    assert send().status == send().status == SUCCEEDED
    states = sim.latest("/count/_action/status").status_list
    assert [state.status for state in states] == [SUCCEEDED, SUCCEEDED]
    assert len({bytes(state.goal_info.goal_id.uuid) for state in states}) == 2


def test_goals_can_be_refused_also_by_an_async_callback(sim, serve, send):
    asked = Future()

    async def accept(goal):
        return await asked if goal.order == 1 else GoalResponse.REJECT

    serve(succeed, goal_callback=accept)
    assert not send(2).accepted
    asked.set_result(GoalResponse.ACCEPT)
    assert send(1).accepted


def test_a_goal_can_be_executed_later_with_another_callback(sim, serve, send):
    queue = []
    serve(succeed, handle_accepted_callback=queue.append)
    goal = send()
    assert (goal.status, goal.got.done()) == (ACCEPTED, False) and queue[0].is_active
    queue[0].execute(lambda goal: (goal.succeed(), Fibonacci.Result(sequence=[1, 2]))[1])
    with pytest.raises(RuntimeError, match="that is EXECUTING cannot become EXECUTING"):
        queue[0].execute()
    sim.run_for(0.0)
    assert list(goal.got.result().result.sequence) == [1, 2] and not queue[0].is_active


def waits(ready):
    async def execute(goal):
        await ready
        goal.canceled() if goal.is_cancel_requested else goal.succeed()
        return Fibonacci.Result()

    return execute


@pytest.mark.parametrize(("answer", "status"), [(CancelResponse.ACCEPT, CANCELED), (CancelResponse.REJECT, SUCCEEDED)])
def test_the_server_decides_whether_a_goal_is_canceled(sim, serve, send, answer, status):
    ready = Future()
    serve(waits(ready), cancel_callback=lambda goal: answer)
    goal = send()
    response = goal.cancel_goal_async()
    sim.run_for(0.0)
    assert len(response.result().goals_canceling) == (status == CANCELED)
    ready.set_result(None)
    sim.run_for(0.0)
    assert goal.got.result().status == goal.status == status


def test_a_goal_can_be_canceled_before_it_is_executed(sim, serve, send):
    queue = []

    def cancel(goal):
        goal.canceled()
        return Fibonacci.Result()

    serve(cancel, handle_accepted_callback=queue.append, cancel_callback=lambda goal: CancelResponse.ACCEPT)
    goal = send()
    goal.cancel_goal_async()
    sim.run_for(0.0)
    queue[0].execute()
    sim.run_for(0.0)
    assert goal.got.result().status == CANCELED


def test_by_default_no_goal_can_be_canceled(sim, serve, send):
    serve(waits(Future()))
    response = send().cancel_goal_async()
    sim.run_for(0.0)
    assert response.result().goals_canceling == []


def test_requests_can_cancel_several_goals(sim, serve, send):
    serve(waits(Future()), cancel_callback=lambda goal: CancelResponse.ACCEPT)
    client = sim.create_node("canceler").create_client(CancelGoal, "/count/_action/cancel_goal")

    def cancel(goal=None, stamp=None):
        request = CancelGoal.Request()
        if goal is not None:
            request.goal_info.goal_id = goal.goal_id
        if stamp is not None:
            request.goal_info.stamp = stamp
        future = client.call_async(request)
        sim.run_for(0.0)
        response = future.result()
        return response.return_code, [bytes(info.goal_id.uuid)[-1] for info in response.goals_canceling]

    goals = []
    for _ in range(3):
        sim.run_for(1.0)
        goals.append(send())
    names = [bytes(goal.goal_id.uuid)[-1] for goal in goals]
    assert cancel(stamp=goals[0].stamp) == (CancelGoal.Response.ERROR_NONE, names[:1])
    assert cancel(goals[1]) == (0, names[1:2])
    assert cancel(goals[2], goals[0].stamp) == (0, [names[0], names[2]])
    assert cancel() == (0, names)
    goals[0].goal_id.uuid[0] = 99
    assert cancel(goals[0]) == (CancelGoal.Response.ERROR_UNKNOWN_GOAL_ID, [])


def test_a_goal_that_has_ended_cannot_be_canceled(sim, serve, send):
    serve(succeed)
    response = send().cancel_goal_async()
    sim.run_for(0.0)
    assert response.result().return_code == CancelGoal.Response.ERROR_GOAL_TERMINATED


def test_a_callback_that_sets_no_state_aborts_its_goal(sim, serve, send, caplog):
    serve(lambda goal: Fibonacci.Result())
    assert send().got.result().status == ABORTED
    assert "a goal of /count ended without succeed, abort or canceled: aborted" in caplog.text


def test_an_error_in_a_callback_aborts_the_goal_and_is_raised_by_the_run(sim, serve, send):
    ready = Future()

    async def execute(goal):
        raise OSError(await ready)

    serve(execute)
    goal = send()
    ready.set_result("out of coffee")
    with pytest.raises(OSError, match="out of coffee"):
        sim.run_for(0.0)
    sim.run_for(0.0)
    assert goal.got.result().status == ABORTED


@pytest.mark.parametrize(
    "use", [lambda goal: goal.is_cancel_requested, lambda goal: goal.publish_feedback(Fibonacci.Feedback())]
)
def test_a_callback_that_waits_in_a_loop_ends_with_an_error(sim, serve, send, use):
    def execute(goal):
        while not use(goal):
            pass

    serve(execute)
    with pytest.raises(
        RuntimeError, match="used a goal 10000 times while simulated time stands still: define it with async"
    ):
        send()


def test_a_goal_can_be_used_any_number_of_times_while_time_passes(sim, serve, send):
    ready = Future()

    async def execute(goal):
        used = [goal.is_cancel_requested for _ in range(9000)]
        await ready
        used += [goal.is_cancel_requested for _ in range(9000)]
        goal.succeed()
        return Fibonacci.Result(sequence=[len(used)])

    serve(execute)
    goal = send()
    sim.run_for(1.0)
    ready.set_result(None)
    sim.run_for(1.0)
    assert list(goal.got.result().result.sequence) == [18000]


@pytest.mark.parametrize(
    ("execute", "error", "words"),
    [
        (
            lambda goal: time.sleep(1.0),
            RuntimeError,
            "of /count must not sleep, because simulated time stands still: define it",
        ),
        (lambda goal: goal.canceled(), RuntimeError, "a goal of /count that is EXECUTING cannot become CANCELED"),
        (lambda goal: goal.succeed(), AssertionError, "result must be a Fibonacci_Result, got None"),
        (
            lambda goal: goal.publish_feedback(Fibonacci.Result()),
            TypeError,
            "takes a Fibonacci_Feedback, got Fibonacci_Result",
        ),
    ],
)
def test_mistakes_in_a_callback_are_errors(sim, serve, send, execute, error, words):
    sleep = time.sleep
    serve(execute)
    with pytest.raises(error, match=words):
        send()
    assert time.sleep is sleep


def test_a_wrong_server_is_refused(sim):
    node = sim.create_node("node")
    with pytest.raises(TypeError, match=r"an action class has Goal, Result, Feedback and Impl, got .*Goal.* without Goal"):
        ActionServer(node, Fibonacci.Goal, "count", succeed)
    with pytest.raises(TypeError, match="callback must be callable, got None"):
        ActionServer(node, Fibonacci, "count", None)
    ActionServer(node, Fibonacci, "count", succeed)
    with pytest.raises(ValueError, match=r"/count/_action/send_goal is already offered"):
        ActionServer(node, Fibonacci, "count", succeed)


def test_a_simulation_with_a_waiting_goal_cannot_be_saved(sim, serve, send):
    serve(waits(Future()))
    send()
    with pytest.raises(RuntimeError, match=r"cannot be saved while async callbacks wait: waits\.<locals>\.execute"):
        sim.save()


def test_a_restore_brings_goals_back(sim, serve, send):
    queue = []
    serve(succeed, handle_accepted_callback=queue.append)
    goal = send()
    saved, results = sim.save(), []
    for _ in range(2):
        queue[0].execute()
        sim.run_for(1.0)
        results.append((goal.status, goal.got.done(), bytes(send().goal_id.uuid)))
        sim.restore(saved)
        assert (goal.status, queue[0].status, goal.got.done()) == (ACCEPTED, ACCEPTED, False)
    assert results[0] == results[1] and results[0][:2] == (SUCCEEDED, True)


def test_a_destroyed_server_is_gone(sim, serve, send):
    server = serve(succeed)
    client = ActionClient(sim.create_node("other"), Fibonacci, "/count")
    assert client.server_is_ready()
    server.destroy()
    assert not client.server_is_ready() and server not in sim._bus.nodes
    server = serve(succeed)
    server._node.destroy_node()
    assert not client.server_is_ready() and server not in sim._bus.nodes


def test_actions_have_parts_and_can_be_of_the_users_package(sim):
    assert NavigateToPose.Goal(behavior_tree="x").pose.header.frame_id == "" and NavigateToPose.Feedback()
    node, heights = sim.create_node("node"), []

    def lift(goal):
        goal.succeed()
        return Lift.Result(done=True, height=goal.request.height)

    ActionServer(node, Lift, "~/lift", lift)
    client = ActionClient(node, Lift, "node/lift")
    sent = client.send_goal_async(Lift.Goal(height=0.5))
    sent.add_done_callback(
        lambda future: future.result().get_result_async().add_done_callback(lambda it: heights.append(it.result().result))
    )
    sim.run_for(0.0)
    assert (heights[0].done, heights[0].height) == (True, 0.5)


def test_the_states_are_those_of_ros():
    with stand_in():
        from action_msgs.msg import GoalStatus as Message
    assert {f"STATUS_{it.name}": it.value for it in GoalStatus} == {
        name: getattr(Message, name) for name in dir(Message) if name.startswith("STATUS_")
    }
    assert TRANSITIONS.keys() == {GoalStatus.ACCEPTED, GoalStatus.EXECUTING, GoalStatus.CANCELING}
