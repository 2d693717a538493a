"""Counterexample: a failed drive in a folder, with all that is needed to repeat it byte by byte."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from ..new_files import write_files
from ..requirements.formula import Requirement
from ..scenarios.world import World
from ..simulation.simulation import Simulation
from ..user_files import read_text
from .case import Case, repeat_command
from .digest import Digest
from .drive import Drive, Setup, check_world, run_drive

__all__ = ["FILE", "Counterexample"]

FILE, PICTURE = "counterexample.json", "drive.png"

TEST = '''"""A drive that violated {shown}.

Made by mobile-robot-simulator falsify. The test passes when the controller is repaired.
"""

from pathlib import Path

from mobile_robot_simulator.falsification import Counterexample


def test_counterexample_{name}():
    Counterexample.load(Path(__file__).with_name("{file}")).check()
'''


@dataclass(frozen=True)
class Counterexample:
    """A world in which a controller violated a requirement.

    Attributes:
        world: The world.
        robustness: Robustness when it was found.
        digest: Fingerprint of all messages of the drive.
        requirement: The requirement as a text.
        case: File that defines `controller` and `requirement`, or None.
        folder: Folder with the files, an absolute path.
    """

    world: World
    robustness: float
    digest: str
    requirement: str
    case: Path | None
    folder: Path

    @staticmethod
    def load(file: str | os.PathLike[str]) -> Counterexample:
        """Reads a counterexample.

        Args:
            file: Its file, `counterexample.json`.

        Raises:
            OSError: The file cannot be read.
            ValueError: It is not a counterexample.
        """
        path = Path(file)
        text = read_text(path, 10_000_000)
        try:
            values = json.loads(text)
            case, world = values["case"], World.from_json(json.dumps(values["world"]))
            return Counterexample(
                replace(world, map=world.map.from_folder(path.parent)),
                float(values["robustness"]),
                str(values["digest"]),
                str(values["requirement"]),
                None if case is None else (path.parent / case).resolve(),
                path.parent.absolute(),
            )
        except (ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
            raise ValueError(f"{path}: not a counterexample: {error}") from None

    @staticmethod
    def save(corpus: Path, drive: Drive, controller: Setup, requirement: Requirement) -> tuple[Counterexample, list[str]]:
        """Repeats a failed drive and saves it in a folder of its own: data, recording, picture and test.

        Args:
            corpus: Folder of counterexamples. It is made if it does not exist.
            drive: The drive.
            controller: The controller.
            requirement: The requirement.

        Returns:
            The counterexample, and notes on what could not be saved.

        Raises:
            OSError: A file cannot be written.
        """
        # The path of a map file is relative to the folder, so that the files can be moved together. The name of the folder
        # depends on it too, and is the same wherever they are.
        world = replace(drive.world, map=drive.world.map.in_folder(corpus / FILE))
        folder = corpus / world.name
        folder.mkdir(parents=True, exist_ok=True)
        digest, notes = Digest(), []
        recorder = None
        try:
            from ..recording.recorder import Recorder

            recorder = Recorder(folder, overwrite=True)
        except ImportError as error:
            notes.append(f"no recording: {error}")

        def prepare(sim: Simulation) -> None:
            sim.record(digest.write)
            if recorder is not None:
                sim.record(recorder.write)

        def finish(sim: Simulation) -> None:
            try:
                sim.draw(folder / PICTURE)
            except ImportError as error:
                notes.append(f"no picture: {error}")

        try:
            again = run_drive(drive.world, controller, requirement, prepare=prepare, finish=finish)
        finally:
            if recorder is not None:
                recorder.close()
        if again != drive:
            notes.append("the drive does not repeat: does the controller use random numbers or keep state between drives?")
        case = Case.of(controller, requirement)
        values = {
            "world": json.loads(world.to_json()),
            # JSON has no infinity.
            "robustness": repr(drive.robustness),
            "digest": digest.text(),
            "requirement": str(requirement),
            "case": None if case is None else Path(os.path.relpath(case.file, folder.resolve())).as_posix(),
        }
        files = {folder / FILE: (json.dumps(values, indent=2) + "\n").encode()}
        if case is None:
            notes.append(
                "no test: the file of the controller does not define it as controller, and the requirement as requirement"
            )
        else:
            # Messages of errors can have anything that would end the docstring.
            shown = f"{requirement}: {drive}".replace("\\", "\\\\").replace('"', '\\"')
            test = TEST.format(shown=shown, name=world.name, file=FILE)
            files[folder / f"test_counterexample_{world.name}.py"] = test.encode()
        write_files(files)
        return Counterexample.load(folder / FILE), notes

    @staticmethod
    def all_in(corpus: Path) -> Iterator[Counterexample]:
        """Yields the counterexamples of a folder, ordered by name.

        Args:
            corpus: The folder. It need not exist.

        Raises:
            OSError: A file cannot be read.
            ValueError: A file is not a counterexample.
        """
        for file in sorted(corpus.glob(f"*/{FILE}")):
            yield Counterexample.load(file)

    @property
    def command(self) -> str:
        """Command that repeats the drive; empty if there is no case."""
        if self.case is None:
            return ""
        return repeat_command(self.case, self.folder / FILE)

    def repeat(self, controller: Setup, requirement: Requirement) -> tuple[Drive, bool]:
        """Drives again.

        Args:
            controller: The controller.
            requirement: The requirement.

        Returns:
            The drive, and True if all its messages have the same bytes as when it was found.

        Raises:
            ValueError: The world cannot be simulated. The message gives the file.
        """
        check_world(self.world, self.folder / FILE)
        digest = Digest()
        drive = run_drive(self.world, controller, requirement, prepare=lambda sim: sim.record(digest.write))
        return drive, digest.text() == self.digest

    def check(self) -> None:
        """Drives again and checks that the requirement now holds.

        Raises:
            AssertionError: It is still violated. The message says whether the drive has the same bytes as when it was found.
            ValueError: There is no case.
            OSError: The file of the case is missing.
        """
        __tracebackhide__ = True
        if self.case is None:
            raise ValueError(f"{self.folder / FILE} names no file with a controller and a requirement")
        case = Case.load(self.case)
        drive, is_same = self.repeat(case.controller, case.requirement)
        if drive.failed:
            bytes_are = "the same bytes as when it was found" if is_same else "other bytes than when it was found"
            raise AssertionError(
                f"the drive violated {case.requirement}: {drive}\n  {bytes_are}\n  repeat with: {self.command}"
            )
