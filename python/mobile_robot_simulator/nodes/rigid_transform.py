"""Rigid transforms in space: a rotation and a translation."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from .._core import Pose as PlanarPose
from ..messages import Point, Pose, Quaternion, Transform, Vector3

Triple = tuple[float, float, float]


@dataclass(frozen=True)
class RigidTransform:
    """Pose of a frame in another frame.

    Attributes:
        translation: x, y, z [m].
        vector: Vector part of the unit quaternion.
        w: Scalar part of the unit quaternion.
    """

    translation: Triple = (0.0, 0.0, 0.0)
    vector: Triple = (0.0, 0.0, 0.0)
    w: float = 1.0

    @classmethod
    def from_message(cls, translation: Any, rotation: Any) -> RigidTransform:
        """Returns the transform of a message. Its quaternion is normalised.

        Args:
            translation: A Vector3 or a Point [m].
            rotation: A Quaternion.

        Raises:
            ValueError: A number is not finite, or the quaternion is zero.
        """
        moved = translation.x, translation.y, translation.z
        turned = rotation.x, rotation.y, rotation.z, rotation.w
        norm = math.hypot(*turned)
        if not all(map(math.isfinite, (*moved, norm))):
            raise ValueError(f"a transform must be finite, got translation {moved}, rotation {turned}")
        if norm == 0.0:
            raise ValueError("the quaternion of a rotation must not be zero")
        x, y, z, w = (part / norm for part in turned)
        return cls(moved, (x, y, z), w)

    @property
    def is_level(self) -> bool:
        """True if the rotation is about the z axis."""
        return self.vector[0] == self.vector[1] == 0.0

    def to_transform(self) -> Transform:
        """Returns the message Transform."""
        return Transform(Vector3(*self.translation), Quaternion(*self.vector, self.w))

    def to_pose(self) -> Pose:
        """Returns the message Pose."""
        return Pose(Point(*self.translation), Quaternion(*self.vector, self.w))

    def __mul__(self, other: RigidTransform) -> RigidTransform:
        """Returns `a_from_b * b_from_c`, which is `a_from_c`."""
        cross, dot = _cross(self.vector, other.vector), _dot(self.vector, other.vector)
        vector = _sum(_scaled(self.w, other.vector), _sum(_scaled(other.w, self.vector), cross))
        return RigidTransform(self.apply(other.translation), vector, self.w * other.w - dot)

    def inverse(self) -> RigidTransform:
        """Returns the transform in the other direction."""
        back = RigidTransform(vector=_scaled(-1.0, self.vector), w=self.w)
        return RigidTransform(_scaled(-1.0, back.rotate(self.translation)), back.vector, back.w)

    def rotate(self, direction: Triple) -> Triple:
        """Returns a direction of the source frame in the target frame."""
        turned = _scaled(2.0, _cross(self.vector, direction))
        return _sum(direction, _sum(_scaled(self.w, turned), _cross(self.vector, turned)))

    def apply(self, point: Triple) -> Triple:
        """Returns a point [m] of the source frame in the target frame."""
        return _sum(self.translation, self.rotate(point))

    def interpolate(self, other: RigidTransform, fraction: float) -> RigidTransform:
        """Returns the transform between this one (0) and another one (1).

        The translation is interpolated along a line, and the rotation with constant speed about one axis (Shoemake 1985,
        slerp), as in tf2.

        Args:
            other: The other transform.
            fraction: Share of the way, from 0 to 1.
        """
        step = RigidTransform(vector=self.inverse().vector, w=self.w) * RigidTransform(vector=other.vector, w=other.w)
        length, sign = math.hypot(*step.vector), math.copysign(1.0, step.w)
        # The core's sine is the same on every machine, so the angle is halved and taken in parts by planar poses.
        angle = PlanarPose.from_quaternion(0.0, 0.0, qx=0.0, qy=0.0, qz=length, qw=abs(step.w)).yaw
        sine, cosine = PlanarPose(0.0, 0.0, fraction * angle).quaternion
        part = RigidTransform(vector=_scaled(sign * sine / length if length > 0.0 else 0.0, step.vector), w=cosine)
        turned = RigidTransform(vector=self.vector, w=self.w) * part
        way = _sum(other.translation, _scaled(-1.0, self.translation))
        return RigidTransform(_sum(self.translation, _scaled(fraction, way)), turned.vector, turned.w)


def _sum(a: Triple, b: Triple) -> Triple:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def _scaled(factor: float, a: Triple) -> Triple:
    return factor * a[0], factor * a[1], factor * a[2]


def _dot(a: Triple, b: Triple) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: Triple, b: Triple) -> Triple:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
