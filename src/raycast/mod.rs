//! From a ray to a range: the boundary at which it enters the first blocking cell.

mod clearance;
pub mod kernel;
mod ray;
mod traversal;

use glam::DVec2;

pub use clearance::{Clearance, Quadrant};
pub use ray::Ray;
pub use traversal::traverse;

use crate::error::{Error, check_number, check_rows};
use crate::grid::OccupancyGrid;
use crate::pose::Pose;
use crate::threads;

/// Casts rays over one grid up to one range.
#[derive(Debug, Clone, Copy)]
pub struct Caster<'grid> {
    grid: &'grid OccupancyGrid,
    clearance: &'grid Clearance,
    max_range: f64,
    limit: f64,
}

impl<'grid> Caster<'grid> {
    /// A caster over `grid` up to `max_range` metres; builds what it needs of the grid if that was not done yet.
    #[must_use]
    pub fn new(grid: &'grid OccupancyGrid, max_range: f64) -> Self {
        // One cell more than the range asks for: what counts is decided on the range in metres alone.
        let limit = max_range / grid.resolution() + 1.0;
        Self { grid, clearance: grid.clearance(), max_range, limit }
    }

    /// The range in metres, or `None` if there is no return within the maximum.
    ///
    /// `origin` in cells from the grid's corner, `direction` a unit vector in the grid's frame.
    #[must_use]
    pub fn cast(&self, origin: DVec2, direction: DVec2) -> Option<f64> {
        let ray = Ray::entering(self.clearance.width(), self.clearance.height(), origin, direction)?;
        if ray.gap > self.limit {
            return None;
        }
        let distance = kernel::portable::cast(self.clearance, &ray, self.limit - ray.gap);
        let range = (ray.gap + distance.max(0.0)) * self.grid.resolution();
        (range < self.max_range).then_some(range)
    }
}

/// Ranges in metres of unrelated rays, each `[x, y, direction]` in the map frame; `max_range` where there is no return.
///
/// # Errors
/// Rays that are not finite, a `max_range` that is not positive, a wrong number of `ranges`, no threads to be had.
pub fn cast_rays(
    grid: &OccupancyGrid,
    rays: &[[f64; 3]],
    max_range: f64,
    threads: Option<usize>,
    ranges: &mut [f32],
) -> Result<(), Error> {
    check_rows("rays", rays.iter().copied())?;
    check_number("max_range", max_range, "positive", |value| value > 0.0)?;
    check_number("max_range", max_range, "a float32", |value| value <= f32::MAX.into())?;
    if ranges.len() != rays.len() {
        return Err(Error::Length { name: "out", value: ranges.len(), needed: rays.len() });
    }
    let caster = Caster::new(grid, max_range);
    threads::for_each_chunk(threads, ranges, CHUNK, |chunk, ranges| {
        for (range, ray) in ranges.iter_mut().zip(&rays[chunk * CHUNK..]) {
            let ray = grid.pose_in_grid(Pose::from(*ray));
            let (sin, cos) = libm::sincos(ray.yaw);
            let hit = caster.cast(ray.position / grid.resolution(), DVec2::new(cos, sin));
            *range = hit.unwrap_or(max_range) as f32;
        }
    })
}

/// Rays that one thread takes at a time.
const CHUNK: usize = 512;
