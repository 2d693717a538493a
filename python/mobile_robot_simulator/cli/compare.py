"""The command `compare`: how far the scans of a log are from simulated ones."""

from __future__ import annotations

import json
import math
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .console import print_note, print_table, stage_bar
from .options import Assignments, MapFile, ParamsFile, RosArgs, load_grid, read_values
from .signals import signals_as_interrupt

if TYPE_CHECKING:
    from ..compare import Comparison, NoiseFit, Spread

REPORT, PAGE = "report.json", "report.html"
"""Files with the results in the folder given to --out."""

NOISE = "noise.yaml"
"""File with the fitted beam model, for `run --params-file`, in that folder."""

PLACES = 3
"""Number of places that the table has."""

BEAMS = {
    "both": "return in both",
    "log_only": "return in the log only",
    "simulation_only": "return in the simulation only",
    "none": "return in neither",
    "near": "below the smallest range",
    "failed": "failed measurements",
}
"""Words for what became of a beam."""


class AlignName(str, Enum):
    """Ways to align a log with its map."""

    none = "none"
    rigid = "rigid"


def compare(
    map_file: MapFile,
    log: Annotated[
        Path, typer.Argument(metavar="LOG", help="CARMEN log, ROS 1 or ROS 2 bag, MCAP file, CSV file or NumPy archive.")
    ],
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help=f"Folder for {PAGE}, {REPORT} and {NOISE}. It is made if it does not exist."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the results as JSON.")] = False,
    align: Annotated[
        AlignName, typer.Option(help="Move the frame of the log to where it explains the scans best: rigid, or none.")
    ] = AlignName.rigid,
    reach: Annotated[
        tuple[float, float],
        typer.Option(metavar="SHIFT YAW", help="Largest shift in x and y, in metres, and largest yaw in radians."),
    ] = (1.0, 0.2),
    refine: Annotated[
        bool, typer.Option("--refine", help="Then move each scan to where it fits best, by at most 0.3 m and 0.09 rad.")
    ] = False,
    offset: Annotated[
        float, typer.Option(help="Length to subtract from the measured ranges, in metres, because walls in maps are thick.")
    ] = 0.0,
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
    from ..compare import compare_log, html_report, noise_text
    from ..logs import read_log
    from ..new_files import check_folder, write_files

    with signals_as_interrupt():
        if out is not None:
            check_folder(out)  # before the long work
        grid = load_grid(map_file, read_values(param, params_file))
        scans = read_log(log, scanner=scanner, pose_topic=pose_topic, max_range=max_range)
        for note in scans.notes:
            print_note(f"{log}: {note}")
        with stage_bar() as progress:
            comparison = compare_log(
                grid, scans, align=align.value, reach=reach, refine=refine, offset=offset, progress=progress
            )
        _note_limits(comparison)
        report = {"map": str(map_file), **comparison.report()}
        if out is not None:
            files = {PAGE: html_report(comparison, str(map_file))}
            files[REPORT] = json.dumps(report, indent=2, allow_nan=False) + "\n"
            if comparison.noise is not None:
                files[NOISE] = noise_text(comparison.noise, comparison.log)
            out.mkdir(parents=True, exist_ok=True)
            write_files({out / name: text.encode("utf-8", "surrogateescape") for name, text in files.items()})
    if as_json:
        print(json.dumps(report, allow_nan=False))
    else:
        print_table(f"{map_file}, {log}", _rows(comparison) + ([("report", f"{out / PAGE}")] if out is not None else []))


def _note_limits(comparison: Comparison) -> None:
    alignment, refinement = comparison.alignment, comparison.refinement
    if alignment is not None and alignment.is_at_limit:
        print_note("the alignment is at the limit of its reach; a larger --reach may find a better one")
    if refinement is not None and (count := int(refinement.is_at_limit.sum())):
        print_note(f"{count} of {len(refinement.poses)} refined poses are at the limit of 0.3 m or 0.09 rad")


def _rows(comparison: Comparison) -> list[tuple[str, str]]:
    """Returns the rows of a table of the results."""
    import numpy as np

    residuals = comparison.residuals
    spread, total = residuals.spread, sum(residuals.counts.values())
    alignment, refinement = comparison.alignment, comparison.refinement
    rows = [("scans", f"{len(comparison.log.ranges)} of {len(comparison.log.angles)} beams")]
    if alignment is not None:
        (x, y), yaw = alignment.shift, math.degrees(alignment.yaw)
        rows.append(("alignment", f"{_signed(x)}, {_signed(y)}, {round(yaw, 2) + 0.0:+.2f}°"))
        rows.append(("  mean error", f"{alignment.error_before:.3f} -> {alignment.error_after:.3f} m"))
    if refinement is not None:
        distance, yaw = np.median(refinement.distances), math.degrees(np.median(np.abs(refinement.changes[:, 2])))
        rows.append(("refinement, median", f"{distance:.3f} m, {yaw:.2f}°"))
        before, after = refinement.errors_before.mean(), refinement.errors_after.mean()
        rows.append(("  mean error", f"{before:.3f} -> {after:.3f} m"))
    rows += [(BEAMS[kind], f"{count / total:.1%} of the beams") for kind, count in residuals.counts.items() if count]
    rows += [("residual, median", _signed(spread.median)), ("residual, MAD", f"{spread.mad:.3f} m")]
    rows += [(f"within {near:.2f} m", f"{share:.1%}") for near, share in spread.within.items()]
    for band in comparison.breakdown.by_range:
        limits = f"{band.low:g} to {band.high:g} m" if math.isfinite(band.high) else f"from {band.low:g} m"
        rows.append((f"at {limits}", _spread(band.spread)))
    for band in comparison.breakdown.by_incidence:
        low, high = math.degrees(band.low), math.degrees(band.high)
        rows.append((f"incidence {low:.0f} to {high:.0f}°", _spread(band.spread)))
    for place in comparison.breakdown.places[:PLACES]:
        text = f"{place.wrong} of {place.count} beams, median {_signed(place.median)}"
        rows.append((f"wrong at {place.x:.2f}, {place.y:.2f}", text))
    if comparison.noise is not None:
        rows += _noise_rows(comparison.noise, comparison.grid.resolution)
    return rows


def _noise_rows(noise: NoiseFit, resolution: float) -> list[tuple[str, str]]:
    model, behind = noise.fit.model, noise.offset_fit.model
    weights = f"hit {model.z_hit:.3f}, short {model.z_short:.3f}, max {model.z_max:.3f}, rand {model.z_rand:.3f}"
    rows = [("fitted noise", f"sigma {model.sigma_hit:.4f} m, {weights}")]
    if noise.fit.unidentified:
        rows.append(("  not determined", ", ".join(noise.fit.unidentified)))
    cells = round(noise.offset / resolution, 1) + 0.0
    text = f"{_signed(noise.offset)} ({cells:+.1f} cells); sigma is then {behind.sigma_hit:.4f} m"
    rows.append(("offset of the walls", text))
    for name, score in noise.scores.items():
        text = f"{score.log_likelihood:+.3f} per reading"
        if score.impossible:
            text = f"none: {score.impossible} of {noise.test_count} readings are impossible"
        rows.append((f"log-likelihood, {name}", text))
    return rows


def _spread(spread: Spread) -> str:
    return f"median {_signed(spread.median)}, MAD {spread.mad:.3f} m"


def _signed(metres: float) -> str:
    return f"{round(metres, 3) + 0.0:+.3f} m"  # not -0.000
