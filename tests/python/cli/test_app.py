"""The app: all subcommands, of which a command imports only its own."""

from __future__ import annotations

import subprocess
import sys

import pytest
from typer.testing import CliRunner

from mobile_robot_simulator.cli.app import app
from mobile_robot_simulator.cli.main import COMMANDS


def test_the_help_page_lists_all_commands() -> None:
    shown = CliRunner().invoke(app, ["--help"]).output
    assert all(f" {name} " in shown for name in COMMANDS)


@pytest.mark.parametrize("name", COMMANDS)
def test_each_command_has_a_help_page(name: str) -> None:
    ran = CliRunner().invoke(app, [name, "--help"])
    assert ran.exit_code == 0 and f" {name} " in ran.output.split("\n")[1]


LATER = {"numpy", "PIL", "yaml", "matplotlib", "rosbags", "mobile_robot_simulator.parameters"}
"""Modules that help pages do not need."""


@pytest.mark.parametrize("name", COMMANDS)
def test_a_help_page_imports_only_what_it_shows(name: str) -> None:
    later = LATER | {f"mobile_robot_simulator.cli.{'dataset' if name == 'live' else 'live'}"}
    later -= {"numpy", "yaml"} if name == "floor-plan" else set()  # it shows the kinds of floor plans
    code = (
        f"import sys; sys.argv[1:] = [{name!r}, '--help']\n"
        "from mobile_robot_simulator.cli import main\n"
        "try: main()\n"
        "except SystemExit: pass\n"
        f"print(*sorted({later} & set(sys.modules)))"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60)
    assert ran.stdout.splitlines()[-1] == ""


def test_a_command_ends_without_a_search_for_garbage() -> None:
    code = (
        "import atexit, gc, sys; sys.argv[1:] = ['--version']\n"
        "atexit.register(lambda: print(gc.get_freeze_count() > 0))\n"  # the first one is called last
        "from mobile_robot_simulator.cli import main\n"
        "main()"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60)
    assert ran.stdout.splitlines()[-1] == "True"
