"""Parameters of the nodes: names, defaults, units, checks, and the objects of the core that are built from them."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal, TypeVar

import numpy as np
import yaml
from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator
from pydantic_core import ErrorDetails

from ._core import (
    FULL_TURN_TOLERANCE,
    BeamModel,
    Drive,
    LaserScanner,
    Limits,
    MotionNoise,
    Pose,
    Shape,
    SurfaceModel,
    laser_presets,
)
from .quoting import nearest, quoted, shortened
from .yaml_documents import parse, value_of

__all__ = [
    "NODES",
    "LaserParameters",
    "MapParameters",
    "Parameters",
    "RobotParameters",
    "WorldParameters",
]

T = TypeVar("T", bound="Parameters")


def _reject_bool(value: object) -> object:
    """Rejects booleans, which would otherwise pass as 0 and 1."""
    if isinstance(value, bool):
        raise ValueError("Input should be a number")
    return value


def _numbers(*names: str) -> BeforeValidator:
    """Returns a validator that rejects anything but a sequence of as many items as there are names."""

    def check(value: object) -> object:
        items = value.tolist() if isinstance(value, np.ndarray) else value
        if not isinstance(items, Sequence) or isinstance(items, str) or len(items) != len(names):
            raise ValueError(f"Input should be {len(names)} numbers [{', '.join(names)}]")
        return items

    return BeforeValidator(check)


def _check_mount(value: object) -> object:
    items = value.tolist() if isinstance(value, np.ndarray) else value
    if not isinstance(items, Sequence) or isinstance(items, str) or len(items) not in (3, 6):
        raise ValueError("Input should be 3 numbers [x, y, yaw] or 6 numbers [x, y, z, roll, pitch, yaw]")
    return items


def _check_seed(value: int) -> int:
    if not 0 <= value < 2**64:
        raise ValueError("Input should be in 0..2**64 - 1")
    return value


Number = Annotated[float, BeforeValidator(_reject_bool), Field(allow_inf_nan=False)]
Rate = Annotated[Number, Field(gt=0.0, le=1e6)]
Weight = Annotated[Number, Field(ge=0.0)]
Count = Annotated[int, BeforeValidator(_reject_bool)]
LARGEST_ANGLE = 2.0 * math.pi + FULL_TURN_TOLERANCE
Angle = Annotated[Number, Field(ge=-LARGEST_ANGLE, le=LARGEST_ANGLE)]
Seed = Annotated[Count, AfterValidator(_check_seed)]
Name = Annotated[str, Field(min_length=1)]
PoseTriple = Annotated[tuple[Number, Number, Number], _numbers("x", "y", "yaw")]
MountNumbers = Annotated[tuple[Number, ...], BeforeValidator(_check_mount)]
Alpha = Annotated[Number, Field(ge=0.0)]
Alphas = Annotated[
    tuple[Alpha, Alpha, Alpha, Alpha, Alpha, Alpha], _numbers("alpha1", "alpha2", "alpha3", "alpha4", "alpha5", "alpha6")
]
Limit = Annotated[float, BeforeValidator(_reject_bool), Field(ge=0.0)]
LimitTriple = Annotated[tuple[Limit, Limit, Limit], _numbers("vx", "vy", "wz")]


FOUR_WHEELS = ("front_left_wheel_joint", "front_right_wheel_joint", "rear_left_wheel_joint", "rear_right_wheel_joint")
JOINTS: Mapping[str, tuple[str, ...]] = {
    "planar": (),
    "differential": ("left_wheel_joint", "right_wheel_joint"),
    "omni": FOUR_WHEELS,
    "ackermann": (*FOUR_WHEELS, "front_left_steering_joint", "front_right_steering_joint"),
}
"""Names of the joints of each drive: the wheels in the order of `Drive`, then the steering."""


def is_topic_name(name: str) -> bool:
    """Returns True if a name is valid for topics and services in ROS."""
    return bool(re.fullmatch(r"[/~]?[A-Za-z_]\w*(/[A-Za-z_]\w*)*", name, re.ASCII))


def _check_topic(name: str) -> str:
    """Rejects names that are not valid for topics and services in ROS."""
    if not is_topic_name(name):
        raise ValueError("Input should be a name such as /scan")
    return name


Positive = Annotated[Number, Field(gt=0.0, le=1e6)]
Topic = Annotated[str, AfterValidator(_check_topic)]
OptionalTopic = Annotated[str, AfterValidator(lambda name: name and _check_topic(name))]


def _check_names_of(one: str, other: str) -> Callable[[object], object]:
    """Returns a validator that rejects what is not a list of different names that ROS accepts in a namespace.

    Args:
        one: An example of a name, for the error.
        other: Another example.
    """

    def check(names: object) -> object:
        is_list = isinstance(names, list | tuple) and all(isinstance(name, str) for name in names)
        if not is_list or not all(re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII) for name in names):  # type: ignore[attr-defined]
            raise ValueError(f"Input should be a list of names such as [{one}, {other}]")
        if len(set(names)) < len(names):  # type: ignore[call-overload, arg-type]
            raise ValueError("Input should be a list of different names")
        return names

    return check


def _check_preset(name: str) -> str:
    """Rejects what is neither empty nor the name of a preset."""
    if name and name not in laser_presets():
        raise ValueError(f"Input should be empty or one of {', '.join(laser_presets())}")
    return name


def _check_faults(texts: object) -> object:
    """Rejects what is not a list of texts."""
    if not (isinstance(texts, list | tuple) and all(isinstance(text, str) for text in texts)):
        raise ValueError("""Input should be a list of texts such as ["Drop('/scan', probability=0.1)"]""")
    return texts


def _corners_to_text(value: object) -> object:
    """Returns the corners as YAML text. Text is returned unchanged."""
    if isinstance(value, str):
        return value
    try:
        corners = [[x if isinstance(x, int) else float(x) for x in (x, y)] for x, y in value]  # type: ignore[attr-defined]
    except (TypeError, ValueError):
        raise ValueError("Input should be the corners [[x, y], ...] of a polygon") from None
    return yaml.safe_dump(corners, default_flow_style=True, width=math.inf).strip()


def _check_corners(text: str) -> str:
    if text:
        try:
            Shape.polygon(value_of(parse(text)))
        except (ValueError, TypeError) as error:
            raise ValueError(f"Input should be the corners [[x, y], ...] of a polygon ({shortened(error)})") from None
    return text


class Parameters(BaseModel):
    """Base class of the parameters of a node. Immutable; every instance has passed all checks.

    Raises:
        ValueError: A name is unknown or a value is invalid. The message gives the name, the value and the requirement.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)
    node_name: ClassVar[str]
    """Name of the node, as in parameter files."""

    def __init__(self, **values: Any) -> None:
        try:
            super().__init__(**values)
        except ValidationError as error:
            raise ValueError(_explain(error, type(self).model_fields)) from None

    @classmethod
    def checked(cls: type[T], values: Mapping[str, Any]) -> T:
        """Returns parameters with these values, and defaults for all others.

        Args:
            values: Values by parameter name.

        Raises:
            ValueError: A name is unknown or a value is invalid. The message gives the name, the value and the requirement.
        """
        return cls(**values)

    def changed(self: T, values: Mapping[str, Any]) -> T:
        """Returns a copy with some values changed, after checking them as `checked` does.

        Args:
            values: Changed values by parameter name.

        Raises:
            ValueError: A name is unknown or a value is invalid.
        """
        given = self.model_dump(include=self.model_fields_set)
        return type(self).checked({**given, **values})

    @cached_property
    def frames(self) -> Mapping[str, str]:
        """Full name of each frame: the value of a parameter such as `base_link_frame`, after `frame_prefix`.

        Computed once, because the nodes need frames for each message. It has an entry for every parameter that is a text.
        """
        prefix, texts = getattr(self, "frame_prefix", ""), {name: value for name, value in self if isinstance(value, str)}
        return {name: f"{prefix}{text.lstrip('/')}" if prefix else text for name, text in texts.items()}


