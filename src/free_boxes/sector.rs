//! The eight sectors of 45° that directions fall into, and the mirroring that turns each of them into sector 0.

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

    /// Returns the sector of a direction. 0.0 and -0.0 count as positive, and a diagonal has x as its major axis.
    #[inline(always)]
    #[must_use]
    pub fn of(direction: DVec2) -> Self {
        Self { x: Mirror::of(direction.x), y: Mirror::of(direction.y), is_steep: direction.y.abs() > direction.x.abs() }
    }

    /// Iterates over all sectors in the order of their numbers.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..Self::COUNT).map(Self::numbered)
    }

    /// Returns the sector with this number.
    ///
    /// # Panics
    /// If the number is not less than [`COUNT`](Self::COUNT).
    #[must_use]
    pub fn numbered(number: usize) -> Self {
        assert!(number < Self::COUNT, "there is no sector {number}");
        let bit = |bit: usize| number >> bit & 1 != 0;
        Self { x: Mirror(bit(0)), y: Mirror(bit(1)), is_steep: bit(2) }
    }

    /// Returns the number of the sector, less than [`COUNT`](Self::COUNT).
    #[inline(always)]
    #[must_use]
    pub fn number(self) -> u32 {
        u32::from(self.x.0) | u32::from(self.y.0) << 1 | u32::from(self.is_steep) << 2
    }

    /// Returns the mirror of the x axis.
    #[inline(always)]
    #[must_use]
    pub fn x(self) -> Mirror {
        self.x
    }

    /// Returns the mirror of the y axis.
    #[inline(always)]
    #[must_use]
    pub fn y(self) -> Mirror {
        self.y
    }

    /// Returns true if the major axis is y.
    #[inline(always)]
    #[must_use]
    pub fn is_steep(self) -> bool {
        self.is_steep
    }

    /// Converts a pair from the order (x, y) to the order (major, minor), or back.
    #[inline(always)]
    #[must_use]
    pub fn order<T>(self, x: T, y: T) -> (T, T) {
        if self.is_steep { (y, x) } else { (x, y) }
    }
}

/// Whether one axis of a sector is mirrored, so that rays of the sector move up it.
///
/// Coordinates and cells count from the lower end of the grid; mirrored cells count from its upper end, and mirrored
/// coordinates are negated. The near line of a cell is the grid line at which rays of the sector enter the cell. They leave
/// it at its far line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mirror(bool);

impl Mirror {
    /// Returns the mirror for rays whose direction has this component along the axis.
    #[inline(always)]
    #[must_use]
    pub fn of(component: f64) -> Self {
        Self(component < 0.0)
    }

    /// Returns true if the axis is mirrored.
    #[inline(always)]
    #[must_use]
    pub fn is_on(self) -> bool {
        self.0
    }

    /// Returns the mirrored number of a cell, on an axis with `size` cells.
    #[inline(always)]
    #[must_use]
    pub fn cell(self, cell: i32, size: i32) -> i32 {
        if self.0 { size - 1 - cell } else { cell }
    }

    /// Returns the mirrored range of a range of cells, on an axis with `size` cells.
    #[must_use]
    pub fn range(self, range: &Range<usize>, size: usize) -> Range<usize> {
        if self.0 { size - range.end..size - range.start } else { range.clone() }
    }

    /// Returns the mirrored coordinate, or the mirrored component of a direction.
    #[inline(always)]
    #[must_use]
    pub fn coordinate(self, coordinate: f64) -> f64 {
        if self.0 { -coordinate } else { coordinate }
    }

    /// Returns the mirrored coordinate of the near line of a cell. The cell itself is not mirrored.
    #[inline(always)]
    #[must_use]
    pub fn near_line(self, cell: i32) -> f64 {
        if self.0 { -1.0 - f64::from(cell) } else { f64::from(cell) }
    }

    /// Returns the coordinate of the near line of a cell. Neither is mirrored.
    #[inline(always)]
    #[must_use]
    pub fn entry_line(self, cell: i32) -> i32 {
        cell + i32::from(self.0)
    }

    /// Returns the distance along the axis from `origin`, a coordinate inside `cell`, to the far line of that cell. Neither
    /// argument is mirrored.
    #[inline(always)]
    #[must_use]
    pub fn to_far_line(self, origin: f64, cell: i32) -> f64 {
        let cell = f64::from(cell);
        if self.0 { origin - cell } else { (cell + 1.0) - origin }
    }

    /// Returns the cell that a ray reaches when it moves `count` cells along the axis. Neither cell is mirrored.
    #[inline(always)]
    #[must_use]
    pub fn ahead(self, cell: i32, count: i32) -> i32 {
        if self.0 { cell - count } else { cell + count }
    }

    /// Returns the number of cells from a cell, which counts too, to the end of the axis in the direction of the rays. The
    /// axis has `size` cells.
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
