"""Export: the drives of a data set as episodes, in the formats of Minari and LeRobot."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any, Literal

import numpy as np

from .episodes import ACTION, Episode, columns_of_episodes
from .formats import EPISODES
from .reader import Dataset
from .reader import open as open_dataset

__all__ = ["export"]


def export(
    path: str | os.PathLike[str], *, format: Literal["minari", "lerobot"], out: str | os.PathLike[str]
) -> dict[str, int]:
    """Writes the drives of a data set as episodes, for libraries of learning from demonstrations.

    The commands of the plan's policy are the actions, and every other column is an observation. A plan has no rewards, so
    they are 0 where the format needs them. No episode ends by itself: each is truncated at its last scan. The folder appears
    as a whole or not at all.

    Args:
        path: Folder of a complete data set in Zarr, of a plan with `poses.kind: drives` and the label `commands`.
        format: "minari" makes a Minari data set `SPLIT-v0` for each split, which `minari.load_dataset` finds if the
            environment variable `MINARI_DATASETS_PATH` is `out`. "lerobot" makes a LeRobot data set in version 3 for each
            split, which `LeRobotDataset("local/SPLIT", root=out/SPLIT)` opens; float64 becomes float32, as policies expect.
        out: Folder to write. It must be new or empty.

    Returns:
        Number of episodes of each split. A drive of one scan has no action and is left out.

    Raises:
        ImportError: The extra `datasets` is not installed, or that of the format.
        OSError: A file cannot be read or written, or `out` has files.
        ValueError: The format is unknown, the folder is no complete data set in Zarr, or it has no drives with commands.
    """
    if format not in EPISODES:
        raise ValueError(f"format must be one of {', '.join(EPISODES)}, got {format!r}")
    dataset, place = open_dataset(path), Path(out).absolute()  # Minari needs an absolute path.
    poses = dataset.plan.poses
    if poses.kind != "drives":
        raise ValueError(f"{path}: only drives are episodes, got poses of kind {poses.kind}")
    if ACTION not in dataset.plan.labels:
        raise ValueError(f"{path}: the actions of an episode are its commands; the plan needs labels: [commands]")
    if place.exists() and (not place.is_dir() or any(place.iterdir())):
        raise FileExistsError(17, "the folder of an export must be new or empty", str(place))
    try:
        writer: Any = import_module(f"{__package__}.{format}_export")
    except ImportError as error:
        raise ImportError(f"{format} needs pip install 'mobile-robot-simulator[{format}]': {error}") from error
    place.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".new-", dir=place.parent, ignore_cleanup_errors=True) as beside:
        draft = Path(beside) / place.name
        draft.mkdir()
        counts = {name: writer.write(draft, name, dataset, _episodes(dataset, name)) for name in dataset}
        if place.exists():
            place.rmdir()
        draft.rename(place)
    return counts


def _episodes(dataset: Dataset, name: str) -> Iterator[Episode]:
    """Yields the drives of a split that have at least two scans. One shard is in memory at a time."""
    split, maps, columns = dataset[name], dataset.attributes["maps"], columns_of_episodes(dataset.plan)
    for part in split.batches(dataset.plan.scans_per_shard):
        starts = np.flatnonzero(np.diff(part["scene"], prepend=-1))
        for first, last in zip(starts, [*starts[1:], len(part["scene"])], strict=True):
            if last - first > 1:
                rows = {key: part[key][first:last].reshape(-1, *column.shape) for key, column in columns.items()}
                yield Episode(int(part["scene"][first]), maps[part["map"][first]]["name"], rows)
