//! Obstacles that are no cells: shapes at poses, which rays see exactly.

mod body;
mod view;

use glam::DVec2;

pub(crate) use body::Body;
pub(crate) use view::{Spread, View};

use crate::error::Error;
use crate::pose::Pose;
use crate::shape::Shape;

/// A set of shapes, each at a pose in the map frame.
///
/// The range of a beam is the distance at which it enters the nearest of grid and obstacles; a beam that starts inside of a
/// shape has range 0, and so has one that starts on an edge and goes in; one that starts on an edge and goes away, or only
/// grazes an edge or a corner, is decided by rounding. Distances are closed forms, right to about 1e-15 of the coordinates.
#[derive(Debug, Clone, Default)]
pub struct Obstacles {
    bodies: Vec<Body>,
}

impl Obstacles {
    /// No obstacles.
    pub const NONE: &'static Self = &Self { bodies: Vec::new() };

    /// Each shape at its pose.
    ///
    /// # Errors
    /// A pose that is not finite.
    pub fn new<'a>(shapes: impl IntoIterator<Item = (&'a Shape, Pose)>) -> Result<Self, Error> {
        let place = |(shape, pose): (&Shape, Pose)| Ok(Body::new(shape, pose.checked()?));
        Ok(Self { bodies: shapes.into_iter().map(place).collect::<Result<_, Error>>()? })
    }

    /// Number of obstacles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.bodies.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// Distance \[m\] at which a ray of the map frame enters the nearest obstacle, infinite if there is none within `limit`.
    ///
    /// `direction` is a unit vector.
    #[must_use]
    pub fn cast(&self, origin: DVec2, direction: DVec2, limit: f64) -> f64 {
        let mut nearest = f64::INFINITY;
        for body in &self.bodies {
            if body.is_near(origin, direction, limit.min(nearest)) {
                let distance = if body.contains(origin) { 0.0 } else { body.entry(origin, direction) };
                nearest = nearest.min(distance);
            }
        }
        if nearest < limit { nearest } else { f64::INFINITY }
    }

    /// [`cast`](Self::cast) from a pose along its heading.
    pub(crate) fn cast_pose(&self, pose: Pose, limit: f64) -> f64 {
        if self.is_empty() {
            return f64::INFINITY;
        }
        let (sin, cos) = libm::sincos(pose.yaw);
        self.cast(pose.position, DVec2::new(cos, sin), limit)
    }

    pub(crate) fn bodies(&self) -> &[Body] {
        &self.bodies
    }
}
