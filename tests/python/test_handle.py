"""handle: groups release their handles in reverse order, and deep copies share handles."""

from __future__ import annotations

import copy

import pytest

from mobile_robot_simulator.handle import Handle, Handles, check_callback


def test_close_releases_the_last_handle_first() -> None:
    released: list[int] = []
    handles = Handles()
    for number in range(3):
        handles.add(released.append, number)
    assert released == []
    handles.close()
    assert released == [2, 1, 0]


def test_a_block_releases_its_handles_only_if_it_raises() -> None:
    released: list[int] = []
    with Handles() as handles:
        handles.add(released.append, 1)
    assert released == []
    with pytest.raises(KeyError), Handles() as handles:
        handles.add(released.append, 2)
        raise KeyError
    assert released == [2]


def test_a_deep_copy_shares_the_handle() -> None:
    handle = Handle()
    assert copy.deepcopy([handle])[0] is handle


def test_a_callback_must_be_callable() -> None:
    check_callback(print)
    with pytest.raises(TypeError, match="a callback must be callable, got 3"):
        check_callback(3)
