//! How far a ray may jump: per cell and sector of directions, a free box.

use glam::DVec2;

use super::Sector;

/// Free boxes around each cell of a grid, one for each [`Sector`] of directions.
///
/// The box of a length has half as many cells across, rounded up. It has the cell in its near corner, extends into the sector and
/// holds no blocking cell. The length is 0 for a blocking cell, and for the border one cell wide around the grid, which stops
/// rays that leave.
///
/// Each sector has a plane of its own, mirrored and swapped as the sector is: a ray moves towards higher columns and rows of its
/// plane, and the cells it comes by are near each other in memory.
#[derive(Debug)]
pub struct Clearance {
    /// Lengths, plane by plane, row by row; then what a read of four bytes may reach beyond the last of them.
    lengths: Vec<u8>,
    width: usize,
    height: usize,
}

/// The longest box, even so that a box two longer than a shorter one is no longer than this.
pub const LONGEST: u8 = 254;

/// Bytes that a four-byte read of the last length reaches beyond it.
const READ_BEYOND: usize = 3;

/// The cells across a box of this length.
#[inline]
#[must_use]
pub fn breadth(length: i32) -> i32 {
    (length + 1) >> 1
}

impl Clearance {
    /// The boxes of a grid whose cells block where `blocks` says so of their index, row by row.
    #[must_use]
    pub fn new(width: usize, height: usize, blocks: impl Fn(usize) -> bool) -> Self {
        let plane = (width + 2) * (height + 2);
        let mut clearance = Self { lengths: vec![0; Sector::COUNT * plane + READ_BEYOND], width, height };
        let upright: Vec<bool> = (0..width * height).map(blocks).collect();
        let steep: Vec<bool> = (0..width * height).map(|index| upright[index % height * width + index / height]).collect();
        for (sector, lengths) in Sector::all().zip(clearance.lengths.chunks_exact_mut(plane)) {
            let (cols, rows) = sector.order(width, height);
            let blocking = if sector.is_steep() { &steep } else { &upright };
            let mirrored = sector.order(sector.is_left(), sector.is_down());
            fill(lengths, blocking, cols, rows, mirrored);
        }
        clearance
    }

    /// Number of columns, border left out.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of rows, border left out.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// All lengths.
    #[must_use]
    pub fn lengths(&self) -> &[u8] {
        &self.lengths
    }

    /// Bytes of a plane.
    #[inline]
    #[must_use]
    pub fn plane(&self) -> usize {
        (self.width + 2) * (self.height + 2)
    }

    /// Bytes from a row to the next in the plane of a sector.
    #[inline]
    #[must_use]
    pub fn stride(&self, sector: Sector) -> usize {
        sector.order(self.width, self.height).0 + 2
    }

    /// Where in the lengths the one of a cell is.
    #[inline]
    #[must_use]
    pub fn index(&self, col: i32, row: i32, sector: Sector) -> usize {
        let col = if sector.is_left() { self.width as i32 - 1 - col } else { col };
        let row = if sector.is_down() { self.height as i32 - 1 - row } else { row };
        let (major, minor) = sector.order(col, row);
        sector.number() as usize * self.plane() + (minor + 1) as usize * self.stride(sector) + (major + 1) as usize
    }

    /// Length of the box of a cell into a sector; columns and rows one off the grid are its border.
    #[must_use]
    pub fn length(&self, col: i32, row: i32, sector: Sector) -> i32 {
        self.lengths[self.index(col, row, sector)].into()
    }

    /// The cell that a point is in, counted in cells, if that is on the grid.
    #[inline]
    #[must_use]
    pub fn cell_at(&self, point: DVec2) -> Option<(i32, i32)> {
        let floor = point.floor();
        let on_grid = floor.x >= 0.0 && floor.y >= 0.0 && floor.x < self.width as f64 && floor.y < self.height as f64;
        on_grid.then_some((floor.x as i32, floor.y as i32))
    }

    /// Bytes held.
    #[must_use]
    pub fn memory(&self) -> usize {
        self.lengths.len()
    }
}

