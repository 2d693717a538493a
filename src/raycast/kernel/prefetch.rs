//! Fetching memory before it is read.
#![allow(unsafe_code, reason = "an intrinsic")]

/// Bytes that are fetched at once.
pub const LINE: usize = 64;

/// Has the processor fetch a byte and those around it into its cache, if there is such a byte and if it can be asked to.
#[inline(always)]
pub fn prefetch<T>(memory: &[T], byte: usize) {
    #[cfg(target_arch = "x86_64")]
    if byte < size_of_val(memory) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: every such processor has the instruction; what it does cannot be seen, and the byte is there.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(memory.as_ptr().cast::<i8>().add(byte)) }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (memory, byte);
}
