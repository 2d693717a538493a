//! The vector operations that the jump loop in `march` needs from an instruction set.

/// Work that is compiled for the instruction set of a kernel.
pub trait Work {
    /// Does the work.
    ///
    /// Implementations must be `#[inline(always)]`, so that they become part of the function that enables the instruction
    /// set. This is why work is not a closure: a closure cannot have this attribute.
    fn run(self);
}

/// The vectors of one instruction set, and the operations on them.
///
/// A type that implements this trait can be created only if the processor has the instruction set, so a value of the type
/// proves that the operations are safe to use. The operations may round in any way, because the jump loop never relies on
/// a result that rounding could change.
pub trait Lanes: Copy {
    /// Number of lanes of a vector.
    const COUNT: usize;
    /// Steps that a ray makes in one pass over the block.
    const STEPS_PER_PASS: usize = 2;
    /// Number of vectors that take their steps in turn, 2 or 3: the processor works on one while another waits for memory.
    const IN_FLIGHT: usize = 3;
    /// Least number of beams from one coarse beam to the next for which it is faster to cast these first. Measured.
    const MIN_STEP: usize = 8;
    /// A vector of float32.
    type Float: Copy;
    /// A vector of int32.
    type Int: Copy;
    /// One bool for each lane.
    type Mask: Copy;
    /// A permutation of lanes that moves selected lanes to the front.
    type Compaction: Copy;

    /// Runs work in a separate function that is compiled for the instruction set.
    fn with_features(self, work: impl Work);
    /// The number in every lane.
    fn splat(self, number: f32) -> Self::Float;
    /// The number in every lane.
    fn splat_int(self, number: i32) -> Self::Int;
    /// a + b.
    fn add(self, a: Self::Float, b: Self::Float) -> Self::Float;
    /// a · b + c, rounded once or twice.
    fn multiply_add(self, a: Self::Float, b: Self::Float, c: Self::Float) -> Self::Float;
    /// The floor of a.
    fn floor(self, a: Self::Float) -> Self::Float;
    /// Distance from a to the nearest integer.
    fn distance_to_integer(self, a: Self::Float) -> Self::Float;
    /// Whole numbers, converted to int32.
    fn to_int(self, a: Self::Float) -> Self::Int;
    /// Numbers converted to float32 in the lanes of the mask, 0 in the others.
    fn to_float(self, mask: Self::Mask, a: Self::Int) -> Self::Float;
    /// Length and breadth of free boxes from their codes in the lanes of the mask, 0 in the others.
    fn sides(self, mask: Self::Mask, codes: Self::Int) -> (Self::Float, Self::Float);
    /// a + b, modulo 2³².
    fn add_int(self, a: Self::Int, b: Self::Int) -> Self::Int;
    /// a · b, modulo 2³².
    fn multiply_int(self, a: Self::Int, b: Self::Int) -> Self::Int;
    /// 65536 · a + b.
    fn pack(self, a: Self::Int, b: Self::Int) -> Self::Int;
    /// The unsigned bytes at these indices; an unspecified byte for an index past the end. An index below 3 may give the byte
    /// at 3 instead.
    fn gather(self, bytes: &[u8], indices: Self::Int) -> Self::Int;
    /// Lanes of the mask with a < b.
    fn is_less(self, mask: Self::Mask, a: Self::Float, b: Self::Float) -> Self::Mask;
    /// Lanes of the mask with a ≤ b.
    fn is_at_most(self, mask: Self::Mask, a: Self::Float, b: Self::Float) -> Self::Mask;
    /// Lanes of the mask where a > b is false. It is false if a or b is NaN.
    fn is_not_greater(self, mask: Self::Mask, a: Self::Float, b: Self::Float) -> Self::Mask;
    /// Lanes of the mask with a > 0.
    fn is_positive(self, mask: Self::Mask, a: Self::Int) -> Self::Mask;
    /// The first `count` lanes.
    fn first_lanes(self, count: usize) -> Self::Mask;
    /// Lanes that are in a and not in b.
    fn and_not(self, a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// One bit for each lane.
    fn bits(self, mask: Self::Mask) -> u32;
    /// a in the lanes of the mask, b in the others.
    fn select(self, mask: Self::Mask, a: Self::Float, b: Self::Float) -> Self::Float;
    /// Reads a vector from index `at` on.
    fn load(self, numbers: &[f32], at: usize) -> Self::Float;
    /// Reads a vector from index `at` on.
    fn load_int(self, numbers: &[i32], at: usize) -> Self::Int;
    /// The permutation that moves the lanes with a bit set to the front, in their order.
    fn compaction(self, bits: u32) -> Self::Compaction;
    /// Writes the selected lanes from index `at` on. May overwrite the rest, up to the length of a vector, with any values.
    fn store_compacted(self, compaction: Self::Compaction, numbers: &mut [f32], at: usize, a: Self::Float);
    /// Writes the selected lanes from index `at` on. May overwrite the rest, up to the length of a vector, with any values.
    fn store_int_compacted(self, compaction: Self::Compaction, numbers: &mut [i32], at: usize, a: Self::Int);
    /// Writes a vector from index `at` on.
    fn store_int(self, numbers: &mut [i32], at: usize, a: Self::Int);
    /// Writes a vector from index `at` on.
    fn store(self, numbers: &mut [f32], at: usize, a: Self::Float);
}
