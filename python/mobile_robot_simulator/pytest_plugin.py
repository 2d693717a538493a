"""The pytest plugin: simulations as fixtures, and failures that can be repeated and looked at.

Fixtures: `simulation`, a factory of simulations; `floor_plan`, a factory of maps; `robot_world`, a simulation made as the
marker says. A test that fails prints the seed and the command that repeats it, and leaves a recording and a picture of each
simulation in its own folder (tmp_path).
"""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

# Nothing else is imported before a test asks for it: this module is loaded by each pytest where the package is installed.
if TYPE_CHECKING:
    from ._core import OccupancyGrid
    from .messages import Message
    from .obstacles import PoseLike
    from .simulation import Simulation

MARKER = "simulator"
KEYWORDS = ("map", "parameters", "seed", "start", "robots", "size", "resolution")
KINDS = ("office", "corridor", "maze", "cave", "warehouse")
START_RADIUS = 0.3
"""A start is drawn where a robot of this radius [m] has room."""

_ROOMS = pytest.StashKey["list[SimulationFactory]"]()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Options of the simulator."""
    group = parser.getgroup("mobile robot simulator")
    group.addoption("--simulator-seed", type=_seed, metavar="N", help="seed of simulations and floor plans, before markers'")
    group.addoption(
        "--simulator-record",
        choices=("never", "on-failure", "always"),
        default="on-failure",
        help="when to leave a recording (MCAP) and a picture of each simulation in the test's folder (default: on-failure)",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Make the marker known."""
    config.addinivalue_line(
        "markers",
        f"{MARKER}({', '.join(f'{name}=...' for name in KEYWORDS)}): "
        "what the fixtures of mobile_robot_simulator make their simulations and floor plans of",
    )