FRAME_PREFIX: Any = Field("", description="prefix of all frames except the map's, such as robot1/")


class RobotParameters(Parameters):
    """Parameters of `MobileRobotSimulator`."""

    node_name = "mobile_robot_simulator_node"

    scanners: Annotated[tuple[str, ...], BeforeValidator(_check_names_of("front", "rear"))] = Field(
        (),
        description="names of several scanners, each with parameters of its own such as front.laser_mount; "
        "empty for one scanner without a name",
    )
    publish_map_transform: bool = Field(
        False,
        description="publish the transform map -> odom and subscribe to /initialpose (default true in Simulation and run)",
    )
    publish_rate: Rate = Field(10.0, description="rate of odometry, transforms and /clock [Hz]")
    publish_clock: bool = Field(True, description="publish /clock (default false in ROS 1)")
    clock_rate: Annotated[Number, Field(ge=0.0, le=1e6)] = Field(
        0.0, description="rate of /clock [Hz]; 0 uses publish_rate (default 100 in ROS)"
    )
    velocity_topic: Topic = Field("cmd_vel", description="topic of the velocity commands")
    odometry_topic: Topic = Field("odom", description="topic of the odometry")
    base_link_frame: Name = Field("base_link", description="frame of the robot; child frame of the odometry")
    odom_frame_id: Name = Field("odom", description="frame of the odometry")
    map_frame_id: Name = Field("map", description="frame of the map")
    frame_prefix: str = FRAME_PREFIX
    initial_pose: PoseTriple = Field(
        (0.0, 0.0, 0.0), description="pose [x, y, yaw] in the map frame at the start and after a reset [m, m, rad]"
    )
    ground_truth_topic: OptionalTopic = Field(
        "ground_truth",
        description="topic of the true pose and velocity, in the map frame; empty for none (default in Simulation and run)",
    )
    contact_topic: OptionalTopic = Field(
        "contacts",
        description="topic of the points in the map frame where the footprint touches something, one at the start of each "
        "contact; empty for none (default in Simulation and run)",
    )
    stalled_topic: OptionalTopic = Field(
        "stalled",
        description="latched topic that says whether contact keeps the robot from following its commands; empty for none "
        "(default in Simulation and run)",
    )
    ground_truth_frame: str = Field(
        "", description="child frame of a transform from map_frame_id that is the true pose; empty for none"
    )
    cmd_vel_stamped: bool = Field(
        True,
        description="expect TwistStamped instead of Twist (default false in ROS 1, Simulation and run); "
        "on ROS, the other type is taken while only that is published",
    )
    speed_factor: Annotated[Rate, Field(le=1e3)] = Field(
        1.0, description="simulated seconds per second of wall time, when the simulation follows the wall clock"
    )
    velocity_timeout: Annotated[Number, Field(ge=0.0)] = Field(
        0.5, description="time for which a command is held [s]; 0 holds it until the next command"
    )
    robot_radius: Annotated[Number, Field(ge=0.0, le=1e6)] = Field(
        0.0, description="radius of a round footprint [m]; 0 for none; without any footprint there is no contact"
    )
    footprint: Annotated[str, BeforeValidator(_corners_to_text), AfterValidator(_check_corners)] = Field(
        "", description="corners [[x, y], ...] of a polygonal footprint [m], instead of robot_radius; empty for none"
    )
    contact: Literal["stop", "slide", "report"] = Field(
        "stop", description="effect of contact with walls, obstacles and other robots: stop, slide or report"
    )
    map_service: Topic = Field(
        "static_map", description="name of the GetMap service, for the map of a robot with a footprint (not in Simulation)"
    )
    map_topic: OptionalTopic = Field(
        "map", description="topic of maps that replace the current one; empty for none (not in Simulation)"
    )
    unknown: Literal["free", "occupied"] = Field(
        "free", description="treatment of unknown cells: free, or occupied, which a footprint collides with"
    )
    velocity_limits: LimitTriple | None = Field(
        None, description="largest absolute velocity [vx, vy, wz] [m/s, m/s, rad/s]; null for no limits"
    )
    acceleration_limits: LimitTriple | None = Field(
        None, description="largest increase of [vx, vy, wz] per second [m/s^2, m/s^2, rad/s^2]; null for no limits"
    )
    deceleration_limits: LimitTriple | None = Field(
        None,
        description="largest decrease of [vx, vy, wz] per second [m/s^2, m/s^2, rad/s^2]; null for acceleration_limits",
    )
    odometry_alphas: Alphas | None = Field(
        None,
        description="noise of the odometry for steps of 0.1 s: alpha1 to alpha6 (Probabilistic Robotics, table 5.3); "
        "null for none",
    )
    odometry_seed: Seed = Field(
        0, description="seed of the noise of the odometry (default in Simulation and run: same as seed)"
    )

    drive: Literal["planar", "differential", "omni", "ackermann"] = Field(
        "planar",
        description="how wheels move the robot: planar (in any direction, without wheels), differential, omni (mecanum "
        "wheels) or ackermann (like a car; base_link is the middle of the rear axle)",
    )
    wheelbase: Positive | None = Field(None, description="distance between the axles [m]; for omni and ackermann")
    track: Positive | None = Field(
        None, description="distance between the wheels of an axle [m]; for every drive but planar"
    )
    wheel_radius: Positive | None = Field(None, description="radius of the wheels [m]; for every drive but planar")
    wheel_speed_limit: Positive | None = Field(
        None, description="largest speed of a wheel [rad/s], of the rear axle for ackermann; null for no limit"
    )
    steering_limit: Annotated[Number, Field(gt=0.0, le=1.5)] = Field(
        0.6, description="largest steering angle of a wheel in the middle of the front axle [rad]; for ackermann"
    )
    steering_rate: Positive | None = Field(
        None, description="largest change of the steering angle per second [rad/s]; null for no limit; for ackermann"
    )
    ackermann_topic: OptionalTopic = Field(
        "ackermann_cmd",
        description="topic of commands with a speed and a steering angle, beside velocity_topic; empty for none; "
        "for ackermann",
    )
    joint_states_topic: OptionalTopic = Field(
        "joint_states", description="topic of the wheels and the steering; empty for none; for every drive but planar"
    )
    joint_names: Annotated[tuple[str, ...], BeforeValidator(_check_names_of("left_wheel", "right_wheel"))] = Field(
        (), description="names of the joints in joint states, the wheels first; empty for names such as left_wheel_joint"
    )
    left_wheel_radius_multiplier: Positive = Field(
        1.0, description="radius of the left wheels in the odometry, as a multiple of the true one"
    )
    right_wheel_radius_multiplier: Positive = Field(
        1.0, description="radius of the right wheels in the odometry, as a multiple of the true one"
    )
    track_multiplier: Positive = Field(1.0, description="track in the odometry, as a multiple of the true one")
    encoder_ticks: Annotated[Number, Field(ge=0.0, le=1e9)] = Field(
        0.0, description="counts of the encoder of each wheel per turn, for the odometry; 0 for exact encoders"
    )
    wheel_slip: Annotated[Number, Field(ge=0.0, le=1.0)] = Field(
        0.0, description="share of the commanded motion that slipping wheels lose; the odometry does not notice it"
    )

    @model_validator(mode="after")
    def _check_footprint(self) -> RobotParameters:
        if self.robot_radius and self.footprint:
            given = f"got {self.robot_radius} and {quoted(self.footprint)}"
            raise ValueError(f"only one of robot_radius and footprint may be given, {given}")
        if self.ground_truth_frame in (self.base_link_frame, self.odom_frame_id, self.map_frame_id):
            raise ValueError(f"ground_truth_frame must be a frame of its own, got {quoted(self.ground_truth_frame)}")
        return self

    @model_validator(mode="after")
    def _check_drive(self) -> RobotParameters:
        needed = {"planar": (), "differential": ("track", "wheel_radius")}
        for name in needed.get(self.drive, ("wheelbase", "track", "wheel_radius")):
            if getattr(self, name) is None:
                raise ValueError(f"{name} must be given for the drive {self.drive}, got none")
        if self.joint_names and len(self.joint_names) != len(JOINTS[self.drive]):
            count = len(JOINTS[self.drive])
            raise ValueError(
                f"joint_names must be {count} names for the drive {self.drive}, got {quoted(list(self.joint_names))}"
            )
        return self

    @property
    def wheels(self) -> Drive | None:
        """Wheels of the robot; None if it is planar."""
        if self.drive == "planar":
            return None
        assert self.track is not None and self.wheel_radius is not None
        limit = math.inf if self.wheel_speed_limit is None else self.wheel_speed_limit
        if self.drive == "differential":
            return Drive.differential(track=self.track, wheel_radius=self.wheel_radius, wheel_speed_limit=limit)
        assert self.wheelbase is not None
        size = {"wheelbase": self.wheelbase, "track": self.track, "wheel_radius": self.wheel_radius}
        if self.drive == "omni":
            return Drive.omni(**size, wheel_speed_limit=limit)
        rate = math.inf if self.steering_rate is None else self.steering_rate
        return Drive.ackermann(**size, steering_limit=self.steering_limit, steering_rate=rate, wheel_speed_limit=limit)

    @property
    def believed_wheels(self) -> Drive | None:
        """Wheels as the odometry takes them to be; None if it is exact."""
        drive, left, right = self.wheels, self.left_wheel_radius_multiplier, self.right_wheel_radius_multiplier
        if drive is None or (left, right, self.track_multiplier, self.encoder_ticks) == (1.0, 1.0, 1.0, 0.0):
            return None
        return drive.with_multipliers(left_radius=left, right_radius=right, track=self.track_multiplier)

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints: the wheels, then the left and the right steering."""
        return self.joint_names or JOINTS[self.drive]

    @property
    def shape(self) -> Shape | None:
        """Footprint in the robot's frame; None if neither `robot_radius` nor `footprint` is given."""
        if self.footprint:
            return Shape.polygon(value_of(parse(self.footprint)))
        return Shape.disc(self.robot_radius) if self.robot_radius else None

    @property
    def limits(self) -> Limits | None:
        """Limits on velocity and acceleration; None if none are given."""
        given = {
            "velocity": self.velocity_limits,
            "acceleration": self.acceleration_limits,
            "deceleration": self.deceleration_limits or self.acceleration_limits,
        }
        limits = {name: triple for name, triple in given.items() if triple is not None}
        return Limits(**limits) if limits else None

    @property
    def motion_noise(self) -> MotionNoise | None:
        """Noise model of the odometry, from `odometry_alphas`; None if they are not given."""
        return None if self.odometry_alphas is None else motion_noise(self.odometry_alphas)


