"""stream: endless batches that depend on the plan, the worker and their number only."""

from __future__ import annotations

from itertools import islice
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from datasets.small_plans import small
from mobile_robot_simulator.datasets import stream
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
