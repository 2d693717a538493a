"""Small plans for tests, and what a folder contains."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from mobile_robot_simulator.datasets import MapPool, Plan, Split, stream

SMALL: dict[str, Any] = {
    "seed": 5,
    "count": 200,
    "maps": [{"floor_plan": "maze", "seeds": [1, 3], "size": [10, 8], "resolution": 0.1}],
    "scanner": {"beam_count": 31, "max_range": 6.0},
    "noise": {"sigma_hit": [0.01, 0.05]},
    "splits": {"train": 2, "test": 1},
    "scans_per_scene": 8,
    "scans_per_shard": 32,
}

DRIVES: dict[str, Any] = {
    "poses": {"kind": "drives", "clearance": 0.2},
    "labels": ["commands", "goals", "goal_distances", "surfaces"],
}
"""Changes for a plan whose data set can be exported."""


def small(**changes: Any) -> Plan:
    return Plan(**{**SMALL, **changes})


def files_of(folder: Path) -> dict[str, bytes]:
    """The bytes of all files by their path in the folder."""
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def load(split: Split, worker: int, results: object) -> None:
    """The loop of a worker of a data loader. Here, because a spawned process imports it."""
    shuffled = [batch["ranges"].tobytes() for batch in split.batches(16, seed=1, worker=worker, workers=2)]
    results.put((worker, shuffled, [split[index]["ranges"].tobytes() for index in range(worker, 40, 2)]))  # type: ignore[attr-defined]


def private_memory_of_a_batch(plan: Plan, maps: MapPool | None, results: object) -> None:
    """Puts the growth of this process's own memory by a batch of a stream [MB]."""

    def private() -> float:
        lines = Path("/proc/self/smaps_rollup").read_text().splitlines()
        return sum(int(line.split()[1]) for line in lines if line.startswith("Private")) / 1024

    before = private()
    next(stream(plan, 20, maps=maps))
    results.put(private() - before)  # type: ignore[attr-defined]
