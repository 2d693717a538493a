//! The jump loop in portable code: in float64, one ray after the other.

use crate::raycast::track::Track;
use crate::raycast::{Clearance, Ray};

/// Distance in cells from a ray's origin to the boundary by which it enters a blocking cell, infinite if there is none; one beyond
/// `limit` may be infinite.
///
/// A ray in a cell leaves that cell's free box through one of its two far sides.
#[inline]
pub fn cast(clearance: &Clearance, ray: &Ray, limit: f64) -> f64 {
    let track = Track::new(clearance, ray);
    let lengths = clearance.lengths();
    let stride = clearance.stride(track.sector);
    let first = clearance.index(ray.col, ray.row, track.sector);
    let mut cell = (0, 0);
    loop {
        let length = lengths[first + cell.1 as usize * stride + cell.0 as usize];
        if length == 0 || track.major.distance(cell.0) > limit {
            return track.distance(ray, cell);
        }
        cell = track.step(cell, i32::from(length));
    }
}
