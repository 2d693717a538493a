"""Help pages: what `--help` shows of the options."""

from __future__ import annotations

from typing import Any

from typer.core import TyperCommand, TyperGroup


def _without_types_of_flags(options: list[Any]) -> list[Any]:
    """Gives flags an empty name for their value. Typer shows `<bool>` otherwise, as if they took one."""
    for option in options:
        if getattr(option, "is_flag", False) and option.metavar is None:
            option.metavar = ""
    return options


class Command(TyperCommand):
    """A command with such a help page."""

    def get_params(self, ctx: Any) -> list[Any]:
        """Returns the arguments and options."""
        return _without_types_of_flags(super().get_params(ctx))


class Group(TyperGroup):
    """A command with subcommands, and with such a help page."""

    def get_params(self, ctx: Any) -> list[Any]:
        """Returns the options."""
        return _without_types_of_flags(super().get_params(ctx))
