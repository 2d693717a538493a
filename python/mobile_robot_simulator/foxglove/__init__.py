"""Foxglove: a simulation shown in the Foxglove app, and controlled from it.

`FoxgloveServer` needs the extra `foxglove` and is imported when it is first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .server import FoxgloveServer

__all__ = ["FoxgloveServer"]


def __getattr__(name: str) -> Any:
    """Imports the server when it is first used."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.server"), name)
