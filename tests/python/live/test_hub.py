"""Hub: frames to pages, inputs from pages."""

import asyncio
import json

import pytest

from mobile_robot_simulator.live.frames import Frame, Trail
from mobile_robot_simulator.live.hub import AHEAD, MOST_WAITING, Hub
from mobile_robot_simulator.live.inputs import Drive, Pause

DRIVE = {"kind": "drive", "robot": "", "vx": 0.5}


def in_loop(check):
    """Runs a check in an event loop, as the server does."""

    async def run():
        check()

    asyncio.run(run())


def test_the_first_who_does_something_holds_the_controls_and_others_are_refused():
    def check():
        hub = Hub()
        first, second = hub.join("first"), hub.join("second")
        done = hub.submit("first", DRIVE)
        wanted, result = hub.next_input(0.0)
        assert wanted == Drive(robot="", vx=0.5)
        result.set_result(None)
        assert done.result() is None
        with pytest.raises(ValueError, match="another viewer holds the controls"):
            hub.submit("second", DRIVE).result(0)
        hub.submit("second", {"kind": "copy_as_python"})  # only looks
        assert hub.next_input(0.0) is not None
        hub.take_controls("second")
        hub.submit("second", DRIVE)
        assert hub.next_input(0.0) is not None
        hub.leave(second)
        hub.submit("first", {"kind": "pause", "paused": True})
        assert hub.next_input(0.0)[0] == Pause(paused=True)
        hub.leave(first)
        assert not hub.has_viewers

    in_loop(check)


def test_a_page_that_connected_again_is_not_removed_by_its_old_connection():
    def check():
        hub = Hub()
        old, new = hub.join("page"), hub.join("page")
        hub.leave(old)
        assert hub.has_viewers
        hub.leave(new)
        assert not hub.has_viewers

    in_loop(check)


def test_a_page_gets_what_has_changed_and_no_more_than_it_draws():
    def check():
        hub = Hub()
        viewer, trail = hub.join("page"), Trail()
        trail.points.append((0.0, 0.0, 0.0, 0.0))
        hub.show(Frame({"now": b"1", "map": b"2"}, {"": trail}))
        first = json.loads(hub.message_for(viewer))
        assert first == {
            "now": 1,
            "map": 2,
            "viewers": {"count": 1, "holds": False, "free": True},
            "trail:": {"first": 0, "points": [[0.0] * 4]},
        }
        assert hub.message_for(viewer) is None
        trail.points.append(None)
        hub.show(Frame({"now": b"3"}, {"": trail}))
        assert json.loads(hub.message_for(viewer)) == {"now": 3, "map": None, "trail:": {"first": 1, "points": [None]}}
        viewer.waiting = AHEAD
        hub.show(Frame({"now": b"4"}, {}))
        assert hub.message_for(viewer) is None

    in_loop(check)


def test_answers_and_notes_reach_their_pages():
    def check():
        hub = Hub()
        one, other = hub.join("one"), hub.join("other")
        hub.show(Frame({}, {}))
        hub.answer(one, 7, hub.submit("one", {"kind": "no such"}))
        hub.tell_all("hello")
        message = json.loads(hub.message_for(one))
        assert message["notes"] == ["hello"]
        assert message["answers"][0]["id"] == 7 and "no such" in message["answers"][0]["error"]
        assert "answers" not in json.loads(hub.message_for(other))

    in_loop(check)


def test_too_many_inputs_are_refused():
    hub = Hub()
    for _ in range(MOST_WAITING):
        hub.submit("page", DRIVE)
    with pytest.raises(ValueError, match="the simulation does not run now"):
        hub.submit("page", DRIVE).result(0)


def test_after_the_end_every_input_is_refused():
    hub = Hub()
    waiting = hub.submit("page", DRIVE)
    hub.close()
    for result in (waiting, hub.submit("page", DRIVE)):
        with pytest.raises(ValueError, match="the view is closed"):
            result.result(0)
