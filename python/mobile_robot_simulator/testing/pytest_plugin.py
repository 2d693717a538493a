"""The pytest plugin: simulations as fixtures, and failures that can be repeated and looked at.

Fixtures: `simulation`, a factory of simulations; `floor_plan`, a factory of maps; `robot_world`, a simulation made as the
marker says. A test that fails prints the seed and the command that repeats it, and leaves a recording and a picture of each
simulation in its own folder (tmp_path).
"""

from __future__ import annotations

import difflib
import math
import os
import shlex
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

# Nothing else is imported before a test asks for it: this module is loaded by each pytest where the package is installed.
if TYPE_CHECKING:
    from .._core import OccupancyGrid, Pose
    from ..physics.obstacles import PoseLike
    from ..recording.deferred import DeferredRecorder
    from ..simulation.simulation import Simulation

MARKER = "simulator"
KEYWORDS = ("map", "parameters", "seed", "start", "robots", "size", "resolution")
KINDS = ("office", "corridor", "maze", "cave", "warehouse")
PLAN_OPTIONS = ("size", "resolution")
START_RADIUS = 0.3
"""A start is drawn where a robot of this radius [m] has room, or of its own if that is greater."""
DRAWS = 100
"""So many starts are drawn for a robot that is to have room beside others."""

_SEED = pytest.StashKey[int]()
_FACTORIES = pytest.StashKey["list[SimulationFactory]"]()


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
    request.node.stash.setdefault(_FACTORIES, []).append(factory)
    yield factory
    factory.close()


@pytest.fixture
def robot_world(simulation: SimulationFactory) -> Simulation:
    """A simulation made as the marker says, of a generated office if there is none."""
    return simulation()


@pytest.fixture
def floor_plan(request: pytest.FixtureRequest) -> Any:
    """A factory of maps: `floor_plan(kind, seed=, size=, resolution=)`; what is left out is as the marker says."""
    settings = _settings(request)
    marked = settings.get("map")
    usual = marked if marked in KINDS else "office"

    def make(kind: str = usual, *, seed: int | None = None, **options: Any) -> OccupancyGrid:
        from ..maps.floor_plans import floor_plan

        options = {**{name: settings[name] for name in PLAN_OPTIONS if name in settings}, **options}
        return floor_plan(kind, seed=settings["seed"] if seed is None else seed, **options)

    return make


class SimulationFactory:
    """Makes the simulations of one test, and keeps what a report of it needs."""

    def __init__(self, request: pytest.FixtureRequest, folder: Path) -> None:
        self._settings = _settings(request)
        self._when: str = request.config.getoption("--simulator-record")
        self._folder = folder
        self._made: list[tuple[Simulation, Path, DeferredRecorder]] = []
        self._own_seeds: list[int] = []

    @property
    def own_seeds(self) -> list[int]:
        """Seeds of simulations that the test named itself."""
        return self._own_seeds

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
        from ..recording.deferred import DeferredRecorder
        from ..simulation.simulation import Simulation

        settings = self._settings
        if seed is None:
            seed = settings["seed"]
        else:
            self._own_seeds.append(seed)
        start = settings.get("start") if start is None and robots is None else start
        robots = settings.get("robots") if robots is None and start is None else robots
        grid = self._grid(settings.get("map", "office") if map is None else map, seed, plan)
        parameters = {**settings.get("parameters", {}), **(parameters or {})}
        if robots is not None and not isinstance(robots, Mapping):
            robots = _draw_all(grid, robots, parameters, seed)
        elif robots is None and start is None:
            start = _draw_all(grid, [""], parameters, seed)[""]
        made = Simulation(grid, parameters=parameters, seed=seed, start=start, robots=robots)
        folder = self._folder / ("simulation" if not self._made else f"simulation-{len(self._made) + 1}")
        spool = DeferredRecorder(folder)
        if self._when != "never":
            made.picture = folder / "drive.png"
            made.record(spool.take)
        self._made.append((made, folder, spool))
        return made

    def leave(self) -> list[str]:
        """Write recordings and pictures; says where they are, or why there is none."""
        lines = []
        for made, folder, spool in self._made:
            if self._when == "never":
                continue
            folder.mkdir(parents=True, exist_ok=True)
            try:
                lines.append(f"recording: {spool.leave()}")
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
        for made, _, spool in self._made:
            made.close()
            spool.drop()

    def _grid(self, map: OccupancyGrid | str | Path, seed: int, plan: Mapping[str, Any]) -> OccupancyGrid:
        unknown = [name for name in plan if name not in PLAN_OPTIONS]
        if unknown:
            raise TypeError(f"simulation takes {', '.join(KEYWORDS)}, got {', '.join(unknown)}")
        if isinstance(map, str) and map in KINDS:
            from ..maps.floor_plans import floor_plan

            options = {name: value for name, value in self._settings.items() if name in PLAN_OPTIONS}
            return floor_plan(map, seed=seed, **{**options, **plan})
        if plan:
            raise ValueError(f"{' and '.join(plan)} can be given for a floor plan only, got {map!r} for a map")
        if not isinstance(map, (str, Path)):
            return map
        from ..maps.map_files import load_map

        try:
            return load_map(map)
        except FileNotFoundError as error:
            near = difflib.get_close_matches(str(map), KINDS, n=1)
            hint = f"; did you mean {near[0]!r}?" if near else ""
            kinds = f"no such map file, nor a floor plan of this kind ({', '.join(KINDS)}){hint}"
            raise FileNotFoundError(error.errno, kinds, str(map)) from error


