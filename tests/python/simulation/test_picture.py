"""Pictures of a simulation: all paths and outlines, and the last scan at the pose where it was taken."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

import mobile_robot_simulator as mrs
from mobile_robot_simulator import plotting
from mobile_robot_simulator.testing import assert_reaches
from simulations import twist


def test_a_picture_shows_all_robots_and_the_scan_where_it_was_taken(
    room: mrs.OccupancyGrid, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: dict[str, Any] = {}

    class RecordedPicture:
        def __init__(self, grid: mrs.OccupancyGrid, path: Any, **parts: Any) -> None:
            drawn.update(parts, path=path)

        def save(self, file: Path) -> None:
            drawn["file"] = file

    monkeypatch.setattr(plotting, "DrivePicture", RecordedPicture)
    robots = {"one": (0.0, 0.0, 0.0), "two": (0.0, 3.0, 0.0), "three": (0.0, -3.0, 0.0)}
    parameters = {"velocity_timeout": 0, "laser_frame_id": "laser", "laser_mount": (0.2, 0.0, 0.0), "apply_noise": False}
    sim = mrs.Simulation(room, robots=robots, parameters=parameters)
    box = sim.add_obstacle(mrs.Shape.rectangle(1.0, 1.0), (-5.0, 0.0, 0.0))
    for name, speed in (("one", 1.0), ("two", 0.5)):
        sim.publish(f"/{name}/cmd_vel", twist(speed))
    sim.run_for(2.05)
    sim.draw(tmp_path / "drive.png")
    assert drawn["file"] == tmp_path / "drive.png"
    assert drawn["path"][-1] == pytest.approx([2.05, 0.0, 0.0]) and list(drawn["others"]) == ["two", "three"]
    assert drawn["others"]["two"][-1] == pytest.approx([1.025, 3.0, 0.0])
    assert drawn["shapes"][0] == (box.shape, mrs.Pose(-5.0, 0.0, 0.0)) and len(drawn["shapes"]) == 4
    assert drawn["name"] == "one"
    assert tuple(drawn["laser_pose"]) == pytest.approx((2.2, 0.0, 0.0))
    assert drawn["scan_points"][:, 0].max() == pytest.approx(9.9)  # the wall


def test_a_simulation_without_a_scan_can_be_drawn(room: mrs.OccupancyGrid, tmp_path: Path) -> None:
    mrs.Simulation(room).draw(tmp_path / "drive.png")
    assert (tmp_path / "drive.png").exists()


def test_drawing_makes_no_folder(room: mrs.OccupancyGrid, tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"no such folder: '.*new'"):
        mrs.Simulation(room).draw(tmp_path / "new" / "drive.png")
    assert list(tmp_path.iterdir()) == []


def test_a_picture_shows_the_goal_and_the_first_contact(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room, parameters={"velocity_timeout": 0, "robot_radius": 0.2})
    sim.publish("/cmd_vel", twist(5.0))
    with pytest.raises(AssertionError):
        assert_reaches(sim, (0.0, 20.0), within=10.0)
    axes = sim.plot(Figure().add_subplot())
    drawn = {str(line.get_label()): np.column_stack(line.get_data()) for line in axes.lines}
    assert drawn["goal"].tolist() == [[0.0, 20.0]]
    assert drawn["contact"].tolist() == [list(sim.truth.contacts[0].point)]


def test_a_simulation_draws_itself_in_axes(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room)
    sim.publish("/cmd_vel", twist(1.0))
    sim.run_for(1.0)
    axes = Figure().add_subplot()
    assert sim.plot(axes) is axes
    assert axes.get_legend_handles_labels()[1] == ["start", "path", "end", "last scan"]


def test_notebooks_show_a_picture_if_there_is_one(room: mrs.OccupancyGrid, monkeypatch: pytest.MonkeyPatch) -> None:
    sim = mrs.Simulation(room, robots={})
    assert sim._repr_png_() is None
    sim.add_robot("one")
    image = sim._repr_png_()
    assert image is not None and image.startswith(b"\x89PNG")
    monkeypatch.setitem(sys.modules, "mobile_robot_simulator.plotting", None)
    assert sim._repr_png_() is None
    with pytest.raises(ImportError):
        sim.plot()
