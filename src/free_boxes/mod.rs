//! How far a ray may jump: per cell and sector of directions, a free box.

mod pages;
mod sector;

use std::ops::Range;

pub use sector::{Mirror, Sector};

use crate::batch;
use pages::Pages;

/// Free boxes around each cell of a grid, one for each [`Sector`] of directions.
///
/// The box of a length has half as many cells across, rounded up. It has the cell in its near corner, extends into the sector and
/// holds no blocking cell. The length is 0 for a blocking cell, and for the border one cell wide around the grid, which stops
/// rays that leave.
///
/// Each sector has a plane of its own, mirrored and swapped as the sector is: a ray moves towards higher columns and rows of its
/// plane, and the cells it comes by are near each other in memory.
#[derive(Debug, Clone)]
pub struct FreeBoxes {
    /// Plane by plane, row by row.
    lengths: Pages,
    width: usize,
    height: usize,
}

/// The longest box, even so that a box two longer than a shorter one is no longer than this.
pub const LONGEST: u8 = 254;

/// Columns and rows of a grid.
pub type Region = (Range<usize>, Range<usize>);

/// The cells across a box of this length.
#[inline]
#[must_use]
pub fn breadth(length: i32) -> i32 {
    (length + 1) >> 1
}

impl FreeBoxes {
    /// The boxes of a grid whose cells, row by row, block where `blocks` says so; built by so many threads, or as many as there
    /// are cores; but for finding out which cells of each column are free, which takes a byte a cell meanwhile.
    ///
    /// # Panics
    /// If there is no cell, or not as many in each row.
    #[must_use]
    pub fn new<T: Sync>(cells: &[T], width: usize, threads: Option<usize>, blocks: impl Fn(&T) -> bool + Sync) -> Self {
        assert!(!cells.is_empty() && cells.len().is_multiple_of(width), "{} cells in rows of {width}", cells.len());
        let height = cells.len() / width;
        let plane = (width + 2) * (height + 2);
        let mut lengths = Pages::zeroed(Sector::COUNT * plane);
        let shape = Self { lengths: Pages::zeroed(0), width, height };
        let free = Free::new(cells, width, (0..width, 0..height), blocks);
        let fill = |sector: usize, lengths: &mut [u8]| shape.fill(Sector::numbered(sector), lengths, &free);
        if batch::for_each_chunk(threads, &mut lengths, plane, fill).is_err() {
            // Without threads to be had, the caller's has to do.
            lengths.chunks_exact_mut(plane).enumerate().for_each(|(sector, lengths)| fill(sector, lengths));
        }
        Self { lengths, ..shape }
    }

    /// Builds anew what depends on the cells of a region, given again all cells and which of them block.
    ///
    /// # Panics
    /// If the region is not on the grid.
    pub fn update<T>(&mut self, cells: &[T], region: Region, blocks: impl Fn(&T) -> bool) {
        let shape = Self { lengths: Pages::zeroed(0), ..*self };
        let free = Free::new(cells, self.width, region, blocks);
        for (sector, lengths) in Sector::all().zip(self.lengths.chunks_exact_mut(shape.plane())) {
            shape.fill(sector, lengths, &free);
        }
    }

    /// Builds the plane of a sector as far as it depends on the cells of a region.
    fn fill<T>(&self, sector: Sector, lengths: &mut [u8], free: &Free<'_, T, impl Fn(&T) -> bool>) {
        let (cols, rows) = &free.region;
        let (along_mirror, across_mirror) = sector.order(sector.x(), sector.y());
        let (along_region, across_region) = sector.order(cols, rows);
        let (along_size, across_size) = sector.order(self.width, self.height);
        let (along, across) =
            (along_mirror.range(along_region, along_size), across_mirror.range(across_region, across_size));
        let stride = self.stride(sector);
        // No box from farther away reaches the region.
        let reached = along.start.saturating_sub(LONGEST.into())..along.end;
        let mut filler = RowFiller::default();
        for row in (across.start.saturating_sub(LONGEST.into())..across.end).rev() {
            let (line, done) = lengths[(row + 1) * stride..(row + 3) * stride].split_at_mut(stride);
            if across.contains(&row) {
                let row = across_mirror.cell(row as i32, across_size as i32) as usize - across_region.start;
                free.tell(sector.is_steep(), row, &mut line[1 + along.start..=along.end]);
                if along_mirror.is_on() {
                    line[1 + along.start..=along.end].reverse();
                }
            }
            filler.fill(&mut line[1 + reached.start..], &done[1 + reached.start..], reached.len());
        }
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
        sector.number() as usize * self.plane() + self.index_in_plane(col, row, sector)
    }

    fn index_in_plane(&self, col: i32, row: i32, sector: Sector) -> usize {
        let (major, minor) = sector.order(sector.x().cell(col, self.width as i32), sector.y().cell(row, self.height as i32));
        (minor + 1) as usize * self.stride(sector) + (major + 1) as usize
    }

