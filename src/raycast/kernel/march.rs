//! The march: the jump loop over vectors of rays, for any instruction set.
//!
//! ```text
//! for each block of up to 1088 rays:
//!     put each ray into its first cell
//!     while rays are active, in passes over the block:
//!         for each 2 or 3 vectors of active rays, a few steps side by side:
//!             code = free_boxes[cell]                         0 ends the ray: a wall or the border
//!             lines = cell + (length, breadth)                the two far sides of the free box
//!             cell = the cell behind the line crossed first   in float32, or exactly near a corner
//!             end the ray if its cell is beyond the limit
//!         note the cells of the rays that have ended, move the active rays up to the front
//!     compute the distance of each ray to its last cell       exactly, in float64
//!     send the distances to the sink
//! ```
//!
//! Rays end at different times. Moving the active rays to the front after every pass keeps all lanes busy. Within a pass, a
//! vector does not wait for the others.
//!
//! A step in float32 finds the right cell unless the ray passes near a corner of a cell; [`TIE_PER_CELL`] bounds the
//! rounding errors. Near a corner, [`Track::step`] decides in float64. So the last cell of each ray is exact. The distance
//! of a ray is computed once, from its last cell.

use super::dense::{self, Dense};
use super::lanes::{Lanes, Work};
use crate::free_boxes::{FreeBoxes, Sector};
use crate::numeric::{GROUP, Group};
use crate::prefetch::{LINE, prefetch};
use crate::raycast::Ray;
use crate::raycast::block::{Axis32, BLOCK, Block};
use crate::raycast::sink::Sink;
use crate::raycast::source::{RayGroup, Source};
use crate::raycast::track::{Track, distance};

/// Bound on the error of a crossing computed in float32 \[cells\], for each cell moved along the major axis. A crossing that
/// is nearer than its bound to a grid line is a tie, which float64 decides.
///
/// A computed crossing is off by at most 7 rounding errors, each of 2⁻²⁴ of the distance moved: 3 in the slope, 1 in the
/// start of the ray within its first cell, and 1 each in a product, a difference and a sum. If rounding swaps the order of
/// the two far lines, the errors of both crossings add up, to less than 16 · 2⁻²⁴ = 2⁻²⁰ of the distance. The bound is twice
/// as large, for safety.
///
/// A crossing that is NaN counts as a tie too. It comes from 0 · ∞: the ray starts on a grid line, and its component across
/// this line is 0 in float32.
const TIE_PER_CELL: f32 = 1.0 / 524_288.0;

/// Constant part of the same bound \[cells\].
///
/// It covers two errors with a wide margin: the rounding of the start within the first cell (2⁻²⁴ along each axis), and the
/// error from the distance moved in the first cell, which is not counted above.
const TIE: f32 = 1.0 / 262_144.0;

/// Number of cache lines of upcoming rays that are prefetched for each group of vectors.
///
/// With this number, most lines are in the cache after one pass over a block, and all after a second pass with half of the
/// rays. The prefetches do not delay other reads.
const LINES_PER_PREFETCH: usize = 12;

/// If the free boxes have more bytes than this, they are assumed not to be in a cache.
const UNCACHED: usize = 1 << 24;

/// Sends each group's hit distances \[cells\] to the sink, fan by fan; infinite if a ray hits nothing. Beyond `limit` the
/// value is unspecified but larger than it.
pub fn cast<L: Lanes, S: Source>(
    lanes: L,
    free_boxes: &FreeBoxes,
    source: S,
    limit: f64,
    buffers: &mut (Box<Block>, Dense),
    sink: &mut impl Sink,
) {
    // No ray moves farther than this on the grid. The sum is below 2²⁴, so it is exact in float32.
    let limit = limit.min((free_boxes.width() + free_boxes.height()) as f64) as f32;
    let (block, dense) = buffers;
    if let Some((fans, coarse)) = source.dense().filter(|(_, coarse)| coarse.step >= L::MIN_STEP) {
        return dense::cast(lanes, free_boxes, (fans, coarse), limit, (block, dense), sink);
    }
    let (fans, groups) = (source.fans(), source.count().div_ceil(GROUP));
    assert!(fans <= 1 || fans * groups <= BLOCK / GROUP, "{fans} fans of {groups} groups do not fit into a block");
    for first_group in (0..groups).step_by(BLOCK / GROUP) {
        let rays_per_fan = (source.count() - first_group * GROUP).min(BLOCK);
        // Two functions that are not inlined: each has all registers to itself.
        lanes.with_features(Trace { march: March { lanes, free_boxes, source, first_group, rays_per_fan, limit }, block });
        let distances = &block.distances[..fans * rays_per_fan.div_ceil(GROUP)];
        lanes.with_features(SendDistances { first_group, distances, sink });
    }
}

