//! A ray as the jump loops follow it: along its sector's axes, in cells counted from the one it starts in.

use super::clearance::breadth;
use super::{Clearance, Ray, Sector};

/// One axis of a ray, mirrored so that the ray goes up it.
#[derive(Debug, Clone, Copy)]
pub struct Axis {
    /// Where the ray starts.
    pub origin: f64,
    /// The near line of the first cell, a whole number.
    pub start: f64,
    /// The unit vector's component, not negative.
    pub direction: f64,
    /// One over the direction.
    pub inverse: f64,
    /// Number of the cell off the grid.
    pub end: i32,
}

/// A ray along the major and the minor axis of its sector.
#[derive(Debug, Clone, Copy)]
pub struct Track {
    /// The axis along which the ray goes farther.
    pub major: Axis,
    /// The other one.
    pub minor: Axis,
    /// The ray's sector.
    pub sector: Sector,
}

/// A crossing nearer than this to a grid line is decided as the plain traversal decides it.
///
/// Rounding moves a crossing by less than 1e-10 cells on the largest grid, so anything farther has only one answer.
const NEAR_TIE: f64 = 1e-6;

impl Axis {
    #[inline(always)]
    fn new(origin: f64, cell: i32, direction: f64, size: usize) -> Self {
        let inverse = 1.0 / direction;
        if direction < 0.0 {
            let start = -1.0 - f64::from(cell);
            Self { origin: -origin, start, direction: -direction, inverse: -inverse, end: cell + 1 }
        } else {
            Self { origin, start: f64::from(cell), direction, inverse, end: size as i32 - cell }
        }
    }

    /// Distance from the ray's origin to the near line of a cell: to the last bit what the plain traversal computes.
    #[inline(always)]
    #[must_use]
    pub fn distance(&self, cell: i32) -> f64 {
        ((self.start + f64::from(cell)) - self.origin) * self.inverse
    }

    /// The cell at `distance`, coming from cell `from`; `is_crossed` tells from the distance to a grid line whether the ray has
    /// crossed it, as the plain traversal would.
    #[inline(always)]
    fn cell_at(&self, distance: f64, from: i32, is_crossed: impl Fn(f64) -> bool) -> i32 {
        // Not negative but for rounding, and truncation is as good as the floor but near a tie.
        let at = (self.origin - self.start) + distance * self.direction;
        let cell = at as i32;
        let beyond = at - f64::from(cell);
        if beyond > NEAR_TIE && beyond < 1.0 - NEAR_TIE {
            return cell;
        }
        let line = cell + i32::from(beyond > 0.5);
        let crossed = is_crossed(self.distance(line));
        // A ray that moves along a grid line (direction zero) stays where it is, and never goes back.
        (line - i32::from(!crossed)).max(from)
    }
}

impl Track {
    /// The track of a ray.
    #[inline(always)]
    #[must_use]
    pub fn new(clearance: &Clearance, ray: &Ray) -> Self {
        let sector = Sector::of(ray.direction);
        let x = Axis::new(ray.origin.x, ray.col, ray.direction.x, clearance.width());
        let y = Axis::new(ray.origin.y, ray.row, ray.direction.y, clearance.height());
        let (major, minor) = sector.order(x, y);
        Self { major, minor, sector }
    }

    /// The cell by which the ray leaves the free box of this length around a cell, exactly as the plain traversal leaves it.
    ///
    /// A ray leaves a box through one of its two far sides. The number of the crossed line is exact, and the distance to it is
    /// computed from the ray's origin as the traversal does; across, the cell is the one the crossing is in.
    #[inline(always)]
    #[must_use]
    pub fn step(&self, (major, minor): (i32, i32), length: i32) -> (i32, i32) {
        let (far_major, far_minor) = (major + length, minor + breadth(length));
        let (to_major, to_minor) = (self.major.distance(far_major), self.minor.distance(far_minor));
        // Of two lines at the same distance the traversal crosses the row's first.
        let steep = self.sector.is_steep();
        if to_major < to_minor || (steep && to_major == to_minor) {
            let is_crossed = |to_line| to_line < to_major || (!steep && to_line == to_major);
            (far_major, self.minor.cell_at(to_major, minor, is_crossed))
        } else {
            let is_crossed = |to_line| to_line < to_minor || (steep && to_line == to_minor);
            (self.major.cell_at(to_minor, major, is_crossed), far_minor)
        }
    }

    /// Distance from the ray's origin, outside of the grid or on it, to where it enters a cell; infinite off the grid.
    ///
    /// Of the lines the ray came by, the one it crossed last is the farther one; before the first crossing, both are behind it.
    #[inline(always)]
    #[must_use]
    pub fn distance(&self, ray: &Ray, (major, minor): (i32, i32)) -> f64 {
        let entered = farther(self.major.distance(major), farther(self.minor.distance(minor), 0.0));
        if major < self.major.end && minor < self.minor.end { ray.gap + entered } else { f64::INFINITY }
    }
}

/// The greater number; b if a is not a number, as the distance to a line is along which the ray goes.
#[inline(always)]
fn farther(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// [`Track::distance`] without the track, in a form that vectorises.
#[inline(always)]
pub fn distance(clearance: &Clearance, ray: &Ray, (major, minor): (i32, i32)) -> f64 {
    let steep = ray.direction.y.abs() > ray.direction.x.abs();
    let (cols, rows) = if steep { (minor, major) } else { (major, minor) };
    let inverse = ray.inverse();
    let along = |cell: i32, cells: i32, direction: f64, origin: f64, inverse: f64, size: usize| {
        let left = direction < 0.0;
        let entered = if left { cell - cells } else { cell + cells };
        let line = entered + i32::from(left);
        ((f64::from(line) - origin) * inverse, (entered as u32) < size as u32)
    };
    let (to_col, col_on_grid) = along(ray.col, cols, ray.direction.x, ray.origin.x, inverse.x, clearance.width());
    let (to_row, row_on_grid) = along(ray.row, rows, ray.direction.y, ray.origin.y, inverse.y, clearance.height());
    let entered = farther(to_col, farther(to_row, 0.0));
    if col_on_grid & row_on_grid { ray.gap + entered } else { f64::INFINITY }
}
