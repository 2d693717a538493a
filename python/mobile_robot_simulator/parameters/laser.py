"""LaserParameters: the parameters of a laser scanner, and the objects of the core that are built from them."""

# Annotations are objects here, not texts: pydantic would have to compile each text, which takes 1.5 ms for all parameters.

import math
from collections.abc import Sequence
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from .._core import FULL_TURN_TOLERANCE, BeamModel, LaserScanner, Pose, SurfaceModel, laser_presets
from ..quoting import shortened
from .model import FRAME_PREFIX, Parameters
from .values import Count, Name, Number, OptionalTopic, Rate, Seed, Topic, Weight

LARGEST_ANGLE = 2.0 * math.pi + FULL_TURN_TOLERANCE


def _check_mount(value: object) -> object:
    items = value.tolist() if isinstance(value, np.ndarray) else value
    if not isinstance(items, Sequence) or isinstance(items, str) or len(items) not in (3, 6):
        raise ValueError("Input should be 3 numbers [x, y, yaw] or 6 numbers [x, y, z, roll, pitch, yaw]")
    return items


def _check_preset(name: str) -> str:
    """Rejects what is neither empty nor the name of a preset."""
    if name and name not in laser_presets():
        raise ValueError(f"Input should be empty or one of {', '.join(laser_presets())}")
    return name


Angle = Annotated[Number, Field(ge=-LARGEST_ANGLE, le=LARGEST_ANGLE)]
MountNumbers = Annotated[tuple[Number, ...], BeforeValidator(_check_mount)]


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
    def _check_laser(self) -> "LaserParameters":
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
