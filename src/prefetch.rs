//! Prefetching: loading memory into the cache before it is read.
#![allow(unsafe_code, reason = "an intrinsic")]

/// Size of a cache line in bytes.
pub const LINE: usize = 64;

/// Loads the cache line of a byte, if the memory has that byte and the processor has an instruction for it.
#[inline(always)]
pub fn prefetch<T>(memory: &[T], byte: usize) {
    #[cfg(target_arch = "x86_64")]
    if byte < size_of_val(memory) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: every x86-64 processor has the instruction. It has no visible effect, and the byte is in the memory.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(memory.as_ptr().cast::<i8>().add(byte)) }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (memory, byte);
}