@pytest.hookimpl(hookwrapper=True, tryfirst=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Iterator[None]:
    """Add to the report of a failure what repeats it, and what was left to look at."""
    outcome: Any = yield
    report: pytest.TestReport = outcome.get_result()
    seed = item.stash.get(_SEED, None)
    if not report.failed or seed is None:
        return
    factories = item.stash.get(_FACTORIES, [])
    own = sorted({str(own) for factory in factories for own in factory.own_seeds} - {str(seed)})
    # The item's name begins at the root of the tests, the command where pytest was called.
    path = os.path.relpath(item.path, item.config.invocation_params.dir)
    node = shlex.quote("::".join([path, *item.nodeid.split("::")[1:]]))
    lines = [
        f"seed: {seed}" + (f"; the test itself gives {', '.join(own)}" if own else ""),
        f"repeat with: pytest {node} --simulator-seed {seed}",
    ]
    if report.when != "teardown":
        lines += [line for factory in factories for line in factory.leave()]
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
    request.node.stash[_SEED] = settings["seed"]
    return settings


def _seed(text: str) -> int:
    if not text.isdecimal() or int(text) >= 2**63:
        raise ValueError(text)
    return int(text)


def _draw_all(grid: OccupancyGrid, names: Sequence[str], parameters: Mapping[str, Any], seed: int) -> dict[str, PoseLike]:
    """A start for each of some robots, with room for its footprint and apart from the others."""
    from ..parameters import RobotParameters, for_node
    from ..simulation.namespaces import of_namespace

    if isinstance(names, str) or len(set(names)) < len(names):
        raise ValueError(f"robots must have names of their own, got {names!r}")
    placed: dict[str, tuple[Pose, float]] = {}
    for index, name in enumerate(names):
        shape = for_node(RobotParameters, of_namespace(name, parameters)).shape
        reach = START_RADIUS if shape is None else max(START_RADIUS, shape.reach)
        for draw in range(DRAWS):
            pose = grid.draw_free_pose(radius=reach, seed=(seed + index + draw * len(names)) % 2**64)
            if all(math.hypot(pose.x - other.x, pose.y - other.y) > reach + far for other, far in placed.values()):
                break
        else:
            raise ValueError(f"no room was found for robot {name} beside {', '.join(placed)}: give robots their poses")
        placed[name] = pose, reach
    return {name: pose for name, (pose, _) in placed.items()}
