//! The jump loop over vectors of rays, for any instruction set.
//!
//! Rays go in passes over a block: each takes a few steps, then those that are still on their way move up next to each other, so
//! that no lane idles for long. Within a pass no vector waits for another.
//!
//! Steps are computed in float32 and are right unless the ray passes near a corner of a cell, by a bound on the rounding. There
//! the exact step of [`Track`] decides. So the cell a ray ends in is exact, and the distance to it is computed once, in float64.

use std::array::from_fn;

use super::lanes::{Lanes, Work};
use super::prefetch::{LINE, prefetch};
use crate::free_boxes::{FreeBoxes, Sector};
use crate::numeric::{GROUP, Group};
use crate::raycast::Ray;
use crate::raycast::block::{Axis32, BLOCK, Block};
use crate::raycast::sink::Sink;
use crate::raycast::source::{RayGroup, Source};
use crate::raycast::track::{Track, distance};

/// A crossing this near to a grid line, by the way along the major axis, has to be decided exactly.
///
/// Where a line is crossed is off by at most 7 roundings, each of 2⁻²⁴ of that way: 3 of the slope, one of where the ray starts in
/// its first cell, and one each of a product, a difference and a sum. If the wrong one of two lines is taken for the first, the
/// errors of both add up, to less than 16 · 2⁻²⁴ = 2⁻²⁰ of the way; twice that is on the safe side. What is no number, as 0 · ∞ is
/// where a ray runs along a grid line but for less than float32 can tell, has to be decided exactly, too.
const TIE_BY_WAY: f32 = 1.0 / 524_288.0;

/// And by the rounding of where the ray starts in its first cell, 2⁻²⁴ along each axis, with much to spare: the way through that
/// cell counts, too.
const TIE: f32 = 1.0 / 262_144.0;

/// Cache lines of upcoming rays that are fetched at a time: so many that most of them are there after one pass over a block and all
/// of them after a second, if that has half the rays; and so few that nothing else has to wait for memory.
const FETCHED: usize = 12;

/// Bytes of boxes from which on they are taken not to be in a cache.
const BEYOND_CACHES: usize = 1 << 24;

/// Hands over, group by group, the distances from the origins of rays to the boundaries by which they enter blocking cells,
/// infinite if there is none; those beyond `limit` are anything beyond it. In cells.
pub fn cast<L: Lanes, S: Source>(
    lanes: L,
    free_boxes: &FreeBoxes,
    source: S,
    limit: f64,
    block: &mut Block,
    sink: &mut impl Sink,
) {
    // No ray goes farther than this on the grid, and float32 tells it apart from a cell less.
    let limit = limit.min((free_boxes.width() + free_boxes.height()) as f64) as f32;
    let (fans, groups) = (source.fans(), source.count().div_ceil(GROUP));
    assert!(fans <= 1 || fans * groups <= BLOCK / GROUP, "{fans} fans of {groups} groups do not fit into a block");
    for first_group in (0..groups).step_by(BLOCK / GROUP) {
        let each = (source.count() - first_group * GROUP).min(BLOCK);
        // One after the other, each function has the registers to itself.
        lanes.with_features(Trace { march: March { lanes, free_boxes, source, first_group, each, limit }, block });
        let distances = &block.distances[..fans * each.div_ceil(GROUP)];
        lanes.with_features(HandOver { first_group, distances, sink });
    }
}

/// Hands over the distances of some groups.
struct HandOver<'a, S> {
    first_group: usize,
    distances: &'a [Group],
    sink: &'a mut S,
}

impl<S: Sink> Work for HandOver<'_, S> {
    #[inline(always)]
    fn run(self) {
        for (group, distances) in (self.first_group..).zip(self.distances) {
            self.sink.take(group, distances);
        }
    }
}

/// Finds out how far the rays of a block come.
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

/// What the rays of a block march over.
struct March<'a, L, S> {
    lanes: L,
    free_boxes: &'a FreeBoxes,
    source: S,
    /// The first group of each fan that is in the block.
    first_group: usize,
    /// Rays of each fan that are.
    each: usize,
    limit: f32,
}

