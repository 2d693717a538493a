//! Random poses in the free area of a grid.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::DVec2;
use rand::RngExt;

use super::{Cell, OccupancyGrid, check_radius};
use crate::batch::for_each_chunk;
use crate::error::Error;
use crate::free_area::{Distances, FreeArea, largest_radius};
use crate::pose::Pose;
use crate::random;

/// Combined with the seed, so that places and scans with the same seed use different streams: "placing" in ASCII.
const PLACES: u64 = 0x0070_6c61_6369_6e67;

impl OccupancyGrid {
    /// Returns a random pose at which a disc of this radius \[m\] overlaps no blocking cell.
    ///
    /// It is the pose with index 0 of [`draw_free_poses`](Self::draw_free_poses).
    ///
    /// # Errors
    /// Those of [`draw_free_poses`](Self::draw_free_poses).
    pub fn draw_free_pose(&self, radius: f64, seed: u64) -> Result<Pose, Error> {
        let mut poses = [[0.0; 3]];
        self.draw_free_poses(radius, seed, 0, None, &mut poses)?;
        Ok(Pose::from(poses[0]))
    }

    /// Writes random poses `[x, y, yaw]` \[m, rad\] at which a disc of this radius \[m\] overlaps no blocking cell.
    ///
    /// The position is uniform over all points of known free cells at which [`is_free_disc`](Self::is_free_disc) is true. The
    /// yaw is uniform over [-π, π). `poses[i]` depends only on the grid, the radius and `(seed, first_index + i)`, and is
    /// the same on every machine. So a batch may be split: its second part starts at `first_index` plus the length of the
    /// first.
    ///
    /// The first call after a change of cells takes a time that is linear in the number of cells; so does a call with
    /// another radius. What it finds is kept: 8 bytes for each cell, and a list of free places.
    ///
    /// ```
    /// use glam::DVec2;
    /// use mobile_robot_simulator::{GridOptions, OccupancyGrid, Pose, Unknown};
    ///
    /// // A row of three cells of 1 m. The last one blocks, so a disc of radius 0.5 m may be anywhere from x = 0 m to x = 1.5 m.
    /// let options =
    ///     GridOptions { resolution: 1.0, origin: Pose::default(), occupied_threshold: 60, unknown: Unknown::Free };
    /// let grid = OccupancyGrid::new(vec![0, 0, 100], 3, options)?;
    /// let mut poses = [[0.0; 3]; 1000];
    /// grid.draw_free_poses(0.5, 1, 0, None, &mut poses)?;
    /// assert!(poses.iter().all(|&[x, ..]| x <= 1.5));
    /// assert!(poses.iter().any(|&[x, ..]| x > 1.49));
    /// # Ok::<(), mobile_robot_simulator::Error>(())
    /// ```
    ///
    /// # Errors
    /// - [`Error::NoFreePlace`]: these points have no area, or are nowhere wider than about 1/2000 of a cell.
    /// - [`Error::Number`]: a radius that is not finite or negative.
    /// - [`Error::Memory`]: there is not enough memory.
    /// - [`Error::Count`]: `threads` is 0 or more than 1024.
    /// - [`Error::Threads`]: the system could not start the threads.
    pub fn draw_free_poses(
        &self,
        radius: f64,
        seed: u64,
        first_index: u64,
        threads: Option<usize>,
        poses: &mut [[f64; 3]],
    ) -> Result<(), Error> {
        /// Number of poses that one thread draws at a time.
        const CHUNK: usize = 1024;
        /// Number of poses that are started together, so that the processor waits for the memory of all of them at once.
        const AT_A_TIME: usize = 16;
        check_radius(radius)?;
        let is_known_free = |index: usize| self.cells[index] >= 0 && !self.options.blocks(self.cells[index]);
        let distances = self.distances_of_cells()?;
        let in_cells = radius / self.resolution();
        let build = || FreeArea::new(&distances, in_cells, self.rounding_of_cells(), is_known_free);
        let no_place = || {
            // Whole micrometres, rounded down, are easy to read.
            let round = |cells: f64| (cells * self.resolution() * 1e6).floor() / 1e6;
            largest_radius(&distances, is_known_free)
                .map_or_else(|error| error, |largest| Error::NoFreePlace { radius, largest: largest.map(round) })
        };
        let area = self.free_areas.area(in_cells, build)?.ok_or_else(no_place)?;
        let Pose { position: origin, .. } = self.options.origin;
        let map_from_grid = DVec2::new(self.grid_from_map.x, -self.grid_from_map.y) * self.resolution();
        let to_map = |at: DVec2| origin + map_from_grid.rotate(at);
        let is_free = |at: DVec2| {
            let position = to_map(at);
            let cell = self.cell_at(position);
            cell.is_some_and(|Cell { col, row }| is_known_free(row * self.width + col)) && self.is_free(position, radius)
        };
        for_each_chunk(threads, poses, CHUNK, |chunk, poses| {
            let mut index = first_index.wrapping_add((chunk * CHUNK) as u64);
            for poses in poses.chunks_mut(AT_A_TIME) {
                let started = std::array::from_fn::<_, AT_A_TIME, _>(|_| {
                    let mut stream = random::stream(seed ^ PLACES, index);
                    index = index.wrapping_add(1);
                    (area.pick(&mut stream), stream)
                });
                for (pose, (pick, mut stream)) in poses.iter_mut().zip(started) {
                    let Some(at) = area.draw(&distances, pick, &mut stream, is_free) else {
                        return Err(no_place());
                    };
                    let (position, yaw) = (to_map(at), (stream.random::<f64>() - 0.5) * TAU);
                    *pose = [position.x, position.y, yaw];
                }
            }
            Ok(())
        })
    }

    /// Returns the distances of all cells to the nearest blocking one; builds them if they are not kept.
    ///
    /// # Errors
    /// [`Error::Memory`], [`Error::Interrupted`].
    pub(crate) fn distances_of_cells(&self) -> Result<Arc<Distances>, Error> {
        let build = || Distances::new(&self.cells, self.width, |&value| self.options.blocks(value));
        self.free_areas.distances(build)
    }

    /// Returns a bound \[cells\] on the rounding error of a point that is converted to the map frame and back.
    fn rounding_of_cells(&self) -> f64 {
        let origin = self.options.origin.position.abs().max_element() / self.resolution();
        1e-9 + 8.0 * f64::EPSILON * (origin + (self.width + self.height) as f64)
    }
}
