"""The pytest plugin: simulations and maps as fixtures, and failures that can be repeated and inspected.

Fixtures: `simulation` makes simulations, `floor_plan` makes maps, and `robot_world` is one simulation with the settings of
the test's markers. The report of a failed test shows the seed and a command that repeats the test. It also names the files
of a recording and a picture of each simulation, which are saved in the test's folder (tmp_path).
"""

from __future__ import annotations

import os
import shlex
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from .simulation_factory import KEYWORDS, PLAN_OPTIONS, SimulationFactory

# pytest loads this module at every start, in all projects. To keep that fast, functions import other modules when needed.
if TYPE_CHECKING:
    from .._core import OccupancyGrid
    from ..simulation.simulation import Simulation

MARKER = "simulator"

_SEED_END = 2**63
"""End of the range of seeds: a parameter of ROS holds a signed 64-bit integer."""

_SEED = pytest.StashKey[int]()
_FACTORIES = pytest.StashKey[list[SimulationFactory]]()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Adds the options of the simulator."""
    group = parser.getgroup("mobile robot simulator")
    group.addoption(
        "--simulator-seed",
        type=_seed,
        metavar="N",
        help="seed of simulations and floor plans; replaces the seeds of markers",
    )
    group.addoption(
        "--simulator-record",
        choices=("never", "on-failure", "always"),
        default="on-failure",
        help="when to save a recording (MCAP) and a picture of each simulation in the test's folder (default: on-failure)",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Registers the marker."""
    config.addinivalue_line(
        "markers",
        f"{MARKER}({', '.join(f'{name}=...' for name in KEYWORDS)}): "
        "settings of the simulations and floor plans that the fixtures of mobile_robot_simulator make",
    )


@pytest.fixture
def simulation(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[SimulationFactory]:
    """A function that makes simulations: `simulation(map, parameters=, seed=, start=, robots=, size=, resolution=)`.

    The map is the kind of a floor plan, a map file or a grid. An argument that the test does not pass is taken from the
    test's markers. By default, the map is a generated office and start poses are random, in free space. `robots` can be a
    list of names, which get random start poses. All simulations are closed when the test ends. See `SimulationFactory`.
    """
    factory = SimulationFactory(_settings(request), request.config.getoption("--simulator-record"), tmp_path)
    request.node.stash.setdefault(_FACTORIES, []).append(factory)
    yield factory
    factory.close()


@pytest.fixture
def robot_world(simulation: SimulationFactory) -> Simulation:
    """A simulation with the settings of the test's markers, in a generated office by default."""
    try:
        return simulation()
    except (TypeError, ValueError, OSError) as error:
        # All arguments come from markers, so that a traceback would show only code of the simulator.
        pytest.fail(f"the settings of the marker {MARKER} are refused: {error}", pytrace=False)


@pytest.fixture
def floor_plan(request: pytest.FixtureRequest) -> Callable[..., OccupancyGrid]:
    """A function that generates maps: `floor_plan(kind, seed=, size=, resolution=)`.

    An argument that the test does not pass is taken from the test's markers. The default kind is an office.
    """
    from ..maps.floor_plans import KINDS
    from ..maps.floor_plans import floor_plan as generate

    settings = _settings(request)
    marked = settings.get("map")
    default = marked if isinstance(marked, str) and marked in KINDS else "office"

    def make(kind: str = default, *, seed: int | None = None, **options: Any) -> OccupancyGrid:
        options = {**{name: settings[name] for name in PLAN_OPTIONS if name in settings}, **options}
        return generate(kind, seed=settings["seed"] if seed is None else seed, **options)

    return make


@pytest.hookimpl(hookwrapper=True, tryfirst=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Iterator[None]:
    """Adds the seed, the command that repeats the test, recordings and pictures to the report of a failed test."""
    outcome: Any = yield
    report: pytest.TestReport = outcome.get_result()
    seed = item.stash.get(_SEED, None)
    if seed is not None and report.when == "setup":
        item.user_properties.append(("simulator_seed", seed))
    if not report.failed or seed is None:
        return
    factories = item.stash.get(_FACTORIES, [])
    own = sorted({str(own) for factory in factories for own in factory.own_seeds} - {str(seed)})
    # Node ids are relative to pytest's root folder, but the command must work in the folder where pytest was called.
    path = os.path.relpath(item.path, item.config.invocation_params.dir)
    node = shlex.quote("::".join([path, *item.nodeid.split("::")[1:]]))
    lines = [
        f"seed: {seed}" + (f"; the test also uses seeds of its own: {', '.join(own)}" if own else ""),
        f"repeat with: pytest {node} --simulator-seed {seed}",
    ]
    if report.when != "teardown":
        saved = [line for factory in factories for line in factory.save()]
        item.user_properties += [(f"simulator_{what}", path) for what, _, path in (line.partition(": ") for line in saved)]
        lines += saved
    report.sections.append(("mobile robot simulator", "\n".join(lines)))


def _settings(request: pytest.FixtureRequest) -> dict[str, Any]:
    """Returns the settings of a test's markers by name.

    The marker nearest to the test has priority. The seed of the command line has priority over all markers. The default seed
    is 0.
    """
    settings: dict[str, Any] = {}
    for marker in request.node.iter_markers(MARKER):
        unknown = [name for name in marker.kwargs if name not in KEYWORDS]
        if marker.args or unknown:
            got = ", ".join([*map(repr, marker.args), *unknown])
            pytest.fail(f"the marker {MARKER} takes the keywords {', '.join(KEYWORDS)}, got {got}", pytrace=False)
        settings = {**marker.kwargs, **settings}
    given = request.config.getoption("--simulator-seed")
    seed = settings["seed"] = given if given is not None else settings.get("seed", 0)
    if not isinstance(seed, int) or isinstance(seed, bool) or not 0 <= seed < _SEED_END:
        pytest.fail(f"the seed of the marker {MARKER} must be an integer from 0 to 2**63 - 1, got {seed!r}", pytrace=False)
    request.node.stash[_SEED] = seed
    return settings


def _seed(text: str) -> int:
    if not text.isdecimal() or int(text) >= _SEED_END:
        raise ValueError(text)
    return int(text)
