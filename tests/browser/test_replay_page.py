"""A recording in a real browser without network: the time line, keys, and no controls of a simulation."""

from __future__ import annotations

import subprocess
import sys

import pytest


@pytest.fixture
def recording(room, tmp_path):
    """The recording of a drive of 20 s in the room, without noise, straight ahead from (1, 4) for 5 s."""
    commands = tmp_path / "commands.csv"
    commands.write_text("time,vx,vy,wz\n0,0.4,0,0\n5,0,0,0\n", encoding="utf-8")
    arguments = [
        room,
        "--commands",
        commands,
        "--start",
        1,
        4,
        0,
        "--duration",
        20,
        "--out",
        "drive",
        "-p",
        "apply_noise:=false",
    ]
    command = [sys.executable, "-m", "mobile_robot_simulator", "run", *map(str, arguments)]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, timeout=120)
    return tmp_path / "drive"


def test_a_recording_runs_and_the_time_line_goes_to_any_time(live, visit, recording):
    page = visit(live(recording).url)
    page.wait("parts.now.time > 0.5 && parts['scan::/scan']")
    line = page.test("time-line").bounding_box()
    page.tab.mouse.click(line["x"] + line["width"] / 2, line["y"] + line["height"] / 2)
    page.wait("Math.abs(parts.now.time - 10) < 1.5 && live.scrub === null")
    x, y, yaw = page.pose()
    assert (x, y, yaw) == (pytest.approx(3.0, abs=0.05), 4.0, 0.0)
    page.wait("live.link().trails[''].length > 50")
    assert "/ 0:" not in page.test("timeline").inner_text() and "0:19.9" in page.test("timeline").inner_text()
    page.tab.mouse.click(line["x"] + 1, line["y"] + line["height"] / 2)
    page.wait("parts.now.robots[''].pose[0] < 1.5 && live.link().trails[''].length < 50")


def test_keys_stop_it_and_go_back_and_on(live, visit, recording):
    page = visit(live(recording, "--paused").url)
    page.tab.keyboard.press("ArrowLeft")  # it is at the beginning already
    page.tab.keyboard.press("ArrowRight")
    page.tab.keyboard.press("ArrowRight")
    page.wait("parts.now.time === 2")
    page.tab.keyboard.press("ArrowLeft")
    page.wait("parts.now.time === 1")
    page.tab.keyboard.press(".")
    page.wait("parts.now.time === 1.1")
    page.tab.keyboard.press("Space")
    page.wait("parts.now.time > 1.3")


def test_there_is_nothing_to_drive_place_or_change(live, visit, recording):
    page = visit(live(recording, "--paused").url)
    for name in ("pad", "side", "panel", "reset", "seed", "wander"):
        assert page.test(name).count() == 0, name
    assert page.tab.locator("[data-tool-name]").count() == 0
    before = page.pose()
    page.tab.keyboard.press("p")
    page.tab.mouse.click(640, 300)
    page.tab.keyboard.press("w")
    page.tab.wait_for_timeout(300)
    assert page.pose() == before and page.test("note").count() == 0
