"""Lifecycle nodes: states, services, errors, managed entities and publishers."""

from __future__ import annotations

import pytest

from mobile_robot_simulator.testing import stand_in
from simulations import small_room

with stand_in():
    from lifecycle_msgs.msg import State as StateMessage
    from lifecycle_msgs.msg import Transition
    from lifecycle_msgs.srv import ChangeState, GetState
    from rclpy.lifecycle import LifecycleNode, SimpleManagedEntity, TransitionCallbackReturn
    from std_msgs.msg import String

SUCCESS, FAILURE, ERROR = TransitionCallbackReturn


class Managed(LifecycleNode):
    """Its callbacks return or raise what `answers` says."""

    def __init__(self):
        super().__init__("managed")
        self.answers, self.seen = {}, []
        self.pub = self.create_lifecycle_publisher(String, "text", 10)

    def answer(self, name, state, default):
        self.seen.append((name, state.label))
        answer = self.answers.get(name, default)
        if isinstance(answer, Exception):
            raise answer
        return answer

    def on_configure(self, state):
        return self.answer("configure", state, SUCCESS)

    def on_activate(self, state):
        return self.answer("activate", state, super().on_activate(state))

    def on_shutdown(self, state):
        return self.answer("shutdown", state, SUCCESS)

    def on_error(self, state):
        return self.answer("error", state, SUCCESS)


@pytest.fixture
def sim():
    return small_room()


@pytest.fixture
def node(sim):
    return sim.spawn(Managed)


@pytest.fixture
def state(sim):
    """A function that asks for the state of the node."""
    client = sim.create_node("asker").create_client(GetState, "/managed/get_state")

    def ask():
        future = client.call_async(GetState.Request())
        sim.run_for(0.0)
        found = future.result().current_state
        assert found.id == getattr(StateMessage, f"PRIMARY_STATE_{found.label.upper()}")
        return found.label

    return ask


def test_a_node_goes_through_its_states(node, state):
    steps = [state()]
    for trigger in ("configure", "activate", "deactivate", "cleanup", "configure", "activate", "shutdown"):
        assert getattr(node, f"trigger_{trigger}")() is SUCCESS
        steps.append(state())
    inactive = ["unconfigured", "inactive"]
    assert steps == [*inactive, "active", *inactive[::-1], "inactive", "active", "finalized"]
    assert node.seen[-1] == ("shutdown", "active")
    with pytest.raises(RuntimeError, match="managed is finalized, so it cannot be shut down"):
        node.trigger_shutdown()


def test_a_transition_from_a_wrong_state_is_an_error(node, state, caplog):
    assert node.trigger_activate() is ERROR and node.seen == [] and state() == "unconfigured"
    assert "managed is unconfigured, so it cannot activate" in caplog.text


@pytest.mark.parametrize(
    ("answers", "result", "after"),
    [
        ({"configure": FAILURE}, FAILURE, "unconfigured"),
        ({"configure": ERROR}, ERROR, "unconfigured"),
        ({"configure": OSError("out of coffee")}, ERROR, "unconfigured"),
        ({"configure": ERROR, "error": FAILURE}, ERROR, "finalized"),
        ({"configure": ERROR, "error": OSError()}, ERROR, "finalized"),
    ],
)
def test_callbacks_can_fail(node, state, answers, result, after, caplog):
    node.answers = answers
    assert node.trigger_configure() is result and state() == after
    assert [name for name, _ in node.seen] == (["configure"] if result is FAILURE else ["configure", "error"])
    assert ("on_configure of managed raised OSError('out of coffee')" in caplog.text) == ("coffee" in str(answers))


def test_a_callback_must_return_a_result(node, state):
    node.answers = {"configure": None}
    with pytest.raises(TypeError, match="on_configure must return a TransitionCallbackReturn, got None"):
        node.trigger_configure()
    assert state() == "unconfigured"


@pytest.mark.parametrize(
    ("transition", "success"),
    [
        (Transition(id=Transition.TRANSITION_CONFIGURE), True),
        (Transition(label="configure"), True),
        (Transition(id=Transition.TRANSITION_ACTIVATE), False),
        (Transition(id=Transition.TRANSITION_ACTIVE_SHUTDOWN), False),
        (Transition(id=99), False),
    ],
)
def test_a_service_changes_the_state(sim, node, state, transition, success, caplog):
    future = (
        sim.create_node("caller")
        .create_client(ChangeState, "/managed/change_state")
        .call_async(ChangeState.Request(transition=transition))
    )
    sim.run_for(0.0)
    assert (future.result().success, state()) == (success, "inactive" if success else "unconfigured")
    assert ("it cannot do transition 99" in caplog.text) == (transition.id == 99)


def test_a_restore_brings_the_state_of_node_and_publisher_back(sim, node, state):
    heard = []
    sim.subscribe("/text", String, heard.append)
    node.trigger_configure()
    saved = sim.save()
    for count in (1, 2):
        node.trigger_activate()
        node.pub.publish(String(data="x"))
        assert state() == "active" and len(heard) == count
        sim.restore(saved)
        node.pub.publish(String(data="x"))
        assert state() == "inactive" and len(heard) == count


def test_entities_are_activated_with_the_node(sim, node):
    dropped, done = [], []

    class Entity(SimpleManagedEntity):
        @SimpleManagedEntity.when_enabled(when_not_enabled=lambda: dropped.append(1))
        def work(self, item):
            done.append(item)

    entity = Entity()
    node.add_managed_entity(entity)
    entity.work("a")
    node.trigger_configure()
    node.trigger_activate()
    entity.work("b")
    assert (dropped, done, node.pub.is_activated) == ([1], ["b"], True)
    assert node.destroy_lifecycle_publisher(node.pub) and node.count_publishers("text") == 0
    node.trigger_deactivate()
    assert not entity.is_activated and node.pub.is_activated
    with pytest.raises(TypeError, match="must be a ManagedEntity, got 1"):
        node.add_managed_entity(1)
