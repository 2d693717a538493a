"""WriterThread: runs functions in order, and raises their errors."""

from __future__ import annotations

import threading

import pytest

from mobile_robot_simulator.recording.writer_thread import WriterThread


def test_functions_run_in_order_in_another_thread() -> None:
    thread, ran = WriterThread(), list[tuple[int, bool]]()
    for number in range(3):
        thread.run(lambda number=number: ran.append((number, threading.current_thread() is threading.main_thread())))
    thread.stop()
    assert ran == [(0, False), (1, False), (2, False)]


def test_errors_are_raised_to_the_caller() -> None:
    def fail() -> None:
        raise OSError(28, "No space left on device")

    thread = WriterThread()
    with pytest.raises(OSError, match="No space left"):
        thread.run(fail)
    thread.run(lambda: None)
    thread.stop()
