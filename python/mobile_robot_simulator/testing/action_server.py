"""Action servers of the stand-in. As on ROS 2, an action is three services and two topics, which the bus carries."""

from __future__ import annotations

import inspect
import time
from collections.abc import Awaitable, Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from enum import Enum, IntEnum
from functools import partial
from typing import Any, NoReturn
from unittest.mock import patch

from ..bus.node import BusNode
from ..bus.task import BusTask
from ..handle import Handle, check_callback
from ..nodes.future import Future, FutureSnapshot
from ..nodes.interface import QoS
from .ros_messages import message_class


class GoalStatus(IntEnum):
    """States of a goal, numbered as in `action_msgs/msg/GoalStatus`."""

    UNKNOWN = 0
    ACCEPTED = 1
    EXECUTING = 2
    CANCELING = 3
    SUCCEEDED = 4
    CANCELED = 5
    ABORTED = 6


TRANSITIONS: Mapping[GoalStatus, Sequence[GoalStatus]] = {
    GoalStatus.ACCEPTED: (GoalStatus.EXECUTING, GoalStatus.CANCELING),
    GoalStatus.EXECUTING: (GoalStatus.CANCELING, GoalStatus.SUCCEEDED, GoalStatus.ABORTED),
    GoalStatus.CANCELING: (GoalStatus.SUCCEEDED, GoalStatus.CANCELED, GoalStatus.ABORTED),
}
"""States that can follow each state, as in the design of ROS 2 actions (https://design.ros2.org/articles/actions.html)."""


MOST_USES = 10_000
"""Number of times that a callback can use a goal at one simulated time, before it counts as an endless loop."""


AWAIT = "define it with async def, and await a Future that a timer completes"
"""What a callback can do instead of waiting, for error messages."""


class GoalResponse(Enum):
    """What a `goal_callback` returns."""

    REJECT = 1
    ACCEPT = 2


class CancelResponse(Enum):
    """What a `cancel_callback` returns."""

    REJECT = 1
    ACCEPT = 2


class ServerGoalHandle(Handle):
    """A goal that a server has accepted.

    Attributes:
        request: The goal.
        info: Its identifier and the time at which it was accepted.
        status: Its state.
        result: Future of the response with its result.
    """

    def __init__(self, server: ActionServer, info: Any, request: Any) -> None:
        self._server, self.info, self.request = server, info, request
        self.status: int = GoalStatus.ACCEPTED
        self.result = Future()
        self._used_ns, self._uses = -1, 0

    @property
    def goal_id(self) -> Any:
        """Identifier of the goal, a `unique_identifier_msgs/msg/UUID`."""
        return self.info.goal_id

    @property
    def is_active(self) -> bool:
        """True until the goal has succeeded, was aborted or was canceled."""
        return self.status in TRANSITIONS

    @property
    def is_cancel_requested(self) -> bool:
        """True if a request to cancel the goal was accepted.

        Raises:
            RuntimeError: It was read in an endless loop.
        """
        self._count_use()
        return self.status == GoalStatus.CANCELING

    def execute(self, execute_callback: Callable[[ServerGoalHandle], Any] | None = None) -> None:
        """Starts to execute the goal, after the current callback has returned.

        Args:
            execute_callback: Replaces the server's `execute_callback` for this goal.

        Raises:
            RuntimeError: The goal is already being executed or has ended.
        """
        if not self.is_cancel_requested:
            self.change(GoalStatus.EXECUTING)
        self._server.execute(self, execute_callback)

    def publish_feedback(self, feedback: Any) -> None:
        """Sends feedback to the client.

        Raises:
            TypeError: It is not the action's `Feedback`.
            RuntimeError: It was called in an endless loop.
        """
        self._count_use()
        self._server.publish_feedback(self, feedback)

    def succeed(self) -> None:
        """Says that the goal was reached. Raises a RuntimeError if it is not being executed."""
        self.change(GoalStatus.SUCCEEDED)

    def abort(self) -> None:
        """Says that the goal was given up. Raises a RuntimeError if it is not being executed."""
        self.change(GoalStatus.ABORTED)

    def canceled(self) -> None:
        """Says that the goal was canceled. Raises a RuntimeError if no request to cancel it was accepted."""
        self.change(GoalStatus.CANCELED)

    def change(self, status: GoalStatus) -> None:
        """Changes the state of the goal, and publishes it.

        Raises:
            RuntimeError: The state cannot follow the current one.
        """
        current = GoalStatus(self.status)
        if status not in TRANSITIONS.get(current, ()):
            raise RuntimeError(f"a goal of {self._server.name} that is {current.name} cannot become {status.name}")
        self.status = status
        self._server.publish_status()

    def _count_use(self) -> None:
        now_ns = self._server.time_ns
        self._uses = self._uses + 1 if now_ns == self._used_ns else 1
        self._used_ns = now_ns
        if self._uses > MOST_USES:
            self._uses = 0
            raise RuntimeError(f"a callback used a goal {MOST_USES} times while simulated time stands still: {AWAIT}")


