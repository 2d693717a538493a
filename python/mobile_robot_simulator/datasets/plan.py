"""Plan: what a data set contains."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from .._core import BeamModel, LaserScanner, SurfaceModel
from ..maps.floor_plans import KINDS
from ..parameters import Count, LaserParameters, Name, Number, RobotParameters, Seed
from ..quoting import nearest, quoted
from ..user_files import read_text
from ..yaml_documents import parse, value_of

__all__ = ["Labels", "Maps", "Noise", "Obstacles", "Plan", "Poses", "Scanner", "load_plan"]

LONGEST_CHUNK = 512
"""Largest number of scans that are compressed together."""


def _as_range(value: object) -> object:
    """Returns a number as a range of one number."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return (value, value)
    if isinstance(value, list | tuple) and len(value) == 2:
        return tuple(value)
    raise ValueError("Input should be a number, or two numbers [low, high] to draw from")


def _check_order(bounds: tuple[float, float]) -> tuple[float, float]:
    if bounds[0] > bounds[1]:
        raise ValueError("Input should be [low, high] with low at most high")
    return bounds


def _as_list(value: object) -> object:
    return [value] if isinstance(value, str) else value


# A value that is given as a number, or as two numbers [low, high] to draw from.
_Positive = Annotated[Number, Field(gt=0.0)]
_Weight = Annotated[Number, Field(ge=0.0)]
_Count = Annotated[Count, Field(ge=0, le=10_000)]
Range = Annotated[tuple[Number, Number], BeforeValidator(_as_range), AfterValidator(_check_order)]
PositiveRange = Annotated[tuple[_Positive, _Positive], BeforeValidator(_as_range), AfterValidator(_check_order)]
WeightRange = Annotated[tuple[_Weight, _Weight], BeforeValidator(_as_range), AfterValidator(_check_order)]
CountRange = Annotated[tuple[_Count, _Count], BeforeValidator(_as_range), AfterValidator(_check_order)]

PositiveCount = Annotated[Count, Field(ge=1, le=2**40)]
SplitName = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_-]*$")]


def draw(bounds: tuple[float, float], dice: random.Random) -> float:
    """Returns a number that is uniform between two bounds; the number itself if they are equal."""
    low, high = bounds
    return low if low == high else low + (high - low) * dice.random()


