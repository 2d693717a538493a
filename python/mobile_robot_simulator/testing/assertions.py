"""Assertions on simulations that explain themselves: where, when, by how much, and where the picture is.

They look at the truth, not at what the robot believes. Those that take a goal or a rate let the simulation run.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from ..instant import NANOSECONDS
from ..messages import LaserScan, Message
from ..simulation.fault import check_at_least_0

if TYPE_CHECKING:
    from ..physics.motion import ContactEvent
    from ..simulation.robots import SimulatedRobot
    from ..simulation.simulation import Simulation

__all__ = ["assert_clearance", "assert_no_contact", "assert_rate", "assert_reaches", "assert_scan_close"]


def assert_reaches(
    sim: Simulation,
    goal: tuple[float, ...],
    within: float,
    *,
    tolerance: float = 0.3,
    yaw_tolerance: float = 0.2,
    robot: str | None = None,
) -> float:
    """Run until a robot is at a goal.

    goal: x, y [m], and yaw [rad] if it matters. within: seconds from now on. tolerance: how near is near enough [m];
    yaw_tolerance likewise [rad]. robot: its name, the first if None.
    returns: the time at which it was there [s].
    raises: AssertionError if it is not there in time; ValueError for a goal that is not two or three finite numbers.
    """
    __tracebackhide__ = True
    if len(goal) not in (2, 3) or not all(map(math.isfinite, goal)):
        raise ValueError(f"goal must be two or three finite numbers, got {goal}")
    check_at_least_0(tolerance=tolerance, yaw_tolerance=yaw_tolerance)
    one, began = sim.named(robot), sim.time

    def there(sim: Simulation) -> bool:
        x, y, yaw = one.pose
        near = math.hypot(x - goal[0], y - goal[1]) <= tolerance
        return near and (len(goal) == 2 or abs(math.remainder(yaw - goal[2], math.tau)) <= yaw_tolerance)

    try:
        return sim.run_until(there, within)
    except TimeoutError:
        pass
    path = one.truth.path
    path = path[path[:, 0] >= began - 1e-9]
    distances = np.hypot(path[:, 1] - goal[0], path[:, 2] - goal[1])
    nearest = int(np.argmin(distances))
    text = (
        f"{_named(one)} did not come within {tolerance:g} m of ({goal[0]:g}, {goal[1]:g}) in {within:g} s: "
        f"it came within {distances[nearest]:.3f} m, {_at(path[nearest])}; "
        f"at the end it is {distances[-1]:.3f} m away, {_at(path[-1])}"
    )
    if distances[nearest] <= tolerance:
        text += f"; yaw {goal[2]:g} was wanted to {yaw_tolerance:g} rad"
    contacts = [
        contact for contact in one.robot.motion.contacts_until(round(sim.time * NANOSECONDS)) if contact.time >= began
    ]
    if contacts:
        text += f"; on its way it {_touched(contacts[0])}"
    _fail(sim, text)


def assert_no_contact(sim: Simulation, *, robot: str | None = None) -> None:
    """No robot touched anything so far, or the one named did not.

    raises: AssertionError with the first contact; ValueError if a robot has no footprint.
    """
    __tracebackhide__ = True
    for one in _chosen(sim, robot):
        contacts = one.truth.contacts
        if contacts:
            more = f", the first of {len(contacts)} contacts" if len(contacts) > 1 else ""
            _fail(sim, f"{_named(one)} {_touched(contacts[0])}{more}")


def assert_clearance(sim: Simulation, at_least: float, *, robot: str | None = None) -> None:
    """No robot came nearer to anything than this [m] so far, or the one named did not: footprint against map.

    Looked at each tenth of a second of the way, and at each change of velocity; between these the robot may have been nearer
    by what it drives in half that time.
    raises: AssertionError with the nearest place.
    """
    __tracebackhide__ = True
    if not 0.0 < at_least < math.inf:
        raise ValueError(f"the clearance must be positive and finite, got {at_least}")
    for one in _chosen(sim, robot):
        path = one.truth.path
        clearances = one.truth.clearances(path, at_least)
        nearest = int(np.argmin(clearances))
        if clearances[nearest] < at_least:
            below = int(np.sum(clearances < at_least))
            _fail(
                sim,
                f"{_named(one)} came within {clearances[nearest]:.3f} m of something, {_at(path[nearest])}: "
                f"{at_least - clearances[nearest]:.3f} m less than the {at_least:g} m wanted, "
                f"and it was too near at {below} of {len(path)} points of its way",
            )


def assert_rate(sim: Simulation, topic: str, hz: float, *, over: float = 2.0, tolerance: float = 0.05) -> None:
    """Run for a while, and see that messages come at a rate.

    hz: the rate wanted. over: for how long to run [s]. tolerance: by what share the rate may differ; no gap may be longer
    than twice the period wanted.
    raises: AssertionError with the rate found and the longest gap; ValueError for an unknown topic or a rate that is none.
    """
    __tracebackhide__ = True
    if not 0.0 < hz < math.inf:
        raise ValueError(f"the rate must be positive and finite, got {hz} Hz")
    check_at_least_0(tolerance=tolerance)
    if not 2.0 <= hz * over < math.inf:
        raise ValueError(f"a rate of {hz:g} Hz needs more than {over:g} s to be seen: give over")
    sim.latest(topic)
    began, times = sim.time, []
    name = topic if topic.startswith("/") else f"/{topic}"

    def tap(topic: str, message: Message, time_ns: int) -> None:
        if topic == name and time_ns > round(began * 1e9):
            times.append(time_ns / 1e9)

    sim.record(tap)
    try:
        sim.run_for(over)
    finally:
        sim.stop_recording(tap)
    ends = [began, *times, sim.time]
    gaps = np.diff(ends)
    longest = int(np.argmax(gaps))
    found = len(times) / over
    # One message more or less falls into a stretch of time by chance.
    if abs(found - hz) > tolerance * hz + 1.0 / over or gaps[longest] > 2.0 / hz + 1e-9:
        _fail(
            sim,
            f"{topic} had {len(times)} messages in {over:g} s from {began:g} s on, {found:.3g} Hz where {hz:g} Hz "
            f"was wanted; the longest gap was {gaps[longest]:.3f} s, from {ends[longest]:.3f} s on",
        )


def assert_scan_close(
    a: LaserScan | NDArray[np.float32], b: LaserScan | NDArray[np.float32], *, tolerance: float = 0.01, share: float = 1.0
) -> None:
    """Two scans see the same, beam by beam.

    tolerance: by how much ranges may differ [m]; a missing return is close to a missing return only. share: of the beams
    that must be close.
    raises: AssertionError with the number of beams that are not, and the worst; ValueError for scans of different lengths.
    """
    __tracebackhide__ = True
    check_at_least_0(tolerance=tolerance)
    if not 0.0 < share <= 1.0:
        raise ValueError(f"the share must be above 0 and at most 1, got {share}")
    left, right = (np.asarray(scan.ranges if isinstance(scan, LaserScan) else scan, np.float64) for scan in (a, b))
    if left.ndim != 1 or left.shape != right.shape or not left.size:
        raise ValueError(f"scans must have beams, and as many as each other, got shapes {left.shape} and {right.shape}")
    same = (left == right) | (np.isnan(left) & np.isnan(right))
    with np.errstate(invalid="ignore"):
        off = np.where(same, 0.0, np.abs(left - right))
    off[np.isnan(off)] = math.inf
    far = off > tolerance
    if far.sum() > (1.0 - share) * len(off):
        worst = int(np.argmax(off))
        where = f"beam {worst}"
        scan = a if isinstance(a, LaserScan) else b
        if isinstance(scan, LaserScan):
            where += (
                f" at {scan.angle_min + worst * scan.angle_increment:.3f} rad, {scan.header.stamp.nanoseconds / 1e9:.3f} s"
            )
        raise AssertionError(
            f"{far.sum()} of {len(off)} beams differ by more than {tolerance:g} m; the worst is {where}: "
            f"{left[worst]:.4f} m and {right[worst]:.4f} m, {off[worst]:.4f} m apart"
        )


def _chosen(sim: Simulation, robot: str | None) -> list[SimulatedRobot]:
    return list(sim.robots.values()) if robot is None else [sim.named(robot)]


def _named(robot: SimulatedRobot) -> str:
    return robot.name or "the robot"


def _at(row: Any) -> str:
    return f"at ({row[1]:.3f}, {row[2]:.3f}) at {row[0]:.3f} s"


def _touched(contact: ContactEvent) -> str:
    x, y = contact.point
    return (
        f"touched {contact.what} at ({x:.3f}, {y:.3f}) at {contact.time:.3f} s, going {contact.speed:.3f} m/s, "
        f"with its centre at ({contact.pose.x:.3f}, {contact.pose.y:.3f})"
    )


def _fail(sim: Simulation, text: str) -> NoReturn:
    """Raise, and say where the picture is if the simulation has a place for one."""
    __tracebackhide__ = True
    if sim.picture is not None:
        try:
            sim.draw(sim.picture)
            text += f"\npicture: {sim.picture}"
        except Exception as error:
            text += f"\nno picture: {error}"
    raise AssertionError(text)
