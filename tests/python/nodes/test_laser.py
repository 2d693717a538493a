"""LaserScannerSimulator: each scan is measured in the current map, from the pose at its stamp."""

from __future__ import annotations

import logging
import math
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import messages
from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.node import NoCopyNode
from mobile_robot_simulator.nodes.interface import QoS
from mobile_robot_simulator.nodes.map_messages import to_message
from mobile_robot_simulator.parameters import LaserParameters

SECOND = 1_000_000_000
NOISE_SEED = 42
TWIST = (0.6, -0.1, 0.8)


class Rig:
    """A scanner on its own bus, with hand-made transforms and everything that is published."""

    def __init__(self, grid: mrs.OccupancyGrid | None, *, started: bool = True, **parameters: Any) -> None:
        self.bus = Bus()
        parameters = {"laser_beam_count": 61, "laser_max_range": 12.0, "apply_noise": False, **parameters}
        self.laser = mrs.nodes.LaserScannerSimulator(
            NoCopyNode(self.bus, "laser"), LaserParameters.checked(parameters), grid=grid
        )
        self.node = NoCopyNode(self.bus, "tester")
        self.sent: list[tuple[str, Any, int]] = []
        self.bus.taps.append(lambda *event: self.sent.append(event))
        self._tf = self.node.create_publisher(mrs.messages.TFMessage, "/tf")
        if started:
            self.laser.start()

    def link(self, parent: str, child: str, pose: Any, *, static: bool = False, seconds: float | None = None) -> None:
        stamp = self.bus.time_ns if seconds is None else round(seconds * SECOND)
        header = mrs.messages.Header(mrs.messages.Time.from_nanoseconds(stamp), parent)
        self.send(
            mrs.messages.TransformStamped(header, child, messages.Transform.from_planar(mrs.Pose(*pose))), static=static
        )

    def send(self, transform: mrs.messages.TransformStamped, *, static: bool) -> None:
        publisher = self.node.create_publisher(mrs.messages.TFMessage, "/tf_static", QoS.LATCHED) if static else self._tf
        publisher.publish(mrs.messages.TFMessage([transform]))

    def run_to(self, seconds: float) -> None:
        self.bus.run_until(round(seconds * SECOND))

    @property
    def scans(self) -> list[mrs.messages.LaserScan]:
        return [message for topic, message, _ in self.sent if topic == "/scan"]


def drive(rig: Rig, until: float, every: float = 0.1, twist: tuple[float, float, float] = TWIST) -> None:
    """Moves a robot from the origin under a constant twist. Publishes each transform 1 ms before its stamp."""
    for count in range(round(until / every) + 1):
        rig.run_to(max(0.0, count * every - 1e-3))
        rig.link("odom", "base_link", mrs.Pose().integrate(twist, count * every), seconds=count * every)
    rig.run_to(until)


def expected_ranges(rig: Rig, grid: mrs.OccupancyGrid, pose: Any, index: int = 0, **options: Any) -> Any:
    """Returns the ranges that a message measured from a pose must contain."""
    parameters = rig.laser.parameters
    noise = None
    if parameters.apply_noise:
        names = ("sigma_hit", "lambda_short", "z_hit", "z_short", "z_max", "z_rand", "range_offset", "range_step")
        noise = mrs.BeamModel(**{name: getattr(parameters, name) for name in names})
        names = ("incidence_sigma", "incidence_limit", "incidence_bias", "correlation", "reference_range", "beam_divergence")
        options["surfaces"] = mrs.SurfaceModel(**{name: getattr(parameters, name) for name in names})
    scanner = mrs.LaserScanner(
        fov=parameters.laser_fov,
        beam_count=parameters.laser_beam_count,
        min_range=parameters.laser_min_range,
        max_range=parameters.laser_max_range,
        mount=options.get("mount", (0.0, 0.0, 0.0)),
    )
    poses = np.array([tuple(pose)])
    surfaces = options.pop("surfaces", None)
    readings = scanner.scan_batch(grid, poses, noise=noise, surfaces=surfaces, seed=parameters.seed, first_index=index)[0]
    return scanner.mark_invalid(readings, no_return=parameters.no_return)


def test_a_scan_field_by_field(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room, laser_frame_id="laser", laser_fov=3.0, laser_min_range=0.2, laser_frequency=8.0)
    rig.link("map", "base_link", (1.0, 2.0, 0.5))
    rig.link("base_link", "laser", (0.0, 0.0, 0.0), static=True)
    rig.run_to(0.125)
    (scan,) = rig.scans
    scanner = mrs.LaserScanner(fov=3.0, beam_count=61, min_range=0.2, max_range=12.0)
    assert scan.header == mrs.messages.Header(mrs.messages.Time(0, 125_000_000), "laser")
    assert scan.angle_min == scanner.angle_min == -1.5
    assert scan.angle_max == scanner.angle_max
    assert scan.angle_increment == 3.0 / 60
    assert scan.time_increment == 0.0
    assert scan.scan_time == 0.125
    assert (scan.range_min, scan.range_max) == (0.2, 12.0)
    assert scan.ranges.dtype == np.float32 and scan.ranges.shape == (61,)
    assert np.array_equal(scan.ranges, expected_ranges(rig, room, (1.0, 2.0, 0.5)))
    assert scan.intensities.dtype == np.float32 and len(scan.intensities) in (0, 61)