class Part(BaseModel):
    """A part of a plan. Immutable; unknown names are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Maps(Part):
    """Maps of a data set: files, or generated floor plans."""

    files: Annotated[tuple[Name, ...], BeforeValidator(_as_list)] = Field(
        (), description="map files; names may have wildcards, and are relative to the folder of the plan"
    )
    resolution: _Positive | None = Field(None, description="side of a cell [m]; not for files of map_server")
    unknown: Literal["free", "occupied"] = Field("free", description="how unknown cells act")
    floor_plan: str | None = Field(None, description="kind of floor plan to generate, instead of files")
    seeds: Annotated[tuple[Seed, Seed], BeforeValidator(_as_range), AfterValidator(_check_order)] = Field(
        (0, 0), description="seeds of the floor plans: one, or [first, last]"
    )
    size: tuple[Number, Number] = Field((40.0, 25.0), description="width and height of the floor plans [m]")

    @model_validator(mode="after")
    def _check_source(self) -> Maps:
        if bool(self.files) == (self.floor_plan is not None):
            raise ValueError("each entry of maps must have either files or floor_plan")
        if self.floor_plan is not None and self.floor_plan not in KINDS:
            near = nearest(self.floor_plan, KINDS)
            hint = f"; did you mean {near[0]!r}?" if near else ""
            raise ValueError(f"floor_plan must be one of {', '.join(KINDS)}, got {quoted(self.floor_plan)}{hint}")
        return self


class Obstacles(Part):
    """Discs that stand in each scene, with their centres where a disc of `poses.clearance` is free of walls."""

    count: CountRange = Field((0, 0), description="number of discs")
    radius: PositiveRange = Field((0.1, 0.4), description="radius of a disc [m]")


class Scanner(Part):
    """The laser scanner. The meaning of the angles is that of `LaserScanner`."""

    fov: Number | None = None
    angle_min: Number | None = None
    angle_max: Number | None = None
    angle_increment: Number | None = None
    beam_count: Annotated[Count, Field(ge=1, le=100_000)] = 541
    min_range: Annotated[Number, Field(ge=0.0)] = 0.05
    max_range: PositiveRange = (30.0, 30.0)
    mount: tuple[Range, ...] = Field(
        ((0.0, 0.0),) * 3, description="[x, y, yaw] or [x, y, z, roll, pitch, yaw] of the scanner on the robot [m, rad]"
    )
    scan_duration: Annotated[Number, Field(ge=0.0)] = Field(
        0.0, description="time that a scan takes [s]; 0 takes all beams in one instant"
    )

    @model_validator(mode="after")
    def _check(self) -> Scanner:
        if len(self.mount) not in (3, 6):
            raise ValueError(f"mount must have 3 or 6 numbers, got {len(self.mount)}")
        if self.max_range[0] <= self.min_range:
            raise ValueError(f"max_range must be above min_range, {self.min_range:g} m, got {self.max_range[0]:g} m")
        self.made(random.Random(0))
        return self

    def made(self, dice: random.Random) -> LaserScanner:
        """Returns a scanner, with numbers drawn where the plan has ranges."""
        names = ("fov", "angle_min", "angle_max", "angle_increment")
        angles = {name: getattr(self, name) for name in names if getattr(self, name) is not None}
        return LaserScanner(
            **angles,
            beam_count=self.beam_count,
            min_range=self.min_range,
            max_range=draw(self.max_range, dice),
            mount=tuple(draw(bounds, dice) for bounds in self.mount),
        )


class Noise(Part):
    """The noise of the ranges: the parameters of `BeamModel`."""

    sigma_hit: PositiveRange = (0.005, 0.005)
    lambda_short: PositiveRange = (2.0, 2.0)
    z_hit: WeightRange = (0.995, 0.995)
    z_short: WeightRange = (0.0, 0.0)
    z_max: WeightRange = (0.005, 0.005)
    z_rand: WeightRange = (0.0, 0.0)
    range_offset: Range = (0.0, 0.0)
    range_sigma_base: WeightRange = (0.0, 0.0)
    range_sigma_per_metre: WeightRange = (0.0, 0.0)
    range_step: WeightRange = (0.0, 0.0)
    range_step_share: WeightRange = (0.0, 0.0)

    def drawn(self, dice: random.Random) -> dict[str, float]:
        """Returns the parameters of a scene, with numbers drawn where the plan has ranges."""
        return {name: draw(bounds, dice) for name, bounds in self}

    @model_validator(mode="after")
    def _check(self) -> Noise:
        for bound in (0, 1):
            BeamModel(**{name: bounds[bound] for name, bounds in self})
        return self


class Surfaces(Part):
    """How what a beam meets changes the noise of its range: the parameters of `SurfaceModel`."""

    incidence_sigma: WeightRange = (0.0, 0.0)
    incidence_limit: WeightRange = (1.5, 1.5)
    incidence_bias: Range = (0.0, 0.0)
    correlation: WeightRange = (0.0, 0.0)
    reference_range: WeightRange = (0.0, 0.0)
    beam_divergence: WeightRange = (0.0, 0.0)
    edge_depth: WeightRange = (0.1, 0.1)
    mixing_length: WeightRange = (0.75, 0.75)

    def drawn(self, dice: random.Random) -> dict[str, float]:
        """Returns the parameters of a scene, with numbers drawn where the plan has ranges."""
        return {name: draw(bounds, dice) for name, bounds in self}

    @model_validator(mode="after")
    def _check(self) -> Surfaces:
        for bound in (0, 1):
            SurfaceModel(**{name: bounds[bound] for name, bounds in self})
        return self


class Twist(Part):
    """Velocity of the robot during a scan, in its own frame; drawn for each scan."""

    vx: Range = (0.0, 0.0)
    vy: Range = (0.0, 0.0)
    wz: Range = (0.0, 0.0)


class Poses(Part):
    """Where the robot is at each scan."""

    kind: Literal["free", "drives", "file"] = Field(
        "free", description="free: uniform over the free space; drives: along drives; file: rows of a file, in order"
    )
    clearance: Annotated[Number, Field(ge=0.0)] = Field(
        0.3, description="smallest distance to walls and obstacles [m]; for drives, of the start"
    )
    twist: Twist = Field(Twist(), description="velocities to draw, for kind free")
    policy: str = Field(
        "",
        description="for drives, module:name of what makes a controller, as for benchmarks.run_tasks; "
        "without it, the robot roams and avoids obstacles, as that of the command run",
    )
    period: _Positive = Field(0.1, description="time between two scans of a drive [s]")
    robot: dict[str, Any] = Field({}, description="parameters of the robot that drives, such as velocity_limits")
    file: str = Field("", description="for kind file: a .npy file with rows (x, y, yaw), relative to the folder of the plan")

    @model_validator(mode="after")
    def _check(self) -> Poses:
        if (self.kind == "file") != bool(self.file):
            raise ValueError("poses must have a file if kind is file, and only then")
        for name in ("policy", "robot"):
            if self.kind != "drives" and getattr(self, name):
                raise ValueError(f"poses must have a {name} only if kind is drives")
        for name in self.robot:
            if name in LaserParameters.model_fields and name not in RobotParameters.model_fields:
                raise ValueError(f"robot must have parameters of the robot, got {name}; the scanner is given as scanner")
        RobotParameters.checked(self.robot)
        if self.policy and ":" not in self.policy:
            raise ValueError(f"policy must be like package.module:name, got {quoted(self.policy)}")
        return self


Label = Literal["true_ranges", "twists", "beam_poses", "goals", "goal_distances", "commands", "surfaces", "incidences"]

LABELS: tuple[str, ...] = get_args(Label)
"""Labels that a plan may ask for. Poses, maps, scenes and what was drawn for a scene are always there."""

LABELS_OF_DRIVES = ("goals", "goal_distances", "commands")

Labels = tuple[Label, ...]


class Plan(BaseModel):
    """What a data set contains. Immutable; every instance has passed all checks.

    A data set consists of *scenes*: a map, obstacles, a scanner and noise, and a number of scans with them. If poses come
    from drives, each scene is a drive. Each random number is named by the seed, the split and the scene.

    Raises:
        ValueError: A name is unknown or a value is invalid. The message gives the name, the requirement and the value.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    seed: Seed = Field(0, description="seed of everything that is random")
    count: PositiveCount = Field(description="number of scans")
    maps: Annotated[tuple[Maps, ...], Field(min_length=1)] = Field(description="where the maps come from")
    scanner: Scanner = Scanner()
    noise: Noise | None = Field(None, description="noise of the ranges; null for none")
    surfaces: Surfaces | None = Field(
        None, description="how what a beam meets changes the noise of its range; it needs noise; null for not at all"
    )
    obstacles: Obstacles = Obstacles()
    poses: Poses = Poses()
    labels: Labels = Field((), description=f"labels beside poses: {', '.join(LABELS)}")
    splits: dict[SplitName, _Positive] = Field(
        {"train": 1.0}, description="weight of each split; it gets its share of the maps, and its share of the scans"
    )
    scans_per_scene: PositiveCount = Field(256, description="number of scans with the same map, noise and obstacles")
    scans_per_shard: PositiveCount = Field(4096, description="number of scans in a file")
    format: Literal["zarr", "parquet"] = Field("zarr", description="format of the files")
    compression: Literal["none", "lz4", "zstd"] = Field(
        "lz4", description="compression of the files; with zstd they are smaller, and take more time"
    )
    quantization: Annotated[Number, Field(ge=1e-6, le=1.0)] | None = Field(
        None, description="largest step between two ranges [m], for better compression; see LaserScanner.quantize"
    )
    folder: Path = Field(Path(), exclude=True, description="folder that names of files are relative to")

    def __init__(self, /, **values: Any) -> None:
        try:
            super().__init__(**values)
        except ValidationError as error:
            raise ValueError(_explain(error)) from None

    @model_validator(mode="after")
    def _check(self) -> Plan:
        if not self.splits:
            raise ValueError("splits must have at least one split, got none")
        if len(set(self.labels)) < len(self.labels):
            raise ValueError(f"labels must differ, got {', '.join(self.labels)}")
        if self.scans_per_shard % self.scans_per_scene:
            given = f"{self.scans_per_shard} and {self.scans_per_scene}"
            raise ValueError(f"scans_per_shard must be a multiple of scans_per_scene, got {given}")
        for label in LABELS_OF_DRIVES:
            if label in self.labels and self.poses.kind != "drives":
                raise ValueError(f"only drives have {label}, got poses of kind {self.poses.kind}")
        if self.surfaces is not None and self.noise is None:
            raise ValueError("surfaces need noise, got none")
        if "beam_poses" in self.labels and not self.scanner.scan_duration:
            raise ValueError("beam_poses need a scanner with a scan_duration above 0")
        if self.poses.kind == "file" and len(self.splits) > 1:
            raise ValueError(f"poses of a file are for one split, got {len(self.splits)}")
        return self

    @property
    def scans_per_chunk(self) -> int:
        """Number of scans that are compressed together: the largest part of a shard that is at most `LONGEST_CHUNK`."""
        return next(n for n in range(min(LONGEST_CHUNK, self.scans_per_shard), 0, -1) if self.scans_per_shard % n == 0)

    @property
    def content(self) -> dict[str, Any]:
        """All values as JSON has them, without the folder."""
        return self.model_dump(mode="json")


