//! Free boxes: how far a ray may jump from a cell without a check of the cells on its way.

mod pages;
mod sector;

use std::ops::Range;

pub use sector::{Mirror, Sector};

use crate::batch;
use pages::Pages;

use crate::error::Error;
use crate::interrupt::Watch;

/// Length of the free box of each cell of a grid, for each [`Sector`] of directions.
///
/// A free box holds no blocking cell. It has the cell in its near corner, extends `length` cells along the major axis of the
/// sector, and half as many cells, rounded up, along the minor axis. Its length is the largest even number possible, up to
/// [`MAX_LENGTH`], or 1 if the cell is free and the next one along the major axis is not. Blocking cells have length 0. A
/// border of length 0, one cell wide, surrounds the grid and stops rays that leave it.
///
/// ```text
///      .  .  .  #  .  .  .  .     The free box of the cell o in sector 0 has length 6 and breadth 3. A ray from o into this
///     +----------------+          sector leaves the box through its right side or its upper side.
///     |.  .  .  .  .  .|.  #
///     |.  .  .  .  .  .|.  .      A box of length 8 would have breadth 4 and hold the two blocking cells #.
///     |o  .  .  .  .  .|.  .
///     +----------------+
/// ```
///
/// Each sector has its own plane of lengths, mirrored and swapped like the sector. So every ray moves towards higher columns
/// and rows of its plane, and cells that a ray visits in turn are close to each other in memory.
#[derive(Debug)]
pub struct FreeBoxes {
    /// One code for each cell and sector, from which [`length`] gives the length: plane by plane, row by row.
    codes: Pages,
    width: usize,
    height: usize,
}

/// Longest box.
pub const MAX_LENGTH: i32 = length(u8::MAX);

/// Ranges of columns and of rows.
pub type Region = (Range<usize>, Range<usize>);

/// Returns the number of cells along the minor axis of a box of this length.
#[inline]
#[must_use]
pub fn breadth(length: i32) -> i32 {
    (length + 1) >> 1
}

/// Returns the length of a box from its code.
///
/// Lengths above 1 are even, so a byte can hold half of a length:
///
/// | code | 0 | 1 | 2 | 3 | 4 | ... | 255 |
/// |---|---|---|---|---|---|---|---|
/// | length | 0 | 1 | 2 | 4 | 6 | ... | 508 |
/// | breadth | 0 | 1 | 1 | 2 | 3 | ... | 254 |
#[inline(always)]
#[must_use]
pub const fn length(code: u8) -> i32 {
    if code > 1 { 2 * (code as i32 - 1) } else { code as i32 }
}

/// What the memory is for, in errors.
const TABLE: &str = "the free boxes of the grid";

/// Memory for the free boxes of a grid, and for building them.
pub struct Room {
    codes: Pages,
    by_column: Pages,
    width: usize,
}

impl Room {
    /// Returns memory for a grid of `cells` cells in rows of `width`. The memory is not touched, so this takes no time.
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    ///
    /// # Panics
    /// If there are no cells, or if their number is not a multiple of `width`.
    pub fn new(cells: usize, width: usize) -> Result<Self, Error> {
        assert!(cells > 0 && cells.is_multiple_of(width), "{cells} cells in rows of {width}");
        let codes = Pages::zeroed(TABLE, Sector::COUNT * (width + 2) * (cells / width + 2))?;
        Ok(Self { codes, by_column: Pages::zeroed(TABLE, cells)?, width })
    }
}

