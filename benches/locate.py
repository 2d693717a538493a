"""Share of scans that `locate` places rightly, and the time it takes, on generated offices and on maps that are given.

Run: python benches/locate.py [--poses N] [--offices N] [--threads N] [MAP.yaml ...]. Scans have 541 noisy beams. A place
is right within 0.1 m and 2°. A scan that is misplaced counts as ambiguous if the place found is at least as likely as the
true pose, and as missed if it is not. The margin is the difference of log-likelihood between the first and the second place.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import mobile_robot_simulator as mrs
from mobile_robot_simulator.localization import locate

NOISE = mrs.BeamModel(sigma_hit=0.03, lambda_short=1.0, z_hit=0.9, z_short=0.03, z_max=0.02, z_rand=0.05)
LASER = mrs.LaserScanner()


def grids(offices: int, maps: list[str]) -> Iterator[tuple[str, mrs.OccupancyGrid]]:
    """Yields the maps with their names."""
    for seed in range(1, offices + 1):
        yield f"office, seed {seed}", mrs.floor_plan("office", seed=seed)
    for path in maps:
        yield Path(path).parent.name, mrs.load_map(path)


def is_right(found: np.ndarray, true: np.ndarray) -> bool:
    """Returns true if a pose is within 0.1 m and 2° of the true one."""
    distance = math.hypot(*(found - true)[:2])
    return distance < 0.1 and abs(math.remainder(found[2] - true[2], math.tau)) < math.radians(2.0)


def main() -> None:
    """Prints a row for each map."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("maps", nargs="*")
    parser.add_argument("--poses", type=int, default=100)
    parser.add_argument("--offices", type=int, default=20)
    parser.add_argument("--threads", type=int)
    arguments = parser.parse_args()
    print(f"{'map':32} {'right':>9} {'ambiguous':>9} {'missed':>6} {'s (median)':>10}  margins of misplaced scans")
    for name, grid in grids(arguments.offices, arguments.maps):
        poses = grid.draw_free_poses(arguments.poses, radius=0.3, seed=1)
        scans = LASER.mark_invalid(LASER.scan_batch(grid, poses, noise=NOISE, seed=1))
        right, times, margins = 0, [], []
        ambiguous = 0
        for pose, scan in zip(poses, scans, strict=True):
            if not np.any(scan < LASER.max_range):
                print(f"{name}: no reading counts from {pose}")
                continue
            start = time.perf_counter()
            location = locate(grid, LASER, scan, noise=NOISE, threads=arguments.threads)
            times.append(time.perf_counter() - start)
            if is_right(location.poses[0], pose):
                right += 1
                continue
            margins.append(f"{location.margin:.1f}")
            true = LASER.log_likelihood(grid, pose[np.newaxis], scan, noise=NOISE)[0]
            ambiguous += bool(location.log_likelihoods[0] >= true)
        missed = len(times) - right - ambiguous
        row = f"{name:32} {right:>5}/{len(times):<3} {ambiguous:>9} {missed:>6} {np.median(times):>10.2f}"
        print(row, " ", ", ".join(margins), flush=True)


if __name__ == "__main__":
    main()
