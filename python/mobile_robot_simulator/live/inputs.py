"""Inputs: what a viewer may ask of a live simulation, checked when it arrives."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, StrictStr, TypeAdapter, ValidationError

from .._core import MAX_COMMAND
from ..quoting import quoted

SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 50.0)
"""Speed factors that the page offers."""

_FARTHEST = 1e6
"""Largest coordinate [m]."""

Coordinate = Annotated[float, Field(ge=-_FARTHEST, le=_FARTHEST, allow_inf_nan=False)]
Angle = Annotated[float, Field(ge=-_FARTHEST, le=_FARTHEST, allow_inf_nan=False)]
Velocity = Annotated[float, Field(ge=-MAX_COMMAND, le=MAX_COMMAND, allow_inf_nan=False)]
Text = Annotated[StrictStr, Field(max_length=1000)]
Name = Annotated[StrictStr, Field(pattern=r"^[A-Za-z0-9_][A-Za-z0-9_. -]{0,99}$")]


class _Input(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Drive(_Input):
    """Velocity of a robot [m/s, m/s, rad/s], valid for `session.HOLD` seconds of wall time."""

    kind: Literal["drive"] = "drive"
    robot: Text
    vx: Velocity = 0.0
    vy: Velocity = 0.0
    wz: Velocity = 0.0


class SetPose(_Input):
    """New pose of a robot in the map frame [m, m, rad]."""

    kind: Literal["set_pose"] = "set_pose"
    robot: Text
    x: Coordinate
    y: Coordinate
    yaw: Angle


class AddObstacle(_Input):
    """New standing disc or rectangle in the map frame. A disc has a radius [m], a rectangle a length and a width [m]."""

    kind: Literal["add_obstacle"] = "add_obstacle"
    x: Coordinate
    y: Coordinate
    yaw: Angle = 0.0
    radius: Annotated[float, Field(gt=0.0, le=1000.0)] | None = None
    length: Annotated[float, Field(gt=0.0, le=1000.0)] | None = None
    width: Annotated[float, Field(gt=0.0, le=1000.0)] | None = None


class MoveObstacle(_Input):
    """New pose of an obstacle in the map frame [m, m, rad]."""

    kind: Literal["move_obstacle"] = "move_obstacle"
    name: Text
    x: Coordinate
    y: Coordinate
    yaw: Angle


class RemoveObstacle(_Input):
    """Removal of an obstacle."""

    kind: Literal["remove_obstacle"] = "remove_obstacle"
    name: Text


class SetParameter(_Input):
    """New value of a parameter as YAML text, of a robot or, if `scanner` is given, of one of its scanners."""

    kind: Literal["set_parameter"] = "set_parameter"
    robot: Text
    scanner: Text | None = None
    name: Text
    value: Text


class Seed(_Input):
    """New seed of the noise of all scanners and odometries, from now on."""

    kind: Literal["seed"] = "seed"
    seed: Annotated[int, Field(ge=0, lt=2**64)]


class SetGoal(_Input):
    """Pose in the map frame [m, m, rad] that the built-in driver takes a robot to."""

    kind: Literal["set_goal"] = "set_goal"
    robot: Text
    x: Coordinate
    y: Coordinate
    yaw: Angle


class Autopilot(_Input):
    """The built-in driver that roams takes a robot over, or the robot stops and waits for commands."""

    kind: Literal["autopilot"] = "autopilot"
    robot: Text
    driver: Literal["wander"] | None = None


class AddFault(_Input):
    """New fault, as in `--fault`."""

    kind: Literal["add_fault"] = "add_fault"
    text: Text


class StopFault(_Input):
    """End of the fault with this number, from 0."""

    kind: Literal["stop_fault"] = "stop_fault"
    number: Annotated[int, Field(ge=0)]


class SaveState(_Input):
    """The present state of the simulation is kept under a name."""

    kind: Literal["save_state"] = "save_state"
    name: Name


class RestoreState(_Input):
    """The simulation goes back to a state that was kept."""

    kind: Literal["restore_state"] = "restore_state"
    name: Name


class Pause(_Input):
    """Time stops or goes on."""

    kind: Literal["pause"] = "pause"
    paused: bool


class Step(_Input):
    """Time stops after so many simulated seconds."""

    kind: Literal["step"] = "step"
    seconds: Annotated[float, Field(gt=0.0, le=60.0)] = 0.1


class Speed(_Input):
    """Simulated seconds per second of wall time."""

    kind: Literal["speed"] = "speed"
    factor: Annotated[float, Field(gt=0.0, le=1000.0)]


class Seek(_Input):
    """Time since the beginning of a recording to go to [s]."""

    kind: Literal["seek"] = "seek"
    time: Annotated[float, Field(ge=0.0, le=1e9, allow_inf_nan=False)]


class Reset(_Input):
    """All robots go back to their start poses."""

    kind: Literal["reset"] = "reset"


class Record(_Input):
    """A recording starts in the folder of this name or, without a name, ends."""

    kind: Literal["record"] = "record"
    name: Name | None = None


class CopyAsPython(_Input):
    """The script that repeats what was done, as the answer."""

    kind: Literal["copy_as_python"] = "copy_as_python"


class CopyCommands(_Input):
    """The commands of a robot as a file for `run --commands`, as the answer."""

    kind: Literal["copy_commands"] = "copy_commands"
    robot: Text


Input: TypeAlias = (
    Drive
    | SetPose
    | SetGoal
    | Autopilot
    | AddObstacle
    | MoveObstacle
    | RemoveObstacle
    | SetParameter
    | AddFault
    | StopFault
    | SaveState
    | RestoreState
    | Pause
    | Step
    | Speed
    | Seek
    | Reset
    | Seed
    | Record
    | CopyAsPython
    | CopyCommands
)
"""One input of a viewer."""

ONLY_LOOKS = (CopyAsPython, CopyCommands)
"""Inputs that change nothing, so every viewer may send them."""

_INPUTS: TypeAdapter[Input] = TypeAdapter(Annotated[Input, Field(discriminator="kind")])


def read_input(data: object) -> Input:
    """Returns the input that a page sent.

    Args:
        data: The decoded JSON.

    Raises:
        ValueError: It is not an input. The message names the field, what is wrong and the value.
    """
    if not isinstance(data, Mapping):
        raise ValueError(f"an input must be an object with a kind, got {quoted(data)}")
    try:
        return _INPUTS.validate_python(dict(data))
    except ValidationError as error:
        first: Any = error.errors(include_url=False)[0]
        place = " ".join(str(each) for each in first["loc"])
        raise ValueError(f"{place or 'input'}: {first['msg']}, got {quoted(first['input'])}") from None
