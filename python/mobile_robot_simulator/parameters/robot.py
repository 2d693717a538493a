"""RobotParameters: the parameters of the robot, and the objects of the core that are built from them."""

# Annotations are objects here, not texts: pydantic would have to compile each text, which takes 1.5 ms for all parameters.

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Literal

import yaml
from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from .._core import Drive, Limits, MotionNoise, Shape
from ..quoting import quoted, shortened
from ..yaml_documents import parse, value_of
from .model import FRAME_PREFIX, Parameters
from .values import Name, Number, OptionalTopic, Positive, Rate, Seed, Topic, names_of, numbers, reject_bool

FOUR_WHEELS = ("front_left_wheel_joint", "front_right_wheel_joint", "rear_left_wheel_joint", "rear_right_wheel_joint")
JOINTS: Mapping[str, tuple[str, ...]] = {
    "planar": (),
    "differential": ("left_wheel_joint", "right_wheel_joint"),
    "omni": FOUR_WHEELS,
    "ackermann": (*FOUR_WHEELS, "front_left_steering_joint", "front_right_steering_joint"),
}
"""Names of the joints of each drive: the wheels in the order of `Drive`, then the steering."""


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


PoseTriple = Annotated[tuple[Number, Number, Number], numbers("x", "y", "yaw")]
Alpha = Annotated[Number, Field(ge=0.0)]
Alphas = Annotated[
    tuple[Alpha, Alpha, Alpha, Alpha, Alpha, Alpha], numbers("alpha1", "alpha2", "alpha3", "alpha4", "alpha5", "alpha6")
]
Limit = Annotated[float, BeforeValidator(reject_bool), Field(ge=0.0)]
LimitTriple = Annotated[tuple[Limit, Limit, Limit], numbers("vx", "vy", "wz")]


class RobotParameters(Parameters):
    """Parameters of `MobileRobotSimulator`."""

    node_name = "mobile_robot_simulator_node"

    scanners: Annotated[tuple[str, ...], BeforeValidator(names_of("front", "rear"))] = Field(
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
    joint_names: Annotated[tuple[str, ...], BeforeValidator(names_of("left_wheel", "right_wheel"))] = Field(
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
    def _check_footprint(self) -> "RobotParameters":
        if self.robot_radius and self.footprint:
            given = f"got {self.robot_radius} and {quoted(self.footprint)}"
            raise ValueError(f"only one of robot_radius and footprint may be given, {given}")
        if self.ground_truth_frame in (self.base_link_frame, self.odom_frame_id, self.map_frame_id):
            raise ValueError(f"ground_truth_frame must be a frame of its own, got {quoted(self.ground_truth_frame)}")
        return self

    @model_validator(mode="after")
    def _check_drive(self) -> "RobotParameters":
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


ODOMETRY_STEP = 0.1
"""Duration of the step for which `odometry_alphas` state the variances [s]: the default period of the odometry."""


def motion_noise(alphas: Sequence[float]) -> MotionNoise:
    """Returns the noise model of the odometry with parameters alpha1 to alpha6, for steps of `ODOMETRY_STEP`.

    Args:
        alphas: The six parameters, each at least 0 (Thrun, Burgard and Fox, *Probabilistic Robotics*, 2006, table 5.3).
    """
    numbered = {f"alpha{number}": alpha for number, alpha in enumerate(alphas, start=1)}
    return MotionNoise(**numbered, reference_step=ODOMETRY_STEP)
