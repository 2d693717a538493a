//! A shape where it stands, and where a ray meets it.

use glam::DVec2;

use crate::pose::Pose;
use crate::shape::{Shape, edges, encloses};

/// A ray that starts this near to an edge \[m\], just behind it and going in, has met it.
const NEAR: f64 = 1e-9;

/// A shape at a pose, in the map frame.
#[derive(Debug, Clone)]
pub struct Body {
    /// Corners counter-clockwise, or a disc's centre.
    corners: Vec<DVec2>,
    /// Of a disc, else 0.
    radius: f64,
    /// Centre and radius of a circle around it all.
    bounds: (DVec2, f64),
}

impl Body {
    pub fn new(shape: &Shape, pose: Pose) -> Self {
        let (corners, radius) = shape.skeleton();
        let (sin, cos) = libm::sincos(pose.yaw);
        let heading = DVec2::new(cos, sin);
        let corners: Vec<DVec2> = corners.iter().map(|&corner| pose.position + heading.rotate(corner)).collect();
        let low = corners.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = corners.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        let center = low.midpoint(high);
        let reach = corners.iter().map(|corner| corner.distance(center)).fold(0.0, f64::max) + radius;
        Self { corners, radius, bounds: (center, reach) }
    }

    /// Radius of a disc, 0 of a polygon.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Centre and radius of a circle around it all.
    pub fn bounds(&self) -> (DVec2, f64) {
        self.bounds
    }

    /// Whether a point is inside; on the edge, rounding decides.
    pub fn contains(&self, point: DVec2) -> bool {
        let (center, reach) = self.bounds;
        point.distance_squared(center) <= reach * reach
            && if self.radius > 0.0 {
                point.distance_squared(center) < self.radius * self.radius
            } else {
                encloses(&self.corners, point)
            }
    }

    /// Whether a ray comes as near as the circle around it all before it has gone `limit`.
    pub fn is_near(&self, origin: DVec2, direction: DVec2, limit: f64) -> bool {
        let (center, reach) = self.bounds;
        let offset = center - origin;
        let (along, across) = (direction.dot(offset), direction.perp_dot(offset));
        across.abs() <= reach && along >= -reach && along - reach <= limit
    }

    /// Distance at which a ray from outside enters, infinite if it does not. `direction` is a unit vector.
    pub fn entry(&self, origin: DVec2, direction: DVec2) -> f64 {
        if self.radius > 0.0 { self.disc_entry(origin, direction) } else { self.polygon_entry(origin, direction) }
    }

    fn disc_entry(&self, origin: DVec2, direction: DVec2) -> f64 {
        let offset = self.corners[0] - origin;
        let (along, across) = (direction.dot(offset), direction.perp_dot(offset));
        let square = self.radius * self.radius - across * across;
        if along < 0.0 || square < 0.0 { f64::INFINITY } else { (along - square.sqrt()).max(0.0) }
    }

    /// The nearest edge that leads in.
    ///
    /// A corner's side of the ray is computed once for both of its edges, so that no ray slips through between them.
    fn polygon_entry(&self, origin: DVec2, direction: DVec2) -> f64 {
        let split = |corner: DVec2| {
            let offset = corner - origin;
            (direction.perp_dot(offset), direction.dot(offset))
        };
        let mut nearest = f64::INFINITY;
        let mut start = split(self.corners[self.corners.len() - 1]);
        for &corner in &self.corners {
            let end = split(corner);
            // The interior is to the left of an edge: rays that go in see it run from their left to their right.
            if start.0 >= 0.0 && end.0 <= 0.0 && start.0 > end.0 {
                let distance = (start.0 * end.1 - end.0 * start.1) / (start.0 - end.0);
                if distance > -NEAR {
                    nearest = nearest.min(distance.max(0.0));
                }
            }
            start = end;
        }
        nearest
    }

    /// Start and end of each edge; of a disc, its centre twice.
    pub fn edges(&self) -> impl Iterator<Item = (DVec2, DVec2)> + Clone {
        edges(&self.corners)
    }
}
