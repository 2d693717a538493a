//! Dense scans: beams so close together that most of them end where their neighbours end.
//!
//! ```text
//! march every n-th beam
//! while there are beams between those that have been marched:
//!     for each gap between two of them:
//!         if they end in one run of wall, the beams between them do too
//!         else march the one in the middle, from where it leaves the free cells that both have crossed
//! compute the distances of all beams, each from its own direction
//! ```
//!
//! [`gaps`](super::gaps) shows why this is exact.

use std::mem::{swap, take};
use std::{iter, slice};

use super::gaps::{Ends, Gaps, unpack};
use super::lanes::{Lanes, Work};
use super::march::{March, SendDistances};
use crate::free_boxes::FreeBoxes;
use crate::numeric::{GROUP, Group};
use crate::raycast::block::{BLOCK, Block};
use crate::raycast::coarse::CoarseBeams;
use crate::raycast::fans::Fans;
use crate::raycast::sink::Sink;
use crate::raycast::source::{RayGroup, Source};
use crate::raycast::track::distance;

/// Buffers for the beams of a dense scan.
#[derive(Default)]
pub struct Dense {
    /// For each beam: the cell to compute its distance from.
    cells: Vec<i32>,
    /// The beams at the ends of gaps.
    ends: Ends,
    /// Those of the next round.
    next: Ends,
    gaps: Gaps,
    /// Where the beams end that were marched last.
    found: Ends,
    chosen: Chosen,
}

/// Beams to march.
#[derive(Default)]
struct Chosen {
    beam: Vec<u32>,
    cos: Vec<Group>,
    sin: Vec<Group>,
    /// Column in which each may start.
    column: Vec<i32>,
}

/// Casts each fan; see [`march::cast`](super::march::cast).
pub fn cast<L: Lanes>(
    lanes: L,
    free_boxes: &FreeBoxes,
    (fans, coarse): (Fans<'_>, &CoarseBeams),
    limit: f32,
    (block, dense): (&mut Block, &mut Dense),
    sink: &mut impl Sink,
) {
    let groups = fans.count.div_ceil(GROUP);
    for fan in 0..fans.starts.len() {
        Scan { lanes, free_boxes, fans, fan, limit, block, dense }.find_cells(coarse);
        for first in (0..groups).step_by(BLOCK / GROUP) {
            let distances = &mut block.distances[..(groups - first).min(BLOCK / GROUP)];
            lanes.with_features(Measure { free_boxes, fans, fan, first, cells: &dense.cells, distances });
            lanes.with_features(SendDistances { first_group: fan * groups + first, distances, sink });
        }
    }
}

/// One scan.
struct Scan<'a, L> {
    lanes: L,
    free_boxes: &'a FreeBoxes,
    fans: Fans<'a>,
    fan: usize,
    limit: f32,
    block: &'a mut Block,
    dense: &'a mut Dense,
}

impl<L: Lanes> Scan<'_, L> {
    /// Finds the cell of each beam.
    fn find_cells(&mut self, coarse: &CoarseBeams) {
        let Self { lanes, free_boxes, fans, limit, .. } = *self;
        self.dense.cells.resize(fans.count.div_ceil(GROUP) * GROUP, 0);
        self.march(&coarse.cos, &coarse.sin, coarse.count, &[]);
        self.dense.start_gaps(coarse.step, fans.count);
        let mut step = coarse.step;
        while step > 1 {
            let apart = ((1.0 - 1e-5) / (coarse.spacing * step as f64).tan()) as f32;
            lanes.with_features(Judge { free_boxes, fans, step, apart, limit, dense: self.dense });
            let chosen = take(&mut self.dense.chosen);
            self.march(&chosen.cos, &chosen.sin, chosen.beam.len(), &chosen.column);
            self.dense.chosen = chosen;
            self.dense.split_gaps(step);
            step /= 2;
        }
    }

    /// Finds the ends of the first `count` beams with these directions. They start in these columns, if any.
    fn march(&mut self, cos: &[Group], sin: &[Group], count: usize, columns: &[i32]) {
        let found = &mut self.dense.found;
        found.clear();
        let starts = slice::from_ref(&self.fans.starts[self.fan]);
        let source = Fans { starts, cos, sin, count, coarse: None };
        for first in (0..count).step_by(BLOCK) {
            let rays_per_fan = (count - first).min(BLOCK);
            let columns = columns.get(first..first + rays_per_fan).unwrap_or_default();
            let (lanes, free_boxes, limit, first_group) = (self.lanes, self.free_boxes, self.limit, first / GROUP);
            let march = March { lanes, free_boxes, source, first_group, rays_per_fan, limit };
            self.lanes.with_features(Advance { march, block: self.block, columns, found });
        }
    }
}

/// Moves the rays of a block to their ends.
struct Advance<'a, L> {
    march: March<'a, L, Fans<'a>>,
    block: &'a mut Block,
    columns: &'a [i32],
    found: &'a mut Ends,
}