@pytest.fixture
def simulation(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[SimulationFactory]:
    """A factory of simulations: `simulation(map, parameters=, seed=, start=, robots=)`; what is left out is the marker's.

    map: a floor plan's kind, a map file or a grid; an office if left out. start: drawn from free space if left out; so is
    each robot's if `robots` are names only. The rest is as for `Simulation`. All are closed when the test ends.
    """
    factory = SimulationFactory(request, tmp_path)
    request.node.stash.setdefault(_ROOMS, []).append(factory)
    yield factory
    factory.close()


@pytest.fixture
def robot_world(simulation: SimulationFactory) -> Simulation:
    """A simulation made as the marker says, of a generated office if there is none."""
    return simulation()


@pytest.fixture
def floor_plan(request: pytest.FixtureRequest) -> Any:
    """A factory of maps: `floor_plan(kind, seed=, size=, resolution=)`; the seed is the test's if left out."""
    settings = _settings(request)

    def make(kind: str = "office", *, seed: int | None = None, **options: Any) -> OccupancyGrid:
        from .floor_plans import floor_plan

        options = {**{name: settings[name] for name in ("size", "resolution") if name in settings}, **options}
        return floor_plan(kind, seed=settings["seed"] if seed is None else seed, **options)

    return make


class SimulationFactory:
    """Makes the simulations of one test, and keeps what a report of it needs."""

    def __init__(self, request: pytest.FixtureRequest, folder: Path) -> None:
        self._settings = _settings(request)
        self._when: str = request.config.getoption("--simulator-record")
        self._folder = folder
        self._made: list[tuple[Simulation, Path, list[tuple[str, Message, int]]]] = []

    @property
    def seed(self) -> int:
        """The seed of this test."""
        seed: int = self._settings["seed"]
        return seed

    def __call__(
        self,
        map: OccupancyGrid | str | Path | None = None,
        *,
        parameters: Mapping[str, Any] | None = None,
        seed: int | None = None,
        start: PoseLike | None = None,
        robots: Mapping[str, PoseLike] | Sequence[str] | None = None,
        **plan: Any,
    ) -> Simulation:
        """A simulation."""
        from .simulation import Simulation

        settings = self._settings
        seed = settings["seed"] if seed is None else seed
        robots = settings.get("robots") if robots is None else robots
        start = settings.get("start") if start is None and robots is None else start
        grid = self._grid(settings.get("map", "office") if map is None else map, seed, plan)
        names = [] if robots is None or isinstance(robots, Mapping) else list(robots)
        poses = {name: _draw(grid, seed + index) for index, name in enumerate(names)}
        made = Simulation(
            grid,
            parameters={**settings.get("parameters", {}), **(parameters or {})},
            seed=seed,
            start=start if start is not None or robots is not None else _draw(grid, seed),
            robots=poses or robots,  # type: ignore[arg-type]
        )
        folder = self._folder / ("simulation" if not self._made else f"simulation-{len(self._made) + 1}")
        messages: list[tuple[str, Message, int]] = []
        if self._when != "never":
            made.picture = folder / "drive.png"
            made.record(lambda topic, message, time_ns: messages.append((topic, message, time_ns)))
        self._made.append((made, folder, messages))
        return made

    def leave(self) -> list[str]:
        """Write recordings and pictures; says where they are, or why there is none."""
        lines = []
        for made, folder, messages in self._made:
            if self._when == "never":
                continue
            folder.mkdir(parents=True, exist_ok=True)
            try:
                lines.append(f"recording: {_write(folder, messages)}")
            except Exception as error:
                lines.append(f"no recording: {error}")
            try:
                made.draw(folder / "drive.png")
                lines.append(f"picture: {folder / 'drive.png'}")
            except Exception as error:
                lines.append(f"no picture: {error}")
        return lines

    def close(self) -> None:
        """Close all simulations, and leave what is always left."""
        if self._when == "always":
            self.leave()
        for made, _, messages in self._made:
            made.close()
            messages.clear()

    def _grid(self, map: OccupancyGrid | str | Path, seed: int, plan: Mapping[str, Any]) -> OccupancyGrid:
        if not isinstance(map, (str, Path)):
            return map
        if str(map) not in KINDS:
            from .maps import load_map

            return load_map(map)
        from .floor_plans import floor_plan

        options = {name: value for name, value in self._settings.items() if name in ("size", "resolution")}
        options.update(plan)
        return floor_plan(str(map), seed=seed, **options)


@pytest.hookimpl(hookwrapper=True, tryfirst=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Iterator[None]:
    """Add to the report of a failure what repeats it, and what was left to look at."""
    outcome: Any = yield
    report: pytest.TestReport = outcome.get_result()
    factories = item.stash.get(_ROOMS, [])
    if not report.failed or not factories:
        return
    for factory in factories:
        lines = [
            f"seed: {factory.seed}",
            f"repeat with: pytest {shlex.quote(item.nodeid)} --simulator-seed {factory.seed}",
            *(factory.leave() if report.when != "teardown" else []),
        ]
        report.sections.append(("mobile robot simulator", "\n".join(lines)))


def _settings(request: pytest.FixtureRequest) -> dict[str, Any]:
    """What the markers say, the nearest first; the seed of the command line before theirs."""
    settings: dict[str, Any] = {}
    for marker in request.node.iter_markers(MARKER):
        unknown = [name for name in marker.kwargs if name not in KEYWORDS]
        if marker.args or unknown:
            got = ", ".join([*map(repr, marker.args), *unknown])
            raise pytest.UsageError(f"the marker {MARKER} takes the keywords {', '.join(KEYWORDS)}, got {got}")
        settings = {**marker.kwargs, **settings}
    given = request.config.getoption("--simulator-seed")
    settings["seed"] = given if given is not None else settings.get("seed", 0)
    return settings


def _seed(text: str) -> int:
    if not text.isdecimal() or int(text) >= 2**63:
        raise ValueError(text)
    return int(text)


def _draw(grid: OccupancyGrid, seed: int) -> PoseLike:
    return grid.draw_free_pose(radius=START_RADIUS, seed=seed)


def _write(folder: Path, messages: list[tuple[str, Message, int]]) -> Path:
    from .recording import Recorder

    with Recorder(folder, overwrite=True) as recorder:
        for topic, message, time_ns in messages:
            recorder.write(topic, message, time_ns)
    return recorder.path
