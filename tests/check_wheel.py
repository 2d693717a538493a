"""Checks an installed package from outside of its sources: what it imports, casts and runs."""

import subprocess
import sys
from importlib.metadata import distribution
from pathlib import Path

import numpy as np

import mobile_robot_simulator as mrs

ROOT = Path(__file__).resolve().parent.parent
HERE = Path(mrs.__file__).resolve()


def check_files() -> None:
    """The package is the installed one, and brings its types and its licence."""
    assert not HERE.is_relative_to(ROOT / "python"), f"imported from the sources: {HERE}"
    files = {path.name for path in distribution("mobile-robot-simulator").files or ()}
    assert {"_core.pyi", "py.typed", "LICENSE"} <= files, f"not all there: {sorted(files)}"


def check_ranges() -> None:
    """A beam along a corridor of half-metre cells, from a wall to a wall, has the range anyone can work out."""
    cells = np.array([[100, 0, 0, 0, 100]], np.int8)
    grid = mrs.OccupancyGrid(cells, resolution=0.5, origin=(10.0, 20.0, 0.0))
    rays = np.array([[11.0, 20.25, 0.0], [11.0, 20.25, np.pi], [9.0, 20.25, 0.0], [11.0, 20.25, np.pi / 2]])
    ranges = mrs.cast_rays(grid, rays, 5.0)
    assert ranges.tolist() == [1.0, 0.5, 1.0, 5.0], ranges


def check_metadata() -> None:
    """`pip show` finds the project's page, what the package does, its authors and its licence."""
    metadata = distribution("mobile-robot-simulator").metadata
    pages = [url for url in metadata.get_all("Project-URL") or () if url.startswith("Homepage, ")]
    fields = [metadata[name] for name in ("Summary", "Author", "License-Expression")]
    assert pages and all(fields), f"pip show shows too little: {pages}, {fields}"


def check_command() -> None:
    """The console command starts and says what it is."""
    command = Path(sys.executable).with_name("mobile-robot-simulator")
    said = subprocess.run([command, "--version"], check=True, capture_output=True, text=True, timeout=60).stdout
    assert mrs.__version__ in said, said


def main() -> None:
    """Run the checks named on the command line, all if none is named."""
    checks = {"files": check_files, "metadata": check_metadata, "ranges": check_ranges, "command": check_command}
    for name in sys.argv[1:] or checks:
        checks[name]()
    print(f"mobile-robot-simulator {mrs.__version__}, Python {sys.version.split()[0]}, NumPy {np.__version__}: works")


if __name__ == "__main__":
    main()