class LaserParameters(Parameters):
    """Parameters of `LaserScannerSimulator`; the defaults are close to a SICK S300.

    The weights `z_hit`, `z_short`, `z_max` and `z_rand` are normalised to a sum of 1.
    """

    node_name = "laser_scanner_simulator_node"

    laser_topic: Topic = Field("scan", description="topic of the scans")
    odometry_topic: Topic = Field(
        "odom", description="topic of the odometry; its twist extrapolates the pose of the robot between transforms"
    )
    map_service: Topic = Field("static_map", description="name of the GetMap service")
    map_topic: OptionalTopic = Field("map", description="topic of maps that replace the current one; empty for none")
    laser_frame_id: Name = Field(
        "base_link", description="frame of the scanner; its pose on the robot is read from tf if tf has one"
    )
    laser_mount: MountNumbers | None = Field(
        None,
        description="pose of the scanner on the robot, [x, y, yaw] or [x, y, z, roll, pitch, yaw] [m, rad], published to "
        "/tf_static; null for none",
    )
    laser_preset: Annotated[str, AfterValidator(_check_preset)] = Field(
        "",
        description="a scanner that is sold, such as hokuyo_utm30lx: its field, beams, ranges, rate and noise replace the "
        "defaults; other parameters that are given count more; empty for none",
    )
    laser_fov: Annotated[Number, Field(gt=0.0, le=LARGEST_ANGLE)] = Field(4.71, description="field of view [rad]")
    laser_angle_min: Angle | None = Field(
        None, description="smallest angle of the beams [rad], together with laser_angle_max and instead of laser_fov"
    )
    laser_angle_max: Angle | None = Field(None, description="largest angle of the beams [rad]")
    laser_clockwise: bool = Field(False, description="measure clockwise, from the largest angle to the smallest")
    laser_beam_count: Annotated[Count, Field(ge=1, le=1_000_000)] = Field(
        541, description="number of beams, and of ranges in a scan"
    )
    laser_max_range: Annotated[Number, Field(gt=0.0, le=1e30)] = Field(30.0, description="largest range [m]")
    laser_min_range: Annotated[Number, Field(ge=0.0)] = Field(0.05, description="smallest valid range [m]")
    laser_frequency: Rate = Field(10.0, description="rate of the scans [Hz]")
    laser_scan_duration: Annotated[Number, Field(ge=0.0)] = Field(
        0.0,
        description="time in which the head turns through the field of the beams [s], at most one period; a head that turns "
        "at laser_frequency takes laser_fov / 2π of a period; 0 measures all beams in one instant",
    )
    laser_intensities: bool = Field(
        False, description="fill intensities of the scans: how much light comes back, 1 for a white wall 1 m ahead"
    )
    apply_noise: bool = Field(True, description="add noise to the ranges")
    sigma_hit: Annotated[Number, Field(gt=0.0)] = Field(0.005, description="standard deviation of a correct range [m]")
    lambda_short: Annotated[Number, Field(gt=0.0)] = Field(
        2.0, description="decay rate of the distance to unexpected objects [1/m]"
    )
    z_hit: Weight = Field(0.995, description="weight of correct ranges")
    z_short: Weight = Field(0.0, description="weight of ranges to unexpected objects")
    z_max: Weight = Field(0.005, description="weight of failed measurements, which read laser_max_range")
    z_rand: Weight = Field(0.0, description="weight of random readings, uniform from 0 to laser_max_range")
    range_offset: Number = Field(0.0, description="distance by which correct ranges lie behind the true ones [m]")
    range_sigma_base: Weight = Field(
        0.0,
        description="the standard deviation of a correct range is at least this plus range_sigma_per_metre times the true "
        "range [m]",
    )
    range_sigma_per_metre: Weight = Field(0.0, description="growth of that standard deviation with the range [m/m]")
    range_step: Weight = Field(0.0, description="step to whose multiples readings are rounded [m]; 0 for none")
    range_step_share: Annotated[Number, Field(ge=0.0, le=0.5)] = Field(
        0.0, description="largest share of a reading that its step may be, if that is more than range_step; 0 for none"
    )
    incidence_sigma: Annotated[Number, Field(ge=0.0, le=4.0)] = Field(
        0.0, description="exponent p: the standard deviation of a correct range grows as cos(incidence)^-p; 0 for not at all"
    )
    incidence_limit: Annotated[Number, Field(ge=0.0, le=1.57)] = Field(
        1.5, description="incidence from which on nothing grows any further [rad]"
    )
    incidence_bias: Number = Field(
        0.0, description="1 - cos(incidence) times this is added to a correct range [m]; 0 for nothing"
    )
    correlation: Annotated[Number, Field(ge=0.0, le=1.0)] = Field(
        0.0, description="part of the variance of a correct range that is fixed for each beam and cell"
    )
    reference_range: Weight = Field(
        0.0,
        description="distance at which a white wall, met at a right angle, returns every second beam [m]; "
        "darker, farther and grazing surfaces return fewer; 0 for all beams",
    )
    beam_divergence: Annotated[Number, Field(ge=0.0, le=0.2)] = Field(
        0.0,
        description="angle over which a beam is spread: at an edge, it reads one of the two surfaces or between them [rad]; "
        "0 for a beam without width",
    )
    edge_depth: Weight = Field(
        0.1, description="smallest difference between the ranges of the two surfaces at an edge, for wide beams [m]"
    )
    mixing_length: Weight = Field(
        0.75, description="largest difference of two ranges at an edge that become one reading between them [m]; 0 for none"
    )
    no_return: Literal["inf", "max", "below_max"] = Field(
        "inf",
        description="reading of a beam without a return: inf (REP-117), max (laser_max_range; range_max is then 1 mm more), "
        "or below_max (laser_max_range less 0.1 m)",
    )
    unknown: Literal["free", "occupied"] = Field(
        "free", description="treatment of unknown cells: free, or occupied, which blocks beams"
    )
    seed: Seed = Field(0, description="seed of the noise of the ranges")
    base_link_frame: Name = Field("base_link", description="frame of the robot")
    map_frame_id: Name = Field("map", description="frame of the map, in which the pose of the scanner is looked up")
    frame_prefix: str = FRAME_PREFIX
    pose_source: Literal["truth", "tf"] = Field(
        "truth",
        description="where the scanner measures from: the true pose of the robot, or its pose in tf; "
        "tf is also used while no true pose has arrived",
    )
    ground_truth_topic: OptionalTopic = Field(
        "ground_truth", description="topic of the true pose of the robot; empty for none (not in Simulation)"
    )

    def __init__(self, **values: Any) -> None:
        preset = values.get("laser_preset", "")
        known = laser_presets().get(preset, {}) if isinstance(preset, str) else {}
        super().__init__(**{**known, **values})
        # What comes from the preset is not given, so that another preset replaces it.
        self.model_fields_set.intersection_update(values)

    @model_validator(mode="after")
    def _check_laser(self) -> LaserParameters:
        if self.laser_min_range >= self.laser_max_range:
            raise ValueError(
                f"laser_min_range must be less than laser_max_range {self.laser_max_range}, got {self.laser_min_range}"
            )
        if self.laser_scan_duration > 1.0 / self.laser_frequency:
            raise ValueError(
                f"laser_scan_duration must be at most 1 / laser_frequency, {1.0 / self.laser_frequency:g} s, "
                f"got {self.laser_scan_duration}"
            )
        low, high = self.laser_angle_min, self.laser_angle_max
        if (low is None) != (high is None):
            raise ValueError(f"laser_angle_min and laser_angle_max must be given together, got {low} and {high}")
        if low is not None and high is not None and not 0.0 < high - low <= LARGEST_ANGLE:
            raise ValueError(f"laser_angle_max must exceed laser_angle_min by at most 2π, got {high} and {low}")
        if self.laser_mount is not None and self.laser_frame_id == self.base_link_frame:
            raise ValueError(
                "laser_mount needs a laser_frame_id other than base_link_frame, "
                f"got {self.laser_mount} for {shortened(self.laser_frame_id)}"
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
            range_offset=self.range_offset,
            range_sigma_base=self.range_sigma_base,
            range_sigma_per_metre=self.range_sigma_per_metre,
            range_step=self.range_step,
            range_step_share=self.range_step_share,
        )

    @property
    def surface_model(self) -> SurfaceModel | None:
        """How what a beam meets changes the noise of its range; None if it changes nothing."""
        switches = (self.incidence_sigma, self.incidence_bias, self.correlation, self.reference_range, self.beam_divergence)
        if not any(switches):
            return None
        return SurfaceModel(
            incidence_sigma=self.incidence_sigma,
            incidence_limit=self.incidence_limit,
            incidence_bias=self.incidence_bias,
            correlation=self.correlation,
            reference_range=self.reference_range,
            beam_divergence=self.beam_divergence,
            edge_depth=self.edge_depth,
            mixing_length=self.mixing_length,
        )

    def scanner(self, mount: Pose | Sequence[float] | None = None) -> LaserScanner:
        """Returns the scanner that these parameters describe.

        Args:
            mount: Pose of the scanner in the robot's frame, in any form that `LaserScanner` takes. Default: `laser_mount`,
                or the identity if that is not given.

        """
        return LaserScanner(
            **self._beam_layout(),
            beam_count=self.laser_beam_count,
            min_range=self.laser_min_range,
            max_range=self.laser_max_range,
            mount=mount or self.laser_mount or Pose(),
        )

    def _beam_layout(self) -> dict[str, float]:
        """Returns the arguments of `LaserScanner` for the angles of the beams."""
        if self.laser_angle_min is None or self.laser_angle_max is None:
            if not self.laser_clockwise:
                return {"fov": self.laser_fov}
            low, high = -0.5 * self.laser_fov, 0.5 * self.laser_fov
        else:
            low, high = self.laser_angle_min, self.laser_angle_max
        return {"angle_min": high, "angle_max": low} if self.laser_clockwise else {"angle_min": low, "angle_max": high}


