"""The command `live`: see a simulation in the browser and drive in it."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .._core import OccupancyGrid, Pose
from ..recording.format import Format
from .console import console, print_note
from .options import (
    Assignments,
    FaultTexts,
    ParamsFile,
    Resolution,
    RosArgs,
    Seed,
    Unit,
    check_positive,
    load_grid,
    pose_of,
    read_faults,
    read_values,
    seed_of,
)
from .signals import signals_as_interrupt

if TYPE_CHECKING:
    from ..live import LiveView
    from ..live.page_view import PageView

PLAN = "office"
"""Floor plan that is shown without a map."""


class DriverName(str, Enum):
    """Who drives at first."""

    viewer = "viewer"
    wander = "wander"


def live(
    map_file: Annotated[
        Path | None,
        typer.Argument(
            metavar="[MAP|RECORDING]",
            help="Map file, as for run, or a bag or MCAP file to play. Without it: a generated office.",
        ),
    ] = None,
    duration: Annotated[
        float | None, typer.Option(help="End after so many simulated seconds. Without it: at Ctrl-C.")
    ] = None,
    start: Annotated[
        tuple[float, float, float] | None,
        typer.Option(metavar="X Y YAW", help="Start pose in the map frame. Without it and initial_pose: a random one."),
    ] = None,
    commands: Annotated[
        Path | None,
        typer.Option(help="CSV file of commands with the columns time, vx, vy, wz. Keys and the pad take the robot over."),
    ] = None,
    driver: Annotated[DriverName, typer.Option(help="Who drives at first, without --commands.")] = DriverName.viewer,
    radius: Annotated[
        float, typer.Option(help="Radius of the footprint in metres. Contact stops the robot; see -p contact:=report.")
    ] = 0.2,
    out: Annotated[Path, typer.Option(help="Folder for the recordings that are started on the page.")] = Path("live"),
    seed: Seed = None,
    format: Annotated[Format, typer.Option(help="Recording format: mcap or sqlite3 for ROS 2, bag for ROS 1.")] = "mcap",
    real_time: Annotated[
        bool, typer.Option("--real-time", help="Accepted as by run. The view always keeps to speed_factor times real time.")
    ] = False,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace recordings of the same name.")] = False,
    resolution: Resolution = None,
    unit: Unit = None,
    fault: FaultTexts = None,
    param: Assignments = None,
    params_file: ParamsFile = None,
    ros_args: RosArgs = False,
    host: Annotated[
        str, typer.Option(help="Address to listen on. If others can reach it, the address of the page contains a token.")
    ] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port of the page; 0 chooses a free one.")] = 8090,
    open_browser: Annotated[bool, typer.Option("--open", help="Open the page in the browser of this machine.")] = False,
    paused: Annotated[bool, typer.Option("--paused", help="Start with the time stopped.")] = False,
    foxglove: Annotated[
        bool, typer.Option("--foxglove", help="Also start a server for the Foxglove app, on this machine only.")
    ] = False,
    foxglove_port: Annotated[
        int, typer.Option(min=0, max=65535, help="Port of the server for the Foxglove app; 0 chooses a free one.")
    ] = 8765,
) -> None:
    """See a simulation in the browser: drive, place things, change parameters, record. Or play a recording there.

    Prints the address of the page. Ctrl-C ends the simulation.
    """
    from ..drivers.script import Script
    from ..live import LiveView
    from ..live.autopilot import ScriptPilot, WanderPilot
    from ..logs.reader import is_bag
    from ..maps import floor_plan
    from ..parameter_files import read_fault_texts
    from ..simulation.simulation import Simulation
    from .drive import has_outline, usual_start

    check_positive("--radius", radius)
    if duration is not None:
        check_positive("--duration", duration)
    if map_file is not None and map_file.exists() and is_bag(map_file):
        simulated = {
            "--duration": duration,
            "--start": start,
            "--commands": commands,
            "--driver": driver != DriverName.viewer,
            "--seed": seed is not None,
            "--resolution": resolution is not None,
            "--unit": unit is not None,
            "--fault": fault,
            "--param": param,
            "--params-file": params_file,
            "--foxglove": foxglove,
        }
        if given := [name for name, value in simulated.items() if value]:
            raise ValueError(f"{map_file} is a recording, so there is no simulation for {', '.join(given)}")
        with signals_as_interrupt():
            _play(map_file, host=host, port=port, paused=paused, open_browser=open_browser)
        return
    lengths = {name: value for name, value in (("resolution", resolution), ("unit", unit)) if value is not None}
    if map_file is None and lengths:
        raise ValueError(f"a generated office is no file, so it takes no {' and no '.join(f'--{name}' for name in lengths)}")
    with signals_as_interrupt():
        values = read_values(param, params_file)
        texts = [*(fault or ()), *(read_fault_texts(params_file) if params_file is not None else ())]
        faults = read_faults(texts)
        grid = load_grid(map_file, values, **lengths) if map_file is not None else floor_plan(PLAN, seed=1)
        script = Script.read(commands) if commands else None
        chosen_seed = seed_of(seed, values)
        pose = usual_start(grid, values, pose_of(start, "--start") if start else None, radius, chosen_seed)
        if not has_outline(values):
            values = {"robot_radius": radius, **values}
        simulation = Simulation(grid, parameters=values, seed=chosen_seed, start=pose)
        for each in faults:
            simulation.add_fault(each)
        source = _source(map_file, lengths, grid, values, chosen_seed, pose, texts)
        view = LiveView(
            simulation,
            host=host,
            port=port,
            folder=out,
            format=format,
            overwrite=overwrite,
            title=map_file.stem if map_file is not None else f"a generated {PLAN}",
            source=source,
            paused=paused,
        )
        name = next(iter(simulation.robots))
        if script is not None:
            view.session.pilots.engage(name, ScriptPilot(simulation, script))
        elif driver == DriverName.wander:
            view.session.pilots.engage(name, WanderPilot(simulation, name, chosen_seed))
        _announce(view, "simulation", open_browser=open_browser)
        if not foxglove:
            _run(view, duration)
            return
        with view:
            from ..foxglove import FoxgloveServer

            with FoxgloveServer(simulation, port=foxglove_port) as server:
                console.print(f"Foxglove: {server.url}", markup=False, highlight=False, soft_wrap=True)
                _run(view, duration, server.turn)


def _play(recording: Path, *, host: str, port: int, paused: bool, open_browser: bool) -> None:
    """Shows a recording until Ctrl-C."""
    from ..live.replay_view import ReplayView

    with ReplayView(recording, host=host, port=port, paused=paused) as view:
        for note in view.replay.playback.notes:
            print_note(f"{recording}: {note}")
        _announce(view, "view", open_browser=open_browser)
        view.run()


def _announce(view: PageView, what: str, *, open_browser: bool) -> None:
    """Prints the address of a page, and opens it in the browser of this machine if that is wanted."""
    console.print(f"Live view: {view.url}", markup=False, highlight=False, soft_wrap=True)
    if open_browser:
        view.open_browser()
    else:
        print_note(f"Open this address in a browser. Ctrl-C ends the {what}.")


def _run(view: LiveView, duration: float | None, turn: Callable[[], None] = lambda: None) -> None:
    """Runs until Ctrl-C or until a simulated time [s], then closes the view. Calls `turn` often meanwhile."""
    try:
        while duration is None or view.session.simulation.time < duration:
            view.run(0.02)
            turn()
    finally:
        view.close()


def _source(
    map_file: Path | None,
    lengths: dict[str, float],
    grid: OccupancyGrid,
    values: dict[str, Any],
    seed: int,
    start: Pose | None,
    faults: list[str],
) -> str:
    """Returns Python statements that create the simulation."""
    made = f"mrs.floor_plan({PLAN!r}, seed=1)"
    if map_file is not None:
        given = "".join(f", {name}={value!r}" for name, value in lengths.items())
        made = f"mrs.load_map({str(map_file.resolve())!r}, unknown={grid.unknown!r}{given})"
    pose = "" if start is None else f", start={tuple(start)!r}"
    lines = [
        f"grid = {made}",
        f"sim = mrs.Simulation(grid, parameters={values!r}, seed={seed}{pose})",
        *(f"sim.add_fault(mrs.faults.{text.strip()})" for text in faults),
    ]
    return "\n".join(lines)
