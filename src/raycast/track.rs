//! A ray in the form that the jump loops need: along the axes of its sector, with cells numbered from its first cell, 0.

use super::Ray;
use crate::free_boxes::{FreeBoxes, Mirror, Sector, breadth};

/// One axis of a ray, mirrored so that the ray moves up it.
#[derive(Debug, Clone, Copy)]
pub struct Axis {
    /// Coordinate of the ray's origin.
    pub origin: f64,
    /// Coordinate of the near line of the first cell, a whole number.
    pub start: f64,
    /// Component of the unit vector; not negative.
    pub direction: f64,
    /// One over the direction.
    pub inverse: f64,
    /// Number of the first cell that is off the grid.
    pub end: i32,
}

/// A ray along the major and the minor axis of its sector.
#[derive(Debug, Clone, Copy)]
pub struct Track {
    /// Axis along which the ray moves farther.
    pub major: Axis,
    /// The other axis.
    pub minor: Axis,
    /// Sector of the ray.
    pub sector: Sector,
}

/// If a crossing is nearer than this to a grid line \[cells\], the cell is chosen by the comparison of the plain traversal.
///
/// Rounding moves a crossing by less than 1e-10 cells on the largest grid, so a crossing farther away is unambiguous.
const NEAR_TIE: f64 = 1e-6;

impl Axis {
    #[inline(always)]
    fn new(mirror: Mirror, origin: f64, cell: i32, direction: f64, size: usize) -> Self {
        Self {
            origin: mirror.coordinate(origin),
            start: mirror.near_line(cell),
            direction: mirror.coordinate(direction),
            inverse: mirror.coordinate(1.0 / direction),
            end: mirror.cells_left(cell, size as i32),
        }
    }

    /// Returns the distance from the ray's origin to the near line of a cell; the same bits as in the plain traversal.
    #[inline(always)]
    #[must_use]
    pub fn distance(&self, cell: i32) -> f64 {
        ((self.start + f64::from(cell)) - self.origin) * self.inverse
    }

    /// Returns the cell that the ray is in at `distance`, given that it was in cell `from` before.
    ///
    /// `is_crossed` decides, from the distance to a grid line, whether the plain traversal would have crossed the line.
    #[inline(always)]
    fn cell_at(&self, distance: f64, from: i32, is_crossed: impl Fn(f64) -> bool) -> i32 {
        // `at` is negative only by rounding, so truncation equals the floor, except near a tie.
        let at = (self.origin - self.start) + distance * self.direction;
        let cell = at as i32;
        let beyond = at - f64::from(cell);
        if beyond > NEAR_TIE && beyond < 1.0 - NEAR_TIE {
            return cell;
        }
        let line = cell + i32::from(beyond > 0.5);
        let crossed = is_crossed(self.distance(line));
        // A ray along a grid line (direction 0) stays in its cell, and no ray moves back.
        (line - i32::from(!crossed)).max(from)
    }
}

impl Track {
    /// Returns the track of a ray.
    #[inline(always)]
    #[must_use]
    pub fn new(free_boxes: &FreeBoxes, ray: &Ray) -> Self {
        let sector = Sector::of(ray.direction);
        let x = Axis::new(sector.x(), ray.origin.x, ray.col, ray.direction.x, free_boxes.width());
        let y = Axis::new(sector.y(), ray.origin.y, ray.row, ray.direction.y, free_boxes.height());
        let (major, minor) = sector.order(x, y);
        Self { major, minor, sector }
    }

    /// Returns the cell that the ray enters when it leaves the free box at cell `(major, minor)`, which is `length` cells
    /// long; the same cell as in the plain traversal.
    ///
    /// A ray leaves a box through one of its two far sides. The grid line of that side is known exactly, and the distance to
    /// it is computed from the ray's origin, as in the traversal. The cell along the other axis is the one that contains the
    /// crossing.
    #[inline(always)]
    #[must_use]
    pub fn step(&self, (major, minor): (i32, i32), length: i32) -> (i32, i32) {
        let (far_major, far_minor) = (major + length, minor + breadth(length));
        let (to_major, to_minor) = (self.major.distance(far_major), self.minor.distance(far_minor));
        // If both lines are at the same distance, the traversal crosses the line between two rows first.
        let steep = self.sector.is_steep();
        if to_major < to_minor || (steep && to_major == to_minor) {
            let is_crossed = |to_line| to_line < to_major || (!steep && to_line == to_major);
            (far_major, self.minor.cell_at(to_major, minor, is_crossed))
        } else {
            let is_crossed = |to_line| to_line < to_minor || (steep && to_line == to_minor);
            (self.major.cell_at(to_minor, major, is_crossed), far_minor)
        }
    }

    /// Returns the cell along the minor axis in which the ray enters cell `major` along the major axis; the same cell as in the plain
    /// traversal.
    #[inline(always)]
    #[must_use]
    pub fn row_in(&self, major: i32) -> i32 {
        let to_major = self.major.distance(major);
        let steep = self.sector.is_steep();
        self.minor.cell_at(to_major, 0, |to_line| to_line < to_major || (!steep && to_line == to_major))
    }

    /// Returns the distance from the start of the ray, which may be off the grid, to the boundary at which it enters a cell;
    /// infinite if that cell is off the grid.
    ///
    /// The ray enters the cell at the farther of its two near lines. The near lines of the first cell are at or behind the
    /// ray's origin, so the ray enters this cell at its origin.
    #[inline(always)]
    #[must_use]
    pub fn distance(&self, ray: &Ray, (major, minor): (i32, i32)) -> f64 {
        let entered = farther(self.major.distance(major), farther(self.minor.distance(minor), 0.0));
        if major < self.major.end && minor < self.minor.end { ray.gap + entered } else { f64::INFINITY }
    }
}

/// Returns the larger number, or `b` if `a` is NaN. The distance to a line that the ray runs along is NaN.
#[inline(always)]
fn farther(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Returns the same as [`Track::distance`], without a track, in a form that the compiler can vectorise.
#[inline(always)]
pub fn distance(free_boxes: &FreeBoxes, ray: &Ray, (major, minor): (i32, i32)) -> f64 {
    let sector = Sector::of(ray.direction);
    let (cols, rows) = sector.order(major, minor);
    let inverse = ray.inverse();
    let along = |mirror: Mirror, cell: i32, cells: i32, origin: f64, inverse: f64, size: usize| {
        let entered = mirror.ahead(cell, cells);
        ((f64::from(mirror.entry_line(entered)) - origin) * inverse, (entered as u32) < size as u32)
    };
    let (to_col, col_on_grid) = along(sector.x(), ray.col, cols, ray.origin.x, inverse.x, free_boxes.width());
    let (to_row, row_on_grid) = along(sector.y(), ray.row, rows, ray.origin.y, inverse.y, free_boxes.height());
    let entered = farther(to_col, farther(to_row, 0.0));
    if col_on_grid & row_on_grid { ray.gap + entered } else { f64::INFINITY }
}
