//! Gaps: what two beams of a scan tell about the beams between them.
//!
//! A and B are beams of one scan in one sector, and C is a beam between them; A is the one with the smaller slope. All move up the
//! axes of their sector, from the same origin in cell (0, 0). Row and column mean the cell along the minor and the major axis.
//!
//! 1. **Order.** The plain traversal crosses the line of a row before that of a column if the computed distance to it is smaller (or
//!    equal, in half of the sectors). A distance is a difference, which is the same number for all beams, times the computed inverse
//!    of a component of the direction. From A to B, the computed components have the right order: neighbours differ by far more than
//!    rounding (`CoarseBeams` sees to it). Division and multiplication keep an order when they round. So a row that A crosses
//!    before a column, C crosses before that column too, and what C does, B does. When they enter a column, the row of C is
//!    between those of A and B.
//! 2. **Free.** If A and B are less than one cell apart at the line of each column up to the column `m`, their rows there differ by at
//!    most 1, so C is in the row of one of them. Then A or B visits each cell that C visits before column `m`. If neither A nor B
//!    ends before column `m`, C does not either.
//! 3. **End.** Let A and B end in cells with the smaller column `m` and the smaller row `r`, and be less than a cell apart up to the
//!    line behind column `m`. Then the distance of C is the one that [`distance`](crate::raycast::track::distance) computes for
//!    cell `(m, r)`, in these cases:
//!    - *They end in column `m`, in one row or in neighbouring ones.* If it is one cell, C ends there: when C leaves the column, it is
//!      in that row or above, as A is. Else B ends in row `r + 1`. It entered from the column before, because A ends in the cell below.
//!      So A did too, as they are close, and C enters column `m` between them, in one of two blocking cells. The farther of the two
//!      sides at which a ray enters cell `(m, r)` is then that of the column.
//!    - *They end in row `r`, and all cells of the row from one end to the other block.* B ends first, in column `m`. A enters its
//!      last cell from below, because the cell before it blocks. Behind column `m`, A is in the row below `r`, as it is close to B, so
//!      the cells there are free. Before it crosses into row `r`, C is in free cells, and then its cell blocks. If C crosses
//!      there, the line of the row is the farther side of cell `(m, r)`, and if it enters cell `(m, r)` from the column
//!      before, the line of the column is.
//!    - *Column `m` is beyond the limit.* C ends there or later, so its distance is beyond the limit, too.
//!
//! A cell off the grid counts as blocking here: its length is 0, and `distance` is infinite for it.

use crate::free_boxes::FreeBoxes;

/// Where some beams of a scan end, in the order of the beams.
#[derive(Default)]
pub struct Ends {
    pub beam: Vec<u32>,
    /// The last cell, as in [`Block::cells`](crate::raycast::block::Block::cells).
    pub cell: Vec<i32>,
    /// As in [`Block::base`](crate::raycast::block::Block::base). It is different in each sector.
    pub base: Vec<i32>,
}

impl Ends {
    pub fn clear(&mut self) {
        self.beam.clear();
        self.cell.clear();
        self.base.clear();
    }

    /// Adds an end of another list.
    pub fn push(&mut self, from: &Self, nth: usize) {
        self.beam.push(from.beam[nth]);
        self.cell.push(from.cell[nth]);
        self.base.push(from.base[nth]);
    }
}

/// What is known about the beams between two successive ends.
#[derive(Default)]
pub struct Gaps {
    /// If the distances are known: the cell to compute them from.
    pub cell: Vec<i32>,
    /// Else: the column before which the beams are free, which a ray may start in.
    pub column: Vec<i32>,
    /// Columns within which two beams stay closer than a cell.
    pub reach: Vec<i32>,
    /// Indices of the gaps whose distances are not known, in order.
    pub open: Vec<u32>,
    /// The same, of gaps in which no two beams with one between them stay closer than a cell.
    pub hopeless: Vec<u32>,
}

/// Value of [`Gaps::column`] if the distances are known. From `MAYBE` down: they are if the cells of a row block.
const KNOWN: i32 = -1;
const MAYBE: i32 = -2;

/// Returns the column and the row of a packed cell.
#[inline(always)]
pub fn unpack(cell: i32) -> (i32, i32) {
    (cell & 0xffff, (cell as u32 >> 16) as i32)
}

impl Gaps {
    /// Forgets all open gaps.
    pub fn clear(&mut self) {
        self.open.clear();
        self.hopeless.clear();
    }

