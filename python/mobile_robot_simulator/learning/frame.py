"""Pictures of environments as arrays of pixels."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from .batch import Batch

SIDE = 256
"""Width and height of a frame [pixels]."""

FREE, UNKNOWN, WALL = 255, 200, 60
ROBOT, GOAL, BEAM = (31, 119, 180), (44, 160, 44), (214, 39, 40)


def frame_of(batch: Batch, index: int) -> NDArray[np.uint8]:
    """Returns a picture of an environment: its whole world, the robot with its scan, and the goal.

    Args:
        batch: The environments.
        index: Which one to show.

    Returns:
        (SIDE, SIDE, 3) pixels, red, green and blue.
    """
    fleet, task = batch.fleet, batch.task
    world, pose = task.grids[fleet.grid_of[index]], fleet.poses[index]
    height, width = world.shape
    scale = SIDE / max(height, width)
    grey = np.select([world.cells < 0, world.cells >= world.occupied_threshold], [UNKNOWN, WALL], FREE).astype(np.uint8)
    size = (max(1, round(width * scale)), max(1, round(height * scale)))
    image = Image.new("RGB", (SIDE, SIDE), (UNKNOWN,) * 3)
    image.paste(Image.fromarray(grey[::-1]).resize(size, Image.Resampling.BOX), (0, SIDE - size[1]))
    x, y, yaw = tuple(world.origin)

    def pixels(points: NDArray[np.float64]) -> list[tuple[float, float]]:
        dx, dy = (points - (x, y)).T / world.resolution * scale
        across, up = math.cos(yaw) * dx + math.sin(yaw) * dy, math.cos(yaw) * dy - math.sin(yaw) * dx
        return list(zip(across.tolist(), (SIDE - up).tolist(), strict=True))

    def disc(point: tuple[float, float], radius: float, colour: tuple[int, int, int]) -> None:
        draw.ellipse((point[0] - radius, point[1] - radius, point[0] + radius, point[1] + radius), fill=colour)

    draw = ImageDraw.Draw(image)
    metre = scale / world.resolution
    for point in pixels(task.laser.end_points(tuple(pose), batch.observations()["ranges"][index])):
        disc(point, 1.0, BEAM)
    for *middle, reach in batch.discs(index):
        disc(pixels(np.array([middle]))[0], reach * metre, (WALL,) * 3)
    disc(pixels(batch.goals[index : index + 1])[0], max(2.0, task.goal_radius * metre), GOAL)
    centre = pixels(pose[None, :2])[0]
    radius = max(3.0, task.footprint.reach * metre)
    disc(centre, radius, ROBOT)
    ahead = pose[:2] + np.array([math.cos(pose[2]), math.sin(pose[2])]) * radius / metre
    draw.line([centre, pixels(ahead[None])[0]], fill=(255, 255, 255), width=1)
    return np.asarray(image)


def grid_of(frames: Sequence[NDArray[np.uint8]]) -> NDArray[np.uint8]:
    """Returns one picture of many of the same size, side by side in rows of equal length, first one at the top left."""
    columns = math.ceil(math.sqrt(len(frames)))
    rows = math.ceil(len(frames) / columns)
    height, width, colours = frames[0].shape
    tiles = np.full((rows * columns, height, width, colours), 255, np.uint8)
    tiles[: len(frames)] = frames
    tiles = tiles.reshape(rows, columns, height, width, colours).swapaxes(1, 2)
    return tiles.reshape(rows * height, columns * width, colours)
