"""Session: a simulation that runs at the pace of the wall clock and takes the inputs of viewers."""

from __future__ import annotations

import time
from collections.abc import Mapping
from contextlib import suppress
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .._core import Pose, Shape
from ..faults.reading import read_fault
from ..instant import NANOSECONDS
from ..messages import Message
from ..namespaces import of_namespace
from ..parameter_files import read_assignment
from ..parameters import LaserParameters, RobotParameters, for_node
from ..quoting import quoted
from ..recording.format import Format
from ..scanners import of_scanner
from .autopilot import GoalPilot, WanderPilot
from .inputs import (
    AddFault,
    AddObstacle,
    Autopilot,
    CopyAsPython,
    CopyCommands,
    Drive,
    Input,
    MoveObstacle,
    Pause,
    Record,
    RemoveObstacle,
    Reset,
    RestoreState,
    SaveState,
    Seed,
    Seek,
    SetGoal,
    SetParameter,
    SetPose,
    Speed,
    Step,
    StopFault,
)
from .journal import Journal, shape_source
from .pace import GRAIN_NS, LONGEST_TURN, Pace
from .pilots import Pilots

if TYPE_CHECKING:
    from ..recording.recorder import Recorder
    from ..simulation.simulation import Simulation
    from ..simulation.snapshot import Snapshot

MOST_STATES = 20
"""States of the simulation that can be kept at a time."""


