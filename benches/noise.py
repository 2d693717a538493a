"""Time of each part of the noise, as a ratio to the time of the default noise.

Run: python benches/noise.py [--turns N]. All parts take turns on the same scans, so a busy machine slows
all of them equally.
Each figure is the median of the ratios within a turn. One thread.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import mobile_robot_simulator as mrs

SCANS = 1000
SEED = 5

WAYS: dict[str, dict[str, Any]] = {
    "true ranges": {},
    "default": {"noise": mrs.BeamModel(), "seed": 1},
    "sigma by range": {"noise": mrs.BeamModel(range_sigma_base=0.002, range_sigma_per_metre=0.001), "seed": 1},
    "offset": {"noise": mrs.BeamModel(range_offset=0.02), "seed": 1},
    "incidence": {
        "noise": mrs.BeamModel(),
        "surfaces": mrs.SurfaceModel(incidence_sigma=0.5, incidence_bias=0.03),
        "seed": 1,
    },
    "correlation": {"noise": mrs.BeamModel(), "surfaces": mrs.SurfaceModel(correlation=0.5), "seed": 1},
    "steps of 1 mm": {"noise": mrs.BeamModel(range_step=0.001), "seed": 1},
    "steps of 1 %": {"noise": mrs.BeamModel(range_step=0.001, range_step_share=0.01), "seed": 1},
    "all": {
        "noise": mrs.BeamModel(range_offset=0.02, range_sigma_per_metre=0.001, range_step=0.001, range_step_share=0.01),
        "surfaces": mrs.SurfaceModel(incidence_sigma=0.5, incidence_bias=0.03, correlation=0.5),
        "seed": 1,
    },
}
"""Arguments of `scan_batch` for each part."""


def seconds(call: Callable[[], object]) -> float:
    """Returns how long a call takes [s]."""
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def main() -> None:
    """Prints a line for each part."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--turns", type=int, default=15)
    turns = parser.parse_args().turns
    grid, laser = mrs.floor_plan("office", seed=SEED, size=(40.0, 40.0)), mrs.LaserScanner()
    poses = grid.draw_free_poses(SCANS, radius=0.2, seed=SEED)
    out = np.empty((SCANS, laser.beam_count), np.float32)
    times: dict[str, list[float]] = {way: [] for way in WAYS}
    for turn in range(turns + 1):
        for way, arguments in WAYS.items():
            taken = seconds(lambda: laser.scan_batch(grid, poses, **arguments, threads=1, out=out))  # noqa: B023 - called here
            if turn > 0:
                times[way].append(taken)
    for way, taken in times.items():
        ratio = statistics.median(one / other for one, other in zip(taken, times["default"], strict=True))
        print(f"{way:20}{min(taken) / out.size * 1e9:8.2f} ns a beam{ratio:8.2f}x")


if __name__ == "__main__":
    main()
