//! A ray on a grid, in cells.

use glam::DVec2;

/// A ray that starts on a grid, where it starts there, and how far it came to get there. Lengths in cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where the ray starts, or where it enters the grid.
    pub origin: DVec2,
    /// Unit vector.
    pub direction: DVec2,
    /// Column of the first cell.
    pub col: i32,
    /// Row of the first cell.
    pub row: i32,
    /// Distance travelled before the grid, infinite for a ray that never gets there.
    pub gap: f64,
}

/// Components below this move a ray by less than a float64 can tell on any grid, and count as zero.
const NO_MOTION: f64 = 1e-300;

impl Ray {
    /// One over the direction, by axis; infinite for an axis that the ray does not move along.
    #[inline(always)]
    #[must_use]
    pub fn inverse(&self) -> DVec2 {
        DVec2::new(1.0 / self.direction.x, 1.0 / self.direction.y)
    }

    /// The ray from `origin` along the unit vector `direction` over a grid of `width` by `height` cells, from its first cell on;
    /// `None` if it passes the grid by.
    ///
    /// From outside, the ray is clipped to the grid's box; the start cell is the one at the side it comes in by.
    #[must_use]
    pub fn entering(width: usize, height: usize, origin: DVec2, direction: DVec2) -> Option<Self> {
        if !origin.is_finite() || !direction.is_finite() {
            // Metres that overflow when counted in cells are beyond any range, and angles that overflow lead nowhere.
            return None;
        }
        let direction = DVec2::new(flush_tiny(direction.x), flush_tiny(direction.y));
        let inverse = direction.recip();
        let size = DVec2::new(width as f64, height as f64);
        let floor = origin.floor();
        let inside = floor.x >= 0.0 && floor.y >= 0.0 && floor.x < size.x && floor.y < size.y;
        if inside {
            let (col, row) = (floor.x as i32, floor.y as i32);
            return Some(Self { origin, direction, col, row, gap: 0.0 });
        }
        let (enter_x, leave_x) = crossing(origin.x, direction.x, inverse.x, size.x)?;
        let (enter_y, leave_y) = crossing(origin.y, direction.y, inverse.y, size.y)?;
        let gap = enter_x.max(enter_y);
        if gap < 0.0 || gap >= leave_x.min(leave_y) || !gap.is_finite() {
            return None;
        }
        let entry = origin + direction * gap;
        let along = |entry: f64, size: f64| entry.floor().clamp(0.0, size - 1.0) as i32;
        let side = |direction: f64, size: f64| if direction < 0.0 { (size, size as i32 - 1) } else { (0.0, 0) };
        let ((x, col), (y, row)) = if enter_x > enter_y {
            (side(direction.x, size.x), (entry.y, along(entry.y, size.y)))
        } else {
            ((entry.x, along(entry.x, size.x)), side(direction.y, size.y))
        };
        Some(Self { origin: DVec2::new(x, y), direction, col, row, gap })
    }
}

#[inline(always)]
pub(super) fn flush_tiny(component: f64) -> f64 {
    if component.abs() < NO_MOTION { 0.0 } else { component }
}

/// Where a ray enters and leaves the slab `[0, size)` along one axis.
fn crossing(origin: f64, direction: f64, inverse: f64, size: f64) -> Option<(f64, f64)> {
    if direction == 0.0 {
        return (origin >= 0.0 && origin < size).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    let (low, high) = (-origin * inverse, (size - origin) * inverse);
    Some((low.min(high), low.max(high)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn enter(x: f64, y: f64, angle: f64) -> Option<(i32, i32, f64)> {
        let (sin, cos) = libm::sincos(angle);
        Ray::entering(4, 3, DVec2::new(x, y), DVec2::new(cos, sin)).map(|ray| (ray.col, ray.row, ray.gap))
    }

    #[test]
    fn a_start_on_the_grid_is_where_it_is() {
        assert_eq!(enter(2.5, 1.5, 1.0), Some((2, 1, 0.0)));
        assert_eq!(enter(0.0, 0.0, 4.0), Some((0, 0, 0.0)));
    }

    #[test]
    fn a_start_outside_comes_in_by_a_side() {
        use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
        assert_eq!(enter(-3.0, 2.5, 0.0), Some((0, 2, 3.0)));
        assert_eq!(enter(7.0, 2.5, PI), Some((3, 2, 3.0)));
        assert_eq!(enter(4.0, 2.5, PI), Some((3, 2, 0.0)));
        assert_eq!(enter(1.5, -2.0, FRAC_PI_2), Some((1, 0, 2.0)));
        let (col, row, gap) = enter(-1.0, -1.0, FRAC_PI_4).unwrap();
        assert!((col, row) == (0, 0) && (gap - 2f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn a_ray_that_passes_by_never_enters() {
        assert_eq!(enter(-3.0, 2.5, 3.0), None);
        assert_eq!(enter(-1.0, 3.0, 0.0), None);
        assert_eq!(enter(-1.0, 5.0, -0.1), None);
        assert_eq!(enter(1e308, -1e308, 2.0), None);
    }

    #[test]
    fn a_start_far_away_loses_nothing_but_precision() {
        assert_eq!(enter(-1e9, 1.5, 0.0), Some((0, 1, 1e9)));
    }
}
