"""noise_file: what the simulator reads is what was fitted."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from compare.simulated_logs import free_poses, log_of, office
from mobile_robot_simulator.compare.noise_file import noise_text
from mobile_robot_simulator.compare.noise_fit import NoiseFit, fit_noise
from mobile_robot_simulator.logs import ScanLog
from mobile_robot_simulator.parameter_files import read_file
from mobile_robot_simulator.parameters import LaserParameters, for_node

GRID = office()
POSES = free_poses(GRID, 20)
NOISE = mrs.BeamModel(sigma_hit=0.05, z_hit=0.9, z_rand=0.1, z_max=0.0)


def noise_of(log: ScanLog) -> NoiseFit:
    found = fit_noise(log, log_of(GRID, POSES).ranges.clip(0.0, log.max_range))
    assert found is not None
    return found


def read(text: str, tmp_path: Path) -> LaserParameters:
    (tmp_path / "noise.yaml").write_text(text)
    return for_node(LaserParameters, read_file(tmp_path / "noise.yaml"))


@pytest.mark.parametrize("turn", [1, -1], ids=["counter-clockwise", "clockwise"])
def test_the_laser_reads_the_model_and_the_beams(tmp_path: Path, turn: int) -> None:
    log = log_of(GRID, POSES, noise=NOISE)
    log = replace(log, angles=turn * log.angles + 0.3)
    noise = noise_of(log)
    parameters = read(noise_text(noise, log), tmp_path)
    found, fitted = parameters.beam_model, noise.fit.model
    assert found.sigma_hit == fitted.sigma_hit and found.lambda_short == fitted.lambda_short
    for name in ("z_hit", "z_short", "z_max", "z_rand"):
        assert getattr(found, name) == pytest.approx(getattr(fitted, name), abs=1e-12)
    np.testing.assert_allclose(parameters.scanner().angles, log.angles, atol=1e-9)
    assert (parameters.laser_min_range, parameters.laser_max_range) == (log.min_range, log.max_range)


@pytest.mark.parametrize("angles", [np.linspace(0.0, 1.0, 101) ** 2, np.full(101, 0.5), np.linspace(0.0, 13.0, 101)])
def test_beams_that_the_laser_cannot_have_are_left_out(tmp_path: Path, angles: np.ndarray) -> None:
    log = replace(log_of(GRID, POSES, noise=NOISE), angles=angles)
    parameters = read(noise_text(noise_of(log), log), tmp_path)
    assert parameters.laser_angle_min is None and parameters.laser_beam_count == 541 and parameters.laser_max_range == 12.0


def test_the_text_says_what_is_not_determined_and_has_one_line_for_each_comment(tmp_path: Path) -> None:
    log = replace(log_of(GRID, POSES), path=Path("a\nz_hit: 7.log"))
    text = noise_text(noise_of(log), log)
    assert "# The readings do not determine lambda_short.\n" in text and "scans of a z_hit: 7.log, fitted" in text
    assert read(text, tmp_path).z_hit == pytest.approx(1.0)
