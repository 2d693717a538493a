//! Any processor: arrays of 8 numbers, in loops that the compiler can vectorise.
#![allow(unsafe_code, reason = "conversions to integers that do not saturate")]

use super::lanes::{Lanes, Work};

/// The instructions that every processor has.
#[derive(Debug, Clone, Copy)]
pub struct Portable;

const COUNT: usize = 8;

/// Returns an array of `of(lane)`.
#[inline(always)]
fn each<T>(of: impl Fn(usize) -> T) -> [T; COUNT] {
    std::array::from_fn(of)
}

/// Returns 32 bits: all 1 if `set` is true, else all 0.
#[inline(always)]
fn all_bits(set: bool) -> u32 {
    if set { u32::MAX } else { 0 }
}

/// Truncates a number to an int32.
#[inline(always)]
fn truncate(a: f32) -> i32 {
    // Cell numbers are at most about 65536. Other numbers (NaN, infinity, padding) become 0; their results are not used.
    let a = if a < 1e9 { a } else { 0.0 };
    let a = if a > -1e9 { a } else { 0.0 };
    // SAFETY: the number is finite and fits in an int32.
    unsafe { a.to_int_unchecked() }
}

/// Writes the lanes whose bit is set, one after the other from index `at` on.
///
/// There are no branches: every lane is written. If the bit of a lane is not set, the next lane is written over that lane.
#[inline(always)]
fn store_selected<T: Copy>(bits: u32, numbers: &mut [T], at: usize, a: [T; COUNT]) {
    let numbers: &mut [T; COUNT] = numbers[at..].first_chunk_mut().expect("room for a whole vector");
    let mut count = 0;
    for (lane, &a) in a.iter().enumerate() {
        numbers[count & (COUNT - 1)] = a;
        count += (bits >> lane & 1) as usize;
    }
}

impl Lanes for Portable {
    const COUNT: usize = COUNT;
    const STEPS_PER_PASS: usize = 4;
    const MIN_STEP: usize = 4;
    const IN_FLIGHT: usize = 2;
    type Float = [f32; COUNT];
    type Int = [i32; COUNT];
    type Mask = [u32; COUNT];
    type Compaction = u32;

    #[inline(never)]
    fn with_features(self, work: impl Work) {
        work.run();
    }

    #[inline(always)]
    fn splat(self, number: f32) -> [f32; COUNT] {
        [number; COUNT]
    }

    #[inline(always)]
    fn splat_int(self, number: i32) -> [i32; COUNT] {
        [number; COUNT]
    }

    #[inline(always)]
    fn add(self, a: [f32; COUNT], b: [f32; COUNT]) -> [f32; COUNT] {
        each(|lane| a[lane] + b[lane])
    }

    #[inline(always)]
    fn multiply_add(self, a: [f32; COUNT], b: [f32; COUNT], c: [f32; COUNT]) -> [f32; COUNT] {
        each(|lane| a[lane] * b[lane] + c[lane])
    }

    #[inline(always)]
    fn floor(self, a: [f32; COUNT]) -> [f32; COUNT] {
        // No cell number is below -1, so the sum is not negative and truncation is the floor.
        each(|lane| (truncate(a[lane] + 1.0) - 1) as f32)
    }

    #[inline(always)]
    fn distance_to_integer(self, a: [f32; COUNT]) -> [f32; COUNT] {
        let floor = self.floor(a);
        each(|lane| {
            let beyond = a[lane] - floor[lane];
            if beyond < 0.5 { beyond } else { 1.0 - beyond }
        })
    }

    #[inline(always)]
    fn to_int(self, a: [f32; COUNT]) -> [i32; COUNT] {
        each(|lane| truncate(a[lane]))
    }

    #[inline(always)]
    fn to_float(self, mask: [u32; COUNT], a: [i32; COUNT]) -> [f32; COUNT] {
        each(|lane| (a[lane] & mask[lane] as i32) as f32)
    }

    #[inline(always)]
    fn sides(self, mask: [u32; COUNT], codes: [i32; COUNT]) -> ([f32; COUNT], [f32; COUNT]) {
        let code = each(|lane| codes[lane] & mask[lane] as i32);
        let is_even = each(|lane| all_bits(code[lane] > 1) as i32);
        // A comparison that holds gives -1.
        let breadth = each(|lane| code[lane] + is_even[lane]);
        (each(|lane| (breadth[lane] + (breadth[lane] & is_even[lane])) as f32), each(|lane| breadth[lane] as f32))
    }

