//! Memory for large tables that are read in random order.

use std::ops::{Deref, DerefMut};

use memmap2::MmapMut;

use crate::error::Error;
use crate::memory;

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
    /// Returns `length` zeros; `what` names them in the error.
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    pub fn zeroed(what: &'static str, length: usize) -> Result<Self, Error> {
        let allocated = || Ok(Self(Memory::Allocated(memory::filled(what, 0, length)?)));
        if length < MIN_MAPPED {
            return allocated();
        }
        let Ok(mapped) = MmapMut::map_anon(length) else { return allocated() };
        #[cfg(target_os = "linux")]
        let _ = mapped.advise(memmap2::Advice::HugePage); // On failure the memory has pages of the usual size.
        Ok(Self(Memory::Mapped(mapped)))
    }

    /// Returns no bytes.
    pub const fn empty() -> Self {
        Self(Memory::Allocated(Vec::new()))
    }

    /// Returns a copy; `what` names it in the error.
    ///
    /// # Errors
    /// Those of [`zeroed`](Self::zeroed).
    pub fn try_clone(&self, what: &'static str) -> Result<Self, Error> {
        let mut copy = Self::zeroed(what, self.len())?;
        copy.copy_from_slice(self);
        Ok(copy)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_start_as_zeros_and_copies_are_independent() {
        for length in [1, 100, MIN_MAPPED - 1, MIN_MAPPED, 5_000_001] {
            let mut pages = Pages::zeroed("", length).expect("enough memory");
            assert!(pages.len() == length && pages.iter().all(|&byte| byte == 0));
            pages[length - 1] = 7;
            let mut copy = pages.try_clone("").expect("enough memory");
            assert!(copy.len() == length && copy[length - 1] == 7);
            copy[0] = 9;
            assert_eq!(pages[0], if length == 1 { 7 } else { 0 });
        }
    }
}
