"""WaitingLog: says what a node waits for, and what it has once it has it."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ..handle import Handles
from .interface import Node

CHECK_PERIOD = 1.0
"""Wall time between two checks of what is missing [s]."""

FIRST_REPORT = 3
"""Number of checks in a row that must find something missing before it is logged. The wait is then at least 2 s long."""

REPORT_PERIOD = 10
"""Number of checks between two reports."""


class WaitingLog:
    """Logs what a node waits for: after 2 s, then every 10 s. When the node has it, the log says that too.

    All times are wall times, because a node may be waiting for simulated time. On the bus they are simulated times.

    Args:
        node: Node that waits.
        name: Name of the waiting node in the messages.
        find_missing: Returns what is missing now: for each thing its name and how the node gets it, or why it does not.
    """

    def __init__(self, node: Node, name: str, find_missing: Callable[[], Mapping[str, str]]) -> None:
        self._node, self._name, self._find_missing = node, name, find_missing
        self._last_time_ns = -1
        self._checks_missing = 0
        self._checks_since_report = REPORT_PERIOD
        self._reported: list[str] = []

    def start(self, handles: Handles) -> None:
        """Starts to check.

        Args:
            handles: Takes what has to be released to stop.
        """
        self._last_time_ns, self._checks_missing = -1, 0
        timer = self._node.create_wall_timer(CHECK_PERIOD, self._check)
        handles.add(self._node.destroy_timer, timer)

    def _check(self) -> None:
        missing = {**self._find_missing_time(), **self._find_missing()}
        log = self._node.get_logger()
        arrived = [thing for thing in self._reported if thing not in missing]
        if arrived:
            log.info(f"{self._name} has {' and '.join(arrived)} now")
            self._reported = [thing for thing in self._reported if thing in missing]
        self._checks_since_report += 1
        self._checks_missing = self._checks_missing + 1 if missing else 0
        if self._checks_missing >= FIRST_REPORT and self._checks_since_report >= REPORT_PERIOD:
            self._checks_since_report, self._reported = 0, list(missing)
            log.warning(f"{self._name} waits for {'; '.join(f'{thing} ({how})' for thing, how in missing.items())}")

    def _find_missing_time(self) -> dict[str, str]:
        """Says that the time is missing if the node's clock stands still."""
        before_ns, self._last_time_ns = self._last_time_ns, self._node.get_clock().now().nanoseconds
        if self._last_time_ns != before_ns:
            return {}
        state = f"which stands still at {before_ns * 1e-9:.2f} s" if before_ns else "where none has arrived"
        return {"the time": f"on topic /clock, {state}"}
