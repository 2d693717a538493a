"""The executors of rclpy on the bus, and its functions that spin: outside a run, they run the simulation."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any, NoReturn

from ..bus.node import BusNode
from ..bus.task import BusTask
from ..nodes.future import Future

RUN_FOR = "on the bus, nodes are run by the simulation: spawn the node, then call sim.run_for(seconds)"


class ExternalShutdownException(Exception):
    """Exception of `rclpy.executors`. Nothing on the bus raises it."""


class Executor:
    """Executor of rclpy. The simulation runs the nodes, in one thread; an executor only waits for them.

    Args:
        *_: Arguments of rclpy's executors, such as `num_threads`, are ignored.
        **__: The same.
    """

    def __init__(self, *_: Any, **__: Any) -> None:
        self._nodes: list[BusNode] = []

    def add_node(self, node: BusNode) -> bool:
        """Adds a node. Returns True if it is new."""
        if node in self._nodes:
            return False
        self._nodes.append(node)
        return True

    def remove_node(self, node: BusNode) -> None:
        """Removes a node."""
        if node in self._nodes:
            self._nodes.remove(node)

    def get_nodes(self) -> list[BusNode]:
        """Returns the nodes."""
        return list(self._nodes)

    def create_task(self, callback: Any, *args: Any, **kwargs: Any) -> Future:
        """Runs a coroutine, a coroutine function or a function. Returns the future of its result."""
        answer = callback if inspect.iscoroutine(callback) else callback(*args, **kwargs)
        if inspect.iscoroutine(answer):
            return BusTask(self._any_node()._bus, answer)
        future = Future()
        future.set_result(answer)
        return future

    def spin(self) -> NoReturn:
        """Always raises an error, because the simulation runs the nodes.

        Raises:
            RuntimeError: Always.
        """
        raise RuntimeError(RUN_FOR)

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Runs the simulation to the time of its next event. Raises the errors of `rclpy.spin_once`."""
        spin_once(self._any_node(), timeout_sec=timeout_sec)

    def spin_until_future_complete(self, future: Future, timeout_sec: float | None = None) -> None:
        """Runs the simulation until a future is done. Raises the errors of `rclpy.spin_until_future_complete`."""
        spin_until_future_complete(self._any_node(), future, timeout_sec=timeout_sec)

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Removes all nodes. Returns True."""
        self._nodes.clear()
        return True

    def _any_node(self) -> BusNode:
        if not self._nodes:
            raise RuntimeError("the executor has no node: call add_node first")
        return self._nodes[0]


class SingleThreadedExecutor(Executor):
    """Executor that runs one callback at a time, as the bus does."""


class MultiThreadedExecutor(Executor):
    """Executor with threads on ROS. On the bus, it also runs one callback at a time."""


def spin(node: BusNode, executor: Executor | None = None) -> NoReturn:
    """Always raises an error, because the simulation runs the nodes.

    Raises:
        RuntimeError: Always.
    """
    raise RuntimeError(RUN_FOR)


def spin_once(node: BusNode, *, executor: Executor | None = None, timeout_sec: float | None = None) -> None:
    """Runs the simulation to the time of its next event, or for the timeout if that is shorter.

    Args:
        node: A node on the bus.
        executor: Ignored.
        timeout_sec: Longest simulated time to run [s]. None for no limit.

    Raises:
        RuntimeError: A callback called, or calls in a row took 300 s of simulated time.
    """
    _refuse_in_callback(node)
    bus, first_ns = node._bus, node._bus.next_ns()
    bus.waiting.wait(lambda: first_ns is not None and bus.next_ns() != first_ns, timeout_sec, "an event", RUN_FOR)


def spin_until_future_complete(
    node: BusNode, future: Future, executor: Executor | None = None, timeout_sec: float | None = None
) -> None:
    """Runs the simulation until a future is done.

    Args:
        node: A node on the bus.
        future: The future.
        executor: Ignored.
        timeout_sec: Longest simulated time to wait [s]. None for no limit.

    Raises:
        RuntimeError: A callback called while the future is not done, or waits in a row took 300 s of simulated time.
    """
    done = Future.done
    if not done(future):
        _refuse_in_callback(node)
        node._bus.waiting.wait(lambda: done(future), timeout_sec, "a future", "nothing on the bus completes it")


def _refuse_in_callback(node: BusNode) -> None:
    if node._bus.is_running:
        raise RuntimeError("a callback must not spin, because simulated time stands still: use add_done_callback or await")


SPINS: dict[str, Callable[..., Any]] = {each.__name__: each for each in (spin, spin_once, spin_until_future_complete)}
"""The functions of `rclpy` that spin."""
