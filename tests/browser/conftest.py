"""A browser without network, and live views in processes of their own."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

sync_api = pytest.importorskip("playwright.sync_api")

# No name resolves and no address but this machine's is reached.
NO_NETWORK = "--host-resolver-rules=MAP * ~NOTFOUND , EXCLUDE 127.0.0.1"
OPTIONS = ["--no-sandbox", "--proxy-server=127.0.0.1:9", "--proxy-bypass-list=127.0.0.1", NO_NETWORK]

WAIT = 30_000
"""Longest time that a page may take for anything [ms]. Generous, because test machines can be busy."""


class Live:
    """A process that shows a simulation.

    Attributes:
        folder: Its working folder.
        url: Address of the page.
    """

    def __init__(self, arguments: list[str], folder: Path) -> None:
        self._arguments, self.folder = arguments, folder
        self.start()

    def start(self) -> None:
        """Starts the process and waits for the address."""
        self.process = subprocess.Popen(
            [sys.executable, *self._arguments], cwd=self.folder, stdout=subprocess.PIPE, text=True, bufsize=1
        )
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        assert "http://" in line, f"the view printed no address but {line!r}"
        self.url = "http://" + line.strip().partition("http://")[2]

    def stop(self, number: int = signal.SIGINT) -> None:
        """Ends the process."""
        if self.process.poll() is None:
            self.process.send_signal(number)
            try:
                self.process.wait(20)
            except subprocess.TimeoutExpired:
                self.process.kill()
        self.process.wait()
        if self.process.stdout is not None:
            self.process.stdout.close()


@pytest.fixture
def live(tmp_path: Path) -> Iterator[Callable[..., Live]]:
    """Starts the command `live` with arguments, or a script: `live(script="...")`."""
    started: list[Live] = []

    def start(*arguments: object, script: str | None = None) -> Live:
        if script is not None:
            command = ["-c", script]
        else:
            given = list(map(str, arguments))
            command = ["-m", "mobile_robot_simulator", "live", *given, *([] if "--port" in given else ["--port", "0"])]
        started.append(Live(command, tmp_path))
        return started[-1]

    yield start
    for each in started:
        each.stop()


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    path = os.environ.get("CHROMIUM") or shutil.which("chromium")
    assert path, "there is no chromium: run tests/browser/run"
    with sync_api.sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=path, args=OPTIONS)
        yield started
        started.close()


class Page:
    """A page of a live view, and what it knows of the simulation.

    Attributes:
        tab: The browser's page.
        problems: Errors in the console, and requests that left this machine.
    """

    def __init__(self, tab: Any, url: str) -> None:
        self.tab, self.problems = tab, list[str]()
        tab.set_default_timeout(WAIT)
        tab.on("pageerror", lambda error: self.problems.append(f"{error}"))
        tab.on("console", lambda message: self._hear(message))
        tab.on("request", lambda request: self._check(request.url))
        tab.goto(url)
        self.wait("window.liveView?.drawCount > 0 && live.mapImage")

    def _hear(self, message: Any) -> None:
        if message.type == "error":
            self.problems.append(message.text)

    def _check(self, url: str) -> None:
        if not url.startswith(("http://127.0.0.1:", "ws://127.0.0.1:", "data:", "blob:")):
            self.problems.append(f"a request to {url}")

    def get(self, expression: str) -> Any:
        """Returns the value of an expression. `parts` is the newest of each part of the frames, `live` the page."""
        return self.tab.evaluate(
            f"(() => {{ const live = window.liveView, parts = live?.link().parts; return {expression} }})()"
        )

    def wait(self, condition: str) -> None:
        """Waits until a condition holds."""
        self.tab.wait_for_function(
            f"(() => {{ const live = window.liveView, parts = live?.link().parts; return {condition} }})()", timeout=WAIT
        )

    def pose(self, robot: str = "") -> list[float]:
        """Returns the true pose of a robot."""
        found: list[float] = self.get(f"parts.now.robots[{robot!r}].pose")
        return found

    def at(self, x: float, y: float) -> tuple[float, float]:
        """Returns the point of the screen of a point of the map."""
        u, v = self.get(f"live.camera.toScreen([{x}, {y}])")
        return u, v

    def drag(self, tool: str, start: tuple[float, float], end: tuple[float, float] | None = None) -> None:
        """Uses a tool on the map, from a point of the map to another."""
        self.tab.click(f"[data-tool-name={tool}]")
        self.tab.mouse.move(*self.at(*start))
        self.tab.mouse.down()
        if end is not None:
            self.tab.mouse.move(*self.at(*end), steps=5)
        self.tab.mouse.up()

    def hold(self, key: str, until: str) -> None:
        """Holds a key until a condition holds."""
        self.tab.keyboard.down(key)
        try:
            self.wait(until)
        finally:
            self.tab.keyboard.up(key)

    def choose(self, name: str, option: str) -> None:
        """Chooses an option of a list that is marked with a name for tests."""
        self.test(name).click()
        self.tab.get_by_role("option", name=option).click()
        self.wait("document.querySelector('.q-menu') === null")

    def test(self, name: str) -> Any:
        """Returns the element that is marked with a name for tests."""
        return self.tab.locator(f"[data-test={name}]")


@pytest.fixture
def visit(browser: Any) -> Iterator[Callable[..., Page]]:
    """Opens a page. At the end, no page may have reported a problem, unless the test has looked at it and removed it."""
    contexts, pages = [], []

    def open_page(url: str, **options: Any) -> Page:
        contexts.append(browser.new_context(**{"viewport": {"width": 1280, "height": 800}, **options}))
        pages.append(Page(contexts[-1].new_page(), url))
        return pages[-1]

    yield open_page
    for context in contexts:
        context.close()
    assert [problem for page in pages for problem in page.problems] == []


@pytest.fixture
def room(tmp_path: Path) -> Path:
    """The file of a room of 8 m by 6 m with an inner wall from (5, 0) to (5, 3)."""
    import numpy as np

    import mobile_robot_simulator as mrs

    cells = np.zeros((120, 160), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    cells[:60, 100] = 100
    file = tmp_path / "room.yaml"
    mrs.save_map(mrs.OccupancyGrid(cells, resolution=0.05), file)
    return file
