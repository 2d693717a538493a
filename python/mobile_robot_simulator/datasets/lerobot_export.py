"""LeRobot: drives as the episodes of a LeRobot data set in version 3."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from datasets.utils import are_progress_bars_disabled, disable_progress_bars, enable_progress_bars
from lerobot.datasets.lerobot_dataset import LeRobotDataset

from .episodes import ACTION, Episode, columns_of_episodes
from .reader import Dataset
from .scenes import Column

__all__ = ["write"]


def write(folder: Path, name: str, dataset: Dataset, episodes: Iterable[Episode]) -> int:
    """Writes a split as a LeRobot data set, and returns its number of episodes.

    The pose is the feature `observation.state`, the command is `action`, and each other column is `observation.COLUMN`.

    Args:
        folder: Folder in which that of the split is made.
        name: Name of the split.
        dataset: The data set.
        episodes: The drives of the split.

    Raises:
        ValueError: There is no whole number of scans in a second.
    """
    plan = dataset.plan
    rate = round(1.0 / plan.poses.period)
    if not rate or not np.isclose(rate * plan.poses.period, 1.0):
        raise ValueError(f"LeRobot needs a whole number of scans in a second, got poses.period {plan.poses.period} s")
    columns = columns_of_episodes(plan)
    made = LeRobotDataset.create(
        f"local/{name}",
        rate,
        {_feature(key): _description(column) for key, column in columns.items()},
        root=folder / name,
        robot_type="mobile robot with a laser scanner",
        use_videos=False,
        video_backend="pyav",  # Without it, LeRobot looks for FFmpeg, and complains.
    )
    task = "drive to the goal" if plan.poses.policy else "roam"
    with _quiet():
        for episode in episodes:
            _add(made, episode, columns, task)
        made.finalize()
    return int(made.meta.total_episodes)


def _add(made: Any, episode: Episode, columns: Mapping[str, Column], task: str) -> None:
    rows = {_feature(key): episode.rows[key].astype(_kind(column)) for key, column in columns.items()}
    for index in range(len(episode.rows[ACTION])):
        made.add_frame({**{key: values[index] for key, values in rows.items()}, "task": task})
    made.save_episode()


@contextmanager
def _quiet() -> Iterator[None]:
    """Keeps the library `datasets` from drawing a bar for each episode."""
    was_quiet = are_progress_bars_disabled()
    disable_progress_bars()
    try:
        yield
    finally:
        if not was_quiet:
            enable_progress_bars()


def _feature(column: str) -> str:
    return {"poses": "observation.state", ACTION: "action"}.get(column, f"observation.{column}")


def _kind(column: Column) -> str:
    return "float32" if column.dtype == "float64" else column.dtype


def _description(column: Column) -> dict[str, Any]:
    return {"dtype": _kind(column), "shape": column.shape, "names": column.attributes.get("columns")}
