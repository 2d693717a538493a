"""Furniture: pieces in a room that leave every part of it reachable."""

from __future__ import annotations

from .dice import Dice
from .plan import Box, Plan

_PASSAGE = 0.9  # least gap between two pieces, or between a piece and a wall that it does not touch [m]


class _Room:
    """A room, the furniture in it, and boxes to keep clear. Every free part of the room stays reachable."""

    def __init__(self, plan: Plan, floor: Box, keep_clear: list[Box]) -> None:
        self.plan, self.floor = plan, floor
        self._taken = list(keep_clear)
        self._passage = plan.count(_PASSAGE)

    def place(self, piece: Box) -> bool:
        """Places a piece and returns True if it fits.

        It fits if a passage remains to every other piece and to every wall that it does not touch.
        """
        floor, passage = self.floor, self._passage
        gaps = (
            piece.left - floor.left,
            floor.right - piece.right,
            piece.bottom - floor.bottom,
            floor.top - piece.top,
        )
        if any(gap != 0 and gap < passage for gap in gaps):
            return False
        if any(piece.grown(passage).overlaps(other) for other in self._taken):
            return False
        self.plan.block(piece)
        self._taken.append(piece)
        return True

    def place_pillar(self, col: int, row: int, radius: float) -> bool:
        """Places a round pillar and returns True if it fits.

        It fits if a passage remains to every wall and to every other piece.
        """
        size = self.plan.count(radius)
        piece = Box(col - size, row - size, col + size + 1, row + size + 1)
        if any(piece.grown(self._passage).overlaps(other) for other in self._taken):
            return False
        if not self.floor.grown(-self._passage).contains(piece):
            return False
        self.plan.pillar(col, row, radius)
        self._taken.append(piece)
        return True


def furnish_room(plan: Plan, dice: Dice, floor: Box, door: Box, side: int) -> None:
    """Furnishes a room by its size, as an office, a meeting room or an open-plan office. The door stays clear."""
    room = _Room(plan, floor, [door.grown(plan.count(0.3))])
    area = floor.width * floor.height * plan.resolution**2
    if area > 34.0 or (area > 20.0 and dice.chance(0.3)):
        if dice.chance(0.5):
            _islands(room, dice)
        else:
            _meeting(room, dice)
    else:
        _desks(room, dice, side)
    _shelves(room, dice)


def furnish_lobby(plan: Plan, dice: Dice, floor: Box, side: int) -> None:
    """Furnishes a lobby with a counter, round pillars and benches."""
    room = _Room(plan, floor, [])
    at = (floor.left + floor.right) // 2 + plan.count(dice.between(0.01, 1.0))
    back = floor.top - plan.count(2.2) if side > 0 else floor.bottom + plan.count(1.6)
    room.place(Box(at - plan.count(1.4), back, at + plan.count(1.4), back + plan.count(0.6)))
    for share in (0.22, 0.78):
        row = (floor.bottom + floor.top) // 2 - side * plan.count(0.8)
        room.place_pillar(floor.left + round(floor.width * share), row, 0.3)
    bench = plan.count(1.8)
    for left in (floor.left, floor.right - plan.count(0.5)):
        if dice.chance(0.7):
            bottom = floor.bottom + (floor.height - bench) // 2
            room.place(Box(left, bottom, left + plan.count(0.5), bottom + bench))


def _desks(room: _Room, dice: Dice, side: int) -> None:
    """Places desks along the outer wall and sometimes along a side wall."""
    plan, floor = room.plan, room.floor
    long, deep = plan.count(1.6), plan.count(0.8)
    back = floor.top - deep if side > 0 else floor.bottom
    for left in dice.shuffled([floor.left, floor.right - long]):
        room.place(Box(left, back, left + long, back + deep))
    if dice.chance(0.5):
        left = floor.left if dice.chance(0.5) else floor.right - deep
        bottom = floor.bottom + round((floor.height - long) * dice.between(0.35, 0.65))
        room.place(Box(left, bottom, left + deep, bottom + long))


def _meeting(room: _Room, dice: Dice) -> None:
    """Places a long table in the middle."""
    plan, floor = room.plan, room.floor
    space = 2 * plan.count(1.25)
    width, height = floor.width - space, floor.height - space
    along_x = width >= height
    width = min(width, plan.count(4.0 if along_x else 1.3))
    height = min(height, plan.count(1.3 if along_x else 4.0))
    if min(width, height) >= plan.count(0.6):
        left, bottom = (floor.left + floor.right - width) // 2, (floor.bottom + floor.top - height) // 2
        room.place(Box(left, bottom, left + width, bottom + height))


def _islands(room: _Room, dice: Dice) -> None:
    """Places islands of four desks, in rows and columns."""
    plan, floor = room.plan, room.floor
    width, height, gap = plan.count(dice.between(1.6, 2.0)), plan.count(1.6), plan.count(1.3)
    cols, rows = (floor.width - gap) // (width + gap), (floor.height - gap) // (height + gap)
    for col in range(cols):
        for row in range(rows):
            left = floor.left + gap + (floor.width - gap) * col // cols
            bottom = floor.bottom + gap + (floor.height - gap) * row // rows
            if dice.chance(0.9):
                room.place(Box(left, bottom, left + width, bottom + height))


def _shelves(room: _Room, dice: Dice) -> None:
    """Places shelves along the side walls and a plant in a corner."""
    plan, floor = room.plan, room.floor
    deep = plan.count(0.4)
    for left in (floor.left, floor.right - deep):
        long = plan.count(dice.between(0.9, 2.4))
        bottom = floor.bottom + round((floor.height - long) * dice.between(0.0, 1.0))
        if dice.chance(0.6) and long < floor.height:
            room.place(Box(left, bottom, left + deep, bottom + long))
    plant = plan.count(0.4)
    corners = [(left, bottom) for left in (floor.left, floor.right - plant) for bottom in (floor.bottom, floor.top - plant)]
    left, bottom = dice.one_of(corners)
    if dice.chance(0.5):
        room.place(Box(left, bottom, left + plant, bottom + plant))
