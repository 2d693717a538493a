"""Format: the names of the recording formats. This module needs no extra."""

from __future__ import annotations

from typing import Literal, TypeAlias

Format: TypeAlias = Literal["mcap", "bag", "sqlite3"]
"""`mcap` and `sqlite3` are for ROS 2 Humble and later, `bag` is for ROS 1."""
