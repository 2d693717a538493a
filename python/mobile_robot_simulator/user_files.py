"""User files: opens and reads the files that users name.

Everything that reads such a file reads it here. A special file such as a FIFO or /dev/zero would block or never end, so only
regular files are read, and never more than a limit.
"""

from __future__ import annotations

import codecs
import errno
import os
import stat
import sys
from pathlib import Path
from typing import BinaryIO

from .quoting import quoted

TEXT_LIMIT = 2**20
"""Largest size of a YAML file [bytes]. Real ones have less than a tenth."""

STDIN = "-"
"""Path that stands for standard input, for readers that accept it."""

_KINDS = (
    (stat.S_ISFIFO, "a FIFO"),
    (stat.S_ISCHR, "a character device"),
    (stat.S_ISBLK, "a block device"),
    (stat.S_ISSOCK, "a socket"),
)
_PIECE = 2**20

# UTF-32 comes first: its little-endian mark starts with that of UTF-16.
_MARKS = (
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)


def to_path(path: object, what: str) -> Path:
    """Returns the path that a user names.

    Args:
        path: A text or a path.
        what: What the path is of, for the error.

    Raises:
        TypeError: It is neither a text nor a path.
    """
    if not isinstance(path, str | os.PathLike) or isinstance(os.fspath(path), bytes):
        raise TypeError(f"the path of {what} must be a text or a Path, got {quoted(path)}")
    return Path(path)


def read_bytes(path: str | os.PathLike[str], limit: int) -> bytes:
    """Returns the content of a regular file.

    Args:
        path: The file. Symbolic links are followed.
        limit: Largest size [bytes].

    Raises:
        OSError: The file cannot be read, is not a regular file, or is larger than `limit`. FileNotFoundError if it does not
            exist, IsADirectoryError if it is a folder.
    """
    with open_regular(path) as file:
        size = os.fstat(file.fileno()).st_size
        if size > limit:
            raise _too_large(path, limit, f"{size} bytes")
        return _read(file, path, limit, size)


def read_text(path: str | os.PathLike[str], limit: int = TEXT_LIMIT, *, allow_stdin: bool = False) -> str:
    """Returns the text of a regular file.

    The encoding is UTF-8, or UTF-16 or UTF-32 if the file starts with the byte order mark of these. Bytes that are not UTF-8
    become lone surrogates, as in `os.fsdecode`, so that file names in the text keep their bytes.

    Args:
        path: The file.
        limit: Largest size [bytes].
        allow_stdin: Read standard input if the path is `-`.

    Raises:
        OSError: As for `read_bytes`.
        ValueError: The file is not text: it contains a NUL character, or it breaks the encoding of its byte order mark.
    """
    is_stdin = allow_stdin and os.fspath(path) == STDIN
    data = _read(sys.stdin.buffer, path, limit, 0) if is_stdin else read_bytes(path, limit)
    try:
        text = _decoded(data)
    except UnicodeDecodeError as error:
        raise ValueError(f"{path}: not {error.encoding} text: {error.reason} at byte {error.start}") from None
    if "\0" in text:
        raise ValueError(
            f"{path}: must be text, got a NUL character in line {text.count(chr(10), 0, text.index(chr(0))) + 1}"
        )
    return text


def open_regular(path: str | os.PathLike[str]) -> BinaryIO:
    """Opens a regular file for reading. Never waits for the other end of a FIFO.

    Args:
        path: The file.

    Raises:
        OSError: As for `read_bytes`.
    """
    try:
        file = open(path, "rb", opener=lambda name, flags: os.open(name, flags | getattr(os, "O_NONBLOCK", 0)))
    except IsADirectoryError as error:
        raise IsADirectoryError(error.errno, "Must be a regular file, got a folder", os.fspath(path)) from None
    mode = os.fstat(file.fileno()).st_mode
    if not stat.S_ISREG(mode):
        file.close()
        kind = next((name for is_kind, name in _KINDS if is_kind(mode)), "a special file")
        raise OSError(errno.EINVAL, f"Must be a regular file, got {kind}", os.fspath(path))
    return file


def _read(file: BinaryIO, path: str | os.PathLike[str], limit: int, size: int) -> bytes:
    """Reads to the end of a file. It can be longer than `size`, for example in /proc or while it grows."""
    pieces, length = [], 0
    while piece := file.read(max(size - length, _PIECE) + 1):
        pieces.append(piece)
        length += len(piece)
        if length > limit:
            raise _too_large(path, limit, "more")
    return pieces[0] if len(pieces) == 1 else b"".join(pieces)


def _too_large(path: str | os.PathLike[str], limit: int, got: str) -> OSError:
    return OSError(errno.EFBIG, f"Must have at most {limit} bytes, got {got}", os.fspath(path))


def _decoded(data: bytes) -> str:
    for mark, encoding in _MARKS:
        if data.startswith(mark):
            return data.decode(encoding)
    if 0 in data[:2] and len(data) % 2 == 0:  # The first character is ASCII, in UTF-16 without a mark.
        return data.decode("utf-16-be" if data[0] == 0 else "utf-16-le")
    return data.removeprefix(codecs.BOM_UTF8).decode("utf-8", "surrogateescape")
