"""Executors and functions that spin: they run the simulation from outside, and refuse to do so in callbacks."""

from __future__ import annotations

import pytest

from mobile_robot_simulator.testing import stand_in
from simulations import small_room

with stand_in():
    import rclpy
    from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
    from rclpy.node import Node
    from rclpy.task import Future
    from std_srvs.srv import Trigger


class Asker(Node):
    """Asks in its constructor, as many tutorials do."""

    def __init__(self):
        super().__init__("asker")
        self.client = self.create_client(Trigger, "answer")
        while not self.client.wait_for_service(timeout_sec=1.0):
            self.get_logger().info("waiting")
        self.future = self.client.call_async(Trigger.Request())
        rclpy.spin_until_future_complete(self, self.future)
        self.answer = self.future.result().message


def respond(request, response):
    response.message = "yes"
    return response


def test_a_constructor_asks_a_service_and_waits_for_the_answer():
    sim = small_room()
    sim.create_node("server").create_service(Trigger, "answer", respond)
    assert sim.spawn(Asker).answer == "yes" and sim.time == 0.0


def test_a_constructor_that_waits_for_a_missing_service_ends_with_an_error():
    with pytest.raises(RuntimeError, match=r"waited for service /answer for 300 s of simulated time: spawn the node"):
        small_room().spawn(Asker)


@pytest.mark.parametrize("kind", [SingleThreadedExecutor, MultiThreadedExecutor])
def test_an_executor_runs_the_simulation_until_a_future_is_done(kind):
    sim, executor = small_room(), kind()
    with pytest.raises(RuntimeError, match="add_node first"):
        executor.spin_once()
    node = sim.create_node("node")
    assert executor.add_node(node) and not executor.add_node(node) and executor.get_nodes() == [node]
    future = Future(executor=executor)
    node.create_timer(2.5, lambda: future.set_result("late"))
    executor.spin_until_future_complete(future, timeout_sec=1.0)
    assert not future.done() and sim.time == 1.0
    executor.spin_until_future_complete(future)
    assert future.result() == "late" and sim.time == 2.5

    async def wait():
        return await future

    assert executor.create_task(wait).result() == executor.create_task(wait()).result() == "late"
    assert executor.create_task(max, 1, 2).result() == 2
    failing, seen = Future(), []

    async def fail():
        raise OSError(await failing)

    async def watch(task):
        try:
            await task
        except OSError as error:
            seen.append(str(error))

    executor.create_task(watch(executor.create_task(fail)))
    failing.set_result("out of coffee")
    sim.run_for(0.0)
    assert seen == ["out of coffee"]
    with pytest.raises(RuntimeError, match=r"sim\.run_for"):
        executor.spin()
    executor.remove_node(node)
    assert executor.get_nodes() == [] and executor.shutdown()


def test_spin_once_runs_to_the_next_event_or_for_the_timeout():
    sim = small_room()
    node, fired = sim.create_node("node"), []
    sim.run_for(0.3)
    node.create_timer(0.001, lambda: fired.append(sim.time)).reset()
    rclpy.spin_once(node)
    assert fired == [sim.time] == [0.301]
    rclpy.spin_once(node, timeout_sec=0.0004)
    assert len(fired) == 1 and sim.time == 0.3014


@pytest.mark.parametrize("timeout", [None, 1.0, 0.0])
def test_a_loop_that_spins_ends_with_an_error(timeout):
    node = small_room().create_node("node")
    with pytest.raises(RuntimeError, match=r"sim\.run_for"):
        while rclpy.ok():
            rclpy.spin_once(node, timeout_sec=timeout)


def test_a_future_that_nothing_completes_ends_with_an_error():
    node = small_room().create_node("node")
    with pytest.raises(RuntimeError, match=r"300 s of simulated time: nothing on the bus completes it"):
        rclpy.spin_until_future_complete(node, Future())


def test_a_callback_must_not_spin():
    sim = small_room()
    node = sim.create_node("node")
    for spin in (lambda: rclpy.spin_once(node), lambda: rclpy.spin_until_future_complete(node, Future(), timeout_sec=1.0)):
        timer = node.create_timer(0.1, spin)
        with pytest.raises(RuntimeError, match=r"must not spin.*add_done_callback or await"):
            sim.run_for(0.2)
        timer.cancel()
