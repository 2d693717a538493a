"""Maps and recordings that the tests on the real ROS share."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

import mobile_robot_simulator as mrs


def room(width: int = 160, height: int = 120, resolution: float = 0.05) -> mrs.OccupancyGrid:
    """A room with two pillars. The origin of the map frame is inside the room."""
    cells = np.zeros((height, width), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    cells[80:90, 100:110] = cells[20:30, 30:34] = 100
    return mrs.OccupancyGrid(cells, resolution=resolution, origin=(-3.0, -2.0, 0.0))


def record_drive(map_file: Path, folder: Path, format: Any) -> Path:
    """Records five seconds of a robot that drives in the map. Returns the file or folder of the recording."""
    from mobile_robot_simulator.recording.recorder import Recorder

    simulation = mrs.Simulation(mrs.load_map(map_file))
    with Recorder(folder, format=format) as recorder:
        simulation.record(recorder.write)
        simulation.publish("/cmd_vel", mrs.messages.Twist(linear=mrs.messages.Vector3(x=0.2)))
        simulation.run_for(5.0)
    return recorder.path
