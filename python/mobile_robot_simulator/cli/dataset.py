"""The command `dataset`: makes a data set of scans from a plan, or verifies one."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .console import console, dataset_bar, print_note, print_table

if TYPE_CHECKING:
    from ..datasets import Progress

DIFFERS = 3
"""Exit status if a shard differs."""

VERIFY = "verify"


class Engine(str, Enum):
    """What makes the scans."""

    threads = "threads"
    ray = "ray"


def dataset(
    plan: Annotated[
        str, typer.Argument(metavar="PLAN|verify", help="YAML file of the plan; or the word verify, to verify a data set.")
    ],
    folder: Annotated[Path | None, typer.Argument(metavar="[DIR]", help="Data set to verify.", show_default=False)] = None,
    out: Annotated[Path | None, typer.Option(metavar="DIR", help="Folder of the data set.")] = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Print numbers, sizes and time, and write nothing.")] = False,
    threads: Annotated[int | None, typer.Option(help="Number of threads. Without it, one per core.")] = None,
    engine: Annotated[
        Engine, typer.Option(help="What makes the scans: threads, or the workers of a Ray cluster.")
    ] = Engine.threads,
    address: Annotated[
        str | None, typer.Option(help="Address of the Ray cluster, such as auto. Without it, one starts on this machine.")
    ] = None,
    sample: Annotated[
        int | None, typer.Option(help="Verify only so many shards, chosen at random. Without it, all are verified.")
    ] = None,
    maps: Annotated[
        Path, typer.Option(metavar="DIR", help="For verify: folder that names of map files in the plan are relative to.")
    ] = Path(),
    as_json: Annotated[bool, typer.Option("--json", help="Print events as JSON, one a line.")] = False,
) -> None:
    """Make a data set of scans from a plan, go on with one, or verify one.

    If DIR has a part of the data set, only what is missing is made. The exit status is 0 if all went well, 3 if verify found
    a shard that differs, and 1 if something is invalid or cannot be read or written.
    """
    if plan == VERIFY:
        if folder is None:
            raise ValueError("verify needs the folder of a data set: dataset verify DIR")
        _verify(folder, sample, maps, as_json=as_json)
        return
    if folder is not None:
        raise ValueError(f"only verify has a second argument, got {folder}; give the folder of a new data set as --out DIR")
    if dry_run:
        _estimate(Path(plan), threads, as_json=as_json)
        return
    if out is None:
        raise ValueError("a data set needs a folder: give --out DIR, or --dry-run")
    from ..datasets import generate

    with _shown(as_json=as_json) as show:
        report = generate(Path(plan), out=out, threads=threads, engine=engine.value, address=address, progress=show)
    if as_json:
        _event("complete", path=str(report.path), scans=report.scans, made=report.made, seconds=round(report.seconds, 3))
        return
    rate = f", {report.scans / report.seconds:.0f} scans/s" if report.made == report.shards else ""
    text = f"{report.path}: {report.scans} scans in {report.shards} shards, {report.made} of them made"
    console.print(f"{text} in {report.seconds:.1f} s{rate}", markup=False, highlight=False, soft_wrap=True)


def _estimate(plan: Path, threads: int | None, *, as_json: bool) -> None:
    from ..datasets import estimate

    found = estimate(plan, threads=threads)
    if as_json:
        _event("estimate", **found._asdict())
        return
    rows = [(f"{split}", f"{scans} scans of {found.maps[split]} maps") for split, scans in found.scans.items()]
    rows += [
        ("shards", f"{found.shards}"),
        ("numbers", f"{found.raw_bytes / 1e6:.1f} MB"),
        ("files", f"about {found.stored_bytes / 1e6:.1f} MB"),
        ("time", f"about {found.seconds:.1f} s, if the disk is fast enough"),
    ]
    print_table(f"{plan}", rows)


def _verify(folder: Path, sample: int | None, maps: Path, *, as_json: bool) -> None:
    from ..datasets import verify

    found = verify(folder, sample=sample, folder=maps)
    if as_json:
        differences = [difference._asdict() for difference in found.differences]
        _event("verified", shards=found.shards, differences=differences, notes=found.notes)
    else:
        for note in found.notes:
            print_note(f"note: {note}")
        for shard, problem in found.differences:
            console.print(f"{shard}: {problem}", markup=False, highlight=False, soft_wrap=True)
        wrong = len({difference.shard for difference in found.differences})
        console.print(f"{found.shards} shards made again, {wrong} differ", highlight=False)
    if found.differences:
        raise typer.Exit(DIFFERS)


@contextmanager
def _shown(*, as_json: bool) -> Iterator[Callable[[Progress], None]]:
    """Yields a function that shows progress: as events, or as a bar, or not at all where the output is no terminal."""
    if as_json:
        yield lambda progress: _event("progress", **progress._asdict())
        return
    with dataset_bar() as show:
        yield lambda progress: show(progress.scans, progress.total)


def _event(event: str, **values: Any) -> None:
    print(json.dumps({"event": event, **values}))
    sys.stdout.flush()
