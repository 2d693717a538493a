"""Warehouses: racks of pallets along aisles, a loading zone and a small office."""

from __future__ import annotations

from .dice import Dice
from .plan import Box, Plan

_AISLE, _CROSS_AISLE, _RACK, _BAY = 2.8, 3.2, 1.1, 2.7  # [m]
_BAYS = 5  # average number of bays in a rack


def draw_warehouse(plan: Plan, dice: Dice) -> None:
    """Draws a hall with a loading zone on the left and racks on the right."""
    inside = plan.inside
    plan.block(inside.grown(plan.outer_wall))
    plan.carve(inside)
    loading = plan.count(min(6.5, 0.22 * inside.width * plan.resolution))
    _dock(plan, dice, Box(inside.left, inside.bottom, inside.left + loading, inside.top))
    _racks(plan, dice, Box(inside.left + loading, inside.bottom, inside.right, inside.top))


def _racks(plan: Plan, dice: Dice, floor: Box) -> None:
    """Draws rows of double racks along x, with an aisle on both sides of each row and cross aisles between the racks."""
    aisle, deep, bay = plan.count(_AISLE), plan.count(_RACK), plan.count(_BAY)
    cross = plan.count(_CROSS_AISLE)
    pitch = 2 * deep + aisle
    rows = max(1, (floor.height - aisle) // pitch)
    cols = max(1, round(floor.width / (_BAYS * bay + cross)))
    long = max(bay, floor.width // cols - cross)
    bays = long // bay
    for row in range(rows):
        bottom = floor.bottom + aisle + (floor.height - aisle) * row // rows
        for col in range(cols):
            left = floor.left + floor.width * col // cols
            for side in range(2):
                _rack(plan, dice, left, bottom + side * deep, bays, long // bays, fill=dice.between(0.45, 0.95))


def _rack(plan: Plan, dice: Dice, left: int, bottom: int, bays: int, bay: int, *, fill: float) -> None:
    """Draws the uprights of each bay and pallets in some bays. A small robot can drive through empty bays."""
    deep, post = plan.count(_RACK), max(2, plan.count(0.1))
    for number in range(bays + 1):
        for row in (bottom, bottom + deep - post):
            at = left + number * bay
            plan.block(Box(at, row, at + post, row + post))
    pallet, gap = plan.count(0.8), plan.count(0.12)
    for number in range(bays):
        start = left + number * bay + post + gap
        for place in range(3):
            if dice.chance(fill):
                at = start + place * (pallet + gap // 2)
                over = plan.count(dice.between(0.01, 0.1)) if dice.chance(0.5) else 0
                end = min(at + pallet, left + (number + 1) * bay)
                plan.block(Box(at, bottom + over, end, bottom + deep - over))


def _dock(plan: Plan, dice: Dice, floor: Box) -> None:
    """Draws the loading zone: gates in the wall, pallets on the floor, and an office in a corner."""
    gate, depth = plan.count(3.0), max(1, plan.outer_wall - 2)
    bottom = floor.bottom + plan.count(1.2)
    while bottom + gate < floor.top - plan.count(4.8):
        plan.carve(Box(floor.left - depth, bottom, floor.left, bottom + gate))
        for _ in range(dice.whole(0, 3)):
            left = floor.left + plan.count(dice.between(1.2, 3.4))
            low = bottom + plan.count(dice.between(0.01, 1.8))
            size = (plan.count(1.2), plan.count(0.8))
            width, height = size if dice.chance(0.5) else size[::-1]
            plan.block(Box(left, low, left + width, low + height))
        bottom += gate + plan.count(2.0)
    width, height = min(plan.count(3.6), floor.width - plan.count(1.5)), plan.count(3.2)
    if width < plan.count(2.0):
        return
    office = Box(floor.left, floor.top - height, floor.left + width, floor.top)
    plan.block(Box(office.left, office.bottom - plan.wall, office.right + plan.wall, office.top))
    plan.carve(office)
    at = office.bottom + plan.count(0.4)
    plan.carve(Box(office.right, at, office.right + plan.wall, at + plan.door))
    plan.block(Box(office.left, office.top - plan.count(0.8), office.left + plan.count(1.6), office.top))
