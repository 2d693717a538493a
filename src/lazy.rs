//! Values that are built when they are first needed, and then kept.

use std::cell::Cell;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering::SeqCst};
use std::thread;
use std::time::Duration;

use crate::error::Error;
use crate::fork::{Section, generation};
use crate::interrupt::Watch;

/// A value that is built when it is first needed.
///
/// One thread builds it, and others that need it wait. Unlike `OnceLock` of the standard library, this does not hang in a
/// forked process: a fork does not wait for a build, and the child builds the value again.
#[derive(Debug)]
pub struct Lazy<T> {
    value: OnceLock<T>,
    /// The [`generation`] of the process in which a thread builds the value; 0 if none does.
    builder: AtomicUsize,
}

/// Time between two looks at whether another thread has built the value.
const PAUSE: Duration = Duration::from_micros(200);

impl<T> Lazy<T> {
    /// Returns a value that is not built yet.
    pub const fn new() -> Self {
        Self { value: OnceLock::new(), builder: AtomicUsize::new(0) }
    }

    /// Returns the value if it is built.
    #[inline]
    pub fn get(&self) -> Option<&T> {
        self.value.get()
    }

    /// Returns the value for changes if it is built.
    pub fn get_mut(&mut self) -> Option<&mut T> {
        self.value.get_mut()
    }

    /// Returns the value; builds it if it is not built yet. After an error, the next call tries again.
    ///
    /// # Errors
    /// - Those of `build`.
    /// - [`Error::Interrupted`]: the call was interrupted while it waited for another thread.
    #[inline]
    pub fn get_or_build(&self, build: impl FnOnce() -> Result<T, Error>) -> Result<&T, Error> {
        self.get().map_or_else(|| self.build(build), Ok)
    }

    #[cold]
    fn build(&self, build: impl FnOnce() -> Result<T, Error>) -> Result<&T, Error> {
        let Some(_claim) = self.claim()? else { return Ok(self.value.get().expect("a value that is built")) };
        let value = build()?;
        let _section = Section::enter();
        Ok(self.value.get_or_init(|| value))
    }

    /// Waits until the value is built or this thread may build it. Returns `None` if it is built.
    ///
    /// A thread that is building a value already does not wait. It can come here again if its build is interrupted by code
    /// that goes on with it afterwards, and it must not wait for itself.
    fn claim(&self) -> Result<Option<Claim<'_>>, Error> {
        let watch = Watch::new();
        loop {
            if self.value.get().is_some() {
                return Ok(None);
            }
            let (builder, own) = (self.builder.load(SeqCst), generation());
            let is_free = builder != own && self.builder.compare_exchange(builder, own, SeqCst, SeqCst).is_ok();
            if is_free || CLAIMS.get() > 0 {
                let claim = Claim::new(is_free.then_some(&self.builder));
                // Another thread may have finished just before.
                return Ok(self.value.get().is_none().then_some(claim));
            }
            watch.check()?;
            thread::sleep(PAUSE);
        }
    }
}

impl<T> From<T> for Lazy<T> {
    fn from(value: T) -> Self {
        Self { value: OnceLock::from(value), builder: AtomicUsize::new(0) }
    }
}

/// The right of one thread to build a value, until this is dropped.
struct Claim<'a> {
    /// The builder to reset at the end.
    builder: Option<&'a AtomicUsize>,
}

thread_local! {
    /// Number of claims of this thread.
    static CLAIMS: Cell<usize> = const { Cell::new(0) };
}

impl<'a> Claim<'a> {
    fn new(builder: Option<&'a AtomicUsize>) -> Self {
        CLAIMS.set(CLAIMS.get() + 1);
        Self { builder }
    }
}

impl Drop for Claim<'_> {
    fn drop(&mut self) {
        CLAIMS.set(CLAIMS.get() - 1);
        if let Some(builder) = self.builder {
            builder.store(0, SeqCst);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Barrier;

    #[test]
    fn one_of_many_threads_builds_the_value() {
        let (lazy, builds, barrier) = (Lazy::new(), AtomicUsize::new(0), Barrier::new(4));
        let build = || {
            thread::sleep(Duration::from_millis(20));
            Ok(builds.fetch_add(1, SeqCst) + 7)
        };
        let get = || {
            barrier.wait();
            lazy.get_or_build(build).copied()
        };
        thread::scope(|scope| {
            let threads = [0; 4].map(|_| scope.spawn(get));
            assert!(threads.into_iter().all(|thread| thread.join().expect("no panic") == Ok(7)));
        });
        assert_eq!(builds.into_inner(), 1);
    }

    #[test]
    fn after_an_error_or_a_panic_the_next_call_builds_the_value() {
        let lazy = Lazy::<u8>::new();
        assert_eq!(lazy.get_or_build(|| Err(Error::Interrupted)), Err(Error::Interrupted));
        thread::scope(|scope| assert!(scope.spawn(|| lazy.get_or_build(|| panic!("a bug"))).join().is_err()));
        assert_eq!(lazy.get(), None);
        assert_eq!((lazy.get_or_build(|| Ok(7)), lazy.get()), (Ok(&7), Some(&7)));
    }

    #[test]
    fn a_build_does_not_wait_for_itself() {
        let lazy = Lazy::new();
        let built = lazy.get_or_build(|| lazy.get_or_build(|| Ok(7)).map(|value| value + 1));
        assert_eq!((built, CLAIMS.get()), (Ok(&7), 0));
    }

    #[test]
    fn a_build_of_an_earlier_process_is_not_waited_for() {
        let lazy = Lazy { value: OnceLock::new(), builder: AtomicUsize::new(generation() + 1) };
        assert_eq!(lazy.get_or_build(|| Ok(7)), Ok(&7));
    }
}
