"""The folder of a recording: a recording is written beside its final place, under a lock, and moved there when complete."""

from __future__ import annotations

import errno
import os
import shutil
import sqlite3
from collections.abc import Collection
from contextlib import suppress
from pathlib import Path

from filelock import FileLock, Timeout

NAME = "recording"
"""Name of a recording in its folder: a rosbag2 folder of this name, or a ROS 1 file with the suffix .bag."""

UNFINISHED = f"{NAME}.unfinished"
"""Folder of a recording that is being written, or that was broken off."""

RECOVER = "mobile-robot-simulator recover"
"""Command that recovers a recording that was broken off."""

_NAMES = (NAME, f"{NAME}.bag")
_LOCK, _OLDER, REBUILT = "lock", "older", "rebuilt"
_ROS2_FILES = {"metadata.yaml", "metadata.yaml.tmp", f"{NAME}.mcap", f"{NAME}.db3", f"{NAME}.db3-journal"}
_ROS1_START = b"#ROSBAG V2.0\n"


class RecordingFolder:
    """The folder of a recording, locked so that no other process records into it.

    Args:
        folder: Folder of the recording. Missing folders are created.
        overwrite: Replace an older recording with its companions, or one that was broken off.
        companions: Names of files in the folder that belong to a recording, as for `Recorder`.
        recover: Keep the recording that was broken off, to recover it.

    Attributes:
        unfinished: Folder to write in. It keeps the messages of a recording that is broken off.

    Raises:
        FileExistsError: There is a recording or a companion and `overwrite` is False, or something else of that name.
        FileNotFoundError: `recover` is True, and no recording was broken off.
        BlockingIOError: Another process records into the folder.
    """

    def __init__(self, folder: Path, *, overwrite: bool, companions: Collection[str] = (), recover: bool = False) -> None:
        self._folder, self.unfinished, self._companions = folder, folder / UNFINISHED, companions
        self._check(overwrite=overwrite)
        existed = self.unfinished.is_dir()
        if recover and not existed:
            raise FileNotFoundError(errno.ENOENT, "No recording was broken off in this folder", str(folder))
        self.unfinished.mkdir(parents=True, exist_ok=True)
        self._lock = FileLock(self.unfinished / _LOCK, timeout=0, thread_local=False)
        try:
            self._lock.acquire()
        except Timeout:
            raise BlockingIOError(errno.EAGAIN, "Another process is recording into this folder", str(folder)) from None
        try:
            # The process that held the lock may have just finished.
            self._check(overwrite=overwrite)
            if recover:
                self._remove(REBUILT)
            elif overwrite:
                self._remove(*_NAMES, REBUILT, _OLDER)
            elif any(os.path.lexists(self.unfinished / name) for name in _NAMES):
                message = f"A recording was broken off here. Recover it with `{RECOVER} {folder}`, or use --overwrite"
                raise FileExistsError(errno.EEXIST, f"{message} (overwrite=True)", str(self.unfinished))
        except BaseException:
            self.keep() if existed else self.discard()
            raise

    def finish(self, path: Path) -> Path:
        """Replaces older recordings and their companions by a complete recording, and returns its new path.

        At no moment does an older companion lie beside the new recording.

        Args:
            path: The complete recording, in the folder `unfinished`.
        """
        aside = self.unfinished / _OLDER
        self._remove(_OLDER)
        aside.mkdir()
        older = [self._folder / name for name in (*self._companions, *_NAMES) if os.path.lexists(self._folder / name)]
        new = self._folder / path.name
        try:
            for each in older:
                each.rename(aside / each.name)
            path.rename(new)
        except BaseException:
            for each in aside.iterdir():
                each.rename(self._folder / each.name)
            raise
        self.discard()
        return new

    def keep(self) -> None:
        """Gives the folder back and keeps what was written. Removes what a failed recovery has rebuilt."""
        with suppress(OSError):
            self._remove(REBUILT)
        self._lock.release()

    def discard(self) -> None:
        """Gives the folder back and removes what was written."""
        self._remove(*_NAMES, REBUILT, _OLDER)
        # Windows cannot remove an open file. Elsewhere, a file that is removed after its lock was given back may be
        # another process's lock already.
        if os.name == "nt":
            self._lock.release()
        with suppress(OSError):
            (self.unfinished / _LOCK).unlink()
            self.unfinished.rmdir()
        self._lock.release()

    def error(self, error: OSError | sqlite3.Error, kept: str) -> OSError:
        """Returns an error of the disk with the path `unfinished` and a text that says what is kept."""
        number = error.errno if isinstance(error, OSError) and error.errno else errno.EIO
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        return OSError(number, f"{reason}. {kept}", str(self.unfinished))

    def _check(self, *, overwrite: bool) -> None:
        """Checks that only recordings would be replaced, and only if the caller wants that."""
        if os.path.lexists(self.unfinished) and not _is_unfinished(self.unfinished):
            raise FileExistsError(errno.EEXIST, "This path holds something that is not a recording", str(self.unfinished))
        for path in (self._folder / name for name in _NAMES):
            if not os.path.lexists(path):
                continue
            if not _is_recording(path):
                raise FileExistsError(errno.EEXIST, "This path holds something that is not a recording", str(path))
            if not overwrite:
                message = "A recording already exists and is kept. To replace it, use --overwrite (overwrite=True)"
                raise FileExistsError(errno.EEXIST, message, str(path))
        for path in (self._folder / name for name in self._companions):
            if os.path.lexists(path) and not (path.is_file() and overwrite):
                reason = "To replace it, use --overwrite (overwrite=True)" if path.is_file() else "It is not a file"
                message = f"A recording would replace this path, which is kept. {reason}"
                raise FileExistsError(errno.EEXIST, message, str(path))

    def _remove(self, *names: str) -> None:
        for path in (self.unfinished / name for name in names):
            if path.is_dir():
                shutil.rmtree(path)
            else:
                path.unlink(missing_ok=True)


def _is_unfinished(path: Path) -> bool:
    known = {*_NAMES, _LOCK, _OLDER, REBUILT}
    return not path.is_symlink() and path.is_dir() and all(item.name in known for item in path.iterdir())


def _is_recording(path: Path) -> bool:
    """Returns True if a path holds nothing except a recording, so that it may be deleted. An empty folder counts too."""
    if path.is_symlink():
        return False
    if path.is_dir():
        return all(item.name in _ROS2_FILES and item.is_file() and not item.is_symlink() for item in path.iterdir())
    if not path.is_file():
        return False
    with path.open("rb") as file:
        return file.read(len(_ROS1_START)) == _ROS1_START
