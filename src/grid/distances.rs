//! Distances from the cells of a grid to the nearest blocking cell.

use std::sync::Arc;

use super::OccupancyGrid;
use crate::distance_field::{DistanceField, MAX_REACH};
use crate::error::{Error, check_number};

impl OccupancyGrid {
    /// Writes to `distances`, for each cell row by row, the distance \[m\] between its centre and that of the nearest blocking
    /// cell, but at most `max_distance` \[m\].
    ///
    /// The distance is Euclidean and exact up to the rounding to a float32. The field is kept until cells change or another
    /// distance is asked for; it takes 2 bytes for each cell.
    ///
    /// ```
    /// use mobile_robot_simulator::{GridOptions, OccupancyGrid, Pose, Unknown};
    ///
    /// let options =
    ///     GridOptions { resolution: 0.5, origin: Pose::default(), occupied_threshold: 60, unknown: Unknown::Free };
    /// let grid = OccupancyGrid::new(vec![100, 0, 0, 0], 4, options)?;
    /// let mut distances = [0.0; 4];
    /// grid.distances(1.2, &mut distances)?;
    /// assert_eq!(distances, [0.0, 0.5, 1.0, 1.2]);
    /// # Ok::<(), mobile_robot_simulator::Error>(())
    /// ```
    ///
    /// # Errors
    /// - [`Error::Number`]: `max_distance` is not positive, or longer than 255 cells.
    /// - [`Error::Length`]: there is not one distance for each cell.
    /// - [`Error::Memory`]: there is not enough memory.
    /// - [`Error::Interrupted`]: the call was interrupted.
    pub fn distances(&self, max_distance: f64, distances: &mut [f32]) -> Result<(), Error> {
        if distances.len() != self.cells.len() {
            return Err(Error::Length { name: "out", value: distances.len(), needed: self.cells.len() });
        }
        let field = self.distance_field(max_distance)?;
        let in_metres = |square: u16| {
            let distance = f64::from(square).sqrt() * self.resolution();
            if square == field.beyond() { max_distance as f32 } else { distance as f32 }
        };
        for (distances, squares) in distances.chunks_exact_mut(self.width).zip(field.rows()) {
            distances.iter_mut().zip(squares).for_each(|(distance, &square)| *distance = in_metres(square));
        }
        Ok(())
    }

    /// Returns the distance field up to a distance \[m\]; builds it if it is not kept.
    ///
    /// # Errors
    /// Those of [`distances`](Self::distances).
    pub(crate) fn distance_field(&self, max_distance: f64) -> Result<Arc<DistanceField>, Error> {
        let reach = max_distance / self.resolution();
        check_number("max_distance", max_distance, "positive and at most 255 cells", |value| {
            value > 0.0 && reach <= MAX_REACH
        })?;
        let blocks = |&value: &i8| self.options.blocks(value);
        self.kept_field.get_or_build(reach, || DistanceField::new(&self.cells, self.width, reach, blocks))
    }
}