def test_a_scan_that_takes_time_follows_the_arc_between_two_poses_in_tf(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room, laser_scan_duration=0.06, laser_frequency=10.0)
    drive(rig, 0.5)
    scan, scanner = rig.scans[-1], rig.laser.scanner
    assert scan.header.stamp.nanoseconds == 440_000_000
    increment = scanner.time_increment(0.06)
    assert scan.time_increment == increment == 0.06 / 60
    expected = [
        scanner.scan(room, mrs.Pose().integrate(TWIST, 0.44 + beam * increment))[beam] for beam in range(scanner.beam_count)
    ]
    np.testing.assert_allclose(scan.ranges, scanner.mark_invalid(np.array(expected)), atol=1e-6)
    at_once = scanner.mark_invalid(scanner.scan(room, mrs.Pose().integrate(TWIST, 0.44)))
    assert not np.allclose(scan.ranges, at_once, atol=1e-3)


def test_missing_and_near_returns_are_marked() -> None:
    cells = np.zeros((40, 40), np.int8)
    cells[:, 22] = 100
    grid = mrs.OccupancyGrid(cells, resolution=0.1)
    found = {}
    for no_return in ("inf", "max"):
        rig = Rig(grid, no_return=no_return, laser_min_range=0.5, laser_fov=2 * math.pi, laser_beam_count=64)
        rig.link("map", "base_link", (2.0, 2.0, 0.0))
        rig.run_to(0.1)
        found[no_return] = rig.scans[0].ranges
    missing = found["inf"] == math.inf
    assert missing.sum() > 32
    assert (found["max"][missing] == 12.0).all()
    assert np.array_equal(found["inf"] == -math.inf, found["max"] == -math.inf)
    assert (found["inf"] == -math.inf).sum() > 5
    valid = np.isfinite(found["inf"])
    assert (found["inf"][valid] >= 0.5).all() and (found["inf"][valid] < 12.0).all() and valid.any()


def kept_by_laser_geometry(scan: mrs.messages.LaserScan) -> Any:
    """Returns which ranges laser_geometry turns into points: those in [range_min, range_max). Its numbers are float32."""
    low, high = np.float32(scan.range_min), np.float32(scan.range_max)
    return np.array([bool(low <= reading < high) for reading in scan.ranges])


@pytest.mark.parametrize(("no_return", "are_kept"), [("inf", False), ("max", True), ("below_max", True)])
@pytest.mark.parametrize("ranges", [(0.05, 12.0), (0.05, 30.0), (11.5, 11.55), (0.0, 0.05), (1.0, 20_000.0), (0.0, 1e30)])
def test_laser_geometry_keeps_a_beam_without_a_return_or_not(
    no_return: str, are_kept: bool, ranges: tuple[float, float]
) -> None:
    low, high = ranges
    empty = mrs.OccupancyGrid(np.zeros((5, 5), np.int8), resolution=0.1)
    rig = Rig(empty, no_return=no_return, laser_min_range=low, laser_max_range=high)
    rig.link("map", "base_link", (0.25, 0.25, 0.0))
    rig.run_to(0.1)
    (scan,) = rig.scans
    assert kept_by_laser_geometry(scan).tolist() == [are_kept] * 61


def test_returns_are_kept_by_laser_geometry_whatever_marks_the_others(room: mrs.OccupancyGrid) -> None:
    hits = {}
    for no_return in ("inf", "max", "below_max"):
        rig = Rig(room, no_return=no_return, laser_max_range=9.0, laser_beam_count=64, laser_fov=2 * math.pi)
        rig.link("map", "base_link", (0.0, 0.0, 0.0))
        rig.run_to(0.1)
        (scan,) = rig.scans
        hits[no_return] = np.where(scan.ranges < np.float32(8.85), kept_by_laser_geometry(scan), False)
        assert (scan.range_min, scan.range_max) == (0.05, pytest.approx(9.001 if no_return == "max" else 9.0, abs=1e-9))
    assert 0 < hits["inf"].sum() < 64
    assert hits["inf"].tolist() == hits["max"].tolist() == hits["below_max"].tolist()


@pytest.mark.parametrize("rate", [1.0, 10.0, 40.0, 7.0])
def test_stamps_and_rates(room: mrs.OccupancyGrid, rate: float) -> None:
    rig = Rig(room, laser_frequency=rate)
    drive(rig, 3.0)
    stamps = [scan.header.stamp.nanoseconds for scan in rig.scans]
    assert stamps == [round(count / rate * SECOND) for count in range(1, round(3 * rate) + 1)]
    assert all(scan.scan_time == 1.0 / rate for scan in rig.scans)


