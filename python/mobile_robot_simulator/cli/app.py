"""The app with all subcommands, for the tools of Typer."""

from __future__ import annotations

from .main import COMMANDS, app_of

app = app_of(COMMANDS)