/// Sends the distances of some groups to the sink.
pub struct SendDistances<'a, S> {
    pub first_group: usize,
    pub distances: &'a [Group],
    pub sink: &'a mut S,
}

impl<S: Sink> Work for SendDistances<'_, S> {
    #[inline(always)]
    fn run(self) {
        for (group, distances) in (self.first_group..).zip(self.distances) {
            self.sink.take(group, distances);
        }
    }
}

/// Computes the distances of the rays of a block.
struct Trace<'a, L, S> {
    march: March<'a, L, S>,
    block: &'a mut Block,
}

impl<L: Lanes, S: Source> Work for Trace<'_, L, S> {
    #[inline(always)]
    fn run(self) {
        self.march.trace(self.block);
    }
}

/// The rays of a block, and the grid that they march over.
pub struct March<'a, L, S> {
    pub lanes: L,
    pub free_boxes: &'a FreeBoxes,
    pub source: S,
    /// First group of each fan that is in the block.
    pub first_group: usize,
    /// Number of rays of each fan that are in the block.
    pub rays_per_fan: usize,
    pub limit: f32,
}

/// A vector of rays.
#[derive(Clone, Copy)]
struct Vector<L: Lanes> {
    /// Place of its first ray in the block.
    at: usize,
    /// Rays that have not ended.
    active: L::Mask,
    /// Cells of the rays along the major axis, numbered as in the block.
    major: L::Float,
    /// Cells of the rays along the minor axis.
    minor: L::Float,
}

