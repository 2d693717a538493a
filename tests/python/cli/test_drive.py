"""Drive: its path, its results and its random start. The summary is tested here too."""

import json

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.cli.drive import WANTED_CLEARANCE, Drive, draw_start
from mobile_robot_simulator.drivers.script import Script

FORWARD = Script(((0.0, 0.5, 0.0, 0.0),))


def room(rows: int, cols: int) -> mrs.OccupancyGrid:
    cells = np.zeros((rows, cols), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    return mrs.OccupancyGrid(cells, resolution=0.05)


def test_a_drive_counts_what_happened(tmp_path):
    drive = Drive(room(80, 120), FORWARD, {}, 3, start=mrs.Pose(2.0, 2.0))
    seen = []
    summary = drive.run(2.0, progress=seen.append)
    assert seen == [1.0, 2.0]
    assert summary.distance == pytest.approx(1.0) and summary.end == pytest.approx((3.0, 2.0, 0.0))
    assert summary.scans == 20 and summary.beams == 20 * 541 and summary.unknown_share == 0.0
    assert summary.start == (2.0, 2.0, 0.0) and drive.odometry_messages == 20
    summary.save(tmp_path / "summary.json")
    assert json.loads((tmp_path / "summary.json").read_text())["seed"] == 3
    assert ("distance driven", "1.0 m") in summary.rows()


def test_a_random_start_has_room_to_turn_where_the_map_has_it():
    wide, narrow = room(80, 120), room(20, 120)
    start = draw_start(wide, 0.2, 1)
    assert wide.is_free_disc(start.x, start.y, WANTED_CLEARANCE)
    start = draw_start(narrow, 0.2, 1)
    assert narrow.is_free_disc(start.x, start.y, 0.2)
    with pytest.raises(ValueError, match="no known free place"):
        draw_start(narrow, 2.0, 1)


@pytest.mark.parametrize("duration", [3.3333333333, 2.00000000049, 1e-12])
@pytest.mark.parametrize(("real_time", "speed_factor"), [(False, 1.0), (True, 1000.0)])
def test_a_drive_ends_whatever_fraction_of_a_nanosecond_its_duration_has(duration, real_time, speed_factor):
    drive = Drive(room(80, 120), FORWARD, {"speed_factor": speed_factor}, 3, start=mrs.Pose(2.0, 2.0))
    calls = []

    def count(time: float) -> None:
        calls.append(time)
        assert len(calls) < 100, "the drive does not end"

    summary = drive.run(duration, real_time=real_time, progress=count)
    assert summary.simulated_seconds == round(duration, 9)


def test_a_drive_slower_than_a_nanosecond_per_step_goes_on():
    drive = Drive(room(80, 120), FORWARD, {"speed_factor": 1e-9}, 3, start=mrs.Pose(2.0, 2.0))
    seen = []

    def interrupt(time: float) -> None:
        seen.append(time)
        raise KeyboardInterrupt

    assert drive.run(1.0, real_time=True, progress=interrupt).interrupted
    assert seen == [1e-9]


@pytest.mark.parametrize("parameters", [{}, {"robot_radius": 0.2}, {"robot_radius": 0.2, "contact": "stop"}])
def test_a_drive_counts_the_contacts_of_the_truth(parameters):
    """A robot drives into a wall at 1 m/s."""
    drive = Drive(room(80, 120), Script(((0.0, 1.0, 0.0, 0.0),)), parameters, 3, start=mrs.Pose(5.0, 2.0))
    summary = drive.run(2.0)
    (contact,) = drive.simulation.truth.contacts
    assert summary.collisions == 1 and contact.what == "a wall"
    assert contact.pose.x == pytest.approx(5.95 - 0.2, abs=1e-5)
    through = drive.simulation.robot.parameters.contact == "report"
    assert summary.end[0] == pytest.approx(7.0 if through else 5.75, abs=1e-5)


def test_the_picture_of_a_drive_is_that_of_its_simulation(tmp_path):
    """It shows the scan from the mount of the scanner, at the pose at which it was taken."""
    pytest.importorskip("matplotlib")
    parameters = {"laser_frame_id": "laser", "laser_mount": [0.5, 0.2, 0.3], "laser_frequency": 1.5}
    drive = Drive(room(80, 120), FORWARD, parameters, 3, start=mrs.Pose(2.0, 2.0))
    drive.run(2.0)
    drive.draw(tmp_path / "drive.png")
    drive.simulation.draw(tmp_path / "simulation.png")
    assert (tmp_path / "drive.png").read_bytes() == (tmp_path / "simulation.png").read_bytes()
