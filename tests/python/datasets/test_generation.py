"""generation: the finished folder has the same bytes, whatever happened on the way."""

from __future__ import annotations

import importlib
import json
import os
import random
import signal
import subprocess
import sys
import time
import tracemalloc
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("zarr", reason="the extra `datasets` is not installed, or has no Zarr for this Python")

import zarr

import mobile_robot_simulator as mrs
from datasets.small_plans import files_of, small
from disks import read_only_folder, small_disk
from mobile_robot_simulator.datasets import Progress, estimate, generate
from mobile_robot_simulator.datasets.workspace import Workspace

PLAN = small()

MAKE = """
import sys
from pathlib import Path
from mobile_robot_simulator.datasets import Plan, generate
plan, out, threads = sys.argv[1:]
print("started", flush=True)
generate(Plan.model_validate_json(plan), out=out, threads=int(threads))
"""


def make(out: Path, threads: int = 2) -> list[str]:
    return [sys.executable, "-c", MAKE, json.dumps(PLAN.content), str(out), str(threads)]


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    out = tmp_path_factory.mktemp("whole") / "data"
    report = generate(PLAN, out=out, threads=1)
    assert (report.scans, report.shards, report.made) == (200, 8, 8)
    return files_of(out)


def test_a_data_set_is_a_zarr_store(expected: dict[str, bytes], tmp_path: Path) -> None:
    generate(PLAN, out=tmp_path / "data")
    store = zarr.open_group(tmp_path / "data", mode="r")
    assert {name for name, _ in store.members(max_depth=None)} == {
        f"{split}{array}" for split in ("train", "test") for array in ("", "/drawn", "/map", "/poses", "/ranges", "/scene")
    }
    ranges = store["train/ranges"]
    assert (ranges.shape, ranges.dtype, ranges.shards, ranges.metadata.zarr_format) == ((133, 31), "float32", (32, 31), 3)
    assert ranges.attrs["units"] == "m" and store["train/poses"].attrs["frame"] == "map"
    # Provenance.
    attributes = store.attrs.asdict()
    assert attributes["made_from"]["plan"] == PLAN.content
    assert attributes["made_from"]["versions"]["mobile_robot_simulator"] == mrs.__version__
    assert [(entry["split"], len(entry["sha256"])) for entry in attributes["maps"]] == [
        ("train", 64),
        ("train", 64),
        ("test", 64),
    ]
    shards = store["train"].attrs["shards"]
    assert [shard["first"] for shard in shards] == [0, 32, 64, 96, 128] and shards[1]["seed"] == "5/train/4"
    assert {*shards[0]["blake3"]} == {"ranges", "poses", "map", "scene", "drawn"}


@pytest.mark.parametrize("threads", [1, 2, 5, None])
def test_any_number_of_threads_gives_the_same_bytes(threads: int | None, expected: dict[str, bytes], tmp_path: Path) -> None:
    seen: list[Progress] = []
    generate(PLAN, out=tmp_path, threads=threads, progress=seen.append)
    assert files_of(tmp_path) == expected
    assert seen[0] == (0, 200, 0, 8) and seen[-1] == (200, 200, 8, 8) and [each.shards for each in seen] == [*range(9)]


def test_a_part_is_completed_to_the_same_bytes(expected: dict[str, bytes], tmp_path: Path) -> None:
    class Enough(Exception):
        pass

    def stop(progress: Progress) -> None:
        if progress.shards == 3:
            raise Enough

    with pytest.raises(Enough):
        generate(PLAN, out=tmp_path, threads=1, progress=stop)
    there = files_of(tmp_path)
    assert "zarr.json" not in there and ".unfinished/shards/train-000002.json" in there
    # Half of a file that a killed process leaves, and a file that lost its end with the power.
    (tmp_path / "train/ranges/.new-x").mkdir()
    (tmp_path / "train/ranges/.new-x/c.7.0").write_bytes(b"half")
    (tmp_path / "train/poses/c.1.0").write_bytes(b"")
    report = generate(PLAN, out=tmp_path)
    assert files_of(tmp_path) == expected and not list(tmp_path.rglob(".*"))
    assert 1 <= report.made <= 6  # shards that ran when it stopped may have been completed


