//! Fetching memory before it is read.
#![allow(unsafe_code, reason = "an intrinsic")]

/// Bytes of a cache line.
const LINE: usize = 64;

/// Has the processor fetch the nth cache line of some memory into its cache, if there is one and if it can be asked to.
#[inline(always)]
pub fn prefetch<T>(memory: &[T], nth: usize) {
    #[cfg(target_arch = "x86_64")]
    if nth * LINE < size_of_val(memory) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: every such processor has the instruction; it reads nothing that could be seen, and faults at no address.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(memory.as_ptr().cast::<i8>().wrapping_add(nth * LINE)) }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (memory, nth, LINE);
}
