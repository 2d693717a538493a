//! Memory for large tables that are read in random order.

use std::ops::{Deref, DerefMut};

use memmap2::MmapMut;

/// A byte array that starts as zeros. A large array uses huge pages if the system has them.
///
/// If a table does not fit in the caches, looking up the address of a page costs as much as reading the byte. With huge
/// pages there are few addresses to look up.
#[derive(Debug)]
pub struct Pages(Memory);

#[derive(Debug)]
enum Memory {
    Allocated(Vec<u8>),
    Mapped(MmapMut),
}

/// Smallest length in bytes that gets its own pages: the usual size of a huge page.
const MIN_MAPPED: usize = 2 << 20;

impl Pages {
    /// Returns `length` zeros.
    #[must_use]
    pub fn zeroed(length: usize) -> Self {
        if length < MIN_MAPPED {
            return Self(Memory::Allocated(vec![0; length]));
        }
        let Ok(mapped) = MmapMut::map_anon(length) else { return Self(Memory::Allocated(vec![0; length])) };
        #[cfg(target_os = "linux")]
        let _ = mapped.advise(memmap2::Advice::HugePage); // On failure the memory has pages of the usual size.
        Self(Memory::Mapped(mapped))
    }
}

impl Deref for Pages {
    type Target = [u8];

    #[inline]
    fn deref(&self) -> &[u8] {
        match &self.0 {
            Memory::Allocated(bytes) => bytes,
            Memory::Mapped(bytes) => bytes,
        }
    }
}

impl DerefMut for Pages {
    #[inline]
    fn deref_mut(&mut self) -> &mut [u8] {
        match &mut self.0 {
            Memory::Allocated(bytes) => bytes,
            Memory::Mapped(bytes) => bytes,
        }
    }
}

impl Clone for Pages {
    fn clone(&self) -> Self {
        let mut copy = Self::zeroed(self.len());
        copy.copy_from_slice(self);
        copy
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_start_as_zeros_and_copies_are_independent() {
        for length in [1, 100, MIN_MAPPED - 1, MIN_MAPPED, 5_000_001] {
            let mut pages = Pages::zeroed(length);
            assert!(pages.len() == length && pages.iter().all(|&byte| byte == 0));
            pages[length - 1] = 7;
            let mut copy = pages.clone();
            assert!(copy.len() == length && copy[length - 1] == 7);
            copy[0] = 9;
            assert_eq!(pages[0], if length == 1 { 7 } else { 0 });
        }
    }
}
