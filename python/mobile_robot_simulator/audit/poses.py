"""Poses: rules for frames, quaternions, covariances and numbers of messages with poses."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..quoting import quoted
from .findings import Findings

LARGEST_NORM_ERROR = 1e-3
"""Largest difference from 1 of the length of a quaternion."""

SYMMETRY = 1e-6
"""Largest asymmetry of correlations, and largest negative eigenvalue of their matrix."""


def check_frames(findings: Findings, topic: str, index: int, frames: dict[str, str]) -> bool:
    """Checks the names of a message's frames. Returns True if they are right.

    Args:
        findings: Where findings go.
        topic: Topic of the message.
        index: Its position among the messages of the topic.
        frames: Names of the frames, by field: `frame_id` and, if there is one, `child_frame_id`.
    """
    shown = ", ".join(f"{name} {quoted(frame)}" for name, frame in frames.items())
    is_right = not any(not frame or frame.startswith("/") for frame in frames.values())
    is_right = is_right and len(set(frames.values())) == len(frames)
    if not is_right:
        findings.add("frame-name", topic, index, shown)
    return is_right


def check_pose(findings: Findings, topic: str, index: int, position: Any, orientation: Any) -> bool:
    """Checks a pose or a transform. Returns True if it is finite and its quaternion is not 0.

    Args:
        findings: Where findings go.
        topic: Topic of the message.
        index: Its position among the messages of the topic.
        position: A Point or a Vector3.
        orientation: A Quaternion.
    """
    numbers = [position.x, position.y, position.z, orientation.x, orientation.y, orientation.z, orientation.w]
    if not all(map(math.isfinite, numbers)):
        findings.add("not-finite", topic, index, f"x y z qx qy qz qw {' '.join(f'{number:g}' for number in numbers)}")
        return False
    norm = math.hypot(*numbers[3:])
    if abs(norm - 1.0) > LARGEST_NORM_ERROR:
        findings.add("quaternion", topic, index, f"length {norm:g}")
    return norm > 0.0


def check_covariance(findings: Findings, topic: str, index: int, name: str, covariance: Any) -> None:
    """Checks a covariance.

    Args:
        findings: Where findings go.
        topic: Topic of the message.
        index: Its position among the messages of the topic.
        name: Name of the covariance's field.
        covariance: 36 numbers, row-major.
    """
    got = _what_is_wrong(np.asarray(covariance, np.float64).reshape(6, 6))
    if got is not None:
        findings.add("covariance", topic, index, f"{name}: {got}")


def _what_is_wrong(matrix: NDArray[np.float64]) -> str | None:
    """Returns what is wrong with a covariance. Correlations are compared, since variances differ by many powers of ten."""
    if not np.isfinite(matrix).all():
        return "numbers that are not finite"
    if not matrix.any():
        return "all 0, which claims a perfect measurement"
    variances = np.diag(matrix)
    if (variances < 0.0).any():
        return f"a variance of {variances.min():g}"
    scale = np.sqrt(variances)
    scale[scale == 0.0] = 1.0
    correlations = matrix / scale[:, None] / scale
    if (asymmetry := np.abs(correlations - correlations.T).max()) > SYMMETRY:
        return f"correlations that differ by {asymmetry:g} across the diagonal"
    if (least := np.linalg.eigvalsh(correlations)[0]) < -SYMMETRY:
        return f"correlations with an eigenvalue of {least:g}"
    return None