/// A vector of rays on their way.
struct Rays<L: Lanes> {
    /// Place in the block of the first of them.
    at: usize,
    /// Those that have not ended.
    active: L::Mask,
    /// The cells they are in, as the block counts them.
    major: L::Float,
    minor: L::Float,
}

impl<L: Lanes, S: Source> March<'_, L, S> {
    /// Aims the rays of a block, moves them, and writes down how far they came.
    #[inline(always)]
    fn trace(&self, block: &mut Block) {
        let Self { free_boxes, source, first_group, each, .. } = *self;
        let (fans, groups) = (source.fans(), each.div_ceil(GROUP));
        // What is no more than a block, which the compiler has to see to do without checks.
        let begin = |fan: usize, group: usize| (fan * each + group * GROUP).min(BLOCK);
        let count = (fans * each).min(BLOCK);
        for fan in 0..fans {
            for group in 0..groups {
                // Behind the last ray of a fan comes the first one of the next.
                block.set_group(free_boxes, &source.group(fan, first_group + group), begin(fan, group));
            }
        }
        debug_assert!((0..count).all(|at| block.start(at) == self.first_place(at)), "a ray does not start where it does");
        if !S::SHARES_START_CELLS && free_boxes.lengths().len() > BEYOND_CACHES {
            (0..count).for_each(|at| prefetch(free_boxes.lengths(), block.start(at)));
        }
        self.run(block, count);
        for fan in 0..fans {
            for group in 0..groups {
                let cells: &[i32; GROUP] =
                    block.cells[begin(fan, group)..].first_chunk().expect("a block has room behind it");
                let rays = source.group(fan, first_group + group);
                let mut distances = [0.0; GROUP];
                for (place, found) in distances.iter_mut().enumerate() {
                    let cell = (cells[place] & 0xffff, (cells[place] as u32 >> 16) as i32);
                    *found = distance(free_boxes, &rays.ray(place), cell);
                }
                block.distances[fan * groups + group] = distances;
            }
        }
    }

    /// Moves each of the first `count` rays to the blocking cell it hits, or off the grid, or beyond the limit.
    #[inline(always)]
    fn run(&self, block: &mut Block, count: usize) {
        const { assert!(L::IN_FLIGHT == 2 || L::IN_FLIGHT == 3) };
        match L::IN_FLIGHT {
            2 => self.passes::<2>(block, count),
            _ => self.passes::<3>(block, count),
        }
        for (&number, &cell) in block.ended[..count].iter().zip(&block.ended_in) {
            block.cells[number as usize] = cell;
        }
    }

    /// Passes over the first rays of a block with so many vectors in flight, until all have ended.
    #[inline(always)]
    fn passes<const IN_FLIGHT: usize>(&self, block: &mut Block, count: usize) {
        let lengths = self.free_boxes.lengths();
        let upcoming = self.source.upcoming();
        let mut rest = count;
        let (mut ended, mut fetched) = (0, 0);
        while rest > 0 {
            // The last ones are not worth moving up.
            let steps = if rest > IN_FLIGHT * L::COUNT { L::STEPS } else { usize::MAX };
            let mut kept = 0;
            for at in (0..rest).step_by(IN_FLIGHT * L::COUNT) {
                (fetched..fetched + FETCHED).for_each(|line| prefetch(upcoming, line * LINE));
                fetched += FETCHED;
                let place = |nth: usize| at + nth * L::COUNT;
                let begun: [L::Mask; IN_FLIGHT] = from_fn(|nth| self.lanes.first(rest.saturating_sub(place(nth))));
                let mut all: [Rays<L>; IN_FLIGHT] = from_fn(|nth| self.load(block, place(nth), begun[nth]));
                for step in 0..steps {
                    if step >= L::STEPS && all.iter().all(|rays| self.lanes.bits(rays.active) == 0) {
                        break;
                    }
                    // By name, as what loops count through is kept in memory.
                    match all.as_mut_slice() {
                        [a, b] => {
                            *a = self.step(lengths, block, a);
                            *b = self.step(lengths, block, b);
                        }
                        [a, b, c] => {
                            *a = self.step(lengths, block, a);
                            *b = self.step(lengths, block, b);
                            *c = self.step(lengths, block, c);
                        }
                        more => more.iter_mut().for_each(|rays| *rays = self.step(lengths, block, rays)),
                    }
                }
                for nth in 0..IN_FLIGHT {
                    ended += self.end(block, ended, &all[nth], begun[nth]);
                    kept += self.keep(block, kept, &all[nth]);
                }
            }
            rest = kept;
        }
    }

    #[inline(always)]
    fn load(&self, block: &Block, at: usize, active: L::Mask) -> Rays<L> {
        Rays { at, active, major: self.lanes.load(&block.major.cell, at), minor: self.lanes.load(&block.minor.cell, at) }
    }

    /// Writes down from place `to` on where the rays ended that did, of those that had begun; returns their number.
    #[inline(always)]
    fn end(&self, block: &mut Block, to: usize, rays: &Rays<L>, begun: L::Mask) -> usize {
        let lanes = self.lanes;
        let bits = lanes.bits(lanes.without(begun, rays.active));
        let from_first = |cell| lanes.add_int(lanes.to_int(cell), lanes.int(1));
        let cell = lanes.pack(from_first(rays.minor), from_first(rays.major));
        let number = lanes.load_int(&block.number, rays.at);
        let order = lanes.order_of(bits);
        lanes.store_int_ordered(order, &mut block.ended, to, number);
        lanes.store_int_ordered(order, &mut block.ended_in, to, cell);
        bits.count_ones() as usize
    }

    /// Moves the rays that are still on their way up to place `to`, not after their own; returns their number.
    #[inline(always)]
    fn keep(&self, block: &mut Block, to: usize, rays: &Rays<L>) -> usize {
        let lanes = self.lanes;
        let bits = lanes.bits(rays.active);
        let order = lanes.order_of(bits);
        for (axis, cell) in [(&mut block.major, rays.major), (&mut block.minor, rays.minor)] {
            lanes.store_ordered(order, &mut axis.cell, to, cell);
            for numbers in [&mut axis.slope, &mut axis.intercept] {
                let kept = lanes.load(numbers, rays.at);
                lanes.store_ordered(order, numbers, to, kept);
            }
        }
        for numbers in [&mut block.base, &mut block.stride, &mut block.number] {
            let kept = lanes.load_int(numbers, rays.at);
            lanes.store_int_ordered(order, numbers, to, kept);
        }
        bits.count_ones() as usize
    }

    /// Moves the active rays out of the free boxes around their cells.
    #[inline(always)]
    fn step(&self, lengths: &[u8], block: &Block, rays: &Rays<L>) -> Rays<L> {
        let lanes = self.lanes;
        let row = lanes.multiply_int(lanes.to_int(rays.minor), lanes.load_int(&block.stride, rays.at));
        let in_row = lanes.add_int(lanes.to_int(rays.major), lanes.load_int(&block.base, rays.at));
        let place = lanes.add_int(row, in_row);
        debug_assert!(self.are_on_grid(rays.active, place), "a ray has left the border");
        let length = lanes.gather(lengths, place);
        let active = lanes.is_positive(rays.active, length);

        // Rays that end here have a length of 0; those that had ended are made to.
        let along = lanes.to_float(rays.active, length);
        let far_major = lanes.add(rays.major, along);
        let far_minor = lanes.add(rays.minor, lanes.half_up(along));
        // Where the lines of the far sides are crossed.
        let crossing = |axis: &Axis32, line| {
            lanes.multiply_add(line, lanes.load(&axis.slope, rays.at), lanes.load(&axis.intercept, rays.at))
        };
        let (at_far_major, at_far_minor) = (crossing(&block.major, far_major), crossing(&block.minor, far_minor));
        let crosses_major = lanes.is_less(active, at_far_major, far_minor);
        let crosses_minor = lanes.without(active, crosses_major);
        let across = lanes.select(crosses_major, at_far_major, at_far_minor);
        let cell = lanes.floor(across);
        let mut major = lanes.select(crosses_minor, cell, far_major);
        let mut minor = lanes.select(crosses_major, cell, far_minor);

        let near = lanes.multiply_add(far_major, lanes.float(TIE_BY_WAY), lanes.float(TIE));
        let ties = lanes.bits(lanes.is_not_greater(active, lanes.off_whole(across), near));
        if ties != 0 {
            (major, minor) = self.step_exactly(block, rays, length, ties, (major, minor));
        }
        debug_assert!(self.have_stayed(active, (rays.major, rays.minor), (major, minor)), "a ray has left where it ended");
        let active = lanes.is_at_most(active, major, lanes.float(self.limit));
        Rays { at: rays.at, active, major, minor }
    }

    /// A ray of the block by its number.
    #[inline(always)]
    fn ray(&self, number: usize) -> Ray {
        let (fan, number) = (number / self.each, number % self.each);
        self.source.group(fan, self.first_group + number / GROUP).ray(number % GROUP)
    }

    /// Where in the lengths the first cell of a ray of the block is.
    fn first_place(&self, at: usize) -> usize {
        let ray = self.ray(at);
        self.free_boxes.index(ray.col, ray.row, Sector::of(ray.direction))
    }

    /// Whether the rays that are not of a mask are in the cells they were in.
    fn have_stayed(&self, active: L::Mask, was: (L::Float, L::Float), is: (L::Float, L::Float)) -> bool {
        let bits = self.lanes.bits(active);
        [(was.0, is.0), (was.1, is.1)].into_iter().all(|(was, is)| {
            let mut lists = [[0.0; 16]; 2];
            self.lanes.store(&mut lists[0], 0, was);
            self.lanes.store(&mut lists[1], 0, is);
            (0..L::COUNT).all(|lane| bits >> lane & 1 != 0 || lists[0][lane] == lists[1][lane])
        })
    }

    /// Whether the rays of a mask are at places that the lengths have.
    fn are_on_grid(&self, active: L::Mask, places: L::Int) -> bool {
        let mut list = [0; 16];
        self.lanes.store_int(&mut list, 0, places);
        let bits = self.lanes.bits(active);
        list.iter()
            .enumerate()
            .all(|(lane, &place)| bits >> lane & 1 == 0 || (place as u32 as usize) < self.free_boxes.lengths().len())
    }

    /// The cells that the rays step into, those of `ties` by the exact step.
    #[cold]
    #[inline(always)]
    fn step_exactly(
        &self,
        block: &Block,
        rays: &Rays<L>,
        length: L::Int,
        mut ties: u32,
        (major, minor): (L::Float, L::Float),
    ) -> (L::Float, L::Float) {
        let lanes = self.lanes;
        let list = |numbers| {
            let mut list = [0.0; 16];
            lanes.store(&mut list, 0, numbers);
            list
        };
        let (now_major, now_minor, length) = (list(rays.major), list(rays.minor), list(lanes.to_float(rays.active, length)));
        let (mut major, mut minor) = (list(major), list(minor));
        while ties != 0 {
            let lane = ties.trailing_zeros() as usize;
            ties &= ties - 1;
            let ray = self.ray(block.number[rays.at + lane] as usize);
            // The block counts cells from the one after the first.
            let now = (now_major[lane] as i32 + 1, now_minor[lane] as i32 + 1);
            let next = Track::new(self.free_boxes, &ray).step(now, length[lane] as i32);
            major[lane] = (next.0 - 1) as f32;
            minor[lane] = (next.1 - 1) as f32;
        }
        (lanes.load(&major, 0), lanes.load(&minor, 0))
    }
}
