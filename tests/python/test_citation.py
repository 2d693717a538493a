"""The citation file is valid YAML, and agrees with the package."""

from pathlib import Path

import yaml

import mobile_robot_simulator as mrs

ROOT = Path(__file__).parents[2]
CITATION = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))


def test_it_has_the_fields_that_the_format_requires() -> None:
    assert CITATION["cff-version"] == "1.2.0"
    assert {"message", "title", "authors"} <= CITATION.keys()


def test_it_names_the_version_of_the_package() -> None:
    assert CITATION["version"] == mrs.__version__


def test_the_documentation_cites_the_same() -> None:
    page = (ROOT / "docs" / "citing.md").read_text(encoding="utf-8")
    assert f"version = {{{CITATION['version']}}}" in page
    assert f"url     = {{{CITATION['repository-code']}}}" in page
    assert all(author["name"] in page for author in CITATION["authors"])
