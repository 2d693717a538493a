"""Stamps: rules for the times of the messages of a topic."""

from __future__ import annotations

import statistics

from ..instant import NANOSECONDS
from .findings import Findings

JUMP = 5.0
"""A gap of this many usual periods is a jump."""

SHORTEST_JUMP_NS = 500_000_000
"""Gaps up to this one are no jumps [ns]."""

LATEST_NS = 500_000_000
"""Stamps up to this long after the time of recording count as on time [ns]. Clocks of two machines differ."""


class Stamps:
    """The stamps of a topic or of a transform, in the order of the bag."""

    def __init__(self, topic: str, what: str = "") -> None:
        self.topic, self._what = topic, f"{what}: " if what else ""
        self._stamps: list[tuple[int, int]] = []

    def add(self, findings: Findings, index: int, stamp: int, recorded: int | None = None) -> None:
        """Adds the stamp of a message, and checks it against the one before.

        Args:
            findings: Where findings go.
            index: Position of the message among those of its topic.
            stamp: The stamp [ns].
            recorded: Time of recording [ns]. None if stamps may be later.
        """
        before = self._stamps[-1][1] if self._stamps else None
        if stamp == 0 and (before is not None or (recorded or 0) > NANOSECONDS):
            findings.add("stamp-zero", self.topic, index, f"{self._what}stamp 0")
        elif before is not None and stamp < before:
            got = f"{self._what}{_shown(stamp)}, {_shown(before - stamp)} before the message before"
            findings.add("stamp-back", self.topic, index, got)
        elif stamp == before:
            findings.add("stamp-repeat", self.topic, index, f"{self._what}{_shown(stamp)} again")
        if recorded is not None and stamp > recorded + LATEST_NS:
            got = f"{self._what}{_shown(stamp)}, recorded {_shown(stamp - recorded)} earlier"
            findings.add("stamp-future", self.topic, index, got)
        self._stamps.append((index, stamp))

    def finish(self, findings: Findings, rule: str = "stamp-jump") -> None:
        """Checks for gaps, once all stamps are known.

        Args:
            findings: Where findings go.
            rule: Name of the rule.
        """
        pairs = zip(self._stamps, self._stamps[1:], strict=False)
        gaps = [(index, stamp - before) for (_, before), (index, stamp) in pairs if stamp > before]
        if not gaps:
            return
        usual = statistics.median(gap for _, gap in gaps)
        for index, gap in gaps:
            if gap > max(JUMP * usual, SHORTEST_JUMP_NS):
                got = f"{self._what}{_shown(gap)} after the message before; the usual period is {_shown(usual)}"
                findings.add(rule, self.topic, index, got)


def _shown(time_ns: float) -> str:
    return f"{time_ns / NANOSECONDS:.6g} s" if time_ns < 1e15 else f"{time_ns / NANOSECONDS:.3f} s"
