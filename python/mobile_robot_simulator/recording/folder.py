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

from ..new_files import check_folder

NAME = "recording"
"""Name of a recording in its folder: a rosbag2 folder of this name, or a ROS 1 file with the suffix .bag."""

UNFINISHED = f"{NAME}.unfinished"
"""Folder of a recording that is being written, or that was broken off."""

RECOVER = "mobile-robot-simulator recover"
"""Command that recovers a recording that was broken off."""

_NAMES = (NAME, f"{NAME}.bag")
_LOCK, REBUILT = "lock", "rebuilt"
_COMPLETE, _OLDER, _REPLACED = "complete", "older", "replaced"
_PARTS = (*_NAMES, REBUILT, _COMPLETE, _OLDER, _REPLACED)
_ROS2_FILES = {"metadata.yaml", "metadata.yaml.tmp", f"{NAME}.mcap", f"{NAME}.db3", f"{NAME}.db3-journal"}
_ROS1_START = b"#ROSBAG V2.0\n"


class RecordingFolder:
    """The folder of a recording, locked so that no other process records into it.

    A killed process leaves the older recording or the new one, each with its companions, or the folder `unfinished`, from
    which `recover` gets the new one. The steps of a recording in that folder:

    1. Messages are written to `recording`.
    2. The recording is finished, and new companions are written to the folder `complete`.
    3. `recording` is moved to `complete`. From here on, nothing has to be rebuilt, only moved.
    4. Older files are moved to `older`, which is renamed to `replaced` after the last one.
    5. New files are moved to their places, the recording last.
    6. The folder is removed.

    Args:
        folder: Folder of the recording. Missing folders are created. It stays the same one if the working directory changes.
        overwrite: Replace an older recording with its companions, or one that was broken off.
        companions: Names of files in the folder that belong to a recording, as for `Recorder`.
        recover: Keep the recording that was broken off, to recover it.

    Attributes:
        unfinished: Folder to write in. It keeps the messages of a recording that is broken off.
        complete: Folder for new companions, in `unfinished`. It must be made first.

    Raises:
        FileExistsError: There is a recording or a companion and `overwrite` is False, or something else of that name.
        FileNotFoundError: `recover` is True, and no recording was broken off.
        BlockingIOError: Another process records into the folder.
        NotADirectoryError: There is a file in place of the folder, or of one above.
    """

    def __init__(self, folder: Path, *, overwrite: bool, companions: Collection[str] = (), recover: bool = False) -> None:
        self._given, self._folder, self._companions = folder, folder.absolute(), tuple(companions)
        self.unfinished = self._folder / UNFINISHED
        self.complete = self.unfinished / _COMPLETE
        check_folder(folder)
        self._check_unfinished()
        existed = self.unfinished.is_dir()
        if recover and not existed:
            raise self._nothing_broken_off()
        if not recover:
            self._check_places(overwrite=overwrite)
        self.unfinished.mkdir(parents=True, exist_ok=True)
        self._lock = FileLock(self.unfinished / _LOCK, timeout=0, thread_local=False)
        try:
            self._lock.acquire()
        except Timeout:
            raise BlockingIOError(errno.EAGAIN, "Another process is recording into this folder", str(folder)) from None
        try:
            # The process that held the lock may have just finished.
            self._check_unfinished()
            if recover:
                self._prepare_recovery(overwrite=overwrite)
            else:
                self._prepare_recording(overwrite=overwrite)
        except BaseException:
            self.keep() if existed and self._is_broken_off() else self.discard()
            raise

    @property
    def complete_recording(self) -> Path | None:
        """The recording in the folder `complete`, which has only to be moved. None if there is none."""
        return next((path for name in _NAMES if os.path.lexists(path := self.complete / name)), None)

    def shown(self, path: Path) -> Path:
        """Returns a path in the folder as the caller named it; absolute if that name now leads elsewhere.

        Args:
            path: A path in the folder, or the folder.
        """
        try:
            is_there = self._given.absolute() == self._folder
        except OSError:  # The working directory is gone.
            is_there = False
        return self._given / path.relative_to(self._folder) if is_there else path

    def finish(self, path: Path) -> Path:
        """Replaces older recordings and their companions by a complete recording, and returns its new path.

        Args:
            path: The complete recording, in the folder `unfinished`. New companions are in the folder `complete`.
        """
        self.complete.mkdir(exist_ok=True)
        return self.finish_complete(path.rename(self.complete / path.name))

    def finish_complete(self, path: Path) -> Path:
        """Moves a recording in the folder `complete`, and its companions there, to their places. Returns its new path.

        At no moment does an older file lie beside a new one.
        """
        self._move()
        with suppress(OSError):  # The recording is in its place, whatever stays here.
            self._remove(*_PARTS)
        self._remove_folder()
        return self.shown(self._folder / path.name)

    def keep(self) -> None:
        """Gives the folder back and keeps what was written. Removes what a failed recovery has rebuilt."""
        with suppress(OSError):
            self._remove(REBUILT)
        self._lock.release()

    def discard(self) -> None:
        """Gives the folder back and removes what was written."""
        try:
            self._remove(*_PARTS)
        finally:
            self._remove_folder()

    def error(self, error: OSError | sqlite3.Error, kept: str) -> OSError:
        """Returns an error of the disk with the path `unfinished` and a text that says what is kept."""
        full = isinstance(error, sqlite3.Error) and "disk is full" in str(error)  # Python 3.10 has no error codes of SQLite.
        number = (isinstance(error, OSError) and error.errno) or (errno.ENOSPC if full else errno.EIO)
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        return OSError(number, f"{reason}. {kept}", str(self.shown(self.unfinished)))

    def _prepare_recording(self, *, overwrite: bool) -> None:
        self._check_places(overwrite=overwrite)
        if self._is_broken_off() and not overwrite:
            message = f"A recording was broken off here. Recover it with `{RECOVER} {self._given}`, or use --overwrite"
            raise FileExistsError(errno.EEXIST, f"{message} (overwrite=True)", str(self.shown(self.unfinished)))
        if self.complete_recording is not None:
            self._move()  # A process was killed meanwhile. Older files may be in `replaced` only.
        self._remove(*_PARTS)

    def _prepare_recovery(self, *, overwrite: bool) -> None:
        if not self._is_broken_off():
            raise self._nothing_broken_off()
        self._remove(REBUILT)
        if self.complete_recording is None:
            self._remove(_COMPLETE)  # companions without a recording
        else:
            new = (path.name for path in self.complete.iterdir() if path.name not in _NAMES)
            self._companions = tuple({*self._companions, *new})
        # A process that was killed while it moved files has been told to replace the older ones.
        began = any((self.unfinished / name).is_dir() for name in (_OLDER, _REPLACED))
        self._check_places(overwrite=overwrite or began)

    def _is_broken_off(self) -> bool:
        """Returns True if there is something to recover."""
        names = (self.unfinished / name for name in _NAMES)
        return self.complete_recording is not None or any(os.path.lexists(path) for path in names)

    def _nothing_broken_off(self) -> FileNotFoundError:
        return FileNotFoundError(errno.ENOENT, "No recording was broken off in this folder", str(self._given))

    def _move(self) -> None:
        """Does steps 4 and 5, or what a killed process has left of them."""
        older, replaced = self.unfinished / _OLDER, self.unfinished / _REPLACED
        try:
            if not replaced.is_dir():
                older.mkdir(exist_ok=True)
                self._move_files(self._folder, older)
                older.rename(replaced)
            self._move_files(self.complete, self._folder)
        except BaseException:
            with suppress(OSError):
                self._move_back()
            raise

    def _move_back(self) -> None:
        """Undoes steps 5 and 4."""
        older, replaced = self.unfinished / _OLDER, self.unfinished / _REPLACED
        if replaced.is_dir():
            self._move_files(self._folder, self.complete)
            replaced.rename(older)
        if older.is_dir():
            self._move_files(older, self._folder)
            older.rmdir()

    def _move_files(self, source: Path, target: Path) -> None:
        for name in (*self._companions, *_NAMES):
            if os.path.lexists(source / name):
                (source / name).rename(target / name)

    def _check_unfinished(self) -> None:
        if os.path.lexists(self.unfinished) and not _is_unfinished(self.unfinished):
            raise FileExistsError(
                errno.EEXIST, "This path holds something that is not a recording", str(self.shown(self.unfinished))
            )

    def _check_places(self, *, overwrite: bool) -> None:
        """Checks that only recordings would be replaced, and only if the caller wants that."""
        for path in (self._folder / name for name in _NAMES):
            if not os.path.lexists(path):
                continue
            if not _is_recording(path):
                raise FileExistsError(
                    errno.EEXIST, "This path holds something that is not a recording", str(self.shown(path))
                )
            if not overwrite:
                message = "A recording already exists and is kept. To replace it, use --overwrite (overwrite=True)"
                raise FileExistsError(errno.EEXIST, message, str(self.shown(path)))
        for path in (self._folder / name for name in self._companions):
            if os.path.lexists(path) and not (path.is_file() and overwrite):
                reason = "To replace it, use --overwrite (overwrite=True)" if path.is_file() else "It is not a file"
                message = f"A recording would replace this path, which is kept. {reason}"
                raise FileExistsError(errno.EEXIST, message, str(self.shown(path)))

    def _remove_folder(self) -> None:
        """Gives the folder back, and removes it if it is empty."""
        # Windows cannot remove an open file. Elsewhere, a file that is removed after its lock was given back may be
        # another process's lock already.
        if os.name == "nt":
            self._lock.release()
        with suppress(OSError):
            (self.unfinished / _LOCK).unlink()
            self.unfinished.rmdir()
        self._lock.release()

    def _remove(self, *names: str) -> None:
        for path in (self.unfinished / name for name in names):
            if path.is_dir():
                shutil.rmtree(path)
            else:
                path.unlink(missing_ok=True)


def _is_unfinished(path: Path) -> bool:
    known = {*_PARTS, _LOCK}
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
