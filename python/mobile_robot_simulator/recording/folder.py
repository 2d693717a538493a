"""The folder of a recording: file names in it, and the replacement of an older recording."""

from __future__ import annotations

import errno
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

NAME = "recording"
"""Name of a recording in its folder: a rosbag2 folder of this name, or a ROS 1 file with the suffix .bag."""

_ROS2_FILES = {"metadata.yaml", "metadata.yaml.tmp", f"{NAME}.mcap", f"{NAME}.db3", f"{NAME}.db3-journal"}
_ROS1_START = b"#ROSBAG V2.0\n"


@contextmanager
def room_for_recording(folder: Path, *, overwrite: bool) -> Iterator[Path]:
    """Moves older recordings aside, so that the caller can begin a new recording in this context.

    The older recordings are deleted at the end of the context, or moved back if the context ends with an error.

    Args:
        folder: Folder of the recording. Missing folders are created.
        overwrite: Replace an older recording.

    Yields:
        The folder.

    Raises:
        FileExistsError: There is a recording and `overwrite` is False, or there is something else with its name.
    """
    older = [path for path in (folder / NAME, folder / f"{NAME}.bag") if os.path.lexists(path)]
    for path in older:
        if not _is_recording(path):
            raise FileExistsError(errno.EEXIST, "This path holds something that is not a recording", str(path))
        if not overwrite:
            message = "A recording already exists and is kept. To replace it, use --overwrite (overwrite=True)"
            raise FileExistsError(errno.EEXIST, message, str(path))
    folder.mkdir(parents=True, exist_ok=True)
    if not older:
        yield folder
        return
    aside = Path(tempfile.mkdtemp(prefix=f".{NAME}-", dir=folder))
    try:
        for path in older:
            path.rename(aside / path.name)
        yield folder
    except BaseException:
        for path in aside.iterdir():
            _remove(folder / path.name)
            path.rename(folder / path.name)
        aside.rmdir()
        raise
    shutil.rmtree(aside)


def _remove(path: Path) -> None:
    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def _is_recording(path: Path) -> bool:
    """Returns True if a path holds nothing except a recording, so that it may be deleted. An empty folder counts too."""
    if path.is_symlink():
        return False
    if path.is_dir():
        return all(item.name in _ROS2_FILES and item.is_file() and not item.is_symlink() for item in path.iterdir())
    with path.open("rb") as file:
        return file.read(len(_ROS1_START)) == _ROS1_START
