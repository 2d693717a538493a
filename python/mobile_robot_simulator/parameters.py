"""Parameters of the two nodes: names, defaults, units and checks; from YAML files and command lines, and back to YAML."""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, TypeVar

import yaml
from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from ._core import BeamModel, LaserScanner, Limits, MotionNoise, Pose, Shape

T = TypeVar("T", bound="Parameters")


def _no_bool(value: object) -> object:
    """Refuse a truth value, which Python would take for 0 or 1."""
    if isinstance(value, bool):
        raise ValueError("Input should be a number")
    return value


def _seed(value: int) -> int:
    if not 0 <= value < 2**64:
        raise ValueError("Input should be in 0..2**64 - 1")
    return value


Number = Annotated[float, BeforeValidator(_no_bool), Field(allow_inf_nan=False)]
Rate = Annotated[Number, Field(gt=0.0, le=1e6)]
Weight = Annotated[Number, Field(ge=0.0)]
Count = Annotated[int, BeforeValidator(_no_bool)]
Name = Annotated[str, Field(min_length=1)]
Triple = tuple[Number, Number, Number]
Alpha = Annotated[Number, Field(ge=0.0)]
Limit = Annotated[float, BeforeValidator(_no_bool), Field(ge=0.0)]
LimitTriple = tuple[Limit, Limit, Limit]


def _topic(name: str) -> str:
    """Refuse what no ROS takes for the name of a topic or service."""
    if not re.fullmatch(r"[/~]?[A-Za-z_]\w*(/[A-Za-z_]\w*)*", name, re.ASCII):
        raise ValueError("a name such as /scan")
    return name


Topic = Annotated[str, AfterValidator(_topic)]


def _outline_text(value: object) -> object:
    """Corners given as such, as text."""
    return value if isinstance(value, str) else yaml.safe_dump(value, default_flow_style=True, width=math.inf).strip()


def _check_outline(text: str) -> str:
    """Refuse what is no outline."""
    if text:
        try:
            Shape.polygon(yaml.safe_load(text))
        except (ValueError, TypeError, yaml.YAMLError) as error:
            raise ValueError(f"corners [[x, y], ...] of an outline ({error})") from None
    return text


class Parameters(BaseModel):
    """Parameters of a node, checked together."""

    model_config = ConfigDict(extra="forbid", frozen=True)
    node_name: ClassVar[str]

    @classmethod
    def checked(cls: type[T], values: Mapping[str, Any]) -> T:
        """Parameters of these values, defaults where there is none.

        raises: ValueError that names the parameter, its value and what was needed.
        """
        try:
            return cls.model_validate(dict(values))
        except ValidationError as error:
            raise ValueError(_explain(error, cls.model_fields)) from None

    def changed(self: T, values: Mapping[str, Any]) -> T:
        """The same with some values changed, checked again."""
        return type(self).checked({**self.model_dump(), **values})


