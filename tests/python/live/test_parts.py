"""Parts: scans and outlines as a page reads them; test_frames.py and test_replay_frames.py look at whole frames."""

from __future__ import annotations

import base64
import json
import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.live.parts import outline_of, scan_part


def test_a_scan_is_placed_at_its_mount_and_beams_without_a_return_end_at_the_limits():
    scanner = mrs.LaserScanner(angle_min=0.0, angle_max=1.5, beam_count=4, min_range=0.5, max_range=8.0, mount=(1, 0, 0))
    ranges = np.array([2.0, np.inf, -np.inf, np.nan], np.float32)
    part = json.loads(scan_part(scanner, mrs.Pose(10.0, 20.0, math.pi / 2), ranges, 3.5))
    points = np.frombuffer(base64.b64decode(part["points"]), np.float32).reshape(-1, 2)
    assert part["place"] == pytest.approx([10.0, 21.0, math.pi / 2], abs=1e-4) and part["stamp"] == 3.5
    assert (list(base64.b64decode(part["hits"])), part["count"]) == ([1, 0, 0, 0], 1)
    np.testing.assert_allclose(points[0], (10.0, 23.0), atol=1e-5)
    np.testing.assert_allclose(np.hypot(*(points - (10.0, 21.0)).T), [2.0, 8.0, 0.5, 8.0], atol=1e-5)


def test_outlines():
    assert outline_of(None) is None
    assert outline_of(mrs.Shape.disc(0.3)) == {"radius": 0.3}
    assert sorted(outline_of(mrs.Shape.rectangle(2.0, 1.0))["corners"]) == [
        [-1.0, -0.5],
        [-1.0, 0.5],
        [1.0, -0.5],
        [1.0, 0.5],
    ]