@pytest.mark.parametrize("rate", [10.0, 40.0, 7.0, 3.0])
def test_a_scan_is_measured_from_the_pose_at_its_own_stamp(room: mrs.OccupancyGrid, rate: float) -> None:
    """Under a constant twist the pose is exact between transforms and after the last one."""
    rig = Rig(room, laser_frequency=rate)
    drive(rig, 3.0)
    for scan in rig.scans:
        seconds = scan.header.stamp.nanoseconds / SECOND
        if seconds < 0.1:
            continue  # The motion is known from the second transform on.
        exact = expected_ranges(rig, room, mrs.Pose().integrate(TWIST, seconds))
        assert np.isclose(scan.ranges, exact, rtol=0.0, atol=1e-5).mean() > 0.95, seconds


def test_a_scan_at_the_stamp_of_a_transform_equals_a_batch_byte_for_byte(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room, apply_noise=True, seed=NOISE_SEED, z_hit=0.7, z_short=0.1, z_max=0.1, z_rand=0.1, sigma_hit=0.05)
    drive(rig, 2.0)
    assert len(rig.scans) == 20
    for index, scan in enumerate(rig.scans):
        pose = mrs.Pose().integrate(TWIST, (index + 1) * 0.1)
        message = messages.Transform.from_planar(pose).to_planar()
        assert scan.ranges.tobytes() == expected_ranges(rig, room, message, index).tobytes()


def test_noise_can_be_switched_off_and_has_a_seed(room: mrs.OccupancyGrid) -> None:
    scans = []
    for options in (
        {},
        {"apply_noise": True, "seed": 1},
        {"apply_noise": True, "seed": 2},
        {"apply_noise": True, "seed": 1},
    ):
        rig = Rig(room, **options)
        drive(rig, 0.5)
        scans.append([scan.ranges.tobytes() for scan in rig.scans])
    assert scans[1] == scans[3]
    assert len({*map(tuple, scans)}) == 3


# --- frames -----------------------------------------------------------------------------------------------------------

MOUNT = (0.3, -0.1, 0.4)


def test_the_mount_is_taken_from_tf(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room, laser_frame_id="laser")
    rig.link("base_link", "laser", MOUNT, static=True)
    rig.link("map", "base_link", (1.0, 2.0, 0.5))
    rig.run_to(0.1)
    (scan,) = rig.scans
    assert scan.header.frame_id == "laser"
    assert np.allclose(scan.ranges, expected_ranges(rig, room, (1.0, 2.0, 0.5), mount=MOUNT), atol=1e-5)
    assert not np.allclose(scan.ranges, expected_ranges(rig, room, (1.0, 2.0, 0.5)), atol=1e-5)


def test_a_mount_may_be_a_chain_of_transforms(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room, laser_frame_id="laser")
    rig.link("base_link", "mast", (0.3, 0.0, 0.0), static=True)
    rig.link("mast", "laser", (0.0, 0.1, 0.7))
    rig.link("map", "base_link", (1.0, 2.0, 0.5))
    rig.run_to(0.1)
    assert np.allclose(rig.scans[0].ranges, expected_ranges(rig, room, (1.0, 2.0, 0.5), mount=(0.3, 0.1, 0.7)), atol=1e-5)


def test_scans_wait_until_the_mount_is_known(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room, laser_frame_id="laser")
    rig.link("map", "base_link", (1.0, 2.0, 0.5))
    rig.run_to(0.1)
    assert rig.scans == []
    rig.link("base_link", "laser", MOUNT, static=True)
    rig.run_to(0.2)
    (scan,) = rig.scans
    assert np.allclose(scan.ranges, expected_ranges(rig, room, (1.0, 2.0, 0.5), mount=MOUNT), atol=1e-5)


@pytest.mark.parametrize("apply_noise", [True, False])
def test_a_laser_inside_a_wall_says_so_once(caplog: pytest.LogCaptureFixture, *, apply_noise: bool) -> None:
    cells = np.zeros((40, 40), np.int8)
    cells[:, 22] = 100
    for x, expected in ((1.0, []), (2.0, ["the laser is inside a wall, at (2.25, 2.00): all true ranges are 0"])):
        caplog.clear()
        grid, mount = mrs.OccupancyGrid(cells, resolution=0.1), [0.25, 0.0, 0.0]
        rig = Rig(grid, laser_frame_id="laser", laser_mount=mount, apply_noise=apply_noise)
        rig.link("map", "base_link", (x, 2.0, 0.0))
        rig.run_to(0.5)
        assert len(rig.scans) == 5
        assert [record.message for record in caplog.records] == expected


