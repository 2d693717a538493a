"""ReplayView: a recording in the browser."""

from __future__ import annotations

import os
from pathlib import Path

from ..logs.playback import Playback
from .page_view import PageView
from .replay import Replay
from .replay_frames import ReplayFrames


class ReplayView(PageView):
    """A recording in the browser, with a time line. Use the command `live`.

    Args:
        recording: The bag, as for `logs.Playback`.
        host: Address to listen on. With another one than 127.0.0.1 or localhost, the address of the page contains a token.
        port: Port; 0 chooses a free one.
        paused: Start with the time stopped.

    Attributes:
        replay: The recording under the control of viewers.

    Raises:
        ImportError: rosbags is not installed.
        OSError: The recording cannot be read, or the address cannot be used.
        ValueError: It is not a bag, or there is nothing to show.
    """

    def __init__(
        self, recording: str | os.PathLike[str], *, host: str = "127.0.0.1", port: int = 0, paused: bool = False
    ) -> None:
        self.replay = Replay(Playback(recording), paused=paused)
        super().__init__(self.replay, ReplayFrames(self.replay, Path(recording).name), host, port)
