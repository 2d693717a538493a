"""The live view in a real browser without network: what a person sees and does."""

from __future__ import annotations

import math
import runpy
import signal
import socket
from pathlib import Path

import pytest

from mobile_robot_simulator.recording import Recorder

START = ("--start", 2, 2, 0)


def parameter(page, name):
    return page.tab.locator(f"[data-parameter={name}]")


def test_the_page_loads_without_network_and_shows_the_map(live, visit, room):
    page = visit(live(room, *START).url)
    wall, free = ([*page.tab.evaluate(PIXEL, list(page.at(*place)))] for place in ((5.025, 2.0), (7.0, 5.0)))
    assert sum(wall[:3]) < 250 < 600 < sum(free[:3])
    assert page.test("scale").inner_text() in ("1 m", "2 m")
    page.tab.mouse.move(*page.at(5.025, 2.0))
    page.wait("live.shown.cursor.includes('column 100') && live.shown.cursor.includes('occupied (100)')")
    assert "x 5.0" in page.test("cursor").inner_text()


PIXEL = "([u, v]) => [...liveView.$refs.canvas.getContext('2d').getImageData(u, v, 1, 1).data]"


def test_keys_move_the_true_pose_and_letting_go_stops(live, visit, room):
    page = visit(live(room, *START).url)
    page.hold("ArrowUp", "parts.now.robots[''].pose[0] > 2.5")
    page.wait("parts.now.robots[''].velocity[0] === 0")
    x, y, yaw = page.pose()
    assert 2.5 < x < 4.7 and (y, yaw) == (2.0, 0.0)
    page.hold("a", "parts.now.robots[''].pose[2] > 0.5")
    page.wait("parts.now.robots[''].velocity[2] === 0")
    assert page.pose()[:2] == [x, y]
    assert page.get("live.link().trails[''].length") > 10


def test_keys_typed_in_a_field_do_not_drive(live, visit, room):
    page = visit(live(room, *START).url)
    page.tab.locator("[data-test=filter]").press_sequentially("wwww")
    assert page.get("live.steering.keys.size") == 0 and page.pose() == [2.0, 2.0, 0.0]


def test_the_pad_and_a_gamepad_drive(live, visit, room):
    page = visit(live(room, *START).url)
    box = page.test("pad").bounding_box()
    page.tab.mouse.move(box["x"] + 74, box["y"] + 74)
    page.tab.mouse.down()
    page.tab.mouse.move(box["x"] + 74, box["y"] + 10, steps=4)
    page.wait("parts.now.robots[''].pose[0] > 2.3")
    page.tab.mouse.up()
    page.wait("parts.now.robots[''].velocity[0] === 0")
    assert page.pose()[1] == 2.0
    page.tab.evaluate("navigator.getGamepads = () => [{ connected: true, axes: [-1, 0] }]")
    page.wait("parts.now.robots[''].pose[2] > 0.3")
    page.tab.evaluate("navigator.getGamepads = () => []")
    page.wait("parts.now.robots[''].velocity[2] === 0")


def test_a_drag_sets_the_pose_and_a_wall_refuses_it(live, visit, room):
    page = visit(live(room, *START).url)
    page.drag("pose", (3.0, 4.0), (3.0, 5.0))
    page.wait("parts.now.robots[''].pose[1] > 3.5")
    x, y, yaw = page.pose()
    assert (x, y) == (pytest.approx(3.0, abs=0.02), pytest.approx(4.0, abs=0.02)) and yaw == pytest.approx(
        math.pi / 2, abs=0.05
    )
    page.drag("pose", (5.025, 1.0), (6.0, 1.0))
    assert "inside a wall" in page.test("note").inner_text() or "touches" in page.test("note").inner_text()
    assert page.pose() == [x, y, yaw]


def test_a_dragged_goal_is_reached_around_the_wall(live, visit, room):
    page = visit(live(room, *START, "-p", "speed_factor:=5").url)
    page.drag("goal", (7.0, 1.5), (7.0, 1.0))
    page.wait("parts.session.pilots['']?.goal")
    page.wait(
        "!parts.session.pilots[''] && Math.hypot(parts.now.robots[''].pose[0] - 7, parts.now.robots[''].pose[1] - 1.5) < 0.1"
    )
    assert page.pose()[2] == pytest.approx(-math.pi / 2, abs=0.1)
    assert not page.get("parts.contacts['']")


