//! The world that scans and footprints are tested against: a grid and obstacles.

use crate::grid::OccupancyGrid;
use crate::obstacles::Obstacles;

/// A grid and the obstacles on it, both borrowed.
///
/// A parameter of type `impl Into<World>` accepts `&grid` (no obstacles) or `(&grid, &obstacles)`.
#[derive(Debug, Clone, Copy)]
pub struct World<'a> {
    /// The map: its blocking cells stop beams and footprints.
    pub grid: &'a OccupancyGrid,
    /// Shapes at poses in the map frame, which stop beams and footprints too.
    pub obstacles: &'a Obstacles,
    /// Index of an obstacle that is not there, such as the one that stands for the robot itself; `None` for none.
    pub except: Option<usize>,
}

impl<'a> From<&'a OccupancyGrid> for World<'a> {
    fn from(grid: &'a OccupancyGrid) -> Self {
        Self { grid, obstacles: Obstacles::NONE, except: None }
    }
}

impl<'a> From<(&'a OccupancyGrid, &'a Obstacles)> for World<'a> {
    fn from((grid, obstacles): (&'a OccupancyGrid, &'a Obstacles)) -> Self {
        Self { grid, obstacles, except: None }
    }
}
