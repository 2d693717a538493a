"""Logger of a node on the bus."""

from __future__ import annotations

import logging
from typing import Any

from ..handle import Handle
from ..instant import NANOSECONDS
from .clock import Clock


class Logger(Handle):
    """Notes of a node, handed on to the standard library's logging; rclpy's names and keywords."""

    def __init__(self, clock: Clock, name: str) -> None:
        self._clock, self._logger = clock, logging.getLogger(f"mobile_robot_simulator.{name}")
        self._last: dict[str, int] = {}

    @property
    def name(self) -> str:
        """The logger's name."""
        return self._logger.name

    def debug(self, message: str, **how: Any) -> bool:
        """What only its author wants to know."""
        return self._log(logging.DEBUG, message, **how)

    def info(self, message: str, **how: Any) -> bool:
        """What is going on."""
        return self._log(logging.INFO, message, **how)

    def warning(self, message: str, **how: Any) -> bool:
        """What should not be."""
        return self._log(logging.WARNING, message, **how)

    warn = warning

    def error(self, message: str, **how: Any) -> bool:
        """What went wrong."""
        return self._log(logging.ERROR, message, **how)

    def fatal(self, message: str, **how: Any) -> bool:
        """What is the end."""
        return self._log(logging.CRITICAL, message, **how)

    def save(self) -> Any:
        """When what does not come each time came last."""
        return dict(self._last)

    def restore(self, state: Any) -> None:
        """Be as when the state was saved."""
        self._last = dict(state)

    def _log(
        self, level: int, message: str, *, once: bool = False, throttle_duration_sec: float | None = None, **_: Any
    ) -> bool:
        now, last = self._clock.now().nanoseconds, self._last.get(message)
        throttled = throttle_duration_sec is not None and last is not None
        if last is not None and (once or (throttled and 0 <= now - last < float(throttle_duration_sec or 0) * NANOSECONDS)):
            return False
        if once or throttle_duration_sec is not None:
            self._last[message] = now
        self._logger.log(level, "%s", message)
        return True
