"""EitherSubscription: it follows the type that others publish."""

from __future__ import annotations

from typing import Any

import pytest

from mobile_robot_simulator.messages import Twist, TwistStamped
from mobile_robot_simulator.ros.either_subscription import EitherSubscription

PLAIN, STAMPED = Twist.ros_type, TwistStamped.ros_type


class Rig:
    """Counts what is subscribed, and collects the log."""

    def __init__(self) -> None:
        self.active: list[type] = []
        self.log: list[str] = []
        self.refusals = 0
        callbacks: dict[type, Any] = {TwistStamped: "stamped", Twist: "plain"}

        def subscribe(kind: type, callback: Any) -> type:
            assert callbacks[kind] == callback
            if self.refusals:
                self.refusals -= 1
                raise TypeError("existing topic name with incompatible type")
            self.active.append(kind)
            return kind

        self.either = EitherSubscription("/cmd_vel", callbacks, subscribe, self.active.remove, self)

    def info(self, message: str) -> None:
        self.log.append(message)

    warning = info


@pytest.mark.parametrize("published", [[], ["std_msgs/msg/String"], [STAMPED]])
def test_the_first_type_stays_while_nobody_publishes_only_another(published: list[str]) -> None:
    rig = Rig()
    rig.either.update(published)
    assert rig.active == [TwistStamped] and not rig.log


def test_the_type_changes_with_what_is_published_and_the_log_says_so() -> None:
    rig = Rig()
    for _ in range(3):
        rig.either.update([PLAIN])
    assert rig.active == [Twist]
    assert rig.log == [f"topic /cmd_vel is published as {PLAIN}, not {STAMPED}: using that"]
    rig.either.update([])
    assert rig.active == [Twist]
    rig.either.update([STAMPED])
    assert rig.active == [TwistStamped] and len(rig.log) == 2
    rig.either.destroy()
    assert rig.active == []


def test_if_the_middleware_refuses_the_new_type_the_next_update_tries_again() -> None:
    rig = Rig()
    rig.refusals = 2
    for active in ([], [], [Twist], [Twist]):
        rig.either.update([PLAIN])
        assert rig.active == active
    assert len(rig.log) == 1


def test_of_several_types_the_current_one_stays_with_one_warning() -> None:
    rig = Rig()
    rig.either.update([PLAIN])
    for _ in range(3):
        rig.either.update([STAMPED, PLAIN])
    assert rig.active == [Twist]
    assert rig.log[1:] == [f"topic /cmd_vel is published with several types: {PLAIN} is used, {STAMPED} is ignored"]
