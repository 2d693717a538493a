//! Obstacles: discs and polygons at poses in the map frame, which beams meet at their exact outlines.

mod body;
mod passing;
mod squares;
mod trajectory;
mod view;

use glam::DVec2;

pub(crate) use body::Body;
pub use passing::MovingObstacle;
pub(crate) use passing::Passing;
pub use trajectory::Trajectory;
pub(crate) use view::View;

use squares::{Circle, Squares};

use crate::error::Error;
use crate::memory;
use crate::pose::Pose;
use crate::shape::Shape;

/// Name of the obstacles in an error.
const OBSTACLES: &str = "the obstacles";

/// Share of a radius by which bounds are enlarged, and the same in metres: far more than rounding errors.
const MARGIN: f64 = 1e-6;

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
#[derive(Debug)]
pub struct Obstacles {
    bodies: Vec<Body>,
    /// A circle around each body: side by side, so that a search reads little memory.
    circles: Vec<Circle>,
    squares: Squares,
    /// Number of obstacles of glass and of mirrors.
    leading: usize,
}

impl Default for Obstacles {
    fn default() -> Self {
        Self { bodies: Vec::new(), circles: Vec::new(), squares: Squares::NONE, leading: 0 }
    }
}

impl Obstacles {
    /// The empty set.
    pub const NONE: &'static Self = &Self { bodies: Vec::new(), circles: Vec::new(), squares: Squares::NONE, leading: 0 };

    /// Returns the set of the given shapes, each placed at its pose in the map frame.
    ///
    /// The index of an obstacle, as in [`Contact::obstacle`](crate::Contact::obstacle), is its position in `shapes`.
    ///
    /// # Errors
    /// - [`Error::Number`]: a pose is not finite.
    /// - [`Error::Memory`]: there is not enough memory.
    pub fn new<'a>(shapes: impl IntoIterator<Item = (&'a Shape, Pose)>) -> Result<Self, Error> {
        let mut obstacles = Self::default();
        for (index, (shape, pose)) in shapes.into_iter().enumerate() {
            obstacles.place(index, shape, pose.checked()?)?;
        }
        Ok(obstacles)
    }

    /// Returns a copy.
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    pub fn try_clone(&self) -> Result<Self, Error> {
        let mut copy = Self { bodies: memory::with_room(OBSTACLES, self.len())?, ..Self::default() };
        copy.circles = memory::with_room(OBSTACLES, self.len())?;
        for body in &self.bodies {
            copy.add(body.try_clone()?)?;
        }
        Ok(copy)
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
        self.cast_past(None, origin, direction, limit)
    }

    /// Same as [`cast`](Self::cast), as if the obstacle with the index `except` were not there.
    fn cast_past(&self, except: Option<usize>, origin: DVec2, direction: DVec2, limit: f64) -> f64 {
        let mut nearest = f64::INFINITY;
        for (_, body) in self.bodies.iter().enumerate().filter(|(index, _)| Some(*index) != except) {
            if body.is_near(origin, direction, limit.min(nearest)) {
                let distance = if body.contains(origin) { 0.0 } else { body.entry(origin, direction) };
                nearest = nearest.min(distance);
            }
        }
        if nearest < limit { nearest } else { f64::INFINITY }
    }

    /// Same as [`cast`](Self::cast), from the position of `pose` along its heading, as if the obstacle with the index `except`
    /// were not there.
    pub(crate) fn cast_pose(&self, except: Option<usize>, pose: Pose, limit: f64) -> f64 {
        if self.is_empty() {
            return f64::INFINITY;
        }
        let (sin, cos) = libm::sincos(pose.yaw);
        self.cast_past(except, pose.position, DVec2::new(cos, sin), limit)
    }

    /// Places a shape at a pose in the map frame, as the obstacle with this index: one of the set, or the next one.
    ///
    /// # Errors
    /// - [`Error::Count`]: the index is larger than the number of obstacles.
    /// - [`Error::Number`]: the pose is not finite.
    /// - [`Error::Memory`]: there is not enough memory. The set is unchanged.
    pub fn place(&mut self, index: usize, shape: &Shape, pose: Pose) -> Result<(), Error> {
        let body = Body::new(shape, pose.checked()?)?;
        if index < self.len() {
            let before = std::mem::replace(&mut self.circles[index], body.circle());
            self.leading += usize::from(body.material().leads_on());
            let replaced = std::mem::replace(&mut self.bodies[index], body);
            self.leading -= usize::from(replaced.material().leads_on());
            self.squares.update(&self.circles, index, Some(before));
            return Ok(());
        }
        if index > self.len() {
            return Err(Error::Count { name: "index", value: index, needed: "at most the number of obstacles" });
        }
        self.add(body)
    }

    fn add(&mut self, body: Body) -> Result<(), Error> {
        let index = self.len();
        memory::push(OBSTACLES, &mut self.circles, body.circle())?;
        let leads_on = body.material().leads_on();
        memory::push(OBSTACLES, &mut self.bodies, body).inspect_err(|_| self.circles.truncate(index))?;
        self.leading += usize::from(leads_on);
        self.squares.update(&self.circles, index, None);
        Ok(())
    }

    /// Iterates over the indices of the obstacles with a point within `radius` \[m\] of `center` in the map frame, in any order;
    /// and over some that are a little farther away.
    pub(crate) fn near(&self, center: DVec2, radius: f64) -> impl Iterator<Item = usize> {
        let near = self.squares.near(&self.circles, center, radius);
        let all = if near.is_none() { 0..self.len() } else { 0..0 };
        all.chain(near.into_iter().flatten()).filter(move |&index| {
            let circle = self.circles[index];
            let limit = (radius + circle.reach) * (1.0 + MARGIN) + MARGIN;
            circle.center.distance_squared(center) <= limit * limit
        })
    }

    /// Returns true if an obstacle is of glass or a mirror.
    pub(crate) fn lead_on(&self) -> bool {
        self.leading > 0
    }

    pub(crate) fn bodies(&self) -> &[Body] {
        &self.bodies
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::Material;

    #[test]
    fn beams_follow_no_glass_once_it_is_gone() {
        let (wall, pose) = (Shape::disc(0.5).expect("a good shape"), Pose::default());
        let glass = wall.clone().with_material(Material::GLASS).expect("a good material");
        let mut obstacles = Obstacles::new([(&wall, pose), (&glass, pose)]).expect("good poses");
        assert!(obstacles.lead_on() && obstacles.try_clone().is_ok_and(|copy| copy.lead_on()));
        obstacles.place(0, &glass, pose).expect("an index");
        obstacles.place(1, &wall, pose).expect("an index");
        assert!(obstacles.lead_on());
        obstacles.place(0, &wall, pose).expect("an index");
        assert!(!obstacles.lead_on());
    }
}
