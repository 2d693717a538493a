"""LaserScannerSimulator: the node that measures laser scans of a map, from the true pose of a robot or its pose in tf."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import messages
from .._core import BeamModel, LaserScanner, Obstacles, OccupancyGrid, Pose, Shape, SurfaceModel, touches
from ..handle import Handle, Handles
from ..instant import NANOSECONDS
from ..messages import Header, LaserScan, Quaternion, TFMessage, Time, TransformStamped, Vector3
from ..parameters import LaserParameters
from ..physics.world import Carrier, Passing
from .interface import Node, Publisher, QoS
from .laser_messages import NO_INTENSITIES, scan_message
from .map_listener import MapListener, MapListenerSnapshot
from .scan_batch import MIN_SCANS, Scan, ScanBatch
from .scan_truth import ScanTruth
from .transforms import TransformBuffer, TransformListener, TransformSnapshot
from .truth_listener import TruthListener, TruthSnapshot
from .waiting import WaitingLog

POINT = Shape.disc(1e-9)

NOTHING = Obstacles()
"""What a scanner sees that is not in the same process as its robot."""

WEIGHTS = ("z_hit", "z_short", "z_max", "z_rand")
"""Parameters that hold the weights of the beam model."""

RESTART_PARAMETERS = (
    "laser_topic",
    "odometry_topic",
    "map_service",
    "map_topic",
    "laser_frame_id",
    "laser_mount",
    "laser_frequency",
    "base_link_frame",
    "map_frame_id",
    "frame_prefix",
    "pose_source",
    "ground_truth_topic",
)
"""Changing one of these restarts the node."""


@dataclass(frozen=True)
class LaserSnapshot:
    """Saved state of a `LaserScannerSimulator`.

    Attributes:
        parameters: Parameters.
        scanner: Scanner with its mount.
        mount: The mount that tf had last, None before that.
        beam_model: Noise of the ranges.
        maps: State of the map listener, with the map.
        scan_count: Number of scans so far. The noise of a scan depends on its number.
        running: Publishers, subscriptions and timers, None while the node is stopped.
        scans: Publisher of the scans, None before the first start.
        transforms: State of the transform buffer.
        listener: Subscriptions of the node's own transform listener, None if it has none or is stopped.
        truth: State of the listener to the ground truth.
        scan_truth: The truth about the last scan that took time.
    """

    parameters: LaserParameters
    scanner: LaserScanner
    mount: Pose | tuple[float, ...] | None
    beam_model: BeamModel
    surface_model: SurfaceModel | None
    maps: MapListenerSnapshot
    scan_count: int
    running: Handles | None
    scans: Publisher[LaserScan] | None
    transforms: TransformSnapshot
    listener: Handles | None
    truth: TruthSnapshot
    scan_truth: ScanTruth | None


class LaserScannerSimulator(Handle):
    """A laser scanner that measures a map from the robot's true pose.

    Pose:
        A simulated robot publishes its true pose, and the scanner measures from there (`pose_source` truth). So whoever
        estimates the pose, such as AMCL or SLAM, learns from the scans where the robot really is. If no true pose arrives,
        or with `pose_source` tf, the scanner measures from the pose that tf reports.
    Time:
        The node publishes scans at `laser_frequency`. Each scan is measured from the pose at its stamp. The node
        extrapolates that pose from the last message with the last velocity, so a scan never waits for a message.
        With `laser_scan_duration`, the beams are taken one after the other, each from where the robot is then, past
        obstacles where they are then. The stamp is that of the first beam, and the scan is published when its time is over.
        There are no scans until both the map and the pose are known. After 2 s without them the node logs what it waits for,
        and again every 10 s.
    Map:
        The node requests the map from `map_service` and retries until it arrives. A map on `map_topic` replaces the current
        one.
    Frames:
        The mount is the scanner's pose in the frame of the robot's base, in space. It comes from tf, or from `laser_mount`
        while tf does not have it. Scans wait until one of the two is known. If tf has no map frame, the root of the tf tree
        that contains the base replaces it.

    Args:
        node: Node to publish and subscribe through.
        parameters: Parameters. Default: `LaserParameters()`.
        grid: Map. If None, the node requests it from the map service.
        carrier: Simulated robot that carries the scanner. If given, its true pose replaces the one in tf, and the scanner
            also sees obstacles and other robots.
        listener: Transform listener that several nodes share. If None, this node has one of its own.
        batch: Casts the scans of several nodes together. If None, the node casts its scans alone.
    """

    def __init__(
        self,
        node: Node,
        parameters: LaserParameters | None = None,
        *,
        grid: OccupancyGrid | None = None,
        carrier: Carrier | None = None,
        listener: TransformListener | None = None,
        batch: ScanBatch | None = None,
    ) -> None:
        self._node, self._clock = node, node.get_clock()
        parameters = parameters or LaserParameters()
        self._maps = MapListener(node, self._prepare, parameters.unknown, grid)
        self._prepared_grid: OccupancyGrid | None = None
        self._carrier, self._batch = carrier, batch
        self._has_own_listener = listener is None
        self._listener = listener or TransformListener(node, TransformBuffer())
        self._transforms = self._listener.buffer
        self._truth = TruthListener(node)
        self._waiting = WaitingLog(node, "the laser", self._find_missing)
        self._mount: Pose | tuple[float, ...] | None = None
        self._has_warned = False
        self._scan_count = 0
        self._scan_truth: ScanTruth | None = None
        self._running: Handles | None = None
        self._scans: Publisher[LaserScan] | None = None
        self._use_parameters(parameters)

    def __repr__(self) -> str:
        return f"LaserScannerSimulator({self.scanner!r})"

    @property
    def parameters(self) -> LaserParameters:
        """Current parameters."""
        return self._parameters

    @property
    def scanner(self) -> LaserScanner:
        """Current scanner, with its mount on the robot."""
        return self._scanner

    @property
    def scan_truth(self) -> ScanTruth | None:
        """The truth about the last scan that took time, None before the first one. See `laser_scan_duration`."""
        return self._scan_truth

    def set_parameters(self, **values: Any) -> None:
        """Changes parameters by name. The next scan uses them.

        Args:
            **values: New values, by the names of `LaserParameters`.

        Raises:
            ValueError: A value is invalid. The message names the parameter, its value and what is allowed. Nothing changes.
            TypeError: A new topic name belongs to a topic of another message type. Nothing changes.
        """
        before, after = self._parameters, self._parameters.changed(values)
        if after == before:
            return
        self._use_parameters(after)
        if self._running is None or all(getattr(before, name) == getattr(after, name) for name in RESTART_PARAMETERS):
            return
        try:
            self._restart()
        except Exception:
            self._use_parameters(before)
            self._restart()
            raise

    def set_laser_params(self, **values: Any) -> None:
        """Same as `set_parameters`, under its name in the original ROS package."""
        self.set_parameters(**values)

    def set_noise_params(self, **values: Any) -> None:
        """Same as `set_parameters`, under its name in the original ROS package."""
        self.set_parameters(**values)

    def start(self) -> None:
        """Starts to publish scans, the first one after one period. Has no effect if the node is running."""
        if self._running is not None:
            return
        self._has_warned = False
        with Handles() as handles:
            self._create_publishers(handles)
            self._create_subscriptions(handles)
            self._maps.start(topic=self._parameters.map_topic, service=self._parameters.map_service, handles=handles)
            scanning = self._node.create_timer(1.0 / self._parameters.laser_frequency, self._publish_scan)
            handles.add(self._node.destroy_timer, scanning)
            needs_mount = not self._update_mount(self._now_ns())
            if self._carrier is None or self._maps.grid is None or self._parameters.pose_source == "tf" or needs_mount:
                self._waiting.start(handles)
            self._running = handles

    def stop(self) -> None:
        """Stops publishing scans. `start` resumes."""
        if self._running is not None:
            self._running.close()
            self._running = None

    def next_scan(self) -> Scan | None:
        """Returns what the ranges of a scan at this moment depend on.

        None if there can be no scan, or if more is needed to tell: the scan takes time, or its pose or its first mount comes
        from a topic.
        """
        carrier, grid, parameters = self._carrier, self._maps.grid, self._parameters
        if carrier is None or grid is None or self._running is None or self._batch is None:
            return None
        if parameters.laser_scan_duration or parameters.pose_source != "truth":
            return None
        if self._mount is None and parameters.laser_frame_id != parameters.base_link_frame:
            return None
        return self._scan_from(grid, carrier.pose, carrier.seen)

    def save(self) -> LaserSnapshot:
        """Returns the state that `restore` takes. The state of the node interface and of the carrier is not part of it."""
        return LaserSnapshot(
            parameters=self._parameters,
            scanner=self._scanner,
            mount=self._mount,
            beam_model=self._beam_model,
            surface_model=self._surface_model,
            maps=self._maps.save(),
            scan_count=self._scan_count,
            running=self._running,
            scans=self._scans,
            transforms=self._transforms.save(),
            listener=self._listener.save() if self._has_own_listener else None,
            truth=self._truth.save(),
            scan_truth=self._scan_truth,
        )

    def restore(self, state: LaserSnapshot) -> None:
        """Puts the node back into a saved state."""
        self._parameters, self._scanner, self._beam_model = state.parameters, state.scanner, state.beam_model
        self._surface_model = state.surface_model
        self._mount = state.mount
        self._maps.restore(state.maps)
        self._scan_count, self._running, self._scans = state.scan_count, state.running, state.scans
        self._transforms.restore(state.transforms)
        self._truth.restore(state.truth)
        self._scan_truth = state.scan_truth
        if self._has_own_listener:
            self._listener.restore(state.listener)

    def _restart(self) -> None:
        self.stop()
        self.start()

    def _create_publishers(self, handles: Handles) -> None:
        """Creates the publisher of scans, and publishes `laser_mount` to /tf_static if it is given."""
        node, parameters = self._node, self._parameters
        self._scans = node.create_publisher(LaserScan, parameters.laser_topic, QoS.SENSOR_DATA)
        handles.add(node.destroy_publisher, self._scans)
        if parameters.laser_mount is not None:
            static = node.create_publisher(TFMessage, "/tf_static", QoS.LATCHED)
            handles.add(node.destroy_publisher, static)
            scanner = parameters.scanner()
            x, y, z, *_ = scanner.mount_in_space
            transform = messages.Transform(Vector3(x, y, z), Quaternion(*scanner.mount_quaternion))
            header = Header(Time.from_nanoseconds(self._now_ns()), parameters.frames["base_link_frame"])
            static.publish(TFMessage([TransformStamped(header, parameters.frames["laser_frame_id"], transform)]))

    def _create_subscriptions(self, handles: Handles) -> None:
        """Subscribes to the ground truth, transforms and odometry, as far as they are needed."""
        parameters = self._parameters
        uses_truth = parameters.pose_source == "truth"
        if uses_truth and self._carrier is None:
            base = parameters.frames["base_link_frame"]
            self._truth.start(parameters.ground_truth_topic, parameters.map_frame_id, base, handles)
        if not uses_truth or self._carrier is None or parameters.laser_frame_id != parameters.base_link_frame:
            self._listener.start(parameters.odometry_topic)
            if self._has_own_listener:
                handles.add(self._listener.stop)

    def _use_parameters(self, parameters: LaserParameters) -> None:
        scanner, beam_model, surface_model = parameters.scanner(), parameters.beam_model, parameters.surface_model
        self._parameters, self._scanner, self._beam_model = parameters, scanner, beam_model
        self._surface_model = surface_model
        self._mount = None
        self._maps.set_unknown(parameters.unknown)
        weights = {name: getattr(parameters, name) for name in WEIGHTS}
        if not math.isclose(sum(weights.values()), 1.0, rel_tol=1e-9):
            normalised = {name: round(getattr(beam_model, name), 6) for name in weights}
            self._node.get_logger().warning(f"the noise weights must sum to 1, got {weights}; normalised to {normalised}")

    def _now_ns(self) -> int:
        return self._clock.now().nanoseconds

    def _find_missing(self) -> dict[str, str]:
        """Returns what is missing for a scan, and how the node gets it."""
        missing, now_ns = self._maps.find_missing(), self._now_ns()
        if self._base_pose(now_ns) is None:
            if self._parameters.pose_source == "truth" and self._truth.has_heard:
                missing["the robot's pose"] = self._truth.explain_missing(now_ns)
            else:
                base, target = self._parameters.frames["base_link_frame"], self._parameters.map_frame_id
                reason = self._transforms.explain_missing(target, base, now_ns)
                missing["the robot's pose"] = f"the transform from {base} to {target}, {reason}"
        if not self._update_mount(now_ns):
            base, frame = self._parameters.frames["base_link_frame"], self._parameters.frames["laser_frame_id"]
            reason = self._transforms.explain_missing(base, frame, now_ns)
            missing["its mount"] = f"laser_mount, or the transform from {frame} to {base}, {reason}"
        return missing

    def _prepare(self, grid: OccupancyGrid) -> None:
        """Builds the beam lookup tables of a new grid on all cores. The first scan would build them on one thread."""
        if self._prepared_grid is not grid:
            grid.prepare()
            self._prepared_grid = grid

    def _publish_scan(self) -> None:
        """Measures and publishes a scan, if the map and the pose are known."""
        assert self._scans is not None
        now_ns, parameters, grid = self._now_ns(), self._parameters, self._maps.grid
        map_from_base = self._base_pose(now_ns)
        is_mounted = self._update_mount(now_ns)
        if grid is None or map_from_base is None or not is_mounted:
            return
        self._prepare(grid)
        duration = parameters.laser_scan_duration
        stamp_ns = now_ns - round(duration * NANOSECONDS) if duration else now_ns
        if stamp_ns == now_ns:
            ranges, intensities = self._measure(grid, map_from_base)
        elif (first := self._base_pose(stamp_ns)) is not None:
            ranges, intensities = self._measure_over_time(grid, stamp_ns, first, map_from_base)
        else:
            return
        self._scan_count += 1
        self._check_position(grid, map_from_base, ranges)
        if self._carrier is not None:
            self._carrier.publish_transforms(now_ns)
        self._scans.publish_lazily(scan_message, stamp_ns, parameters, self._scanner, ranges, intensities)

    def _base_pose(self, now_ns: int) -> Pose | None:
        """Returns the pose of the robot's base in the map frame. None if it is unknown."""
        parameters = self._parameters
        if parameters.pose_source == "truth":
            if self._carrier is not None:
                return self._carrier.pose
            if self._truth.has_heard:
                return self._truth.pose(now_ns)
        return self._transforms.lookup_or_root(parameters.map_frame_id, parameters.frames["base_link_frame"], now_ns)

    def _update_mount(self, now_ns: int) -> bool:
        """Sets the mount to the one in tf, if tf has one. Returns False if the mount is unknown.

        The mount is known once tf has had it, with `laser_mount`, and if the scanner's frame is that of the robot.
        """
        frames = self._parameters.frames
        base, frame = frames["base_link_frame"], frames["laser_frame_id"]
        if frame == base:
            return True
        mount: Pose | tuple[float, ...] | None = self._transforms.lookup(base, frame, now_ns)
        space = None if mount is None else self._transforms.lookup_in_space(base, frame)
        if space is not None and not space.is_level:
            mount = (*space.translation, *space.vector, space.w)
        if mount is not None and mount != self._mount:
            self._mount, self._scanner = mount, self._parameters.scanner(mount)
        return self._mount is not None or self._parameters.laser_mount is not None

    def _check_position(self, grid: OccupancyGrid, map_from_base: Pose, ranges: Any) -> None:
        """Warns if the scanner is inside a wall, once after each start.

        Args:
            grid: The map.
            map_from_base: Pose of the robot.
            ranges: The scan. One without noise that sees anything at a distance is not from inside a wall.
        """
        if self._has_warned or (ranges[-1] > 0.0 and not self._parameters.apply_noise):
            return
        if touches(grid, POINT, map_from_laser := map_from_base * self._scanner.mount):
            self._has_warned = True
            x, y, _ = map_from_laser
            self._node.get_logger().warning(f"the laser is inside a wall, at ({x:.2f}, {y:.2f}): all true ranges are 0")

    def _measure(self, grid: OccupancyGrid, map_from_base: Pose) -> tuple[Any, Any]:
        """Measures the next scan in one instant. Returns its ranges and its intensities, as `_read` does."""
        obstacles = NOTHING if self._carrier is None else self._carrier.seen
        parameters = self._parameters
        ranges, batch = None, self._batch
        if batch is not None and batch.scanner_count >= MIN_SCANS:
            ranges = batch.take(self, self._scan_from(grid, map_from_base, obstacles))
        if ranges is not None and not parameters.laser_intensities:
            return ranges, NO_INTENSITIES
        if not (parameters.apply_noise or parameters.laser_intensities):  # the ranges of `_read`, with fewer arguments
            return self._scanner.scan(grid, map_from_base, obstacles=obstacles), NO_INTENSITIES
        return self._read(grid, np.array([(map_from_base.x, map_from_base.y, map_from_base.yaw)]), obstacles, ranges)

    def _scan_from(self, grid: OccupancyGrid, map_from_base: Pose, obstacles: Obstacles) -> Scan:
        """Returns what the ranges of the next scan depend on, in one instant."""
        noise, surfaces, seed, index = self._noise, self._surfaces, self._parameters.seed, self._scan_count
        return self._scanner, grid, map_from_base, obstacles, noise, surfaces, seed, index

    def _read(
        self, grid: OccupancyGrid, poses: Any, obstacles: Obstacles | Sequence[Any], ranges: Any = None
    ) -> tuple[Any, Any]:
        """Returns the ranges (beam_count,) float32 [m] of the next scan, and its intensities, which may be empty.

        `ranges` are those that were cast before.
        """
        scanner, parameters, index = self._scanner, self._parameters, self._scan_count
        noise, surfaces, seed = self._noise, self._surfaces, parameters.seed
        if ranges is None:
            ranges = scanner.scan_batch(
                grid, poses, obstacles=obstacles, noise=noise, surfaces=surfaces, seed=seed, first_index=index, threads=1
            )[0]
        if not parameters.laser_intensities:
            return ranges, NO_INTENSITIES
        drawn: dict[str, Any] = {} if noise is None else {"seed": seed, "first_index": index}
        return ranges, scanner.intensities(grid, poses, obstacles=obstacles, threads=1, **drawn)[0]

    def _measure_over_time(self, grid: OccupancyGrid, stamp_ns: int, first: Pose, last: Pose) -> tuple[Any, Any]:
        """Measures the next scan, of which beam 0 was taken at a stamp [ns]. Returns its ranges and its intensities.

        A robot in this process knows where it was at the time of each beam. Otherwise the robot has moved on an arc from
        the `first` to the `last` pose.
        """
        duration = self._parameters.laser_scan_duration
        increment = self._scanner.time_increment(duration)
        times_ns = np.rint(np.arange(self._scanner.beam_count) * (increment * NANOSECONDS)).astype(np.int64)
        offsets_ns = times_ns - round(duration * NANOSECONDS)
        if self._carrier is not None and self._parameters.pose_source == "truth":
            poses = self._carrier.poses_at(offsets_ns)
        else:
            poses = first.trace(first.twist_to(last, duration), times_ns / NANOSECONDS)
        passing: list[Passing] = [] if self._carrier is None else self._carrier.surroundings_at(offsets_ns)
        ranges, intensities = self._read(grid, poses[np.newaxis], passing)
        seed, index = self._parameters.seed, self._scan_count
        self._scan_truth = ScanTruth(
            stamp_ns, times_ns, poses, ranges, grid, self._scanner, self._noise, seed, index, tuple(passing), self._surfaces
        )
        return ranges, intensities

    @property
    def _noise(self) -> BeamModel | None:
        return self._beam_model if self._parameters.apply_noise else None

    @property
    def _surfaces(self) -> SurfaceModel | None:
        return self._surface_model if self._parameters.apply_noise else None