def test_a_mount_in_space_is_read_from_tf(room: mrs.OccupancyGrid) -> None:
    """The chain from the robot to the scanner turns upside down, and then tilts."""
    rig = Rig(room, laser_frame_id="laser")
    rig.link("map", "base_link", (1.0, 2.0, 0.5))
    upside_down = mrs.LaserScanner(mount=(0.1, 0.0, 0.2, math.pi, 0.0, 0.3))
    tilted = mrs.LaserScanner(mount=(0.1, 0.0, 0.2, 0.2, 0.1, 0.3))
    for period, mounted in enumerate((upside_down, tilted), 1):
        x, y, z, *_ = mounted.mount_in_space
        above = mrs.messages.Transform(mrs.messages.Vector3(0.0, 0.0, z))
        turned = mrs.messages.Transform(mrs.messages.Vector3(x, y, 0.0), mrs.messages.Quaternion(*mounted.mount_quaternion))
        for parent, child, transform in (("base_link", "mast", above), ("mast", "laser", turned)):
            rig.send(mrs.messages.TransformStamped(mrs.messages.Header(frame_id=parent), child, transform), static=True)
        rig.run_to(0.1 * period)
        alike = rig.laser.parameters.scanner(mounted.mount_in_space)
        expected = alike.mark_invalid(alike.scan(room, (1.0, 2.0, 0.5)))
        assert np.allclose(rig.scans[-1].ranges, expected, atol=1e-5)
    level = rig.laser.parameters.scanner((0.1, 0.0, 0.3)).scan(room, (1.0, 2.0, 0.5))
    assert np.isfinite(level).any() and not np.allclose(rig.scans[-1].ranges, rig.scans[0].ranges)
    assert np.allclose(
        level, rig.laser.parameters.scanner((0.1, 0.0, 0.2, math.pi, 0.0, 0.3)).scan(room, (1.0, 2.0, 0.5))[::-1]
    )


def test_a_mount_given_as_a_parameter_is_published(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room, laser_frame_id="laser", laser_mount=list(MOUNT))
    (message,) = [message for topic, message, _ in rig.sent if topic == "/tf_static"]
    (transform,) = message.transforms
    assert (transform.header.frame_id, transform.child_frame_id) == ("base_link", "laser")
    assert tuple(transform.transform.to_planar()) == pytest.approx(MOUNT, abs=1e-15)
    rig.link("map", "base_link", (1.0, 2.0, 0.5))
    rig.run_to(0.1)
    assert np.allclose(rig.scans[0].ranges, expected_ranges(rig, room, (1.0, 2.0, 0.5), mount=MOUNT), atol=1e-5)


def test_a_mount_in_space_given_as_a_parameter_is_published(room: mrs.OccupancyGrid) -> None:
    numbers = [0.1, -0.2, 0.3, 0.1, 0.2, -2.0]
    rig = Rig(room, laser_frame_id="laser", laser_mount=numbers)
    (message,) = [message for topic, message, _ in rig.sent if topic == "/tf_static"]
    moved, turned = message.transforms[0].transform.translation, message.transforms[0].transform.rotation
    published = (moved.x, moved.y, moved.z, turned.x, turned.y, turned.z, turned.w)
    assert mrs.LaserScanner(mount=published).mount_in_space == pytest.approx(numbers, abs=1e-15)
    rig.link("map", "base_link", (1.0, 2.0, 0.5))
    rig.run_to(0.1)
    alike = rig.laser.parameters.scanner(numbers)
    assert np.allclose(rig.scans[0].ranges, alike.mark_invalid(alike.scan(room, (1.0, 2.0, 0.5))), atol=1e-5)


def test_a_scan_in_the_robots_frame_is_measured_from_the_robots_origin(room: mrs.OccupancyGrid) -> None:
    """Readers of a scan in the robot's frame cannot learn of a mount, so such a mount is refused."""
    with pytest.raises(
        ValueError, match=r"laser_mount needs a laser_frame_id other than base_link_frame, got \(.*\) for base_link"
    ):
        Rig(room, laser_frame_id="base_link", laser_mount=list(MOUNT))
    rig = Rig(room, laser_frame_id="base_link")
    rig.link("map", "base_link", (1.0, 2.0, 0.5))
    rig.run_to(0.1)
    (scan,) = rig.scans
    assert scan.header.frame_id == "base_link"
    assert np.allclose(scan.ranges, expected_ranges(rig, room, (1.0, 2.0, 0.5)), atol=1e-5)


@pytest.mark.parametrize("root", ["map", "odom", "world"])
def test_the_root_of_the_robots_tree_replaces_an_unknown_map_frame(room: mrs.OccupancyGrid, root: str) -> None:
    rig = Rig(room)
    rig.link(root, "base_link", (1.0, 2.0, 0.5))
    rig.run_to(0.1)
    assert np.array_equal(rig.scans[0].ranges, expected_ranges(rig, room, (1.0, 2.0, 0.5)))


def test_map_and_odometry_transforms_are_chained(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room)
    map_from_odom, odom_from_base = mrs.Pose(1.0, -2.0, 0.6), mrs.Pose(0.5, 0.25, -0.1)
    rig.link("map", "odom", map_from_odom)
    rig.link("odom", "base_link", odom_from_base)
    rig.run_to(0.1)
    assert np.allclose(rig.scans[0].ranges, expected_ranges(rig, room, map_from_odom * odom_from_base), atol=1e-5)


def test_there_are_no_scans_without_a_pose(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room)
    rig.run_to(1.0)
    rig.link("map", "elsewhere", (0.0, 0.0, 0.0))
    rig.run_to(2.0)
    assert rig.scans == []
    rig.link("map", "base_link", (0.0, 0.0, 0.0))
    rig.run_to(2.1)
    assert len(rig.scans) == 1