impl FreeBoxes {
    /// Returns the free boxes of a grid with these cells, row by row; `blocks` says which of them block.
    ///
    /// Built on `threads` threads (default: all cores), after a first, single-threaded pass.
    ///
    /// # Errors
    /// [`Error::Interrupted`]: the call was interrupted.
    pub fn new<T: Sync>(
        room: Room,
        cells: &[T],
        threads: Option<usize>,
        blocks: impl Fn(&T) -> bool + Sync,
    ) -> Result<Self, Error> {
        let Room { mut codes, by_column, width } = room;
        let height = cells.len() / width;
        let plane = (width + 2) * (height + 2);
        let shape = Self { codes: Pages::empty(), width, height };
        let watch = Watch::new();
        let free = FreeCells::new(cells, width, (0..width, 0..height), blocks, by_column, &watch)?;
        let fill = |sector: usize, codes: &mut [u8]| shape.fill(Sector::numbered(sector), codes, &free, &watch);
        match batch::for_each_chunk_watched(&watch, threads, &mut codes, plane, fill) {
            // The system cannot start threads, so the calling thread does the work.
            Err(Error::Threads { .. }) => {
                codes.chunks_exact_mut(plane).enumerate().try_for_each(|(sector, codes)| fill(sector, codes))?;
            }
            filled => filled?,
        }
        Ok(Self { codes, ..shape })
    }

    /// Returns a copy.
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    pub fn try_clone(&self) -> Result<Self, Error> {
        Ok(Self { codes: self.codes.try_clone(TABLE)?, ..*self })
    }

    /// Rebuilds the lengths that depend on the cells of a region. Takes all cells of the grid, like [`new`](Self::new).
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory. The lengths are unchanged.
    ///
    /// # Panics
    /// If the region is not on the grid.
    pub fn update<T>(&mut self, cells: &[T], region: Region, blocks: impl Fn(&T) -> bool) -> Result<(), Error> {
        let shape = Self { codes: Pages::empty(), ..*self };
        let by_column = Pages::zeroed(TABLE, region.0.len() * region.1.len())?;
        let watch = Watch::never();
        let free = FreeCells::new(cells, self.width, region, blocks, by_column, &watch)?;
        for (sector, codes) in Sector::all().zip(self.codes.chunks_exact_mut(shape.plane())) {
            shape.fill(sector, codes, &free, &watch)?;
        }
        Ok(())
    }

    /// Fills the part of a sector's plane that depends on the cells of a region.
    fn fill<T>(
        &self,
        sector: Sector,
        codes: &mut [u8],
        free: &FreeCells<'_, T, impl Fn(&T) -> bool>,
        watch: &Watch,
    ) -> Result<(), Error> {
        let (cols, rows) = &free.region;
        let (major, minor) = sector.order(sector.x(), sector.y());
        let (major_region, minor_region) = sector.order(cols, rows);
        let (major_size, minor_size) = sector.order(self.width, self.height);
        let (along, across) = (major.range(major_region, major_size), minor.range(minor_region, minor_size));
        let stride = self.stride(sector);
        // Boxes of cells farther away do not reach the region.
        let (max_along, max_across) = (MAX_LENGTH as usize, breadth(MAX_LENGTH) as usize);
        let reaching = along.start.saturating_sub(max_along)..along.end;
        let mut filler = RowFiller::default();
        let mut before = Vec::new();
        for row in (across.start.saturating_sub(max_across)..across.end).rev() {
            watch.check()?;
            let (line, next_row) = codes[(row + 1) * stride..(row + 3) * stride].split_at_mut(stride);
            if across.contains(&row) {
                let index = minor.cell(row as i32, minor_size as i32) as usize - minor_region.start;
                let line = &mut line[1 + along.start..=along.end];
                free.write_line(sector.is_steep(), index, line);
                if major.is_on() {
                    line.reverse();
                }
            }
            let line = &mut line[1 + reaching.start..];
            if row < across.start {
                before.clear();
                before.extend_from_slice(&line[..reaching.len()]);
            }
            filler.fill(line, &next_row[1 + reaching.start..], reaching.len());
            // The codes of a row depend on its cells and on the next row. If they have not changed, those of the rows before it
            // stay the same, too.
            if row < across.start && line[..reaching.len()] == before {
                break;
            }
        }
        Ok(())
    }

    /// Returns the number of columns, without the border.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Returns the number of rows, without the border.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// Returns the codes of all lengths: plane by plane, row by row, each row and plane with its border.
    #[must_use]
    pub fn codes(&self) -> &[u8] {
        &self.codes
    }

    /// Returns the size of a plane in bytes.
    #[inline]
    #[must_use]
    pub fn plane(&self) -> usize {
        (self.width + 2) * (self.height + 2)
    }

