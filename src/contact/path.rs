//! Paths of a footprint, and bounds on how soon a point of it can have moved by some distance.

use glam::DVec2;

use crate::motion::{Twist, integrate};
use crate::pose::{Pose, rotate};

/// A path from a start pose, given in an outer frame (here that of the grid).
#[derive(Debug, Clone, Copy)]
pub enum Path {
    /// The arc of a twist that is constant in the footprint's own frame.
    Arc(Pose, Twist),
    /// A straight line: the linear velocity is constant in the outer frame, and the footprint turns at a constant rate.
    Line(Pose, Twist),
}

/// Motion of a footprint at one pose of its path, in the outer frame.
#[derive(Debug, Clone, Copy)]
pub struct Kinematics {
    /// Velocity of the footprint's origin \[m/s\].
    linear: DVec2,
    /// Turn rate \[rad/s\].
    angular: f64,
    /// Acceleration of the footprint's origin \[m/s²\].
    acceleration: DVec2,
    /// Time to look ahead \[s\].
    horizon: f64,
    /// A speed that no point of the footprint exceeds on its path \[m/s\].
    top_speed: f64,
}

impl Path {
    /// Returns the pose after `time` seconds.
    pub fn pose_at(self, time: f64) -> Pose {
        match self {
            Self::Arc(start, twist) => integrate(start, twist, time),
            Self::Line(start, twist) => {
                Pose { position: start.position + twist.linear * time, yaw: start.yaw + twist.angular * time }
            }
        }
    }

    /// Returns the twist. Its linear part is in the footprint's frame for an arc, and in the outer frame for a line.
    pub fn twist(self) -> Twist {
        let (Self::Arc(_, twist) | Self::Line(_, twist)) = self;
        twist
    }

    /// Returns the motion at a pose of the path, for bounds that hold for the next `horizon` seconds. `top_speed` is that of
    /// the footprint.
    pub fn kinematics_at(self, pose: Pose, horizon: f64, top_speed: f64) -> Kinematics {
        match self {
            Self::Arc(_, Twist { linear, angular }) => {
                let linear = rotate(linear, pose.yaw);
                Kinematics { linear, angular, acceleration: angular * linear.perp(), horizon, top_speed }
            }
            Self::Line(_, Twist { linear, angular }) => {
                Kinematics { linear, angular, acceleration: DVec2::ZERO, horizon, top_speed }
            }
        }
    }

    /// Returns a speed \[m/s\] that no point within `reach` of the origin exceeds.
    pub fn top_speed(self, reach: f64) -> f64 {
        let Twist { linear, angular } = self.twist();
        linear.length() + angular.abs() * reach
    }
}

impl Kinematics {
    /// Returns the velocity \[m/s\] of the point at `offset` \[m\] from the footprint's origin.
    pub fn velocity(self, offset: DVec2) -> DVec2 {
        self.linear + self.angular * offset.perp()
    }

    /// Returns a time \[s\] before which the point of the footprint at `offset` cannot have moved by `distance` along a unit
    /// vector `normal` that stands still.
    ///
    /// The time is infinite if the point cannot get there within the horizon.
    pub fn earliest(self, offset: DVec2, normal: DVec2, distance: f64) -> f64 {
        // The point circles at the turn rate ω, so its acceleration changes at a rate (jerk) of at most ω² times its speed.
        let square = self.angular * self.angular;
        let jerk = square * (self.linear.length() + self.angular.abs() * offset.length());
        let acceleration = normal.dot(self.acceleration - square * offset) + jerk * self.horizon;
        let earliest = first_root(normal.dot(self.velocity(offset)), acceleration, distance);
        // Also right where the quadratic bound is weak: the point cannot be faster than the top speed.
        earliest.max(distance / self.top_speed)
    }

    /// Returns a time \[s\] before which a point of the world, now at `offset` from the footprint's origin, cannot have come
    /// nearer by `distance` to a line that moves with the footprint. `normal` is the line's unit normal, away from the
    /// footprint.
    ///
    /// The time is infinite if the point cannot get there within the horizon. The world seen from the footprint moves with
    /// the opposite velocity; a frame that turns adds the Coriolis and the centrifugal acceleration.
    pub fn earliest_of_world(self, offset: DVec2, normal: DVec2, distance: f64) -> f64 {
        let (square, speed) = (self.angular * self.angular, self.linear.length());
        // The derivative of the acceleration below, with respect to time. On an arc it is smaller.
        let jerk = square * (3.0 * speed + self.angular.abs() * (offset.length() + speed * self.horizon));
        let seen = square * offset - 2.0 * self.angular * self.linear.perp() + self.acceleration;
        first_root(normal.dot(self.velocity(offset)), normal.dot(seen) + jerk * self.horizon, distance)
    }
}

/// Returns the first positive root t of `velocity·t + acceleration·t²/2 = distance`, infinite if there is none.
///
/// By Taylor's theorem a point does not move farther than the left side, if `velocity` is its velocity now and
/// `acceleration` is the largest one until then.
fn first_root(velocity: f64, acceleration: f64, distance: f64) -> f64 {
    let discriminant = velocity * velocity + 2.0 * acceleration * distance;
    if velocity > 0.0 {
        if discriminant < 0.0 { f64::INFINITY } else { 2.0 * distance / (velocity + discriminant.sqrt()) }
    } else if acceleration > 0.0 {
        (discriminant.sqrt() - velocity) / acceleration
    } else {
        f64::INFINITY
    }
}
