"""Writes the pages of the documentation that are generated from the code: parameters and command line.

`make docs` runs it. The pages are committed, and a test fails if they differ from what this script writes.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

from mobile_robot_simulator.parameters import NODES, Parameters

REFERENCE = Path(__file__).parents[1] / "reference"


def pages() -> dict[Path, str]:
    """Returns the contents of the generated pages by file."""
    return {REFERENCE / "parameters.md": parameters_page(), REFERENCE / "command_line.md": command_line_page()}


def parameters_page() -> str:
    """Returns a page with all parameters of all nodes: name, default, meaning."""
    lines = [
        "# Parameters",
        "",
        "This page is generated from the code. `mobile-robot-simulator parameters` prints the same list as a YAML file",
        "for the option `--params-file`.",
    ]
    for model in NODES:
        summary = (model.__doc__ or "").strip().splitlines()[0]
        lines += ["", f"## {model.node_name}", "", summary, "", "| parameter | default | meaning |", "|---|---|---|"]
        for name, info in model.model_fields.items():
            meaning = (info.description or "").replace("|", "\\|").replace("[", "\\[")
            lines.append(f"| `{name}` | {default_of(model, name)} | {meaning} |")
    return "\n".join(lines) + "\n"


def default_of(model: type[Parameters], name: str) -> str:
    """Returns the default of a parameter as it is written in a YAML file."""
    default = model.model_fields[name].get_default()
    if model.model_fields[name].is_required():
        return "required"
    if default is None:
        return "not set"
    return f"`{json.dumps(default)}`"


def command_line_page() -> str:
    """Returns a page with the help texts of the command and of its subcommands, as Typer prints them."""
    command = [sys.executable, "-m", "typer", "mobile_robot_simulator.cli.app", "utils", "docs"]
    options = ["--name", "mobile-robot-simulator", "--title", "Command line"]
    text = subprocess.run([*command, *options], capture_output=True, text=True, check=True, timeout=60).stdout.strip()
    # Typer cuts long help texts in its list of commands. The whole text stands below the command's own heading.
    for cut in re.findall(r"^\* `(.+)`: .*\.\.\.$", text, re.MULTILINE):
        _, _, section = text.partition(f"## `mobile-robot-simulator {cut}`\n\n")
        whole = " ".join(section.partition("\n\n")[0].split())
        text = re.sub(rf"^\* `{cut}`: .*$", lambda _, line=f"* `{cut}`: {whole}": line, text, flags=re.MULTILINE)
    # Markdown would read square brackets outside of code as links.
    parts = text.split("```")
    parts[::2] = [part.replace("[", "\\[") for part in parts[::2]]
    return "```".join(parts) + "\n"


if __name__ == "__main__":
    for path, content in pages().items():
        path.write_text(content, encoding="utf-8")