class RobotParameters(Parameters):
    """Parameters of `MobileRobotSimulator`."""

    node_name = "mobile_robot_simulator_node"

    publish_map_transform: bool = Field(
        False, description="publish map -> odom, and take /initialpose; Simulation and run: true unless set"
    )
    publish_rate: Rate = Field(10.0, description="rate of odometry, transforms and clock, Hz")
    publish_clock: bool = Field(True, description="whether to publish /clock; on ROS 1 the default is false")
    clock_rate: Annotated[Number, Field(ge=0.0, le=1e6)] = Field(
        0.0, description="rate of the clock, Hz; 0 is publish_rate; on ROS the default is 100"
    )
    velocity_topic: Topic = Field("/cmd_vel", description="topic of velocity commands")
    odometry_topic: Topic = Field("/odom", description="topic of the odometry")
    base_link_frame: Name = Field("base_link", description="frame of the robot, child frame of the odometry")
    odom_frame_id: Name = Field("odom", description="frame of the odometry")
    map_frame_id: Name = Field("map", description="frame of the map")
    cmd_vel_stamped: bool = Field(
        True, description="take TwistStamped rather than Twist; Simulation and run: false unless set"
    )
    speed_factor: Annotated[Rate, Field(le=1e3)] = Field(1.0, description="simulated time over wall time when paced")
    velocity_timeout: Annotated[Number, Field(ge=0.0)] = Field(
        0.5, description="a command is held for so long, s; 0 holds it for ever"
    )
    robot_radius: Annotated[Number, Field(ge=0.0, le=1e6)] = Field(
        0.0, description="radius of the robot's footprint, m; 0 for none: then nothing holds it back"
    )
    footprint: Annotated[str, BeforeValidator(_outline_text), AfterValidator(_check_outline)] = Field(
        "", description="corners of the robot's footprint instead, m, as [[x, y], ...]; empty for none"
    )
    contact: Literal["stop", "slide", "report"] = Field(
        "stop", description="what contact with walls and others does to the robot: stop, slide or report"
    )
    velocity_limits: LimitTriple | None = Field(None, description="most of [vx, vy, wz] either way, m/s and rad/s")
    acceleration_limits: LimitTriple | None = Field(
        None, description="most that [vx, vy, wz] grow by in a second, m/s^2 and rad/s^2"
    )
    deceleration_limits: LimitTriple | None = Field(
        None, description="most that they fall by in a second; acceleration_limits if not given"
    )
    odometry_alphas: tuple[Alpha, Alpha, Alpha, Alpha, Alpha, Alpha] | None = Field(
        None, description="drift of the odometry: alpha1 to alpha6 of Probabilistic Robotics, table 5.3; none if not given"
    )
    odometry_seed: Annotated[Count, AfterValidator(_seed)] = Field(
        0, description="seed of the odometry's drift; Simulation and run: that of the noise unless set"
    )

    @model_validator(mode="after")
    def _have_one_footprint(self) -> RobotParameters:
        if self.robot_radius and self.footprint:
            raise ValueError(
                f"one of robot_radius and footprint must be left out, got {self.robot_radius} and {self.footprint}"
            )
        return self

    @property
    def shape(self) -> Shape | None:
        """The robot's footprint."""
        if self.footprint:
            return Shape.polygon(yaml.safe_load(self.footprint))
        return Shape.disc(self.robot_radius) if self.robot_radius else None

    @property
    def limits(self) -> Limits | None:
        """What the robot's velocity is held to."""
        given = {
            "velocity": self.velocity_limits,
            "acceleration": self.acceleration_limits,
            "deceleration": self.deceleration_limits or self.acceleration_limits,
        }
        limits = {name: triple for name, triple in given.items() if triple is not None}
        return Limits(**limits) if limits else None

    @property
    def motion_noise(self) -> MotionNoise | None:
        """Noise model of the odometry, built from `odometry_alphas`; None if they are not given."""
        return None if self.odometry_alphas is None else motion_noise(self.odometry_alphas)