    /// Length of the box of a cell into a sector; columns and rows one off the grid are its border.
    #[must_use]
    pub fn length(&self, col: i32, row: i32, sector: Sector) -> i32 {
        self.lengths[self.index(col, row, sector)].into()
    }
}

/// Which cells of a region do not block: 1, else 0.
struct Free<'a, T, F> {
    cells: &'a [T],
    width: usize,
    region: Region,
    blocks: F,
    by_col: Vec<u8>,
}

impl<'a, T, F: Fn(&T) -> bool> Free<'a, T, F> {
    fn new(cells: &'a [T], width: usize, region: Region, blocks: F) -> Self {
        // What fits into a cache both along rows and along columns.
        const TILE: usize = 64;
        let height = region.1.len();
        let mut by_col = vec![0; region.0.len() * height];
        for first_row in (0..height).step_by(TILE) {
            for first_col in region.0.clone().step_by(TILE) {
                for col in first_col..(first_col + TILE).min(region.0.end) {
                    let end = (first_row + TILE).min(height);
                    let column = cells[(region.1.start + first_row) * width + col..].iter().step_by(width);
                    let tile = &mut by_col[(col - region.0.start) * height..][first_row..end];
                    tile.iter_mut().zip(column).for_each(|(to, cell)| *to = u8::from(!blocks(cell)));
                }
            }
        }
        Self { cells, width, region, blocks, by_col }
    }

    /// Tells of a row of the region, or of a column.
    fn tell(&self, is_column: bool, index: usize, line: &mut [u8]) {
        if is_column {
            line.copy_from_slice(&self.by_col[index * line.len()..][..line.len()]);
        } else {
            let row = &self.cells[(self.region.1.start + index) * self.width..][self.region.0.clone()];
            line.iter_mut().zip(row).for_each(|(to, cell)| *to = u8::from(!(self.blocks)(cell)));
        }
    }
}

/// Fills the rows of a plane, with room for what is known of a row's cells before their lengths.
#[derive(Default)]
struct RowFiller {
    /// The lengths so far, but for those of 1; then the two behind the row, of which the grid's border has but one.
    covered: Vec<u8>,
    /// As many, of the next step.
    shortened: Vec<u8>,
}

