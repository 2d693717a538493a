"""Workspace: the folder of a data set while it is made: which shards are complete, and how new ones come in.

A shard is complete when its record is there, which is moved to its place after the files of the shard. The records and all
else that is not data are in the folder `.unfinished`, which disappears when the data set is complete.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from ..new_files import write_files
from ..quoting import quoted
from ..user_files import read_text
from .job import Files, Job, Shard

__all__ = ["Workspace"]

UNFINISHED = ".unfinished"
LARGEST = 2**30
"""Largest size of a record, or of what a data set is made from [bytes]."""

_SHOWN = 5
_MISSING = object()


class Workspace:
    """The folder of a data set while it is made.

    Args:
        folder: The folder. It is made if it does not exist.
        complete: File that is there when the data set is complete, and is written last.
    """

    def __init__(self, folder: Path, complete: str) -> None:
        self._folder, self._complete = folder, folder / complete
        self._own = folder / UNFINISHED
        self._identity = self._own / "dataset.json"

    @property
    def is_complete(self) -> bool:
        """True if the data set is complete."""
        return self._complete.exists()

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Keeps other processes from making the same data set meanwhile.

        Raises:
            OSError: Another process makes it, or the folder cannot be made.
        """
        from filelock import FileLock, Timeout

        is_new = not self._folder.exists()
        self._own.mkdir(parents=True, exist_ok=True)
        lock = FileLock(self._own / "lock")
        try:
            lock.acquire(timeout=0)
        except Timeout:
            raise OSError(f"{self._folder}: another process makes this data set") from None
        try:
            yield
        finally:
            if not self._identity.exists():
                self.clean()  # The folder was refused, or is complete.
            lock.release()
            if is_new:
                with suppress(OSError):  # It is not empty.
                    self._folder.rmdir()

    def begin(self, job: Job, stored: Mapping[str, Any] | None = None) -> None:
        """Begins a data set, or goes on with one; removes what a killed process left half written.

        Args:
            job: What the data set shall contain.
            stored: What a complete data set contains.

        Raises:
            FileExistsError: The folder has other files.
            ValueError: The folder has data of another plan, of other maps, or from other versions. The message says which.
        """
        place, identity = self._identity, _as_json(job.identity)
        if stored is None and place.exists():
            stored = json.loads(read_text(place, LARGEST))
        if stored is not None:
            changes = [f"{name}: {before} -> {now}" for name, before, now in _differences(stored, identity)]
            if changes:
                more = f"; and {len(changes) - _SHOWN} more" if len(changes) > _SHOWN else ""
                raise ValueError(
                    f"{self._folder}: the folder has data of another plan; give another folder, or undo the changes: "
                    + "; ".join(changes[:_SHOWN])
                    + more
                )
        elif others := [path.name for path in self._folder.iterdir() if path.name != UNFINISHED]:
            raise FileExistsError(f"{self._folder}: the folder of a new data set must be empty, got {others[0]}")
        for draft in self._folder.rglob(".new-*"):
            shutil.rmtree(draft, ignore_errors=True)
        (self._own / "shards").mkdir(parents=True, exist_ok=True)
        if not place.exists():
            write_files({place: json.dumps(identity, indent=1).encode()})

    def has(self, paths: Iterable[str]) -> bool:
        """Returns whether files are there, and are not empty."""
        try:
            return all((self._folder / path).stat().st_size for path in paths)
        except OSError:
            return False

    def record_of(self, shard: Shard) -> dict[str, Any] | None:
        """Returns the record of a shard; None if the shard is not complete."""
        try:
            record: dict[str, Any] = json.loads(read_text(self._record(shard), LARGEST))
            sizes = {path: (self._folder / path).stat().st_size for path in record["sizes"]}
        except (OSError, ValueError, KeyError):
            return None
        return record if sizes == record["sizes"] else None

    def add(self, shard: Shard, files: Files, record: Mapping[str, Any]) -> None:
        """Writes the files of a shard, then its record.

        Raises:
            OSError: The disk is full, or the files cannot be written.
        """
        places = {self._folder / path: data for path, data in files.items()}
        for folder in {place.parent for place in places}:
            folder.mkdir(parents=True, exist_ok=True)
        sizes = {path: len(data) for path, data in files.items()}
        content = json.dumps({**record, "sizes": sizes}, sort_keys=True).encode()
        write_files({**places, self._record(shard): content})

    def finish(self, files: Files) -> None:
        """Writes the last files, which make the data set complete, and removes what was only needed to make it.

        Raises:
            OSError: The disk is full, or the files cannot be written.
        """
        places = {self._folder / path: data for path, data in files.items()}
        for folder in {place.parent for place in places}:
            folder.mkdir(parents=True, exist_ok=True)
        write_files(places)
        self.clean()

    def clean(self) -> None:
        """Removes what was only needed to make the data set."""
        shutil.rmtree(self._own, ignore_errors=True)

    def _record(self, shard: Shard) -> Path:
        return self._own / "shards" / f"{shard.name}.json"


def _as_json(content: Any) -> Any:
    """Returns the content as it is after writing and reading it."""
    return json.loads(json.dumps(content))


def _differences(before: Any, now: Any, name: str = "") -> Iterator[tuple[str, str, str]]:
    """Yields what differs in two contents of JSON: where, and both values as text."""
    if isinstance(before, dict) and isinstance(now, dict):
        for key in [*before, *(key for key in now if key not in before)]:
            inner = f"{name}.{key}" if name else key
            yield from _differences(before.get(key, _MISSING), now.get(key, _MISSING), inner)
    elif isinstance(before, list) and isinstance(now, list) and len(before) == len(now):
        for index, (old, new) in enumerate(zip(before, now, strict=True)):
            yield from _differences(old, new, f"{name}[{index}]")
    elif before != now:
        yield name.removeprefix("plan."), _text(before), _text(now)


def _text(value: Any) -> str:
    return "nothing" if value is _MISSING else quoted(value)
