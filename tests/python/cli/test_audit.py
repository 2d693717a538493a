"""The command audit. tests/python/audit has the rules."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess

import pytest

pytest.importorskip("rosbags", reason="the extra `recording` is not installed")

from logs.bags import changed, messages, record
from mobile_robot_simulator.messages import LaserScan

Command = Callable[..., CompletedProcess[str]]


def break_scan(scan: LaserScan) -> None:
    scan.ranges[4] = 31.0


def test_a_clean_bag(command: Command, tmp_path: Path) -> None:
    done = command("audit", record(tmp_path / "bag", messages()))
    assert done.returncode == 0 and done.stdout.endswith("no findings\n") and "30 messages" in done.stdout
    done = command("audit", tmp_path / "bag", "--json")
    assert done.returncode == 0 and json.loads(done.stdout)["findings"] == []


def test_a_finding(command: Command, tmp_path: Path) -> None:
    bag = record(tmp_path / "bag", changed("/scan", break_scan))
    done = command("audit", bag)
    got = "1 readings outside 0.05..30; beam 4 has 31"
    expected = "a reading must be in range_min..range_max, or +inf, -inf or NaN (REP-117)"
    assert done.returncode == 3
    assert f"/scan message 7: scan-ranges: {expected}; got {got}\n1 findings\n" in done.stdout
    done = command("audit", bag, "--json")
    finding = {"rule": "scan-ranges", "topic": "/scan", "count": 1, "indices": [7], "got": got, "expected": expected}
    content = {"bag": str(bag), "messages": {"/odom": 30, "/scan": 30, "/tf": 30}, "findings": [finding]}
    assert done.returncode == 3 and json.loads(done.stdout) == content


def test_what_is_no_bag(command: Command, tmp_path: Path) -> None:
    done = command("audit", tmp_path / "missing")
    assert done.returncode == 1 and done.stderr == f"error: {tmp_path / 'missing'}: no such file or directory\n"