class Session:
    """A simulation, paced and under the control of viewers. All methods must be called in one thread.

    Args:
        simulation: The simulation.
        journal: Takes what the viewers do.
        folder: Folder in which recordings are made.
        format: Format of the recordings.
        overwrite: Replace recordings of the same name.
        paused: Start with the time stopped.

    Attributes:
        pace: Whether time runs, and how fast.
        pilots: Who drives each robot.
        recording: Folder of the recording that is being made, or None.
        moves: Number of times that viewers have moved or reset robots.
        epoch: Number of resets and restores, after which paths start again.
        notes: What all viewers should be told. Whoever tells them, clears it.
        is_watching: True while a script runs the simulation, and viewers only watch.
        steps_ns: Simulated time that the script may run although time is stopped [ns].
    """

    def __init__(
        self,
        simulation: Simulation,
        journal: Journal,
        folder: Path,
        *,
        format: Format = "mcap",
        overwrite: bool = False,
        paused: bool = False,
    ) -> None:
        self.simulation, self.journal, self.folder = simulation, journal, folder
        robots = list(simulation.robots.values())
        self.pace = Pace(robots[0].robot.parameters.speed_factor if robots else 1.0, paused=paused)
        self.pilots = Pilots(simulation, journal)
        self.recording: Path | None = None
        self.moves = self.epoch = 0
        self.notes: list[str] = []
        self.is_watching, self.steps_ns = False, 0
        self._wall: float | None = None
        self._format, self._overwrite = format, overwrite
        self._recorder: Recorder | None = None
        self._error: Exception | None = None
        self._states: dict[str, tuple[Snapshot, int]] = {}

    @property
    def now_ns(self) -> int:
        """Simulated time [ns]."""
        return round(self.simulation.time * NANOSECONDS)

    @property
    def states(self) -> Mapping[str, float]:
        """Simulated times of the kept states by their names [s]."""
        return {name: state.time for name, (state, _) in self._states.items()}

    @property
    def free_name(self) -> str:
        """Name for the next recording, which its folder does not have yet."""
        return next(name for number in count(1) if not (self.folder / (name := f"drive-{number}")).exists())

    # --- time ---

    def turn(self, wall: float) -> None:
        """Runs the simulation up to a wall time.

        Args:
            wall: Current wall time [s], as from `time.monotonic`.
        """
        self.pilots.end_held(wall)
        self._run(self.pace.due_ns(wall), LONGEST_TURN)
        self.note_time(wall)

    def note_time(self, wall: float) -> None:
        """Takes note of the simulated time at a wall time [s], and of what the pilots have to tell."""
        self._wall = wall
        self.pace.note(wall, self.now_ns)
        if self._error is not None:
            self.notes.append(f"the recording has ended: {self._error}")
            with suppress(OSError, ValueError):
                self._end_recording()
        self.notes += self.pilots.notes
        self.pilots.notes.clear()

    def _run(self, duration_ns: int, longest: float = float("inf")) -> None:
        """Runs for a simulated time [ns] and sends commands to the robots that are driven.

        A run that takes longer than `longest` [s] of wall time ends after a part of it, so that inputs do not wait.
        """
        end_ns, began = self.now_ns + duration_ns, time.monotonic()
        while (left_ns := end_ns - self.now_ns) > 0:
            self.pilots.send_due()
            self.simulation.run_for(min(left_ns, self.pilots.until_next_ns(100 * GRAIN_NS)) / NANOSECONDS)
            if time.monotonic() - began > longest:
                return

    # --- inputs ---

    def do(self, wanted: Input) -> Any:
        """Does what a viewer wants.

        Returns:
            What the input asks for, as JSON can hold it; None if it asks for nothing.

        Raises:
            ValueError: The simulation refuses it. The message says why. Nothing changes.
            TypeError: As ValueError, for a value of a wrong type.
            RuntimeError: It is not possible while a script runs the simulation.
            OSError: A recording cannot be written.
            ImportError: A recording needs a package that is not installed.
        """
        method = getattr(self, f"_do_{wanted.kind}")
        return method(wanted)

    def close(self) -> None:
        """Stops the robots that a page drives, and ends a recording."""
        self.pilots.release()
        self._end_recording()

    def _do_drive(self, wanted: Drive) -> None:
        self.simulation.named(wanted.robot)
        self.pilots.hold(wanted.robot, (wanted.vx, wanted.vy, wanted.wz), self._wall or time.monotonic())

    def _do_set_pose(self, wanted: SetPose) -> None:
        pose = (wanted.x, wanted.y, wanted.yaw)
        self._check_on_map(wanted.x, wanted.y)
        self.simulation.set_pose(pose, wanted.robot)
        self.moves += 1
        self._note(f"sim.set_pose({pose!r}, {wanted.robot!r})")

    def _do_set_goal(self, wanted: SetGoal) -> None:
        pose = Pose(wanted.x, wanted.y, wanted.yaw)
        self.pilots.engage(wanted.robot, GoalPilot(self.simulation, wanted.robot, pose))

    def _do_autopilot(self, wanted: Autopilot) -> None:
        robot = self.simulation.named(wanted.robot)
        if wanted.driver is None:
            self.pilots.stop(wanted.robot)
        else:
            self.pilots.engage(wanted.robot, WanderPilot(self.simulation, wanted.robot, robot.laser.parameters.seed))

    def _do_add_obstacle(self, wanted: AddObstacle) -> str:
        if (wanted.radius is None) == (wanted.length is None or wanted.width is None):
            raise ValueError("an obstacle needs either a radius, or a length and a width")
        if wanted.radius is not None:
            shape = Shape.disc(wanted.radius)
        else:
            assert wanted.length is not None and wanted.width is not None
            shape = Shape.rectangle(wanted.length, wanted.width)
        pose = (wanted.x, wanted.y, wanted.yaw)
        name = self.simulation.add_obstacle(shape, pose).name
        self._note(f"sim.add_obstacle({shape_source(shape)}, {pose!r}, {name!r})")
        return name

    def _do_move_obstacle(self, wanted: MoveObstacle) -> None:
        pose = (wanted.x, wanted.y, wanted.yaw)
        self.simulation.move_obstacle(wanted.name, pose)
        self._note(f"sim.move_obstacle({wanted.name!r}, {pose!r})")

    def _do_remove_obstacle(self, wanted: RemoveObstacle) -> None:
        self.simulation.remove_obstacle(wanted.name)
        self._note(f"sim.remove_obstacle({wanted.name!r})")

    def _do_set_parameter(self, wanted: SetParameter) -> None:
        robot = self.simulation.named(wanted.robot)
        if wanted.scanner is not None and wanted.scanner not in robot.scanners:
            raise ValueError(f"unknown scanner {quoted(wanted.scanner)}; there are {quoted(list(robot.scanners))}")
        node = robot.robot if wanted.scanner is None else robot.scanners[wanted.scanner]
        if wanted.name not in type(node.parameters).model_fields:
            raise ValueError(f"unknown parameter {quoted(wanted.name)}")
        _, value = read_assignment(f"{wanted.name}:={wanted.value}")
        node.set_parameters(**{wanted.name: value})
        self._note_parameter(wanted.robot, wanted.scanner, wanted.name, value)

    def _do_seed(self, wanted: Seed) -> None:
        for name, robot in self.simulation.robots.items():
            values = of_namespace(name, {"seed": wanted.seed, "odometry_seed": wanted.seed})
            odometry_seed = for_node(RobotParameters, values).odometry_seed
            robot.robot.set_parameters(odometry_seed=odometry_seed)
            self._note_parameter(name, None, "odometry_seed", odometry_seed)
            for scanner, laser in robot.scanners.items():
                seed = for_node(LaserParameters, of_scanner(scanner, values)).seed
                laser.set_parameters(seed=seed)
                self._note_parameter(name, scanner, "seed", seed)

    def _do_add_fault(self, wanted: AddFault) -> None:
        self.simulation.add_fault(read_fault(wanted.text))
        self._note(f"sim.add_fault(mrs.faults.{wanted.text.strip()})")

    def _do_stop_fault(self, wanted: StopFault) -> None:
        if wanted.number >= len(self.simulation.faults):
            raise ValueError(f"there is no fault {wanted.number}, only {len(self.simulation.faults)}")
        self.simulation.faults[wanted.number].stop()
        self._note(f"sim.faults[{wanted.number}].stop()")

    def _do_save_state(self, wanted: SaveState) -> None:
        if wanted.name not in self._states and len(self._states) >= MOST_STATES:
            raise ValueError(f"at most {MOST_STATES} states can be kept; use the name of one that is no longer needed")
        self._states[wanted.name] = self.simulation.save(), self.journal.command_count
        self._note(f"states[{wanted.name!r}] = sim.save()")

    def _do_restore_state(self, wanted: RestoreState) -> None:
        if wanted.name not in self._states:
            raise ValueError(f"there is no state {quoted(wanted.name)}; there are {quoted(list(self._states))}")
        state, command_count = self._states[wanted.name]
        self._note(f"sim.restore(states[{wanted.name!r}])")
        self.simulation.restore(state)
        self.pilots.forget()
        self.journal.forget_commands_after(command_count)
        self._restart_paths()

    def _do_pause(self, wanted: Pause) -> None:
        self.pace.paused = wanted.paused

    def _do_step(self, wanted: Step) -> None:
        self.pace.paused = True
        if self.is_watching:
            self.steps_ns += round(wanted.seconds * NANOSECONDS)
        else:
            self._run(round(wanted.seconds * NANOSECONDS))

    def _do_speed(self, wanted: Speed) -> None:
        self.pace.speed = wanted.factor

    def _do_seek(self, wanted: Seek) -> None:
        raise ValueError("a simulation has no time line: keep its state, and go back to it")

    def _do_reset(self, wanted: Reset) -> None:
        self.pilots.forget()
        self.simulation.reset()
        self._note("sim.reset()")
        self._restart_paths()

    def _do_record(self, wanted: Record) -> str | None:
        if wanted.name is None:
            return self._end_recording()
        if self._recorder is not None:
            raise ValueError(f"a recording is being made in {self.recording}; end it first")
        from ..recording.recorder import Recorder

        recorder = Recorder(self.folder / wanted.name, format=self._format, overwrite=self._overwrite)
        self._recorder, self.recording = recorder, self.folder / wanted.name
        self.simulation.record(self._write)
        return None

    def _do_copy_as_python(self, wanted: CopyAsPython) -> str:
        return self.journal.to_python(self.now_ns)

    def _do_copy_commands(self, wanted: CopyCommands) -> str:
        self.simulation.named(wanted.robot)
        return self.journal.to_csv(wanted.robot)

    # --- helpers ---

    def _end_recording(self) -> str | None:
        """Ends the recording. Returns its path, or None if there is none."""
        if self._recorder is None:
            return None
        recorder, self._recorder, self.recording, self._error = self._recorder, None, None, None
        self.simulation.stop_recording(self._write)
        recorder.close()
        return str(recorder.path)

    def _write(self, topic: str, message: Message, time_ns: int) -> None:
        """Records a message. After an error, such as a full disk, the recording ends with this turn."""
        if self._recorder is not None and self._error is None:
            try:
                self._recorder.write(topic, message, time_ns)
            except (OSError, ValueError) as error:
                self._error = error

    def _check_on_map(self, x: float, y: float) -> None:
        if self.simulation.grid.cell_at(x, y) is None:
            raise ValueError(f"({x:.2f}, {y:.2f}) is off the map, where there is nothing to touch and nothing to see")

    def _restart_paths(self) -> None:
        self.moves += 1
        self.epoch += 1

    def _note_parameter(self, robot: str, scanner: str | None, name: str, value: Any) -> None:
        part = "robot" if scanner is None else f"scanners[{scanner!r}]"
        self._note(f"sim.named({robot!r}).{part}.set_parameters({name}={value!r})")

    def _note(self, call: str) -> None:
        self.journal.add(self.now_ns, call)
