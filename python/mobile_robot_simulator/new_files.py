"""New files: everything that the package writes for a user, except recordings, is written here.

A file is written beside its place, and moved there when it is complete. So a full disk, Ctrl-C or a killed process leaves
the older file, and never half of a file.
"""

from __future__ import annotations

import errno
import os
import tempfile
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


def check_folder(folder: Path) -> None:
    """Checks that a folder is there or can be made.

    Args:
        folder: The folder.

    Raises:
        NotADirectoryError: There is a file of this name, or of that of a folder above.
    """
    existing = next((each for each in (folder, *folder.parents) if each.exists()), None)
    if existing is not None and not existing.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, "Must be a folder", str(existing))


def write_files(contents: Mapping[Path, bytes | NDArray[np.uint8]]) -> None:
    """Writes files that belong together: completes all of them, then moves them to their places, in order.

    Existing files are replaced, each in one step. A symbolic link stays, and the file that it points to is replaced. If the
    process is killed meanwhile, a hidden folder `.new-…` can stay beside the files.

    Args:
        contents: The bytes of each file.

    Raises:
        FileNotFoundError: The folder of a file does not exist. No folder is ever made for a file.
        IsADirectoryError: There is a folder of that name.
        PermissionError: An existing file is write-protected, or its folder is.
        OSError: There is something else of that name, such as a device, or the disk is full.
    """
    with ExitStack() as drafts:
        moves = []
        for path, data in contents.items():
            place = _place(path)
            try:
                beside = tempfile.TemporaryDirectory(prefix=".new-", dir=place.parent, ignore_cleanup_errors=True)
                draft = Path(drafts.enter_context(beside)) / place.name
                with draft.open("wb") as file:
                    file.write(data if isinstance(data, bytes) else data.data)
                    file.flush()
                    os.fsync(file.fileno())  # Some network drives report only here that they are full.
            except OSError as error:
                raise _not_written(error, path) from error
            moves.append((draft, place, path))
        for draft, place, path in moves:
            try:
                os.replace(draft, place)
            except OSError as error:
                raise _not_written(error, path) from error


def _place(path: Path) -> Path:
    """Returns the path of the file itself, behind symbolic links, after checking that it can be written."""
    place = Path(os.path.realpath(path))
    if place.is_dir():
        raise IsADirectoryError(errno.EISDIR, "Cannot write a file over a folder", str(path))
    if not place.parent.is_dir():
        raise FileNotFoundError(errno.ENOENT, "Cannot write a file: no such folder", str(place.parent))
    if place.exists() and not place.is_file():
        raise OSError(errno.EINVAL, "Cannot write a file over something that is not a regular file", str(path))
    if place.exists() and not os.access(place, os.W_OK):
        raise PermissionError(errno.EACCES, "Cannot replace a write-protected file", str(path))
    return place


def _not_written(error: OSError, path: Path) -> OSError:
    """Returns the error with the user's path instead of that of the draft."""
    reason = error.strerror or str(error)
    return OSError(error.errno or errno.EIO, f"{reason}; the file was not written, an older one is kept", str(path))
