"""ReplayView: a recording in the browser. A plain WebSocket stands for the page."""

from __future__ import annotations

import gzip
import urllib.request
from pathlib import Path
from urllib.parse import urlsplit

import numpy as np
import pytest

pytest.importorskip("rosbags", reason="the extra `recording` is not installed")

from pages import Page, background, viewer_of

import mobile_robot_simulator as mrs
from logs.bags import changed, messages, record
from mobile_robot_simulator.live.replay_view import ReplayView
from simulations import hall


def cells_of(url: str, shape: tuple[int, int]) -> np.ndarray:
    """Returns the cells of the map as a page gets them."""
    with urllib.request.urlopen(f"http://{urlsplit(url).netloc}/live/map?viewer={viewer_of(url)}", timeout=20) as answer:
        return np.frombuffer(gzip.decompress(answer.read()), np.int8).reshape(shape)


def test_a_page_plays_stops_and_goes_to_a_time(tmp_path: Path) -> None:
    with ReplayView(record(tmp_path / "bag", messages()), paused=True) as view:
        running = background(lambda: view.run(60.0))
        page = Page(view.url)
        assert page.parts["session"]["paused"] and page.parts["replay"]["duration"] == 2.9
        page.send("seek", time=1.5)
        page.wait(lambda: page.parts["now"]["time"] == 1.5)
        assert page.parts["scan::/scan"]["stamp"] == 1.5
        page.send("set_pose", robot="", x=1.0, y=1.0, yaw=0.0)
        page.wait(lambda: any("this is a recording" in str(each.get("error")) for each in page.answers))
        page.send("speed", factor=10.0)
        page.send("pause", paused=False)
        page.wait(lambda: page.parts["now"]["time"] == 2.9 and page.parts["session"]["paused"])
        page.close()
        view.close()
        running.join(5.0)
        assert not running.is_alive()


def test_the_map_that_a_page_gets_is_that_of_the_time(tmp_path: Path) -> None:
    recorded, simulation = list(messages()[:0]), mrs.Simulation(hall(), start=(5.0, 5.0, 0.0))
    simulation.record(lambda topic, message, time_ns: recorded.append((topic, mrs.messages.copied(message), time_ns)))
    simulation.run_for(1.0)
    simulation.set_cells(50, 60, np.full((2, 3), 100, np.int8))
    simulation.run_for(1.0)
    with ReplayView(record(tmp_path / "bag", recorded), paused=True) as view:
        running = background(lambda: view.run(60.0))
        page = Page(view.url)
        first = page.parts["map"]["version"]
        assert np.array_equal(cells_of(view.url, (200, 200)), hall().cells)
        page.send("seek", time=1.5)
        page.wait(lambda: page.parts["map"]["version"] != first)
        assert np.array_equal(cells_of(view.url, (200, 200)), simulation.grid.cells)
        page.close()
        view.close()
        running.join(5.0)


def test_a_page_is_told_what_is_wrong_in_the_recording(tmp_path: Path) -> None:
    recorded = changed("/scan", lambda scan: setattr(scan, "range_max", -1.0), 9)
    with ReplayView(record(tmp_path / "bag", recorded), paused=True) as view:
        running = background(lambda: view.run(60.0))
        page = Page(view.url)
        page.send("seek", time=0.9)
        page.wait(lambda: "/scan, stamp 1.000000000 s" in str(page.parts.get("notes")))
        page.close()
        view.close()
        running.join(5.0)


def test_what_is_no_recording_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        ReplayView(tmp_path / "nothing.mcap")
