"""wrong calls: each says what is wrong, what it got and what it needs, and none is accepted in silence."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import faults
from simulations import drive, hall, small_room

DISC = mrs.Shape.disc(0.1)


def nothing(*_: object) -> None:
    pass


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: mrs.save_map(3, "x.yaml"), TypeError, "the grid must be an OccupancyGrid, got 3"),
        (lambda: mrs.save_map(hall(), 3), TypeError, "the path of a map must be a text or a Path, got 3"),
        (lambda: mrs.load_map(3), TypeError, "the path of a map must be a text or a Path, got 3"),
        (lambda: mrs.load_map(""), ValueError, "the path of a map must name a file, got ''"),
        (lambda: mrs.floor_plan("office", seed="a"), TypeError, "seed must be an integer, got 'a'"),
        (lambda: mrs.floor_plan("office", seed=1.5), TypeError, "seed must be an integer, got 1.5"),
        (lambda: mrs.floor_plan("office", resolution="a"), TypeError, "resolution must be a number [m], got 'a'"),
        (lambda: faults.Drop(3), TypeError, "the name of a topic or service must be a text, got 3"),
        (lambda: faults.Drop("/scan", probability="a"), TypeError, "probability must be a number, got 'a'"),
        (lambda: faults.Drop("/scan", start="a"), TypeError, "start must be a number, got 'a'"),
        (lambda: faults.Drop("/scan", seed="a"), TypeError, "seed must be an integer, got 'a'"),
        (lambda: faults.Delay("/scan", "a"), TypeError, "seconds must be a number, got 'a'"),
        (
            lambda: faults.BlockedSector(-20, 20),
            ValueError,
            "first_angle must be in [-2π, 2π] radians, got -20; -20° is -0.3491 rad",
        ),
        (
            lambda: faults.BlockedSector(0, 20),
            ValueError,
            "last_angle must be in [-2π, 2π] radians, got 20; 20° is 0.3491 rad",
        ),
        (lambda: faults.BlockedSector("a", "b"), TypeError, "first_angle must be a number, got 'a'"),
        (lambda: faults.Slip("a"), TypeError, "share must be a number, got 'a'"),
        (lambda: faults.ClockJump("a", at=1.0), TypeError, "seconds must be a number, got 'a'"),
    ],
)
def test_functions(call: Callable[[], object], error: type[Exception], message: str) -> None:
    with pytest.raises(error) as caught:
        call()
    assert str(caught.value) == message


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda sim: sim.create_node(3), TypeError, "a node's name must be a text, got 3"),
        (
            lambda sim: sim.create_node("a", namespace=3),
            TypeError,
            "a node's namespace must be a text such as /robot1, got 3",
        ),
        (
            lambda sim: sim.create_node("a", parameters="b"),
            TypeError,
            "a node's parameters must be a mapping from names to values, got 'b'",
        ),
        (
            lambda sim: sim.create_node("a").create_timer("a", nothing),
            TypeError,
            "a timer's period must be a number of seconds, got 'a'",
        ),
        (
            lambda sim: sim.robot.set_pose((1, 2, 0)),
            TypeError,
            "the pose must be a Pose, got (1, 2, 0); Simulation.set_pose also takes (x, y, yaw)",
        ),
        (lambda sim: sim.robot.slip(5), ValueError, "the share must be in 0..1, got 5"),
        (lambda sim: sim.robot.slip("a"), TypeError, "the share must be a number or None, got 'a'"),
        (lambda sim: sim.robot.drift(3, 1), TypeError, "the noise must be a MotionNoise or None, got 3"),
        (lambda sim: sim.robot.drift(None, "a"), TypeError, "the seed must be an integer, got 'a'"),
        (lambda sim: sim.move_obstacle(3), ValueError, "the obstacle must be in the world, got 3"),
        (lambda sim: sim.remove_obstacle(3), ValueError, "the obstacle must be in the world, got 3"),
        (lambda sim: sim.draw(3), TypeError, "a picture's file must be a text or a Path, got 3"),
        (lambda sim: sim.plot(3), TypeError, "ax must be Matplotlib axes or None, got 3"),
        (lambda sim: sim.grid.plot(3), TypeError, "ax must be Matplotlib axes or None, got 3"),
        (lambda sim: sim.unsubscribe(3), TypeError, "the subscription must be one that subscribe returned, got 3"),
        (
            lambda sim: sim.unsubscribe(small_room().subscribe("/scan", mrs.messages.LaserScan, nothing)),
            ValueError,
            "the subscription to /scan must be one of this simulation's subscribe",
        ),
        (lambda sim: sim.add_obstacle(DISC, (3, 3, 0), name=3), TypeError, "an obstacle's name must be a text, got 3"),
        (
            lambda sim: sim.spawn(print),
            TypeError,
            "spawn needs a class derived from bus.Node, or a function that creates one, got <built-in function print>, "
            "which created none",
        ),
        (lambda sim: sim.spawn(print, parameters=3), TypeError, "parameters must be a mapping from names to values, got 3"),
        (lambda sim: sim.record(3), TypeError, "a callback must be callable, got 3"),
        (
            lambda sim: sim.stop_recording(print),
            ValueError,
            "the tap must be one that is recording, got <built-in function print>",
        ),
        (lambda sim: sim.named("bob"), ValueError, "unknown robot 'bob'; the only robot has no name"),
        (
            lambda sim: mrs.Simulation(sim.grid, robots={}).named("bob"),
            ValueError,
            "unknown robot 'bob'; there are none",
        ),
        (
            lambda sim: mrs.Simulation(sim.grid, robots={"ann": (1, 1, 0), "eve": (3, 3, 0)}).named("bob"),
            ValueError,
            "unknown robot 'bob'; there are ann, eve",
        ),
        (
            lambda sim: mrs.Simulation(sim.grid, parameters="seed"),
            TypeError,
            "parameters must be a mapping from names to values, got 'seed'",
        ),
        (
            lambda sim: mrs.Simulation(sim.grid, robots={}).add_robot("ann", parameters=""),
            TypeError,
            "parameters must be a mapping from names to values, got ''",
        ),
        *(
            (
                lambda sim, name=name: mrs.Simulation(sim.grid, robots={name: (1, 1, 0)}),
                error,
                f"a robot's name must consist of letters, digits and _, and not begin with a digit, got {name!r}",
            )
            for name, error in (
                (3, TypeError),
                (None, TypeError),
                ("3", ValueError),
                ("a b", ValueError),
                ("/a", ValueError),
            )
        ),
    ],
)
def test_calls_of_a_simulation(call: Callable[[mrs.Simulation], object], error: type[Exception], message: str) -> None:
    with pytest.raises(error) as caught:
        call(small_room())
    assert str(caught.value) == message


def test_wrong_calls_change_nothing(tmp_path: Path) -> None:
    sim = small_room()
    for call in (lambda: sim.record(3), lambda: sim.robot.slip(2), lambda: sim.add_obstacle(DISC, (3, 3, 0), name=3)):  # type: ignore[arg-type]
        with pytest.raises((TypeError, ValueError)):
            call()
    other = small_room()
    for each in (sim, other):
        drive(each, 0.5)
        each.run_for(1.0)
    assert not sim.obstacles and sim.pose == other.pose and sim.latest("/scan") == other.latest("/scan")
    with pytest.raises(TypeError):
        mrs.save_map(3, tmp_path / "x.yaml")  # type: ignore[arg-type]
    assert not list(tmp_path.iterdir())


def test_spawn_takes_a_function_that_creates_nodes() -> None:
    sim = small_room()
    names = ("first", "second")
    nodes = sim.spawn(lambda: [mrs.bus.Node(name) for name in names], namespace="/robot1")
    assert [node.get_namespace() for node in nodes] == ["/robot1", "/robot1"]
