"""Digest: any bit of any message changes it."""

from __future__ import annotations

import dataclasses

import numpy as np

from falsification.crossing import SPACE
from mobile_robot_simulator.falsification.digest import Digest
from mobile_robot_simulator.messages import Header, LaserScan, Time


def digest(*written):
    found = Digest()
    for topic, message, time_ns in written:
        found.write(topic, message, time_ns)
    return found.text()


def test_every_bit_counts():
    scan = LaserScan(
        header=Header(stamp=Time(1, 2), frame_id="laser"), range_max=5.0, ranges=np.array([1.0, 2.0], np.float32)
    )
    same = digest(("/scan", scan, 5))
    assert same == digest(("/scan", dataclasses.replace(scan, ranges=scan.ranges.copy()), 5))
    others = [
        digest(("/scan", scan, 6)),
        digest(("/scam", scan, 5)),
        digest(("/scan", scan, 5), ("/scan", scan, 5)),
        digest(("/scan", dataclasses.replace(scan, range_max=np.nextafter(5.0, 6.0)), 5)),
        digest(("/scan", dataclasses.replace(scan, ranges=np.nextafter(scan.ranges, np.float32(9.0))), 5)),
        digest(("/scan", dataclasses.replace(scan, ranges=scan.ranges.astype(np.float64)), 5)),
        digest(("/scan", dataclasses.replace(scan, header=Header(stamp=Time(1, 3), frame_id="laser")), 5)),
        digest(),
    ]
    assert len({same, *others}) == len(others) + 1


def test_a_drive_has_the_same_digest_again_and_another_seed_another_one():
    def drive(seed):
        world = dataclasses.replace(
            SPACE.world([0.5] * len(SPACE.dimensions)), seed=seed, parameters={"laser_beam_count": 9}
        )
        found = Digest()
        with world.simulation() as sim:
            sim.record(found.write)
            sim.run_for(1.0)
        return found.text()

    assert drive(1) == drive(1) != drive(2)
