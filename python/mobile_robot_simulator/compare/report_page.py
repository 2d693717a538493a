"""Report page: the results of a comparison as one HTML page with its pictures inside."""

from __future__ import annotations

import base64
import math
from collections.abc import Callable, Iterable, Sequence
from html import escape

import numpy as np

from .breakdown import WRONG, Band
from .comparison import Comparison
from .noise_fit import PARAMETERS

_UNIT = "measured - simulated [m]"

_DPI = 150  # of the map

_STYLE = """
:root { color-scheme: light; }
body { font: 15px/1.5 system-ui, sans-serif; color: #262a33; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.15rem; margin-top: 2.2rem; }
p.file { overflow-wrap: anywhere; margin: 0; color: #5b6270; }
table { border-collapse: collapse; margin: 0.8rem 0; } th { text-align: left; font-weight: 600; }
td, th { padding: 0.2rem 1.1rem 0.2rem 0; border-bottom: 1px solid #e2e5e9; font-variant-numeric: tabular-nums; }
img { max-width: 100%; height: auto; display: block; }
"""


def html_report(comparison: Comparison, map_name: str) -> str:
    """Returns an HTML page that needs no other file. Without Matplotlib, it has no pictures, and says so.

    Args:
        comparison: The results.
        map_name: Name of the map.
    """
    try:
        pictures = _pictures(comparison)
    except ImportError as error:
        pictures = dict.fromkeys(
            ("map", "histogram", "range", "incidence", "beam"), f"<p>No picture: {escape(str(error))}</p>"
        )
    breakdown = comparison.breakdown
    parts = [
        "<h1>Comparison of a log with its map</h1>",
        f'<p class="file">log: {escape(str(comparison.log.path))}</p><p class="file">map: {escape(map_name)}</p>',
        _summary(comparison),
        *(f"<p>{escape(note)}</p>" for note in comparison.log.notes),
        "<h2>Where the simulation is wrong</h2>",
        "<p>A dot where each real beam ended. Red: it is more than 0.1 m nearer than simulated, because something stands "
        "there that the map does not have. Blue: it is farther, because the map has something before it that is not "
        "there.</p>",
        pictures["map"],
        _places(comparison),
        "<h2>Residuals</h2>",
        "<p>A residual is a measured range less the simulated one.</p>",
        pictures["histogram"],
        "<h2>By range</h2>",
        pictures["range"],
        _bands("simulated range", breakdown.by_range, _range_name),
        "<h2>By incidence</h2>",
        "<p>The angle between the beam and the normal of the simulated wall: 0° for a beam at right angles to it.</p>",
        pictures["incidence"],
        _bands("incidence", breakdown.by_incidence, _angle_name),
        "<h2>By beam</h2>",
        pictures["beam"],
        _noise(comparison),
    ]
    head = (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>Comparison</title><style>{_STYLE}</style></head>'
    )
    page = f"{head}\n<body>\n{chr(10).join(parts)}\n</body></html>\n"
    return page.encode("utf-8", "replace").decode()  # a file's name may have bytes that are not UTF-8


def _pictures(comparison: Comparison) -> dict[str, str]:
    """Returns the images of the page as HTML, by name.

    Raises:
        ImportError: Matplotlib is not installed.
    """
    from ..plotting import ResidualPicture
    from ..plotting.charts import bands_png, beams_png, histogram_png

    breakdown, residuals = comparison.breakdown, comparison.residuals
    values = residuals.values[~np.isnan(residuals.values)]
    edges, counts = residuals.histogram()
    place = ResidualPicture(comparison.grid, comparison.poses, comparison.ends(), values)

    def of_bands(bands: Sequence[Band], names: list[str], label: str) -> bytes:
        medians, mads = [band.spread.median for band in bands], [band.spread.mad for band in bands]
        return bands_png(names, medians, mads, label=label, unit=_UNIT)

    by_range, by_incidence = breakdown.by_range, breakdown.by_incidence
    beams = breakdown.by_beam
    return {
        "map": _image(place.to_png(dpi=_DPI), "map with a dot where each beam ended"),
        "histogram": _image(histogram_png(edges, counts, unit=_UNIT), "histogram of the residuals"),
        "range": _image(of_bands(by_range, [_range_name(band) for band in by_range], "simulated range"), "by range"),
        "incidence": _image(
            of_bands(by_incidence, [_angle_name(each) for each in by_incidence], "incidence"), "by incidence"
        ),
        "beam": _image(beams_png([each.median for each in beams], [each.mad for each in beams], unit=_UNIT), "by beam"),
    }


