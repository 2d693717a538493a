"""Signals: SIGTERM and SIGHUP end a command as Ctrl-C does, and nothing is left behind. test_run.py sends them to `run`."""

from __future__ import annotations

import os
import signal
import sys
from contextlib import suppress

import pytest
import typer

from mobile_robot_simulator.cli import signals
from mobile_robot_simulator.cli.signals import signals_as_interrupt

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has other signals")


@pytest.mark.parametrize(("name", "status"), [("SIGTERM", 143), ("SIGHUP", 129), ("SIGINT", 130)])
def test_a_signal_is_an_interrupt_with_its_own_exit_status(name: str, status: int) -> None:
    number = getattr(signal, name)
    before = signal.getsignal(number)
    with pytest.raises(typer.Exit) as raised, signals_as_interrupt():
        os.kill(os.getpid(), number)
        signal.pause()
    assert raised.value.exit_code == status
    assert signal.getsignal(number) == before


def test_later_signals_do_not_interrupt_what_is_being_saved() -> None:
    saved = False
    with signals_as_interrupt() as interruption:
        try:
            os.kill(os.getpid(), signal.SIGTERM)
            signal.pause()
        except KeyboardInterrupt:
            os.kill(os.getpid(), signal.SIGTERM)
            os.kill(os.getpid(), signal.SIGHUP)
            saved = True
    assert saved and interruption.exit_status == 143


def test_a_signal_has_no_effect_once_saving_has_begun() -> None:
    with signals_as_interrupt() as interruption:
        interruption.ignore_more()
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            os.kill(os.getpid(), number)


def test_an_interrupt_that_was_lost_can_be_sent_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """Python drops a KeyboardInterrupt that is raised in a destructor, for example."""
    monkeypatch.setattr(signals, "_ECHO", 0.0)
    with pytest.raises(typer.Exit), signals_as_interrupt():
        with suppress(KeyboardInterrupt):
            os.kill(os.getpid(), signal.SIGINT)
            signal.pause()
        os.kill(os.getpid(), signal.SIGINT)
        signal.pause()


def test_an_ignored_signal_stays_ignored() -> None:
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with signals_as_interrupt():
            os.kill(os.getpid(), signal.SIGHUP)
    finally:
        signal.signal(signal.SIGHUP, before)