class LaserParameters(Parameters):
    """Parameters of `LaserScannerSimulator`; the defaults are roughly a SICK S300's."""

    node_name = "laser_scanner_simulator_node"

    laser_topic: Topic = Field("/scan", description="topic of the scans")
    odometry_topic: Topic = Field("/odom", description="topic of the odometry, whose twist carries the robot from tf to tf")
    map_service: Topic = Field("/static_map", description="service that the map is asked of")
    map_topic: Annotated[str, AfterValidator(lambda name: name and _topic(name))] = Field(
        "/map", description="topic of maps that take the place of the one in use; empty for none"
    )
    laser_frame_id: Name = Field("base_link", description="frame of the scanner; its mount is taken from tf if tf knows it")
    laser_mount: Triple | None = Field(
        None, description="pose of the scanner on the robot [x, y, yaw], m and rad, published to /tf_static if given"
    )
    laser_fov: Annotated[Number, Field(gt=0.0, le=2.0 * math.pi + 1e-6)] = Field(4.71, description="field of view, rad")
    laser_beam_count: Annotated[Count, Field(ge=1, le=1_000_000)] = Field(541, description="number of beams and of ranges")
    laser_max_range: Annotated[Number, Field(gt=0.0, le=1e30)] = Field(30.0, description="largest range, m")
    laser_min_range: Annotated[Number, Field(ge=0.0)] = Field(0.05, description="smallest valid range, m")
    laser_frequency: Rate = Field(10.0, description="rate of the scans, Hz")
    apply_noise: bool = Field(True, description="whether ranges are noisy")
    sigma_hit: Annotated[Number, Field(gt=0.0)] = Field(0.005, description="standard deviation of a range, m")
    lambda_short: Annotated[Number, Field(gt=0.0)] = Field(2.0, description="rate of unexpected objects, 1/m")
    z_hit: Weight = Field(0.995, description="weight of correct ranges")
    z_short: Weight = Field(0.0, description="weight of unexpected objects")
    z_max: Weight = Field(0.005, description="weight of failures, readings of the largest range")
    z_rand: Weight = Field(0.0, description="weight of unexplained readings")
    no_return: Literal["inf", "max"] = Field(
        "inf", description="what a missing return reads: inf (REP-117) or max, the largest range"
    )
    unknown: Literal["free", "occupied"] = Field("free", description="what unknown cells are to beams: free or occupied")
    seed: Annotated[Count, AfterValidator(_seed)] = Field(0, description="seed of the noise")
    base_link_frame: Name = Field("base_link", description="frame of the robot")
    map_frame_id: Name = Field("map", description="frame of the map, that the scanner is looked up in")

    @model_validator(mode="after")
    def _fit_together(self) -> LaserParameters:
        if self.laser_min_range >= self.laser_max_range:
            raise ValueError(
                f"laser_min_range must be less than laser_max_range {self.laser_max_range}, got {self.laser_min_range}"
            )
        if self.laser_mount is not None and self.laser_frame_id == self.base_link_frame:
            raise ValueError(
                f"laser_mount needs a laser_frame_id of its own, got {self.laser_mount} for {self.laser_frame_id}"
            )
        if self.z_hit + self.z_short + self.z_max + self.z_rand == 0.0:
            raise ValueError("at least one of z_hit, z_short, z_max, z_rand must be positive, got 0 for all")
        return self

    @property
    def beam_model(self) -> BeamModel:
        """Noise model of the ranges, with its weights normalised to a sum of 1."""
        return BeamModel(
            sigma_hit=self.sigma_hit,
            lambda_short=self.lambda_short,
            z_hit=self.z_hit,
            z_short=self.z_short,
            z_max=self.z_max,
            z_rand=self.z_rand,
        )

    def scanner(self, mount: Pose | None = None) -> LaserScanner:
        """Returns the scanner that these parameters describe.

        Args:
            mount: Pose of the scanner in the robot's frame. Default: `laser_mount`, or the identity if that is not given.

        """
        return LaserScanner(
            fov=self.laser_fov,
            beam_count=self.laser_beam_count,
            min_range=self.laser_min_range,
            max_range=self.laser_max_range,
            mount=mount or Pose(*(self.laser_mount or (0.0, 0.0, 0.0))),
        )


class MapParameters(Parameters):
    """Parameters of `MapFileServer`, under the names of nav2_map_server."""

    node_name = "map_server"

    yaml_filename: Name = Field(description="map_server YAML file of the map")
    topic_name: Topic = Field("/map", description="topic of the map")
    service_name: Topic = Field("/static_map", description="service that hands out the map")
    frame_id: Name = Field("map", description="frame of the map")


def motion_noise(alphas: Sequence[float]) -> MotionNoise:
    """Returns the noise model of the odometry with the parameters alpha1 to alpha6."""
    return MotionNoise(**{f"alpha{number}": alpha for number, alpha in enumerate(alphas, start=1)})


NODES: tuple[type[Parameters], ...] = (RobotParameters, LaserParameters)


def check_names(names: Iterable[str], models: Iterable[type[Parameters]] = NODES) -> None:
    """Check that every name is a parameter of one of the nodes.

    raises: ValueError that suggests the nearest name.
    """
    models = tuple(models)
    known = sorted({name for model in models for name in model.model_fields})
    for key in names:
        node, separator, name = key.rpartition(":")
        own = [model for model in models if model.node_name == node]
        if separator and not own:
            raise ValueError(_unknown(node, [model.node_name for model in models], what="node"))
        if name not in (own[0].model_fields if own else known):
            raise ValueError(_unknown(name, own[0].model_fields if own else known))