    /// Returns the size in bytes of a row in the plane of a sector.
    #[inline]
    #[must_use]
    pub fn stride(&self, sector: Sector) -> usize {
        sector.order(self.width, self.height).0 + 2
    }

    /// Returns the index in [`codes`](Self::codes) of a cell and sector. Columns and rows -1, width and height are the
    /// border.
    #[inline]
    #[must_use]
    pub fn index(&self, col: i32, row: i32, sector: Sector) -> usize {
        sector.number() as usize * self.plane() + self.index_in_plane(col, row, sector)
    }

    fn index_in_plane(&self, col: i32, row: i32, sector: Sector) -> usize {
        let (major, minor) = sector.order(sector.x().cell(col, self.width as i32), sector.y().cell(row, self.height as i32));
        (minor + 1) as usize * self.stride(sector) + (major + 1) as usize
    }

    /// Returns the length of the free box of a cell in a sector. Columns and rows -1, width and height are the border.
    #[must_use]
    pub fn length(&self, col: i32, row: i32, sector: Sector) -> i32 {
        length(self.codes[self.index(col, row, sector)])
    }
}

/// Which cells of a region are free, by row and by column.
struct FreeCells<'a, T, F> {
    cells: &'a [T],
    width: usize,
    region: Region,
    blocks: F,
    /// 1 for each free cell of the region and 0 for the others, column by column.
    by_column: Pages,
}

impl<'a, T, F: Fn(&T) -> bool> FreeCells<'a, T, F> {
    fn new(
        cells: &'a [T],
        width: usize,
        region: Region,
        blocks: F,
        mut by_column: Pages,
        watch: &Watch,
    ) -> Result<Self, Error> {
        // A square of this side fits in the cache, whether it is read by row or by column.
        const TILE: usize = 64;
        let height = region.1.len();
        for first_row in (0..height).step_by(TILE) {
            for first_col in region.0.clone().step_by(TILE) {
                watch.check()?;
                for col in first_col..(first_col + TILE).min(region.0.end) {
                    let end = (first_row + TILE).min(height);
                    let column = cells[(region.1.start + first_row) * width + col..].iter().step_by(width);
                    let tile = &mut by_column[(col - region.0.start) * height..][first_row..end];
                    tile.iter_mut().zip(column).for_each(|(to, cell)| *to = u8::from(!blocks(cell)));
                }
            }
        }
        Ok(Self { cells, width, region, blocks, by_column })
    }

    /// Writes 1 for each free cell and 0 for the others, of one column or one row of the region.
    fn write_line(&self, is_column: bool, index: usize, line: &mut [u8]) {
        if is_column {
            line.copy_from_slice(&self.by_column[index * line.len()..][..line.len()]);
        } else {
            let row = &self.cells[(self.region.1.start + index) * self.width..][self.region.0.clone()];
            line.iter_mut().zip(row).for_each(|(to, cell)| *to = u8::from(!(self.blocks)(cell)));
        }
    }
}

/// Computes the codes of a plane row by row. Holds the buffers for this.
#[derive(Default)]
struct RowFiller {
    /// Halves of the lengths of the row so far, rounded down, then those of up to two cells past its end.
    halves: Vec<u8>,
    /// The same after the next step.
    next: Vec<u8>,
}