def test_a_transform_that_is_not_finite_is_refused_with_a_warning(
    room: mrs.OccupancyGrid, caplog: pytest.LogCaptureFixture
) -> None:
    rig = Rig(room)
    rig.link("map", "base_link", (1.0, 2.0, 0.5))
    rig.run_to(0.05)
    broken = mrs.messages.TransformStamped(mrs.messages.Header(mrs.messages.Time(0, 50_000_000), "map"), "base_link")
    broken.transform.translation.x = math.nan
    rig.node.create_publisher(mrs.messages.TFMessage, "/tf").publish(mrs.messages.TFMessage([broken]))
    rig.run_to(0.1)
    assert [record.levelname for record in caplog.records] == ["WARNING"] and "base_link" in caplog.text
    assert np.array_equal(rig.scans[0].ranges, expected_ranges(rig, room, (1.0, 2.0, 0.5)))


# --- the map ----------------------------------------------------------------------------------------------------------


def serve(rig: Rig, grid: mrs.OccupancyGrid, service: str = "/static_map") -> mrs.nodes.MapServer:
    server = mrs.nodes.MapServer(NoCopyNode(rig.bus, "map_server"), grid, service=service)
    server.start()
    return server


@pytest.mark.parametrize("service", ["/static_map", "/floor/map"])
def test_the_map_is_requested_from_its_service(room: mrs.OccupancyGrid, service: str) -> None:
    rig = Rig(None, started=False, map_service=service)
    serve(rig, room, service)
    rig.laser.start()
    rig.link("map", "base_link", (1.0, 2.0, 0.5))
    rig.run_to(0.1)
    assert np.array_equal(rig.scans[0].ranges, expected_ranges(rig, room, (1.0, 2.0, 0.5)))


def test_the_scanner_waits_for_a_late_map(room: mrs.OccupancyGrid) -> None:
    rig = Rig(None)
    rig.link("map", "base_link", (1.0, 2.0, 0.5))
    for seconds in (1.0, 2.5):
        rig.run_to(seconds)
        rig.link("map", "base_link", (1.0, 2.0, 0.5))
    assert rig.scans == []
    serve(rig, room)
    rig.run_to(3.5)
    first = rig.scans[0]
    assert 2 * SECOND < first.header.stamp.nanoseconds <= int(3.6 * SECOND)
    assert np.array_equal(first.ranges, expected_ranges(rig, room, (1.0, 2.0, 0.5)))


def test_an_invalid_map_is_refused_with_a_warning(room: mrs.OccupancyGrid, caplog: pytest.LogCaptureFixture) -> None:
    rig = Rig(None)
    info = messages.MapMetaData(resolution=1.0, width=1, height=1)
    replies = [
        messages.OccupancyGrid(),
        messages.OccupancyGrid(info=info, data=[0] * 5),
        messages.OccupancyGrid(info=info, data=[200]),
    ]

    def answer(request: Any, response: Any) -> Any:
        response.map = replies.pop(0) if replies else to_message(room)
        return response

    rig.node.create_service(mrs.messages.GetMap, "/static_map", answer)
    for seconds in range(1, 6):
        rig.run_to(seconds)
        rig.link("map", "base_link", (1.0, 2.0, 0.5))
    rig.run_to(5.5)
    assert [record.levelname for record in caplog.records if "map refused" in record.message] == ["WARNING"] * 3
    assert rig.scans


@pytest.mark.parametrize(("unknown", "blocks"), [("free", False), ("occupied", True)])
def test_unknown_cells_of_a_served_map(unknown: str, blocks: bool) -> None:
    cells = np.zeros((10, 40), np.int8)
    cells[:, 20:] = -1
    rig = Rig(None, started=False, unknown=unknown, laser_beam_count=1, laser_fov=1.0)
    serve(rig, mrs.OccupancyGrid(cells, resolution=0.1))
    rig.laser.start()
    rig.link("map", "base_link", (0.5, 0.5, 0.0))
    rig.run_to(0.1)
    assert rig.scans[0].ranges.tolist() == [1.5 if blocks else math.inf]


# --- changes while running --------------------------------------------------------------------------------------------


def test_scanner_parameters_change_by_name(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room)
    rig.laser.set_laser_params(laser_beam_count=31, laser_fov=2.0, laser_max_range=5.0, laser_min_range=0.1)
    rig.laser.stop()
    rig.laser.start()
    rig.link("map", "base_link", (1.0, 2.0, 0.5))
    rig.run_to(0.1)
    (scan,) = rig.scans
    assert (len(scan.ranges), scan.range_max, scan.range_min) == (31, 5.0, 0.1)
    assert scan.angle_max - scan.angle_min == pytest.approx(2.0)
    assert np.array_equal(scan.ranges, expected_ranges(rig, room, (1.0, 2.0, 0.5)))