NEAREST_AHEAD = (
    "(() => { const s = parts['scan::'], i = s.hit.length >> 1; return Math.hypot(s.xy[2 * i] - 2, s.xy[2 * i + 1] - 2) })()"
)


def test_an_obstacle_is_in_the_next_scan_moves_and_goes(live, visit, room):
    page = visit(live(room, *START, "-p", "z_max:=0", "-p", "laser_frequency:=20").url)
    page.wait(f"Math.abs({NEAREST_AHEAD} - 3) < 0.1")
    page.drag("disc", (3.5, 2.0), (3.5, 2.4))
    page.wait(f"Math.abs({NEAREST_AHEAD} - 1.1) < 0.1")
    page.drag("disc", (3.5, 2.1), (4.0, 2.1))
    page.wait(f"Math.abs({NEAREST_AHEAD} - 1.6) < 0.1")
    page.drag("remove", (4.0, 2.0))
    page.wait(f"Math.abs({NEAREST_AHEAD} - 3) < 0.1")
    page.drag("box", (3.0, 1.5), (3.4, 2.5))
    page.wait(f"Math.abs({NEAREST_AHEAD} - 1) < 0.1")
    (box,) = page.get("parts.obstacles")
    assert max(x for x, _ in box["corners"]) == pytest.approx(0.2, abs=0.02)


def test_a_refused_parameter_stays_in_its_field_with_the_reason(live, visit, room):
    page = visit(live(room, *START).url)
    page.test("filter").fill("laser_frequency")
    field = parameter(page, "laser_frequency")
    assert "above 0, at most 1,000,000" in field.inner_text() and "Hz" in field.inner_text()
    field.locator("input").fill("-3")
    field.locator("input").press("Enter")
    field.get_by_text("laser_frequency must be greater than 0, got -3").wait_for()
    assert field.locator("input").input_value() == "-3"
    field.locator("input").fill("25")
    field.locator("input").press("Enter")
    page.wait("parts.settings.nodes[1].values.laser_frequency === '25.0'")
    assert "must be" not in field.inner_text()
    page.test("filter").fill("contact")
    parameter(page, "contact").locator(".q-field__native").click()
    page.tab.get_by_role("option", name="slide").click()
    page.wait("parts.settings.nodes[0].values.contact === 'slide'")


def test_a_recording_opens_and_the_script_repeats_it_byte_by_byte(live, visit, room, tmp_path):
    from rosbags.rosbag2 import Reader

    process = live(
        room, *START, "--paused", "--fault", "Drop('/scan', probability=0.3)", "-p", "odometry_alphas:=[0.1,0,0,0.1,0,0]"
    )
    page = visit(process.url)
    page.tab.get_by_role("tab", name="Keep").click()
    page.test("record").click()
    page.wait("parts.session.recording")
    page.test("pause").click()
    page.hold("ArrowUp", "parts.now.robots[''].pose[0] > 2.3")
    page.drag("disc", (4.0, 3.0))
    page.drag("goal", (3.0, 4.5), (2.0, 4.5))
    page.wait("parts.now.robots[''].pose[1] > 2.5")
    page.test("state-name").fill("on the way")
    page.test("save-state").click()
    page.wait("parts.session.states['on the way'] !== undefined")
    page.wait("parts.now.time > parts.session.states['on the way'] + 0.5")
    page.tab.locator("[data-state='on the way']").click()
    page.test("pause").click()
    page.wait("parts.session.paused")
    page.test("end-recording").click()
    page.wait("!parts.session.recording")
    page.test("copy-as-python").click()
    with page.tab.expect_download() as download:
        page.test("download").click()
    script = tmp_path / "repeat.py"
    download.value.save_as(script)
    recording = tmp_path / "live" / "drive-1" / "recording"
    with Reader(recording) as reader:
        assert {"/scan", "/odom", "/cmd_vel", "/map"} <= {
            each.topic for each in reader.connections
        } and reader.message_count > 50
    repeat = runpy.run_path(str(script))
    simulation = start_of(script)
    with Recorder(tmp_path / "again") as recorder:
        simulation.record(recorder.write)
        repeat["repeat"](simulation)
    again = tmp_path / "again" / "recording" / "recording.mcap"
    assert (recording / "recording.mcap").read_bytes() == again.read_bytes()


