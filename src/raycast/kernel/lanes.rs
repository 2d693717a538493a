//! Vectors of float32 and of int32, as the march over them needs them of an instruction set.

/// Work that is compiled with the instruction set of a kernel.
pub trait Work {
    /// Does the work. Must be `#[inline(always)]`, so that it becomes part of the function that enables the instruction set; a
    /// closure cannot be.
    fn run(self);
}

/// An instruction set that the processor has, by its vectors. A value of such a type is proof that it has it.
///
/// What rounds may round in any way: the march decides nothing on these numbers that rounding could change.
pub trait Lanes: Copy {
    /// Lanes in a vector.
    const COUNT: usize;
    /// Steps between two times that the rays still on their way move up.
    const STEPS: usize = 2;
    /// Vectors in flight at the same time, none of which waits for another: 2 or 3.
    const IN_FLIGHT: usize = 3;
    /// A vector of float32.
    type Float: Copy;
    /// A vector of int32.
    type Int: Copy;
    /// Yes or no for each lane.
    type Mask: Copy;
    /// An order of some lanes.
    type Order: Copy;

    /// Does some work with the instruction set, as a function of its own.
    fn with_features(self, work: impl Work);
    /// The same number in all lanes.
    fn float(self, number: f32) -> Self::Float;
    /// The same number in all lanes.
    fn int(self, number: i32) -> Self::Int;
    /// The sums.
    fn add(self, a: Self::Float, b: Self::Float) -> Self::Float;
    /// a · b + c.
    fn multiply_add(self, a: Self::Float, b: Self::Float, c: Self::Float) -> Self::Float;
    /// The largest whole numbers that are no greater.
    fn floor(self, a: Self::Float) -> Self::Float;
    /// Halves of whole numbers in [0, 255], rounded up.
    fn half_up(self, a: Self::Float) -> Self::Float;
    /// How far from the nearest whole number.
    fn off_whole(self, a: Self::Float) -> Self::Float;
    /// Whole numbers as such.
    fn to_int(self, a: Self::Float) -> Self::Int;
    /// Whole numbers as float32, and 0 where the mask does not hold.
    fn to_float(self, within: Self::Mask, a: Self::Int) -> Self::Float;
    /// The sums, wrapping around.
    fn add_int(self, a: Self::Int, b: Self::Int) -> Self::Int;
    /// The products' lower 32 bits.
    fn multiply_int(self, a: Self::Int, b: Self::Int) -> Self::Int;
    /// a, 65,536-fold, plus b.
    fn pack(self, a: Self::Int, b: Self::Int) -> Self::Int;
    /// The bytes at these places, counted without sign; of places beyond the last, some byte.
    fn gather(self, bytes: &[u8], places: Self::Int) -> Self::Int;
    /// Where a mask holds and a < b.
    fn is_less(self, within: Self::Mask, a: Self::Float, b: Self::Float) -> Self::Mask;
    /// Where a mask holds and a <= b.
    fn is_at_most(self, within: Self::Mask, a: Self::Float, b: Self::Float) -> Self::Mask;
    /// Where a mask holds and a > b does not, as it does not where one is not a number.
    fn is_not_greater(self, within: Self::Mask, a: Self::Float, b: Self::Float) -> Self::Mask;
    /// Where a mask holds and a is positive.
    fn is_positive(self, within: Self::Mask, a: Self::Int) -> Self::Mask;
    /// The first lanes.
    fn first(self, count: usize) -> Self::Mask;
    /// Where a holds and b does not.
    fn without(self, a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// A bit for each lane.
    fn bits(self, mask: Self::Mask) -> u32;
    /// a where the mask holds, else b.
    fn select(self, mask: Self::Mask, a: Self::Float, b: Self::Float) -> Self::Float;
    /// Numbers from a place on.
    fn load(self, numbers: &[f32], at: usize) -> Self::Float;
    /// Numbers from a place on.
    fn load_int(self, numbers: &[i32], at: usize) -> Self::Int;
    /// The order in which the lanes with a bit set come first, and then any.
    fn order_of(self, bits: u32) -> Self::Order;
    /// Puts the lanes that come first in an order from a place on, and behind them, up to a whole vector, anything.
    fn store_ordered(self, order: Self::Order, numbers: &mut [f32], at: usize, a: Self::Float);
    /// Puts the lanes that come first in an order from a place on, and behind them, up to a whole vector, anything.
    fn store_int_ordered(self, order: Self::Order, numbers: &mut [i32], at: usize, a: Self::Int);
    /// Puts all lanes from a place on.
    fn store_int(self, numbers: &mut [i32], at: usize, a: Self::Int);
    /// Puts all lanes from a place on.
    fn store(self, numbers: &mut [f32], at: usize, a: Self::Float);
}
