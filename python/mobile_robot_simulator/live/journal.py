"""Journal: what viewers did to a simulation, as a Python script that repeats it and as a file of commands."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass

from .._core import Shape
from ..instant import NANOSECONDS

_HEAD = '''"""Repeats what was done in the live view: the same calls at the same simulated times."""

import mobile_robot_simulator as mrs


def repeat(sim: mrs.Simulation) -> None:
    """Runs a simulation that starts as the one in the live view did."""
'''

_UNTIL = """
    def until(time: float) -> None:
        sim.run_for(max(0.0, time - sim.time))
"""

_DRIVE = '''
    def drive(topic: str, vx: float, vy: float, wz: float) -> None:
        """Publishes a command, as the page does."""
        twist = mrs.messages.Twist(mrs.messages.Vector3(vx, vy), mrs.messages.Vector3(z=wz))
        sim.publish(topic, twist)
'''

_DRIVE_STAMPED = '''
    def drive_stamped(topic: str, vx: float, vy: float, wz: float) -> None:
        """Publishes a command with a stamp, as the page does."""
        twist = mrs.messages.Twist(mrs.messages.Vector3(vx, vy), mrs.messages.Vector3(z=wz))
        stamp = mrs.messages.Time.from_nanoseconds(round(sim.time * 1e9))
        sim.publish(topic, mrs.messages.TwistStamped(mrs.messages.Header(stamp, "base_link"), twist))
'''


@dataclass(frozen=True)
class Command:
    """A velocity command that was published.

    Attributes:
        time_ns: Simulated time [ns].
        robot: Name of the robot.
        velocity: vx, vy [m/s], wz [rad/s].
    """

    time_ns: int
    robot: str
    velocity: tuple[float, float, float]


class Journal:
    """The calls that viewers have made, in order.

    Args:
        start: Python statements that create the simulation `sim`. Empty if only the caller knows how.
        began_ns: Simulated time of the first possible call [ns].
    """

    def __init__(self, start: str = "", began_ns: int = 0) -> None:
        self._start, self._began_ns = start, began_ns
        self._calls: list[tuple[int, str]] = []
        self._commands: list[Command] = []

    @property
    def command_count(self) -> int:
        """Number of commands so far, for `forget_commands_after`."""
        return len(self._commands)

    def forget_commands_after(self, count: int) -> None:
        """Forgets all commands but the first ones, because time went back to before them. The calls stay."""
        del self._commands[count:]

    def add(self, time_ns: int, call: str) -> None:
        """Adds a call, as Python source on the variable `sim`."""
        self._calls.append((time_ns, call))

    def add_command(self, command: Command, topic: str, *, stamped: bool) -> None:
        """Adds a velocity command that was published on a topic."""
        self._commands.append(command)
        numbers = ", ".join(repr(each) for each in command.velocity)
        self.add(command.time_ns, f"drive{'_stamped' if stamped else ''}({topic!r}, {numbers})")

    def to_python(self, now_ns: int) -> str:
        """Returns a script with a function `repeat(sim)` that makes the same calls, and runs until a time [ns].

        If the journal knows how the simulation was created, the script also creates and runs it.
        """
        calls = [call for _, call in self._calls]
        parts = [_HEAD, _UNTIL]
        parts += [_DRIVE] if any(call.startswith("drive(") for call in calls) else []
        parts += [_DRIVE_STAMPED] if any(call.startswith("drive_stamped(") for call in calls) else []
        lines, last_ns = ["    states = {}"] if any(call.startswith("states[") for call in calls) else [], self._began_ns
        for time_ns, call in [*self._calls, (now_ns, "")]:
            if time_ns != last_ns:
                lines.append(f"    until({time_ns / NANOSECONDS!r})")
            if call:
                lines.append(f"    {call}")
            last_ns = time_ns
        end = (
            f'\n\nif __name__ == "__main__":\n{_indented(self._start)}    repeat(sim)\n    print(sim)\n'
            if self._start
            else ""
        )
        return "".join(parts) + "\n" + "\n".join(lines or ["    pass"]) + "\n" + end

    def to_csv(self, robot: str) -> str:
        """Returns the commands of a robot as a file that `mobile-robot-simulator run --commands` reads."""
        text = io.StringIO()
        rows = csv.writer(text, lineterminator="\n")
        rows.writerow(("time", "vx", "vy", "wz"))
        # Of commands at the same time, the last one counts.
        last = {each.time_ns: each.velocity for each in self._commands if each.robot == robot}
        rows.writerows((time_ns / NANOSECONDS, *velocity) for time_ns, velocity in last.items())
        return text.getvalue()


def shape_source(shape: Shape) -> str:
    """Returns the Python expression that creates a shape."""
    if shape.radius is not None:
        return f"mrs.Shape.disc({shape.radius!r})"
    return f"mrs.Shape.polygon({shape.points.tolist()!r})"


def _indented(text: str) -> str:
    return "".join(f"    {line}\n" if line else "\n" for line in text.splitlines())