/// Fills a plane of `cols` by `rows`.
///
/// A dynamic programme: a box two longer and one broader is covered by its first two cells and the boxes two along, one across,
/// and both.
fn fill(lengths: &mut [u8], blocking: &[bool], cols: usize, rows: usize, mirrored: (bool, bool)) {
    let stride = cols + 2;
    for row in (0..rows).rev() {
        let (line, done) = lengths[(row + 1) * stride..(row + 3) * stride].split_at_mut(stride);
        let source = if mirrored.1 { rows - 1 - row } else { row };
        let source = &blocking[source * cols..][..cols];
        if mirrored.0 {
            fill_row(line, done, source.iter());
        } else {
            fill_row(line, done, source.iter().rev());
        }
    }
}

/// Fills the row `line`, the row `done` across from it being done; `blocking` from the last cell to the first.
fn fill_row<'a>(line: &mut [u8], done: &[u8], blocking: impl Iterator<Item = &'a bool>) {
    let cols = line.len() - 2;
    let (mut next, mut after_next) = (0, 0);
    let (mut done_next, mut done_after_next) = (0, 0);
    let mut next_blocks = true;
    for ((length, &done), &blocks) in line[1..=cols].iter_mut().zip(&done[1..=cols]).rev().zip(blocking) {
        let least = done.min(done_after_next).min(after_next).min(LONGEST - 2);
        // Boxes of length 1 two apart leave the cell between them.
        let free = if next_blocks { 1 } else { least + 2 - u8::from(least == 1) };
        *length = if blocks { 0 } else { free };
        (after_next, next) = (next, *length);
        (done_after_next, done_next) = (done_next, done);
        next_blocks = blocks;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use rand::Rng;

    /// Sector, cell, and the length found there, of all cells and sectors.
    fn boxes(clearance: &Clearance) -> impl Iterator<Item = (Sector, (i32, i32), i32)> {
        let cells = (0..clearance.height() as i32).flat_map(|row| (0..clearance.width() as i32).map(move |col| (col, row)));
        cells.flat_map(move |(col, row)| {
            Sector::all().map(move |sector| (sector, (col, row), clearance.length(col, row, sector)))
        })
    }

    /// Whether a box has a blocking cell or reaches off the grid.
    fn is_blocked(blocking: &[bool], width: usize, (col, row): (i32, i32), sector: Sector, length: i32) -> bool {
        let (cols, rows) = sector.order(length, breadth(length));
        let height = blocking.len() / width;
        (0..rows).flat_map(|up| (0..cols).map(move |along| (along, up))).any(|(along, up)| {
            let col = col + if sector.is_left() { -along } else { along };
            let row = row + if sector.is_down() { -up } else { up };
            let on_grid = (0..width as i32).contains(&col) && (0..height as i32).contains(&row);
            !on_grid || blocking[row as usize * width + col as usize]
        })
    }

    #[test]
    fn boxes_are_free_and_all_but_as_long_as_can_be() {
        let mut stream = random::stream(1, 0);
        for (width, height, one_in) in [(1, 1, 2), (1, 9, 4), (13, 1, 4), (17, 12, 3), (23, 31, 20), (40, 25, 400)] {
            let blocking: Vec<bool> = (0..width * height).map(|_| stream.next_u64().is_multiple_of(one_in)).collect();
            let clearance = Clearance::new(width, height, |index| blocking[index]);
            for (sector, cell, length) in boxes(&clearance) {
                let blocked = |length| is_blocked(&blocking, width, cell, sector, length);
                assert!(!blocked(length), "{width}x{height} {cell:?} {sector:?}: {length} is too long");
                assert!(blocked(length + 2), "{width}x{height} {cell:?} {sector:?}: {length} is too short");
                assert_eq!(length == 0, blocked(1), "{width}x{height} {cell:?} {sector:?}");
            }
        }
    }

    #[test]
    fn lengths_stop_at_what_a_byte_holds() {
        let clearance = Clearance::new(300, 300, |_| false);
        for sector in Sector::all() {
            let corner = |back: bool| if back { 299 } else { 0 };
            assert_eq!(clearance.length(corner(sector.is_left()), corner(sector.is_down()), sector), i32::from(LONGEST));
            assert_eq!(clearance.length(corner(!sector.is_left()), corner(!sector.is_down()), sector), 1);
        }
    }

    #[test]
    fn the_border_stops_every_sector() {
        let clearance = Clearance::new(3, 2, |_| false);
        for (col, row) in [(-1, 0), (3, 1), (0, -1), (2, 2), (-1, -1), (3, 2)] {
            for sector in Sector::all() {
                assert_eq!(clearance.length(col, row, sector), 0);
            }
        }
    }
}
