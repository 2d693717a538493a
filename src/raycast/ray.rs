//! A ray on a grid, in cells.

use glam::DVec2;

/// The part of a ray that is on a grid. Coordinates and lengths are in cells, from the corner of the grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Start of the ray, or the point where it enters the grid.
    pub origin: DVec2,
    /// Unit vector.
    pub direction: DVec2,
    /// Column of the first cell.
    pub col: i32,
    /// Row of the first cell.
    pub row: i32,
    /// Distance from the start of the ray to `origin`; infinite if the ray misses the grid.
    pub gap: f64,
}

/// Smaller components of a direction count as 0: on any grid they move a ray by less than a float64 can resolve.
const MIN_COMPONENT: f64 = 1e-300;

impl Ray {
    /// Returns one over each component of the direction; infinite for an axis along which the ray does not move.
    #[inline(always)]
    #[must_use]
    pub fn inverse(&self) -> DVec2 {
        DVec2::new(1.0 / self.direction.x, 1.0 / self.direction.y)
    }

    /// Returns the part of a ray that is on a grid of `width` by `height` cells; `None` if the ray misses the grid.
    ///
    /// `origin` is the start of the ray and `direction` a unit vector. A ray from outside is clipped to the rectangle of the
    /// grid; its first cell is the one at the side through which it enters.
    #[must_use]
    pub fn entering(width: usize, height: usize, origin: DVec2, direction: DVec2) -> Option<Self> {
        if !origin.is_finite() || !direction.is_finite() {
            // The pose overflowed when it was converted to cells and to a direction. It is farther away than any range.
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

/// Returns 0 for a component of a direction that is too small to move the ray.
#[inline(always)]
pub(super) fn flush_tiny(component: f64) -> f64 {
    if component.abs() < MIN_COMPONENT { 0.0 } else { component }
}

/// Returns the distances at which a ray enters and leaves the slab `[0, size)` of one axis; `None` if it misses the slab.
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
    fn a_start_on_the_grid_is_unchanged() {
        assert_eq!(enter(2.5, 1.5, 1.0), Some((2, 1, 0.0)));
        assert_eq!(enter(0.0, 0.0, 4.0), Some((0, 0, 0.0)));
    }

    #[test]
    fn a_ray_from_outside_enters_through_a_side() {
        use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
        assert_eq!(enter(-3.0, 2.5, 0.0), Some((0, 2, 3.0)));
        assert_eq!(enter(7.0, 2.5, PI), Some((3, 2, 3.0)));
        assert_eq!(enter(4.0, 2.5, PI), Some((3, 2, 0.0)));
        assert_eq!(enter(1.5, -2.0, FRAC_PI_2), Some((1, 0, 2.0)));
        let (col, row, gap) = enter(-1.0, -1.0, FRAC_PI_4).unwrap();
        assert!((col, row) == (0, 0) && (gap - 2f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn a_ray_that_misses_the_grid_is_none() {
        assert_eq!(enter(-3.0, 2.5, 3.0), None);
        assert_eq!(enter(-1.0, 3.0, 0.0), None);
        assert_eq!(enter(-1.0, 5.0, -0.1), None);
        assert_eq!(enter(1e308, -1e308, 2.0), None);
    }

    #[test]
    fn a_start_far_away_only_loses_precision() {
        assert_eq!(enter(-1e9, 1.5, 0.0), Some((0, 1, 1e9)));
    }
}