impl RowFiller {
    /// Computes the first `count` codes of a row.
    ///
    /// At the start, `line` holds 0 for each blocking cell of the row and another number for each free one; from index
    /// `count` on it holds final codes. `next_row` holds the final codes of the next row.
    ///
    /// Method: dynamic programming. A box at (col, row) that is 2 longer and 1 broader than a box of length L is covered by
    /// the first two cells of its row and by three boxes of length L, which start at cells ahead.
    ///
    /// ```text
    ///     row + 1    A  A  C  C      L = 2: a box of length 4 and breadth 2 is covered by the boxes A, B and C and the
    ///     row        f  f  B  B      cells f. The length at (col, row) is 2 more than that of the shortest of A, B and C
    ///               col              if both cells f are free, and 1 if only the first of them is.
    /// ```
    fn fill(&mut self, line: &mut [u8], next_row: &[u8], count: usize) {
        // Half of a length, rounded down: two boxes of length 1 whose cells are two apart do not cover the cell between them.
        let half = |code: u8| code.saturating_sub(1);
        // The code of the shorter box is one more than its half, which is what a box that is 2 longer has as its half.
        let from_next_row = next_row.iter().zip(&next_row[2..]).map(|(&a, &b)| a.min(b).clamp(1, half(u8::MAX)));
        let are_free = line[..count].iter().zip(&line[1..]).map(|(&here, &next)| here != 0 && next != 0);
        self.halves.clear();
        // At the end of the grid the next row lacks one cell, so the last cell is left out here. Its length is 0 or 1, and
        // the border, which follows, has the 0 that stands for both.
        self.halves.extend(from_next_row.zip(are_free).map(|(half, are_free)| if are_free { half } else { 0 }));
        self.halves.extend(line[count..].iter().take(2).map(|&code| half(code)));
        debug_assert!(self.halves.len() >= count, "a row lacks cells past its end or in the next row");
        // The third box is in the same row: half[col] <= half[col + 2] + 1. In a loop over the cells, each cell would have to
        // wait for the previous one. Instead the bound is applied to the whole row at distances 2, 4, 8 and so on, as long as it
        // can be below the largest half.
        self.next.resize(self.halves.len(), 0);
        let cells = self.halves.len();
        let largest = usize::from(self.halves.iter().fold(0, |largest: u8, &half| largest.max(half)));
        let is_useful = |&distance: &usize| distance < cells && distance / 2 < largest;
        for distance in [2, 4, 8, 16, 32, 64, 128, 256].into_iter().take_while(is_useful) {
            let (near, end) = self.next.split_at_mut(cells - distance);
            for ((to, &here), &ahead) in near.iter_mut().zip(&self.halves).zip(self.halves.iter().skip(distance)) {
                *to = here.min(ahead.saturating_add((distance / 2) as u8));
            }
            end.copy_from_slice(&self.halves[near.len()..]);
            std::mem::swap(&mut self.halves, &mut self.next);
        }
        for (code, &half) in line[..count].iter_mut().zip(&self.halves) {
            // The code of an even length is one more than its half; a free cell has at least code 1.
            *code = half + (*code).min(1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn built<T: Sync>(cells: &[T], width: usize, threads: Option<usize>, blocks: impl Fn(&T) -> bool + Sync) -> FreeBoxes {
        FreeBoxes::new(Room::new(cells.len(), width).expect("enough memory"), cells, threads, blocks)
            .expect("no interruption")
    }
    use crate::random;
    use rand::Rng;

    /// Sector, cell and length of every box.
    fn boxes(free_boxes: &FreeBoxes) -> impl Iterator<Item = (Sector, (i32, i32), i32)> {
        let cells =
            (0..free_boxes.height() as i32).flat_map(|row| (0..free_boxes.width() as i32).map(move |col| (col, row)));
        cells.flat_map(move |(col, row)| {
            Sector::all().map(move |sector| (sector, (col, row), free_boxes.length(col, row, sector)))
        })
    }

    /// Returns true if a box holds a blocking cell or reaches off the grid.
    fn is_blocked(blocking: &[bool], width: usize, (col, row): (i32, i32), sector: Sector, length: i32) -> bool {
        let (cols, rows) = sector.order(length, breadth(length));
        let height = blocking.len() / width;
        (0..rows).flat_map(|up| (0..cols).map(move |along| (along, up))).any(|(along, up)| {
            let (col, row) = (sector.x().ahead(col, along), sector.y().ahead(row, up));
            let on_grid = (0..width as i32).contains(&col) && (0..height as i32).contains(&row);
            !on_grid || blocking[row as usize * width + col as usize]
        })
    }

    #[test]
    fn boxes_are_free_and_at_most_one_cell_too_short() {
        let mut stream = random::stream(1, 0);
        for (width, height, one_in) in [(1, 1, 2), (1, 9, 4), (13, 1, 4), (17, 12, 3), (23, 31, 20), (40, 25, 400)] {
            let blocking: Vec<bool> = (0..width * height).map(|_| stream.next_u64().is_multiple_of(one_in)).collect();
            let free_boxes = built(&blocking, width, Some(1), |blocks| *blocks);
            for (sector, cell, length) in boxes(&free_boxes) {
                let blocked = |length| is_blocked(&blocking, width, cell, sector, length);
                assert!(!blocked(length), "{width}x{height} {cell:?} {sector:?}: {length} is too long");
                assert!(blocked(length + 2), "{width}x{height} {cell:?} {sector:?}: {length} is too short");
                assert_eq!(length == 0, blocked(1), "{width}x{height} {cell:?} {sector:?}");
            }
        }
    }

    #[test]
    fn whole_row_steps_equal_one_cell_after_the_other() {
        let mut stream = random::stream(3, 0);
        let mut below = |bound: u64| (stream.next_u64() % bound) as u8;
        let covering = |code: &u8| if *code == 1 { 0 } else { length(*code) };
        let code = |length: i32| if length > 1 { (length / 2 + 1) as u8 } else { length as u8 };
        for count in (1..70).chain(500..570) {
            for behind in 1..4 {
                let mut done: Vec<u8> = (0..count + behind).map(|_| 255 - below(40)).collect();
                let mut line: Vec<u8> = (0..count + behind).map(|_| below(255).min(1)).collect();
                line[count..].fill_with(|| below(256));
                if behind == 1 {
                    (done[count], line[count]) = (0, 0);
                }
                let mut expected = line.clone();
                for cell in (0..count).rev() {
                    let ahead = [done.get(cell), done.get(cell + 2), expected.get(cell + 2)];
                    let least = ahead.map(|code| code.map_or(0, covering)).into_iter().fold(MAX_LENGTH - 2, i32::min);
                    expected[cell] = if line[cell] != 0 && line[cell + 1] != 0 { code(least + 2) } else { line[cell] };
                }
                RowFiller::default().fill(&mut line, &done, count);
                assert_eq!(line, expected, "{count} cells, {behind} behind");
            }
        }
    }

    #[test]
    fn lengths_end_at_the_longest_box() {
        let free_boxes = built(&[(); 360_000], 600, Some(1), |()| false);
        for sector in Sector::all() {
            let corner = |back: bool| if back { 599 } else { 0 };
            assert_eq!(free_boxes.length(corner(sector.x().is_on()), corner(sector.y().is_on()), sector), MAX_LENGTH);
            assert_eq!(free_boxes.length(corner(!sector.x().is_on()), corner(!sector.y().is_on()), sector), 1);
        }
    }

    #[test]
    fn the_border_stops_every_sector() {
        let free_boxes = built(&[(); 6], 3, Some(1), |()| false);
        for (col, row) in [(-1, 0), (3, 1), (0, -1), (2, 2), (-1, -1), (3, 2)] {
            for sector in Sector::all() {
                assert_eq!(free_boxes.length(col, row, sector), 0);
            }
        }
    }

    #[test]
    fn an_update_equals_a_rebuild() {
        let mut stream = random::stream(2, 0);
        let mut below = |count: usize| stream.next_u64() as usize % count;
        for (width, height, one_in) in [(1, 1, 2), (1, 700, 300), (700, 1, 300), (40, 30, 9), (1100, 300, 100_000)] {
            let mut blocking: Vec<bool> = (0..width * height).map(|_| below(one_in) == 0).collect();
            let mut free_boxes = built(&blocking, width, Some(1), |blocks| *blocks);
            for _ in 0..20 {
                let (col, row) = (below(width), below(height));
                let region = (col..col + 1 + below(width - col), row..row + 1 + below(height - row));
                for row in region.1.clone() {
                    blocking[row * width..][region.0.clone()].fill_with(|| below(one_in) == 0);
                }
                free_boxes.update(&blocking, region.clone(), |blocks| *blocks).expect("enough memory");
                let rebuilt = built(&blocking, width, Some(2), |blocks| *blocks);
                assert!(free_boxes.codes() == rebuilt.codes(), "{width}x{height} {region:?}");
            }
        }
    }
}