def test_scan_time_matches_the_rate_of_the_scans(room: mrs.OccupancyGrid) -> None:
    """When a new frequency takes effect, stamps and scan_time change together."""
    rig = Rig(room)
    rig.link("map", "base_link", (1.0, 2.0, 0.5))
    rig.run_to(0.5)
    rig.laser.set_laser_params(laser_frequency=40.0)
    rig.run_to(1.0)
    for before, after in zip(rig.scans[5:], rig.scans[6:], strict=False):
        gap = (after.header.stamp.nanoseconds - before.header.stamp.nanoseconds) / SECOND
        assert after.scan_time == pytest.approx(gap)


def test_a_new_frequency_applies_from_the_next_start(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room)
    rig.laser.set_laser_params(laser_frequency=20.0)
    rig.laser.stop()
    rig.laser.start()
    rig.link("map", "base_link", (1.0, 2.0, 0.5))
    rig.run_to(0.5)
    assert len(rig.scans) == 10 and rig.scans[0].scan_time == 0.05


@pytest.mark.parametrize("reload", [False, True])
def test_the_parameter_unknown_can_be_changed(reload: bool) -> None:
    cells = np.zeros((10, 40), np.int8)
    cells[:, 20:] = -1
    rig = Rig(None, started=False, laser_beam_count=1, laser_fov=1.0)
    serve(rig, mrs.OccupancyGrid(cells, resolution=0.1))
    if reload:
        rig.laser.start()
        rig.run_to(0.05)
    rig.laser.set_laser_params(unknown="occupied")
    rig.laser.stop()
    rig.laser.start()
    rig.link("map", "base_link", (0.5, 0.5, 0.0))
    rig.run_to(0.5)
    assert rig.scans[0].ranges.tolist() == [1.5]


def test_noise_parameters_apply_from_the_next_scan_on(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room, apply_noise=True, seed=NOISE_SEED)
    rig.link("map", "base_link", (1.0, 2.0, 0.5))
    rig.run_to(0.1)
    before = expected_ranges(rig, room, (1.0, 2.0, 0.5), 0)
    rig.laser.set_noise_params(sigma_hit=0.5, z_hit=1.0, z_max=0.0)
    rig.run_to(0.2)
    assert rig.scans[0].ranges.tobytes() == before.tobytes()
    assert rig.scans[1].ranges.tobytes() == expected_ranges(rig, room, (1.0, 2.0, 0.5), 1).tobytes()
    assert rig.laser.parameters.sigma_hit == 0.5


def test_the_surfaces_that_beams_meet_change_the_scans(room: mrs.OccupancyGrid) -> None:
    surfaces = {
        "incidence_sigma": 1.0,
        "incidence_bias": 0.1,
        "correlation": 0.5,
        "reference_range": 4.0,
        "beam_divergence": 0.1,
    }
    rig = Rig(room, apply_noise=True, seed=NOISE_SEED, range_offset=0.05, range_step=0.01, **surfaces)
    rig.link("map", "base_link", (1.0, 2.0, 0.5))
    rig.run_to(0.1)
    before = expected_ranges(rig, room, (1.0, 2.0, 0.5), 0)
    rig.laser.set_noise_params(incidence_bias=0.3)
    rig.run_to(0.2)
    assert rig.scans[0].ranges.tobytes() == before.tobytes()
    assert rig.scans[1].ranges.tobytes() == expected_ranges(rig, room, (1.0, 2.0, 0.5), 1).tobytes()
    rig.laser.set_noise_params(**dict.fromkeys(surfaces, 0.0))
    rig.run_to(0.3)
    assert rig.scans[2].ranges.tobytes() == expected_ranges(rig, room, (1.0, 2.0, 0.5), 2).tobytes()
    rig.laser.set_noise_params(apply_noise=False)
    rig.run_to(0.4)
    assert rig.scans[3].ranges.tobytes() == expected_ranges(rig, room, (1.0, 2.0, 0.5), 3).tobytes()


