//! Hit: the side of a cell through which a ray enters it.

use glam::DVec2;

use super::Ray;
use super::traversal::{Walk, traverse};
use crate::grid::{Cell, OccupancyGrid};

/// Returns the distance \[m\] at which a ray enters the first blocking cell, infinite if there is none, and the component of
/// its direction along the normal of the side through which it enters; `None` if it starts inside.
///
/// `origin` \[m\] and `direction`, a unit vector, are in the frame of the grid. The distance is that of the plain traversal.
#[must_use]
pub fn hit_of(grid: &OccupancyGrid, origin: DVec2, direction: DVec2) -> (f64, Option<f64>) {
    let Some(ray) = Ray::entering(grid.width(), grid.height(), grid.in_cells(origin), direction) else {
        return (f64::INFINITY, None);
    };
    let distance = traverse(grid, &ray, f64::INFINITY);
    let normal = if distance == 0.0 && ray.gap == 0.0 {
        None
    } else if is_at_column(&ray, distance) {
        Some(ray.direction.x)
    } else {
        Some(ray.direction.y)
    };
    ((ray.gap + distance.max(0.0)) * grid.resolution(), normal)
}

/// Returns the first blocking cell that a ray enters.
#[must_use]
pub fn cell_hit(grid: &OccupancyGrid, origin: DVec2, direction: DVec2) -> Option<Cell> {
    let ray = Ray::entering(grid.width(), grid.height(), grid.in_cells(origin), direction)?;
    let mut walk = Walk::new(&ray);
    loop {
        let cell = walk.cell(grid)?;
        if grid.is_blocking(cell) {
            return Some(cell);
        }
        walk.step();
    }
}

/// Returns true if a ray crosses a line between columns at a distance that the traversal found.
fn is_at_column(ray: &Ray, distance: f64) -> bool {
    let line = (ray.origin.x + ray.direction.x * distance).round();
    // The expression of the traversal, so that the numbers are equal.
    ray.direction.x != 0.0 && (line - ray.origin.x) * ray.inverse().x == distance
}
