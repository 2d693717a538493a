"""The command `audit`: whether a bag keeps the conventions of ROS."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from .console import console, print_table

FOUND = 3
"""Exit status if something breaks a rule."""

SHOWN = 5
"""Number of indices that a finding shows."""


def audit(
    bag: Annotated[Path, typer.Argument(metavar="BAG", help="ROS 1 bag, ROS 2 bag, MCAP file, or folder given to --out.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print the findings as JSON.")] = False,
) -> None:
    """Check whether the scans, odometry and transforms of a bag keep the conventions of ROS.

    The exit status is 0 if they do, 3 if they do not, and 1 if the bag cannot be read.
    """
    from ..audit import audit_bag

    result = audit_bag(bag)
    if as_json:
        findings = [
            {
                "rule": each.rule,
                "topic": each.topic,
                "count": each.count,
                "indices": each.indices,
                "got": each.got,
                "expected": each.expected,
            }
            for each in result.findings
        ]
        print(json.dumps({"bag": str(result.path), "messages": result.counts, "findings": findings}))
    else:
        print_table(f"{result.path}", [(topic, f"{count} messages") for topic, count in result.counts.items()])
        for each in result.findings:
            more = ", ..." if each.count > SHOWN else ""
            where = f"message{'s' if each.count > 1 else ''} {', '.join(map(str, each.indices[:SHOWN]))}{more}"
            text = f"{each.topic} {where}: {each.rule}: {each.expected}; got {each.got}"
            if each.count > 1:
                text += f" ({each.count} messages)"
            console.print(text, markup=False, highlight=False, soft_wrap=True)
        console.print(f"{len(result.findings)} findings" if result.findings else "no findings", highlight=False)
    if result.findings:
        raise typer.Exit(FOUND)
