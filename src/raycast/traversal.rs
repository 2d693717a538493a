//! The plain traversal, cell by cell: the specification of the faster kernels.

use super::Ray;
use crate::grid::{Cell, OccupancyGrid};

/// Returns the distance in cells from the origin of a ray to the boundary at which it enters the first blocking cell;
/// infinite if there is none within `limit`.
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
#[must_use]
pub fn traverse(grid: &OccupancyGrid, ray: &Ray, limit: f64) -> f64 {
    let inverse = ray.inverse();
    let (right, up) = (ray.direction.x >= 0.0, ray.direction.y >= 0.0);
    let to_col_line = |col: i64| ((col + i64::from(right)) as f64 - ray.origin.x) * inverse.x;
    let to_row_line = |row: i64| ((row + i64::from(up)) as f64 - ray.origin.y) * inverse.y;
    let (mut col, mut row) = (i64::from(ray.col), i64::from(ray.row));
    let (mut to_col, mut to_row) = (to_col_line(col), to_row_line(row));
    let mut distance = 0.0;
    loop {
        let on_grid = (0..grid.width() as i64).contains(&col) && (0..grid.height() as i64).contains(&row);
        if !on_grid || distance > limit {
            return f64::INFINITY;
        }
        if grid.is_blocking(Cell { col: col as usize, row: row as usize }) {
            return distance;
        }
        if to_col < to_row {
            distance = to_col;
            col += if right { 1 } else { -1 };
            to_col = to_col_line(col);
        } else {
            distance = to_row;
            row += if up { 1 } else { -1 };
            to_row = to_row_line(row);
        }
    }
}
