"""LaserScannerSimulator: transforms and a map in, laser scans out."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np

from .. import messages
from .._core import LaserScanner, OccupancyGrid, Pose
from ..handle import Handle, Handles
from ..messages import GetMap, Header, LaserScan, TFMessage, Time, TransformStamped
from ..parameters import LaserParameters
from ..physics.world import Carrier, Placed
from .interface import Client, Future, Node, QoS
from .map_messages import from_message, is_of, with_unknown
from .transforms import TransformBuffer, TransformListener

NO_INTENSITIES = np.zeros(0, np.float32)

PATIENCE_NS = 10_000_000_000
"""How long an answer of the map's service is waited for before it is asked again."""

WEIGHTS = ("z_hit", "z_short", "z_max", "z_rand")

SET_UP = (
    "laser_topic",
    "odometry_topic",
    "map_service",
    "map_topic",
    "laser_frame_id",
    "laser_mount",
    "laser_frequency",
    "base_link_frame",
)
"""Parameters that what `start` sets up hangs on."""


class LaserScannerSimulator(Handle):
    """A laser scanner that sees the map from where tf says it is.

    Scans at `laser_frequency`, from the pose at the scan's own stamp: the last transform, carried on by the twist of the
    last odometry, so that it never waits for one. The map is asked of `map_service`, each second until it is there; before
    that, and before the scanner's pose is known, there are no scans. A map that arrives on `map_topic` takes its place. The
    scanner's mount is its transform from the robot's base if tf knows it, else `laser_mount`. If the map frame is not known
    to tf, the frame that the robot's base hangs from stands for it.

    node: what to publish and subscribe through. grid: the map, if it need not be asked of a service. carrier: the robot that
    it really stands on, which then says where it is, and what else is there to see. transforms: what is known of tf, if that
    is kept elsewhere.
    """

    def __init__(
        self,
        node: Node,
        parameters: LaserParameters | None = None,
        *,
        grid: OccupancyGrid | None = None,
        carrier: Carrier | None = None,
        transforms: TransformBuffer | None = None,
    ) -> None:
        self._node = node
        self._grid = grid
        self._carrier = carrier
        self._transforms = TransformBuffer() if transforms is None else transforms
        self._listener = TransformListener(node, self._transforms) if transforms is None else None
        self._index = 0
        self._asked_ns: int | None = None
        self._running: Handles | None = None
        self._use(parameters or LaserParameters())

    @property
    def parameters(self) -> LaserParameters:
        """The parameters in use."""
        return self._parameters

    @property
    def scanner(self) -> LaserScanner:
        """The scanner as it is mounted."""
        return self._scanner

    def set_parameters(self, **values: Any) -> None:
        """Change parameters by their names, from the next scan on.

        raises: ValueError that names the parameter, its value and what was needed; then nothing changes.
        """
        before, after = self._parameters, self._parameters.changed(values)
        if after == before:
            return
        self._use(after)
        if self._grid is not None and after.unknown != before.unknown:
            self._grid = with_unknown(self._grid, after.unknown)
        if self._running is None or all(getattr(before, name) == getattr(after, name) for name in SET_UP):
            return
        try:
            self._restart()
        except Exception:
            self._use(before)
            self._restart()
            raise

    def set_laser_params(self, **values: Any) -> None:
        """As `set_parameters`, under the original's name."""
        self.set_parameters(**values)

    def set_noise_params(self, **values: Any) -> None:
        """As `set_parameters`, under the original's name."""
        self.set_parameters(**values)

    def start(self) -> None:
        """Scan from now on."""
        if self._running is not None:
            return
        node, parameters = self._node, self._parameters
        self._asked_ns = None
        with Handles() as handles:
            self._scans = node.create_publisher(LaserScan, parameters.laser_topic, QoS.SENSOR_DATA)
            handles.add(node.destroy_publisher, self._scans)
            if parameters.laser_mount is not None:
                static = node.create_publisher(TFMessage, "/tf_static", QoS.LATCHED)
                handles.add(node.destroy_publisher, static)
                transform = messages.Transform.from_planar(Pose(*parameters.laser_mount))
                header = Header(Time.from_nanoseconds(self._now()), parameters.base_link_frame)
                static.publish(TFMessage([TransformStamped(header, parameters.laser_frame_id, transform)]))
            if self._listener is not None:
                self._listener.start(parameters.odometry_topic)
                handles.add(self._listener.stop)
            if parameters.map_topic:
                maps = node.create_subscription(messages.OccupancyGrid, parameters.map_topic, self._take_map, QoS.LATCHED)
                handles.add(node.destroy_subscription, maps)
            client = node.create_client(GetMap, parameters.map_service)
            handles.add(node.destroy_client, client)
            self._ask_for_map(client)
            asking = node.create_timer(1.0, partial(self._ask_for_map, client))
            handles.add(node.destroy_timer, asking)
            handles.add(node.destroy_timer, node.create_timer(1.0 / parameters.laser_frequency, self._scan))
            self._running = handles

    def stop(self) -> None:
        """Scan no more; `start` goes on from here."""
        if self._running is not None:
            self._running.close()
            self._running = None

    def save(self) -> Any:
        """All that `restore` needs, but for what the node's surroundings keep."""
        return dict(vars(self)), self._transforms.save()

    def restore(self, state: Any) -> None:
        """Be as when the state was saved."""
        attributes, transforms = state
        vars(self).update(attributes)
        self._transforms.restore(transforms)

    def _restart(self) -> None:
        """Set everything up afresh."""
        self.stop()
        self.start()

    def _use(self, parameters: LaserParameters) -> None:
        scanner, noise = parameters.scanner(), parameters.beam_model
        self._parameters, self._scanner, self._noise = parameters, scanner, noise
        weights = {name: getattr(parameters, name) for name in WEIGHTS}
        if not math.isclose(sum(weights.values()), 1.0, rel_tol=1e-9):
            shares = {name: round(getattr(self._noise, name), 6) for name in weights}
            self._node.get_logger().warning(f"the noise's weights must sum to 1, got {weights}; normalised to {shares}")

    def _now(self) -> int:
        return self._node.get_clock().now().nanoseconds

    def _ask_for_map(self, client: Client) -> None:
        now = self._now()
        waiting = self._asked_ns is not None and 0 <= now - self._asked_ns < PATIENCE_NS
        if self._grid is None and not waiting and client.service_is_ready():
            self._asked_ns = now
            client.call_async(GetMap.Request()).add_done_callback(self._take_answer)

    def _take_answer(self, future: Future) -> None:
        self._asked_ns = None
        self._take_map(future.result().map)

    def _take_map(self, message: messages.OccupancyGrid) -> None:
        if self._grid is not None and is_of(message, self._grid):
            return
        try:
            self._grid = from_message(message, unknown=self._parameters.unknown)
        except ValueError as error:
            self._node.get_logger().warning(f"map refused: {error}")
            return
        height, width = self._grid.shape
        self._node.get_logger().info(f"map of {width}x{height} cells of {self._grid.resolution:g} m in use")

    def _scan(self) -> None:
        now, parameters = self._now(), self._parameters
        base, frame = parameters.base_link_frame, parameters.laser_frame_id
        obstacles: list[Placed] = []
        if self._carrier is not None:
            map_from_base: Pose | None = self._carrier.pose
            obstacles = self._carrier.surroundings
        else:
            map_from_base = self._transforms.lookup_or_root(parameters.map_frame_id, base, now)
        if self._grid is None or map_from_base is None:
            return
        mount = self._transforms.lookup(base, frame, now) if frame != base else None
        if mount is not None and mount != self._scanner.mount:
            self._scanner = parameters.scanner(mount)
        scanner = self._scanner
        readings = scanner.scan_batch(
            self._grid,
            np.array([(map_from_base.x, map_from_base.y, map_from_base.yaw)]),
            obstacles=obstacles,
            noise=self._noise if parameters.apply_noise else None,
            seed=parameters.seed,
            first_index=self._index,
            threads=1,
        )[0]
        self._index += 1
        self._scans.publish(
            LaserScan(
                Header(Time.from_nanoseconds(now), frame),
                angle_min=scanner.angle_min,
                angle_max=scanner.angle_max,
                angle_increment=scanner.angle_increment,
                scan_time=1.0 / parameters.laser_frequency,
                range_min=scanner.min_range,
                range_max=scanner.max_range,
                ranges=scanner.mark_invalid(readings, no_return=parameters.no_return),
                intensities=NO_INTENSITIES,
            )
        )