def start_of(script: Path):
    """The simulation that a script creates before it repeats what was done."""
    import mobile_robot_simulator as mrs

    text = script.read_text()
    lines = [line.strip() for line in text.partition('if __name__ == "__main__":')[2].splitlines()]
    names = {"mrs": mrs}
    exec("\n".join(line for line in lines if line and not line.startswith(("repeat(", "print("))), names)
    return names["sim"]


def test_two_viewers_see_the_same_and_one_holds_the_controls(live, visit, room):
    url = live(room, *START).url
    one, two = visit(url), visit(url)
    one.hold("ArrowUp", "parts.now.robots[''].pose[0] > 2.3")
    one.wait("parts.now.robots[''].velocity[0] === 0")
    two.wait("parts.now.robots[''].pose[0] > 2.3 && parts.now.robots[''].velocity[0] === 0")
    assert one.pose() == two.pose()
    assert "2 viewers" in two.test("viewers").inner_text() and "another holds" in two.test("viewers").inner_text()
    two.tab.keyboard.press("ArrowLeft")
    two.tab.get_by_text("another viewer holds the controls").wait_for()
    assert one.pose()[2] == 0.0
    two.test("take-controls").click()
    two.wait("parts.viewers.holds")
    two.hold("ArrowLeft", "parts.now.robots[''].pose[2] > 0.2")
    one.wait("parts.now.robots[''].pose[2] > 0.2 && !parts.viewers.holds")


def test_a_closed_page_stops_the_robot_and_not_the_simulation(live, visit, room):
    url = live(room, *START, "-p", "speed_factor:=0.5").url
    one, two = visit(url), visit(url)
    one.tab.keyboard.down("ArrowUp")
    two.wait("parts.now.robots[''].velocity[0] > 0")
    one.tab.close()
    two.wait("parts.viewers.count === 1 && parts.now.robots[''].velocity[0] === 0")
    before = two.get("parts.now.time")
    two.wait(f"parts.now.time > {before} + 0.2")
    assert two.pose()[0] < 4.7


def test_a_reload_shows_the_same_again(live, visit, room):
    page = visit(live(room, *START).url)
    page.hold("ArrowUp", "parts.now.robots[''].pose[0] > 2.5")
    page.wait("parts.now.robots[''].velocity[0] === 0")
    pose, trail = page.pose(), page.get("live.link().trails[''].length")
    page.tab.reload()
    page.wait("window.liveView?.drawCount > 0 && live.mapImage")
    assert page.pose() == pose and page.get("live.link().trails[''].length") == trail
    page.hold("ArrowLeft", "parts.now.robots[''].pose[2] > 0.2")


def test_a_page_comes_back_when_the_simulator_is_killed_and_started_again(live, visit, room):
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    process = live(room, *START, "--port", port)
    page = visit(process.url)
    page.hold("ArrowUp", "parts.now.robots[''].pose[0] > 2.5")
    process.stop(signal.SIGKILL)
    page.test("lost").get_by_text("The connection is lost").wait_for()
    page.tab.screenshot()
    process.start()
    page.wait("window.liveView?.open && live.drawCount > 0 && parts.now?.robots[''].pose[0] === 2")
    page.hold("ArrowUp", "parts.now.robots[''].pose[0] > 2.5")
    page.problems.clear()  # the console reports each attempt to connect


def test_time_stops_steps_runs_faster_and_robots_are_put_back(live, visit, room):
    page = visit(live(room, *START).url)
    page.tab.keyboard.press("Space")
    page.wait("parts.session.paused")
    stopped = page.get("parts.now.time")
    page.test("step").click()
    page.wait(f"Math.abs(parts.now.time - {stopped} - 0.1) < 1e-6")
    page.tab.keyboard.press("ArrowUp")
    page.tab.get_by_text("Time stands still").wait_for()
    page.choose("speed", "10\N{MULTIPLICATION SIGN}")
    page.wait("parts.session.speed === 10")
    page.tab.keyboard.press("Space")
    page.wait("parts.now.rate > 4")
    page.hold("ArrowUp", "parts.now.robots[''].pose[0] > 2.5")
    page.test("reset").click()
    page.wait("parts.now.robots[''].pose[0] === 2 && live.link().trails[''].length < 3")
    page.test("seed").click()
    page.test("seed-value").fill("-4")
    page.tab.get_by_role("button", name="Use this seed").click()
    page.tab.get_by_text("greater than or equal to 0").wait_for()
    page.test("seed-value").fill("4")
    page.tab.get_by_role("button", name="Use this seed").click()
    page.wait("parts.settings.nodes[1].values.seed === '4' && parts.settings.nodes[0].values.odometry_seed === '4'")


