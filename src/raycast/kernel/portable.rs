//! The jump loop in portable scalar code.

use crate::raycast::clearance::Quadrant;
use crate::raycast::{Clearance, Ray};

/// A crossing nearer than this to a grid line is decided as the plain traversal decides it.
///
/// Rounding moves a crossing by less than 1e-10 cells on the largest grid, so anything farther has only one answer.
const NEAR_TIE: f64 = 1e-6;

/// Distance in cells from a ray's first cell to the boundary by which it enters a blocking one, or infinity if there is none
/// within `limit`: to the last bit that of [`traverse`](crate::raycast::traverse).
///
/// A ray in a cell leaves that cell's free square through one of its two far sides. The crossed line's number is exact, and
/// the distance to it is computed from the ray's origin as the traversal does; across, the cell is the one the crossing is in.
#[must_use]
pub fn cast(clearance: &Clearance, ray: &Ray, limit: f64) -> f64 {
    let quadrant = Quadrant::of(ray.direction.x, ray.direction.y);
    let (left, down) = (ray.direction.x < 0.0, ray.direction.y < 0.0);
    let (mut col, mut row) = (ray.col, ray.row);
    let mut distance = 0.0;
    loop {
        let side = clearance.side(col, row, quadrant);
        if side == 0 {
            return if clearance.contains(col, row) { distance } else { f64::INFINITY };
        }
        if distance > limit {
            return f64::INFINITY;
        }
        let col_line = if left { col + 1 - side } else { col + side };
        let row_line = if down { row + 1 - side } else { row + side };
        let to_col = (f64::from(col_line) - ray.origin.x) * ray.inverse.x;
        let to_row = (f64::from(row_line) - ray.origin.y) * ray.inverse.y;
        if to_col < to_row {
            distance = to_col;
            col = if left { col_line - 1 } else { col_line };
            let across = Axis { origin: ray.origin.y, direction: ray.direction.y, inverse: ray.inverse.y };
            row = across.index_at(distance, row, |to_line| to_line <= distance);
        } else {
            distance = to_row;
            row = if down { row_line - 1 } else { row_line };
            let across = Axis { origin: ray.origin.x, direction: ray.direction.x, inverse: ray.inverse.x };
            col = across.index_at(distance, col, |to_line| to_line < distance);
        }
    }
}

/// One axis of a ray.
struct Axis {
    origin: f64,
    direction: f64,
    inverse: f64,
}

impl Axis {
    /// The index along this axis at `distance`, coming from index `from`; `is_crossed` tells from the distance to a grid line
    /// whether the ray has crossed it, as the plain traversal would.
    fn index_at(&self, distance: f64, from: i32, is_crossed: impl Fn(f64) -> bool) -> i32 {
        let at = self.origin + distance * self.direction;
        let line = at.round_ties_even();
        if (at - line).abs() > NEAR_TIE {
            return at.floor() as i32;
        }
        let crossed = is_crossed((line - self.origin) * self.inverse);
        // A ray that moves along a grid line (direction zero) stays where it is, and never goes back.
        if self.direction < 0.0 {
            (line as i32 - i32::from(crossed)).min(from)
        } else {
            (line as i32 - i32::from(!crossed)).max(from)
        }
    }
}
