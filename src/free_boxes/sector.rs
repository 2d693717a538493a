//! The eight sectors of 45° that directions fall into, and the mirroring that makes them all alike.

use std::ops::Range;

use glam::DVec2;

/// One eighth of all directions: the way a ray moves along each axis, and the axis along which it moves farther.
///
/// A ray is mirrored along each axis that it moves down, and its axes are swapped if it moves farther along y. After that
/// every ray moves up both axes, and farther along the first one, its major axis. Negation is exact, so distances keep all
/// their bits.
///
/// ```text
///           y
///     \  5  |  4  /       The number of each sector. Bit 0: x is mirrored. Bit 1: y is mirrored.
///    1  \   |   /  0      Bit 2: y is the major axis.
///    -------+------- x
///    3  /   |   \  2      Mirroring and swapping turn every sector into sector 0.
///     /  7  |  6  \
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sector {
    x: Mirror,
    y: Mirror,
    is_steep: bool,
}

impl Sector {
    /// Number of sectors.
    pub const COUNT: usize = 8;

    /// Sector of a direction. Both zeros count as positive, and a diagonal has x as its major axis.
    #[inline(always)]
    #[must_use]
    pub fn of(direction: DVec2) -> Self {
        Self { x: Mirror::of(direction.x), y: Mirror::of(direction.y), is_steep: direction.y.abs() > direction.x.abs() }
    }

    /// All sectors, by number.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..Self::COUNT).map(Self::numbered)
    }

    /// The sector with this number.
    ///
    /// # Panics
    /// If the number is not less than [`COUNT`](Self::COUNT).
    #[must_use]
    pub fn numbered(number: usize) -> Self {
        assert!(number < Self::COUNT, "there is no sector {number}");
        let bit = |bit: usize| number >> bit & 1 != 0;
        Self { x: Mirror(bit(0)), y: Mirror(bit(1)), is_steep: bit(2) }
    }

    /// Number of the sector, less than [`COUNT`](Self::COUNT).
    #[inline(always)]
    #[must_use]
    pub fn number(self) -> u32 {
        u32::from(self.x.0) | u32::from(self.y.0) << 1 | u32::from(self.is_steep) << 2
    }

    /// How the x axis is mirrored.
    #[inline(always)]
    #[must_use]
    pub fn x(self) -> Mirror {
        self.x
    }

    /// How the y axis is mirrored.
    #[inline(always)]
    #[must_use]
    pub fn y(self) -> Mirror {
        self.y
    }

    /// True if the major axis is y.
    #[inline(always)]
    #[must_use]
    pub fn is_steep(self) -> bool {
        self.is_steep
    }

    /// Turns a pair in the order (x, y) into the order (major, minor), and back.
    #[inline(always)]
    #[must_use]
    pub fn order<T>(self, x: T, y: T) -> (T, T) {
        if self.is_steep { (y, x) } else { (x, y) }
    }
}

/// Whether one axis of a sector is mirrored, so that rays of the sector move up it.
///
/// Coordinates and cells count from the lower end of the grid; mirrored cells count from its upper end, and mirrored
/// coordinates are negated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mirror(bool);

impl Mirror {
    /// The mirror for rays with this component of the direction.
    #[inline(always)]
    #[must_use]
    pub fn of(component: f64) -> Self {
        Self(component < 0.0)
    }

    /// True if the axis is mirrored.
    #[inline(always)]
    #[must_use]
    pub fn is_on(self) -> bool {
        self.0
    }

    /// The number of a cell of an axis with `size` cells, mirrored.
    #[inline(always)]
    #[must_use]
    pub fn cell(self, cell: i32, size: i32) -> i32 {
        if self.0 { size - 1 - cell } else { cell }
    }

    /// A range of cells of an axis with `size` cells, mirrored.
    #[must_use]
    pub fn range(self, range: &Range<usize>, size: usize) -> Range<usize> {
        if self.0 { size - range.end..size - range.start } else { range.clone() }
    }

    /// A coordinate, or a component of a direction, mirrored.
    #[inline(always)]
    #[must_use]
    pub fn coordinate(self, coordinate: f64) -> f64 {
        if self.0 { -coordinate } else { coordinate }
    }

    /// The mirrored coordinate of the near line of a cell: the one that the ray crosses to enter the cell.
    #[inline(always)]
    #[must_use]
    pub fn near_line(self, cell: i32) -> f64 {
        if self.0 { -1.0 - f64::from(cell) } else { f64::from(cell) }
    }

    /// The coordinate, not mirrored, of the near line of a cell.
    #[inline(always)]
    #[must_use]
    pub fn entry_line(self, cell: i32) -> i32 {
        cell + i32::from(self.0)
    }

    /// Distance along the axis from `origin`, in cell `cell`, to the far line of the cell.
    #[inline(always)]
    #[must_use]
    pub fn to_far_line(self, origin: f64, cell: i32) -> f64 {
        let cell = f64::from(cell);
        if self.0 { origin - cell } else { (cell + 1.0) - origin }
    }

    /// The cell, not mirrored, that is `count` cells ahead of a cell.
    #[inline(always)]
    #[must_use]
    pub fn ahead(self, cell: i32, count: i32) -> i32 {
        if self.0 { cell - count } else { cell + count }
    }

    /// Number of cells from a cell, that cell included, to the end of an axis with `size` cells.
    #[inline(always)]
    #[must_use]
    pub fn cells_left(self, cell: i32, size: i32) -> i32 {
        if self.0 { cell + 1 } else { size - cell }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_name_the_sectors() {
        for (number, sector) in Sector::all().enumerate() {
            assert_eq!((sector.number() as usize, Sector::numbered(number)), (number, sector));
        }
        let number = |x, y| Sector::of(DVec2::new(x, y)).number();
        assert_eq!([number(2.0, 1.0), number(-2.0, 1.0), number(2.0, -1.0), number(-2.0, -1.0)], [0, 1, 2, 3]);
        assert_eq!([number(1.0, 2.0), number(1.0, -2.0), number(-1.0, 2.0), number(-1.0, -2.0)], [4, 6, 5, 7]);
        assert_eq!([number(1.0, 1.0), number(-0.0, -0.0), number(-0.0, 1.0)], [0, 0, 4]);
    }

    #[test]
    fn a_mirrored_axis_counts_from_its_other_end() {
        let (plain, mirrored) = (Mirror::of(1.0), Mirror::of(-1.0));
        // On an axis with five cells.
        assert_eq!((plain.cell(1, 5), mirrored.cell(1, 5)), (1, 3));
        assert_eq!((plain.range(&(0..2), 5), mirrored.range(&(0..2), 5)), (0..2, 3..5));
        assert_eq!((plain.near_line(2), mirrored.near_line(2)), (2.0, -3.0));
        assert_eq!((plain.entry_line(2), mirrored.entry_line(2)), (2, 3));
        assert_eq!((plain.to_far_line(2.25, 2), mirrored.to_far_line(2.25, 2)), (0.75, 0.25));
        assert_eq!((plain.ahead(2, 2), mirrored.ahead(2, 2)), (4, 0));
        assert_eq!((plain.cells_left(2, 5), mirrored.cells_left(2, 5)), (3, 3));
        assert_eq!((plain.cells_left(0, 5), mirrored.cells_left(0, 5)), (5, 1));
    }
}