def test_a_complete_data_set_is_left_alone(expected: dict[str, bytes], tmp_path: Path) -> None:
    generate(PLAN, out=tmp_path)
    times = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*") if path.is_file()}
    assert generate(PLAN, out=tmp_path).made == 0
    assert {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*") if path.is_file()} == times


@pytest.mark.parametrize("threads", [1, 3])
def test_what_is_missing_of_a_complete_data_set_is_made_again(
    threads: int, expected: dict[str, bytes], tmp_path: Path
) -> None:
    generate(PLAN, out=tmp_path)
    (tmp_path / "train/ranges/c.0.0").unlink()
    (tmp_path / "train/map/c.4").write_bytes(b"")
    for file in (tmp_path / "test/scene").glob("c.*"):
        file.unlink()
    seen: list[Progress] = []
    report = generate(PLAN, out=tmp_path, threads=threads, progress=seen.append)
    assert (report.shards, report.made) == (8, 5) and files_of(tmp_path) == expected
    assert seen[0] == (96, 200, 3, 8) and seen[-1] == (200, 200, 8, 8)


def test_a_repair_that_was_broken_off_goes_on(expected: dict[str, bytes], tmp_path: Path) -> None:
    def stop(progress: Progress) -> None:
        raise InterruptedError

    generate(PLAN, out=tmp_path)
    (tmp_path / "test/poses/c.1.0").unlink()
    with pytest.raises(InterruptedError):
        generate(PLAN, out=tmp_path, progress=stop)
    assert generate(PLAN, out=tmp_path).made == 1
    assert files_of(tmp_path) == expected


def test_a_shard_that_has_become_another_is_not_mixed_with_the_others(tmp_path: Path) -> None:
    """The code of a policy is not part of what is compared with the plan."""
    plan = small(poses={"kind": "drives", "clearance": 0.2, "policy": "turning_policy:make"}, count=40, folder=tmp_path)
    for rate in (0.3, 0.65):  # Files of different sizes, so that Python does not take old bytecode for the second.
        (tmp_path / "turning_policy.py").write_text(f"def make():\n    return lambda observation: (0.0, {rate})\n")
        sys.modules.pop("turning_policy", None)
        if rate == 0.3:
            generate(plan, out=tmp_path / "data", threads=1)
            (tmp_path / "data/train/ranges/c.0.0").unlink()
            before = files_of(tmp_path / "data")
    importlib.invalidate_caches()
    with pytest.raises(ValueError, match=r"train-000000 are missing, and made again, other numbers come out: .*poses"):
        generate(plan, out=tmp_path / "data", threads=1)
    assert files_of(tmp_path / "data") == before


@pytest.mark.parametrize("is_complete", [True, False])
def test_another_plan_is_an_error_that_says_what_changed(is_complete: bool, tmp_path: Path) -> None:
    def stop(progress: Progress) -> None:
        if progress.shards == 1 and not is_complete:
            raise InterruptedError

    try:
        generate(PLAN, out=tmp_path, progress=stop)
    except InterruptedError:
        assert not is_complete
    before = files_of(tmp_path)
    with pytest.raises(ValueError) as error:
        generate(small(noise={"sigma_hit": [0.01, 0.06]}, count=201), out=tmp_path)
    assert str(error.value) == (
        f"{tmp_path}: the folder has data of another plan; give another folder, or undo the changes: "
        "count: 200 -> 201; noise.sigma_hit[1]: 0.05 -> 0.06"
    )
    assert {name: data for name, data in files_of(tmp_path).items() if name != ".unfinished/lock"} == {
        name: data for name, data in before.items() if name != ".unfinished/lock"
    }


def test_another_map_is_an_error(tmp_path: Path) -> None:
    for seed in (1, 2):
        mrs.save_map(mrs.floor_plan("maze", seed=seed, size=(10.0, 8.0), resolution=0.1), tmp_path / "map.yaml")
        plan = small(maps=[{"files": "map.yaml"}], splits={"train": 1}, folder=tmp_path)
        if seed == 1:
            generate(plan, out=tmp_path / "data")
    with pytest.raises(ValueError, match=r"another plan; .*: maps\[0\].digest: '[0-9a-f.]+' -> '"):
        generate(plan, out=tmp_path / "data")


def test_a_folder_with_other_files(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("all of it")
    with pytest.raises(FileExistsError, match=r"the folder of a new data set must be empty, got thesis.tex"):
        generate(PLAN, out=tmp_path)
    with pytest.raises(NotADirectoryError, match="the place of a data set must be a folder"):
        generate(PLAN, out=tmp_path / "thesis.tex")
    assert (tmp_path / "thesis.tex").read_text() == "all of it"


def test_two_processes_do_not_make_the_same_data_set(tmp_path: Path) -> None:
    with Workspace(tmp_path, "zarr.json").locked(), pytest.raises(OSError, match="another process makes this data set"):
        generate(PLAN, out=tmp_path)


def test_a_scene_that_is_not_possible_is_an_error_with_its_map(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"maze \d, 10 x 8 m.*, scene \d+ of train: "):
        generate(small(poses={"clearance": 5.0}), out=tmp_path)


@pytest.mark.parametrize("threads", [0, 1025])
def test_a_number_of_threads_out_of_range(threads: int, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=f"threads must be in 1..1024, got {threads}"):
        generate(PLAN, out=tmp_path / "data", threads=threads)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"engine": "slurm"}, "engine must be 'threads' or 'ray', got 'slurm'"),
        ({"address": "auto"}, "only the engine ray has an address, got 'auto'"),
        ({"engine": "ray", "threads": 2}, "the engine ray takes the CPUs of its cluster, got threads=2"),
    ],
)
def test_an_engine_that_does_not_fit(arguments: dict[str, Any], message: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=message):
        generate(PLAN, out=tmp_path / "data", **arguments)
    assert not list(tmp_path.iterdir())


