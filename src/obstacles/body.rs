//! One obstacle: a shape placed in the map frame, and its intersection with a ray.

use glam::DVec2;

use super::squares::Circle;
use crate::error::Error;
use crate::memory;
use crate::pose::Pose;
use crate::shape::{Shape, edges, encloses};
use crate::surface::Material;

/// Tolerance \[m\] for a ray that starts on an edge: an entry up to this far behind the origin counts, at distance 0.
const BEHIND_TOLERANCE: f64 = 1e-9;

/// A shape placed at a pose, in map coordinates.
#[derive(Debug)]
pub struct Body {
    /// Corners of a polygon, counter-clockwise, or the centre of a disc \[m\].
    corners: Vec<DVec2>,
    /// Radius of a disc \[m\], 0 for a polygon.
    radius: f64,
    /// Centre and radius \[m\] of a circle that encloses the shape.
    bounds: (DVec2, f64),
    material: Material,
}

impl Body {
    /// Returns a shape at a pose.
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    pub fn new(shape: &Shape, pose: Pose) -> Result<Self, Error> {
        let (corners, radius) = shape.skeleton();
        let (sin, cos) = libm::sincos(pose.yaw);
        let placed = corners.iter().map(|&corner| placed(corner, pose.position, DVec2::new(cos, sin)));
        let corners = memory::collected(super::OBSTACLES, placed)?;
        let low = corners.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = corners.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        let center = low.midpoint(high);
        let reach = corners.iter().map(|corner| corner.distance(center)).fold(0.0, f64::max) + radius;
        Ok(Self { corners, radius, bounds: (center, reach), material: shape.material() })
    }

    /// Returns a copy.
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    pub fn try_clone(&self) -> Result<Self, Error> {
        Ok(Self { corners: memory::collected(super::OBSTACLES, self.corners.iter().copied())?, ..*self })
    }

    /// What the shape is made of.
    pub fn material(&self) -> &Material {
        &self.material
    }

    /// Radius of a disc \[m\], 0 for a polygon.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Centre and radius \[m\] of a circle that encloses the shape.
    pub fn bounds(&self) -> (DVec2, f64) {
        self.bounds
    }

    /// The same circle, with whether the shape is that disc.
    pub fn circle(&self) -> Circle {
        let (center, reach) = self.bounds;
        Circle { center, reach, is_outline: self.radius > 0.0 }
    }

    /// Returns true if a point is inside. On the outline, rounding decides.
    pub fn contains(&self, point: DVec2) -> bool {
        let (center, reach) = self.bounds;
        point.distance_squared(center) <= reach * reach && contains(&self.corners, self.radius, point)
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
        if self.radius > 0.0 {
            disc_entry(self.corners[0] - origin, self.radius, direction)
        } else {
            let sides = self.corners.iter().map(|&corner| side(corner - origin, direction));
            let last = side(self.corners[self.corners.len() - 1] - origin, direction);
            nearest_entry(last, sides)
        }
    }

    /// Returns the outward normal at the place of the outline that is nearest to a point on it: a unit vector.
    pub fn normal_near(&self, point: DVec2) -> DVec2 {
        if self.radius > 0.0 {
            return (point - self.corners[0]).normalize_or(DVec2::X);
        }
        let distance = |(start, end): (DVec2, DVec2)| {
            let along = (end - start) * ((point - start).dot(end - start) / (end - start).length_squared()).clamp(0.0, 1.0);
            point.distance_squared(start + along)
        };
        let nearest = self.edges().min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
        nearest.map_or(DVec2::X, |(start, end)| -(end - start).perp().normalize_or(DVec2::X))
    }

    /// Iterates over the edges as (start, end). A disc gives one edge, which starts and ends at its centre.
    pub fn edges(&self) -> impl Iterator<Item = (DVec2, DVec2)> + Clone {
        edges(&self.corners)
    }
}

/// Returns the coordinates in the map frame of a corner of a shape at a pose, given by its position and the unit vector along
/// its x axis.
#[inline(always)]
pub fn placed(corner: DVec2, position: DVec2, heading: DVec2) -> DVec2 {
    position + heading.rotate(corner)
}

/// Returns true if a point is inside a shape with this skeleton. On the outline, rounding decides.
pub fn contains(corners: &[DVec2], radius: f64, point: DVec2) -> bool {
    if radius > 0.0 { point.distance_squared(corners[0]) < radius * radius } else { encloses(corners, point) }
}

/// Returns the distance \[m\] at which a ray enters a disc, infinity if it does not. `offset` leads from the ray's origin to the
/// centre.
#[inline(always)]
pub fn disc_entry(offset: DVec2, radius: f64, direction: DVec2) -> f64 {
    let (along, across) = (direction.dot(offset), direction.perp_dot(offset));
    let square = radius * radius - across * across;
    let distance = along - square.max(0.0).sqrt();
    if (along < 0.0) | (square < 0.0) {
        f64::INFINITY
    } else if distance > 0.0 {
        distance
    } else {
        0.0
    }
}

/// A corner of a polygon in the frame of a ray: how far it is to the left of the ray, and how far along it \[m\].
#[derive(Debug, Clone, Copy, Default)]
pub struct Side {
    left: f64,
    along: f64,
}

/// Returns the side of a corner. `offset` leads to it from the ray's origin.
#[inline(always)]
pub fn side(offset: DVec2, direction: DVec2) -> Side {
    Side { left: direction.perp_dot(offset), along: direction.dot(offset) }
}

/// Returns the distance to the nearest edge that a ray crosses from outside to inside, from the sides of all corners; `last`
/// is that of the last corner.
#[inline(always)]
fn nearest_entry(last: Side, sides: impl Iterator<Item = Side>) -> f64 {
    let (mut nearest, mut start) = (f64::INFINITY, last);
    for end in sides {
        nearest = nearest.min(edge_entry(start, end));
        start = end;
    }
    nearest
}

/// Returns the distance at which a ray crosses an edge from outside to inside, infinity if it does not.
///
/// The interior lies to the left of every edge (corners are counter-clockwise), so an edge that the ray enters through runs
/// from the ray's left to its right:
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
#[inline(always)]
pub fn edge_entry(start: Side, end: Side) -> f64 {
    let distance = (start.left * end.along - end.left * start.along) / (start.left - end.left);
    let is_entered = (start.left >= 0.0) & (end.left <= 0.0) & (start.left > end.left) & (distance > -BEHIND_TOLERANCE);
    if !is_entered {
        f64::INFINITY
    } else if distance > 0.0 {
        distance
    } else {
        0.0
    }
}
