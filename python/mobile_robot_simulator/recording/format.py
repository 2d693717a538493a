"""Format: the names of the formats of a recording. Needs no extra."""

from __future__ import annotations

from typing import Literal, TypeAlias

Format: TypeAlias = Literal["mcap", "bag", "sqlite3"]
"""MCAP or SQLite for ROS 2 Humble and later, or bag for ROS 1."""