def test_faults_are_added_refused_and_turned_off(live, visit, room):
    page = visit(live(room, *START, "-p", "laser_frequency:=20").url)
    page.tab.get_by_role("tab", name="Faults").click()
    page.test("fault").fill("Drop('/scann')")
    page.test("add-fault").click()
    page.tab.get_by_text("did you mean /scan").wait_for()
    page.choose("examples", "Blackout('/scan')")
    page.test("add-fault").click()
    page.wait("parts.session.faults.length === 1 && parts.session.faults[0].acts")
    stamp = page.get("parts['scan::'].stamp")
    before = page.get("parts.now.time")
    page.wait(f"parts.now.time > {before} + 0.3")
    assert page.get("parts['scan::'].stamp") == stamp
    page.tab.locator(".q-item .q-toggle").click()
    page.wait(f"parts['scan::'].stamp > {stamp} && parts.session.faults[0].stopped")


ROBOTS = """
import math
import numpy as np
import mobile_robot_simulator as mrs
cells = np.zeros((200, 200), np.int8)
cells[[0, -1], :] = cells[:, [0, -1]] = 100
starts = {f"r{n}": (10 + 6 * math.cos(n), 10 + 6 * math.sin(n), n + math.pi) for n in range(6)}
sim = mrs.Simulation(mrs.OccupancyGrid(cells, resolution=0.1), robots=starts)
sim.add_obstacle(mrs.Shape.disc(0.4), lambda time: (10 + math.sin(time), 10.0, 0.0), "cart")
view = sim.show()
print(view.url, flush=True)
view.run()
"""


def test_one_of_several_robots_is_chosen_and_driven(live, visit):
    page = visit(live(script=ROBOTS).url)
    page.tab.mouse.click(*page.at(*page.pose("r3")[:2]))
    page.wait("live.robot === 'r3'")
    before = {name: page.pose(name) for name in ("r2", "r3")}
    x, y, _ = before["r3"]
    page.hold("ArrowUp", f"Math.hypot(parts.now.robots.r3.pose[0] - {x}, parts.now.robots.r3.pose[1] - {y}) > 0.3")
    assert page.pose("r2") == before["r2"]
    page.choose("robot", "r1")
    page.hold("ArrowUp", "parts.now.robots.r1.velocity[0] > 0")
    assert page.get("parts.obstacles[0].velocity[0]") != 0


SCRIPT = """
import mobile_robot_simulator as mrs
grid = mrs.floor_plan("office", seed=1)
sim = mrs.Simulation(grid, start=grid.draw_free_pose(radius=1.2, seed=7))
print(sim.show().url, flush=True)
while True:
    sim.publish("/cmd_vel", mrs.messages.Twist(angular=mrs.messages.Vector3(z=0.5)))
    sim.run_for(0.1)
"""


def test_a_page_watches_a_script_and_stops_its_time(live, visit):
    page = visit(live(script=SCRIPT).url)
    page.wait("parts.now.robots[''].velocity[2] === 0.5 && parts.now.rate > 0.5")
    page.test("pause").click()
    page.wait("parts.session.paused")
    stopped = page.get("parts.now.time")
    page.drag("pose", tuple(page.pose()[:2]), None)
    page.tab.wait_for_timeout(300)
    assert page.get("parts.now.time") == stopped
    page.test("pause").click()
    page.wait(f"parts.now.time > {stopped} + 0.2")


def test_the_page_fits_a_phone(live, visit, room):
    page = visit(live(room, *START).url, viewport={"width": 412, "height": 820}, has_touch=True)
    left, right = page.at(0.0, 3.0)[0], page.at(8.0, 3.0)[0]
    assert 0 < left < right <= 412 and right - left > 250
    box = page.test("pad").bounding_box()
    page.tab.mouse.move(box["x"] + 74, box["y"] + 74)
    page.tab.mouse.down()
    page.tab.mouse.move(box["x"] + 74, box["y"] + 10, steps=4)
    page.wait("parts.now.robots[''].pose[0] > 2.2")
    page.tab.mouse.up()
