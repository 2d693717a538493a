"""Time of each part of the noise, of materials and of intensities, as a ratio to the time of the default noise.

Run: python benches/noise.py [--turns N] [--map MAP.yaml]. All parts take turns on the same scans, so a busy machine slows
all of them equally.
Each figure is the median of the ratios within a turn. One thread.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable
from functools import partial
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
    "no return": {"noise": mrs.BeamModel(), "surfaces": mrs.SurfaceModel(reference_range=20.0), "seed": 1},
    "footprint": {"noise": mrs.BeamModel(), "surfaces": mrs.SurfaceModel(beam_divergence=0.005), "seed": 1},
    "steps of 1 mm": {"noise": mrs.BeamModel(range_step=0.001), "seed": 1},
    "steps of 1 %": {"noise": mrs.BeamModel(range_step=0.001, range_step_share=0.01), "seed": 1},
    "all": {
        "noise": mrs.BeamModel(range_offset=0.02, range_sigma_per_metre=0.001, range_step=0.001, range_step_share=0.01),
        "surfaces": mrs.SurfaceModel(incidence_sigma=0.5, incidence_bias=0.03, correlation=0.5, reference_range=20.0),
        "seed": 1,
    },
}
"""Arguments of `scan_batch` for each part."""

SHARES = {"2.5 % glass, 2.5 % mirrors": (0.95, 0.025, 0.025, 0.0), "5 % dark walls": (0.95, 0.0, 0.0, 0.05)}
"""Shares of the default materials (wall, glass, mirror, dark) among the cells of a map."""


def seconds(call: Callable[[], object]) -> float:
    """Returns the processor time that a call takes [s], which does not count other programs."""
    start = time.process_time()
    call()
    return time.process_time() - start


def main() -> None:
    """Prints a line for each part."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--turns", type=int, default=15)
    parser.add_argument("--map", help="a map file; an office by default")
    arguments = parser.parse_args()
    turns = arguments.turns
    office = partial(mrs.floor_plan, "office", seed=SEED, size=(40.0, 40.0))
    grid, laser = mrs.load_map(arguments.map) if arguments.map else office(), mrs.LaserScanner()
    poses = grid.draw_free_poses(SCANS, radius=0.2, seed=SEED)
    out = np.empty((SCANS, laser.beam_count), np.float32)
    options: dict[str, Any] = {"threads": 1, "out": out}
    calls: dict[str, Callable[[], object]] = {
        way: partial(laser.scan_batch, grid, poses, **arguments, **options) for way, arguments in WAYS.items()
    }
    draw = np.random.default_rng(SEED)
    for name, shares in SHARES.items():
        mixed = grid.with_materials(draw.choice(4, grid.shape, p=shares).astype(np.uint8))
        for way in ("default", "all"):
            calls[f"{name}, {way}"] = partial(laser.scan_batch, mixed, poses, **WAYS[way], **options)
    calls["intensities"] = partial(laser.intensities, grid, poses, seed=1, **options)
    times: dict[str, list[float]] = {way: [] for way in calls}
    for turn in range(turns + 1):
        for way, call in calls.items():
            taken = seconds(call)
            if turn > 0:
                times[way].append(taken)
    for way, series in times.items():
        ratio = statistics.median(one / other for one, other in zip(series, times["default"], strict=True))
        print(f"{way:36}{min(series) / out.size * 1e9:8.2f} ns a beam{ratio:8.2f}x")


if __name__ == "__main__":
    main()
