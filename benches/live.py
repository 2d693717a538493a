"""Figures of the live view, in a headless browser: scans per second, time from a click to the next scan, load of the server.

Needs the extra `live`, Playwright and Chromium, as tests/browser/setup.sh installs them:

    .venv-browser/bin/python benches/live.py [--seconds 10]

Each figure is of one process with a simulation and one page, both on this machine. The load of the server is the processor
time of that process, the simulation included, per wall time.
"""

from __future__ import annotations

import argparse
import os
import shutil
import statistics
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from playwright.sync_api import Page, sync_playwright

SIMULATION = """
import math, sys
import numpy as np
import mobile_robot_simulator as mrs

side, robots = int(sys.argv[1]), int(sys.argv[2])
cells = np.zeros((side, side), np.int8)
cells[[0, -1]] = cells[:, [0, -1]] = 100
cells[::100, ::7] = 100
grid = mrs.OccupancyGrid(cells, resolution=0.05)
parameters = {"laser_frequency": 20.0, "laser_beam_count": 541, "robot_radius": 0.2}
spots = grid.draw_free_poses(robots, radius=1.0, seed=1)
if robots == 1:
    sim = mrs.Simulation(grid, parameters=parameters, start=tuple(spots[0]), seed=1)
else:
    sim = mrs.Simulation(grid, parameters=parameters, robots={f"r{n}": tuple(spot) for n, spot in enumerate(spots)}, seed=1)
view = mrs.live.LiveView(sim)
print(view.url, flush=True)
view.run()
"""


class Shown:
    """A simulation in a process of its own, and its page."""

    def __init__(self, browser: Any, side: int, robots: int) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-c", SIMULATION, str(side), str(robots)], stdout=subprocess.PIPE, text=True
        )
        assert self.process.stdout is not None
        url = self.process.stdout.readline().strip()
        self.page: Page = browser.new_page(viewport={"width": 1280, "height": 800})
        began = time.perf_counter()
        self.page.goto(url)
        self.page.wait_for_function("window.liveView?.mapImage && liveView.drawnScan > 0")
        self.opening = time.perf_counter() - began

    def close(self) -> None:
        """Ends the page and the process."""
        self.page.close()
        self.process.kill()
        self.process.wait()

    def server_seconds(self) -> float:
        """Processor time of the server so far [s]."""
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def rates(self, seconds: float) -> tuple[float, float, float]:
        """Returns the drawn scans per second, the drawn frames per second and the load of the server in cores."""
        count = "[liveView.drawnScan, liveView.drawCount]"
        before, spent, began = self.page.evaluate(count), self.server_seconds(), time.perf_counter()
        time.sleep(seconds)
        after, wall = self.page.evaluate(count), time.perf_counter() - began
        scans, frames = ((new - old) / wall for new, old in zip(after, before, strict=True))
        return scans, frames, (self.server_seconds() - spent) / wall

    def click_to_scan(self, count: int) -> list[float]:
        """Returns the times from putting an obstacle down to the drawing of the first scan after it is there [ms]."""
        return [self.page.evaluate(CLICK, number) for number in range(count)]


CLICK = """async (number) => {
  const live = window.liveView, link = live.link(), began = performance.now();
  await live.tell({ kind: "add_obstacle", x: 5 + (number % 20), y: 5, radius: 0.2 });
  const done = link.scanCount;
  while (live.drawnScan <= done) await new Promise(requestAnimationFrame);
  return performance.now() - began;
}"""


def main() -> None:
    """Prints the figures."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--seconds", type=float, default=10.0, help="time to measure each rate [s]")
    seconds = arguments.parse_args().seconds
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        one = Shown(browser, 1000, 1)
        scans, frames, load = one.rates(seconds)
        print(f"one robot, 541 beams at 20 Hz, 1000² cells: {scans:.1f} scans/s shown, {frames:.0f} frames/s")
        print(f"    server, with the simulation: {100 * load:.0f} % of a core")
        times = one.click_to_scan(40)
        print(
            f"    from a click to the next scan drawn: median {statistics.median(times):.0f} ms, largest {max(times):.0f} ms"
        )
        one.close()
        big = Shown(browser, 4000, 1)
        print(f"4000² cells: open after {big.opening:.2f} s")
        big.close()
        twenty = Shown(browser, 1000, 20)
        scans, frames, load = twenty.rates(seconds)
        print(f"twenty robots: {frames:.0f} frames/s, {scans:.0f} scans/s shown, server {100 * load:.0f} % of a core")
        twenty.close()
        browser.close()
    print(f"load of the machine: {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")


if __name__ == "__main__":
    main()
