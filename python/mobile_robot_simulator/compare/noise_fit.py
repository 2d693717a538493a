"""NoiseFit: the beam model of a log, fitted to the even scans and tested on the odd ones."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._core import BeamFit, BeamModel
from ..logs import ScanLog

AMCL = {
    "AMCL": BeamModel(sigma_hit=0.2, lambda_short=0.1, z_hit=0.95, z_short=0.1, z_max=0.05, z_rand=0.05),
    "AMCL of Nav2": BeamModel(sigma_hit=0.2, lambda_short=0.1, z_hit=0.5, z_short=0.05, z_max=0.05, z_rand=0.5),
}
"""Defaults of AMCL on ROS 1, and of Nav2's, with their weights scaled to sum to 1."""

MOST_READINGS = 20_000
"""Largest number of readings that a model is fitted to. Of longer logs, scans at equal distances are used."""

PARAMETERS = ("sigma_hit", "lambda_short", "z_hit", "z_short", "z_max", "z_rand")


@dataclass(frozen=True)
class Score:
    """How well a beam model explains readings that it was not fitted to.

    Attributes:
        log_likelihood: Mean over the readings of the logarithm of the density [1/m] or, for marks, of the probability. It is
            minus infinity if a reading is impossible.
        impossible: Number of readings that the model says are impossible.
    """

    log_likelihood: float
    impossible: int


@dataclass(frozen=True)
class NoiseFit:
    """The beam model of a log.

    Attributes:
        fit: The model of greatest likelihood for the even scans (0, 2, ...), and its standard errors.
        offset: How far real returns lie behind simulated ones, by greatest likelihood for the even scans [m].
        offset_fit: The model of greatest likelihood for the even scans, fitted together with that offset.
        test_count: Number of readings of the odd scans, on which it is tested.
        scores: How well models explain these: "fit", "fit with offset", and AMCL's defaults, see `AMCL`.
    """

    fit: BeamFit
    offset: float
    offset_fit: BeamFit
    test_count: int
    scores: dict[str, Score]

    def report(self) -> dict[str, Any]:
        """Returns the results as values that JSON has. None stands for minus infinity."""
        return {
            "fit": _fit_report(self.fit),
            "offset": self.offset,
            "fit_with_offset": _fit_report(self.offset_fit),
            "test_readings": self.test_count,
            "log_likelihood_per_reading": {name: _finite(score.log_likelihood) for name, score in self.scores.items()},
            "impossible_readings": {name: score.impossible for name, score in self.scores.items()},
        }


def fit_noise(
    log: ScanLog,
    simulated: NDArray[np.float32],
    *,
    progress: Callable[[float], None] = lambda _: None,
) -> NoiseFit | None:
    """Returns the beam model of a log, or None if the even or the odd scans have no reading that can be used.

    The model is fitted to at most `MOST_READINGS` readings, which takes about a second, and tested on all of the odd scans.
    A reading of NaN cannot be used, and neither can any from within a blocking cell of the map.

    Args:
        log: The log.
        simulated: (N, B) float32, simulated ranges [m]. Exactly the log's `max_range` means no return.
        progress: Called repeatedly with the share of the work that is done, up to 1.
    """
    is_used = ~np.isnan(log.ranges) & (simulated > 0.0)
    if log.min_range <= 0.0:
        is_used &= log.ranges != -np.inf
    count = -(-len(simulated) // 2)
    some = max(1, MOST_READINGS // simulated.shape[1])
    fitted = 2 * np.unique(np.linspace(0, count - 1, min(count, some)).round().astype(np.intp))
    even = simulated[fitted][is_used[fitted]], log.ranges[fitted][is_used[fitted]]
    odd = simulated[1::2][is_used[1::2]], log.ranges[1::2][is_used[1::2]]
    if not len(even[0]) or not len(odd[0]):
        return None
    limits = {"max_range": log.max_range, "min_range": log.min_range}
    fit = BeamModel.fit(*even, log.max_range, min_range=log.min_range)
    progress(0.5)
    offset_fit = BeamModel.fit(*even, log.max_range, min_range=log.min_range, fit_offset=True)
    offset = offset_fit.offset or 0.0
    scores = {name: score_of(model, odd, limits) for name, model in {"fit": fit.model, **AMCL}.items()}
    behind = _behind(odd[0], offset, log.max_range)
    scores["fit with offset"] = score_of(offset_fit.model, (behind, odd[1]), limits)
    progress(1.0)
    return NoiseFit(fit, offset, offset_fit, len(odd[0]), scores)


def _behind(simulated: NDArray[np.float32], offset: float, max_range: float) -> NDArray[np.float32]:
    """Returns simulated ranges with an offset added to those of hits, which stay hits."""
    most = np.nextafter(np.float32(max_range), np.float32(0.0))
    return np.where(simulated < max_range, np.clip(simulated + np.float32(offset), np.float32(1e-6), most), simulated)


def score_of(model: BeamModel, readings: tuple[NDArray[np.float32], NDArray[np.float32]], limits: dict[str, float]) -> Score:
    """Returns how well a model explains readings.

    Args:
        model: The model.
        readings: Simulated and measured ranges, (N,) float32 each [m], N >= 1.
        limits: `max_range` and `min_range` [m].
    """
    simulated, measured = readings
    likelihood = model.likelihood(measured, simulated, **limits)
    impossible = int((likelihood == 0.0).sum())
    mean = -math.inf if impossible else float(np.log(likelihood).mean())
    return Score(mean, impossible)


def _fit_report(fit: BeamFit) -> dict[str, Any]:
    return {
        **{name: getattr(fit.model, name) for name in PARAMETERS},
        "standard_errors": fit.standard_errors,
        "unidentified": list(fit.unidentified),
        "log_likelihood_per_reading": fit.log_likelihood / fit.count,
        "readings": fit.count,
        "has_converged": fit.has_converged,
    }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
