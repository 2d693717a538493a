"""LiveView: a simulation in the browser, and what a script that runs it notices. A plain WebSocket stands for the page."""

from __future__ import annotations

import asyncio
import re
import threading
import time
from urllib.parse import urlsplit

import pytest
import websockets
from pages import Page, background, fetch
from sessions import robot

import mobile_robot_simulator as mrs
from mobile_robot_simulator.live import LiveView
from mobile_robot_simulator.live.inputs import Record
from simulations import drive


def test_a_page_drives_the_simulation_that_run_hands_over():
    sim = robot()
    with LiveView(sim) as view:
        running = background(lambda: view.run(30.0))
        page = Page(view.url)
        page.send("drive", robot="", vx=1.0)
        page.wait(lambda: sim.pose.x > 3.1)
        page.send("pause", paused=True)
        page.wait(lambda: page.parts["session"]["paused"])
        page.send("set_pose", robot="", x=0.0, y=0.0, yaw=0.0)
        page.wait(lambda: any("wall" in str(each.get("error")) for each in page.answers))
        page.close()
        view.close()
        running.join(5.0)
        assert not running.is_alive()


def test_a_script_runs_at_the_speed_of_the_view_and_with_the_same_messages():
    sims = [robot(), robot()]
    view = sims[0].show(speed=20.0)
    assert sims[0].show() is view
    began = time.monotonic()
    for sim in sims:
        drive(sim, 0.5)
        sim.run_for(4.0)
    assert time.monotonic() - began > 0.15
    assert sims[0].pose == sims[1].pose and sims[0].time == 4.0
    assert (sims[0].latest("/scan").ranges == sims[1].latest("/scan").ranges).all()
    sims[0].close()
    assert view.is_closed
    view.close()


def test_a_page_stops_the_time_of_a_script_steps_it_and_a_closed_page_does_not():
    sim = robot()
    view = sim.show(speed=2.0)
    page_is_there, ended = threading.Event(), threading.Event()

    def script():
        page_is_there.wait(20.0)
        sim.run_for(3.0)
        ended.set()

    running = background(script)
    page = Page(view.url)
    page_is_there.set()
    page.wait(lambda: sim.time > 0.2)
    page.send("pause", paused=True)
    page.wait(lambda: page.parts["session"]["paused"])
    stopped = sim.time
    time.sleep(0.3)
    assert sim.time == stopped and not ended.is_set()
    page.send("step", seconds=0.5)
    page.wait(lambda: sim.time >= stopped + 0.4)
    time.sleep(0.2)
    assert sim.time < stopped + 0.6
    page.send("add_obstacle", x=8.0, y=8.0, radius=0.5)
    page.wait(lambda: len(sim.obstacles) == 1)
    page.send("save_state", name="here")
    page.wait(lambda: any("error" in each for each in page.answers))  # not in the middle of a run
    page.close()
    assert ended.wait(20.0)
    running.join(5.0)
    assert sim.time == 3.0
    view.close()


def test_the_speed_must_be_positive():
    with pytest.raises(ValueError, match="the speed must be positive and finite, got 0"):
        robot().show(speed=0.0)
    with pytest.raises(TypeError, match="the speed must be a number, got '1'"):
        robot().show(speed="1")


@pytest.mark.parametrize("port", [-1, 65536])
def test_the_port_must_be_one(port):
    with pytest.raises(ValueError, match=rf"the port must be in 0\.\.65535, got {port}"):
        robot().show(port=port)


def test_in_the_event_loop_of_a_notebook_the_page_runs_the_simulation_between_cells():
    sim = robot()

    async def notebook():
        view = sim.show()
        await asyncio.sleep(0.5)
        first = sim.time
        sim.run_for(0.1)  # a cell
        assert view._repr_html_().startswith(f'<iframe src="{view.url}"')
        await asyncio.sleep(0.2)
        view.close()
        return first

    first = asyncio.run(notebook())
    assert 0.2 < first < 0.6 and sim.time > first + 0.1


def test_two_views_in_one_process_show_their_own_simulation():
    with LiveView(robot()) as one, LiveView(mrs.Simulation(mrs.floor_plan("maze", seed=1), start=(1.0, 1.0, 0.0))) as other:
        pages = [Page(view.url) for view in (one, other)]
        assert [page.parts["map"]["rows"] for page in pages] == [200, other.session.simulation.grid.shape[0]]
        for page in pages:
            page.close()


def test_strangers_get_nothing():
    with LiveView(robot()) as view:
        base = view.url
        assert fetch(base)[0] == 200
        assert fetch(base, Host="evil.example")[0] == 403
        assert fetch(f"{base}live/map?viewer=nobody")[0] == 403

        async def talk():
            address = f"ws://{urlsplit(base).netloc}/live/socket?viewer=nobody"
            async with websockets.connect(address, proxy=None) as socket:
                with pytest.raises(websockets.ConnectionClosed) as closed:
                    await socket.recv()
                return closed.value.rcvd.code

        assert asyncio.run(talk()) == 4403
    assert view.is_closed


def test_elsewhere_the_address_needs_its_token():
    with LiveView(robot(), host="0.0.0.0") as view:
        base, _, token = view.url.partition("?token=")
        local = f"http://127.0.0.1:{urlsplit(base).port}/"
        assert len(token) > 15
        assert (
            fetch(local)[0] == 403 and fetch(f"{local}?token=wrong")[0] == 403 and fetch(f"{local}?token=%C3%A4")[0] == 403
        )
        assert fetch(f"{local}?token={token}")[0] == 200


def test_a_port_in_use_is_an_error_that_says_so():
    with (
        LiveView(robot()) as view,
        pytest.raises(OSError, match=r"cannot listen on 127.0.0.1, port \d+: Address already in use"),
    ):
        LiveView(robot(), port=urlsplit(view.url).port)


def test_the_page_names_no_address_elsewhere():
    with LiveView(robot()) as view:
        assert not re.findall(r"(?:src|href)=[\"']?(?:https?:)?//", fetch(view.url)[1])


def test_a_closed_view_ends_its_recording(tmp_path):
    view = LiveView(robot(), folder=tmp_path)
    view.session.do(Record(name="one"))
    view.session.simulation.run_for(1.0)
    view.close()
    assert (tmp_path / "one" / "recording" / "metadata.yaml").is_file()