@dataclass(frozen=True)
class ServerSnapshot:
    """Saved state of an action server: each goal with its status and its result."""

    goals: Mapping[bytes, tuple[ServerGoalHandle, int, FutureSnapshot]]


class ActionServer(Handle):
    """Offers an action, as `rclpy.action.ActionServer` does.

    An `execute_callback` defined with `async def` can await futures. Any other one runs at one simulated time. Results are
    kept as long as the server.

    Args:
        node: Node that offers the action.
        action_type: Action class with `Goal`, `Result` and `Feedback`.
        action_name: Name of the action.
        execute_callback: Takes the goal handle and returns the result.
        goal_callback: Takes the goal and returns a `GoalResponse`. By default, every goal is accepted.
        handle_accepted_callback: Takes the handle of an accepted goal. By default, it is executed.
        cancel_callback: Takes the goal handle and returns a `CancelResponse`. By default, no goal can be canceled.
        **_: Other keywords of rclpy are ignored.

    Raises:
        TypeError: A callback is not callable, or `action_type` is not an action class.
        ValueError: A node already offers the action, or the name is empty.
    """

    def __init__(
        self,
        node: BusNode,
        action_type: Any,
        action_name: str,
        execute_callback: Callable[[ServerGoalHandle], Any],
        *,
        goal_callback: Callable[[Any], Any] | None = None,
        handle_accepted_callback: Callable[[ServerGoalHandle], Any] | None = None,
        cancel_callback: Callable[[ServerGoalHandle], Any] | None = None,
        **_: Any,
    ) -> None:
        check_action(action_type)
        self.action_type, self.name = action_type, node.resolve_service_name(action_name)
        self._node, self._bus = node, node._bus
        self._goals: dict[bytes, ServerGoalHandle] = {}
        self.register_execute_callback(execute_callback)
        self.register_goal_callback(goal_callback)
        self.register_handle_accepted_callback(handle_accepted_callback)
        self.register_cancel_callback(cancel_callback)
        impl = action_type.Impl
        self._services = [
            node.create_service(impl.SendGoalService, f"{self.name}/_action/send_goal", self._take_goal),
            node.create_service(impl.CancelGoalService, f"{self.name}/_action/cancel_goal", self._cancel_goals),
            node.create_service(impl.GetResultService, f"{self.name}/_action/get_result", self._result_of),
        ]
        self._feedback = node.create_publisher(impl.FeedbackMessage, f"{self.name}/_action/feedback")
        self._status = node.create_publisher(impl.GoalStatusMessage, f"{self.name}/_action/status", QoS.LATCHED)
        self._bus.nodes.append(self)
        node._handles[self] = self.destroy

    @property
    def time_ns(self) -> int:
        """Simulated time [ns]."""
        return self._bus.time_ns

    def register_execute_callback(self, execute_callback: Callable[[ServerGoalHandle], Any]) -> None:
        """Replaces the `execute_callback`."""
        check_callback(execute_callback)
        self._execute_callback = execute_callback

    def register_goal_callback(self, goal_callback: Callable[[Any], Any] | None) -> None:
        """Replaces the `goal_callback`. None accepts every goal."""
        self._goal_callback = goal_callback or (lambda _: GoalResponse.ACCEPT)
        check_callback(self._goal_callback)

    def register_handle_accepted_callback(self, handle_accepted_callback: Callable[[ServerGoalHandle], Any] | None) -> None:
        """Replaces the `handle_accepted_callback`. None executes each goal."""
        self._accepted_callback = handle_accepted_callback or ServerGoalHandle.execute
        check_callback(self._accepted_callback)

    def register_cancel_callback(self, cancel_callback: Callable[[ServerGoalHandle], Any] | None) -> None:
        """Replaces the `cancel_callback`. None refuses every request."""
        self._cancel_callback = cancel_callback or (lambda _: CancelResponse.REJECT)
        check_callback(self._cancel_callback)

    def execute(self, goal: ServerGoalHandle, execute_callback: Callable[[ServerGoalHandle], Any] | None) -> None:
        """Runs a callback with a goal after the current callback has returned, and sends the result to the client."""
        callback = execute_callback or self._execute_callback
        self._bus.schedule(self._bus.time_ns, lambda: self._start(self._executed(goal, callback), callback))

    def publish_feedback(self, goal: ServerGoalHandle, feedback: Any) -> None:
        """Sends feedback of a goal to its client. Raises the error of `ServerGoalHandle.publish_feedback`."""
        if not isinstance(feedback, self.action_type.Feedback):
            raise TypeError(f"{self.name} takes a {self.action_type.Feedback.__name__}, got {type(feedback).__name__}")
        self._feedback.publish(self.action_type.Impl.FeedbackMessage(goal_id=goal.goal_id, feedback=feedback))

    def publish_status(self) -> None:
        """Publishes the states of all goals."""
        status = message_class("action_msgs/msg/GoalStatus")
        states = [status(goal_info=goal.info, status=int(goal.status)) for goal in self._goals.values()]
        self._status.publish(self.action_type.Impl.GoalStatusMessage(status_list=states))

    def destroy(self) -> None:
        """Stops offering the action. Goals that are being executed go on without a client."""
        for service in self._services:
            self._node.destroy_service(service)
        for publisher in (self._feedback, self._status):
            self._node.destroy_publisher(publisher)
        self._node._handles.pop(self, None)
        if self in self._bus.nodes:
            self._bus.nodes.remove(self)

    def save(self) -> ServerSnapshot:
        """Returns the state that `restore` takes."""
        return ServerSnapshot({key: (goal, goal.status, goal.result.save()) for key, goal in self._goals.items()})

    def restore(self, state: ServerSnapshot) -> None:
        """Puts the server back into a saved state."""
        self._goals = {key: goal for key, (goal, _, _) in state.goals.items()}
        for goal, status, result in state.goals.values():
            goal.status = status
            goal.result.restore(result)

    # --- services ---

    async def _take_goal(self, request: Any, response: Any) -> Any:
        key = bytes(request.goal_id.uuid)
        if key in self._goals or await _answered(self._goal_callback(request.goal)) is not GoalResponse.ACCEPT:
            return response
        response.accepted, response.stamp = True, self._node.get_clock().now().to_msg()
        info = message_class("action_msgs/msg/GoalInfo")(goal_id=request.goal_id, stamp=response.stamp)
        goal = self._goals[key] = ServerGoalHandle(self, info, request.goal)
        self.publish_status()
        # The client learns of its goal before the goal is executed.
        self._bus.schedule(self._bus.time_ns, lambda: self._start(self._accepted(goal), self._accepted_callback))
        return response

    async def _accepted(self, goal: ServerGoalHandle) -> None:
        await _answered(self._accepted_callback(goal))

    async def _cancel_goals(self, request: Any, response: Any) -> Any:
        key, stamp = bytes(request.goal_info.goal_id.uuid), request.goal_info.stamp
        wants_one, wants_earlier = any(key), stamp.nanoseconds > 0
        if wants_one and not wants_earlier:
            asked = [self._goals[key]] if key in self._goals else []
            if not asked:
                response.return_code = response.ERROR_UNKNOWN_GOAL_ID
            elif not asked[0].is_active:
                response.return_code = response.ERROR_GOAL_TERMINATED
        else:
            asked = [
                goal
                for other, goal in self._goals.items()
                if not wants_earlier or goal.info.stamp.nanoseconds <= stamp.nanoseconds or other == key
            ]
        for goal in asked:
            if goal.is_active and await _answered(self._cancel_callback(goal)) is CancelResponse.ACCEPT and goal.is_active:
                if not goal.is_cancel_requested:
                    goal.change(GoalStatus.CANCELING)
                response.goals_canceling = [*response.goals_canceling, goal.info]
        return response

    def _result_of(self, request: Any, response: Any) -> Any:
        goal = self._goals.get(bytes(request.goal_id.uuid))
        return response if goal is None else goal.result

    async def _executed(self, goal: ServerGoalHandle, callback: Callable[[ServerGoalHandle], Any]) -> None:
        try:
            with _no_sleep(self.name):
                answer = callback(goal)
            result = await _answered(answer)
            response = self.action_type.Impl.GetResultService.Response(result=result)
        except Exception:
            self._end(goal, self.action_type.Impl.GetResultService.Response())
            raise
        self._end(goal, response)

    def _end(self, goal: ServerGoalHandle, response: Any) -> None:
        if goal.is_active:
            self._node.get_logger().warning(f"a goal of {self.name} ended without succeed, abort or canceled: aborted")
            goal.abort()
        response.status = int(goal.status)
        # The client receives the feedback that was sent before the result.
        self._bus.schedule(self._bus.time_ns, partial(goal.result.set_result, response))

    def _start(self, coroutine: Any, callback: Callable[..., Any]) -> None:
        """Starts a task that shows the name of the user's callback."""
        coroutine.__qualname__ = getattr(callback, "__qualname__", repr(callback))
        BusTask(self._bus, coroutine)


async def _answered(answer: Any) -> Any:
    """Returns what a callback has returned, also if it is a coroutine function."""
    return await answer if isinstance(answer, Awaitable) else answer


@contextmanager
def _no_sleep(action: str) -> Iterator[None]:
    """Makes `time.sleep` raise an error in the block."""

    def refuse(_: float) -> NoReturn:
        raise RuntimeError(f"the execute_callback of {action} must not sleep, because simulated time stands still: {AWAIT}")

    with patch.object(time, "sleep", refuse):
        yield


def check_action(action_type: Any) -> None:
    """Checks that a type is an action class.

    Raises:
        TypeError: It is not.
    """
    missing = [
        name for name in ("Goal", "Result", "Feedback", "Impl") if not inspect.isclass(getattr(action_type, name, None))
    ]
    if missing:
        raise TypeError(f"an action class has Goal, Result, Feedback and Impl, got {action_type!r} without {missing[0]}")
