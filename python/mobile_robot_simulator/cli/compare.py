"""The command `compare`: how far the scans of a log are from simulated ones."""

from __future__ import annotations

import errno
import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..new_files import write_files
from .console import print_note, print_table, stage_bar
from .options import Assignments, MapFile, ParamsFile, RosArgs, load_grid, read_values
from .signals import signals_as_interrupt

if TYPE_CHECKING:
    from ..compare import Comparison

REPORT = "report.json"
"""File with the results in the folder given to --out."""

BEAMS = {
    "both": "return in both",
    "log_only": "return in the log only",
    "simulation_only": "return in the simulation only",
    "none": "return in neither",
    "near": "below the smallest range",
    "failed": "failed measurements",
}
"""Words for what became of a beam."""


def compare(
    map_file: MapFile,
    log: Annotated[
        Path, typer.Argument(metavar="LOG", help="CARMEN log, ROS 1 or ROS 2 bag, MCAP file, CSV file or NumPy archive.")
    ],
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help=f"Folder for {REPORT}. It is made if it does not exist.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the results as JSON.")] = False,
    scanner: Annotated[
        str | None, typer.Option(help="Topic of the scans in a bag, or word that begins a CARMEN line.")
    ] = None,
    pose_topic: Annotated[str | None, typer.Option(help="Topic of the poses in a bag. Without it: transforms.")] = None,
    max_range: Annotated[
        float | None, typer.Option(help="Range from which on a beam has no return, in metres. Bags have it in each scan.")
    ] = None,
    param: Assignments = None,
    params_file: ParamsFile = None,
    ros_args: RosArgs = False,
) -> None:
    """Compare the scans of a log with scans that are simulated at the same poses of a map.

    A residual is a measured range less the simulated one. Of the parameters, only `unknown` has an effect.
    """
    from ..compare import compare_log
    from ..logs import read_log

    with signals_as_interrupt():
        if out is not None:
            _check_folder(out)
        grid = load_grid(map_file, read_values(param, params_file))
        scans = read_log(log, scanner=scanner, pose_topic=pose_topic, max_range=max_range)
        for note in scans.notes:
            print_note(f"{log}: {note}")
        with stage_bar() as progress:
            comparison = compare_log(grid, scans, progress=progress)
        report = {"map": str(map_file), **comparison.report()}
        if out is not None:
            out.mkdir(parents=True, exist_ok=True)
            write_files({out / REPORT: (json.dumps(report, indent=2, allow_nan=False) + "\n").encode()})
    if as_json:
        print(json.dumps(report, allow_nan=False))
    else:
        print_table(f"{map_file}, {log}", _rows(comparison) + ([("report", f"{out / REPORT}")] if out is not None else []))


def _rows(comparison: Comparison) -> list[tuple[str, str]]:
    """Returns the rows of a table of the results."""
    residuals = comparison.residuals
    spread, total = residuals.spread, sum(residuals.counts.values())
    rows = [("scans", f"{len(comparison.log.ranges)} of {len(comparison.log.angles)} beams")]
    rows += [(BEAMS[kind], f"{count / total:.1%} of the beams") for kind, count in residuals.counts.items() if count]
    rows += [("residual, median", _signed(spread.median)), ("residual, MAD", f"{spread.mad:.3f} m")]
    rows += [(f"within {near:.2f} m", f"{share:.1%}") for near, share in spread.within.items()]
    return rows


def _signed(metres: float) -> str:
    return f"{round(metres, 3) + 0.0:+.3f} m"  # not -0.000


def _check_folder(out: Path) -> None:
    """Checks, before the long work, that a folder can be made.

    Raises:
        NotADirectoryError: There is a file of this name, or of that of a folder above.
    """
    existing = next((each for each in (out, *out.parents) if each.exists()), None)
    if existing is not None and not existing.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, "Must be a folder", str(existing))
