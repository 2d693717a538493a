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

/// Velocity and acceleration of a footprint at one pose of its path, in the outer frame.
#[derive(Debug, Clone, Copy)]
pub struct Kinematics {
    /// Velocity of the footprint's origin \[m/s\].
    linear: DVec2,
    /// Turn rate \[rad/s\].
    angular: f64,
    /// Acceleration of the footprint's origin \[m/s²\].
    acceleration: DVec2,
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

    /// Returns velocity and acceleration at a pose of the path.
    pub fn kinematics_at(self, pose: Pose) -> Kinematics {
        match self {
            Self::Arc(_, Twist { linear, angular }) => {
                let linear = rotate(linear, pose.yaw);
                Kinematics { linear, angular, acceleration: angular * linear.perp() }
            }
            Self::Line(_, Twist { linear, angular }) => Kinematics { linear, angular, acceleration: DVec2::ZERO },
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

    /// Returns a lower bound on the time \[s\] in which the point at `offset` moves by `distance` along a unit vector
    /// `normal`.
    ///
    /// The bound is infinite if the point cannot get there within `horizon` seconds.
    ///
    /// Method: within the horizon the displacement is at most `v·t + a·t²/2` (Taylor's theorem), where v is the current
    /// velocity along `normal` and a is the largest acceleration along it. The point circles at constant turn rate ω, so its
    /// acceleration changes at a rate (jerk) of at most ω² times its speed. The bound is the first root of
    /// `v·t + a·t²/2 = distance`.
    pub fn earliest(self, offset: DVec2, normal: DVec2, distance: f64, horizon: f64) -> f64 {
        let square = self.angular * self.angular;
        let jerk = square * (self.linear.length() + self.angular.abs() * offset.length());
        let acceleration = normal.dot(self.acceleration - square * offset) + jerk * horizon;
        let velocity = normal.dot(self.velocity(offset));
        let discriminant = velocity * velocity + 2.0 * acceleration * distance;
        if velocity > 0.0 {
            if discriminant < 0.0 { f64::INFINITY } else { 2.0 * distance / (velocity + discriminant.sqrt()) }
        } else if acceleration > 0.0 {
            (discriminant.sqrt() - velocity) / acceleration
        } else {
            f64::INFINITY
        }
    }
}
