"""LostDrive: a drive whose process ended before the drive did."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

from ..new_files import write_files
from ..scenarios.world import World
from ..user_files import read_text
from ..worker_pool import how_it_ended
from .case import Case, repeat_command

__all__ = ["WORLD_FILE", "LostDrive", "load_world"]

WORLD_FILE = "world.json"


class LostDrive(ChildProcessError):
    """A process ended while it ran a drive: something killed it, such as a lack of memory, or the controller ended it.

    The message says how to repeat the drive.

    Attributes:
        world: The world of the drive.
        number: Number of the drive in the search, from 1 on; None if it is one of the corpus or of the shrinking.
        exit_code: Exit code of the process; the number of a signal, negative, if that ended it.
        failure: Folder of the failure that was being shrunk, None if there was none.
    """

    def __init__(
        self,
        world: World,
        number: int | None,
        exit_code: int,
        repeat_with: str | None = None,
        failure: Path | None = None,
    ) -> None:
        if repeat_with is None:
            text = json.dumps(json.loads(world.to_json()))
            repeat_with = f"run_drive(World.from_json(text), controller, requirement), where text = {text!r}"
        drive, ended = "a drive" if number is None else f"drive {number}", how_it_ended(exit_code)
        found = "" if failure is None else f"; the failure that was being shrunk is in {failure}"
        super().__init__(
            f"the process of {drive} {ended} before the drive was over{found}; repeat the drive with: {repeat_with}"
        )
        self.world, self.number, self.exit_code, self.failure = world, number, exit_code, failure

    def saved(self, corpus: Path, case: Case | None, failure: Path | None = None) -> LostDrive:
        """Saves the world and returns an error that names its file.

        Args:
            corpus: Folder of counterexamples. It is made if it does not exist.
            case: File of the controller and the requirement, or None.
            failure: Folder of the failure that was being shrunk, or None.

        Raises:
            OSError: The file cannot be written.
        """
        world = replace(self.world, map=self.world.map.in_folder(corpus / WORLD_FILE))
        file = corpus / world.name / WORLD_FILE
        file.parent.mkdir(parents=True, exist_ok=True)
        write_files({file: world.to_json().encode()})
        command = f"run_drive(load_world({str(file)!r}), controller, requirement)"
        if case is not None:
            command = repeat_command(case.file, file)
        return LostDrive(self.world, self.number, self.exit_code, command, failure)


def load_world(file: Path) -> World:
    """Reads the world of a drive that was lost.

    Args:
        file: Its file, `world.json`.

    Raises:
        OSError: The file cannot be read.
        ValueError: It is not a world.
    """
    world = World.from_json(read_text(file, 10_000_000))
    return replace(world, map=world.map.from_folder(file.parent))
