"""report_page: one page that has everything and needs no other file."""

from __future__ import annotations

import base64
import io
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import mobile_robot_simulator as mrs
from compare.simulated_logs import free_poses, log_of, office
from mobile_robot_simulator.compare import compare_log, html_report

GRID = office()
POSES = free_poses(GRID, 20)
NOISE = mrs.BeamModel(sigma_hit=0.04, z_hit=0.9, z_rand=0.1, z_max=0.0)
LOG = log_of(GRID, POSES, noise=NOISE, said=POSES + np.array([0.1, 0.0, 0.0]))
COMPARISON = compare_log(GRID, LOG, refine=True)
VOID = ("meta", "img", "br")


class Page(HTMLParser):
    """Checks that elements are closed in order, and keeps the cells of tables and the sources of images."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.cells: list[str] = []
        self.sources: list[str] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.sources += [value or "" for name, value in attrs if name in ("src", "href")]
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] == "td":
            self.cells.append(data)


def test_the_page_has_the_results() -> None:
    cells = Page(html_report(COMPARISON, "map.yaml")).cells
    spread, noise = COMPARISON.residuals.spread, COMPARISON.noise
    assert noise is not None and COMPARISON.alignment is not None
    for expected in (
        f"{spread.median:+.3f} m",
        f"{spread.mad:.3f} m",
        f"{spread.within[0.05]:.1%}",
        f"{COMPARISON.alignment.error_before:.3f} to {COMPARISON.alignment.error_after:.3f} m",
        f"{noise.fit.model.sigma_hit:.4g}",
        f"{noise.scores['AMCL'].log_likelihood:+.3f}",
        "75 to 90°",
    ):
        assert expected in cells, expected
    assert sum(bool(re.fullmatch(r"\d+ of \d+", cell)) for cell in cells) == len(COMPARISON.breakdown.places) > 3


def test_the_pictures_are_inside() -> None:
    pytest.importorskip("matplotlib", reason="the extra `plotting` is not installed")
    sources = Page(html_report(COMPARISON, "map.yaml")).sources
    assert len(sources) == 5 and all(source.startswith("data:image/png;base64,") for source in sources)
    sizes = [Image.open(io.BytesIO(base64.b64decode(source.partition(",")[2]))).size for source in sources]
    assert min(width for width, _ in sizes) > 600


def test_without_matplotlib_the_page_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(*_: object) -> dict[str, str]:
        raise ImportError("pictures need <matplotlib>")

    monkeypatch.setattr("mobile_robot_simulator.compare.report_page._pictures", missing)
    text = html_report(COMPARISON, "map.yaml")
    assert Page(text).sources == [] and text.count("No picture: pictures need &lt;matplotlib&gt;") == 5


def test_names_are_text_and_not_markup() -> None:
    path = Path("<b>caf\udce9.log")
    text = html_report(replace(COMPARISON, log=replace(LOG, path=path, notes=("<i> & so on",))), "<u>.yaml")
    Page(text)
    assert "log: &lt;b&gt;caf?.log<" in text and "map: &lt;u&gt;.yaml<" in text and "<p>&lt;i&gt; &amp; so on</p>" in text


def test_a_short_log_without_errors_has_a_page() -> None:
    text = html_report(compare_log(GRID, log_of(GRID, POSES[:1]), align="none"), "map.yaml")
    assert "No residual is larger than 0.2 m." in text and "Noise of the scanner" not in text
    Page(text)
