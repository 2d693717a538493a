//! How a footprint moves, and how soon a point of it can get somewhere.

use glam::DVec2;

use crate::motion::{Twist, integrate};
use crate::pose::{Pose, rotate};

/// Where a footprint goes from where it is.
#[derive(Debug, Clone, Copy)]
pub enum Path {
    /// Along the arc of a twist that is constant in the footprint's own frame.
    Arc(Pose, Twist),
    /// Along a straight line at a velocity that is constant in the outer frame, while it turns.
    Line(Pose, Twist),
}

/// How the points of a footprint move at one moment, in the outer frame.
#[derive(Debug, Clone, Copy)]
pub struct Moment {
    linear: DVec2,
    angular: f64,
    acceleration: DVec2,
}

impl Path {
    /// Pose after `time` seconds.
    pub fn pose_at(self, time: f64) -> Pose {
        match self {
            Self::Arc(start, twist) => integrate(start, twist, time),
            Self::Line(start, twist) => {
                Pose { position: start.position + twist.linear * time, yaw: start.yaw + twist.angular * time }
            }
        }
    }

    /// The twist, its linear part in the footprint's frame (arc) or the outer one (line).
    pub fn twist(self) -> Twist {
        let (Self::Arc(_, twist) | Self::Line(_, twist)) = self;
        twist
    }

    /// How the footprint moves at a pose of the path.
    pub fn moment(self, pose: Pose) -> Moment {
        match self {
            Self::Arc(_, Twist { linear, angular }) => {
                let linear = rotate(linear, pose.yaw);
                Moment { linear, angular, acceleration: angular * linear.perp() }
            }
            Self::Line(_, Twist { linear, angular }) => Moment { linear, angular, acceleration: DVec2::ZERO },
        }
    }

    /// No point within `reach` of the origin moves faster than this.
    pub fn top_speed(self, reach: f64) -> f64 {
        let Twist { linear, angular } = self.twist();
        linear.length() + angular.abs() * reach
    }
}

impl Moment {
    /// Velocity of the point at `offset` from the origin.
    pub fn velocity(self, offset: DVec2) -> DVec2 {
        self.linear + self.angular * offset.perp()
    }

    /// A time \[s\] before which the point at `offset` has not moved by `distance` along the unit vector `normal`; infinite if it
    /// will not within `horizon` seconds.
    ///
    /// By Taylor's theorem to second order, with the acceleration's largest value over the horizon: every point goes round at
    /// constant speed, so that its acceleration changes by no more than ω² times that speed a second.
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