impl<L: Lanes> Work for Advance<'_, L> {
    #[inline(always)]
    fn run(self) {
        let Self { march, block, columns, found } = self;
        let count = march.fill(block);
        found.base.extend_from_slice(&block.base[..count]);
        march.start_in(block, columns);
        march.run(block, count);
        found.cell.extend_from_slice(&block.cells[..count]);
    }
}

/// Judges gaps of `step` beams, and chooses the beams to march in those that are open.
struct Judge<'a> {
    free_boxes: &'a FreeBoxes,
    fans: Fans<'a>,
    step: usize,
    apart: f32,
    limit: f32,
    dense: &'a mut Dense,
}

impl Work for Judge<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { free_boxes, fans, step, apart, limit, dense } = self;
        let Dense { cells, ends, gaps, chosen, .. } = dense;
        chosen.beam.clear();
        chosen.column.clear();
        if ends.beam.is_empty() {
            gaps.clear();
            return;
        }
        gaps.judge(free_boxes, ends, step, apart, limit);
        match step {
            2 => spread::<2>(cells, ends, gaps),
            4 => spread::<4>(cells, ends, gaps),
            8 => spread::<8>(cells, ends, gaps),
            16 => spread::<16>(cells, ends, gaps),
            _ => spread::<32>(cells, ends, gaps),
        }
        chosen.beam.extend(gaps.open.iter().map(|&gap| ends.beam[gap as usize] + step as u32 / 2));
        chosen.column.extend(gaps.open.iter().map(|&gap| gaps.column[gap as usize]));
        for &gap in &gaps.hopeless {
            chosen.beam.extend(ends.beam[gap as usize] + 1..ends.beam[gap as usize + 1]);
            chosen.column.extend(iter::repeat_n(gaps.column[gap as usize], step - 1));
        }
        let groups = chosen.beam.len().div_ceil(GROUP);
        if chosen.cos.len() < groups {
            chosen.cos.resize(groups, [1.0; GROUP]);
            chosen.sin.resize(groups, [0.0; GROUP]);
        }
        let (cos, sin) = (fans.cos.as_flattened(), fans.sin.as_flattened());
        let to = chosen.cos.as_flattened_mut().iter_mut().zip(chosen.sin.as_flattened_mut());
        for (to, &beam) in to.zip(&chosen.beam) {
            (*to.0, *to.1) = (cos[beam as usize], sin[beam as usize]);
        }
    }
}

/// Writes the cells of all beams in gaps of `STEP` beams. Those of open gaps are overwritten later.
#[inline(always)]
fn spread<const STEP: usize>(cells: &mut [i32], ends: &Ends, gaps: &Gaps) {
    for ((beams, &end), &cell) in ends.beam.windows(2).zip(&ends.cell).zip(&gaps.cell) {
        if beams[1] - beams[0] == STEP as u32 {
            let to: &mut [i32; STEP] = cells[beams[0] as usize..].first_chunk_mut().expect("a gap within the scan");
            *to = [cell; STEP];
            to[0] = end;
        }
    }
}

impl Dense {
    /// Makes the gaps between coarse beams that were marched.
    fn start_gaps(&mut self, step: usize, count: usize) {
        let Self { cells, found, ends, .. } = self;
        let last = (count - 1) / step;
        // The beams after the last gap.
        cells[last * step..count].copy_from_slice(&found.cell[last..]);
        found.cell.truncate(last + 1);
        found.base.truncate(last + 1);
        found.beam.extend((0..=last as u32).map(|nth| nth * step as u32));
        swap(ends, found);
    }

    /// Takes the ends of the beams that were marched, and splits each open gap of `step` beams at the beam in its middle.
    fn split_gaps(&mut self, step: usize) {
        let Self { cells, ends, next, gaps, found, chosen } = self;
        for (&beam, &cell) in chosen.beam.iter().zip(&found.cell) {
            cells[beam as usize] = cell;
        }
        next.clear();
        if step > 2 {
            found.beam.extend_from_slice(&chosen.beam[..gaps.open.len()]);
            let mut last = None;
            for (nth, &gap) in gaps.open.iter().enumerate() {
                if last != Some(gap) {
                    next.push(ends, gap as usize);
                }
                next.push(found, nth);
                next.push(ends, gap as usize + 1);
                last = Some(gap + 1);
            }
        }
        swap(ends, next);
    }
}

/// Computes the distances of groups of beams, from `first` on.
struct Measure<'a> {
    free_boxes: &'a FreeBoxes,
    fans: Fans<'a>,
    fan: usize,
    first: usize,
    cells: &'a [i32],
    distances: &'a mut [Group],
}

impl Work for Measure<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { free_boxes, fans, fan, first, cells, distances } = self;
        for ((group, distances), cells) in (first..).zip(distances).zip(cells[first * GROUP..].chunks_exact(GROUP)) {
            let rays = fans.group(fan, group);
            for (slot, (found, &cell)) in distances.iter_mut().zip(cells).enumerate() {
                *found = distance(free_boxes, &rays.ray(slot), unpack(cell));
            }
        }
    }
}
