"""The citation file is valid, and agrees with the package."""

import subprocess
import sys
from pathlib import Path

import yaml

import mobile_robot_simulator as mrs

ROOT = Path(__file__).parents[2]
CITATION = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))


def test_it_follows_the_schema_of_the_format() -> None:
    check = [sys.executable, "-m", "check_jsonschema", "--builtin-schema", "vendor.citation-file-format"]
    done = subprocess.run([*check, ROOT / "CITATION.cff"], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stdout
    assert CITATION["cff-version"] == "1.2.0"


def test_it_names_the_version_of_the_package() -> None:
    assert CITATION["version"] == mrs.__version__


def test_the_documentation_cites_the_same() -> None:
    page = (ROOT / "docs" / "citing.md").read_text(encoding="utf-8")
    assert f"version = {{{CITATION['version']}}}" in page
    assert f"url     = {{{CITATION['repository-code']}}}" in page
    assert all(author["name"] in page for author in CITATION["authors"])
