"""Recordings: messages written to ROS 2 bags (MCAP, SQLite) and ROS 1 bags.

`Recorder` needs the extra `recording` and is imported when it is first used. `DeferredRecorder` keeps messages without the
extra, and needs it only to save them.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from .deferred import DeferredRecorder
from .format import Format

if TYPE_CHECKING:
    from .recorder import Recorder, recover

__all__ = ["DeferredRecorder", "Format", "Recorder", "recover"]


def __getattr__(name: str) -> Any:
    """Imports the recorder when it is first used."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.recorder"), name)
