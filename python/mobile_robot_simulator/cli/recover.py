"""The command `recover`: a complete recording from one that was broken off."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .console import console
from .run import COMPANIONS


def recover(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="Folder given to --out.")],
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace an older recording in the folder, with its summary and picture.")
    ] = False,
) -> None:
    """Recover a recording that was broken off, for example because the process was killed or the disk was full."""
    from ..recording.recorder import recover as recover_recording

    path, count = recover_recording(folder, overwrite=overwrite, companions=COMPANIONS)
    console.print(f"{path}: {count} messages", highlight=False, soft_wrap=True)
