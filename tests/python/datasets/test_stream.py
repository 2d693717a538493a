"""stream: endless batches that depend on the plan, the worker and their number only."""

from __future__ import annotations

import multiprocessing
import pickle
import sys
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from datasets.small_plans import private_memory_of_a_batch, small
from mobile_robot_simulator.datasets import load_maps, stream
from mobile_robot_simulator.datasets.job import job_of

PLAN = small(splits={"train": 1}, labels=["true_ranges"])


def bytes_of(batch: dict[str, np.ndarray]) -> bytes:
    return b"".join(batch[name].tobytes() for name in sorted(batch))


def test_a_batch_depends_on_worker_and_number_only() -> None:
    batches = [bytes_of(batch) for batch in islice(stream(PLAN, 20, worker=1), 5)]
    assert len(set(batches)) == 5
    for start in range(5):
        assert bytes_of(next(stream(PLAN, 20, worker=1, start=start))) == batches[start]
    assert bytes_of(next(stream(PLAN, 20, worker=2))) not in batches
    assert bytes_of(next(stream(PLAN.model_copy(update={"seed": 6}), 20, worker=1))) not in batches
    assert bytes_of(next(stream(PLAN.model_copy(update={"count": 9}), 20, worker=1))) == batches[0]
    assert [bytes_of(batch) for batch in islice(stream(PLAN, 20, worker=1, kept=1), 5)] == batches


def test_batches_are_scans_of_their_maps() -> None:
    laser, grids = mrs.LaserScanner(beam_count=31, max_range=6.0), [source.load() for _, source in job_of(PLAN).maps]
    seen = set()
    for batch in islice(stream(PLAN, 20), 10):
        assert [len(array) for array in batch.values()] == [20] * len(batch)
        for row in range(0, 20, 5):
            seen.add(int(batch["map"][row]))
            assert np.array_equal(batch["true_ranges"][row], laser.scan(grids[batch["map"][row]], batch["poses"][row]))
    assert seen == {0, 1, 2}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"batch_size": 0}, "batch_size must be at least 1, got 0"),
        ({"worker": -1}, "worker must be at least 0, got -1"),
        ({"start": -1}, "start must be at least 0, got -1"),
        ({"split": "test"}, "split must be one of train, got 'test'"),
    ],
)
def test_arguments_out_of_range(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        stream(PLAN, **{"batch_size": 4, **arguments})


def test_maps_that_are_loaded_before_give_the_same_batches(monkeypatch: pytest.MonkeyPatch) -> None:
    maps = load_maps(PLAN)
    expected = [bytes_of(batch) for batch in islice(stream(PLAN, 20), 5)]
    copied = pickle.loads(pickle.dumps(maps))
    assert [bytes_of(batch) for batch in islice(stream(PLAN, 20, maps=copied), 5)] == expected
    monkeypatch.setattr("mobile_robot_simulator.datasets.map_pool.MapSource.load", None)  # No map is loaded again.
    assert [bytes_of(batch) for batch in islice(stream(PLAN, 20, maps=maps), 5)] == expected
    with pytest.raises(ValueError, match="split must be one of train, got 'test'"):
        load_maps(PLAN, split="test")


@pytest.mark.skipif(not Path("/proc/self/smaps_rollup").exists(), reason="only Linux tells which memory is shared")
def test_forked_workers_share_the_maps_of_their_parent() -> None:
    # A map of four million cells takes more than 40 MB with its tables.
    plan = small(maps=[{"floor_plan": "office", "size": [100, 100]}], splits={"train": 1})
    maps = load_maps(plan)
    grown = {}
    for name, given in {"shared": maps, "own": None}.items():
        context = multiprocessing.get_context("fork")
        results = context.SimpleQueue()
        worker = context.Process(target=private_memory_of_a_batch, args=(plan, given, results))
        worker.start()
        grown[name] = results.get()
        worker.join()
    assert grown["shared"] < 8.0 and grown["own"] > 16.0, grown


@pytest.mark.skipif(sys.platform == "win32", reason="Windows cannot fork")
def test_a_fork_while_another_thread_loads_a_map() -> None:
    maps, expected = load_maps(PLAN), bytes_of(next(stream(PLAN, 20)))
    with maps._lock:  # As a thread does for a moment.
        context = multiprocessing.get_context("fork")
        results = context.Queue()
        worker = context.Process(target=lambda: results.put(bytes_of(next(stream(PLAN, 20, maps=maps)))))
        worker.start()
    assert results.get(timeout=30) == expected
    worker.join(60)
    assert worker.exitcode == 0
