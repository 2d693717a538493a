"""WheelCourse: where the wheels of a robot are at one time, computed when somebody asks."""

from __future__ import annotations

from .._core import Pose
from .velocity_profile import Velocity, VelocityProfile


class WheelCourse:
    """Pose and velocity of the wheels at one time. What the robot does later does not change them.

    Args:
        profile: Velocity of the wheels at that time.
        start: Pose at the start of the profile.
        time_ns: The time [ns].

    """

    __slots__ = ("_place", "_pose", "_profile", "_start", "_time_ns")

    def __init__(self, profile: VelocityProfile, start: Pose, time_ns: int) -> None:
        self._profile, self._start, self._time_ns = profile, start, time_ns
        self._pose: Pose | None = None
        self._place: tuple[float, float, float, float] | None = None

    @property
    def pose(self) -> Pose:
        """The pose, in the frame of that at the start, with a wrapped yaw."""
        # Not a cached_property: before Python 3.12, that takes a lock, which costs more than the pose.
        if self._pose is None:
            self._pose = self._profile.move(self._start, self._time_ns).wrapped()
        return self._pose

    @property
    def place(self) -> tuple[float, float, float, float]:
        """The same pose as numbers: x and y [m], and the components z and w of its quaternion."""
        if self._place is None:
            pose = self.pose
            self._place = (pose.x, pose.y, *pose.quaternion)
        return self._place

    @property
    def velocity(self) -> Velocity:
        """The velocity, in the robot's frame."""
        return self._profile.velocity_at(self._time_ns)
