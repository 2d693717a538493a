"""Fails if a public name is missing from the API reference, or has no docstring.

Run after `mkdocs build`, which writes the inventory of all documented names.
"""

from __future__ import annotations

import inspect
import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType

from mkdocstrings import Inventory

import mobile_robot_simulator as package

INVENTORY = Path(__file__).parents[2] / "site" / "objects.inv"


def public_modules() -> list[ModuleType]:
    """Returns the package and its public submodules."""
    names = [name for name in dir(package) if not name.startswith("_") and _is_submodule(name)]
    return [package, *(import_module(f"{package.__name__}.{name}") for name in names)]


def _is_submodule(name: str) -> bool:
    folder = Path(package.__file__).parent
    return (folder / f"{name}.py").exists() or (folder / name).is_dir()


def problems(documented: set[str]) -> list[str]:
    """Returns a line for each public name that is not in the reference or has no docstring.

    Args:
        documented: Full names of all documented objects.
    """
    lines = []
    for module in public_modules():
        for name in module.__all__:
            path, value = f"{module.__name__}.{name}", getattr(module, name)
            if inspect.ismodule(value) or name == "__version__":
                continue
            if path not in documented:
                lines.append(f"{path} is not in the API reference")
            if (inspect.isclass(value) or inspect.isroutine(value)) and not inspect.getdoc(value):
                lines.append(f"{path} has no docstring")
            if inspect.isclass(value):
                lines += [f"{path}.{member} has no docstring" for member in _undocumented(value)]
    return lines


def _undocumented(cls: type) -> list[str]:
    """Returns the names of public methods and properties of a class that have no docstring."""
    members = [(name, value) for name, value in vars(cls).items() if not name.startswith("_")]
    return [
        name
        for name, value in members
        if (inspect.isroutine(value) or isinstance(value, property)) and not inspect.getdoc(getattr(cls, name))
    ]


def main() -> None:
    """Checks the built documentation; exits with an error if a name is missing."""
    with INVENTORY.open("rb") as file:
        found = problems(set(Inventory.parse_sphinx(file)))
    if found:
        sys.exit("\n".join(found))


if __name__ == "__main__":
    main()
