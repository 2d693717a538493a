"""Action clients of the stand-in. They use the services and topics of an action server."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, NoReturn

from ..bus.node import BusNode
from ..bus.task import plain_callback
from ..handle import Handle, check_callback
from ..messages import copied
from ..nodes.future import Future
from ..nodes.interface import QoS
from .action_server import GoalStatus, check_action
from .ros_messages import message_class


class ClientGoalHandle(Handle):
    """A goal that a client has sent.

    Attributes:
        goal_id: Identifier of the goal, a `unique_identifier_msgs/msg/UUID`.
        accepted: True if the server has accepted the goal.
        stamp: Time at which it did so.
        status: State of the goal, numbered as in `action_msgs/msg/GoalStatus`.
    """

    def __init__(self, client: ActionClient, goal_id: Any, response: Any) -> None:
        self._client, self.goal_id = client, goal_id
        self.accepted, self.stamp = response.accepted, response.stamp
        self.status: int = GoalStatus.UNKNOWN

    def get_result_async(self) -> Future:
        """Returns a future for the result: an object with `status` and `result`. It is done when the goal has ended."""
        impl = self._client.action_type.Impl
        return self._client.call(impl.GetResultService, "get_result", impl.GetResultService.Request(goal_id=self.goal_id))

    def cancel_goal_async(self) -> Future:
        """Asks the server to cancel the goal.

        Returns:
            A future for the response. Its `goals_canceling` has the goal if the server accepts.
        """
        service = self._client.action_type.Impl.CancelGoalService
        request = service.Request()
        request.goal_info.goal_id = self.goal_id
        return self._client.call(service, "cancel_goal", request)

    def get_result(self) -> NoReturn:
        """Always raises a RuntimeError, because a callback that waits would wait forever."""
        raise RuntimeError("a callback must not wait for a result: use get_result_async and add_done_callback")

    def cancel_goal(self) -> NoReturn:
        """Always raises a RuntimeError, because a callback that waits would wait forever."""
        raise RuntimeError("a callback must not wait for a response: use cancel_goal_async and add_done_callback")


@dataclass(frozen=True)
class ClientSnapshot:
    """Saved state of an action client: accepted goals with their statuses, and callbacks for feedback, by goal."""

    goals: Mapping[bytes, tuple[ClientGoalHandle, int]]
    callbacks: Mapping[bytes, Callable[[Any], Any]]


class ActionClient(Handle):
    """Sends goals to an action server, as `rclpy.action.ActionClient` does.

    Args:
        node: Node that sends the goals.
        action_type: Action class with `Goal`, `Result` and `Feedback`.
        action_name: Name of the action.
        **_: Other keywords of rclpy are ignored.

    Raises:
        TypeError: `action_type` is not an action class, or not that of the existing action.
        ValueError: The name is empty.
    """

    def __init__(self, node: BusNode, action_type: Any, action_name: str, **_: Any) -> None:
        check_action(action_type)
        self.action_type, self.name = action_type, node.resolve_service_name(action_name)
        self._node, self._bus = node, node._bus
        self._goals: dict[bytes, ClientGoalHandle] = {}
        self._callbacks: dict[bytes, Callable[[Any], Any]] = {}
        impl = action_type.Impl
        self._services = [
            self._bus.service(f"{self.name}/_action/{name}", service)
            for name, service in (
                ("send_goal", impl.SendGoalService),
                ("cancel_goal", impl.CancelGoalService),
                ("get_result", impl.GetResultService),
            )
        ]
        self._subscriptions = [
            node.create_subscription(impl.FeedbackMessage, f"{self.name}/_action/feedback", self._take_feedback),
            node.create_subscription(impl.GoalStatusMessage, f"{self.name}/_action/status", self._take_status, QoS.LATCHED),
        ]
        self._bus.nodes.append(self)
        node._handles[self] = self.destroy

    def server_is_ready(self) -> bool:
        """Returns True if a node offers the action."""
        return all(service.handler is not None for service in self._services)

    def wait_for_server(self, timeout_sec: float | None = None) -> bool:
        """Waits until a node offers the action. Otherwise the same as `wait_for_service` of a client of a service.

        Args:
            timeout_sec: Longest simulated time to wait [s]. None for no limit.

        Returns:
            True if a node offers the action.

        Raises:
            RuntimeError: The wait would never end.
        """
        hint = "spawn the node that offers it before this one"
        return self._bus.waiting.wait(self.server_is_ready, timeout_sec, f"action {self.name}", hint)

    def send_goal_async(
        self, goal: Any, feedback_callback: Callable[[Any], Any] | None = None, goal_uuid: Any = None
    ) -> Future:
        """Sends a copy of a goal.

        Args:
            goal: The goal.
            feedback_callback: Called with each message of feedback; its `feedback` is what the server has sent.
            goal_uuid: Identifier of the goal. By default, a new one.

        Returns:
            A future for a `ClientGoalHandle`. It is done when the server has accepted or refused the goal.

        Raises:
            TypeError: The goal is not the action's `Goal`, or the callback is not callable.
        """
        if not isinstance(goal, self.action_type.Goal):
            raise TypeError(f"{self.name} takes a {self.action_type.Goal.__name__}, got {type(goal).__name__}")
        if goal_uuid is None:
            number = self._bus.next_timer_order()
            goal_uuid = message_class("unique_identifier_msgs/msg/UUID")(uuid=number.to_bytes(16, "big"))
        if feedback_callback is not None:
            check_callback(feedback_callback)
            self._callbacks[bytes(goal_uuid.uuid)] = plain_callback(self._bus, feedback_callback)
        service = self.action_type.Impl.SendGoalService
        request = service.Request(goal_id=goal_uuid, goal=copied(goal))
        return self.call(service, "send_goal", request, partial(self._sent, goal_uuid))

    def send_goal(self, goal: Any, **_: Any) -> NoReturn:
        """Always raises a RuntimeError, because a callback that waits would wait forever."""
        raise RuntimeError(f"a callback must not wait for {self.name}: use send_goal_async and add_done_callback")

    def call(self, service: Any, name: str, request: Any, convert: Callable[[Any], Any] | None = None) -> Future:
        """Calls a service of the action. The arguments are those of `Bus.call`, and the last part of the service's name."""
        return self._bus.call(self._bus.service(f"{self.name}/_action/{name}", service), request, convert)

    def destroy(self) -> None:
        """Stops receiving feedback and states."""
        for subscription in self._subscriptions:
            self._node.destroy_subscription(subscription)
        self._node._handles.pop(self, None)
        if self in self._bus.nodes:
            self._bus.nodes.remove(self)

    def save(self) -> ClientSnapshot:
        """Returns the state that `restore` takes."""
        return ClientSnapshot({key: (goal, goal.status) for key, goal in self._goals.items()}, dict(self._callbacks))

    def restore(self, state: ClientSnapshot) -> None:
        """Puts the client back into a saved state."""
        self._goals = {key: goal for key, (goal, _) in state.goals.items()}
        self._callbacks = dict(state.callbacks)
        for goal, status in state.goals.values():
            goal.status = status

    def _sent(self, goal_id: Any, response: Any) -> ClientGoalHandle:
        goal = ClientGoalHandle(self, goal_id, response)
        if goal.accepted:
            goal.status = GoalStatus.ACCEPTED
            self._goals[bytes(goal_id.uuid)] = goal
        else:
            self._callbacks.pop(bytes(goal_id.uuid), None)
        return goal

    def _take_feedback(self, message: Any) -> None:
        callback = self._callbacks.get(bytes(message.goal_id.uuid))
        if callback is not None:
            callback(message)

    def _take_status(self, message: Any) -> None:
        for item in message.status_list:
            goal = self._goals.get(bytes(item.goal_info.goal_id.uuid))
            if goal is not None:
                goal.status = item.status
