"""Frames: what a page draws, as named parts of JSON that are sent when they have changed."""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from .._core import Pose, Shape
from ..instant import NANOSECONDS
from ..messages import LaserScan
from ..parameter_files import yaml_of
from ..parameters import LaserParameters, Parameters, RobotParameters
from .belief import Belief
from .fault_examples import fault_examples
from .parameter_fields import fields_of

if TYPE_CHECKING:
    from ..physics.obstacles import Obstacle
    from ..simulation.robots import SimulatedRobot
    from ..simulation.simulation import Simulation
    from .session import Session

LONGEST_TRAIL = 20_000
"""Points of a path that a page can show. If there are more, the older half is thinned to every second point."""

_LOOK_AHEAD_NS = 1_000_000
"""Simulated time from which the velocity of an obstacle is measured [ns]."""

_TRAIL_STEP = 0.02
"""Shortest distance between two points of a path [m]."""


@dataclass
class Trail:
    """The path of a robot: where it was and where its odometry believed it to be.

    Attributes:
        points: Rows x, y, believed x, believed y in the map frame [m]; None where the robot was moved.
        epoch: Number that changes when earlier points change.
    """

    points: list[tuple[float, float, float, float] | None] = field(default_factory=list)
    epoch: int = 0

    def clear(self) -> None:
        """Starts anew."""
        self.points.clear()
        self.epoch += 1

    def add(self, pose: Pose, believed: Pose, *, is_moved: bool = False) -> None:
        """Adds a point, unless the robot has hardly moved. With `is_moved`, it is not joined to the last one."""
        point = (round(pose.x, 3), round(pose.y, 3), round(believed.x, 3), round(believed.y, 3))
        last = next((each for each in reversed(self.points[-2:]) if each is not None), None)
        if last is not None:
            moved = max(abs(a - b) for a, b in zip(point, last, strict=True))
            if moved < _TRAIL_STEP and not is_moved:
                return
            if is_moved and self.points[-1] is not None:
                self.points.append(None)
        self.points.append(point)
        if len(self.points) > LONGEST_TRAIL:
            half = LONGEST_TRAIL // 2
            self.points = self.points[:half:2] + self.points[half:]
            self.epoch += 1


@dataclass(frozen=True)
class Frame:
    """What there is to draw at one time.

    Attributes:
        parts: JSON of each part by name.
        trails: Paths by the names of the robots. Pages take only the new points.
    """

    parts: Mapping[str, bytes]
    trails: Mapping[str, Trail]


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
        self._choices = _json({"fields": {"robot": fields_of(RobotParameters), "scanner": fields_of(LaserParameters)}})
        self._free_name: tuple[object, str] = (self, "")

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
        parts = {"now": _json(now), "map": self._map(simulation), "obstacles": self._obstacles(simulation)}
        parts |= {"choices": self._choices, "settings": self._parameters(simulation), "session": self._state()}
        parts["outlines"] = _json({name: _outline(robot.robot.footprint) for name, robot in robots.items()})
        parts["contacts"] = _json({name: self._contact_points(robot) for name, robot in robots.items()})
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
            robot: {"title": each.title, "goal": None if each.goal is None else _rounded(each.goal)}
            for robot, each in session.pilots.autopilots.items()
        }
        return _json(
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
            self._settings = present, _json({"nodes": rows, "examples": fault_examples(simulation)})
        return self._settings[1]

    def _robot(self, robot: SimulatedRobot, believed: Pose) -> dict[str, Any]:
        vx, vy, wz = robot.truth.velocity
        return {"pose": _rounded(robot.pose), "believed": _rounded(believed), "velocity": [vx, vy, wz]}

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
        rows, columns = grid.shape
        origin, version = _rounded(grid.origin, 6), id(message)
        threshold = grid.occupied_threshold
        return _json(
            {
                "rows": rows,
                "columns": columns,
                "resolution": grid.resolution,
                "origin": origin,
                "threshold": threshold,
                "title": self._title,
                "version": version,
            }
        )

    def _obstacles(self, simulation: Simulation) -> bytes:
        return _json([self._obstacle(each) for each in simulation.obstacles])

    def _obstacle(self, obstacle: Obstacle) -> dict[str, Any]:
        now_ns = self._session.now_ns
        pose, soon = obstacle.pose(now_ns), obstacle.pose(now_ns + _LOOK_AHEAD_NS)
        seconds = _LOOK_AHEAD_NS / NANOSECONDS
        velocity = [round((soon.x - pose.x) / seconds, 3), round((soon.y - pose.y) / seconds, 3)]
        outline = _outline(obstacle.shape) or {}
        return {"name": obstacle.name, "pose": _rounded(pose, 4), "velocity": velocity, **outline}

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
        hits = (ranges >= scanner.min_range) & (ranges < scanner.max_range)
        # End points of beams without a return, just below the largest range, only to fill the area that was seen.
        farthest = np.nextafter(np.float32(scanner.max_range), np.float32(0.0))
        nearest = np.float32(scanner.min_range)
        points = scanner.end_points(base, np.where(hits, ranges, np.where(ranges < nearest, nearest, farthest)))
        place = base * scanner.mount
        part = {
            "stamp": stamp,
            "place": _rounded(place),
            "points": _packed(points.astype(np.float32)),
            "hits": _packed(hits.astype(np.uint8)),
            "count": int(hits.sum()),
        }
        self._scans[key] = message, _json(part)
        return self._scans[key][1]


def _rounded(pose: Pose, digits: int = 4) -> list[float]:
    return [round(pose.x, digits), round(pose.y, digits), round(pose.yaw, 5)]


def _outline(shape: Shape | None) -> dict[str, Any] | None:
    if shape is None:
        return None
    if shape.radius is not None:
        return {"radius": shape.radius}
    return {"corners": shape.points.round(4).tolist()}


def _packed(values: np.ndarray[Any, Any]) -> str:
    return base64.b64encode(values.tobytes()).decode("ascii")


def _json(value: Any) -> bytes:
    return json.dumps(value, separators=(",", ":"), allow_nan=False).encode()
