"""Assertions on simulations, with messages that say what happened, where, when and by how much.

They check the ground truth, not the robot's estimates. `assert_reaches` and `assert_rate` run the simulation. If
`Simulation.picture` is set, a failed assertion saves a picture of the drive in that file, and its message names the file.
The picture shows the last goal of `assert_reaches` and where each robot first touched something.

Example:
    >>> import numpy as np
    >>> import mobile_robot_simulator as mrs
    >>> from mobile_robot_simulator.testing import assert_reaches
    >>> grid = mrs.OccupancyGrid(np.zeros((100, 100), np.int8), resolution=0.1)
    >>> sim = mrs.Simulation(grid, start=(1.0, 5.0, 0.0), parameters={"velocity_timeout": 0.0})
    >>> sim.publish("/cmd_vel", mrs.messages.Twist(linear=mrs.messages.Vector3(x=0.5)))
    >>> assert_reaches(sim, (2.0, 5.0), within=5.0, tolerance=0.12)
    1.8
    >>> assert_reaches(sim, (1.0, 5.0), within=1.0)
    Traceback (most recent call last):
    AssertionError: the robot did not come within 0.3 m of (1, 5) in 1 s: it was never nearer than 0.900 m
      nearest: 0.900 m away, at (1.900, 5.000) at 1.800 s
      end: 1.400 m away, at (2.400, 5.000) at 2.800 s
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NoReturn

import numpy as np
from numpy.typing import NDArray

from ..bus.topic import absolute
from ..instant import NANOSECONDS
from ..messages import LaserScan, Message
from ..quoting import quoted
from ..simulation.arguments import check_at_least_0

if TYPE_CHECKING:
    from ..physics.motion import ContactEvent
    from ..simulation.robots import SimulatedRobot
    from ..simulation.simulation import Simulation

__all__ = ["assert_clearance", "assert_no_contact", "assert_rate", "assert_reaches", "assert_scan_close", "fail", "point_of"]


def assert_reaches(
    sim: Simulation,
    goal: tuple[float, ...],
    within: float,
    *,
    tolerance: float = 0.3,
    yaw_tolerance: float = 0.2,
    robot: str | None = None,
) -> float:
    """Runs the simulation until a robot reaches a goal.

    Args:
        sim: The simulation.
        goal: Position x [m], y [m] in the map frame, and optionally the yaw [rad].
        within: Longest simulated time to run [s].
        tolerance: Largest distance from the position that counts as reached [m].
        yaw_tolerance: Largest difference from the yaw that counts as reached [rad].
        robot: Name of the robot; None for the first.

    Returns:
        The simulated time at which the robot reached the goal [s].

    Raises:
        AssertionError: The robot did not reach the goal in time. The message gives the nearest and the last point of its
            path, and its first contact.
        ValueError: The goal is not two or three finite numbers, or a tolerance is negative or not finite.
    """
    __tracebackhide__ = True
    if len(goal) not in (2, 3) or not all(map(math.isfinite, goal)):
        raise ValueError(f"goal must be two or three finite numbers, got {quoted(goal)}")
    check_at_least_0(tolerance=tolerance, yaw_tolerance=yaw_tolerance)
    driver, start = sim.named(robot), sim.time
    sim.goal = tuple(goal)

    def reached(sim: Simulation) -> bool:
        x, y, yaw = driver.pose
        near = math.hypot(x - goal[0], y - goal[1]) <= tolerance
        return near and (len(goal) == 2 or abs(math.remainder(yaw - goal[2], math.tau)) <= yaw_tolerance)

    try:
        return sim.run_until(reached, within)
    except TimeoutError:
        pass  # fail below raises an error with a better message
    fail(sim, _missed(sim, driver, goal, start, tolerance, yaw_tolerance))


def assert_no_contact(sim: Simulation, *, robot: str | None = None) -> None:
    """Checks that no robot has touched a wall, an obstacle or another robot so far.

    Args:
        sim: The simulation.
        robot: Name of the only robot to check; None for all robots.

    Raises:
        AssertionError: A robot touched something. The message gives its first contact.
        ValueError: A robot has no footprint.
    """
    __tracebackhide__ = True
    for driver in _chosen(sim, robot):
        contacts = driver.truth.contacts
        if contacts:
            count = f" (the first of {len(contacts)} contacts)" if len(contacts) > 1 else ""
            fail(sim, f"{driver.title} touched {_contact(contacts[0])}{count}")


def assert_clearance(sim: Simulation, at_least: float, *, robot: str | None = None) -> None:
    """Checks that no robot has come too near to a wall, an obstacle or another robot so far.

    The clearance is checked at the points of `GroundTruth.path`: at each change of velocity and at least every 0.1 s.
    Between two such points, the true clearance can be smaller by about the distance that the robot and what is near it move
    in half the time between them.

    Args:
        sim: The simulation.
        at_least: Smallest allowed distance from the footprint to anything else [m].
        robot: Name of the only robot to check; None for all robots.

    Raises:
        AssertionError: A robot came too near. The message gives the place and time of the smallest distance.
        ValueError: The clearance is not positive and finite.
    """
    __tracebackhide__ = True
    if not 0.0 < at_least < math.inf:
        raise ValueError(f"the clearance must be positive and finite, got {quoted(at_least)}")
    for driver in _chosen(sim, robot):
        path = driver.truth.path
        clearances = driver.truth.clearances(path, at_least)
        nearest = int(np.argmin(clearances))
        if clearances[nearest] < at_least:
            too_near = int(np.sum(clearances < at_least))
            fail(
                sim,
                f"{driver.title} came within {clearances[nearest]:.3f} m of a wall, obstacle or robot, "
                f"{at_least - clearances[nearest]:.3f} m less than the required {at_least:g} m\n"
                f"  nearest: {point_of(path[nearest])}\n"
                f"  too near at {too_near} of {len(path)} points of its path",
            )


def assert_rate(sim: Simulation, topic: str, hz: float, *, over: float = 2.0, tolerance: float = 0.05) -> None:
    """Runs the simulation for a while and checks the rate at which a topic is published.

    The number of messages can differ from the expected number by the share `tolerance` plus one message, because the number
    depends on when the interval starts. The time between two messages must not exceed twice the expected period.

    Args:
        sim: The simulation.
        topic: Name of the topic.
        hz: Expected rate [Hz].
        over: Simulated time to run [s], at least two expected periods.
        tolerance: Allowed difference of the rate, as a share of `hz`.

    Raises:
        AssertionError: The rate differs, or a gap between messages is too long. The message gives both.
        ValueError: The topic does not exist, the rate is not positive and finite, or `over` is too short.
    """
    __tracebackhide__ = True
    if not 0.0 < hz < math.inf:
        raise ValueError(f"the rate must be positive and finite, got {quoted(hz)} Hz")
    check_at_least_0(tolerance=tolerance)
    if not 2.0 <= hz * over < math.inf:
        raise ValueError(f"a rate of {hz:g} Hz needs more than {over:g} s to be measured: give a larger over")
    start, times = sim.time, _times(sim, topic, over)
    ends = [start, *times, sim.time]
    gaps = np.diff(ends)
    longest = int(np.argmax(gaps))
    rate = len(times) / over
    # The interval contains one message more or less, depending on when it starts.
    if abs(rate - hz) > tolerance * hz + 1.0 / over or gaps[longest] > 2.0 / hz + 1e-9:
        fail(
            sim,
            f"{topic} was published at {rate:.3g} Hz instead of {hz:g} Hz: "
            f"{len(times)} messages in {over:g} s, from {start:g} s to {sim.time:g} s\n"
            f"  allowed: {hz:g} Hz ± {100 * tolerance:g} %, gaps of at most {2.0 / hz:g} s\n"
            f"  longest gap: {gaps[longest]:.3f} s, from {ends[longest]:.3f} s to {ends[longest + 1]:.3f} s",
        )


def assert_scan_close(
    a: LaserScan | NDArray[np.float32], b: LaserScan | NDArray[np.float32], *, tolerance: float = 0.01, share: float = 1.0
) -> None:
    """Checks that two scans agree, beam by beam.

    Args:
        a: First scan, or its ranges [m], (N,).
        b: Second scan, or its ranges [m], (N,).
        tolerance: Largest difference of two ranges that counts as equal [m]. A missing return (inf or NaN) equals only the
            same kind of missing return.
        share: Share of the beams that must be equal, above 0 and at most 1.

    Raises:
        AssertionError: Too many beams differ. The message gives their number and the beam that differs most.
        ValueError: The scans have no beams or different numbers of beams, or an option is out of range.
    """
    __tracebackhide__ = True
    check_at_least_0(tolerance=tolerance)
    if not 0.0 < share <= 1.0:
        raise ValueError(f"the share must be above 0 and at most 1, got {quoted(share)}")
    first, second = (np.asarray(scan.ranges if isinstance(scan, LaserScan) else scan, np.float64) for scan in (a, b))
    if first.ndim != 1 or first.shape != second.shape or not first.size:
        raise ValueError(f"scans must have the same number of beams, at least one, got shapes {first.shape}, {second.shape}")
    same = (first == second) | (np.isnan(first) & np.isnan(second))
    with np.errstate(invalid="ignore"):
        difference = np.where(same, 0.0, np.abs(first - second))
    difference[np.isnan(difference)] = math.inf
    different = int((difference > tolerance).sum())
    if different > (1.0 - share) * len(difference):
        worst = int(np.argmax(difference))
        allowed = f" ({100 * share:g} % of the beams must agree)" if share < 1.0 else ""
        raise AssertionError(
            f"{different} of {len(difference)} beams differ by more than {tolerance:g} m{allowed}\n"
            f"  largest difference: {difference[worst]:.4f} m, at {_beam(a, b, worst)}: "
            f"{first[worst]:.4f} m in the first scan, {second[worst]:.4f} m in the second"
        )


def _missed(
    sim: Simulation,
    driver: SimulatedRobot,
    goal: tuple[float, ...],
    start: float,
    tolerance: float,
    yaw_tolerance: float,
) -> str:
    """Returns the message for a robot that missed its goal: nearest point, last point of the path, first contact."""
    path = driver.truth.path
    path = path[path[:, 0] >= start - 1e-9]
    distances = np.hypot(path[:, 1] - goal[0], path[:, 2] - goal[1])
    nearest, near = int(np.argmin(distances)), distances <= tolerance
    wanted = f"{driver.title} did not come within {tolerance:g} m of ({goal[0]:g}, {goal[1]:g})"
    yaw_error = 0.0
    if len(goal) == 3:
        yaw_error = min((abs(math.remainder(yaw - goal[2], math.tau)) for yaw in path[near, 3]), default=0.0)
        wanted += f" with a yaw within {yaw_tolerance:g} rad of {goal[2]:g} rad"
    text = f"{wanted} in {sim.time - start:g} s: "
    if not near.any():
        text += f"it was never nearer than {distances[nearest]:.3f} m"
    elif yaw_error > yaw_tolerance:
        text += f"it was near enough, but its yaw was then always off by {yaw_error:.3f} rad or more"
    else:
        text += "it was there only between two events, but the goal is checked only at events"
    text += f"\n  nearest: {distances[nearest]:.3f} m away, {point_of(path[nearest])}"
    text += f"\n  end: {distances[-1]:.3f} m away, {point_of(path[-1])}"
    contacts = [
        contact for contact in driver.robot.motion.contacts_until(round(sim.time * NANOSECONDS)) if contact.time >= start
    ]
    if contacts:
        text += f"\n  first contact: {_contact(contacts[0])}"
    return text


def _times(sim: Simulation, topic: str, seconds: float) -> list[float]:
    """Runs the simulation for a duration [s]. Returns the times [s] of the messages sent to a topic in that time."""
    sim.latest(topic)  # raises ValueError if the topic does not exist
    start_ns, name = round(sim.time * NANOSECONDS), absolute(topic)
    times: list[float] = []

    def tap(topic: str, message: Message, time_ns: int) -> None:
        if topic == name and time_ns > start_ns:
            times.append(time_ns / NANOSECONDS)

    sim.record(tap)
    try:
        sim.run_for(seconds)
    finally:
        sim.stop_recording(tap)
    return times


def _chosen(sim: Simulation, robot: str | None) -> list[SimulatedRobot]:
    return list(sim.robots.values()) if robot is None else [sim.named(robot)]


def point_of(row: NDArray[np.float64]) -> str:
    """Returns the position and the time of a row of `GroundTruth.path` as a text."""
    return f"at ({row[1]:.3f}, {row[2]:.3f}) at {row[0]:.3f} s"


def _contact(contact: ContactEvent) -> str:
    x, y = contact.point
    return (
        f"{contact.what} at ({x:.3f}, {y:.3f}) at {contact.time:.3f} s: "
        f"robot at ({contact.pose.x:.3f}, {contact.pose.y:.3f}), speed {contact.speed:.3f} m/s"
    )


def _beam(a: LaserScan | NDArray[np.float32], b: LaserScan | NDArray[np.float32], beam: int) -> str:
    """Returns a text for a beam. It includes the angle and the scan's time if `a` or `b` is a LaserScan."""
    scan = a if isinstance(a, LaserScan) else b
    if not isinstance(scan, LaserScan):
        return f"beam {beam}"
    angle = scan.angle_min + beam * scan.angle_increment
    return f"beam {beam} (angle {angle:.3f} rad, scan of {scan.header.stamp.nanoseconds / NANOSECONDS:.3f} s)"


def fail(sim: Simulation, text: str) -> NoReturn:
    """Saves a picture if `Simulation.picture` is set. Then raises AssertionError."""
    __tracebackhide__ = True
    if sim.picture is not None:
        try:
            sim.picture.parent.mkdir(parents=True, exist_ok=True)
            sim.draw(sim.picture)
            text += f"\npicture: {sim.picture}"
        except Exception as error:
            text += f"\nno picture: {error}"
    raise AssertionError(text)
