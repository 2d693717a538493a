"""Offices: wings of rooms along corridors, cross corridors, a lobby and furniture."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

from .dice import Dice
from .furniture import furnish_lobby, furnish_room
from .plan import Box, Plan

_WING, _ROOM, _LOBBY = 12.5, 4.2, 8.0  # average depth of a wing, width of a room, and width of the lobby [m]
_CROSSING_EVERY = 22.0  # average distance between cross corridors [m]


class _Wing(NamedTuple):
    """A corridor (`hall`) with a row of rooms on each side."""

    inside: Box
    hall: Box


def draw_office(plan: Plan, dice: Dice) -> None:
    """Draws wings side by side, parallel to the longer side of the plan."""
    if plan.height > plan.width:
        turned = Plan(plan.height, plan.width, plan.resolution)
        draw_office(turned, dice)
        plan.cells = turned.cells.T.copy()
        return
    wings = _wings(plan, dice)
    for wing in wings:
        plan.block(wing.inside.grown(plan.outer_wall))
    for wing in wings:
        plan.carve(wing.hall)
    crossings = _crossings(plan, dice, wings)
    for crossing in crossings:
        plan.carve(crossing)
    for number, wing in enumerate(wings):
        for side in (-1, 1):
            _draw_rooms(plan, dice, wing, side, crossings, with_lobby=number == 0 and side < 0)


def _wings(plan: Plan, dice: Dice) -> list[_Wing]:
    inside = plan.inside
    count = max(1, round(inside.height / plan.count(_WING)))
    # One end of an upper wing may be missing, so that the building is not always a rectangle.
    shortened = dice.whole(1, count - 1) if count > 1 and dice.chance(0.7) else -1
    wings = []
    for number in range(count):
        bottom = inside.bottom + (inside.height + plan.wall) * number // count
        top = inside.bottom + (inside.height + plan.wall) * (number + 1) // count - plan.wall
        left, right = inside.left, inside.right
        if number == shortened and inside.width > plan.count(25.0):
            missing = round(inside.width * dice.between(0.2, 0.35))
            left, right = (left + missing, right) if dice.chance(0.5) else (left, right - missing)
        width = plan.count(dice.between(1.8, 2.4))
        middle = (bottom + top - width) // 2 + round((top - bottom) * dice.between(-0.06, 0.06))
        wings.append(_Wing(Box(left, bottom, right, top), Box(left, middle, right, middle + width)))
    return wings


def _crossings(plan: Plan, dice: Dice, wings: list[_Wing]) -> list[Box]:
    """Cross corridors between neighbouring wings: near both ends, and more in between if the wings are long."""
    crossings = []
    for lower, upper in pairwise(wings):
        left = max(lower.inside.left, upper.inside.left)
        right = min(lower.inside.right, upper.inside.right)
        count = max(2, round((right - left) / plan.count(_CROSSING_EVERY)) + 1)
        for number in range(count):
            share = (number + 0.5 + dice.between(-0.2, 0.2)) / count
            width = plan.count(dice.between(1.6, 2.0))
            at = left + round((right - left - width) * share)
            crossings.append(Box(at, lower.hall.bottom, at + width, upper.hall.top))
    return crossings


def _draw_rooms(plan: Plan, dice: Dice, wing: _Wing, side: int, crossings: list[Box], *, with_lobby: bool) -> None:
    """Draws the rooms on one side of a wing's corridor: below it (-1) or above it (+1)."""
    inside, hall = wing
    bottom, top = (hall.top + plan.wall, inside.top) if side > 0 else (inside.bottom, hall.bottom - plan.wall)
    strip = Box(inside.left, bottom, inside.right, top)
    for left, right in _gaps(plan, strip, crossings):
        rooms = _split(plan, dice, left, right, with_lobby=with_lobby)
        lobby = max(rooms, key=lambda room: room[1] - room[0]) if with_lobby else None
        for room in rooms:
            box = Box(room[0], bottom, room[1], top)
            plan.carve(box)
            if room == lobby:
                _open_lobby(plan, dice, box, side)
            else:
                _open_room(plan, dice, box, side)


def _gaps(plan: Plan, strip: Box, crossings: list[Box]) -> list[tuple[int, int]]:
    """Columns [left, right) of the parts of a strip between the corridors that cross it. Omits parts below 2 m."""
    through = sorted(box for box in crossings if box.overlaps(strip))
    edges = [
        strip.left,
        *(edge for box in through for edge in (box.left - plan.wall, box.right + plan.wall)),
        strip.right,
    ]
    return [(left, right) for left, right in zip(edges[::2], edges[1::2], strict=True) if right - left >= plan.count(2.0)]


def _split(plan: Plan, dice: Dice, left: int, right: int, *, with_lobby: bool) -> list[tuple[int, int]]:
    """Columns [left, right) of the rooms that fill a span, with a wall between neighbours."""
    span = right - left + plan.wall
    count = max(1, round(span / plan.count(_ROOM)))
    shares = [dice.between(0.75, 1.35) for _ in range(count)]
    if with_lobby and count > 2:
        shares = shares[:-1]
        shares[dice.whole(0, len(shares) - 1)] = max(2.0, _LOBBY / _ROOM)
    ends = [left]
    for number in range(len(shares)):
        ends.append(left + round(span * sum(shares[: number + 1]) / sum(shares)))
    return [(low, high - plan.wall) for low, high in pairwise(ends)]


def _open_room(plan: Plan, dice: Dice, room: Box, side: int) -> None:
    """Adds a door to the corridor, near a corner of the room, and furniture that leaves the door free."""
    door = min(plan.door + plan.count(dice.between(0.01, 0.2)), room.width)
    inset = min(plan.count(dice.between(0.15, 0.6)), room.width - door)
    left = room.left + inset if dice.chance(0.5) else room.right - inset - door
    wall = (room.bottom - plan.wall, room.bottom) if side > 0 else (room.top, room.top + plan.wall)
    opening = Box(left, wall[0], left + door, wall[1])
    plan.carve(opening)
    furnish_room(plan, dice, room, opening, side)


def _open_lobby(plan: Plan, dice: Dice, room: Box, side: int) -> None:
    """Opens the lobby to the corridor over its full width, except for a stub of wall at each end."""
    stub = min(plan.count(0.6), room.width // 5)
    wall = (room.bottom - plan.wall, room.bottom) if side > 0 else (room.top, room.top + plan.wall)
    plan.carve(Box(room.left + stub, wall[0], room.right - stub, wall[1]))
    furnish_lobby(plan, dice, room, side)
