"""Future: the response of a service call, available later."""

from __future__ import annotations

import pytest

from mobile_robot_simulator.nodes.future import Future


def test_callbacks_run_once_when_the_result_is_set_and_at_once_afterwards() -> None:
    future, seen = Future(), list[object]()
    future.add_done_callback(lambda done: seen.append(("early", done.result())))
    assert (future.done(), future.result(), seen) == (False, None, [])
    future.set_result(3)
    future.add_done_callback(lambda done: seen.append(("late", done.result())))
    assert future.done() and seen == [("early", 3), ("late", 3)]


def test_a_restored_future_waits_again_for_the_same_callbacks() -> None:
    future, seen = Future(), list[object]()
    future.add_done_callback(lambda done: seen.append(done.result()))
    state = future.save()
    for result in (1, 2):
        future.set_result(result)
        future.restore(state)
        assert not future.done()
    assert seen == [1, 2]


def test_a_failed_call_raises_its_exception_instead_of_a_result() -> None:
    future, seen = Future(), list[object]()
    error = OSError("the server died")
    future.add_done_callback(lambda done: seen.append(done.exception()))
    state = future.save()
    future.set_exception(error)
    assert future.done() and seen == [error]
    with pytest.raises(OSError, match="the server died"):
        future.result()
    failed = future.save()
    future.restore(state)
    assert (future.done(), future.result(), future.exception()) == (False, None, None)
    future.restore(failed)
    assert (future.done(), future.exception()) == (True, error)
