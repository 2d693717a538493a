"""Checks of the arguments that searches and estimates have in common. Errors name arguments as the caller gave them."""

from __future__ import annotations

import os
from pathlib import Path

from ..quoting import quoted
from ..requirements.formula import Requirement
from ..scenarios.space import Space

__all__ = ["check_corpus", "check_flags", "check_progress", "check_task"]


def check_task(space: object, requirement: object, **controllers: object) -> None:
    """Checks what is to be driven.

    Args:
        space: The worlds.
        requirement: The requirement.
        **controllers: The controllers, each under its name.

    Raises:
        TypeError: One has a wrong type.
    """
    for name, controller in controllers.items():
        if not callable(controller):
            raise TypeError(f"{name} must be a function of the simulation, got {quoted(controller)}")
    if not isinstance(space, Space):
        raise TypeError(f"space must be a scenarios.Space, got {quoted(space)}")
    if not isinstance(requirement, Requirement):
        raise TypeError(f"requirement must be a requirement such as always(clearance > 0.2), got {quoted(requirement)}")


def check_flags(**flags: object) -> None:
    """Checks arguments that are True or False.

    Args:
        **flags: The arguments, each under its name.

    Raises:
        TypeError: One is something else.
    """
    for name, flag in flags.items():
        if not isinstance(flag, bool):
            raise TypeError(f"{name} must be True or False, got {quoted(flag)}")


def check_progress(progress: object) -> None:
    """Checks what is called after each drive.

    Args:
        progress: A function, or None.

    Raises:
        TypeError: It is something else.
    """
    if progress is not None and not callable(progress):
        raise TypeError(f"progress must be a function or None, got {quoted(progress)}")


def check_corpus(corpus: object) -> Path | None:
    """Returns the absolute path of the folder of counterexamples, None if there is none.

    Args:
        corpus: The folder, which need not exist, or None.

    Raises:
        TypeError: It is no path.
        NotADirectoryError: It is a file.
    """
    if corpus is None:
        return None
    if not isinstance(corpus, str | os.PathLike) or isinstance(os.fspath(corpus), bytes):
        raise TypeError(f"corpus must be a text, a Path or None, got {quoted(corpus)}")
    folder = Path(corpus)
    if folder.exists() and not folder.is_dir():
        raise NotADirectoryError(f"corpus must be a folder, got the file {folder}")
    return folder.absolute()  # A controller may change the working directory.
