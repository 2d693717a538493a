"""Tools for tests of robot code: assertions on simulations, a stand-in for rclpy, and the pytest plugin.

pytest loads this package at every start, in all projects. To keep that fast, public names are imported at their first use.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .assertions import assert_clearance, assert_no_contact, assert_rate, assert_reaches, assert_scan_close
    from .rclpy_shim import stand_in
    from .requirement_assertions import assert_always, assert_holds
    from .strategies import disturbances, faults, poses, worlds

__all__ = [
    "assert_always",
    "assert_clearance",
    "assert_holds",
    "assert_no_contact",
    "assert_rate",
    "assert_reaches",
    "assert_scan_close",
    "disturbances",
    "faults",
    "poses",
    "stand_in",
    "worlds",
]

_MODULES = {
    "assert_always": "requirement_assertions",
    "assert_holds": "requirement_assertions",
    "disturbances": "strategies",
    "faults": "strategies",
    "poses": "strategies",
    "stand_in": "rclpy_shim",
    "worlds": "strategies",
}
"""Modules of the names that are not in `assertions`."""


def __getattr__(name: str) -> Any:
    """Imports a public name when it is first used."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_MODULES.get(name, 'assertions')}"), name)
