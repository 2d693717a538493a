"""Shrinking: makes the world of a failed drive smaller and simpler, as long as the drive still fails."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

from ..benchmarks.control_loop import STEP
from ..scenarios.world import World
from ..scenarios.world_map import ROOM, WorldMap
from .drive import ERROR, TIME, Drive
from .fault_shrinking import simpler_faults, simpler_numbers, smaller_faults

__all__ = ["LIMIT", "shrink"]

LIMIT = 500
"""Largest number of drives."""

ROOM_AT_START = 0.5
"""Clearance at the start that a smaller world need not exceed [m]."""

SIDES = (3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 15.0, 20.0, 30.0)
"""Sides of rooms to try [m]."""


def shrink(drive: Drive, run: Callable[[World], Drive], *, limit: int = LIMIT) -> Drive:
    """Returns a failed drive in a smaller and simpler world, which fails in the same way.

    It tries, in turns until nothing helps: fewer faults and obstacles, an empty and smaller room, a shorter drive,
    shorter and weaker faults, and numbers with fewer digits. The parameters stay as they are. Start, goal and obstacles stay
    in free space, and the start keeps its clearance, up to 0.5 m. A drive that ended with an error must end with an error of
    the same type; another one must violate the requirement. A drive that ended because its time was over keeps its time,
    because every drive is too short for some requirements.

    Args:
        drive: The failed drive.
        run: Runs a world. A ValueError means that the world is not valid.
        limit: Largest number of drives.

    Raises:
        ValueError: The drive has not failed.
    """
    if not drive.failed:
        raise ValueError(f"only a failed drive can be shrunk, got one with robustness {drive.robustness:g}")
    left, room = limit, min(ROOM_AT_START, drive.world.simulation().truth.clearance)
    tried = {drive.world.to_json()}
    is_changed = True
    while is_changed:
        is_changed = False
        for step in (_with_less, _on_plainer_maps, _shorter, _with_smaller_faults, _with_simpler_numbers):
            # After a success, the same step goes on with the new world.
            again = True
            while again:
                again = False
                for world in step(drive):
                    text = world.to_json()
                    if text in tried:
                        continue
                    if not left:
                        return drive
                    tried.add(text)
                    if not _is_sound(world, room):
                        continue
                    left -= 1
                    try:
                        shorter = run(world)
                    except ValueError:
                        continue
                    if shorter.failed and _kind(shorter) == _kind(drive):
                        drive, again, is_changed = shorter, True, True
                        break
    return drive


def _is_sound(world: World, room: float) -> bool:
    """True if start, goal and obstacles are in known free space, and the start has so much room around it [m]."""
    try:
        grid = world.map.grid()
        places = [world.start[:2], *([world.goal] if world.goal is not None else [])]
        places += [(disc.x, disc.y) for disc in world.obstacles]
        values, cells = grid.cells, [grid.cell_at(x, y) for x, y in places]
        if any(cell is None or not 0 <= values[cell] < grid.occupied_threshold for cell in cells):
            return False
        return world.simulation().truth.clearance >= room
    except ValueError:
        return False


def _kind(drive: Drive) -> str:
    return drive.error.partition(":")[0] if drive.ending == ERROR else ""


def _with_less(drive: Drive) -> Iterator[World]:
    world = drive.world
    if world.things > 1:
        yield replace(world, obstacles=(), faults=())
    if len(world.obstacles) > 1:
        yield replace(world, obstacles=())
    if len(world.faults) > 1:
        yield replace(world, faults=())
    count = len(world.obstacles)
    if count > 3:
        yield replace(world, obstacles=world.obstacles[: count // 2])
        yield replace(world, obstacles=world.obstacles[count // 2 :])
    for number in reversed(range(count)):
        yield replace(world, obstacles=world.obstacles[:number] + world.obstacles[number + 1 :])
    for number in reversed(range(len(world.faults))):
        yield replace(world, faults=world.faults[:number] + world.faults[number + 1 :])
    if world.seed:
        yield replace(world, seed=0)
    for number, disc in enumerate(world.obstacles):
        if disc.vx or disc.vy:
            standing = replace(disc, vx=0.0, vy=0.0)
            yield replace(world, obstacles=(*world.obstacles[:number], standing, *world.obstacles[number + 1 :]))


def _on_plainer_maps(drive: Drive) -> Iterator[World]:
    world, map = drive.world, drive.world.map
    if not map.is_generated:
        return
    if map.kind != ROOM:
        yield replace(world, map=WorldMap(ROOM, 0, map.size, map.resolution))
        if map.seed:
            yield replace(world, map=replace(map, seed=0))
        return
    width, height = map.size
    for side in SIDES:
        if side < width:
            yield replace(world, map=replace(map, size=(side, height)))
    for side in SIDES:
        if side < height:
            yield replace(world, map=replace(map, size=(width, side)))


def _shorter(drive: Drive) -> Iterator[World]:
    world = drive.world
    if drive.ending == TIME:
        return
    for duration in (float(math.ceil(drive.time)), round(math.ceil(drive.time / STEP - 1e-9) * STEP, 3)):
        if duration < world.duration:
            yield replace(world, duration=duration)


def _with_smaller_faults(drive: Drive) -> Iterator[World]:
    for index, text in enumerate(drive.world.faults):
        for fault in smaller_faults(text):
            yield _with_fault(drive.world, index, fault)


def _with_simpler_numbers(drive: Drive) -> Iterator[World]:
    world = drive.world
    for axis in reversed(range(3)):
        for number in simpler_numbers(world.start[axis]):
            start = (*world.start[:axis], number, *world.start[axis + 1 :])
            yield replace(world, start=start)  # type: ignore[arg-type]
    for axis in range(2) if world.goal is not None else ():
        assert world.goal is not None
        for number in simpler_numbers(world.goal[axis]):
            yield replace(world, goal=(number, world.goal[1]) if axis == 0 else (world.goal[0], number))
    for index, disc in enumerate(world.obstacles):
        for name in ("x", "y", "radius", "vx", "vy"):
            for number in simpler_numbers(getattr(disc, name)):
                if name != "radius" or number > 0.0:
                    simpler = replace(disc, **{name: number})
                    yield replace(world, obstacles=(*world.obstacles[:index], simpler, *world.obstacles[index + 1 :]))
    for index, text in enumerate(world.faults):
        for fault in simpler_faults(text):
            yield _with_fault(world, index, fault)


def _with_fault(world: World, index: int, fault: str) -> World:
    return replace(world, faults=(*world.faults[:index], fault, *world.faults[index + 1 :]))
