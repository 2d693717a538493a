//! Zeroed bytes to be read at random.

use std::ops::{Deref, DerefMut};

use memmap2::MmapMut;

/// Bytes that start as zeros, in huge pages where there are many and the system grants such pages: on a grid that no cache holds,
/// looking up where a page is costs as much as what is in it.
#[derive(Debug)]
pub struct Pages(Memory);

#[derive(Debug)]
enum Memory {
    Allocated(Vec<u8>),
    Mapped(MmapMut),
}

/// The least that is worth pages of its own, which the usual huge page holds.
const WORTH_MAPPING: usize = 2 << 20;

impl Pages {
    /// So many zeros.
    #[must_use]
    pub fn zeroed(length: usize) -> Self {
        if length < WORTH_MAPPING {
            return Self(Memory::Allocated(vec![0; length]));
        }
        let Ok(mapped) = MmapMut::map_anon(length) else { return Self(Memory::Allocated(vec![0; length])) };
        #[cfg(target_os = "linux")]
        let _ = mapped.advise(memmap2::Advice::HugePage); // A system without them has pages all the same.
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
    fn pages_are_zeros_of_their_own() {
        for length in [1, 100, WORTH_MAPPING - 1, WORTH_MAPPING, 5_000_001] {
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