class WorldParameters(Parameters):
    """Parameters of the world of a ROS process, in which all of its robots move."""

    node_name = "world_server"

    robots: Annotated[tuple[str, ...], BeforeValidator(_check_names_of("robot1", "robot2"))] = Field(
        (), description="names of several robots, each in a namespace of its name; empty for one robot without a name"
    )
    faults: Annotated[tuple[str, ...], BeforeValidator(_check_faults)] = Field(
        (), description="faults of the process, each as a text such as Drop('/scan', probability=0.1)"
    )
    obstacles_topic: Topic = Field("obstacles", description="topic of markers that add, move and remove obstacles")
    markers_topic: OptionalTopic = Field(
        "markers", description="topic of markers that show robots, obstacles and contacts in RViz; empty for none"
    )
    markers_rate: Rate = Field(5.0, description="rate of these markers [Hz]")
    map_frame_id: Name = Field("map", description="frame of the map")


class MapParameters(Parameters):
    """Parameters of `MapFileServer`, with the names of nav2_map_server."""

    node_name = "map_server"

    yaml_filename: Name = Field(description="path of the map_server YAML file of the map")
    topic_name: Topic = Field("map", description="topic of the map")
    service_name: Topic = Field("static_map", description="name of the GetMap service")
    frame_id: Name = Field("map", description="frame of the map")