def for_node(model: type[T], values: Mapping[str, Any]) -> T:
    """A node's parameters out of values for all nodes: `name`, or before that `node:name`."""
    own = {name: values[name] for name in model.model_fields if name in values}
    for name in model.model_fields:
        if (key := f"{model.node_name}:{name}") in values:
            own[name] = values[key]
    return model.checked(own)


def read_file(path: str | Path) -> dict[str, Any]:
    """Values out of a ROS 2 parameter file: `ros__parameters` under `/**` or under a node's name.

    What stands under a node's name is for that node alone, and goes before the rest: its key is `node:name`.

    raises: OSError for a file that can't be read; ValueError for another shape, unknown nodes and unknown parameters.
    """
    data = Path(path).read_bytes()
    try:
        content = yaml.safe_load(data)
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise ValueError(f"{path} is not YAML: {error}") from None
    if not isinstance(content, dict):
        raise ValueError(f"{path} must hold nodes with their ros__parameters, got {type(content).__name__}")
    nodes = {f"{model.node_name}": model for model in NODES}
    values: dict[str, Any] = {}
    for key in sorted(content, key=lambda key: key != "/**"):
        node = str(key).lstrip("/")
        if node not in (*nodes, "**"):
            raise ValueError(f"{path}: {_unknown(str(key), ['/**', *nodes], what='node')}")
        section = content[key]
        parameters = section.get("ros__parameters") if isinstance(section, dict) else None
        if not isinstance(parameters, dict):
            raise ValueError(f"{path}: {key} must hold a mapping ros__parameters, got {section!r}")
        check_names(map(str, parameters), NODES if node == "**" else (nodes[node],))
        values.update(parameters if node == "**" else {f"{node}:{name}": value for name, value in parameters.items()})
    return values


def read_assignment(text: str) -> tuple[str, Any]:
    """Key and value out of `name:=value`, or of `node:name:=value` for one node alone; the value in YAML."""
    name, separator, value = text.partition(":=")
    if not separator or not name:
        raise ValueError(f"a parameter must be given as name:=value, got {text!r}")
    check_names([name])
    try:
        return name, yaml.safe_load(value)
    except yaml.YAMLError:
        raise ValueError(f"the value of {name} must be YAML, got {value!r}") from None


def to_yaml(values: Mapping[str, Any] | None = None) -> str:
    """All parameters with their meanings, in the shape that `read_file` reads; defaults where no value is given."""
    check_names(values or {})
    lines = []
    for model in NODES:
        parameters = for_node(model, values or {})
        lines += [f"{model.node_name}:", "  ros__parameters:"]
        for name, info in model.model_fields.items():
            value = yaml.safe_dump(getattr(parameters, name), default_flow_style=True).removesuffix("...\n").strip()
            value = f"[{', '.join(map(str, getattr(parameters, name)))}]" if value.startswith("!!python/tuple") else value
            lines.append(f"    {name}: {value}".ljust(46) + f"  # {info.description}")
    return "\n".join(lines) + "\n"


def _unknown(name: str, known: Iterable[str], what: str = "parameter") -> str:
    known = list(known)
    near = difflib.get_close_matches(name.lower(), known, n=1, cutoff=0.5)
    return f"unknown {what} {name!r}; " + (f"did you mean {near[0]!r}?" if near else f"known are {', '.join(known)}")


def _explain(error: ValidationError, known: Iterable[str]) -> str:
    """What was wrong, one line for each parameter."""
    lines = []
    for detail in error.errors(include_url=False):
        where = ".".join(str(part) for part in detail["loc"])
        message = detail["msg"].removeprefix("Value error, ")
        if detail["type"] == "extra_forbidden":
            lines.append(_unknown(where, known))
        elif where:
            needed = message.removeprefix("Input should be ")
            lines.append(f"{where} must be {needed}, got {detail['input']!r}")
        else:
            lines.append(message)
    return "; ".join(lines)
