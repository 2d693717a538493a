//! Directions of the walls at the cells of a grid.

use super::OccupancyGrid;
use crate::batch::thread_count;
use crate::error::Error;
use crate::interrupt::is_pool_thread;
use crate::wall_directions::{STEPS, WallDirections, angle};

impl OccupancyGrid {
    /// Writes to `directions`, for each cell row by row, the direction of the wall at that cell \[rad\]: the angle from the x
    /// axis of the grid to the wall, 0 to below π; NaN where it is unknown.
    ///
    /// Only blocking cells with a free neighbour have a direction. It is that of the straight line through such cells around it
    /// that are connected with it, in a window of 11 × 11 cells, near corners of 9 × 9 or 7 × 7, in steps of π / 252. It is
    /// unknown where they are not along a line, such as within three cells of a corner. The first call finds the directions on
    /// `threads` threads (default: all cores); they take 1 byte for each cell, and follow [`set_cells`](Self::set_cells).
    ///
    /// ```
    /// use mobile_robot_simulator::{GridOptions, OccupancyGrid, Pose, Unknown};
    ///
    /// let options =
    ///     GridOptions { resolution: 0.5, origin: Pose::default(), occupied_threshold: 60, unknown: Unknown::Free };
    /// let cells = vec![
    ///     0, 0, 0, 0, //
    ///     100, 100, 100, 100,
    /// ];
    /// let mut directions = [1.0; 8];
    /// OccupancyGrid::new(cells, 4, options)?.wall_directions(None, &mut directions)?;
    /// assert!(directions[..4].iter().all(|direction| direction.is_nan()));
    /// assert_eq!(directions[4..], [0.0; 4]);
    /// # Ok::<(), mobile_robot_simulator::Error>(())
    /// ```
    ///
    /// # Errors
    /// - [`Error::Length`]: there is not one direction for each cell.
    /// - [`Error::Count`]: `threads` is 0 or more than 1024.
    /// - [`Error::Threads`]: the system could not start the threads.
    /// - [`Error::Memory`]: there is not enough memory.
    /// - [`Error::Interrupted`]: the call was interrupted.
    pub fn wall_directions(&self, threads: Option<usize>, directions: &mut [f32]) -> Result<(), Error> {
        if directions.len() != self.cells.len() {
            return Err(Error::Length { name: "out", value: directions.len(), needed: self.cells.len() });
        }
        thread_count(threads, directions.len())?;
        for (direction, &step) in directions.iter_mut().zip(self.walls(threads)?.steps()) {
            *direction = if step < STEPS { angle(step) as f32 } else { f32::NAN };
        }
        Ok(())
    }

    /// Returns the directions of the walls; the first call finds them.
    ///
    /// # Errors
    /// Those of [`wall_directions`](Self::wall_directions).
    pub(crate) fn walls(&self, threads: Option<usize>) -> Result<&WallDirections, Error> {
        // A pool thread must not wait for other threads here; see `free_boxes_by`.
        let threads = || if is_pool_thread() { Some(1) } else { threads };
        let blocks = |&value: &i8| self.options.blocks(value);
        self.wall_directions.get_or_build(|| WallDirections::new(&self.cells, self.width, threads(), blocks))
    }
}