ODOMETRY_STEP = 0.1
"""Duration of the step for which `odometry_alphas` state the variances [s]: the default period of the odometry."""


def motion_noise(alphas: Sequence[float]) -> MotionNoise:
    """Returns the noise model of the odometry with parameters alpha1 to alpha6, for steps of `ODOMETRY_STEP`.

    Args:
        alphas: The six parameters, each at least 0 (Thrun, Burgard and Fox, *Probabilistic Robotics*, 2006, table 5.3).
    """
    numbered = {f"alpha{number}": alpha for number, alpha in enumerate(alphas, start=1)}
    return MotionNoise(**numbered, reference_step=ODOMETRY_STEP)


NODES: tuple[type[Parameters], ...] = (RobotParameters, LaserParameters)
"""Parameter classes of the nodes that a parameter file can set."""


def check_names(names: Iterable[str], models: Iterable[type[Parameters]] = NODES) -> None:
    """Checks that every name is a parameter of one of the nodes.

    Args:
        names: Parameter names; `node:name` stands for the parameter `name` of that node only.
        models: Parameter classes of the nodes.

    Raises:
        ValueError: A name is unknown. The message suggests the nearest known name.
    """
    models = tuple(models)
    known = sorted({name for model in models for name in model.model_fields})
    for key in names:
        node, separator, name = key.rpartition(":") if isinstance(key, str) else ("", "", key)
        own = [model for model in models if model.node_name == node]
        if separator and not own:
            raise ValueError(unknown_name(node, [model.node_name for model in models], kind="node"))
        if name not in (own[0].model_fields if own else known):
            raise ValueError(unknown_name(name, own[0].model_fields if own else known))


