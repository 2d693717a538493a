//! The jump loop for one ray at a time, in float64. It serves grids whose free boxes have too many bytes for int32 indices.

use crate::free_boxes::{FreeBoxes, length};
use crate::raycast::Ray;
use crate::raycast::track::Track;

/// Returns the distance in cells from the start of a ray to the boundary at which it enters the first blocking cell;
/// infinite if there is none. Beyond `limit` the distance may be infinite.
#[inline]
pub fn cast(free_boxes: &FreeBoxes, ray: &Ray, limit: f64) -> f64 {
    let track = Track::new(free_boxes, ray);
    let codes = free_boxes.codes();
    let stride = free_boxes.stride(track.sector);
    let first = free_boxes.index(ray.col, ray.row, track.sector);
    let mut cell = (0, 0);
    loop {
        let length = length(codes[first + cell.1 as usize * stride + cell.0 as usize]);
        if length == 0 || track.major.distance(cell.0) > limit {
            return track.distance(ray, cell);
        }
        cell = track.step(cell, length);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raycast::traversal::traverse;
    use crate::{GridOptions, OCCUPIED_THRESHOLD, OccupancyGrid, Pose, Unknown, random};
    use glam::DVec2;
    use rand::{Rng, RngExt};

    #[test]
    fn distances_equal_those_of_the_traversal() {
        let mut stream = random::stream(9, 0);
        for (width, height, one_in) in [(1, 1, 2), (1, 90, 40), (90, 1, 40), (60, 50, 3), (150, 120, 200)] {
            let cells =
                (0..width * height).map(|_| if stream.next_u64().is_multiple_of(one_in) { 100 } else { 0 }).collect();
            let (origin, occupied_threshold) = (Pose::default(), OCCUPIED_THRESHOLD);
            let options = GridOptions { resolution: 1.0, origin, occupied_threshold, unknown: Unknown::Free };
            let grid = OccupancyGrid::new(cells, width, options).expect("a grid");
            for _ in 0..5000 {
                let mut along = |size: usize| (stream.random::<f64>() * 1.4 - 0.2) * size as f64;
                let start = DVec2::new(along(width), along(height));
                let start = if stream.next_u64().is_multiple_of(4) { start.round() } else { start };
                let (sin, cos) = libm::sincos((stream.next_u64() % 64) as f64 * 0.1);
                if let Some(ray) = Ray::entering(width, height, start, DVec2::new(cos, sin)) {
                    let expected = ray.gap + traverse(&grid, &ray, f64::INFINITY).max(0.0);
                    assert_eq!(cast(grid.free_boxes(), &ray, f64::INFINITY).to_bits(), expected.to_bits(), "{ray:?}");
                }
            }
        }
    }
}
