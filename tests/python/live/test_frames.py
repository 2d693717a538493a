"""Frames: what a page draws."""

import base64
import json

import numpy as np
import pytest
from sessions import do, robot, session_of, turns

import mobile_robot_simulator as mrs
from mobile_robot_simulator.live.frames import FrameMaker
from simulations import pair


def part(frame, name):
    return json.loads(frame.parts[name])


def test_scan_points_are_where_the_beams_end():
    session = session_of(robot(apply_noise=False))
    maker = FrameMaker(session)
    turns(session, 0.5)
    scan = part(maker.make(), "scan::")
    points = np.frombuffer(base64.b64decode(scan["points"]), np.float32).reshape(-1, 2)
    hits = np.frombuffer(base64.b64decode(scan["hits"]), np.uint8)
    assert len(points) == 61 and hits.all() and scan["count"] == 61
    assert points[30] == pytest.approx((19.9, 3.0), abs=1e-4)  # straight ahead is the right wall
    on_walls = np.minimum.reduce([np.abs(points - 0.1).min(axis=1), np.abs(points - 19.9).min(axis=1)])
    assert on_walls.max() < 1e-4


def test_beams_without_a_return_end_at_the_largest_range_and_are_no_points():
    session = session_of(robot(apply_noise=False, laser_max_range=4.0))
    maker = FrameMaker(session)
    turns(session, 0.5)
    scan = part(maker.make(), "scan::")
    points = np.frombuffer(base64.b64decode(scan["points"]), np.float32).reshape(-1, 2)
    hits = np.frombuffer(base64.b64decode(scan["hits"]), np.uint8).astype(bool)
    distances = np.hypot(*(points - (3.0, 3.0)).T)
    assert 0 < hits.sum() < 61 and scan["count"] == hits.sum()
    assert distances[~hits] == pytest.approx(4.0, abs=1e-3) and (distances[hits] < 3.999).all()


def test_a_part_that_has_not_changed_has_the_same_bytes():
    session = session_of(robot())
    maker = FrameMaker(session)
    wall = turns(session, 0.5)
    before = maker.make()
    turns(session, 0.02, wall)
    after = maker.make()
    changed = {name for name in after.parts if before.parts[name] != after.parts[name]}
    assert changed == {"now"}


def test_the_state_of_the_session_is_shown():
    session = session_of(pair())
    maker = FrameMaker(session)
    do(session, "add_fault", text="Drop('/robot1/scan')")
    do(session, "save_state", name="here")
    do(session, "speed", factor=2.0)
    do(session, "set_goal", robot="robot1", x=5.0, y=15.0, yaw=0.5)
    state = part(maker.make(), "session")
    assert state["faults"] == [{"text": "Drop('/robot1/scan')", "acts": True, "stopped": False}]
    assert state["states"] == {"here": 0.0} and state["speed"] == 2.0 and not state["paused"]
    assert state["pilots"] == {"robot1": {"title": "goal", "goal": [5.0, 15.0, 0.5]}}
    assert state["recording"] is None and state["free_name"] == "drive-1"


def test_parameters_are_yaml_texts_and_change():
    session = session_of(robot())
    maker = FrameMaker(session)
    nodes = part(maker.make(), "settings")["nodes"]
    assert [(node["robot"], node["scanner"]) for node in nodes] == [("", None), ("", "")]
    assert nodes[1]["values"]["laser_frequency"] == "20.0" and nodes[0]["values"]["velocity_limits"] == "null"
    do(session, "set_parameter", robot="", scanner="", name="laser_frequency", value="5")
    assert part(maker.make(), "settings")["nodes"][1]["values"]["laser_frequency"] == "5.0"


def test_obstacles_have_their_outline_and_velocity():
    session = session_of(robot())
    maker = FrameMaker(session)
    session.simulation.add_obstacle(mrs.Shape.disc(0.3), lambda time: (5.0 + 2.0 * time, 6.0, 0.0), "cart")
    session.simulation.add_obstacle(mrs.Shape.rectangle(2.0, 1.0), (9.0, 9.0, 0.0), "box")
    turns(session, 0.52)
    cart, box = part(maker.make(), "obstacles")
    assert cart["radius"] == 0.3 and cart["pose"][0] == pytest.approx(6.0, abs=0.01) and cart["velocity"] == [2.0, 0.0]
    assert sorted(box["corners"]) == [[-1.0, -0.5], [-1.0, 0.5], [1.0, -0.5], [1.0, 0.5]] and box["velocity"] == [0.0, 0.0]


def test_contacts_are_shown_where_they_are():
    session = session_of(robot(contact="stop"))
    maker = FrameMaker(session)
    do(session, "set_pose", robot="", x=19.0, y=5.0, yaw=0.0)
    session.pilots.hold("", (2.0, 0.0, 0.0), 100.0)
    turns(session, 1.0)
    assert part(maker.make(), "contacts") == {"": [[19.9, 5.0]]}


def test_a_reset_starts_the_path_anew():
    session = session_of(robot())
    maker = FrameMaker(session)
    session.pilots.hold("", (1.0, 0.0, 0.0), 100.0)
    wall = 100.0
    for _ in range(20):
        wall = turns(session, 0.02, wall)
        maker.make()
    before = maker.make().trails[""]
    count, epoch = len(before.points), before.epoch
    do(session, "reset")
    after = maker.make().trails[""]
    assert count > 10 and after.epoch == epoch + 1 and len(after.points) == 1
