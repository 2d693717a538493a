//! Forks of the process: a child must not inherit a lock that a thread of its parent holds, because the child has no such
//! thread, so that nothing would ever unlock it.
//!
//! A *section* is a short piece of code that must not be cut by a fork. The fork waits until no thread is in a section, and
//! no thread enters one meanwhile. All locks of this crate are held in sections only.
//!
//! Three rules keep sections free of deadlocks. They are short. A thread in a section does not wait for anything that a
//! forking thread may hold; in Python this is the GIL. Nor does it wait for a thread that may be about to enter a section.

use std::cell::Cell;
use std::ops::{Deref, DerefMut};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::SeqCst};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

/// Number of threads in sections.
static THREADS_INSIDE: AtomicUsize = AtomicUsize::new(0);

/// Number of threads that are about to fork the process.
static FORKS: AtomicUsize = AtomicUsize::new(0);

/// Number of forks between the first process and this one, plus 1.
static GENERATION: AtomicUsize = AtomicUsize::new(1);

/// Time between two looks at one of these numbers.
const PAUSE: Duration = Duration::from_micros(50);

thread_local! {
    /// Number of sections that this thread is in, one inside the other.
    static DEPTH: Cell<usize> = const { Cell::new(0) };
}

/// Returns a number that is not 0 and differs between a process and all processes that it descends from by forks.
pub fn generation() -> usize {
    register();
    GENERATION.load(SeqCst)
}

/// A section of the current thread, until it is dropped. Sections may be nested.
#[derive(Debug)]
pub struct Section(());

impl Section {
    /// Enters a section; waits while the process forks.
    pub fn enter() -> Self {
        // Only the outermost section waits: a fork waits for the end of this one.
        if DEPTH.get() == 0 {
            register();
            THREADS_INSIDE.fetch_add(1, SeqCst);
            while FORKS.load(SeqCst) > 0 {
                THREADS_INSIDE.fetch_sub(1, SeqCst);
                thread::sleep(PAUSE);
                THREADS_INSIDE.fetch_add(1, SeqCst);
            }
        }
        DEPTH.set(DEPTH.get() + 1);
        Self(())
    }
}

impl Drop for Section {
    fn drop(&mut self) {
        DEPTH.set(DEPTH.get() - 1);
        if DEPTH.get() == 0 {
            THREADS_INSIDE.fetch_sub(1, SeqCst);
        }
    }
}

/// A mutex that no child process finds locked. It has no poison: use it for values that a panic cannot leave half changed.
#[derive(Debug, Default)]
pub struct Lock<T>(Mutex<T>);

/// The value of a [`Lock`], which is locked until this is dropped.
#[derive(Debug)]
pub struct Locked<'a, T> {
    // Fields are dropped in this order: the section ends last.
    value: MutexGuard<'a, T>,
    _section: Section,
}

impl<T> Lock<T> {
    pub const fn new(value: T) -> Self {
        Self(Mutex::new(value))
    }

    /// Locks the value; waits while another thread has locked it.
    pub fn lock(&self) -> Locked<'_, T> {
        let section = Section::enter();
        Locked { value: self.0.lock().unwrap_or_else(PoisonError::into_inner), _section: section }
    }
}

impl<T> Deref for Locked<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T> DerefMut for Locked<'_, T> {
    fn deref_mut(&mut self) -> &mut T {
        &mut self.value
    }
}

/// Has the system call the functions below at each fork.
fn register() {
    static IS_REGISTERED: AtomicBool = AtomicBool::new(false);
    if IS_REGISTERED.load(SeqCst) {
        return;
    }
    #[cfg(unix)]
    #[allow(unsafe_code, reason = "a function of the C library")]
    // SAFETY: The functions live as long as the process, and have the type that is asked for. If two threads come here at
    // once, the functions are registered twice, which does no harm: FORKS counts.
    unsafe {
        libc::pthread_atfork(Some(before_fork), Some(after_fork_in_parent), Some(after_fork_in_child));
    }
    IS_REGISTERED.store(true, SeqCst);
}

#[cfg(unix)]
extern "C" fn before_fork() {
    FORKS.fetch_add(1, SeqCst);
    while THREADS_INSIDE.load(SeqCst) > 0 {
        thread::sleep(PAUSE);
    }
}

#[cfg(unix)]
extern "C" fn after_fork_in_parent() {
    FORKS.fetch_sub(1, SeqCst);
}

/// The child has one thread, the one that forked, and it is in no section. What other threads counted is gone with them.
#[cfg(unix)]
extern "C" fn after_fork_in_child() {
    THREADS_INSIDE.store(0, SeqCst);
    FORKS.store(0, SeqCst);
    GENERATION.fetch_add(1, SeqCst);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sections_nest() {
        let (outer, inner) = (Section::enter(), Section::enter());
        assert_eq!(DEPTH.get(), 2);
        drop(outer);
        assert!(DEPTH.get() == 1 && THREADS_INSIDE.load(SeqCst) >= 1);
        drop(inner);
        assert_eq!(DEPTH.get(), 0);
    }

    #[test]
    fn a_lock_counts_for_many_threads_also_after_a_panic() {
        let lock = Lock::new(0);
        let add = |times: usize| (0..times).for_each(|_| *lock.lock() += 1);
        thread::scope(|scope| (0..4).for_each(|_| drop(scope.spawn(|| add(1000)))));
        thread::scope(|scope| {
            let panics = scope.spawn(|| {
                let _locked = lock.lock();
                panic!("a bug");
            });
            assert!(panics.join().is_err());
        });
        add(1);
        assert_eq!(*lock.lock(), 4001);
    }
}