def for_node(model: type[T], values: Mapping[str, Any]) -> T:
    """Returns the parameters of one node from values for all nodes.

    Args:
        model: Parameter class of the node.
        values: Values by key. The key `name` sets the parameter of every node that has it. The key `node:name` sets the
            parameter of that node only and takes precedence.

    Raises:
        ValueError: A value is invalid.
    """
    own = {name: values[name] for name in model.model_fields if name in values}
    for name in model.model_fields:
        if (key := f"{model.node_name}:{name}") in values:
            own[name] = values[key]
    return model.checked(own)


def unknown_name(name: str, known: Iterable[str], kind: str = "parameter") -> str:
    """Returns an error message for an unknown name, with the nearest known name if one is similar."""
    known = list(known)
    near = nearest(name, known)
    return f"unknown {kind} {quoted(name)}; " + (
        f"did you mean {near[0]!r}?" if near else f"known {kind}s: {', '.join(known)}"
    )


def _explain(error: ValidationError, known: Iterable[str]) -> str:
    """Returns all errors as one text, separated by semicolons. Each gives the parameter, the requirement and the value."""
    messages = []
    for detail in error.errors(include_url=False):
        name = "".join(f"[{part}]" if isinstance(part, int) else part for part in detail["loc"])
        if detail["type"] == "extra_forbidden":
            messages.append(unknown_name(name, known))
        elif detail["type"] == "missing":
            messages.append(f"{name} is required")
        elif name:
            messages.append(f"{name} must {_requirement(detail)}, got {quoted(detail['input'])}")
        else:
            messages.append(detail["msg"].removeprefix("Value error, "))
    return "; ".join(messages)


def _requirement(detail: ErrorDetails) -> str:
    """Returns what a value must be, from a message such as "Input should be a valid number, unable to parse string"."""
    if detail["type"] == "int_parsing_size":
        return "be a valid integer"
    message = detail["msg"].removeprefix("Value error, ")
    if detail["type"] in ("bool_parsing", "float_parsing", "int_from_float", "int_parsing"):
        message = message.partition(", ")[0]
    return re.sub(r"^\w+ should ", "", message)
