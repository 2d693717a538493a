"""handles: what was taken hold of is let go of, the last first; and what is held is not copied."""

from __future__ import annotations

import copy

import pytest

from mobile_robot_simulator.handle import Handle, Handles


def test_all_is_let_go_of_the_last_first() -> None:
    gone: list[int] = []
    handles = Handles()
    for number in range(3):
        handles.add(gone.append, number)
    assert gone == []
    handles.close()
    assert gone == [2, 1, 0]


def test_a_block_lets_go_only_if_it_raises() -> None:
    gone: list[int] = []
    with Handles() as handles:
        handles.add(gone.append, 1)
    assert gone == []
    with pytest.raises(KeyError), Handles() as handles:
        handles.add(gone.append, 2)
        raise KeyError
    assert gone == [2]


def test_a_handle_is_itself_in_a_copy_of_what_holds_it() -> None:
    handle = Handle()
    assert copy.deepcopy([handle])[0] is handle