impl RowFiller {
    /// Fills the first `count` cells of a row from what is behind them and the row `done` across; so far, they are 0 where they
    /// block and something else where they do not.
    ///
    /// A dynamic programme: a box two longer and one broader is covered by its first two cells and the boxes two along, one
    /// across, and both. Only the box two along is of the same row.
    fn fill(&mut self, line: &mut [u8], done: &[u8], count: usize) {
        // Boxes of length 1 two apart leave the cell between them.
        let covering = |length: u8| if length == 1 { 0 } else { length };
        let across = done.iter().zip(&done[2..]).map(|(&near, &far)| covering(near).min(covering(far)).min(LONGEST - 2) + 2);
        let is_free = line[..count].iter().zip(&line[1..]).map(|(&here, &next)| here != 0 && next != 0);
        self.covered.clear();
        // At the grid's edge the row across is a cell short, and the 0 of the border stands in for that of the last cell.
        self.covered.extend(across.zip(is_free).map(|(length, is_free)| if is_free { length } else { 0 }));
        self.covered.extend(line[count..].iter().take(2).map(|&length| covering(length)));
        // A box is at most two longer than the one two along, which holds for all in a row as soon as it does for those two, four,
        // eight and so on along; each such step is done for many cells at once, whereas one after the other would wait.
        debug_assert!(self.covered.len() >= count, "a row lacks cells behind it or across");
        self.shortened.resize(self.covered.len(), 0);
        let cells = self.covered.len();
        for along in [2, 4, 8, 16, 32, 64, 128].into_iter().take_while(|&along| along < cells) {
            let (near, end) = self.shortened.split_at_mut(cells - along);
            for ((to, &here), &there) in near.iter_mut().zip(&self.covered).zip(self.covered.iter().skip(along)) {
                *to = here.min(there.saturating_add(along as u8));
            }
            end.copy_from_slice(&self.covered[near.len()..]);
            std::mem::swap(&mut self.covered, &mut self.shortened);
        }
        for (length, &covered) in line[..count].iter_mut().zip(&self.covered) {
            // What blocks has length 0, and what is free before what blocks has 1.
            *length = covered.max((*length).min(1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use rand::Rng;

    /// Sector, cell, and the length found there, of all cells and sectors.
    fn boxes(free_boxes: &FreeBoxes) -> impl Iterator<Item = (Sector, (i32, i32), i32)> {
        let cells =
            (0..free_boxes.height() as i32).flat_map(|row| (0..free_boxes.width() as i32).map(move |col| (col, row)));
        cells.flat_map(move |(col, row)| {
            Sector::all().map(move |sector| (sector, (col, row), free_boxes.length(col, row, sector)))
        })
    }

    /// Whether a box has a blocking cell or reaches off the grid.
    fn is_blocked(blocking: &[bool], width: usize, (col, row): (i32, i32), sector: Sector, length: i32) -> bool {
        let (cols, rows) = sector.order(length, breadth(length));
        let height = blocking.len() / width;
        (0..rows).flat_map(|up| (0..cols).map(move |along| (along, up))).any(|(along, up)| {
            let col = col + if sector.x().is_on() { -along } else { along };
            let row = row + if sector.y().is_on() { -up } else { up };
            let on_grid = (0..width as i32).contains(&col) && (0..height as i32).contains(&row);
            !on_grid || blocking[row as usize * width + col as usize]
        })
    }

    #[test]
    fn boxes_are_free_and_all_but_as_long_as_can_be() {
        let mut stream = random::stream(1, 0);
        for (width, height, one_in) in [(1, 1, 2), (1, 9, 4), (13, 1, 4), (17, 12, 3), (23, 31, 20), (40, 25, 400)] {
            let blocking: Vec<bool> = (0..width * height).map(|_| stream.next_u64().is_multiple_of(one_in)).collect();
            let free_boxes = FreeBoxes::new(&blocking, width, Some(1), |blocks| *blocks);
            for (sector, cell, length) in boxes(&free_boxes) {
                let blocked = |length| is_blocked(&blocking, width, cell, sector, length);
                assert!(!blocked(length), "{width}x{height} {cell:?} {sector:?}: {length} is too long");
                assert!(blocked(length + 2), "{width}x{height} {cell:?} {sector:?}: {length} is too short");
                assert_eq!(length == 0, blocked(1), "{width}x{height} {cell:?} {sector:?}");
            }
        }
    }

    #[test]
    fn steps_along_come_to_what_one_cell_after_the_other_does() {
        let mut stream = random::stream(3, 0);
        let mut below = |bound: u64| (stream.next_u64() % bound) as u8;
        let covering = |length: &u8| if *length == 1 { 0 } else { *length };
        for count in (1..70).chain(500..570) {
            for behind in 1..4 {
                let mut done: Vec<u8> = (0..count + behind).map(|_| 255 - below(40)).collect();
                let mut line: Vec<u8> = (0..count + behind).map(|_| below(255).min(1)).collect();
                line[count..].fill_with(|| below(255));
                if behind == 1 {
                    (done[count], line[count]) = (0, 0);
                }
                let mut expected = line.clone();
                for cell in (0..count).rev() {
                    let ahead = [done.get(cell), done.get(cell + 2), expected.get(cell + 2)];
                    let least = ahead.map(|length| length.map_or(0, covering)).into_iter().fold(LONGEST - 2, u8::min);
                    expected[cell] = if line[cell] != 0 && line[cell + 1] != 0 { least + 2 } else { line[cell] };
                }
                RowFiller::default().fill(&mut line, &done, count);
                assert_eq!(line, expected, "{count} cells, {behind} behind");
            }
        }
    }

    #[test]
    fn lengths_stop_at_what_a_byte_holds() {
        let free_boxes = FreeBoxes::new(&[(); 90_000], 300, Some(1), |()| false);
        for sector in Sector::all() {
            let corner = |back: bool| if back { 299 } else { 0 };
            assert_eq!(
                free_boxes.length(corner(sector.x().is_on()), corner(sector.y().is_on()), sector),
                i32::from(LONGEST)
            );
            assert_eq!(free_boxes.length(corner(!sector.x().is_on()), corner(!sector.y().is_on()), sector), 1);
        }
    }

    #[test]
    fn the_border_stops_every_sector() {
        let free_boxes = FreeBoxes::new(&[(); 6], 3, Some(1), |()| false);
        for (col, row) in [(-1, 0), (3, 1), (0, -1), (2, 2), (-1, -1), (3, 2)] {
            for sector in Sector::all() {
                assert_eq!(free_boxes.length(col, row, sector), 0);
            }
        }
    }

    #[test]
    fn an_update_is_as_good_as_a_new_start() {
        let mut stream = random::stream(2, 0);
        let mut below = |count: usize| stream.next_u64() as usize % count;
        for (width, height, one_in) in [(1, 1, 2), (1, 700, 300), (700, 1, 300), (40, 30, 9), (400, 300, 20_000)] {
            let mut blocking: Vec<bool> = (0..width * height).map(|_| below(one_in) == 0).collect();
            let mut free_boxes = FreeBoxes::new(&blocking, width, Some(1), |blocks| *blocks);
            for _ in 0..20 {
                let (col, row) = (below(width), below(height));
                let region = (col..col + 1 + below(width - col), row..row + 1 + below(height - row));
                for row in region.1.clone() {
                    blocking[row * width..][region.0.clone()].fill_with(|| below(one_in) == 0);
                }
                free_boxes.update(&blocking, region.clone(), |blocks| *blocks);
                let anew = FreeBoxes::new(&blocking, width, Some(2), |blocks| *blocks);
                assert!(free_boxes.lengths() == anew.lengths(), "{width}x{height} {region:?}");
            }
        }
    }
}
