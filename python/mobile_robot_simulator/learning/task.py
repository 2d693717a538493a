"""The task of a navigation environment: what the robot is, where it drives, and what it is rewarded for."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from .._core import BeamModel, LaserScanner, Limits, OccupancyGrid, Shape
from ..quoting import quoted
from ..scenarios import Moving
from .plans import training_plans

PARTS = {"progress": 1.0, "goal": 10.0, "contact": -10.0, "time": -0.1, "turning": 0.0}
"""Parts of the reward and their default weights."""

FACTORS = ("velocity", "acceleration", "deceleration")
"""Limits on the motion that can be randomised, by a factor."""

NOISE = (
    "sigma_hit",
    "lambda_short",
    "z_hit",
    "z_short",
    "z_max",
    "z_rand",
    "range_offset",
    "range_sigma_base",
    "range_sigma_per_metre",
    "range_step",
    "range_step_share",
)
"""Numbers of the noise that can be randomised."""


class Disturbance(NamedTuple):
    """What is random about a robot in an episode."""

    noise: BeamModel | None
    """Noise of the ranges."""
    slip: float
    """Share of the commanded motion that slipping wheels lose."""
    limits: Limits | None
    """Limits on the velocity and its change."""


@dataclass(frozen=True, kw_only=True)
class NavigationTask:
    """What an environment of navigation is: drive to a goal without touching anything.

    Args:
        worlds: Maps; each episode takes place in one of them, drawn at random. None means eight office floors:
            `training_plans(8)`.
        scanner: The scanner on the robot. None means 64 beams around it, up to 10 m.
        noise: Noise of the ranges. None means true ranges.
        footprint: Outline of the robot.
        limits: Limits on the velocity and its change. None means that a velocity is taken at once.
        max_velocity: Velocity that an action of 1 stands for: (v, ω) for a robot that drives ahead and turns, or (vx,
            vy, ω) for one that also drives sideways [m/s, m/s, rad/s]. The number of actions is that of these numbers.
        duration: Duration of a step [s].
        time_limit: Duration of an episode after which it is truncated [s].
        goal_radius: Distance from the goal at which it is reached [m].
        goal_distances: Least and largest distance in a straight line from the start to the goal [m].
        clearance: Least free distance around the footprint at a start, at a goal and on some way between them [m].
        obstacles: Discs that move to and fro, drawn for each episode, at speeds of at most 100 m/s; None for none. They
            have no part in what a goal that can be reached is.
        rewards: Weights of the parts of the reward: `progress` counts the metres by which the goal came nearer, `goal`
            is 1 for reaching it, `contact` 1 for touching something, `time` the seconds of the step, `turning` the
            radians turned. Parts that are not named keep the default: progress 1, goal 10, contact -10, time -0.1,
            turning 0.
        randomisation: Ranges (low, high) of numbers that are drawn for each episode: those of `BeamModel` (`sigma_hit`,
            `z_short`, ...; the weights are scaled to sum to 1), `slip`, the share of the commanded motion that
            slipping wheels lose, and `velocity`, `acceleration` and `deceleration`, factors on those `limits`.

    Raises:
        ValueError: A value is out of range, not finite or unknown.
        TypeError: An argument has the wrong type.

    Example:
        >>> NavigationTask(max_velocity=(0.5, 0.5, 1.0)).max_velocity
        (0.5, 0.5, 1.0)
    """

    worlds: Sequence[OccupancyGrid] | OccupancyGrid | None = None
    scanner: LaserScanner | None = None
    noise: BeamModel | None = field(default_factory=BeamModel)
    footprint: Shape = field(default_factory=lambda: Shape.disc(0.2))
    limits: Limits | None = None
    max_velocity: Sequence[float] = (0.6, 1.5)
    duration: float = 0.1
    time_limit: float = 60.0
    goal_radius: float = 0.3
    goal_distances: tuple[float, float] = (2.0, 8.0)
    clearance: float = 0.05
    obstacles: Moving | None = None
    rewards: Mapping[str, float] = field(default_factory=dict)
    randomisation: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        worlds = training_plans(8) if self.worlds is None else self.worlds
        self._set("worlds", [worlds] if isinstance(worlds, OccupancyGrid) else _listed("worlds", worlds))
        if self.scanner is None:
            self._set("scanner", LaserScanner(fov=math.tau, beam_count=64, max_range=10.0))
        for name, kind in (("scanner", LaserScanner), ("footprint", Shape)):
            if not isinstance(getattr(self, name), kind):
                raise TypeError(f"{name} must be a {kind.__name__}, got {quoted(getattr(self, name))}")
        for name, other in (("noise", BeamModel), ("limits", Limits), ("obstacles", Moving)):
            if not isinstance(getattr(self, name), (other, type(None))):
                raise TypeError(f"{name} must be a {other.__name__} or None, got {quoted(getattr(self, name))}")
        if not self.grids or not all(isinstance(world, OccupancyGrid) for world in self.grids):
            raise TypeError(f"worlds must be one or more OccupancyGrid, got {quoted(self.worlds)}")
        for name in ("time_limit", "goal_radius"):
            self._set(name, _number(name, getattr(self, name), "above 0", low=5e-324))
        self._set("duration", _number("duration", self.duration, "at least 1e-9 and at most 1e6", low=1e-9, high=1e6))
        self._set("clearance", _number("clearance", self.clearance, "at least 0", low=0.0))
        needed = "above 0 and at most 1000"
        axes = _listed("max_velocity", self.max_velocity)
        velocity = tuple(_number("max_velocity", axis, needed, low=5e-324, high=1e3) for axis in axes)
        if len(velocity) not in (2, 3):
            raise ValueError(f"max_velocity must be (v, ω) or (vx, vy, ω), got {len(velocity)} numbers")
        self._set("max_velocity", velocity)
        self._set("goal_distances", _range("goal_distances", self.goal_distances))
        if self.goal_distances[0] <= self.goal_radius:
            text = (
                f"goals must be farther than goal_radius, {self.goal_radius:g} m, got goal_distances {self.goal_distances}"
            )
            raise ValueError(text)
        if self.obstacles is not None:
            _number("obstacles.radius.low", self.obstacles.radius.low, "above 0", low=5e-324)
            _number("obstacles.speed.high", self.obstacles.speed.high, "at most 100 m/s", high=100.0)
        for name in ("rewards", "randomisation"):
            if not isinstance(getattr(self, name), Mapping):
                raise TypeError(f"{name} must be a dict, got {quoted(getattr(self, name))}")
        for name in self.rewards:
            if name not in PARTS:
                raise ValueError(f"rewards must be of {', '.join(PARTS)}, got {quoted(name)}")
        weights = {name: _number(f"rewards[{name!r}]", weight, "finite") for name, weight in self.rewards.items()}
        self._set("rewards", {**PARTS, **weights})
        for name in self.randomisation:
            if name not in (*NOISE, *FACTORS, "slip"):
                raise ValueError(f"randomisation must be of {', '.join((*NOISE, *FACTORS))}, slip, got {quoted(name)}")
            if name in FACTORS and self.limits is None:
                raise ValueError(f"randomisation[{name!r}] needs limits, got limits=None")
        ranges = {name: _range(f"randomisation[{name!r}]", limits) for name, limits in self.randomisation.items()}
        self._set("randomisation", ranges)
        for numbers in (
            {name: low for name, (low, _) in ranges.items()},
            {name: high for name, (_, high) in ranges.items()},
        ):
            self.disturbed(numbers)

    @property
    def grids(self) -> list[OccupancyGrid]:
        """The worlds, as a list."""
        assert isinstance(self.worlds, list)
        return self.worlds

    @property
    def laser(self) -> LaserScanner:
        """The scanner on the robot."""
        assert self.scanner is not None
        return self.scanner

    @property
    def step_limit(self) -> int:
        """Number of steps of an episode after which it is truncated."""
        return max(1, math.ceil(self.time_limit / self.duration - 1e-9))

    def disturbed(self, numbers: Mapping[str, float]) -> Disturbance:
        """Returns what is random about the robot of an episode, given the numbers that were drawn for it.

        Raises:
            ValueError: A number is out of range.
        """
        slip = numbers.get("slip", 0.0)
        if not 0.0 <= slip <= 1.0:
            raise ValueError(f"randomisation['slip'] must be in 0..1, got {slip}")
        limits, noise = self.limits, self.noise
        if limits is not None and any(name in numbers for name in FACTORS):
            scaled = {name: [numbers.get(name, 1.0) * limit for limit in getattr(limits, name)] for name in FACTORS}
            limits = Limits(**scaled)
        if any(name in numbers for name in NOISE):
            base = self.noise or BeamModel(z_hit=1.0, z_max=0.0)
            noise = BeamModel(**{name: numbers.get(name, getattr(base, name)) for name in NOISE})
        return Disturbance(noise, slip, limits)

    def _set(self, name: str, value: Any) -> None:
        object.__setattr__(self, name, value)


def _listed(name: str, values: Any) -> list[Any]:
    try:
        return list(values)
    except TypeError:
        raise TypeError(f"{name} must be a sequence, got {quoted(values)}") from None


def _number(name: str, value: Any, needed: str, low: float = -math.inf, high: float = math.inf) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{name} must be a number, got {quoted(value)}") from None
    if not (math.isfinite(number) and low <= number <= high):
        raise ValueError(f"{name} must be {needed}, got {quoted(value)}")
    return number


def _range(name: str, value: Any) -> tuple[float, float]:
    try:
        low, high = value
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be two numbers (low, high), got {quoted(value)}") from None
    low, high = (_number(name, number, "at least 0", low=0.0) for number in (low, high))
    if low > high:
        raise ValueError(f"{name} must be (low, high) with low <= high, got {quoted(value)}")
    return low, high