    /// Judges the gaps of `step` beams between successive ends. Other pairs of ends count as known.
    ///
    /// `apart` is the number of cells after which beams that far apart, along an axis, have come one cell apart.
    #[inline(always)]
    pub fn judge(&mut self, free_boxes: &FreeBoxes, ends: &Ends, step: usize, apart: f32, limit: f32) {
        let count = ends.beam.len() - 1;
        for column in [&mut self.cell, &mut self.column, &mut self.reach] {
            column.resize(count, 0);
        }
        // Slices of one length, so that the compiler leaves out the bounds checks and uses vectors.
        let (beam_a, beam_b) = (&ends.beam[..count], &ends.beam[1..=count]);
        let (cell_a, cell_b) = (&ends.cell[..count], &ends.cell[1..=count]);
        let (base_a, base_b) = (&ends.base[..count], &ends.base[1..=count]);
        let (cell, column, reaches) = (&mut self.cell[..count], &mut self.column[..count], &mut self.reach[..count]);
        for gap in 0..count {
            let (a, b) = (unpack(cell_a[gap]), unpack(cell_b[gap]));
            let (m, r) = (a.0.min(b.0), a.1.min(b.1));
            let is_sector = base_a[gap] == base_b[gap];
            // At the line of column x they are less than x · tan(angle) · (1 + slope²) apart, for the larger slope, at most 1.
            let slope = |(column, row): (i32, i32)| (row + 1) as f32 / (column - 1).max(1) as f32;
            let (slope_a, slope_b) = (slope(a), slope(b));
            let slope = if slope_a > slope_b { slope_a } else { slope_b };
            let slope = if slope < 1.0 { slope } else { 1.0 };
            let reach = apart / (1.0 + slope * slope);
            let reach = if reach < 65_536.0 { reach } else { 65_536.0 };
            // Rounds to a whole number, half a cell lower: a conversion would not become a vector instruction.
            let reach = ((reach + (8_388_608.0 - 0.5)).to_bits() & 0x7f_ffff) as i32;
            let is_near = is_sector & (m + 1 < reach);
            let in_row = is_near & (a.1 == b.1);
            let is_known = (is_near & (a.0 == b.0) & ((a.1 - b.1).abs() <= 1))
                | (in_row & ((a.0 - b.0).abs() <= 1))
                | (is_near & (m as f32 > limit + 1.0))
                | (beam_b[gap] - beam_a[gap] != step as u32);
            let start = if is_sector { m.min(reach) } else { 0 };
            let start = if in_row { MAYBE - m } else { start };
            column[gap] = if is_known { KNOWN } else { start };
            reaches[gap] = reach;
            cell[gap] = m | r << 16;
        }
        self.list_open(free_boxes, ends, step);
    }

    /// Lists the gaps that are not known, after a look at the cells of rows.
    #[inline(always)]
    fn list_open(&mut self, free_boxes: &FreeBoxes, ends: &Ends, step: usize) {
        let count = self.column.len();
        self.hopeless.clear();
        self.open.resize(count, 0);
        let mut found = 0;
        for gap in 0..count {
            self.open[found] = gap as u32;
            found += usize::from(self.column[gap] != KNOWN);
        }
        let mut open = 0;
        for nth in 0..found {
            let gap = self.open[nth] as usize;
            if self.column[gap] <= MAYBE {
                self.column[gap] = MAYBE - self.column[gap];
                if is_wall(free_boxes, ends.base[gap], ends.cell[gap], ends.cell[gap + 1]) {
                    continue;
                }
            }
            let is_hopeless = step > 2 && self.reach[gap] * (step as i32 / 2) <= self.cell[gap] & 0xffff;
            if is_hopeless && self.column[gap] > 0 {
                self.hopeless.push(gap as u32);
                continue;
            }
            self.open[open] = gap as u32;
            open += 1;
        }
        self.open.truncate(open);
    }
}

/// Returns true if all cells between two different ones of a row have length 0.
#[inline(always)]
fn is_wall(free_boxes: &FreeBoxes, base: i32, a: i32, b: i32) -> bool {
    let ((a, row), (b, _)) = (unpack(a), unpack(b));
    let is_steep = base as usize >= 4 * free_boxes.plane();
    let stride = 2 + if is_steep { free_boxes.height() } else { free_boxes.width() };
    // The base is the index of cell (1, 1) here.
    let index = |column: i32| (base + column - 1) as usize + row as usize * stride - stride;
    free_boxes.codes()[index(a.min(b)) + 1..index(a.max(b))].iter().all(|&code| code == 0)
}
