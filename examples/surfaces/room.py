"""Scans a room with a glass front, a mirror and a dark wall, and draws the readings.

Run it with: python examples/surfaces/room.py --out surfaces.png
"""

from __future__ import annotations

import argparse

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np

import mobile_robot_simulator as mrs

WALL, GLASS, MIRROR, DARK = range(4)
COLORS = {WALL: "#30343b", GLASS: "#41a7d8", MIRROR: "#d33682", DARK: "#9a6a00"}
NAMES = {WALL: "wall", GLASS: "glass", MIRROR: "mirror", DARK: "dark"}
RESOLUTION = 0.05


def room() -> mrs.OccupancyGrid:
    """Returns a room of 6 m by 4 m with a corridor of 2 m behind its glass front."""
    cells, materials = np.zeros((81, 161), np.int8), np.zeros((81, 161), np.uint8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    cells[:, 120], materials[1:-1, 120] = 100, GLASS
    cells[8:26, 120], materials[8:26, 120] = 0, WALL  # the door is open
    materials[-1, 20:80] = MIRROR
    materials[:, 0] = DARK
    cells[20:28, 60:68] = 100  # a pillar
    return mrs.OccupancyGrid(cells, resolution=RESOLUTION, materials=materials)


def main() -> None:
    """Prints how many beams end behind glass or beyond a mirror, and draws where all beams seem to end."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--out", default="surfaces.png", help="the picture")
    arguments = parser.parse_args()
    grid = room()
    laser = mrs.LaserScanner(fov=6.28, beam_count=720, max_range=15.0)
    pose = mrs.Pose(2.0, 2.2, 0.0)
    plain = laser.scan(grid.with_materials(None), pose)
    readings = laser.scan_batch(grid, [pose], noise=mrs.BeamModel(sigma_hit=0.01), seed=1)[0]
    print(f"{np.sum(readings > plain + 0.1)} of {len(readings)} readings are behind the first surface")

    figure, axes = plt.subplots(figsize=(8, 5.6), layout="constrained")
    for number, color in COLORS.items():
        rows, cols = np.nonzero((grid.cells == 100) & (grid.materials == number))
        axes.plot((cols + 0.5) * RESOLUTION, (rows + 0.5) * RESOLUTION, "s", color=color, ms=3.2, label=NAMES[number])
    points = laser.end_points(pose, readings)
    axes.plot(*points.T, ".", color="#dc322f", ms=3, label="readings")
    axes.plot(pose.x, pose.y, "o", color="#1f4fd8", ms=9, label="laser")
    axes.set(xlabel="x [m]", ylabel="y [m]", aspect="equal")
    axes.legend(ncols=6, loc="lower center", bbox_to_anchor=(0.5, 1.0), frameon=False)
    figure.savefig(arguments.out, dpi=100)


if __name__ == "__main__":
    main()
