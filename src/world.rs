//! What there is to see and to run into.

use crate::grid::OccupancyGrid;
use crate::obstacles::Obstacles;

/// A grid, and the obstacles that stand on it.
///
/// Wherever a world is asked for, a grid alone will do.
#[derive(Debug, Clone, Copy)]
pub struct World<'a> {
    /// Walls.
    pub grid: &'a OccupancyGrid,
    /// Things that are no cells.
    pub obstacles: &'a Obstacles,
}

impl<'a> From<&'a OccupancyGrid> for World<'a> {
    fn from(grid: &'a OccupancyGrid) -> Self {
        Self { grid, obstacles: Obstacles::NONE }
    }
}

impl<'a> From<(&'a OccupancyGrid, &'a Obstacles)> for World<'a> {
    fn from((grid, obstacles): (&'a OccupancyGrid, &'a Obstacles)) -> Self {
        Self { grid, obstacles }
    }
}