@pytest.mark.parametrize("duration", [0.0, 0.05])
def test_intensities_are_of_the_panes_that_the_ranges_say(duration: float) -> None:
    """A box of glass in a room, of which about half of the beams are returned."""
    cells = np.pad(np.zeros((40, 40), np.int8), 1, constant_values=np.int8(100))
    cells[10, 10:31] = cells[30, 10:31] = cells[10:31, 10] = cells[10:31, 30] = 100
    numbers = np.zeros(cells.shape, np.uint8)
    numbers[10:31, 10:31] = 1
    pane = mrs.Material("glass", reflectivity=0.3, return_chance=0.5, return_angle=1.5)
    room = mrs.OccupancyGrid(cells, resolution=0.1).with_materials(numbers, table=["wall", pane])
    rig = Rig(
        room,
        apply_noise=True,
        seed=NOISE_SEED,
        sigma_hit=1e-6,
        z_hit=1.0,
        z_max=0.0,
        laser_intensities=True,
        laser_scan_duration=duration,
    )
    rig.link("map", "base_link", (2.05, 2.05, 0.3))
    rig.run_to(0.2)
    scanner = rig.laser.scanner
    options: dict[str, Any] = {} if duration == 0.0 else {"scan_duration": duration}
    found = [scan.intensities for scan in rig.scans]
    assert len(found) >= 2
    for index, scan in enumerate(rig.scans):
        expected = scanner.intensities(room, [(2.05, 2.05, 0.3)], seed=NOISE_SEED, first_index=index, **options)[0]
        np.testing.assert_allclose(scan.intensities, expected, rtol=1e-5)
        # A pane that returns is nearer, and darker, than the wall behind it.
        is_pane = scan.ranges < 1.5
        assert 10 < is_pane.sum() < 51
        assert np.all((scan.intensities * scan.ranges**2 <= 0.3001) == is_pane)
    assert not np.array_equal(found[0], found[1])


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"laser_fov": -1.0}, "laser_fov must be greater than 0, got -1.0"),
        ({"laser_beam_count": 0}, "laser_beam_count must be"),
        ({"laser_min_range": 50.0}, "laser_min_range must be less than laser_max_range"),
        ({"laser_fow": 1.0}, "did you mean 'laser_fov'"),
        ({"sigma_hit": 0.0}, "sigma_hit must be greater than 0"),
        ({"z_hit": 0.0, "z_max": 0.0}, "at least one of z_hit"),
        ({"z_hit": 1e308, "z_rand": 1.7e308}, ""),
        ({"laser_beam_count": 31, "laser_fov": 7.0}, "laser_fov"),
        ({"laser_max_range": 1e39}, "laser_max_range"),
    ],
)
def test_a_refused_change_leaves_everything_as_it_was(room: mrs.OccupancyGrid, values: dict[str, Any], words: str) -> None:
    rig = Rig(room, apply_noise=True, seed=NOISE_SEED)
    parameters, scanner = rig.laser.parameters, rig.laser.scanner
    for change in (rig.laser.set_laser_params, rig.laser.set_noise_params):
        with pytest.raises(ValueError) as caught:
            change(**values)
        assert words in str(caught.value)
        assert rig.laser.parameters == parameters
        assert repr(rig.laser.scanner) == repr(scanner)
    rig.link("map", "base_link", (1.0, 2.0, 0.5))
    rig.run_to(0.1)
    assert rig.scans[0].ranges.tobytes() == expected_ranges(rig, room, (1.0, 2.0, 0.5)).tobytes()


@pytest.mark.parametrize(("name", "value"), [("laser_topic", "/tf"), ("laser_topic", "/"), ("map_service", "//")])
def test_a_change_that_the_node_interface_refuses_leaves_everything_as_it_was(
    room: mrs.OccupancyGrid, name: str, value: str
) -> None:
    rig = Rig(room)
    parameters = rig.laser.parameters
    with pytest.raises((ValueError, TypeError)):
        rig.laser.set_laser_params(**{name: value})
    assert rig.laser.parameters == parameters
    rig.link("map", "base_link", (1.0, 2.0, 0.5))
    rig.run_to(0.1)
    assert len(rig.scans) == 1


def test_weights_are_normalised_with_a_warning(room: mrs.OccupancyGrid, caplog: pytest.LogCaptureFixture) -> None:
    rig = Rig(room, apply_noise=True, z_hit=3.0, z_short=1.0, z_max=0.0, z_rand=0.0)
    assert [record.levelname for record in caplog.records] == ["WARNING"]
    assert "sum to 1" in caplog.text
    rig.link("map", "base_link", (1.0, 2.0, 0.5))
    rig.run_to(0.1)
    noise = mrs.BeamModel(z_hit=0.75, z_short=0.25, z_max=0.0, z_rand=0.0)
    scanner = mrs.LaserScanner(beam_count=61, max_range=12.0)
    expected = scanner.mark_invalid(scanner.scan_batch(room, np.array([[1.0, 2.0, 0.5]]), noise=noise, seed=0)[0])
    assert np.array_equal(rig.scans[0].ranges, expected)


@pytest.mark.parametrize("weights", [{}, {"z_hit": 0.7, "z_short": 0.1, "z_max": 0.1, "z_rand": 0.1}])
def test_weights_that_sum_to_one_need_no_warning(
    room: mrs.OccupancyGrid, caplog: pytest.LogCaptureFixture, weights: dict[str, float]
) -> None:
    with caplog.at_level(logging.WARNING):
        Rig(room, apply_noise=True, **weights)
    assert not caplog.records


# --- start and stop ---------------------------------------------------------------------------------------------------