def test_a_full_disk_is_an_error_and_the_rest_is_made_later(expected: dict[str, bytes], tmp_path: Path) -> None:
    with small_disk(160) as disk:
        with pytest.raises(OSError, match="No space left on device"):
            generate(PLAN, out=disk / "data")
        for path in (disk / "data").rglob("*"):
            if path.is_file():
                place = tmp_path / path.relative_to(disk / "data")
                place.parent.mkdir(parents=True, exist_ok=True)
                place.write_bytes(path.read_bytes())
    assert any((tmp_path / ".unfinished/shards").iterdir())
    assert generate(PLAN, out=tmp_path).made < 8
    assert files_of(tmp_path) == expected


def test_a_folder_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    with read_only_folder(tmp_path / "data"), pytest.raises(OSError):
        generate(PLAN, out=tmp_path / "data")


@pytest.mark.slow
def test_killed_at_random_moments_the_same_bytes_come_out(expected: dict[str, bytes], tmp_path: Path) -> None:
    dice, kills = random.Random(1), 0
    for turn in range(3):
        out = tmp_path / f"{turn}"
        while True:
            with subprocess.Popen(make(out, threads=1 + turn % 3), stdout=subprocess.PIPE, text=True) as process:
                assert process.stdout and process.stdout.readline() == "started\n"
                time.sleep(dice.uniform(0.0, 0.5))
                process.send_signal(signal.SIGKILL)
            if process.returncode == 0:
                break
            assert process.returncode == -signal.SIGKILL
            kills += 1
            # A store that can be opened is complete.
            assert not (out / "zarr.json").exists() or {**files_of(out), **expected} == files_of(out)
            if kills % 4 == 0:
                subprocess.run(make(out), check=True, capture_output=True)
                break
        assert files_of(out) == expected
    assert kills >= 3


KILLED_AT_EACH_STEP = """
import os, shutil, sys
from mobile_robot_simulator.datasets import Plan, generate

def count_changes(event, arguments):
    global left
    if event in ("os.rename", "os.remove", "os.mkdir", "os.rmdir") or (event == "open" and arguments[2] & os.O_CREAT):
        left -= 1
        if left == 0:
            os._exit(9)

plan, out, first = Plan.model_validate_json(sys.argv[1]), sys.argv[2], int(sys.argv[3])
left = first
sys.addaudithook(count_changes)
generate(plan, out=out, threads=1)
"""


