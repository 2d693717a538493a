"""Logger of a node on the bus."""

from __future__ import annotations

import logging
from typing import Any, Protocol

from ..handle import Handle
from ..instant import NANOSECONDS, Instant


class LoggerClock(Protocol):
    """Tells the time, for throttled messages."""

    def now(self) -> Instant:
        """Returns the current time."""


class BusLogger(Handle):
    """Forwards a node's log messages to Python's `logging`, with the method names and keywords of rclpy.

    All methods that log return True if they logged the message, and take two keywords; others are ignored. With `once=True`,
    the same message is logged only the first time. With `throttle_duration_sec`, the same message is logged again only after
    this time on the node's clock [s].

    Args:
        clock: The node's clock.
        name: Name of the node. The name of the logger is `mobile_robot_simulator.<name>`.
    """

    def __init__(self, clock: LoggerClock, name: str) -> None:
        self._clock, self._logger = clock, logging.getLogger(f"mobile_robot_simulator.{name}")
        self._last_logged_ns: dict[str, int] = {}

    @property
    def name(self) -> str:
        """Name of the logger in Python's `logging`."""
        return self._logger.name

    def debug(self, message: str, **options: Any) -> bool:
        """Logs a detail for debugging the node."""
        return self._log(logging.DEBUG, message, **options)

    def info(self, message: str, **options: Any) -> bool:
        """Logs normal progress."""
        return self._log(logging.INFO, message, **options)

    def warning(self, message: str, **options: Any) -> bool:
        """Logs a problem that the node can work around."""
        return self._log(logging.WARNING, message, **options)

    warn = warning

    def error(self, message: str, **options: Any) -> bool:
        """Logs an operation that failed."""
        return self._log(logging.ERROR, message, **options)

    def fatal(self, message: str, **options: Any) -> bool:
        """Logs a failure that the node cannot recover from."""
        return self._log(logging.CRITICAL, message, **options)

    def save(self) -> dict[str, int]:
        """Returns the time at which each `once` or throttled message was last logged [ns]."""
        return dict(self._last_logged_ns)

    def restore(self, state: dict[str, int]) -> None:
        """Puts the logger back into a saved state."""
        self._last_logged_ns = dict(state)

    def _log(
        self, level: int, message: str, *, once: bool = False, throttle_duration_sec: float | None = None, **_: Any
    ) -> bool:
        now, last = self._clock.now().nanoseconds, self._last_logged_ns.get(message)
        throttled = throttle_duration_sec is not None and last is not None
        if last is not None and (once or (throttled and 0 <= now - last < float(throttle_duration_sec or 0) * NANOSECONDS)):
            return False
        if once or throttle_duration_sec is not None:
            self._last_logged_ns[message] = now
        self._logger.log(level, "%s", message)
        return True
