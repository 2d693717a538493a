"""Minari: drives as the episodes of a Minari data set, in HDF5."""

from __future__ import annotations

from collections.abc import Iterable
from importlib.metadata import version
from pathlib import Path
from typing import Any

import h5py  # noqa: F401  # Minari's storage needs it, and says so only when it writes.
import numpy as np
from gymnasium import spaces
from minari.data_collector.episode_buffer import EpisodeBuffer
from minari.dataset.minari_storage import MinariStorage

from .episodes import ACTION, Episode, columns_of_episodes
from .reader import Dataset
from .scenes import Column

__all__ = ["write"]


def write(folder: Path, name: str, dataset: Dataset, episodes: Iterable[Episode]) -> int:
    """Writes a split as a Minari data set `NAME-v0`, and returns its number of episodes.

    An episode of n scans has n observations and n - 1 actions: after the last scan, the robot did not go on.

    Args:
        folder: Folder for data sets, as `MINARI_DATASETS_PATH` names it.
        name: Name of the split.
        dataset: The data set.
        episodes: The drives of the split.
    """
    plan, place = dataset.plan, folder / f"{name}-v0" / "data"
    place.mkdir(parents=True)
    columns = columns_of_episodes(plan)
    boxes: dict[str, spaces.Space[Any]] = {key: _box(column) for key, column in columns.items()}
    for key in {"ranges", "true_ranges"} & boxes.keys():
        boxes[key] = spaces.Box(0.0, plan.scanner.max_range[1], columns[key].shape, np.float32)
    action = boxes.pop(ACTION)
    storage = MinariStorage.new(place, spaces.Dict(boxes), action)
    storage.update_metadata(
        {
            "dataset_id": f"{name}-v0",
            "minari_version": version("minari"),
            "algorithm_name": plan.poses.policy or "roaming",
            "description": f"Drives of a simulated robot with a laser scanner, split {name}.",
            "made_from": dataset.attributes["made_from"],
        }
    )
    storage.update_episodes(_buffer(episode) for episode in episodes)
    return int(storage.total_episodes)


def _box(column: Column) -> spaces.Box:
    kind = np.dtype(column.dtype)
    low, high = (-np.inf, np.inf) if kind.kind == "f" else (np.iinfo(kind).min, np.iinfo(kind).max)
    return spaces.Box(low, high, column.shape, kind.type)


def _buffer(episode: Episode) -> EpisodeBuffer:
    steps = len(episode.rows[ACTION]) - 1
    truncations = np.zeros(steps, bool)
    truncations[-1] = True
    return EpisodeBuffer(
        options={"scene": episode.scene, "map": episode.map},
        observations={name: rows for name, rows in episode.rows.items() if name != ACTION},
        actions=episode.rows[ACTION][:-1],
        rewards=np.zeros(steps),
        terminations=np.zeros(steps, bool),
        truncations=truncations,
        infos={},
    )
