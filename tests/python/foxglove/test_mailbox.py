"""Mailbox: work runs in order in one thread, errors come back, and nobody waits forever."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

import pytest

from mobile_robot_simulator.foxglove import mailbox
from mobile_robot_simulator.foxglove.mailbox import MOST_WAITING, Mailbox


def asked(box: Mailbox, work: Callable[[], Any]) -> Future[Any]:
    """Asks in another thread, and returns when the work waits."""
    waits = threading.Event()
    leave = box.leave

    def leave_and_tell(given: Callable[[], Any]) -> Future[Any]:
        left = leave(given)
        waits.set()
        return left

    box.leave = leave_and_tell  # type: ignore[method-assign]
    pool = ThreadPoolExecutor(1)
    result = pool.submit(box.ask, work)
    assert waits.wait(10.0)
    pool.shutdown(wait=False)
    return result


def test_work_runs_in_order_in_the_thread_that_empties() -> None:
    box, done = Mailbox(), list[tuple[int, str]]()
    for number in range(3):
        box.leave(lambda number=number: done.append((number, threading.current_thread().name)))
    assert done == []
    box.empty()
    assert done == [(number, threading.current_thread().name) for number in range(3)]


def test_work_that_leaves_work_does_not_keep_the_thread() -> None:
    box, count = Mailbox(), []

    def again() -> None:
        count.append(1)
        box.leave(again)

    box.leave(again)
    box.empty()
    assert count == [1]


def test_an_answer_and_an_error_come_back() -> None:
    box = Mailbox()
    answer = asked(box, lambda: 42)
    box.empty()
    assert answer.result(10.0) == 42
    failure = asked(box, lambda: int("x"))
    box.empty()
    with pytest.raises(ValueError, match="invalid literal"):
        failure.result(10.0)


def test_who_asks_does_not_wait_forever_and_the_work_is_not_done_later(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mailbox, "LONGEST_WAIT", 0.01)
    box, done = Mailbox(), list[int]()
    with pytest.raises(RuntimeError, match=r"the simulation did not answer within 0\.01 s"):
        box.ask(lambda: done.append(1))
    box.empty()
    assert done == []


def test_too_much_work_is_refused() -> None:
    box, done = Mailbox(), list[int]()
    for _ in range(MOST_WAITING):
        box.leave(lambda: done.append(1))
    with pytest.raises(RuntimeError, match=f"the simulation is busy: {MOST_WAITING} requests wait already"):
        box.leave(lambda: done.append(1))
    box.empty()
    assert len(done) == MOST_WAITING


def test_a_closed_mailbox_refuses_what_waits_and_what_comes() -> None:
    box = Mailbox()
    answer = asked(box, lambda: 42)
    box.close()
    with pytest.raises(RuntimeError, match="the server has stopped"):
        answer.result(10.0)
    with pytest.raises(RuntimeError, match="the server has stopped"):
        box.ask(lambda: 42)