def _image(png: bytes, text: str) -> str:
    return f'<img alt="{escape(text)}" src="data:image/png;base64,{base64.b64encode(png).decode()}">'


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = ["<tr>" + "".join(f"<th>{escape(cell)}</th>" for cell in head) + "</tr>"] if head else []
    lines += ["<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows]
    return f"<table>{''.join(lines)}</table>"


def _summary(comparison: Comparison) -> str:
    spread, counts = comparison.residuals.spread, comparison.residuals.counts
    total = sum(counts.values())
    rows = [
        ("scans", f"{len(comparison.log.ranges)} of {len(comparison.log.angles)} beams"),
        ("beams with a return in both", f"{counts['both'] / total:.1%}"),
        ("in the log only", f"{counts['log_only'] / total:.1%}"),
        ("in the simulation only", f"{counts['simulation_only'] / total:.1%}"),
        ("median of the residuals", f"{spread.median:+.3f} m"),
        ("MAD of the residuals", f"{spread.mad:.3f} m"),
        *((f"within {near:.2f} m", f"{share:.1%}") for near, share in spread.within.items()),
    ]
    if comparison.offset:
        rows.append(("subtracted from the readings", f"{comparison.offset:+.3f} m"))
    if (alignment := comparison.alignment) is not None:
        (x, y), yaw = alignment.shift, math.degrees(alignment.yaw)
        rows.append(("alignment of the log", f"{x:+.3f} m, {y:+.3f} m, {yaw:+.2f}°"))
        rows.append(("mean error of the beams by that", f"{alignment.error_before:.3f} to {alignment.error_after:.3f} m"))
    if (refinement := comparison.refinement) is not None:
        yaw = math.degrees(np.median(np.abs(refinement.changes[:, 2])))
        rows.append(("refinement of the poses, median", f"{np.median(refinement.distances):.3f} m, {yaw:.2f}°"))
        before, after = refinement.errors_before.mean(), refinement.errors_after.mean()
        rows.append(("mean error of the beams by that", f"{before:.3f} to {after:.3f} m"))
    return _table((), rows)


def _places(comparison: Comparison) -> str:
    places = comparison.breakdown.places
    if not places:
        return f"<p>No residual is larger than {WRONG:g} m.</p>"
    rows = [(f"{each.x:.2f}, {each.y:.2f}", f"{each.wrong} of {each.count}", f"{each.median:+.3f} m") for each in places]
    return _table(("square of 0.5 m at x, y [m]", f"beams wrong by more than {WRONG:g} m", "their median residual"), rows)


def _range_name(band: Band) -> str:
    return f"{band.low:g} to {band.high:g} m" if math.isfinite(band.high) else f"from {band.low:g} m"


def _angle_name(band: Band) -> str:
    return f"{math.degrees(band.low):.0f} to {math.degrees(band.high):.0f}°"


def _bands(what: str, bands: Sequence[Band], name: Callable[[Band], str]) -> str:
    rows = [
        (
            name(band),
            f"{band.spread.count}",
            f"{band.spread.median:+.3f} m",
            f"{band.spread.mad:.3f} m",
            *(f"{share:.1%}" for share in band.spread.within.values()),
        )
        for band in bands
    ]
    return _table((what, "beams", "median", "MAD", "within 0.05 m", "0.10 m", "0.20 m"), rows)


def _noise(comparison: Comparison) -> str:
    noise = comparison.noise
    if noise is None:
        return ""
    models = {"fit": noise.fit, "fit with offset": noise.offset_fit}
    fits = [(name, *(f"{getattr(fit.model, each):.4g}" for each in PARAMETERS)) for name, fit in models.items()]
    cells = noise.offset / comparison.grid.resolution
    unsure = f" The readings do not determine {', '.join(noise.fit.unidentified)}." if noise.fit.unidentified else ""
    scores = [
        (name, f"{score.log_likelihood:+.3f}" if not score.impossible else f"{score.impossible} readings are impossible")
        for name, score in noise.scores.items()
    ]
    return (
        "<h2>Noise of the scanner</h2>"
        f"<p>The beam model of the even scans. By greatest likelihood, real returns lie {noise.offset:+.3f} m "
        f"({cells:+.1f} cells) behind simulated ones, since walls on maps are thick.{escape(unsure)}</p>"
        + _table(("", *PARAMETERS), fits)
        + f"<p>Test on the {noise.test_count} readings of the odd scans:</p>"
        + _table(("model", "log-likelihood per reading"), scores)
    )
