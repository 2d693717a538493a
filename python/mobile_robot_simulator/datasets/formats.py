"""Formats: the modules that write and read the files of a data set."""

from __future__ import annotations

import sys
from importlib import import_module
from pathlib import Path
from typing import Any

__all__ = ["EPISODES", "damaged_file", "format_of", "formats", "missing_file"]

EPISODES = ("minari", "lerobot")
"""Formats to which drives are exported."""


def formats() -> dict[str, str]:
    """Returns the formats by name, and the file of each that is there when a data set is complete."""
    return {"zarr": "zarr.json", "parquet": "dataset.json"}


def format_of(name: str) -> Any:
    """Returns the module that writes and reads a format.

    Raises:
        ImportError: The extra `datasets` or `parquet` is not installed, or this Python is too old for the format.
    """
    try:
        return import_module(f"{__package__}.{name}_store")
    except ImportError as error:
        if name == "zarr" and sys.version_info < (3, 11):
            raise ImportError(
                f"Zarr v3 needs Python 3.11 or later, this is {sys.version.split()[0]}; give format: parquet"
            ) from error
        extra = {"zarr": "datasets"}.get(name, name)
        raise ImportError(f"{name} needs pip install 'mobile-robot-simulator[{extra}]': {error}") from error


def missing_file(path: Path) -> FileNotFoundError:
    """Returns the error that a file of a shard has no bytes."""
    return FileNotFoundError(
        2, "this file of the data set is missing or empty; give the command that made the data set again", str(path)
    )


def damaged_file(path: Path, error: Exception) -> ValueError:
    """Returns the error that a file of a shard cannot be read."""
    advice = "remove this file and give the command that made the data set again"
    return ValueError(f"{path}: this file of the data set is damaged: {error}; {advice}")
