"""Data sets of PyTorch, as an application has them. Here, because spawned workers import them."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from torch.utils.data import Dataset, IterableDataset, get_worker_info

import mobile_robot_simulator as mrs
from mobile_robot_simulator import datasets

LASER = mrs.LaserScanner(beam_count=61, max_range=8.0)


class Shuffled(IterableDataset):
    """Shuffled batches of a split. Each worker reads shards of its own."""

    def __init__(self, folder: Path, split: str, size: int) -> None:
        self._split, self._size, self.epoch = datasets.open(folder)[split], size, 0

    def __iter__(self) -> Iterator[dict[str, NDArray[Any]]]:
        info = get_worker_info()
        worker, workers = (0, 1) if info is None else (info.id, info.num_workers)
        return self._split.batches(self._size, seed=self.epoch, worker=worker, workers=workers)


class Streams(IterableDataset):
    """Scans that are made while they are read. Each worker has a stream of its own, of which it gives `count` batches."""

    def __init__(self, plan: datasets.Plan, size: int, count: int) -> None:
        self._plan, self._size, self._count, self._maps = plan, size, count, datasets.load_maps(plan)

    def __iter__(self) -> Iterator[dict[str, NDArray[Any]]]:
        info = get_worker_info()
        worker = 0 if info is None else info.id
        return islice(datasets.stream(self._plan, self._size, worker=worker, maps=self._maps), self._count)


class Scans(Dataset):
    """Scans of a grid, each cast in the worker on two threads."""

    def __init__(self, grid: mrs.OccupancyGrid, poses: NDArray[np.float64]) -> None:
        self._grid, self._poses = grid, poses

    def __len__(self) -> int:
        return len(self._poses) // 50

    def __getitem__(self, index: int) -> NDArray[np.float32]:
        return LASER.scan_batch(self._grid, self._poses[50 * index : 50 * (index + 1)], threads=2)
