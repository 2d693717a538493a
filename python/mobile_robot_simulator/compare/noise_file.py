"""noise_file: a fitted beam model as a parameter file that the laser and `run` read."""

from __future__ import annotations

from typing import Any

import numpy as np
import yaml

from ..logs import ScanLog
from ..parameters import LaserParameters
from .noise_fit import PARAMETERS, NoiseFit

_SAME = 1e-4  # largest distance between an angle of the log and one of the laser [rad]


def noise_text(noise: NoiseFit, log: ScanLog) -> str:
    """Returns a ROS 2 parameter file with the fitted beam model and the beams of the log's scanner.

    Angles are left out if the laser of the simulator cannot have them, such as uneven ones.

    Args:
        noise: The fit.
        log: The log that it was fitted to.
    """
    values = {name: getattr(noise.fit.model, name) for name in PARAMETERS}
    values |= _scanner_values(log)
    unsure = ", ".join(noise.fit.unidentified)
    lines = [f"# Beam model of the even scans of {_one_line(str(log.path))}, fitted by mobile-robot-simulator compare."]
    if unsure:
        lines.append(f"# The readings do not determine {unsure}.")
    lines.append(
        f"# Real returns lie {noise.offset:+.3f} m behind simulated ones; with that offset, sigma_hit is "
        f"{noise.offset_fit.model.sigma_hit:.4g}."
    )
    sections = {LaserParameters.node_name: {"ros__parameters": values}}
    return "\n".join(lines) + "\n" + yaml.safe_dump(sections, sort_keys=False)


def _scanner_values(log: ScanLog) -> dict[str, Any]:
    """Returns the parameters of the log's scanner."""
    limits = {"laser_min_range": log.min_range, "laser_max_range": log.max_range}
    first, last = float(log.angles[0]), float(log.angles[-1])
    layout = {
        "laser_beam_count": len(log.angles),
        "laser_angle_min": min(first, last),
        "laser_angle_max": max(first, last),
        "laser_clockwise": last < first,
    }
    try:
        angles = LaserParameters.checked({**limits, **layout}).scanner().angles
    except ValueError:
        return limits
    return {**limits, **layout} if np.abs(angles - log.angles).max() <= _SAME else limits


def _one_line(text: str) -> str:
    return " ".join(text.split())
