"""Signals: what a terminal, a service manager or a CI job sends to end a command."""

from __future__ import annotations

import math
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

import typer

_ENDING: list[signal.Signals] = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
"""Signals that end a command. Ctrl-C sends SIGINT. Windows has no SIGHUP."""

_ECHO = 1.0
"""Time after a signal in which others have no effect [s]. Service managers and wrappers of commands send several."""


class Interruption:
    """The signal that ended a command early.

    Attributes:
        number: The signal. It is SIGINT, which Ctrl-C sends, until another one arrives.
    """

    def __init__(self) -> None:
        self.number = int(signal.SIGINT)
        self._ignored_until = -math.inf

    def ignore_more(self) -> None:
        """From now on, signals have no effect, so that what was done can be saved."""
        self._ignored_until = math.inf

    def interrupt(self, number: int, _frame: FrameType | None) -> None:
        """Handles a signal.

        Raises:
            KeyboardInterrupt: Unless the signal has no effect.
        """
        now = time.monotonic()
        if now < self._ignored_until:
            return
        self.number, self._ignored_until = number, now + _ECHO
        raise KeyboardInterrupt

    @property
    def exit_status(self) -> int:
        """The status that shells give to a process ended by the signal: 130 for Ctrl-C, 143 for SIGTERM, 129 for SIGHUP."""
        return 128 + self.number


@contextmanager
def signals_as_interrupt() -> Iterator[Interruption]:
    """Turns SIGTERM and SIGHUP into KeyboardInterrupt while the context is open, as Python does with SIGINT.

    A signal that the process ignores stays ignored, so a command under `nohup` outlives its terminal. For a second after
    one of these signals, and after a call of `Interruption.ignore_more`, they have no effect. If a KeyboardInterrupt leaves
    the context, the command exits with the status of the signal.

    Yields:
        The signal that arrived. It is SIGINT until then.

    Raises:
        typer.Exit: A KeyboardInterrupt left the context.
    """
    interruption = Interruption()
    usual = (signal.SIG_DFL, signal.default_int_handler)
    changed = {each: signal.getsignal(each) for each in _ENDING if signal.getsignal(each) in usual}
    for each in changed:
        signal.signal(each, interruption.interrupt)
    try:
        yield interruption
    except KeyboardInterrupt:
        raise typer.Exit(interruption.exit_status) from None
    finally:
        for each, handler in changed.items():
            signal.signal(each, handler)
