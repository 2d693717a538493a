//! The plain traversal, cell by cell: the specification of the faster kernels.

use glam::DVec2;

use super::Ray;
use crate::grid::{Cell, OccupancyGrid};

/// Side of a cell: a line between two columns, or between two rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Its normal is along the columns, the x axis of the grid.
    Column,
    /// Its normal is along the rows.
    Row,
}

/// The cells along a ray, one after the other.
///
/// The method is that of Amanatides & Woo 1987, sec. 2, with one difference: the distance of a crossing is computed from the
/// origin of the ray, not summed up. A ray through a corner crosses the boundary between two rows first, so the path is
/// 4-connected:
///
/// ```text
///     +-----+-----+
///     |  2  |  3  |     A ray from cell 1 through the corner visits the cells 1, 2 and 3.
///     +-----+-----+
///     |  1  |     |
///     +-----+-----+
/// ```
pub struct Walk {
    origin: DVec2,
    inverse: DVec2,
    is_rightward: bool,
    is_upward: bool,
    col: i64,
    row: i64,
    to_col: f64,
    to_row: f64,
    /// Distance in cells from the origin of the ray to the boundary of the current cell.
    pub distance: f64,
}

impl Walk {
    /// Returns the walk at the first cell of a ray.
    #[inline(always)]
    #[must_use]
    pub fn new(ray: &Ray) -> Self {
        let mut walk = Self {
            origin: ray.origin,
            inverse: ray.inverse(),
            is_rightward: ray.direction.x >= 0.0,
            is_upward: ray.direction.y >= 0.0,
            col: i64::from(ray.col),
            row: i64::from(ray.row),
            to_col: 0.0,
            to_row: 0.0,
            distance: 0.0,
        };
        walk.to_col = walk.to_col_line();
        walk.to_row = walk.to_row_line();
        walk
    }

    #[inline(always)]
    fn to_col_line(&self) -> f64 {
        ((self.col + i64::from(self.is_rightward)) as f64 - self.origin.x) * self.inverse.x
    }

    #[inline(always)]
    fn to_row_line(&self) -> f64 {
        ((self.row + i64::from(self.is_upward)) as f64 - self.origin.y) * self.inverse.y
    }

    /// Returns the current cell; `None` off the grid.
    #[inline(always)]
    #[must_use]
    pub fn cell(&self, grid: &OccupancyGrid) -> Option<Cell> {
        let on_grid = (0..grid.width() as i64).contains(&self.col) && (0..grid.height() as i64).contains(&self.row);
        on_grid.then_some(Cell { col: self.col as usize, row: self.row as usize })
    }

    /// Goes to a cell farther on the way of the ray and returns the side through which the ray enters it.
    ///
    /// The ray enters a cell through the farther of the near sides that it crosses; if both are at the same distance, it crosses the
    /// boundary between two rows first.
    pub fn jump(&mut self, ray: &Ray, col: i64, row: i64) -> Side {
        (self.col, self.row) = (col, row);
        let col_entered = ((col + i64::from(!self.is_rightward)) as f64 - self.origin.x) * self.inverse.x;
        let row_entered = ((row + i64::from(!self.is_upward)) as f64 - self.origin.y) * self.inverse.y;
        (self.to_col, self.to_row) = (self.to_col_line(), self.to_row_line());
        // The near sides of the column and the row of the first cell are not crossed.
        let (crosses_col, crosses_row) = (col != i64::from(ray.col), row != i64::from(ray.row));
        if crosses_col && (!crosses_row || col_entered >= row_entered) {
            self.distance = col_entered;
            Side::Column
        } else {
            self.distance = row_entered;
            Side::Row
        }
    }

    /// Goes to the next cell and returns the side through which the ray enters it.
    #[inline(always)]
    pub fn step(&mut self) -> Side {
        if self.to_col < self.to_row {
            self.distance = self.to_col;
            self.col += if self.is_rightward { 1 } else { -1 };
            self.to_col = self.to_col_line();
            Side::Column
        } else {
            self.distance = self.to_row;
            self.row += if self.is_upward { 1 } else { -1 };
            self.to_row = self.to_row_line();
            Side::Row
        }
    }
}

/// Returns the distance in cells from the origin of a ray to the boundary at which it enters the first blocking cell;
/// infinite if there is none within `limit`.
#[must_use]
pub fn traverse(grid: &OccupancyGrid, ray: &Ray, limit: f64) -> f64 {
    let mut walk = Walk::new(ray);
    loop {
        let Some(cell) = walk.cell(grid) else { return f64::INFINITY };
        if walk.distance > limit {
            return f64::INFINITY;
        }
        if grid.is_blocking(cell) {
            return walk.distance;
        }
        walk.step();
    }
}