    #[inline(always)]
    fn add_int(self, a: [i32; COUNT], b: [i32; COUNT]) -> [i32; COUNT] {
        each(|lane| a[lane].wrapping_add(b[lane]))
    }

    #[inline(always)]
    fn multiply_int(self, a: [i32; COUNT], b: [i32; COUNT]) -> [i32; COUNT] {
        each(|lane| a[lane].wrapping_mul(b[lane]))
    }

    #[inline(always)]
    fn pack(self, a: [i32; COUNT], b: [i32; COUNT]) -> [i32; COUNT] {
        each(|lane| (a[lane] << 16).wrapping_add(b[lane]))
    }

    #[inline(always)]
    fn gather(self, bytes: &[u8], indices: [i32; COUNT]) -> [i32; COUNT] {
        each(|lane| bytes.get(indices[lane] as u32 as usize).copied().unwrap_or(0).into())
    }

    #[inline(always)]
    fn is_less(self, mask: [u32; COUNT], a: [f32; COUNT], b: [f32; COUNT]) -> [u32; COUNT] {
        each(|lane| mask[lane] & all_bits(a[lane] < b[lane]))
    }

    #[inline(always)]
    fn is_at_most(self, mask: [u32; COUNT], a: [f32; COUNT], b: [f32; COUNT]) -> [u32; COUNT] {
        each(|lane| mask[lane] & all_bits(a[lane] <= b[lane]))
    }

    #[inline(always)]
    fn is_not_greater(self, mask: [u32; COUNT], a: [f32; COUNT], b: [f32; COUNT]) -> [u32; COUNT] {
        each(|lane| mask[lane] & !all_bits(a[lane] > b[lane]))
    }

    #[inline(always)]
    fn is_positive(self, mask: [u32; COUNT], a: [i32; COUNT]) -> [u32; COUNT] {
        each(|lane| mask[lane] & all_bits(a[lane] > 0))
    }

    #[inline(always)]
    fn first_lanes(self, count: usize) -> [u32; COUNT] {
        each(|lane| all_bits(lane < count))
    }

    #[inline(always)]
    fn and_not(self, a: [u32; COUNT], b: [u32; COUNT]) -> [u32; COUNT] {
        each(|lane| a[lane] & !b[lane])
    }

    #[inline(always)]
    fn bits(self, mask: [u32; COUNT]) -> u32 {
        (0..COUNT).map(|lane| mask[lane] & 1 << lane).sum()
    }

    #[inline(always)]
    fn select(self, mask: [u32; COUNT], a: [f32; COUNT], b: [f32; COUNT]) -> [f32; COUNT] {
        each(|lane| f32::from_bits(a[lane].to_bits() & mask[lane] | b[lane].to_bits() & !mask[lane]))
    }

    #[inline(always)]
    fn load(self, numbers: &[f32], at: usize) -> [f32; COUNT] {
        *numbers[at..].first_chunk().expect("room for a whole vector")
    }

    #[inline(always)]
    fn load_int(self, numbers: &[i32], at: usize) -> [i32; COUNT] {
        *numbers[at..].first_chunk().expect("room for a whole vector")
    }

    #[inline(always)]
    fn compaction(self, bits: u32) -> u32 {
        bits
    }

    #[inline(always)]
    fn store_compacted(self, compaction: u32, numbers: &mut [f32], at: usize, a: [f32; COUNT]) {
        store_selected(compaction, numbers, at, a);
    }

    #[inline(always)]
    fn store_int_compacted(self, compaction: u32, numbers: &mut [i32], at: usize, a: [i32; COUNT]) {
        store_selected(compaction, numbers, at, a);
    }

    #[inline(always)]
    fn store(self, numbers: &mut [f32], at: usize, a: [f32; COUNT]) {
        numbers[at..at + COUNT].copy_from_slice(&a);
    }

    #[inline(always)]
    fn store_int(self, numbers: &mut [i32], at: usize, a: [i32; COUNT]) {
        numbers[at..at + COUNT].copy_from_slice(&a);
    }
}
