"""preset: scanners that are sold, in the core, in the parameters of the laser, and in the documentation."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.parameters import LaserParameters

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "sensors.md"
PRESETS = mrs.laser_presets()
DASH = "\N{EN DASH}"


@pytest.mark.parametrize("name", PRESETS)
def test_the_scanner_the_noise_and_the_parameters_of_a_preset_agree(name: str) -> None:
    parameters, known = LaserParameters(laser_preset=name), PRESETS[name]
    for key, value in known.items():
        assert getattr(parameters, key) == value
    laser, noise = mrs.LaserScanner.preset(name), mrs.BeamModel.preset(name)
    assert repr(laser) == repr(parameters.scanner())
    assert repr(noise) == repr(parameters.beam_model)


def test_the_documentation_has_the_numbers_of_all_presets_and_a_source_for_each() -> None:
    tables = PAGE.read_text(encoding="utf-8").partition("## Presets")[2].split("## Sources")
    rows = {cells[1].strip(" `"): cells[2:9] for line in tables[0].splitlines() if len(cells := line.split("|")) == 10}
    sources = re.findall(r"^\| `(\w+)` \|(.*)$", tables[1], re.MULTILINE)
    assert [name for name, _ in sources] == list(PRESETS)
    for name, known in PRESETS.items():
        field, beams, rate, span, sigma, grows, step = (cell.strip() for cell in rows[name])
        assert float(field) == round(math.degrees(known["laser_fov"]), 2)
        assert (int(beams), float(rate)) == (known["laser_beam_count"], known["laser_frequency"])
        near, _, far = span.partition(DASH)
        assert (float(near) if near else None) == known.get("laser_min_range")
        assert (float(far) if far else None) == known.get("laser_max_range")
        assert sigma == (f"{known['sigma_hit']:.2g}" if "sigma_hit" in known else DASH)
        growth = (known.get("range_sigma_base"), known.get("range_sigma_per_metre"))
        assert grows == ("{:.2g} + {:.2g} r".format(*growth) if None not in growth else DASH)
        assert step == (f"{known['range_step_share']:g} r" if "range_step_share" in known else DASH)


def test_at_least_eight_sensors() -> None:
    assert len(PRESETS) >= 8


def test_given_parameters_count_more_than_those_of_the_preset() -> None:
    parameters = LaserParameters(laser_preset="hokuyo_utm30lx", laser_frequency=5.0)
    assert (parameters.laser_beam_count, parameters.laser_frequency) == (1081, 5.0)


def test_another_preset_replaces_the_first_and_none_gives_the_defaults() -> None:
    first = LaserParameters(laser_preset="hokuyo_utm30lx", laser_frequency=5.0)
    second = first.changed({"laser_preset": "sick_tim571"})
    assert (second.laser_beam_count, second.laser_frequency, second.sigma_hit) == (811, 5.0, 0.005)
    assert second.changed({"laser_preset": ""}) == LaserParameters(laser_frequency=5.0)
    assert first.changed({"sigma_hit": 0.1}).laser_beam_count == 1081


@pytest.mark.parametrize("name", ["hokuyo", "", "x" * 1000])
def test_unknown_presets_are_rejected(name: str) -> None:
    with pytest.raises(ValueError, match=r"^the preset must be one of hokuyo_urg04lx, .*, got \"" + name[:60] + '"$'):
        mrs.LaserScanner.preset(name)
    with pytest.raises(ValueError, match="the preset must be one of hokuyo_urg04lx"):
        mrs.BeamModel.preset(name)
    if name:
        with pytest.raises(ValueError, match=r"laser_preset must be empty or one of hokuyo_urg04lx, .*, got '(xx|hokuyo)"):
            LaserParameters(laser_preset=name)


def test_the_mount_is_that_of_the_robot() -> None:
    assert mrs.LaserScanner.preset("sick_s300", mount=(1.0, 2.0, 0.5)).mount == mrs.Pose(1.0, 2.0, 0.5)


def test_each_scanner_of_a_robot_may_have_a_preset_of_its_own() -> None:
    grid = mrs.floor_plan("office", seed=1)
    values: dict[str, object] = {
        "scanners": ["front", "rear"],
        "front.laser_preset": "sick_s300",
        "laser_preset": "robotis_lds02",
    }
    values |= {"front.laser_mount": (0.3, 0.0, 0.0), "rear.laser_mount": (-0.3, 0.0, math.pi)}
    sim = mrs.Simulation(grid, parameters=values, start=grid.draw_free_poses(1, radius=0.3, seed=1)[0])
    sim.run_for(0.2)
    assert (len(sim.latest("/front/scan").ranges), len(sim.latest("/rear/scan").ranges)) == (541, 360)
