"""The nodes that the stand-in for rclpy is tested with: the real rclpy imports and creates them too."""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from worlds import Ros2World, wait_until

NODES = Path(__file__).parents[1] / "python/testing/ros_nodes"
NOT_INSTALLED = {"example_interfaces", "message_filters", "my_robot_msgs", "tf2_geometry_msgs", "tf2_ros"}
"""Packages of the nodes that PyPI does not have."""


@pytest.fixture
def executor(world: Ros2World) -> Iterator[Any]:
    """An executor that spins in a thread, in the default context, which nodes use that name no other."""
    import rclpy
    from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor

    rclpy.init(domain_id=int(os.environ["ROS_DOMAIN_ID"]))
    executor = MultiThreadedExecutor(num_threads=4)

    def spin() -> None:
        try:
            executor.spin()
        except ExternalShutdownException:
            pass

    thread = threading.Thread(target=spin)
    thread.start()
    yield executor
    executor.shutdown()
    rclpy.shutdown()
    thread.join()


@pytest.fixture
def module(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Any:
    """A module of the folder, imported under the real rclpy."""
    monkeypatch.syspath_prepend(str(NODES))
    try:
        yield import_module(request.param)
    except ModuleNotFoundError as error:
        package = (error.name or "").partition(".")[0]
        if package not in NOT_INSTALLED:
            raise
        pytest.skip(f"{package} is not installed")
    finally:
        sys.modules.pop(request.param, None)


@pytest.mark.parametrize("module", sorted(path.stem for path in NODES.glob("*.py")), indirect=True)
def test_the_real_rclpy_creates_every_node(executor: Any, module: Any) -> None:
    from rclpy.node import Node

    kinds = [kind for kind in vars(module).values() if isinstance(kind, type) and kind.__module__ == module.__name__]
    assert kinds and all(issubclass(kind, Node) for kind in kinds)
    nodes = []
    for kind in kinds:
        nodes.append(kind())
        executor.add_node(nodes[-1])
    for node in nodes:
        executor.remove_node(node)
        node.destroy_node()


@pytest.mark.parametrize("module", ["fibonacci"], indirect=True)
def test_an_action_has_the_same_results_as_on_the_bus(executor: Any, module: Any) -> None:
    server, client = module.FibonacciServer(), module.FibonacciClient()
    for node in (server, client):
        executor.add_node(node)
    client.send_goal(3)
    wait_until(lambda: client.status is not None, "the result")
    assert client.succeeded and client.sequence == [0, 1, 1, 2] and client.partial == [[0, 1, 1], [0, 1, 1, 2]]
    client.status = None
    client.send_goal(5)
    wait_until(lambda: len(client.partial) == 3, "feedback")
    client.cancel()
    wait_until(lambda: client.status is not None, "the end")
    assert (client.canceling, client.status, client.sequence) == (1, 5, [])
    client.send_goal(0)
    wait_until(lambda: not client.accepted, "the refusal")


@pytest.mark.parametrize("module", ["lifecycle_talker"], indirect=True)
def test_a_lifecycle_node_has_the_same_states_as_on_the_bus(executor: Any, module: Any) -> None:
    from rclpy.lifecycle import TransitionCallbackReturn as Return

    node = module.LifecycleTalker()
    results = [node.trigger_activate(), node.trigger_configure()]
    node.publish()
    results += [node.trigger_activate(), node.trigger_deactivate(), node.trigger_cleanup(), node.trigger_shutdown()]
    assert results == [Return.ERROR, *[Return.SUCCESS] * 5]
    node.destroy_node()