def load_plan(path: str | Path) -> Plan:
    """Returns the plan of a YAML file.

    Args:
        path: The file. Names of files in it are relative to its folder.

    Raises:
        OSError: The file cannot be read.
        ValueError: The file is not YAML, or the plan is invalid.
    """
    path = Path(path)
    root = value_of(parse(read_text(path), path))
    if not isinstance(root, dict):
        raise ValueError(f"{path}: a plan must be a mapping of names to values, got {quoted(root)}")
    if "folder" in root:
        raise ValueError(f"{path}: {_unknown(('folder',))}")
    try:
        # Absolute, because workers may have another working folder.
        return Plan(**root, folder=path.parent.absolute())
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


_NEEDED = {
    "tuple_type": "be a list",
    "dict_type": "be a mapping of names to values",
    "model_type": "be a mapping of names to values",
    "string_type": "be a text",
}
"""What YAML must have, for errors of pydantic that name types of Python."""


def _explain(error: ValidationError) -> str:
    messages, details = [], error.errors(include_url=False)
    for detail in details:
        # If an item is wrong, pydantic also counts the right ones.
        if detail["type"] == "too_short" and any(
            detail["loc"] == other["loc"][: len(detail["loc"])] != other["loc"] for other in details
        ):
            continue
        name = _text(detail["loc"])
        message = detail["msg"].removeprefix("Value error, ")
        if detail["type"] == "extra_forbidden":
            messages.append(_unknown(detail["loc"]))
        elif detail["type"] == "missing":
            messages.append(f"{name} is required")
        elif "should " in message or detail["type"] in _NEEDED:
            needed = _NEEDED.get(detail["type"]) or message.partition("should ")[2].partition(" after validation")[0]
            messages.append(f"{name} must {needed}, got {quoted(detail['input'])}")
        else:
            messages.append(f"{name}: {message}" if name else message)
    return "; ".join(messages)


def _text(place: tuple[int | str, ...]) -> str:
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in place).lstrip(".")


def _unknown(place: tuple[int | str, ...]) -> str:
    """Returns the message about an unknown name, with the most similar one that its part of the plan has."""
    part: type[BaseModel] = Plan
    for name in place[:-1]:
        if isinstance(name, str):
            part = _part_in(part.model_fields[name].annotation) or part
    near = nearest(place[-1], sorted({*part.model_fields} - {"folder"}))
    return f"unknown name in the plan: {_text(place)}" + (f"; did you mean {near[0]}?" if near else "")


def _part_in(kind: Any) -> type[BaseModel] | None:
    """Returns the part of a plan that a type is, or that it contains, as a tuple does."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return kind
    return next((part for inner in get_args(kind) if (part := _part_in(inner))), None)
