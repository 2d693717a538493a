"""Maps as messages: conversion in both directions, and what is refused."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import messages
from mobile_robot_simulator.nodes.map_messages import carries_grid, from_message, to_message, with_unknown

CELLS = np.array([[0, 100, -1], [59, 60, 1]], np.int8)


@pytest.fixture
def grid() -> mrs.OccupancyGrid:
    return mrs.OccupancyGrid(CELLS, resolution=0.05, origin=(1.0, -2.0, 0.3))


def test_the_message_holds_the_map_field_by_field(grid: mrs.OccupancyGrid) -> None:
    message = to_message(grid, "world")
    assert message.header == mrs.messages.Header(frame_id="world")
    assert (message.info.width, message.info.height, message.info.resolution) == (3, 2, 0.05)
    assert (message.info.origin.position.x, message.info.origin.position.y) == (1.0, -2.0)
    orientation = message.info.origin.orientation
    assert (orientation.x, orientation.y) == (0.0, 0.0)
    assert (orientation.z, orientation.w) == pytest.approx((math.sin(0.15), math.cos(0.15)), abs=1e-15)
    # Rows from the lower left.
    assert message.data.dtype == np.int8
    assert message.data.tolist() == [0, 100, -1, 59, 60, 1]
    assert type(message.info.width) is int and type(message.info.resolution) is float


def test_a_map_survives_a_round_trip(grid: mrs.OccupancyGrid) -> None:
    back = from_message(to_message(grid), unknown="occupied")
    assert np.array_equal(back.cells, grid.cells)
    assert tuple(back.origin) == pytest.approx(tuple(grid.origin), abs=1e-15)
    assert (back.resolution, back.unknown) == (0.05, "occupied")


@pytest.mark.parametrize("data", [[0, 100, -1, 59, 60, 1], (0, 100, -1, 59, 60, 1), CELLS.reshape(-1).astype(np.int64)])
def test_data_may_be_a_list(grid: mrs.OccupancyGrid, data: Any) -> None:
    message = to_message(grid)
    message.data = data
    assert np.array_equal(from_message(message).cells, CELLS)


def broken(**changes: Any) -> messages.OccupancyGrid:
    message = to_message(mrs.OccupancyGrid(CELLS, resolution=0.05))
    for name, value in changes.items():
        if name == "data":
            message.data = value
        elif name == "x":
            message.info.origin.position.x = value
        else:
            setattr(message.info, name, value)
    return message


@pytest.mark.parametrize(
    "message",
    [
        broken(data=np.zeros(5, np.int8)),
        broken(data=np.zeros(0, np.int8)),
        broken(data=np.full(6, 101, np.int8)),
        broken(data=[0, 0, 0, 0, 0, 200]),
        broken(data=np.array([0, 0, 0, 0, 0, 255], np.uint8)),
        broken(data=np.array([0, 0, 0, 0, 0, 0.5])),
        broken(data=["a"] * 6),
        broken(width=0, height=0, data=np.zeros(0, np.int8)),
        broken(width=-3, height=-2),
        broken(width=6, height=2),
        broken(resolution=0.0),
        broken(resolution=math.nan),
        broken(x=math.inf),
    ],
    ids=[
        "short",
        "none",
        "101",
        "list of 200",
        "uint8",
        "float",
        "text",
        "empty",
        "negative",
        "wide",
        "point",
        "nan",
        "inf",
    ],
)
def test_an_invalid_map_is_refused(message: messages.OccupancyGrid) -> None:
    with pytest.raises(ValueError):
        from_message(message)


def test_a_float32_resolution_becomes_the_decimal_it_stands_for() -> None:
    message = to_message(mrs.OccupancyGrid(np.zeros((2, 2), np.int8), resolution=0.05))
    message.info.resolution = float(np.float32(0.05))
    assert from_message(message).resolution == 0.05


@pytest.mark.parametrize("change", [{}, {"origin": (1.0, -2.0, 0.2)}, {"resolution": 0.1}, {"cells": CELLS[::-1]}])
def test_a_message_carries_a_grid_only_if_cells_resolution_and_origin_agree(
    grid: mrs.OccupancyGrid, change: dict[str, Any]
) -> None:
    values = {"cells": CELLS, "resolution": 0.05, "origin": (1.0, -2.0, 0.3), **change}
    other = mrs.OccupancyGrid(values.pop("cells"), **values)
    assert carries_grid(to_message(other), grid) == (not change)


def test_with_unknown_changes_only_how_unknown_cells_are_treated(grid: mrs.OccupancyGrid) -> None:
    occupied = with_unknown(grid, "occupied")
    assert (grid.unknown, occupied.unknown) == ("free", "occupied")
    assert carries_grid(to_message(occupied), grid) and occupied.occupied_threshold == grid.occupied_threshold