@pytest.mark.slow
def test_killed_at_many_steps_the_same_bytes_come_out(tmp_path: Path) -> None:
    """The process ends itself before its n-th change of the disk, for n from the start to the end of the work."""
    plan = small(count=40, scans_per_shard=16, splits={"train": 1})
    generate(plan, out=tmp_path / "whole")
    whole, step, done = files_of(tmp_path / "whole"), 1, False
    while not done:
        out = tmp_path / f"{step}"
        command = [sys.executable, "-c", KILLED_AT_EACH_STEP, json.dumps(plan.content), str(out), str(step)]
        ran = subprocess.run(command, capture_output=True, text=True, timeout=60)
        assert ran.returncode in (0, 9), ran.stderr
        done = ran.returncode == 0
        generate(plan, out=out)
        assert files_of(out) == whole, step
        step += 13 if step > 8 else 3
    assert step > 80


@pytest.mark.skipif(sys.platform == "win32", reason="Windows cannot send SIGINT to one process")
def test_ctrl_c_ends_a_long_shard(tmp_path: Path) -> None:
    """A shard of drives with a slow policy takes minutes."""
    plan = small(
        poses={"kind": "drives", "policy": "slow_policy:Slow", "clearance": 0.2}, scans_per_scene=4096, scans_per_shard=4096
    )
    plan = plan.model_copy(update={"count": 100_000})
    (tmp_path / "slow_policy.py").write_text(
        "import os, time\nclass Slow:\n    def __call__(self, observation):\n"
        # One write, because two threads may print on one line.
        "        os.write(1, b'drives\\n')\n        time.sleep(0.05)\n        return 0.0, 0.0\n"
    )
    script = MAKE.replace("generate(Plan", "try:\n    generate(Plan") + "except KeyboardInterrupt:\n    print('ended')\n"
    command = [sys.executable, "-c", script, json.dumps(plan.content), str(tmp_path / "data"), "2"]
    paths = os.pathsep.join([str(tmp_path), *sys.path])
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env={**os.environ, "PYTHONPATH": paths}
    ) as process:
        try:
            assert process.stdout and process.stdout.readline() == "started\n" and process.stdout.readline() == "drives\n"
            process.send_signal(signal.SIGINT)
            printed, errors = process.communicate(timeout=60)
        finally:
            process.kill()
    assert (process.returncode, printed.splitlines()[-1], errors) == (0, "ended", "")
    assert not list(tmp_path.rglob(".new-*")) and not (tmp_path / "data/zarr.json").exists()


def test_memory_does_not_grow_with_the_number_of_scans(tmp_path: Path) -> None:
    script = MAKE + "import resource\nprint(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)\n"
    peaks = []
    for count in (8192, 65536):
        plan = small(count=count, scans_per_shard=2048, scanner={"beam_count": 181})
        command = [sys.executable, "-c", script, json.dumps(plan.content), str(tmp_path / f"{count}"), "2"]
        ran = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120)
        peaks.append(int(ran.stdout.split()[-1]) / 1024)
    # All scans of the larger one have 47 MB.
    assert peaks[1] - peaks[0] < 20.0, peaks


def test_an_estimate_is_right_about_numbers_and_sizes(expected: dict[str, bytes]) -> None:
    found = estimate(PLAN)
    assert (found.scans, found.maps, found.shards) == ({"train": 133, "test": 67}, {"train": 2, "test": 1}, 8)
    row = 31 * 4 + 3 * 8 + 4 + 8 + 8
    assert found.raw_bytes == 200 * row and found.seconds > 0.0
    stored = sum(len(data) for name, data in expected.items() if "zarr.json" not in name)
    assert 0.5 < found.stored_bytes / stored < 1.5


def test_an_estimate_of_a_huge_data_set_takes_no_memory_for_its_shards() -> None:
    tracemalloc.start()
    try:
        found = estimate(small(count=8_000_000, scans_per_shard=8, splits={"train": 1}))
        assert found.shards == 1_000_000 and tracemalloc.get_traced_memory()[1] < 50e6
    finally:
        tracemalloc.stop()
