"""package.xml agrees with the other files that describe the package."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

ROOT = Path(__file__).parents[3]
PACKAGE = ElementTree.parse(ROOT / "package.xml").getroot()


def test_the_version_is_that_of_cargo_toml() -> None:
    # Cargo.toml owns the version, but ROS tools only read package.xml. So the version must be repeated there.
    match = re.search(r'^version = "(.+)"$', (ROOT / "Cargo.toml").read_text(encoding="utf-8"), re.MULTILINE)
    assert match is not None
    assert PACKAGE.findtext("version") == match[1]


def test_the_description_is_that_of_pyproject_toml() -> None:
    match = re.search(r'^description = "(.+)"$', (ROOT / "pyproject.toml").read_text(encoding="utf-8"), re.MULTILINE)
    assert match is not None
    assert PACKAGE.findtext("description") == match[1]


def test_cmake_installs_every_script() -> None:
    installed = re.findall(r"scripts/(\w+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))
    assert sorted(installed) == sorted(path.name for path in (ROOT / "scripts").iterdir())