impl<L: Lanes, S: Source> March<'_, L, S> {
    /// Puts the rays of a single fan into the block, and returns their number.
    #[inline(always)]
    pub fn fill(&self, block: &mut Block) -> usize {
        let count = self.rays_per_fan.min(BLOCK);
        for group in 0..count.div_ceil(GROUP) {
            block.set_group(self.free_boxes, &self.source.group(0, self.first_group + group), group * GROUP);
        }
        count
    }

    /// Moves the first rays of a block, which are in their first cells, to where they enter these columns along their major axis. The
    /// cells before must be free. Rays stay where they are for column 0.
    #[inline(always)]
    pub fn start_in(&self, block: &mut Block, columns: &[i32]) {
        let lanes = self.lanes;
        let all = lanes.first_lanes(L::COUNT);
        for (columns, at) in columns.chunks(L::COUNT).zip((0..).step_by(L::COUNT)) {
            let mut list = [0; 16];
            list[..columns.len()].copy_from_slice(columns);
            let column = lanes.load_int(&list, 0);
            let moved = lanes.is_positive(all, column);
            // The first cell of a ray has number -1 in the block.
            let major = lanes.to_float(all, lanes.add_int(column, lanes.splat_int(-1)));
            let across =
                lanes.multiply_add(major, lanes.load(&block.major.slope, at), lanes.load(&block.major.intercept, at));
            let near = lanes.multiply_add(major, lanes.splat(TIE_PER_CELL), lanes.splat(TIE));
            let mut ties = lanes.bits(lanes.is_not_greater(moved, lanes.distance_to_integer(across), near));
            let mut minor = [0.0; 16];
            lanes.store(&mut minor, 0, lanes.select(moved, lanes.floor(across), lanes.splat(-1.0)));
            while ties != 0 {
                let lane = ties.trailing_zeros() as usize;
                ties &= ties - 1;
                minor[lane] = (Track::new(self.free_boxes, &self.ray(at + lane)).row_in(list[lane]) - 1) as f32;
            }
            lanes.store(&mut block.major.cell, at, major);
            lanes.store(&mut block.minor.cell, at, lanes.load(&minor, 0));
        }
    }

    /// Fills the block with rays, moves them, and stores their distances.
    #[inline(always)]
    fn trace(&self, block: &mut Block) {
        let Self { free_boxes, source, first_group, rays_per_fan, .. } = *self;
        let (fans, groups) = (source.fans(), rays_per_fan.div_ceil(GROUP));
        // Each `min` leaves its number unchanged. It tells the compiler that no index is past the end of the block, so the
        // compiler leaves out the bounds checks.
        let first_place = |fan: usize, group: usize| (fan * rays_per_fan + group * GROUP).min(BLOCK);
        let count = (fans * rays_per_fan).min(BLOCK);
        for fan in 0..fans {
            for group in 0..groups {
                // The padding of a fan is overwritten by the first rays of the next one.
                block.set_group(free_boxes, &source.group(fan, first_group + group), first_place(fan, group));
            }
        }
        debug_assert!((0..count).all(|at| block.start(at) == self.first_index(at)), "a ray starts in a wrong cell");
        if !S::SHARES_START_CELLS && free_boxes.codes().len() > UNCACHED {
            (0..count).for_each(|at| prefetch(free_boxes.codes(), block.start(at)));
        }
        self.run(block, count);
        for fan in 0..fans {
            for group in 0..groups {
                let cells: &[i32; GROUP] =
                    block.cells[first_place(fan, group)..].first_chunk().expect("a block has padding at its end");
                let rays = source.group(fan, first_group + group);
                let mut distances = [0.0; GROUP];
                for (slot, found) in distances.iter_mut().enumerate() {
                    let cell = (cells[slot] & 0xffff, (cells[slot] as u32 >> 16) as i32);
                    *found = distance(free_boxes, &rays.ray(slot), cell);
                }
                block.distances[fan * groups + group] = distances;
            }
        }
    }

    /// Moves each of the first `count` rays until it enters a blocking cell, leaves the grid, or is beyond the limit.
    #[inline(always)]
    pub fn run(&self, block: &mut Block, count: usize) {
        const { assert!(L::IN_FLIGHT == 2 || L::IN_FLIGHT == 3) };
        match L::IN_FLIGHT {
            2 => self.passes::<2>(block, count),
            _ => self.passes::<3>(block, count),
        }
        for (&number, &cell) in block.ended[..count].iter().zip(&block.ended_in) {
            block.cells[number as usize] = cell;
        }
    }

    /// Passes over the first `count` rays of a block until all have ended, `IN_FLIGHT` vectors at a time.
    #[inline(always)]
    fn passes<const IN_FLIGHT: usize>(&self, block: &mut Block, count: usize) {
        let codes = self.free_boxes.codes();
        let upcoming = self.source.upcoming();
        let mut active = count;
        let (mut ended, mut prefetched) = (0, 0);
        while active > 0 {
            // The last vectors run until all of their rays have ended: no other rays could fill their free lanes.
            let steps = if active > IN_FLIGHT * L::COUNT { L::STEPS_PER_PASS } else { usize::MAX };
            let mut kept = 0;
            for at in (0..active).step_by(IN_FLIGHT * L::COUNT) {
                (prefetched..prefetched + LINES_PER_PREFETCH).for_each(|line| prefetch(upcoming, line * LINE));
                prefetched += LINES_PER_PREFETCH;
                let place = |nth: usize| at + nth * L::COUNT;
                // Not `array::from_fn`: the compiler leaves it a function, and copies the vectors through memory.
                let started = |nth: usize| self.lanes.first_lanes(active.saturating_sub(place(nth)));
                let mut vectors = [self.load(block, place(0), started(0)); IN_FLIGHT];
                for (nth, rays) in vectors.iter_mut().enumerate().skip(1) {
                    *rays = self.load(block, place(nth), started(nth));
                }
                for step in 0..steps {
                    if step >= L::STEPS_PER_PASS && vectors.iter().all(|rays| self.lanes.bits(rays.active) == 0) {
                        break;
                    }
                    // Each vector has its own name here: in a loop over the array, the compiler would keep the vectors in
                    // memory instead of registers.
                    match vectors.as_mut_slice() {
                        [a, b] => {
                            *a = self.step(codes, block, a);
                            *b = self.step(codes, block, b);
                        }
                        [a, b, c] => {
                            *a = self.step(codes, block, a);
                            *b = self.step(codes, block, b);
                            *c = self.step(codes, block, c);
                        }
                        more => more.iter_mut().for_each(|rays| *rays = self.step(codes, block, rays)),
                    }
                }
                for (nth, rays) in vectors.iter().enumerate() {
                    ended += self.store_ended(block, ended, rays, started(nth));
                    kept += self.move_up(block, kept, rays);
                }
            }
            active = kept;
        }
    }

    /// Reads a vector of rays from place `at` on.
    #[inline(always)]
    fn load(&self, block: &Block, at: usize, active: L::Mask) -> Vector<L> {
        Vector { at, active, major: self.lanes.load(&block.major.cell, at), minor: self.lanes.load(&block.minor.cell, at) }
    }

    /// Stores the numbers and cells of the rays in `started` that are no longer active, from place `to` on. Returns how many
    /// rays these are.
    #[inline(always)]
    fn store_ended(&self, block: &mut Block, to: usize, rays: &Vector<L>, started: L::Mask) -> usize {
        let lanes = self.lanes;
        let bits = lanes.bits(lanes.and_not(started, rays.active));
        // The first cell of a ray has number -1 in the block, and 0 in the result.
        let from_first = |cell| lanes.add_int(lanes.to_int(cell), lanes.splat_int(1));
        let cell = lanes.pack(from_first(rays.minor), from_first(rays.major));
        let number = lanes.load_int(&block.number, rays.at);
        let compaction = lanes.compaction(bits);
        lanes.store_int_compacted(compaction, &mut block.ended, to, number);
        lanes.store_int_compacted(compaction, &mut block.ended_in, to, cell);
        bits.count_ones() as usize
    }

    /// Moves the active rays to place `to`, which is at or before their current place. Returns how many rays these are.
    #[inline(always)]
    fn move_up(&self, block: &mut Block, to: usize, rays: &Vector<L>) -> usize {
        let lanes = self.lanes;
        let bits = lanes.bits(rays.active);
        let compaction = lanes.compaction(bits);
        for (axis, cell) in [(&mut block.major, rays.major), (&mut block.minor, rays.minor)] {
            lanes.store_compacted(compaction, &mut axis.cell, to, cell);
            for numbers in [&mut axis.slope, &mut axis.intercept] {
                let kept = lanes.load(numbers, rays.at);
                lanes.store_compacted(compaction, numbers, to, kept);
            }
        }
        for numbers in [&mut block.base, &mut block.stride, &mut block.number] {
            let kept = lanes.load_int(numbers, rays.at);
            lanes.store_int_compacted(compaction, numbers, to, kept);
        }
        bits.count_ones() as usize
    }

    /// Moves each active ray out of the free box of its cell.
    #[inline(always)]
    fn step(&self, codes: &[u8], block: &Block, rays: &Vector<L>) -> Vector<L> {
        let lanes = self.lanes;
        let row = lanes.multiply_int(lanes.to_int(rays.minor), lanes.load_int(&block.stride, rays.at));
        let in_row = lanes.add_int(lanes.to_int(rays.major), lanes.load_int(&block.base, rays.at));
        let index = lanes.add_int(row, in_row);
        debug_assert!(self.are_on_grid(rays.active, index), "a ray is past the border");
        // The bytes at 0 to 3 are border, in a grid of any width, so it does not matter which of them is read.
        let code = lanes.gather(codes, index);
        let active = lanes.is_positive(rays.active, code);

        // Rays that end here have length 0. Rays that ended before get length 0, so that they stay in their cells.
        let (length, breadth) = lanes.sides(rays.active, code);
        let (far_major, far_minor) = (lanes.add(rays.major, length), lanes.add(rays.minor, breadth));
        // Coordinates along one axis at which the ray crosses a line of the other axis.
        let crossing = |axis: &Axis32, line| {
            lanes.multiply_add(line, lanes.load(&axis.slope, rays.at), lanes.load(&axis.intercept, rays.at))
        };
        let (at_far_major, at_far_minor) = (crossing(&block.major, far_major), crossing(&block.minor, far_minor));
        let crosses_major = lanes.is_less(active, at_far_major, far_minor);
        let crosses_minor = lanes.and_not(active, crosses_major);
        let across = lanes.select(crosses_major, at_far_major, at_far_minor);
        let cell = lanes.floor(across);
        let mut major = lanes.select(crosses_minor, cell, far_major);
        let mut minor = lanes.select(crosses_major, cell, far_minor);

        let near = lanes.multiply_add(far_major, lanes.splat(TIE_PER_CELL), lanes.splat(TIE));
        let ties = lanes.bits(lanes.is_not_greater(active, lanes.distance_to_integer(across), near));
        if ties != 0 {
            (major, minor) = self.step_exactly(block, rays, length, ties, (major, minor));
        }
        debug_assert!(self.have_stayed(active, (rays.major, rays.minor), (major, minor)), "a ray has moved after its end");
        let active = lanes.is_at_most(active, major, lanes.splat(self.limit));
        Vector { at: rays.at, active, major, minor }
    }

    /// Returns the ray of the block with this number.
    #[inline(always)]
    fn ray(&self, number: usize) -> Ray {
        let (fan, number) = (number / self.rays_per_fan, number % self.rays_per_fan);
        self.source.group(fan, self.first_group + number / GROUP).ray(number % GROUP)
    }

    /// Returns the index, in the codes of the free boxes, of the first cell of a ray of the block.
    fn first_index(&self, at: usize) -> usize {
        let ray = self.ray(at);
        self.free_boxes.index(ray.col, ray.row, Sector::of(ray.direction))
    }

    /// Returns true if the rays that are not in the mask have not moved.
    fn have_stayed(&self, active: L::Mask, was: (L::Float, L::Float), is: (L::Float, L::Float)) -> bool {
        let bits = self.lanes.bits(active);
        [(was.0, is.0), (was.1, is.1)].into_iter().all(|(was, is)| {
            let mut lists = [[0.0; 16]; 2];
            self.lanes.store(&mut lists[0], 0, was);
            self.lanes.store(&mut lists[1], 0, is);
            (0..L::COUNT).all(|lane| bits >> lane & 1 != 0 || lists[0][lane] == lists[1][lane])
        })
    }

    /// Returns true if the indices of the rays in the mask are indices of free boxes.
    fn are_on_grid(&self, active: L::Mask, indices: L::Int) -> bool {
        let mut list = [0; 16];
        self.lanes.store_int(&mut list, 0, indices);
        let bits = self.lanes.bits(active);
        list.iter()
            .enumerate()
            .all(|(lane, &index)| bits >> lane & 1 == 0 || (index as u32 as usize) < self.free_boxes.codes().len())
    }

    /// Returns the cells that the rays step into: the result of the exact step for lanes in `ties`, `(major, minor)` for the
    /// others.
    #[cold]
    #[inline(always)]
    fn step_exactly(
        &self,
        block: &Block,
        rays: &Vector<L>,
        length: L::Float,
        mut ties: u32,
        (major, minor): (L::Float, L::Float),
    ) -> (L::Float, L::Float) {
        let lanes = self.lanes;
        let list = |numbers| {
            let mut list = [0.0; 16];
            lanes.store(&mut list, 0, numbers);
            list
        };
        let (now_major, now_minor, length) = (list(rays.major), list(rays.minor), list(length));
        let (mut major, mut minor) = (list(major), list(minor));
        while ties != 0 {
            let lane = ties.trailing_zeros() as usize;
            ties &= ties - 1;
            let ray = self.ray(block.number[rays.at + lane] as usize);
            // The first cell of a ray has number -1 in the block, and 0 in a track.
            let now = (now_major[lane] as i32 + 1, now_minor[lane] as i32 + 1);
            let next = Track::new(self.free_boxes, &ray).step(now, length[lane] as i32);
            major[lane] = (next.0 - 1) as f32;
            minor[lane] = (next.1 - 1) as f32;
        }
        (lanes.load(&major, 0), lanes.load(&minor, 0))
    }
}
