//! Obstacles: discs and polygons at poses in the map frame, which beams meet at their exact outlines.

mod body;
mod passing;
mod trajectory;
mod view;

use glam::DVec2;

pub(crate) use body::Body;
pub use passing::MovingObstacle;
pub(crate) use passing::Passing;
pub use trajectory::Trajectory;
pub(crate) use view::View;

use crate::error::Error;
use crate::memory;
use crate::pose::Pose;
use crate::shape::Shape;

/// Name of the obstacles in an error.
const OBSTACLES: &str = "the obstacles";

/// A set of obstacles, each a [`Shape`] at a [`Pose`] in the map frame.
///
/// The range of a beam is the distance to the nearest blocking cell or obstacle. Distances to obstacles are computed in
/// closed form, with a rounding error of about 1e-15 times the coordinates. Boundary cases:
///
/// | beam | range |
/// |---|---|
/// | starts inside an obstacle | 0 |
/// | starts on an outline and points inwards | 0 |
/// | starts on an outline and points outwards | rounding decides whether it hits |
/// | only touches an edge or a corner | rounding decides whether it hits |
///
/// ```
/// use glam::DVec2;
/// use mobile_robot_simulator::{Obstacles, Pose, Shape};
///
/// let pillar = Shape::disc(1.0)?;
/// let obstacles = Obstacles::new([(&pillar, Pose::new(3.0, 0.0, 0.0))])?;
/// assert_eq!(obstacles.cast(DVec2::ZERO, DVec2::X, 10.0), 2.0);
/// assert_eq!(obstacles.cast(DVec2::ZERO, DVec2::Y, 10.0), f64::INFINITY);
/// # Ok::<(), mobile_robot_simulator::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Obstacles {
    bodies: Vec<Body>,
}

impl Obstacles {
    /// The empty set.
    pub const NONE: &'static Self = &Self { bodies: Vec::new() };

    /// Returns the set of the given shapes, each placed at its pose in the map frame.
    ///
    /// The index of an obstacle, as in [`Contact::obstacle`](crate::Contact::obstacle), is its position in `shapes`.
    ///
    /// # Errors
    /// - [`Error::Number`]: a pose is not finite.
    /// - [`Error::Memory`]: there is not enough memory.
    pub fn new<'a>(shapes: impl IntoIterator<Item = (&'a Shape, Pose)>) -> Result<Self, Error> {
        let mut bodies = Vec::new();
        for (shape, pose) in shapes {
            memory::push(OBSTACLES, &mut bodies, Body::new(shape, pose.checked()?)?)?;
        }
        Ok(Self { bodies })
    }

    /// Returns the number of obstacles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.bodies.len()
    }

    /// Returns true if there are no obstacles.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// Returns the distance \[m\] along a ray to the nearest obstacle, infinity if there is none nearer than `limit` \[m\].
    ///
    /// `origin` \[m\] and `direction` (a unit vector) are in the map frame. Cost: linear in the number of obstacles.
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

    /// Same as [`cast`](Self::cast), from the position of `pose` along its heading.
    pub(crate) fn cast_pose(&self, pose: Pose, limit: f64) -> f64 {
        if self.is_empty() {
            return f64::INFINITY;
        }
        let (sin, cos) = libm::sincos(pose.yaw);
        self.cast(pose.position, DVec2::new(cos, sin), limit)
    }

    /// Places a shape at a pose, as the obstacle with this index: one of the set, or the next one.
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    pub(crate) fn place(&mut self, index: usize, shape: &Shape, pose: Pose) -> Result<(), Error> {
        let body = Body::new(shape, pose)?;
        match self.bodies.get_mut(index) {
            Some(old) => *old = body,
            None => memory::push(OBSTACLES, &mut self.bodies, body)?,
        }
        Ok(())
    }

    /// Returns true if an obstacle is of glass or a mirror.
    pub(crate) fn lead_on(&self) -> bool {
        self.bodies.iter().any(|body| body.material().leads_on())
    }

    pub(crate) fn bodies(&self) -> &[Body] {
        &self.bodies
    }
}
