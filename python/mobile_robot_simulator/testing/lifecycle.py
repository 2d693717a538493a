"""Lifecycle nodes of the stand-in, with the names of `rclpy.lifecycle`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from functools import wraps
from typing import Any

from ..bus.node import Node
from ..bus.topic import BusPublisher
from ..quoting import quoted
from .ros_messages import message_class


class TransitionCallbackReturn(Enum):
    """What a callback of a transition returns, numbered as in rclpy."""

    SUCCESS = 97
    FAILURE = 98
    ERROR = 99


@dataclass(frozen=True)
class LifecycleState:
    """A state of a node.

    Attributes:
        state_id: Its number in `lifecycle_msgs/msg/State`.
        label: Its name, such as `inactive`.
    """

    state_id: int
    label: str


UNCONFIGURED = LifecycleState(1, "unconfigured")
INACTIVE = LifecycleState(2, "inactive")
ACTIVE = LifecycleState(3, "active")
FINALIZED = LifecycleState(4, "finalized")


@dataclass(frozen=True)
class Transition:
    """A transition between two states.

    Attributes:
        id: Its number in `lifecycle_msgs/msg/Transition`.
        label: Its name. The node's callback is `on_<label>`.
        start: State from which it starts.
        success: State after the callback has returned SUCCESS.
        failure: State after the callback has returned FAILURE.
    """

    id: int
    label: str
    start: LifecycleState
    success: LifecycleState
    failure: LifecycleState


TRANSITIONS = (
    Transition(1, "configure", UNCONFIGURED, INACTIVE, UNCONFIGURED),
    Transition(2, "cleanup", INACTIVE, UNCONFIGURED, INACTIVE),
    Transition(3, "activate", INACTIVE, ACTIVE, INACTIVE),
    Transition(4, "deactivate", ACTIVE, INACTIVE, ACTIVE),
    Transition(5, "shutdown", UNCONFIGURED, FINALIZED, FINALIZED),
    Transition(6, "shutdown", INACTIVE, FINALIZED, FINALIZED),
    Transition(7, "shutdown", ACTIVE, FINALIZED, FINALIZED),
)
"""All transitions that can be asked for (https://design.ros2.org/articles/node_lifecycle.html)."""


class ManagedEntity:
    """Something that a lifecycle node configures and activates together with itself. Each method is a callback."""

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Called when the node is configured, with its state before."""
        return TransitionCallbackReturn.SUCCESS

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Called when the node is cleaned up, with its state before."""
        return TransitionCallbackReturn.SUCCESS

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Called when the node is shut down, with its state before."""
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Called when the node is activated, with its state before."""
        return TransitionCallbackReturn.SUCCESS

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Called when the node is deactivated, with its state before."""
        return TransitionCallbackReturn.SUCCESS

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Called when another callback has failed with an error, with the node's state before."""
        return TransitionCallbackReturn.SUCCESS


class SimpleManagedEntity(ManagedEntity):
    """An entity that knows whether it is active.

    Attributes:
        is_activated: True while the node is active.
    """

    is_activated = False

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Activates the entity."""
        self.is_activated = True
        return TransitionCallbackReturn.SUCCESS

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Deactivates the entity."""
        self.is_activated = False
        return TransitionCallbackReturn.SUCCESS

    @staticmethod
    def when_enabled(
        wrapped: Callable[..., None] | None = None, *, when_not_enabled: Callable[..., None] | None = None
    ) -> Any:
        """Decorates a method that does nothing while the entity is not active.

        Args:
            wrapped: The method.
            when_not_enabled: Called without arguments instead.
        """

        def decorate(method: Callable[..., None]) -> Callable[..., None]:
            @wraps(method)
            def call(self: SimpleManagedEntity, *args: Any, **kwargs: Any) -> None:
                if self.is_activated:
                    method(self, *args, **kwargs)
                elif when_not_enabled is not None:
                    when_not_enabled()

            return call

        return decorate if wrapped is None else decorate(wrapped)


class LifecyclePublisher(SimpleManagedEntity, BusPublisher[Any]):
    """A publisher that drops messages while its node is not active."""

    @SimpleManagedEntity.when_enabled
    def publish(self, message: Any) -> None:
        """Sends a copy of the message if the node is active. Raises the errors of `BusPublisher.publish`."""
        BusPublisher.publish(self, message)


class LifecycleNode(ManagedEntity, Node):
    """Replaces `rclpy.lifecycle.LifecycleNode`. It offers the services `~/change_state` and `~/get_state`.

    A callback `on_...` that raises an exception counts as one that returns ERROR, as on ROS; the exception is logged.

    Args:
        node_name: Name of the node.
        enable_communication_interface: If False, the node does not offer the services.
        **kwargs: Arguments of `Node`.
    """

    def __init__(self, node_name: str, *, enable_communication_interface: bool = True, **kwargs: Any) -> None:
        super().__init__(node_name, **kwargs)
        self._state = UNCONFIGURED
        self._managed: list[ManagedEntity] = []
        if enable_communication_interface:
            for name, answer in (("ChangeState", self._change_state), ("GetState", self._get_state)):
                service = name.replace("State", "_state").lower()
                self.create_service(message_class(f"lifecycle_msgs/srv/{name}"), f"~/{service}", answer)

    def trigger_configure(self) -> TransitionCallbackReturn:
        """Configures the node. Returns what `on_configure` has returned, or ERROR if the state does not allow it."""
        return self._trigger("configure")

    def trigger_cleanup(self) -> TransitionCallbackReturn:
        """Cleans the node up. Returns what `on_cleanup` has returned, or ERROR if the state does not allow it."""
        return self._trigger("cleanup")

    def trigger_activate(self) -> TransitionCallbackReturn:
        """Activates the node. Returns what `on_activate` has returned, or ERROR if the state does not allow it."""
        return self._trigger("activate")

    def trigger_deactivate(self) -> TransitionCallbackReturn:
        """Deactivates the node. Returns what `on_deactivate` has returned, or ERROR if the state does not allow it."""
        return self._trigger("deactivate")

    def trigger_shutdown(self) -> TransitionCallbackReturn:
        """Shuts the node down. Returns what `on_shutdown` has returned.

        Raises:
            RuntimeError: The node is already shut down.
        """
        if self._state == FINALIZED:
            raise RuntimeError(f"{self.get_name()} is finalized, so it cannot be shut down")
        return self._trigger("shutdown")

    def add_managed_entity(self, entity: ManagedEntity) -> None:
        """Adds an entity that the default callbacks of the node call.

        Raises:
            TypeError: It is not a `ManagedEntity`.
        """
        if not isinstance(entity, ManagedEntity):
            raise TypeError(f"a managed entity must be a ManagedEntity, got {quoted(entity)}")
        self._managed.append(entity)

    def create_lifecycle_publisher(self, msg_type: Any, topic: str, qos_profile: Any, **_: Any) -> LifecyclePublisher:
        """Creates a publisher that drops messages while the node is not active. Raises the errors of `create_publisher`."""
        publisher = self.create_publisher(msg_type, topic, qos_profile, publisher_class=LifecyclePublisher)
        assert isinstance(publisher, LifecyclePublisher)
        self.add_managed_entity(publisher)
        return publisher

    def destroy_lifecycle_publisher(self, publisher: LifecyclePublisher) -> bool:
        """Destroys a publisher. Returns True."""
        self._managed = [entity for entity in self._managed if entity is not publisher]
        return self.destroy_publisher(publisher)

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Calls `on_configure` of the managed entities, up to the first that does not return SUCCESS."""
        return self._call_entities("on_configure", state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Calls `on_cleanup` of the managed entities, up to the first that does not return SUCCESS."""
        return self._call_entities("on_cleanup", state)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Calls `on_shutdown` of the managed entities, up to the first that does not return SUCCESS."""
        return self._call_entities("on_shutdown", state)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Calls `on_activate` of the managed entities, up to the first that does not return SUCCESS."""
        return self._call_entities("on_activate", state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Calls `on_deactivate` of the managed entities, up to the first that does not return SUCCESS."""
        return self._call_entities("on_deactivate", state)

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Calls `on_error` of the managed entities, up to the first that does not return SUCCESS."""
        return self._call_entities("on_error", state)

    def save(self) -> Any:
        """Returns the state that `restore` takes: that of the node, and which publishers are active."""
        active = [(it, it.is_activated) for it in self._managed if isinstance(it, LifecyclePublisher)]
        return super().save(), active

    def restore(self, state: Any) -> None:
        """Puts the node back into a saved state."""
        attributes, active = state
        super().restore(attributes)
        for publisher, is_activated in active:
            publisher.is_activated = is_activated

    def _call_entities(self, name: str, state: LifecycleState) -> TransitionCallbackReturn:
        answers = (self._checked(getattr(entity, name)(state), name) for entity in tuple(self._managed))
        success = TransitionCallbackReturn.SUCCESS
        return next((answer for answer in answers if answer is not success), success)

    def _trigger(self, label: str) -> TransitionCallbackReturn:
        before = self._state
        transition = next((it for it in TRANSITIONS if (it.label, it.start) == (label, before)), None)
        if transition is None:
            self.get_logger().error(f"{self.get_name()} is {before.label}, so it cannot {label}")
            return TransitionCallbackReturn.ERROR
        answer = self._answer(f"on_{label}", before)
        if answer is TransitionCallbackReturn.ERROR:
            recovered = self._answer("on_error", before) is TransitionCallbackReturn.SUCCESS
            self._state = UNCONFIGURED if recovered else FINALIZED
        else:
            self._state = transition.success if answer is TransitionCallbackReturn.SUCCESS else transition.failure
        return answer

    def _answer(self, name: str, before: LifecycleState) -> TransitionCallbackReturn:
        try:
            answer = getattr(self, name)(before)
        except Exception as error:
            self.get_logger().error(f"{name} of {self.get_name()} raised {error!r}")
            return TransitionCallbackReturn.ERROR
        return self._checked(answer, name)

    def _checked(self, answer: Any, name: str) -> TransitionCallbackReturn:
        if not isinstance(answer, TransitionCallbackReturn):
            raise TypeError(f"{name} must return a TransitionCallbackReturn, got {quoted(answer)}")
        return answer

    def _change_state(self, request: Any, response: Any) -> Any:
        asked = request.transition
        known = {(it.id, it.start): it.label for it in TRANSITIONS}
        label = asked.label or known.get((asked.id, self._state), f"do transition {asked.id}")
        response.success = self._trigger(label) is TransitionCallbackReturn.SUCCESS
        return response

    def _get_state(self, request: Any, response: Any) -> Any:
        response.current_state.id, response.current_state.label = self._state.state_id, self._state.label
        return response


LIFECYCLE: dict[str, object] = {
    **{
        kind.__name__: kind
        for kind in (LifecycleNode, LifecyclePublisher, LifecycleState, ManagedEntity, SimpleManagedEntity)
    },
    "Node": LifecycleNode,
    "Publisher": LifecyclePublisher,
    "State": LifecycleState,
    "TransitionCallbackReturn": TransitionCallbackReturn,
}
"""Contents of `rclpy.lifecycle`."""
