"""DeferredRecorder: the messages of a simulation whose recording may be wanted later."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..messages import Message
    from .recorder import Recorder

MOST_IN_MEMORY = 10_000
"""Messages beyond so many, about 10 MB, go to disk.

Writing takes longer than the drive itself, which is nothing to tests of a minute. To keep all of a long one costs more: the
garbage collector goes through them again and again.
"""


class DeferredRecorder:
    """Takes messages and makes a recording of them in a folder if that is asked for: in memory as long as they are few.

    What goes wrong while it takes them is told by `leave`, and nobody else's matter.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._messages: list[tuple[str, Message, int]] = []
        self._recorder: Recorder | None = None
        self._error: Exception | None = None
        self._open, self._left = True, False

    def take(self, topic: str, message: Message, time_ns: int) -> None:
        """Take one message, which must not change after."""
        if not self._open or self._error is not None:
            return
        self._messages.append((topic, message, time_ns))
        if self._recorder is not None or len(self._messages) >= MOST_IN_MEMORY:
            try:
                self._write()
            except Exception as error:
                self._error = error
                self._messages.clear()

    def leave(self) -> Path:
        """Finish the recording, and say where it is. raises: what went wrong; ImportError without rosbags."""
        if self._error is None and self._open:
            self._write()
            self._left = True
        self._close()
        if self._error is not None or self._recorder is None:
            raise self._error or ValueError("the messages were dropped")
        return self._recorder.path

    def drop(self) -> None:
        """Let go of the messages, and of what is on disk unless it was left."""
        self._close()
        if self._recorder is not None and not self._left:
            shutil.rmtree(self._recorder.path, ignore_errors=True)
            self._recorder = None

    def _write(self) -> None:
        if self._recorder is None:
            from .recorder import Recorder

            self._recorder = Recorder(self._folder, overwrite=True)
        for topic, message, time_ns in self._messages:
            self._recorder.write(topic, message, time_ns)
        self._messages.clear()

    def _close(self) -> None:
        self._open = False
        self._messages.clear()
        if self._recorder is not None:
            self._recorder.close()
