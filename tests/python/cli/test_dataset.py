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
        f"train-000002: {out / 'train/poses/c.2.0'}: this file of the data set is missing or empty; give the command that "
        "made the data set again\n4 shards made again, 1 differ"
    )


def test_maps_that_are_not_found_are_an_error_that_names_the_option(command: Command, plan: Path, tmp_path: Path) -> None:
    out = tmp_path / "data"
    assert command("dataset", plan, "--out", out).returncode == 0
    (tmp_path / "elsewhere").mkdir()
    done = command("dataset", "verify", out, "--maps", tmp_path / "elsewhere")
    assert done.returncode == 1
    assert "no map file of this name for 'room.yaml' of the plan; give the folder of the plan as --maps DIR" in done.stderr


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
        (
            ["somewhere"],
            "only verify and export have a second argument, got somewhere; give the folder of a new data set as --out DIR",
        ),
    ],
)
def test_a_missing_folder(arguments: list[str], message: str, command: Command, plan: Path) -> None:
    done = command("dataset", plan, *arguments)
    assert (done.returncode, done.stderr) == (1, f"error: {message}\n")


def test_verify_without_a_folder(command: Command) -> None:
    done = command("dataset", "verify")
    assert (done.returncode, done.stderr) == (1, "error: verify needs the folder of a data set: dataset verify DIR\n")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["verify", "data", "--out", "x"], "verify takes no --out; it takes --sample, --maps and --json"),
        (["verify", "data", "--threads", 2], "verify takes no --threads; it takes --sample, --maps and --json"),
        (["verify", "data", "--engine", "ray"], "verify takes no --engine; it takes --sample, --maps and --json"),
        (["verify", "data", "--dry-run"], "verify takes no --dry-run; it takes --sample, --maps and --json"),
        (["PLAN", "--dry-run", "--threads", 0], "threads must be in 1..1024, got 0"),
        (
            ["PLAN", "--dry-run", "--address", "auto"],
            "--dry-run takes no --address; it takes --dry-run, --threads, --out and --json",
        ),
        (
            ["PLAN", "--out", "x", "--sample", 2],
            "a plan takes no --sample; it takes --out, --threads, --engine, --address and --json",
        ),
        (["export", "data"], "export needs folders and a format: dataset export DIR --format minari --out DIR"),
        (
            ["export", "data", "--format", "minari", "--out", "x", "--threads", 1],
            "export takes no --threads; it takes --format, --out and --json",
        ),
    ],
)
def test_an_option_without_effect(arguments: list[str], message: str, command: Command, plan: Path) -> None:
    done = command("dataset", *(plan if argument == "PLAN" else argument for argument in arguments))
    assert (done.returncode, done.stderr) == (1, f"error: {message}\n")


def test_drives_are_exported(command: Command, plan: Path, tmp_path: Path) -> None:
    pytest.importorskip("minari", reason="the extra `minari` is not installed, or has no Minari for this Python")
    plan.write_text(PLAN + "poses: {kind: drives, clearance: 0.2}\nlabels: [commands]\n")
    assert command("dataset", plan, "--out", tmp_path / "data").returncode == 0
    done = command("dataset", "export", tmp_path / "data", "--format", "minari", "--out", tmp_path / "out")
    assert (done.returncode, done.stdout, done.stderr) == (0, f"{tmp_path / 'out'}: 7 episodes of train\n", "")
    done = command("dataset", "export", tmp_path / "data", "--format", "minari", "--out", tmp_path / "out", "--json")
    assert done.returncode == 1 and "must be new or empty" in done.stderr
    done = command("dataset", "export", tmp_path / "data", "--format", "minari", "--out", tmp_path / "two", "--json")
    assert json.loads(done.stdout) == {"event": "exported", "path": str(tmp_path / "two"), "episodes": {"train": 7}}


def test_another_plan(command: Command, plan: Path, tmp_path: Path) -> None:
    assert command("dataset", plan, "--out", tmp_path / "data").returncode == 0
    plan.write_text(PLAN.replace("100", "101"))
    done = command("dataset", plan, "--out", tmp_path / "data")
    assert done.returncode == 1 and done.stderr.endswith("or undo the changes: count: 100 -> 101\n")
