"""The stamps of scans and transforms: they are the same times, so that nobody waits for a transform."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from test_nodes import SCAN, TF
from worlds import VERSION

SCAN_COUNT = 40
ENOUGH = 0.95
"""Share of the scans that must have a transform. A node that gets no processor for a whole period skips a stamp."""


def nanoseconds(stamp: Any) -> int:
    """Returns a stamp of ROS 1 or ROS 2 in nanoseconds."""
    return stamp.to_nsec() if VERSION == "1" else stamp.sec * 10**9 + stamp.nanosec


@pytest.fixture
def sim_time(request: pytest.FixtureRequest, world: Any) -> Any:
    """Arguments of a node that follows /clock, or none."""
    if not request.param or VERSION == "2":
        yield {"use_sim_time": True} if request.param else {}
        return
    world.rospy.set_param("/use_sim_time", True)
    yield {}
    world.rospy.set_param("/use_sim_time", False)


def start(world: Any, map_file: Path, *, together: bool, robot: dict[str, Any], laser: dict[str, Any]) -> None:
    if together:
        world.start("all", map_file=map_file, **robot, **laser)
        return
    world.start("robot", **robot)
    world.start("map", map_file=map_file)
    world.start("laser", **laser)


@pytest.mark.parametrize(
    ("together", "sim_time"),
    [(True, False), (False, False), (False, True)],
    ids=["together", "apart", "apart with /clock"],
    indirect=["sim_time"],
)
def test_each_scan_has_a_transform_at_its_stamp(
    world: Any, map_file: Path, together: bool, sim_time: dict[str, Any]
) -> None:
    clock = {"publish_clock": True} if VERSION == "1" and not together else {}
    start(world, map_file, together=together, robot=clock, laser=sim_time)
    check_stamps(world)


def test_scans_of_all_have_transforms_at_any_rate(world: Any, map_file: Path) -> None:
    world.start("all", map_file=map_file, publish_rate=10.0, laser_frequency=40.0)
    check_stamps(world)


def check_stamps(world: Any) -> None:
    """Checks that scans have transforms at their stamps, and prints how long one waits for them."""
    scans, transforms = world.subscribe("/scan", SCAN), world.subscribe("/tf", TF)
    transforms.wait_for(3)
    scans.wait_for(3)
    first = len(scans)
    scans.wait_for(SCAN_COUNT)
    transforms.wait_for(2)
    of_scans = [nanoseconds(scan.header.stamp) for scan in scans[first : first + SCAN_COUNT]]
    of_transforms = [nanoseconds(message.transforms[-1].header.stamp) for message in transforms]
    arrivals = dict(zip(of_transforms, transforms.times, strict=False))
    waits = []
    for stamp, arrived in zip(of_scans, scans.times[first:], strict=False):
        usable = [time for other, time in arrivals.items() if other >= stamp]
        waits.append(max(0.0, min(usable, default=arrived + 1.0) - arrived))
    matched, prompt = np.isin(of_scans, of_transforms), np.array(waits) < 0.005
    print(
        f"\n{matched.sum()} of {SCAN_COUNT} scans have a transform at their stamp; {prompt.sum()} can be transformed within "
        f"5 ms after their arrival, median {np.median(waits) * 1e3:.1f} ms"
    )
    assert matched.mean() >= ENOUGH
