//! One obstacle: a shape placed in the map frame, and its intersection with a ray.

use glam::DVec2;

use crate::error::Error;
use crate::memory;
use crate::pose::Pose;
use crate::shape::{Shape, edges, encloses};

/// Tolerance \[m\] for a ray that starts on an edge: an entry up to this far behind the origin counts, at distance 0.
const BEHIND_TOLERANCE: f64 = 1e-9;

/// A shape placed at a pose, in map coordinates.
#[derive(Debug, Clone)]
pub struct Body {
    /// Corners of a polygon, counter-clockwise, or the centre of a disc \[m\].
    corners: Vec<DVec2>,
    /// Radius of a disc \[m\], 0 for a polygon.
    radius: f64,
    /// Centre and radius \[m\] of a circle that encloses the shape.
    bounds: (DVec2, f64),
}

impl Body {
    /// Returns a shape at a pose.
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    pub fn new(shape: &Shape, pose: Pose) -> Result<Self, Error> {
        let (corners, radius) = shape.skeleton();
        let (sin, cos) = libm::sincos(pose.yaw);
        let heading = DVec2::new(cos, sin);
        let placed = corners.iter().map(|&corner| pose.position + heading.rotate(corner));
        let corners = memory::collected(super::OBSTACLES, placed)?;
        let low = corners.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = corners.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        let center = low.midpoint(high);
        let reach = corners.iter().map(|corner| corner.distance(center)).fold(0.0, f64::max) + radius;
        Ok(Self { corners, radius, bounds: (center, reach) })
    }

    /// Radius of a disc \[m\], 0 for a polygon.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Centre and radius \[m\] of a circle that encloses the shape.
    pub fn bounds(&self) -> (DVec2, f64) {
        self.bounds
    }

    /// Returns true if a point is inside. On the outline, rounding decides.
    pub fn contains(&self, point: DVec2) -> bool {
        let (center, reach) = self.bounds;
        point.distance_squared(center) <= reach * reach
            && if self.radius > 0.0 {
                point.distance_squared(center) < self.radius * self.radius
            } else {
                encloses(&self.corners, point)
            }
    }

    /// Returns true if a ray may meet the bounding circle within `limit` metres. A quick test that never misses a hit.
    pub fn is_near(&self, origin: DVec2, direction: DVec2, limit: f64) -> bool {
        let (center, reach) = self.bounds;
        let offset = center - origin;
        let (along, across) = (direction.dot(offset), direction.perp_dot(offset));
        across.abs() <= reach && along >= -reach && along - reach <= limit
    }

    /// Returns the distance \[m\] at which a ray that starts outside enters the shape, infinity if it does not.
    ///
    /// `direction` must be a unit vector.
    pub fn entry(&self, origin: DVec2, direction: DVec2) -> f64 {
        if self.radius > 0.0 { self.disc_entry(origin, direction) } else { self.polygon_entry(origin, direction) }
    }

    fn disc_entry(&self, origin: DVec2, direction: DVec2) -> f64 {
        let offset = self.corners[0] - origin;
        let (along, across) = (direction.dot(offset), direction.perp_dot(offset));
        let square = self.radius * self.radius - across * across;
        if along < 0.0 || square < 0.0 { f64::INFINITY } else { (along - square.sqrt()).max(0.0) }
    }

    /// Returns the distance to the nearest edge that the ray crosses from outside to inside.
    ///
    /// Corners are expressed in the ray's own frame: `along` it and `left` of it. The interior lies to the left of every
    /// edge (corners are counter-clockwise), so an edge that the ray enters through runs from the ray's left to its right:
    ///
    /// ```text
    ///           start (left > 0)
    ///             |
    ///             |   interior
    ///  origin --->+------------->
    ///             |
    ///             v
    ///            end (left < 0)
    /// ```
    ///
    /// The side of a corner is computed once and used for both of its edges, so no ray passes between two edges.
    fn polygon_entry(&self, origin: DVec2, direction: DVec2) -> f64 {
        let left_and_along = |corner: DVec2| {
            let offset = corner - origin;
            (direction.perp_dot(offset), direction.dot(offset))
        };
        let mut nearest = f64::INFINITY;
        let mut start = left_and_along(self.corners[self.corners.len() - 1]);
        for &corner in &self.corners {
            let end = left_and_along(corner);
            if start.0 >= 0.0 && end.0 <= 0.0 && start.0 > end.0 {
                let distance = (start.0 * end.1 - end.0 * start.1) / (start.0 - end.0);
                if distance > -BEHIND_TOLERANCE {
                    nearest = nearest.min(distance.max(0.0));
                }
            }
            start = end;
        }
        nearest
    }

    /// Iterates over the edges as (start, end). A disc gives one edge, which starts and ends at its centre.
    pub fn edges(&self) -> impl Iterator<Item = (DVec2, DVec2)> + Clone {
        edges(&self.corners)
    }
}
