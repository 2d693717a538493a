"""ScanBatch: the scans of one instant are cast together, to the same bytes as one by one, whatever happens between them."""

from __future__ import annotations

import random
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import messages
from mobile_robot_simulator._core import scan_each
from mobile_robot_simulator.nodes import laser, scan_batch
from simulations import hall, twist

SEED = 5
COUNT = 20
"""Number of robots: more than `MIN_SCANS`."""

Sent = list[tuple[str, int, bytes]]
"""Topic, time [ns] and content of each message, in order."""


@pytest.fixture
def batches(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Sizes of the batches that are cast."""
    sizes: list[int] = []

    def counted(scans: list[scan_batch.Scan]) -> list[Any]:
        sizes.append(len(scans))
        return scan_each(scans)

    monkeypatch.setattr(scan_batch, "scan_each", counted)
    return sizes


def crowd(count: int = COUNT, *, grid: mrs.OccupancyGrid | None = None, **parameters: Any) -> mrs.Simulation:
    """Returns robots in rows that drive in circles, see one another and touch one another."""
    starts = {f"robot{index}": (1.5 + 1.1 * (index % 5), 1.5 + 1.1 * (index // 5), 0.7 * index) for index in range(count)}
    quick = {"laser_beam_count": 64, "robot_radius": 0.3, "velocity_timeout": 0.0, "sigma_hit": 0.02}
    sim = mrs.Simulation(grid or hall(10.0), parameters={**quick, **parameters}, seed=SEED, robots=starts)
    sim.add_obstacle(mrs.Shape.disc(0.2), [(0.0, 8.0, 1.0, 0.0), (2.0, 8.0, 8.0, 0.0)])
    for name in starts:
        sim.publish(f"/{name}/cmd_vel", twist(0.4, 0.0, 0.9))
    return sim


def recorded(sim: mrs.Simulation) -> Sent:
    """Returns the list to which all messages of a simulation will be added."""
    sent: Sent = []

    def record(topic: str, message: Any, time_ns: int) -> None:
        is_scan = isinstance(message, messages.LaserScan)
        content = message.ranges.tobytes() + message.intensities.tobytes() if is_scan else repr(message).encode()
        sent.append((topic, time_ns, content))

    sim.record(record)
    return sent


def scans_of(sent: Sent) -> Sent:
    """Returns the scans among messages."""
    return [each for each in sent if each[0].endswith("scan")]


def both_ways(run: Callable[[], Sent]) -> tuple[Sent, Sent]:
    """Returns the messages of a run with scans in batches and one by one."""
    together = run()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(laser, "MIN_SCANS", 10**6)
        return together, run()


def run_crowd(seconds: float = 0.5, **parameters: Any) -> Sent:
    sim = crowd(**parameters)
    sent = recorded(sim)
    sim.run_for(seconds)
    return sent


KINDS: dict[str, dict[str, Any]] = {
    "noise": {},
    "no_noise": {"apply_noise": False},
    "surfaces": {"incidence_sigma": 0.05, "reference_range": 5.0, "correlation": 0.5},
    "intensities": {"laser_intensities": True},
    "intensities_without_noise": {"laser_intensities": True, "apply_noise": False},
    "tilted": {"laser_frame_id": "laser", "laser_mount": (0.1, 0.0, 0.4, 0.0, 0.2, 0.0)},
    "between_time_steps": {"laser_frequency": 40.0},
    "rectangles": {"robot_radius": 0.0, "footprint": [(0.3, 0.2), (-0.3, 0.2), (-0.3, -0.2), (0.3, -0.2)]},
    "several_scanners": {
        "scanners": ["front", "rear"],
        "front.laser_mount": (0.2, 0.0, 0.0),
        "rear.laser_mount": (-0.2, 0.0, 3.1),
        "rear.laser_beam_count": 31,
    },
    "glass": {"grid": hall(10.0).with_materials(np.zeros((100, 100), np.uint8), table=["glass"])},
}


@pytest.mark.parametrize("kind", KINDS)
def test_a_crowd_scans_the_same_bytes_as_one_by_one(monkeypatch: pytest.MonkeyPatch, batches: list[int], kind: str) -> None:
    taken: list[bool] = []
    take = scan_batch.ScanBatch.take

    def counted(batch: scan_batch.ScanBatch, scanner: scan_batch.Scanning, scan: scan_batch.Scan) -> Any:
        ranges = take(batch, scanner, scan)
        taken.append(ranges is not None)
        return ranges

    monkeypatch.setattr(scan_batch.ScanBatch, "take", counted)
    together, alone = both_ways(partial(run_crowd, **KINDS[kind]))
    scanner_count = COUNT * len(KINDS[kind].get("scanners", [""]))
    assert together == alone and {"/clock", "/tf", "/robot3/odom"} < {topic for topic, *_ in together}
    assert (scan_count := len(scans_of(together))) >= 5 * scanner_count
    assert sum(taken) == sum(batches) and set(batches) == {scanner_count}
    # The first scan waits for a mount.
    assert sum(taken) >= scan_count - (scanner_count if "mount" in str(KINDS[kind]) else 0)


@pytest.mark.parametrize("threads", [1, 2, 8])
def test_the_number_of_threads_changes_nothing(monkeypatch: pytest.MonkeyPatch, threads: int) -> None:
    expected = run_crowd()
    monkeypatch.setattr(scan_batch, "scan_each", partial(scan_each, threads=threads))
    assert run_crowd() == expected


@pytest.mark.parametrize("parameters", [{"laser_scan_duration": 0.05}, {"pose_source": "tf"}])
def test_scans_that_take_time_and_poses_from_tf_are_not_cast_in_batches(batches: list[int], parameters: Any) -> None:
    assert len(scans_of(run_crowd(**parameters))) > 3 * COUNT
    assert batches == []


def test_scanners_that_take_time_or_are_stopped_are_left_out_of_a_batch(batches: list[int]) -> None:
    sim = crowd(laser_frequency=10.0)
    slow = sim.named("robot3").laser
    slow.set_parameters(laser_scan_duration=0.02)
    sent = recorded(sim)
    stopped: list[messages.Odometry] = []

    def stop(odometry: messages.Odometry) -> None:  # It comes before the first scan of its instant.
        stopped.append(odometry)
        sim.named("robot15").laser.stop()

    sim.run_for(0.15)
    sim.subscribe("/robot0/odom", messages.Odometry, stop)
    sim.run_for(0.2)
    assert stopped and batches == [COUNT - 1, COUNT - 2, COUNT - 2]
    assert len(scans_of(sent)) == 3 * COUNT - 2


def test_nobody_is_asked_for_a_scan_while_few_are_due(monkeypatch: pytest.MonkeyPatch, batches: list[int]) -> None:
    asked: list[object] = []
    monkeypatch.setattr(laser.LaserScannerSimulator, "next_scan", lambda scanner: asked.append(scanner))
    sim = crowd(COUNT // 2)
    sim.run_for(0.03)
    for index in range(COUNT // 2):
        sim.add_robot(f"late{index}", start=(7.5, 1.0 + 0.8 * index, 0.0))
    sent = recorded(sim)
    sim.run_for(0.5)
    assert len(scans_of(sent)) > 4 * COUNT and asked == batches == []


def test_a_few_robots_cast_alone(batches: list[int]) -> None:
    assert run_crowd(count=scan_batch.MIN_SCANS - 1) and batches == []
    assert run_crowd(count=scan_batch.MIN_SCANS) and batches == [scan_batch.MIN_SCANS] * 5


def stop_laser(sim: mrs.Simulation) -> None:
    sim.named("robot15").laser.stop()


def add_robot(sim: mrs.Simulation) -> None:
    sim.add_robot("late", start=(8.5, 8.5, 0.0), parameters={"robot_radius": 0.5})


def mount(sim: mrs.Simulation) -> None:
    sim.named("robot15").laser.set_parameters(laser_frame_id="laser", laser_mount=(0.2, 0.0, 0.5))


def replace_map(sim: mrs.Simulation) -> None:
    cells = hall(10.0).cells.copy()
    cells[60:] = 100
    sim.map_server.serve(mrs.OccupancyGrid(cells, resolution=0.1))


INTERVENTIONS: dict[str, Callable[[mrs.Simulation], object]] = {
    "an_obstacle_is_placed": lambda sim: sim.add_obstacle(mrs.Shape.disc(0.3), (7.5, 5.0, 0.0)),
    "an_obstacle_is_moved": lambda sim: sim.move_obstacle("pillar", (7.5, 4.0, 0.0)),
    "an_obstacle_is_removed": lambda sim: sim.remove_obstacle("pillar"),
    "a_robot_is_moved": lambda sim: sim.set_pose((8.0, 6.0, 1.0), "robot15"),
    "a_robot_that_has_scanned_is_moved": lambda sim: sim.set_pose((8.0, 6.0, 1.0), "robot0"),
    "all_robots_are_reset": lambda sim: sim.reset(),
    "a_robot_is_added": add_robot,
    "a_footprint_changes": lambda sim: sim.named("robot15").robot.set_parameters(robot_radius=0.1),
    "cells_change": lambda sim: sim.set_cells(50, 70, np.full((9, 3), 100, np.int8)),
    "cells_change_behind_the_back_of_the_simulation": lambda sim: sim.grid.set_cells(50, 70, np.full((9, 3), 100, np.int8)),
    "the_map_is_replaced": replace_map,
    "the_noise_changes": lambda sim: sim.named("robot15").laser.set_parameters(sigma_hit=0.3),
    "the_noise_is_switched_off": lambda sim: sim.named("robot15").laser.set_parameters(apply_noise=False),
    "surfaces_change": lambda sim: sim.named("robot15").laser.set_parameters(incidence_sigma=0.3),
    "the_seed_changes": lambda sim: sim.named("robot15").laser.set_parameters(seed=99),
    "the_range_changes": lambda sim: sim.named("robot15").laser.set_parameters(laser_max_range=1.0),
    "the_mount_changes": mount,
    "scans_begin_to_take_time": lambda sim: sim.named("robot15").laser.set_parameters(laser_scan_duration=0.02),
    "a_laser_is_stopped": stop_laser,
    "a_robot_is_commanded": lambda sim: sim.publish("/robot15/cmd_vel", twist(-0.5, 0.0, 2.0)),
    "wheels_slip": lambda sim: sim.named("robot15").robot.slip(0.5),
    "a_robot_is_pushed": lambda sim: sim.named("robot15").robot.push((0.5, 0.2)),
}


def run_with(intervene: Callable[[mrs.Simulation], object], **parameters: Any) -> Sent:
    """Runs a crowd in which something happens once, between the third scan of robot 7 and those of the next robots."""
    sim = crowd(**parameters)
    sim.add_obstacle(mrs.Shape.disc(0.3), (8.0, 4.0, 0.0), "pillar")
    sent, scans = recorded(sim), []

    def take(scan: messages.LaserScan) -> None:
        scans.append(scan)
        if len(scans) == 3:
            intervene(sim)

    sim.subscribe("/robot7/scan", messages.LaserScan, take)
    sim.run_for(0.5)
    return sent


@pytest.mark.parametrize("frequency", [10.0, 40.0])
@pytest.mark.parametrize("name", INTERVENTIONS)
def test_what_happens_between_two_scans_of_an_instant_changes_the_later_ones(
    batches: list[int], name: str, frequency: float
) -> None:
    together, alone = both_ways(partial(run_with, INTERVENTIONS[name], laser_frequency=frequency))
    assert together == alone
    assert len(batches) >= 3


@pytest.mark.parametrize(
    "name", [name for name in INTERVENTIONS if name not in ("a_robot_is_commanded", "wheels_slip", "a_robot_is_pushed")]
)
def test_the_checks_of_what_happens_could_fail(name: str) -> None:
    """At the instant itself, scans differ from those of a run in which nothing happens."""
    without, changed = scans_of(run_with(lambda sim: None)), scans_of(run_with(INTERVENTIONS[name]))
    at = [time_ns for topic, time_ns, _ in without if topic == "/robot7/scan"][2]
    assert [each for each in without if each[1] == at] != [each for each in changed if each[1] == at]


def test_random_events_between_scans_change_the_same_scans() -> None:
    """Anything happens at any time, several times in one instant."""

    def run(seed: int) -> Sent:
        dice = random.Random(seed)
        sim = crowd(laser_frequency=dice.choice([10.0, 40.0]), contact=dice.choice(["stop", "slide"]))
        sim.add_obstacle(mrs.Shape.disc(0.3), (8.0, 4.0, 0.0), "pillar")
        sent = recorded(sim)

        def happen(_: object) -> None:
            if dice.random() < 0.03:
                robot = f"robot{dice.randrange(COUNT)}"
                place = (dice.uniform(7.0, 9.0), dice.uniform(1.0, 9.0), dice.uniform(-3.0, 3.0))
                move = dice.choice(
                    [
                        lambda: sim.add_obstacle(mrs.Shape.disc(0.1), place),
                        lambda: sim.move_obstacle("pillar", place, velocity=(0.3, 0.0, 0.0)),
                        lambda: sim.set_pose(place, robot),
                        lambda: sim.publish(f"/{robot}/cmd_vel", twist(*place)),
                        lambda: sim.set_cells(dice.randrange(90), 70, np.full((2, 2), dice.choice([0, 100]), np.int8)),
                        lambda: sim.named(robot).laser.set_parameters(sigma_hit=dice.uniform(0.01, 0.1)),
                        lambda: sim.named(robot).robot.push(place[:2]),
                    ]
                )
                try:
                    move()
                except ValueError:  # There is no room at the place.
                    pass

        for index in range(COUNT):
            sim.subscribe(f"/robot{index}/scan", messages.LaserScan, happen)
            sim.subscribe(f"/robot{index}/odom", messages.Odometry, happen)
        sim.run_for(0.6)
        return sent

    for seed in range(8):
        together, alone = both_ways(partial(run, seed))
        assert together == alone, seed


def test_nobody_is_looked_at_earlier_than_without_batches(batches: list[int]) -> None:
    """A robot with a footprint among some without does not ask where the others are, so it has to scan alone."""

    def run() -> Sent:
        sim = crowd(0)
        sim.remove_obstacle("1")
        names = [f"robot{index}" for index in range(COUNT)]
        shape = {"robot_radius": 0.0, "footprint": [(0.4, 0.1), (-0.4, 0.1), (-0.4, -0.1), (0.4, -0.1)]}
        for index, name in enumerate(names):
            parameters = shape if index == 0 else {"robot_radius": 0.0}
            sim.add_robot(name, start=(3.0 + 0.1 * index, 4.0, 3.0), parameters=parameters)
        sim.publish("/robot0/cmd_vel", twist(0.1, 0.0, 1.3))
        turns = iter((1.1, 1.2, 1.3, 1.4, 1.5, 1.6) * 20)
        sim.subscribe(
            "/robot0/scan", messages.LaserScan, lambda _: sim.publish("/robot0/cmd_vel", twist(0.1, 0.0, next(turns)))
        )
        sent = recorded(sim)
        sim.run_for(6.0)
        return sent

    together, alone = both_ways(run)
    assert together == alone and batches == []


def test_scans_after_a_restore_are_the_same_and_cast_in_batches_again(batches: list[int]) -> None:
    def run() -> Sent:
        sim = crowd()
        sim.run_for(0.2)
        state = sim.save()
        sent = recorded(sim)
        sent.clear()  # The map, which was published before.
        sim.run_for(0.1)
        first = list(sent)
        sim.add_robot("late", start=(8.5, 8.5, 0.0))
        sim.run_for(0.1)
        for _ in range(2):
            sent.clear()
            sim.restore(state)
            sim.run_for(0.1)
            assert sent == first
        return [*sent, *first]

    together, alone = both_ways(run)
    assert together == alone
    assert batches == [COUNT, COUNT, COUNT, COUNT + 1, COUNT, COUNT]


def test_a_run_that_an_exception_has_cut_goes_on_with_the_same_scans() -> None:
    def run() -> Sent:
        sim = crowd()
        sent = recorded(sim)

        def fail(_: object) -> None:
            if sim.time == pytest.approx(0.2):
                raise RuntimeError("a bug")

        sim.subscribe("/robot7/scan", messages.LaserScan, fail)
        with pytest.raises(RuntimeError, match="a bug"):
            sim.run_for(0.5)
        sim.add_obstacle(mrs.Shape.disc(0.3), (7.5, 5.0, 0.0))
        sim.run_for(0.25)
        return sent

    together, alone = both_ways(run)
    assert together == alone and len(scans_of(together)) == 4 * COUNT


@pytest.mark.parametrize("error", [ValueError, OSError, MemoryError])
def test_scanners_cast_alone_if_the_batch_fails(monkeypatch: pytest.MonkeyPatch, error: type[Exception]) -> None:
    expected = run_crowd(1.0)
    calls: list[object] = []

    def fail(scans: object) -> None:
        calls.append(scans)
        raise error("no threads")

    monkeypatch.setattr(scan_batch, "scan_each", fail)
    assert run_crowd(1.0) == expected
    assert len(calls) == 1, "the next batch comes later"


def test_batches_pause_while_each_scan_changes_the_world(batches: list[int]) -> None:
    sim = crowd()
    sim.add_obstacle(mrs.Shape.disc(0.3), (8.0, 4.0, 0.0), "pillar")
    moves: list[Any] = []
    for index in range(COUNT):
        topic = f"/robot{index}/scan"
        moves.append(sim.subscribe(topic, messages.LaserScan, lambda _: sim.move_obstacle("pillar", (8.0, 4.0, 0.0))))
    sim.run_for(0.1 * (scan_batch.SKIPPED + 3))
    assert len(batches) == 2
    for move in moves:
        sim.unsubscribe(move)
    sim.run_for(0.1 * (scan_batch.SKIPPED + 2))
    assert len(batches) == 5


class FakeScanner:
    """A scanner with a scan."""

    def __init__(self, scan: scan_batch.Scan) -> None:
        self.scan = scan

    def next_scan(self) -> scan_batch.Scan:
        return self.scan


def scan_of(grid: mrs.OccupancyGrid) -> scan_batch.Scan:
    return mrs.LaserScanner(beam_count=5), grid, mrs.Pose(1.0, 2.0, 0.5), mrs.Obstacles(), mrs.BeamModel(), None, 3, 4


CHANGES: tuple[Any, ...] = (
    mrs.LaserScanner(beam_count=6),
    hall(8.0),
    mrs.Pose(1.0, 2.0, 0.5000000000000001),
    mrs.Obstacles(),
    mrs.BeamModel(sigma_hit=0.2),
    mrs.SurfaceModel(incidence_sigma=0.1),
    4,
    5,
)


@pytest.mark.parametrize("part", [None, *range(len(CHANGES))])
def test_a_scan_is_taken_only_if_no_part_of_it_has_changed(part: int | None) -> None:
    grid = hall(10.0)
    scanners = [FakeScanner(scan_of(grid)) for _ in range(COUNT)]
    batch = scan_batch.ScanBatch(lambda: 7, lambda: scanners[1:])
    assert batch.take(scanners[0], scanners[0].scan) is not None
    last = scanners[-1]
    scan: Any = last.scan if part is None else (*last.scan[:part], CHANGES[part], *last.scan[part + 1 :])
    assert (batch.take(last, scan) is None) == (part is not None)
    assert batch.take(last, last.scan) is None, "each scan once"
    grid.set_cells(0, 0, np.zeros((1, 1), np.int8))
    assert batch.take(scanners[1], scanners[1].scan) is None
