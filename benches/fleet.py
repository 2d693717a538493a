"""Benchmarks of fleets: what motion and contact add to scans, rollouts for a planner, and memory.

Run: python benches/fleet.py. Each figure is the shortest of many calls, all in one process. The compared calls take turns,
so a busy machine slows all of them.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

import mobile_robot_simulator as mrs

ROBOTS = 1024
BEAMS = 200
TURNS = 60
DURATION = 0.1
ROLLOUTS = 1000, 50

LIMITS = mrs.Limits(acceleration=(1.0, 1.0, 3.0), deceleration=(2.0, 2.0, 6.0))
FLEETS = {
    "motion": {},
    "contact": {"footprint": mrs.Shape.disc(0.2)},
    "contact, polygon": {"footprint": mrs.Shape.rectangle(0.5, 0.3)},
    "contact, limits": {"footprint": mrs.Shape.disc(0.2), "limits": LIMITS},
}


def shortest(calls: dict[str, Callable[[], object]]) -> dict[str, float]:
    """Returns the shortest time [s] of each of some calls, which take turns."""
    times: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(TURNS):
        for name, call in calls.items():
            start = time.perf_counter()
            call()
            times[name].append(time.perf_counter() - start)
    return {name: min(found) for name, found in times.items()}


def main() -> None:
    """Runs all benchmarks and prints their figures."""
    grid = mrs.floor_plan("office", seed=1)
    laser, noise, dice = mrs.LaserScanner(beam_count=BEAMS), mrs.BeamModel(), np.random.default_rng(1)
    commands = dice.uniform((0.0, 0.0, -1.0), (0.8, 0.0, 1.0), (TURNS, ROBOTS, 3))
    print(f"{ROBOTS} robots, {BEAMS} noisy beams, steps of {DURATION} s; robots that touch something are put elsewhere")
    for name, options in FLEETS.items():
        fleet = mrs.Fleet(grid, seeds=np.arange(ROBOTS), scanner=laser, noise=noise, clearance=0.1, **options)
        ranges = np.empty((ROBOTS, BEAMS), np.float32)
        step = fleet.step(commands[0], DURATION)
        turn = iter(range(2 * TURNS))

        def stepped(fleet: mrs.Fleet = fleet, step: mrs.FleetStep = step, turn: object = turn) -> None:
            fleet.step(commands[next(turn) % TURNS], DURATION, out=step)  # type: ignore[call-overload]

        def scanned(step: mrs.FleetStep = step, ranges: np.ndarray = ranges) -> None:
            laser.scan_batch(grid, step.poses, noise=noise, seed=1, out=ranges)

        def moved_on(fleet: mrs.Fleet = fleet, step: mrs.FleetStep = step) -> None:
            fleet.reset(step.contacts)

        times = shortest({"step": stepped, "scans": scanned, "reset": moved_on})
        rate = ROBOTS / times["step"]
        ratio = times["step"] / times["scans"]
        print(f"  {name}: {times['step'] * 1e3:.2f} ms, {ratio:.2f} times the scans alone, {rate:,.0f} robot steps/s")
    fleet = mrs.Fleet(grid, seeds=[1], footprint=mrs.Shape.disc(0.2), clearance=0.3)
    sequences = dice.normal((0.8, 0.0, 0.0), (0.2, 0.0, 0.6), (*ROLLOUTS, 3))
    for duration in (0.02, 0.1):
        took = shortest({"rollout": lambda duration=duration: fleet.rollout(sequences, duration)})["rollout"]
        contacts = fleet.rollout(sequences, duration)[1].any(axis=1).mean()
        print(
            f"{ROLLOUTS[0]} rollouts x {ROLLOUTS[1]} steps of {duration} s: {took * 1e3:.2f} ms, {contacts:.0%} touch a wall"
        )
    print(f"state of a robot: {fleet.save().words.nbytes} bytes")


if __name__ == "__main__":
    main()
