"""DeferredRecorder: keeps messages, and saves them as a recording only on request."""

from __future__ import annotations

from functools import partial
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..messages import Message
    from .recorder import Recorder

MOST_IN_MEMORY = 10_000
"""Number of messages at which all messages are moved from memory to disk. In memory, they take about 10 MB.

A test of one simulated minute has fewer messages, so it never writes, which would take longer than the simulation itself. In
a long simulation, keeping messages would cost more than writing them: the garbage collector visits all of them repeatedly.
"""


class DeferredRecorder:
    """Keeps messages, and saves them as a recording only on request. From `MOST_IN_MEMORY` messages on, they go to disk.

    An error while messages are moved to disk does not stop the simulation. `save` raises it later.

    Args:
        folder: Folder of the recording, as for `Recorder`.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder.absolute()
        self._messages: list[Any] = []
        """Topic, time [ns], message and None of each message, one after another. For a call that builds a message: topic,
        time, function, number of arguments, and the arguments. Objects that hold them would cost garbage collections."""
        self._room = MOST_IN_MEMORY
        """Number of messages that can be kept before `_move_to_disk` must be called. 0 after that, and once it is closed."""
        self._recorder: Recorder | None = None
        self._error: Exception | None = None
        self._open, self._saved = True, False

    def write(self, topic: str, message: Message | partial[Message], time_ns: int) -> None:
        """Adds a message, or the call that builds it, which was published on a topic at a time [ns].

        The message must not change afterwards. A call is only made when the messages are moved to disk.
        """
        messages = self._messages
        if type(message) is partial and not message.keywords:
            arguments = message.args
            messages += (topic, time_ns, message.func, len(arguments))
            messages += arguments
        else:
            messages += (topic, time_ns, message, None)
        self._room -= 1
        if self._room <= 0:
            self._make_room()

    def _make_room(self) -> None:
        """Moves the messages to disk, unless the recorder is closed, or could not move those before."""
        self._room = 0
        if not self._open or self._error is not None:
            self._messages.clear()
            return
        try:
            self._move_to_disk()
        except Exception as error:
            self._error = error
            self._messages.clear()

    def save(self) -> Path:
        """Finishes the recording and returns its path. Saving again returns the same path.

        Raises:
            ImportError: rosbags is not installed.
            ValueError: The messages were discarded, or a message cannot be recorded.
            OSError: The folder cannot be written.
        """
        if self._error is None and self._open:
            self._move_to_disk()
            self._saved = True
        self._close()
        if self._error is not None or self._recorder is None:
            raise self._error or ValueError("the messages were discarded")
        return self._recorder.path

    def discard(self) -> None:
        """Deletes the messages in memory and on disk. A saved recording is kept, and what a full disk has broken off."""
        self._open, self._room = False, 0
        self._messages.clear()
        if self._recorder is not None and not self._saved:
            self._recorder.discard()
            self._recorder = None

    def _move_to_disk(self) -> None:
        if self._recorder is None:
            from .recorder import Recorder

            self._recorder = Recorder(self._folder, overwrite=True)
        kept = iter(self._messages)
        for topic, time_ns, message, count in zip(kept, kept, kept, kept, strict=True):
            whole = message if count is None else partial(message, *islice(kept, count))
            self._recorder.write(topic, whole, time_ns)
        self._messages.clear()

    def _close(self) -> None:
        self._open, self._room = False, 0
        self._messages.clear()
        if self._recorder is not None:
            self._recorder.close()
