"""The public surface of the package, and what importing it costs."""

import importlib
import subprocess
import sys

import pytest

import mobile_robot_simulator as mrs

HEAVY = ("matplotlib", "nicegui", "PIL", "pydantic", "rich", "rosbags", "scipy", "typer", "yaml")

USE = f"""
import sys
import mobile_robot_simulator as mrs

import numpy as np

grid = mrs.OccupancyGrid(np.array([[0, 100]], np.int8), resolution=1.0)
laser = mrs.LaserScanner(beam_count=1, max_range=5.0)
ranges = laser.scan_batch(grid, np.array([[0.5, 0.5, 0.0]]), noise=mrs.BeamModel(), seed=1)
assert ranges.shape == (1, 1)
print(*sorted({set(HEAVY)!r} & set(sys.modules)))
"""


def test_the_core_loads_nothing_that_it_does_not_need() -> None:
    """Importing pydantic or Matplotlib takes longer than casting a million beams."""
    ran = subprocess.run([sys.executable, "-c", USE], capture_output=True, text=True, timeout=60, check=False)
    assert (ran.returncode, ran.stdout.strip()) == (0, ""), ran.stderr


BUILT_WITH = [
    "BeamFit",
    "BeamModel",
    "Contact",
    "Drive",
    "Fleet",
    "FleetState",
    "FleetStep",
    "LaserScanner",
    "LikelihoodField",
    "Limits",
    "Material",
    "MotionNoise",
    "Obstacles",
    "OccupancyGrid",
    "Pose",
    "RandomStream",
    "Shape",
    "Simulation",
    "SurfaceModel",
    "WheelMotion",
    "advance",
    "cast_rays",
    "clearance",
    "clearance_batch",
    "floor_plan",
    "integrate_twist",
    "laser_presets",
    "load_map",
    "save_map",
    "touches",
]
"""Names that users build with. Everything else is in a submodule."""

SUBMODULES = [
    "audit",
    "benchmarks",
    "bus",
    "compare",
    "datasets",
    "falsification",
    "faults",
    "foxglove",
    "learning",
    "live",
    "localization",
    "logs",
    "maps",
    "messages",
    "nodes",
    "parameters",
    "physics",
    "plotting",
    "recording",
    "requirements",
    "ros",
    "scenarios",
    "simulation",
    "testing",
]


def test_the_package_offers_names_to_build_with_and_submodules() -> None:
    assert sorted(mrs.__all__) == sorted([*BUILT_WITH, "__version__"])
    assert set(dir(mrs)) == {*BUILT_WITH, *SUBMODULES, "__version__"}


@pytest.mark.slow
@pytest.mark.parametrize("name", SUBMODULES)
def test_a_submodule_is_reached_by_attribute_and_by_import(name: str) -> None:
    """Uses a fresh interpreter for each name, because an import elsewhere would set the attribute."""
    module = f"mobile_robot_simulator.{name}"
    for code in (
        f"import mobile_robot_simulator as mrs; print(mrs.{name}.__name__)",
        f"import {module} as m; print(m.__name__)",
    ):
        ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=False)
        assert (ran.returncode, ran.stdout.strip()) == (0, module), ran.stderr


@pytest.mark.parametrize("name", SUBMODULES)
def test_a_submodule_has_what_it_says_that_it_offers(name: str) -> None:
    module = importlib.import_module(f"mobile_robot_simulator.{name}")
    for each in module.__all__:
        assert hasattr(module, each)


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="Twist"):
        mrs.Twist  # noqa: B018