def test_stop_and_start(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room, apply_noise=True, seed=NOISE_SEED)
    rig.laser.start()
    rig.link("map", "base_link", (1.0, 2.0, 0.5))
    rig.run_to(0.3)
    rig.laser.stop()
    rig.laser.stop()
    rig.run_to(0.6)
    rig.laser.start()
    rig.link("map", "base_link", (1.0, 2.0, 0.5))
    rig.run_to(0.8)
    assert [scan.header.stamp.nanoseconds for scan in rig.scans] == [count * SECOND // 10 for count in (1, 2, 3, 7, 8)]
    for index, scan in enumerate(rig.scans):
        assert scan.ranges.tobytes() == expected_ranges(rig, room, (1.0, 2.0, 0.5), index).tobytes()


def test_nothing_is_published_before_the_start(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room, started=False)
    rig.link("map", "base_link", (1.0, 2.0, 0.5))
    rig.run_to(1.0)
    assert rig.scans == []


def test_topics_are_parameters(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room, laser_topic="front/scan", base_link_frame="base", map_frame_id="world", laser_frame_id="base")
    rig.link("world", "base", (1.0, 2.0, 0.5))
    rig.run_to(0.1)
    assert "/front/scan" in [topic for topic, _, _ in rig.sent]


@pytest.mark.parametrize("fov", [2 * math.pi, 6.283185307, 6.2831855])
def test_a_full_circle_has_no_duplicate_beam(room: mrs.OccupancyGrid, fov: float) -> None:
    rig = Rig(room, laser_fov=fov, laser_beam_count=360)
    rig.link("map", "base_link", (1.0, 2.0, 0.5))
    rig.run_to(0.1)
    scan = rig.scans[0]
    assert len(scan.ranges) == 360
    assert scan.angle_increment == pytest.approx(2 * math.pi / 360)
    assert scan.angle_max == pytest.approx(scan.angle_min + 2 * math.pi * 359 / 360)


# --- in a simulation --------------------------------------------------------------------------------------------------


def hall(side: int = 100) -> mrs.OccupancyGrid:
    cells = np.zeros((side, side), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    return mrs.OccupancyGrid(cells, resolution=0.1, origin=(-side / 20, -side / 20, 0.0))


def simulation(**parameters: Any) -> mrs.Simulation:
    return mrs.Simulation(hall(), parameters={"apply_noise": False, "laser_beam_count": 5, **parameters})


@pytest.mark.parametrize(
    ("values", "complaint"),
    [
        ({"laser_fov": 9.0}, "laser_fov must be less than or equal to 6.28"),
        ({"laser_beam_count": 3, "laser_topic": "no name"}, "laser_topic must be a name such as /scan, got 'no name'"),
        ({"laser_topic": "/odom"}, "/odom carries Odometry, got LaserScan"),
    ],
)
def test_a_refused_change_in_a_simulation_changes_nothing(values: dict[str, Any], complaint: str) -> None:
    sim = simulation()
    sim.run_for(1.0)
    before = sim.laser.parameters
    with pytest.raises((ValueError, TypeError), match=complaint.replace("(", r"\(")):
        sim.laser.set_parameters(**values)
    assert sim.laser.parameters == before
    last = sim.latest("/scan")
    sim.run_for(1.0)
    assert sim.latest("/scan").header.stamp.nanoseconds > last.header.stamp.nanoseconds
    assert len(sim.latest("/scan").ranges) == 5


def test_a_change_of_unknown_applies_to_the_current_map() -> None:
    cells = np.zeros((20, 20), np.int8)
    cells[:, 15] = -1
    sim = mrs.Simulation(mrs.OccupancyGrid(cells, resolution=0.1), start=(0.55, 1.05, 0.0))
    sim.laser.set_parameters(apply_noise=False, laser_beam_count=1)
    sim.run_for(0.5)
    assert sim.latest("/scan").ranges[0] == math.inf
    sim.laser.set_parameters(unknown="occupied", laser_fov=1e-3)
    sim.run_for(0.5)
    assert sim.latest("/scan").ranges[0] == pytest.approx(0.95, abs=1e-3)


def test_a_valid_new_map_replaces_the_old_one() -> None:
    sim = simulation()
    sim.run_for(1.0)
    broken = to_message(hall(40))
    broken.info.width = 7
    sim.publish("/map", broken)
    sim.run_for(1.0)
    assert sim.latest("/scan").ranges[2] == pytest.approx(4.9)
    sim.publish("/map", to_message(hall(40)))
    sim.run_for(1.0)
    assert sim.latest("/scan").ranges[2] == pytest.approx(1.9)


def test_a_message_with_the_same_map_does_not_replace_the_grid() -> None:
    sim = mrs.Simulation(mrs.OccupancyGrid(hall().cells, resolution=0.1, origin=(-5.0, -5.0, 1e-3)))
    used = sim.laser._maps.grid
    sim.run_for(1.0)
    assert sim.laser._maps.grid is used


@pytest.mark.parametrize(
    ("values", "ends"),
    [
        ({"laser_angle_min": -0.5, "laser_angle_max": 1.0}, (-0.5, 1.0)),
        ({"laser_angle_min": -0.5, "laser_angle_max": 1.0, "laser_clockwise": True}, (1.0, -0.5)),
        ({"laser_fov": 2.0, "laser_clockwise": True}, (1.0, -1.0)),
        ({"laser_angle_min": 0.0, "laser_angle_max": 6.28319, "laser_beam_count": 4}, (0.0, 0.75 * 6.28319)),
    ],
)
def test_scans_have_the_angles_of_the_parameters(values: dict[str, Any], ends: tuple[float, float]) -> None:
    sim = simulation(**values)
    sim.run_for(0.1)
    scan = sim.latest("/scan")
    assert (scan.angle_min, scan.angle_max) == pytest.approx(ends)
    assert round((scan.angle_max - scan.angle_min) / scan.angle_increment) + 1 == len(scan.ranges)
