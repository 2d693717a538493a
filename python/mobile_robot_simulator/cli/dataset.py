"""The command `dataset`: makes a data set of scans from a plan, verifies one, or exports its drives."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator, Mapping
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
EXPORT = "export"


class Engine(str, Enum):
    """What makes the scans."""

    threads = "threads"
    ray = "ray"


class Format(str, Enum):
    """What drives are exported to."""

    minari = "minari"
    lerobot = "lerobot"


def dataset(
    plan: Annotated[
        str,
        typer.Argument(
            metavar="PLAN|verify|export",
            help="YAML file of the plan; or the word verify, to verify a data set; or export, to export its drives.",
        ),
    ],
    folder: Annotated[
        Path | None, typer.Argument(metavar="[DIR]", help="Data set to verify or export.", show_default=False)
    ] = None,
    out: Annotated[Path | None, typer.Option(metavar="DIR", help="Folder of the data set, or of the export.")] = None,
    format: Annotated[
        Format | None, typer.Option(help="For export: the library that shall open the drives as episodes.")
    ] = None,
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
        Path | None,
        typer.Option(
            metavar="DIR",
            help="For verify: folder that names of map files in the plan are relative to. Without it, this folder.",
        ),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print events as JSON, one a line.")] = False,
) -> None:
    """Make a data set of scans from a plan, go on with one, verify one, or export its drives as episodes.

    If DIR has a part of the data set, only what is missing is made. The exit status is 0 if all went well, 3 if verify found
    a shard that differs, and 1 if something is invalid or cannot be read or written.
    """
    options = {
        "--out": out,
        "--format": format,
        "--dry-run": dry_run or None,
        "--threads": threads,
        "--engine": None if engine == Engine.threads else engine.value,
        "--address": address,
        "--sample": sample,
        "--maps": maps,
    }
    if plan == VERIFY:
        if folder is None:
            raise ValueError("verify needs the folder of a data set: dataset verify DIR")
        _check_options("verify", options, "--sample", "--maps")
        _verify(folder, sample, maps or Path(), as_json=as_json)
        return
    if plan == EXPORT:
        if folder is None or out is None or format is None:
            raise ValueError("export needs folders and a format: dataset export DIR --format minari --out DIR")
        _check_options("export", options, "--format", "--out")
        _export(folder, format, out, as_json=as_json)
        return
    if folder is not None:
        given = f"got {folder}; give the folder of a new data set as --out DIR"
        raise ValueError(f"only verify and export have a second argument, {given}")
    if dry_run:
        _check_options("--dry-run", options, "--dry-run", "--threads", "--out")
        _estimate(Path(plan), threads, as_json=as_json)
        return
    if out is None:
        raise ValueError("a data set needs a folder: give --out DIR, or --dry-run")
    _check_options("a plan", options, "--out", "--threads", "--engine", "--address")
    from ..datasets import generate

    with _shown(as_json=as_json) as show:
        report = generate(Path(plan), out=out, threads=threads, engine=engine.value, address=address, progress=show)
    if as_json:
        _event("complete", path=str(report.path), scans=report.scans, made=report.made, seconds=round(report.seconds, 3))
        return
    rate = f", {report.scans / report.seconds:.0f} scans/s" if report.made == report.shards else ""
    text = f"{report.path}: {report.scans} scans in {report.shards} shards, {report.made} of them made"
    console.print(f"{text} in {report.seconds:.1f} s{rate}", markup=False, highlight=False, soft_wrap=True)


def _check_options(name: str, options: Mapping[str, object], *allowed: str) -> None:
    """Raises if an option is given that has no effect."""
    for option, value in options.items():
        if value is not None and option not in allowed:
            raise ValueError(f"{name} takes no {option}; it takes {', '.join(allowed)} and --json")


def _export(folder: Path, form: Format, out: Path, *, as_json: bool) -> None:
    from ..datasets import export

    episodes = export(folder, format=form.value, out=out)
    if as_json:
        _event("exported", path=str(out), episodes=episodes)
        return
    counts = ", ".join(f"{count} episodes of {split}" for split, count in episodes.items())
    console.print(f"{out}: {counts}", markup=False, highlight=False, soft_wrap=True)


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

    try:
        found = verify(folder, sample=sample, folder=maps)
    except FileNotFoundError as error:
        if error.filename != str(maps):
            raise
        hint = "give the folder of the plan as --maps DIR"
        raise FileNotFoundError(error.errno, f"{error.strerror}; {hint}", error.filename) from None
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
