//! Hits: what each beam of a scan meets, and at which angle.

use glam::DVec2;

use super::LaserScanner;
use crate::batch::{check_rows, for_each_chunk};
use crate::error::Error;
use crate::grid::OccupancyGrid;
use crate::numeric::GROUP;
use crate::obstacles::Obstacles;
use crate::pose::Pose;
use crate::raycast::hit_of;
use crate::world::World;

/// What a beam meets.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Hit {
    /// [`Hit::NOTHING`] without a return, [`Hit::WALL`] for a blocking cell, and this plus 1 plus its index for an obstacle.
    pub surface: i32,
    /// Angle \[rad\] between the beam and the normal of the surface, 0 to π/2; NaN if there is no surface, or the laser is inside.
    pub incidence: f32,
}

impl Hit {
    /// Surface of a beam without a return.
    pub const NOTHING: i32 = -1;

    /// Surface of a beam that meets a blocking cell.
    pub const WALL: i32 = 0;
}

impl LaserScanner {
    /// Writes what each beam of a batch of scans meets to `hits`, without noise: the surface whose distance is the range of
    /// [`scan`](Self::scan).
    ///
    /// The normal of a blocking cell is that of the side through which the beam enters it, so a slanting wall has the normals of
    /// its steps. The method is the plain traversal, which takes some hundred nanoseconds a beam.
    ///
    /// `poses` has one row for each scan, or one for each beam of a scan that takes time.
    ///
    /// # Errors
    /// - [`Error::Tilted`]: the scanner is tilted.
    /// - [`Error::Row`]: a pose is not finite.
    /// - [`Error::Length`]: `hits` does not have `beam_count` elements for each scan.
    /// - [`Error::Count`], [`Error::Threads`]: as in [`scan_batch`](Self::scan_batch).
    pub fn hits<'a>(
        &self,
        world: impl Into<World<'a>>,
        poses: &[[f64; 3]],
        threads: Option<usize>,
        hits: &mut [Hit],
    ) -> Result<(), Error> {
        let (world, beams) = (world.into(), self.options.beam_count);
        if self.slant.is_some() {
            return Err(Error::Tilted);
        }
        check_rows("poses", poses, threads)?;
        let has_beams = poses.len() == hits.len();
        if !has_beams && hits.len() != poses.len() * beams {
            return Err(Error::Length { name: "hits", value: hits.len(), needed: poses.len() * beams });
        }
        for_each_chunk(threads, hits, beams, |scan, hits| {
            for (beam, hit) in hits.iter_mut().enumerate() {
                let pose = poses[if has_beams { scan * beams + beam } else { scan }];
                *hit = self.hit(world, Pose::from(pose) * self.base_from_fan, beam);
            }
            Ok(())
        })
    }

    /// Returns what a beam meets.
    fn hit(&self, World { grid, obstacles, except }: World<'_>, map_from_fan: Pose, beam: usize) -> Hit {
        let in_fan = DVec2::new(self.cos[beam / GROUP][beam % GROUP], self.sin[beam / GROUP][beam % GROUP]);
        let (range, of_wall) = hit_wall(grid, map_from_fan, in_fan);
        let max_range = self.options.max_range;
        let (mut nearest, mut hit) = (max_range, Hit { surface: Hit::NOTHING, incidence: f32::NAN });
        if range < max_range {
            (nearest, hit) = (range, Hit { surface: Hit::WALL, incidence: of_wall });
        }
        let (sin, cos) = libm::sincos(map_from_fan.yaw);
        let (origin, direction) = (map_from_fan.position, DVec2::new(cos, sin).rotate(in_fan));
        if let Some((index, distance, normal)) = hit_obstacle((obstacles, except), origin, direction, nearest) {
            debug_assert!(distance < nearest, "{distance} is not nearer than {nearest}");
            hit = Hit { surface: Hit::WALL + 1 + index as i32, incidence: incidence(normal) };
        }
        hit
    }
}

/// Returns the distance \[m\] at which a beam enters a blocking cell, infinite if there is none, and its incidence \[rad\].
fn hit_wall(grid: &OccupancyGrid, map_from_fan: Pose, in_fan: DVec2) -> (f64, f32) {
    let grid_from_fan = grid.pose_in_grid(map_from_fan);
    let (sin, cos) = libm::sincos(grid_from_fan.yaw);
    let (distance, normal) = hit_of(grid, grid_from_fan.position, DVec2::new(cos, sin).rotate(in_fan));
    (distance, incidence(normal))
}

/// Returns the nearest obstacle but `except` that a beam enters before `limit` \[m\]: its index, the distance \[m\], and the product
/// of the beam's direction and the normal; no product if the beam starts inside.
pub(super) fn hit_obstacle(
    (obstacles, except): (&Obstacles, Option<usize>),
    origin: DVec2,
    direction: DVec2,
    limit: f64,
) -> Option<(usize, f64, Option<f64>)> {
    let mut nearest = None;
    let mut limit = limit;
    for (index, body) in obstacles.bodies().iter().enumerate().filter(|(index, _)| Some(*index) != except) {
        let inside = body.contains(origin);
        let distance = if inside { 0.0 } else { body.entry(origin, direction) };
        if distance < limit {
            limit = distance;
            let normal = (!inside).then(|| body.normal_near(origin + direction * distance).dot(direction));
            nearest = Some((index, distance, normal));
        }
    }
    nearest
}

/// Returns the angle \[rad\] of a beam to a normal from the product of their unit vectors; NaN if there is no normal.
fn incidence(product: Option<f64>) -> f32 {
    product.map_or(f32::NAN, |product| libm::acos(product.abs().min(1.0)) as f32)
}
