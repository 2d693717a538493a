"""Frames: what a page draws, as named parts of JSON that are sent when they have changed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .._core import OccupancyGrid, Pose
from ..instant import NANOSECONDS
from ..messages import LaserScan
from ..parameter_files import yaml_of
from ..parameters import LaserParameters, Parameters, RobotParameters
from .belief import Belief
from .fault_examples import fault_examples
from .parameter_fields import fields_of
from .parts import Frame, json_part, map_part, outline_of, rounded, scan_part
from .trail import Trail

if TYPE_CHECKING:
    from ..physics.obstacles import Obstacle
    from ..simulation.robots import SimulatedRobot
    from ..simulation.simulation import Simulation
    from .session import Session

_LOOK_AHEAD_NS = 1_000_000
"""Simulated time from which the velocity of an obstacle is measured [ns]."""


class FrameMaker:
    """Makes frames of a simulation.

    Args:
        session: The session of the simulation.
        title: Name of the map.
    """

    def __init__(self, session: Session, title: str = "") -> None:
        self._session, self._title = session, title
        self._scans: dict[str, tuple[LaserScan, bytes]] = {}
        self._trails: dict[str, Trail] = {}
        self._beliefs: dict[str, Belief] = {}
        self._epoch = session.epoch
        self._settings: tuple[tuple[object, ...], bytes] = ((), b"")
        self._choices = json_part({"fields": {"robot": fields_of(RobotParameters), "scanner": fields_of(LaserParameters)}})
        self._free_name: tuple[object, str] = (self, "")

    @property
    def grid(self) -> OccupancyGrid:
        """The map."""
        return self._session.simulation.grid

    def make(self) -> Frame:
        """Returns the frame of the present."""
        session, simulation = self._session, self._session.simulation
        robots = simulation.robots
        if self._epoch != session.epoch:
            self._epoch = session.epoch
            for trail in self._trails.values():
                trail.clear()
        believed = {name: self._follow(robot) for name, robot in robots.items()}
        now = {
            "time": simulation.time,
            "rate": round(session.pace.rate, 2),
            "robots": {name: self._robot(robot, believed[name]) for name, robot in robots.items()},
        }
        parts = {"now": json_part(now), "map": self._map(simulation), "obstacles": self._obstacles(simulation)}
        parts |= {"choices": self._choices, "settings": self._parameters(simulation), "session": self._state()}
        parts["outlines"] = json_part({name: outline_of(robot.robot.footprint) for name, robot in robots.items()})
        parts["contacts"] = json_part({name: self._contact_points(robot) for name, robot in robots.items()})
        for name, robot in robots.items():
            for scanner in robot.scanners:
                if (part := self._scan(simulation, robot, scanner)) is not None:
                    parts[f"scan:{name}:{scanner}"] = part
        return Frame(parts, {name: self._trails[name] for name in robots})

    def _state(self) -> bytes:
        """Returns what viewers have set: the pace, the pilots, faults, states and the recording."""
        session, simulation = self._session, self._session.simulation
        if self._free_name[0] != session.recording:
            self._free_name = session.recording, session.free_name
        pilots = {
            robot: {"title": each.title, "goal": None if each.goal is None else rounded(each.goal)}
            for robot, each in session.pilots.autopilots.items()
        }
        return json_part(
            {
                "paused": session.pace.paused,
                "speed": session.pace.speed,
                "pilots": pilots,
                "faults": [
                    {"text": repr(fault), "acts": fault.acts, "stopped": fault.is_stopped} for fault in simulation.faults
                ],
                "states": dict(session.states),
                "recording": None if session.recording is None else str(session.recording),
                "folder": str(session.folder),
                "free_name": self._free_name[1],
            }
        )

    def _parameters(self, simulation: Simulation) -> bytes:
        """Returns the values of all parameters as YAML texts."""
        nodes: list[tuple[str, str | None, Parameters]] = []
        for name, robot in simulation.robots.items():
            nodes.append((name, None, robot.robot.parameters))
            nodes += [(name, scanner, laser.parameters) for scanner, laser in robot.scanners.items()]
        present = tuple(parameters for *_, parameters in nodes)
        if list(map(id, present)) != list(map(id, self._settings[0])):
            rows = [
                {"robot": robot, "scanner": scanner, "values": {name: yaml_of(value) for name, value in parameters}}
                for robot, scanner, parameters in nodes
            ]
            self._settings = present, json_part({"nodes": rows, "examples": fault_examples(simulation)})
        return self._settings[1]

    def _robot(self, robot: SimulatedRobot, believed: Pose) -> dict[str, Any]:
        vx, vy, wz = robot.truth.velocity
        return {"pose": rounded(robot.pose), "believed": rounded(believed), "velocity": [vx, vy, wz]}

    def _follow(self, robot: SimulatedRobot) -> Pose:
        """Adds the present to the trail of a robot. Returns the pose that its odometry believes, in the map frame."""
        odometry = self._session.simulation.latest(robot.robot.parameters.odometry_topic)
        belief = self._beliefs.setdefault(robot.name, Belief())
        believed, moved = belief.update(robot.truth, odometry, self._session.moves)
        self._trails.setdefault(robot.name, Trail()).add(robot.pose, believed, is_moved=moved)
        return believed

    def _contact_points(self, robot: SimulatedRobot) -> list[list[float]]:
        if robot.robot.footprint is None:
            return []
        return [[round(x, 3), round(y, 3)] for x, y in (each.point for each in robot.truth.contacts[-50:])]

    def _map(self, simulation: Simulation) -> bytes:
        """Returns the place of the map. Its version changes with its cells."""
        grid, message = simulation.grid, simulation.latest("/map")
        return map_part(grid, self._title, id(message))

    def _obstacles(self, simulation: Simulation) -> bytes:
        return json_part([self._obstacle(each) for each in simulation.obstacles])

    def _obstacle(self, obstacle: Obstacle) -> dict[str, Any]:
        now_ns = self._session.now_ns
        pose, soon = obstacle.pose(now_ns), obstacle.pose(now_ns + _LOOK_AHEAD_NS)
        seconds = _LOOK_AHEAD_NS / NANOSECONDS
        velocity = [round((soon.x - pose.x) / seconds, 3), round((soon.y - pose.y) / seconds, 3)]
        outline = outline_of(obstacle.shape) or {}
        return {"name": obstacle.name, "pose": rounded(pose, 4), "velocity": velocity, **outline}

    def _scan(self, simulation: Simulation, robot: SimulatedRobot, name: str) -> bytes | None:
        """Returns the last scan of a scanner: end points in the map frame, and which of them are returns."""
        node = robot.scanners[name]
        message = simulation.latest(node.parameters.laser_topic)
        if not isinstance(message, LaserScan):
            return None
        key = f"{robot.name}:{name}"
        if key in self._scans and self._scans[key][0] is message:
            return self._scans[key][1]
        scanner, stamp = node.scanner, message.header.stamp.nanoseconds / NANOSECONDS
        try:
            base = robot.truth.pose_at(stamp)
        except ValueError:
            return None  # the scan is older than a reset
        ranges = np.asarray(message.ranges, np.float32)
        if len(ranges) != scanner.beam_count:
            return None  # the scanner has changed since
        self._scans[key] = message, scan_part(scanner, base, ranges, stamp)
        return self._scans[key][1]
