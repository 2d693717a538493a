"""Signals: what a terminal, a service manager or a CI job sends to end a command."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

import typer

_ENDING: list[signal.Signals] = [getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)]
"""Signals that end a command like Ctrl-C. Windows has no SIGHUP."""


class Interruption:
    """The signal that ended a command early.

    Attributes:
        number: The signal. It is SIGINT, which Ctrl-C sends, until another one arrives.
    """

    def __init__(self) -> None:
        self.number = int(signal.SIGINT)

    @property
    def exit_status(self) -> int:
        """The status that shells give to a process ended by the signal: 130 for Ctrl-C, 143 for SIGTERM, 129 for SIGHUP."""
        return 128 + self.number


@contextmanager
def signals_as_interrupt() -> Iterator[Interruption]:
    """Turns SIGTERM and SIGHUP into KeyboardInterrupt while the context is open.

    A signal that the process ignores stays ignored, so a command under `nohup` outlives its terminal. After the first of
    these signals, more of them have no effect: service managers send several, and the work in progress must still be saved.
    If a KeyboardInterrupt leaves the context, the command exits with the status of the signal.

    Yields:
        The signal that arrived.

    Raises:
        typer.Exit: A KeyboardInterrupt left the context.
    """
    interruption = Interruption()

    def interrupt(number: int, _frame: FrameType | None) -> None:
        for each in changed:
            signal.signal(each, signal.SIG_IGN)
        interruption.number = number
        raise KeyboardInterrupt

    changed = {each: signal.getsignal(each) for each in _ENDING if signal.getsignal(each) == signal.SIG_DFL}
    for each in changed:
        signal.signal(each, interrupt)
    try:
        yield interruption
    except KeyboardInterrupt:
        raise typer.Exit(interruption.exit_status) from None
    finally:
        for each, handler in changed.items():
            signal.signal(each, handler)
