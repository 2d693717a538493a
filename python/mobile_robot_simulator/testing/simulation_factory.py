"""SimulationFactory: makes the simulations of a test, and saves recordings and pictures of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..quoting import nearest, quoted
from .start_poses import draw_start_poses

# pytest loads this module at every start, in all projects. To keep that fast, functions import other modules when needed.
if TYPE_CHECKING:
    from .._core import OccupancyGrid
    from ..physics.obstacles import PoseLike
    from ..recording.deferred import DeferredRecorder
    from ..scenarios.world import World
    from ..simulation.simulation import Simulation

KEYWORDS = ("map", "parameters", "seed", "start", "robots", "size", "resolution")
"""Keywords of the marker."""

PLAN_OPTIONS = ("size", "resolution")
"""Keywords that apply only to generated floor plans."""


@dataclass(frozen=True)
class MadeSimulation:
    """A simulation made for a test.

    Attributes:
        simulation: The simulation.
        folder: Folder for its recording and its picture.
        recorder: Recorder that keeps its messages until the test ends.
    """

    simulation: Simulation
    folder: Path
    recorder: DeferredRecorder

    @property
    def picture(self) -> Path:
        """File for the picture."""
        return self.folder / "drive.png"


class SimulationFactory:
    """Makes the simulations of one test, and saves recordings and pictures of them.

    Args:
        settings: Settings of the test's markers by name. They replace arguments that the test does not pass. `seed` is
            required.
        record: When to save recordings and pictures: "never", "on-failure" or "always".
        folder: Folder in which they are saved.
    """

    def __init__(self, settings: Mapping[str, Any], record: str, folder: Path) -> None:
        self._settings, self._record, self._folder = settings, record, folder
        self._made: list[MadeSimulation] = []
        self._own_seeds: list[int] = []

    @property
    def own_seeds(self) -> list[int]:
        """Seeds that the test passed as arguments."""
        return self._own_seeds

    def __call__(
        self,
        map: OccupancyGrid | str | Path | World | None = None,
        *,
        parameters: Mapping[str, Any] | None = None,
        seed: int | None = None,
        start: PoseLike | None = None,
        robots: Mapping[str, PoseLike] | Sequence[str] | None = None,
        **plan: Any,
    ) -> Simulation:
        """Makes a simulation. Arguments that are not passed are taken from the test's markers.

        Args:
            map: Kind of a floor plan, map file, or grid; default: a generated office. A `World` has everything, so that
                no other argument can be given and markers have no effect.
            parameters: Values of the nodes' parameters by name, in addition to those of the markers.
            seed: Seed of the noise, of a generated floor plan and of random start poses.
            start: Start pose of the robot (x [m], y [m], yaw [rad]); default: random, in free space.
            robots: Start poses of several robots by name, or only their names for random start poses.
            **plan: `size` and `resolution` of a generated floor plan.

        Raises:
            TypeError: An argument is unknown.
            ValueError: `size` or `resolution` is given for a map that is not generated, or `Simulation` refuses an argument.
            FileNotFoundError: The map is neither a kind of floor plan nor an existing file.
        """
        from ..scenarios.world import World
        from ..simulation.simulation import Simulation

        if isinstance(map, World):
            if plan or any(value is not None for value in (parameters, seed, start, robots)):
                raise ValueError("a World has all settings of the simulation: no other argument can be given")
            simulation = map.simulation()
            self._own_seeds.append(map.seed)
            self._keep_messages(simulation)
            return simulation
        settings = self._settings
        if seed is None:
            seed = settings["seed"]
        else:
            self._own_seeds.append(seed)
        if start is None and robots is None:
            start = settings.get("start")
            robots = settings.get("robots") if start is None else None
        grid = self._grid(settings.get("map", "office") if map is None else map, seed, plan)
        parameters = {**settings.get("parameters", {}), **(parameters or {})}
        if robots is not None and not isinstance(robots, Mapping):
            robots = draw_start_poses(grid, robots, parameters, seed)
        elif robots is None and start is None:
            start = draw_start_poses(grid, [""], parameters, seed)[""]
        simulation = Simulation(grid, parameters=parameters, seed=seed, start=start, robots=robots)
        self._keep_messages(simulation)
        return simulation

    def save(self) -> list[str]:
        """Saves a recording and a picture of each simulation.

        Returns:
            A line for each file, with its path or the reason why it was not saved. Empty if recording is off.
        """
        lines = []
        for made in self._made if self._record != "never" else []:
            made.folder.mkdir(parents=True, exist_ok=True)
            try:
                lines.append(f"recording: {made.recorder.save()}")
            except Exception as error:
                lines.append(f"no recording: {error}")
            try:
                made.simulation.draw(made.picture)
                lines.append(f"picture: {made.picture}")
            except Exception as error:
                lines.append(f"no picture: {error}")
        return lines

    def close(self) -> None:
        """Closes all simulations. Before that, saves recordings and pictures if `record` is "always"."""
        if self._record == "always":
            self.save()
        for made in self._made:
            made.simulation.close()
            made.recorder.discard()

    def _keep_messages(self, simulation: Simulation) -> None:
        """Keeps the messages of a new simulation, so that `save` can write a recording."""
        from ..recording.deferred import DeferredRecorder

        folder = self._folder / ("simulation" if not self._made else f"simulation-{len(self._made) + 1}")
        made = MadeSimulation(simulation, folder, DeferredRecorder(folder))
        if self._record != "never":
            simulation.picture = made.picture
            simulation.record_lazily(made.recorder.write)
        self._made.append(made)

    def _grid(self, map: OccupancyGrid | str | Path, seed: int, plan: Mapping[str, Any]) -> OccupancyGrid:
        """Returns the map: a grid as it is, a generated floor plan, or a map file."""
        from ..maps.floor_plans import KINDS, floor_plan

        unknown = [name for name in plan if name not in PLAN_OPTIONS]
        if unknown:
            raise TypeError(f"simulation takes {', '.join(KEYWORDS)}, got {', '.join(unknown)}")
        if isinstance(map, str) and map in KINDS:
            options = {name: value for name, value in self._settings.items() if name in PLAN_OPTIONS}
            return floor_plan(map, seed=seed, **{**options, **plan})
        if plan:
            raise ValueError(f"{' and '.join(plan)} can be given for a generated floor plan only, got the map {quoted(map)}")
        return _load(map) if isinstance(map, (str, Path)) else map


def _load(file: str | Path) -> OccupancyGrid:
    """Returns the map of a map file. If there is no such file, the error lists the kinds of floor plans."""
    from ..maps import load_map
    from ..maps.floor_plans import KINDS

    try:
        return load_map(file)
    except FileNotFoundError as error:
        near = nearest(str(file), KINDS)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        text = f"there is no such map file, and no such kind of floor plan ({', '.join(KINDS)}){hint}"
        raise FileNotFoundError(error.errno, text, str(file)) from error
