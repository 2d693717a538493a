"""The command dataset. tests/python/datasets has what it makes."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess

import pytest

pytest.importorskip("zarr", reason="the extra `datasets` is not installed, or has no Zarr for this Python")

Command = Callable[..., CompletedProcess[str]]

PLAN = """
seed: 1
count: 100
maps: [{files: room.yaml}]
scanner: {beam_count: 31}
noise: {sigma_hit: 0.01}
scans_per_scene: 16
scans_per_shard: 32
"""


@pytest.fixture
def plan(room: Path) -> Path:
    file = room.parent / "plan.yaml"
    file.write_text(PLAN)
    return file


def test_a_data_set_is_made_verified_and_left_alone(command: Command, plan: Path, tmp_path: Path) -> None:
    out = tmp_path / "data"
    done = command("dataset", plan, "--dry-run")
    assert done.returncode == 0 and "100 scans of 1 maps" in done.stdout and not out.exists()
    done = command("dataset", plan, "--out", out)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith(f"{out}: 100 scans in 4 shards, 4 of them made in ") and done.stdout.endswith(" scans/s\n")
    done = command("dataset", plan, "--out", out)
    assert done.returncode == 0 and "0 of them made" in done.stdout
    done = command("dataset", "verify", out, "--maps", plan.parent)
    assert (done.returncode, done.stdout) == (0, "4 shards made again, 0 differ\n")
    (out / "train/poses/c.2.0").unlink()
    done = command("dataset", "verify", out, "--maps", plan.parent)
    assert done.returncode == 3
    assert done.stdout.startswith(
        "train-000002: stored numbers do not have their digest: poses\n4 shards made again, 1 differ"
    )


def test_events(command: Command, plan: Path, tmp_path: Path) -> None:
    done = command("dataset", plan, "--out", tmp_path / "data", "--json", "--threads", 1)
    *progress, last = map(json.loads, done.stdout.splitlines())
    assert [(event["event"], event["shards"], event["total"], event["total_shards"]) for event in progress] == [
        ("progress", shards, 100, 4) for shards in range(5)
    ]
    # The last shard, of 4 scans, may be written before another.
    scans = [event["scans"] for event in progress]
    assert scans[0] == 0 and scans[4] == 100 and scans == sorted(scans)
    assert (last["event"], last["scans"], last["made"]) == ("complete", 100, 4)
    (estimate,) = map(json.loads, command("dataset", plan, "--dry-run", "--json").stdout.splitlines())
    assert (estimate["event"], estimate["scans"], estimate["shards"]) == ("estimate", {"train": 100}, 4)
    (verified,) = map(
        json.loads, command("dataset", "verify", tmp_path / "data", "--json", "--maps", plan.parent).stdout.splitlines()
    )
    assert verified == {"event": "verified", "shards": 4, "differences": [], "notes": []}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "a data set needs a folder: give --out DIR, or --dry-run"),
        (["somewhere"], "only verify has a second argument, got somewhere; give the folder of a new data set as --out DIR"),
    ],
)
def test_a_missing_folder(arguments: list[str], message: str, command: Command, plan: Path) -> None:
    done = command("dataset", plan, *arguments)
    assert (done.returncode, done.stderr) == (1, f"error: {message}\n")


def test_verify_without_a_folder(command: Command) -> None:
    done = command("dataset", "verify")
    assert (done.returncode, done.stderr) == (1, "error: verify needs the folder of a data set: dataset verify DIR\n")


def test_another_plan(command: Command, plan: Path, tmp_path: Path) -> None:
    assert command("dataset", plan, "--out", tmp_path / "data").returncode == 0
    plan.write_text(PLAN.replace("100", "101"))
    done = command("dataset", plan, "--out", tmp_path / "data")
    assert done.returncode == 1 and done.stderr.endswith("or undo the changes: count: 100 -> 101\n")
