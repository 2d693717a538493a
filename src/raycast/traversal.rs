//! The plain cell-by-cell traversal: the specification of all that is faster.

use super::Ray;
use crate::grid::{Cell, OccupancyGrid};

/// Distance in cells from a ray's first cell to the boundary by which it enters a blocking one, or infinity if there is none
/// within `limit`.
///
/// Amanatides & Woo 1987, sec. 2, but for one thing: a crossing's distance is computed from the ray's origin, not summed up.
/// A ray through a corner crosses the row's boundary first, so the path is 4-connected.
#[must_use]
pub fn traverse(grid: &OccupancyGrid, ray: &Ray, limit: f64) -> f64 {
    let inverse = ray.inverse();
    let (mut col, mut row) = (i64::from(ray.col), i64::from(ray.row));
    let mut distance = 0.0;
    loop {
        let on_grid = (0..grid.width() as i64).contains(&col) && (0..grid.height() as i64).contains(&row);
        if !on_grid || distance > limit {
            return f64::INFINITY;
        }
        if grid.is_blocking(Cell { col: col as usize, row: row as usize }) {
            return distance;
        }
        let (left, down) = (ray.direction.x < 0.0, ray.direction.y < 0.0);
        let to_col = ((col + i64::from(!left)) as f64 - ray.origin.x) * inverse.x;
        let to_row = ((row + i64::from(!down)) as f64 - ray.origin.y) * inverse.y;
        if to_col < to_row {
            distance = to_col;
            col += if left { -1 } else { 1 };
        } else {
            distance = to_row;
            row += if down { -1 } else { 1 };
        }
    }
}
