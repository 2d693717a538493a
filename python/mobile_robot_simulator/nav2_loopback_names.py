"""Translates the parameters of nav2_loopback_sim to ours."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from .quoting import quoted

ANGLES = {"scan_angle_min": -math.pi, "scan_angle_max": math.pi, "scan_angle_increment": 0.02617}
"""The three scan angles of nav2_loopback_sim with their defaults there [rad]. They are translated together."""

_RENAMED = {
    "publish_map_odom_tf": "publish_map_transform",
    "base_frame_id": "base_link_frame",
    "enable_stamped_cmd_vel": "cmd_vel_stamped",
    "scan_frame_id": "laser_frame_id",
    "scan_range_min": "laser_min_range",
    "scan_range_max": "laser_max_range",
}
_TRANSLATED: dict[str, Callable[[str, Any], dict[str, Any]]] = {
    "update_duration": lambda name, value: {"publish_rate": 1.0 / _positive(name, value)},
    "odom_publish_dur": lambda name, value: {"publish_rate": 1.0 / _positive(name, value)},
    "scan_publish_dur": lambda name, value: {"laser_frequency": 1.0 / _positive(name, value)},
    "scan_use_inf": lambda name, value: {"no_return": "inf" if value else "below_max"},
    "scan_noise_std": lambda name, value: {"sigma_hit": value} if value else {"apply_noise": False},
}
SYNONYMS = (*_RENAMED, *_TRANSLATED, *ANGLES)
"""All parameter names of nav2_loopback_sim that differ from ours."""


def translate(given: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Returns, for each given parameter of nav2_loopback_sim, our parameters with their values.

    Two periods of the odometry, `update_duration` and `odom_publish_dur`, set `publish_rate`. If both are given, the shorter
    one counts.

    Args:
        given: Values by name. Names outside `SYNONYMS` are ignored.

    Raises:
        ValueError: A value cannot be translated.

    Example:
        >>> translate({"scan_use_inf": False})
        {'scan_use_inf': {'no_return': 'below_max'}}
    """
    meanings: dict[str, dict[str, Any]] = {}
    for name, value in given.items():
        if name in _RENAMED:
            meanings[name] = {_RENAMED[name]: value}
        elif name in _TRANSLATED:
            meanings[name] = _TRANSLATED[name](name, value)
        elif name in ANGLES:
            meanings[name] = _beams({angle: given.get(angle, ANGLES[angle]) for angle in ANGLES})
    rates = [meaning["publish_rate"] for meaning in meanings.values() if "publish_rate" in meaning]
    for meaning in meanings.values():
        if "publish_rate" in meaning:
            meaning["publish_rate"] = max(rates)
    return meanings


def _beams(angles: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the field and the number of beams.

    If less than half an increment is missing to a full circle, the scan is a full circle.
    """
    low, high, step = (float(angles[name]) for name in ANGLES)
    _positive("scan_angle_increment", step)
    if not low < high:
        raise ValueError(f"scan_angle_min must be less than scan_angle_max, got {low} and {high}")
    if high - low > 2.0 * math.pi - step / 2.0:
        ends = {"laser_angle_min": low, "laser_angle_max": low + 2.0 * math.pi}
        return ends | {"laser_beam_count": round(2.0 * math.pi / step)}
    return {"laser_angle_min": low, "laser_angle_max": high, "laser_beam_count": round((high - low) / step) + 1}


def _positive(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 < value < math.inf:
        raise ValueError(f"{name} must be positive, got {quoted(value)}")
    return float(value)
