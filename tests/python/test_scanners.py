"""Several scanners on a robot: parameters, topics, frames, noise, and what they see."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import faults
from mobile_robot_simulator.parameter_files import read_assignment, read_file, to_yaml
from mobile_robot_simulator.parameters import LaserParameters, for_node
from mobile_robot_simulator.scanners import check_robot_names, of_scanner, scanner_names, split

BOTH: dict[str, Any] = {
    "scanners": ["front", "rear"],
    "laser_beam_count": 31,
    "front.laser_mount": (0.3, 0.0, 0.0),
    "rear.laser_mount": (-0.3, 0.0, 3.0),
    "rear.laser_fov": 2.0,
}


def grid() -> mrs.OccupancyGrid:
    return mrs.floor_plan("office", seed=1, size=(12.0, 10.0))


def simulation(**values: Any) -> mrs.Simulation:
    return mrs.Simulation(grid(), start=grid().draw_free_pose(radius=0.6, seed=1), parameters={**BOTH, **values})


def test_each_scanner_has_a_topic_a_frame_and_noise_of_its_own() -> None:
    sim = simulation()
    sim.run_for(0.1)
    for name, (lasers, scan) in {
        "front": ((0.3, 0.0, 0.0), "/front/scan"),
        "rear": ((-0.3, 0.0, 3.0), "/rear/scan"),
    }.items():
        message, laser = sim.latest(scan), sim.named(None).scanners[name]
        assert message.header.frame_id == f"{name}_laser" and laser.scanner.mount == mrs.Pose(*lasers)
        expected = laser.scanner.scan_batch(
            sim.grid, [sim.pose], noise=laser.parameters.beam_model, seed=laser.parameters.seed, first_index=0
        )
        assert np.array_equal(message.ranges, laser.scanner.mark_invalid(expected[0]))
    assert sim.laser is sim.named(None).scanners["front"]
    assert sim.latest("/rear/scan").angle_max == 1.0
    assert "/scan" not in sim._bus.topic_names()


def test_the_noise_of_a_scanner_does_not_depend_on_the_others() -> None:
    values = {name: value for name, value in BOTH.items() if not name.startswith("front.")} | {"scanners": ["rear"]}
    both = simulation()
    alone = mrs.Simulation(both.grid, start=both.pose, parameters=values)
    for sim in (both, alone):
        sim.run_for(1.0)
    assert both.latest("/rear/scan") == alone.latest("/rear/scan")
    seeds = [laser.parameters.seed for laser in both.named(None).scanners.values()]
    assert len({*seeds, 0}) == 3


def test_scanners_of_one_robot_see_others_and_not_their_own() -> None:
    own = {"apply_noise": False, "robot_radius": 0.25, "laser_max_range": 4.0}
    start = {"one": (5.0, 5.0, 0.0), "two": (7.0, 5.0, 0.0)}
    empty = mrs.OccupancyGrid(np.zeros((100, 100), np.int8), resolution=0.1)
    sim = mrs.Simulation(empty, robots=start, parameters={**BOTH, **own, "laser_beam_count": 1})
    sim.run_for(0.1)
    assert sim.latest("/one/front/scan").ranges == pytest.approx([2.0 - 0.3 - 0.25])
    assert sim.latest("/one/rear/scan").ranges.tolist() == [np.inf]
    assert sim.latest("/two/front/scan").header.frame_id == "two/front_laser"
    mounts = [message.transforms[0].child_frame_id for topic, message, _ in sim._bus.latched() if topic == "/tf_static"]
    assert mounts == ["one/front_laser", "one/rear_laser", "two/front_laser", "two/rear_laser"]


def test_all_scanners_are_saved_and_restored() -> None:
    sim = simulation()
    sim.run_for(0.5)
    state = sim.save()
    sim.run_for(1.0)
    first = [sim.latest(topic) for topic in ("/front/scan", "/rear/scan")]
    sim.restore(state)
    sim.run_for(1.0)
    assert [sim.latest(topic) for topic in ("/front/scan", "/rear/scan")] == first


def test_an_outage_of_the_laser_stops_all_scanners() -> None:
    sim = simulation()
    sim.add_fault(faults.Outage("laser", start=0.25, end=0.95))
    counts = {"/front/scan": 0, "/rear/scan": 0}
    for topic in counts:
        sim.subscribe(topic, mrs.messages.LaserScan, lambda _, topic=topic: counts.update({topic: counts[topic] + 1}))
    sim.run_for(0.9)
    assert counts == {"/front/scan": 2, "/rear/scan": 2}
    sim.run_for(0.5)
    assert counts["/front/scan"] == counts["/rear/scan"] > 4


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"front.laser_mount": (0.3, 0.0, 0.0)}, r"front.laser_mount needs front among the scanners, got scanners=\[\]"),
        ({"scanners": ["front"], "rear.seed": 1}, r"rear.seed needs rear among the scanners, got scanners=\[front\]"),
        ({"scanners": ["a", "a"]}, "scanners must be a list of different names"),
        ({"scanners": "front"}, r"scanners must be a list of names such as \[front, rear\], got 'front'"),
        ({"scanners": ["front"], "front.laser_fow": 1}, "unknown parameter 'front.laser_fow'"),
        ({"scanners": ["front"], "front.publish_rate": 1}, "unknown parameter 'front.publish_rate'"),
        ({"scanners": ["front"], "front.laser_fov": 9.0}, "laser_fov must be less than or equal to"),
    ],
)
def test_wrong_parameters_of_scanners_are_refused(values: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        mrs.Simulation(grid(), start=grid().draw_free_pose(radius=0.6, seed=1), parameters=values)


def test_values_come_from_the_scanner_then_from_all() -> None:
    values = {
        "laser_topic": "lidar/scan",
        "seed": 7,
        "laser_fov": 1.0,
        "a.laser_fov": 2.0,
        "a.seed": 9,
        "scanners": ["a", "b"],
    }
    assert scanner_names(values) == ("a", "b") and scanner_names({}) == ("",)
    check_robot_names(values)
    a, b = (for_node(LaserParameters, of_scanner(name, values)) for name in "ab")
    assert (a.laser_topic, a.laser_frame_id, a.laser_fov, a.seed) == ("lidar/a/scan", "a_laser", 2.0, 9)
    assert (b.laser_topic, b.laser_frame_id, b.laser_fov) == ("lidar/b/scan", "b_laser", 1.0) and b.seed not in (7, 9)
    of_the_node = {f"{LaserParameters.node_name}:laser_fov": 3.0}
    assert for_node(LaserParameters, of_scanner("a", {**values, **of_the_node})).laser_fov == 2.0
    assert for_node(LaserParameters, of_scanner("b", {**values, **of_the_node})).laser_fov == 3.0
    assert of_scanner("", values) == values
    assert split("front.laser_mount") == ("front", "laser_mount") == split("laser_scanner_simulator_node:front.laser_mount")
    assert split("front.publish_rate") == ("", "front.publish_rate")


def test_scanners_are_read_from_files_and_assignments(tmp_path: Path) -> None:
    file = tmp_path / "parameters.yaml"
    file.write_text(to_yaml(BOTH), encoding="utf-8")
    read = read_file(file)
    for scanner in ("front", "rear"):
        assert for_node(LaserParameters, of_scanner(scanner, read)) == for_node(LaserParameters, of_scanner(scanner, BOTH))
    assert read_assignment("front.laser_mount:=[1, 2, 3]") == ("front.laser_mount", [1, 2, 3])
    with pytest.raises(ValueError, match=r"unknown parameter 'front\.laser_fow'"):
        read_assignment("front.laser_fow:=1")
