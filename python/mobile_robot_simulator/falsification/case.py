"""Case: a Python file that defines a controller, a space and a requirement."""

from __future__ import annotations

import importlib
import os
import shlex
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..requirements.formula import Requirement
from ..scenarios.space import Space
from ..user_files import open_regular
from .drive import Setup

__all__ = ["Case", "repeat_command"]


def repeat_command(case: Path, file: Path) -> str:
    """Returns the command that repeats a drive, for the present working directory.

    Args:
        case: File with the controller and the requirement.
        file: File with the world of the drive.
    """
    shown = (shlex.quote(os.path.relpath(path)) for path in (case, file))
    return "mobile-robot-simulator falsify {} --repeat {}".format(*shown)


@dataclass(frozen=True)
class Case:
    """A controller, a space and a requirement of a file.

    Attributes:
        file: The file.
        controller: Its attribute `controller`.
        requirement: Its attribute `requirement`.
        space: Its attribute `space`; None if it has none.
    """

    file: Path
    controller: Setup
    requirement: Requirement
    space: Space | None

    @staticmethod
    def load(file: str | os.PathLike[str]) -> Case:
        """Imports a file, with its folder in `sys.path` so that other processes can import it too.

        Args:
            file: The file, whose name is also that of its module.

        Raises:
            OSError: The file cannot be read or is not a regular file: FileNotFoundError if it is missing,
                IsADirectoryError if it is a folder.
            ValueError: The file has no controller or no requirement, or a different module of its name is imported already.
            Exception: Any error that the file raises.
        """
        open_regular(file).close()
        path = Path(file).resolve()
        if path.suffix != ".py" or not path.stem.isidentifier():
            raise ValueError(f"a case must be a Python file whose name is that of a module, got {file}")
        if str(path.parent) not in sys.path:
            sys.path.insert(0, str(path.parent))
        module = importlib.import_module(path.stem)
        imported = getattr(module, "__file__", None)
        if imported is None or Path(imported).resolve() != path:
            raise ValueError(f"{file} cannot be imported, because another module is named {path.stem}: {imported}")
        return Case._of(path, vars(module))

    @staticmethod
    def of(controller: Setup, requirement: Requirement) -> Case | None:
        """Returns the case that a controller and a requirement come from, None if their file does not define them as such.

        Args:
            controller: The controller.
            requirement: The requirement.
        """
        module = sys.modules.get(getattr(controller, "__module__", ""))
        file = getattr(module, "__file__", None)
        if file is None or getattr(module, "controller", None) is not controller:
            return None
        return Case._of(Path(file).resolve(), vars(module)) if getattr(module, "requirement", None) == requirement else None

    @staticmethod
    def _of(file: Path, names: dict[str, Any]) -> Case:
        controller, requirement, space = (names.get(name) for name in ("controller", "requirement", "space"))
        if not callable(controller):
            raise ValueError(f"{file} must define controller, a function or class that takes the simulation")
        if not isinstance(requirement, Requirement):
            raise ValueError(f"{file} must define requirement, such as always(clearance > 0.2)")
        if not isinstance(space, Space | None):
            raise ValueError(f"{file} must define space as a scenarios.Space, got {type(space).__name__}")
        return Case(file, controller, requirement, space)
