"""wheel_course: the pose and velocity of a time, whatever comes after it."""

from __future__ import annotations

import mobile_robot_simulator as mrs
from mobile_robot_simulator.instant import NANOSECONDS
from mobile_robot_simulator.physics.motion import Motion


def test_it_tells_what_the_motion_told_at_that_time():
    motion = Motion(0, 0.0, mrs.Pose(), mrs.Pose(1.0, 2.0, 3.0), limits=mrs.Limits(acceleration=(1.0, 1.0, 1.0)))
    motion.command((1.0, 0.0, 0.5), 0)
    course = motion.wheel_course(NANOSECONDS)
    told = motion.wheel_pose(NANOSECONDS).wrapped(), motion.wheel_velocity(NANOSECONDS)
    motion.slip(0.5, NANOSECONDS)
    motion.command((-1.0, 0.0, 0.0), NANOSECONDS)
    motion.stop(2 * NANOSECONDS)
    assert (course.pose, course.velocity) == told
    assert tuple(motion.wheel_course(2 * NANOSECONDS).pose) == tuple(motion.wheel_pose(2 * NANOSECONDS).wrapped())
