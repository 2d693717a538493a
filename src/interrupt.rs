//! Interruption: how a long call ends early, for example on Ctrl-C.

use std::cell::Cell;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use crate::error::Error;

/// Returns true if the call that the current thread is in must end.
type Hook = fn() -> bool;

static HOOK: OnceLock<Hook> = OnceLock::new();

/// Time between two calls of the hook.
const INTERVAL: Duration = Duration::from_millis(50);

/// Time between two looks at the clock, roughly.
const CLOCK_NANOS: u64 = 1_000_000;

thread_local! {
    /// True while this thread is in the hook. Calls that the hook makes are not interrupted: the hook may make one each time.
    static IS_ASKING: Cell<bool> = const { Cell::new(false) };
}

/// Calls the hook.
fn ask(hook: Hook) -> bool {
    IS_ASKING.set(true);
    let is_interrupted = hook();
    IS_ASKING.set(false);
    is_interrupted
}

/// Sets the function that long calls ask about every 50 ms, on the thread of the call, whether they must end.
///
/// The first function counts, for the whole process. Without one, no call ends early.
#[cfg_attr(not(feature = "python"), allow(dead_code, reason = "for bindings"))]
pub fn set_hook(hook: Hook) {
    let _ = HOOK.set(hook);
}

/// Returns true if the calling thread belongs to a pool.
///
/// While a pool thread waits for other threads, it may run another task of its pool. If that task needs the result that the
/// thread is still computing, neither can continue: a deadlock.
pub fn is_pool_thread() -> bool {
    rayon::current_thread_index().is_some()
}

/// Tells the loops of one call whether the call must end. All threads of the call share it; only the calling one asks the
/// hook.
#[derive(Debug)]
pub struct Watch {
    hook: Option<Hook>,
    is_interrupted: AtomicBool,
    /// The first look at the clock.
    start: OnceLock<Instant>,
    // The following are used by the calling thread only.
    /// Number of steps until the next look at the clock.
    steps_left: AtomicU32,
    /// Number of steps between two looks.
    steps: AtomicU32,
    /// Time of the last look [ns since `start`].
    looked_at: AtomicU64,
    /// Time of the last call of the hook [ns since `start`].
    asked_at: AtomicU64,
}

impl Watch {
    /// Returns a watch that asks the hook.
    pub fn new() -> Self {
        Self { hook: HOOK.get().copied().filter(|_| !IS_ASKING.get()), ..Self::never() }
    }

    /// Returns a watch that never interrupts: for loops in a section of `fork`, in which the hook must not be called.
    pub const fn never() -> Self {
        Self {
            hook: None,
            is_interrupted: AtomicBool::new(false),
            start: OnceLock::new(),
            steps_left: AtomicU32::new(1),
            steps: AtomicU32::new(1),
            looked_at: AtomicU64::new(0),
            asked_at: AtomicU64::new(0),
        }
    }

    /// Returns true if the call must end. To be called before each step of a loop; takes about 2 ns.
    #[inline]
    pub fn is_interrupted(&self) -> bool {
        let Some(hook) = self.hook else { return false };
        if self.is_interrupted.load(Ordering::Relaxed) || is_pool_thread() {
            return self.is_interrupted.load(Ordering::Relaxed);
        }
        let left = self.steps_left.load(Ordering::Relaxed);
        if left > 0 {
            self.steps_left.store(left - 1, Ordering::Relaxed);
            return false;
        }
        self.look(hook)
    }

    /// The same as an error.
    ///
    /// # Errors
    /// [`Error::Interrupted`]: the call must end.
    #[inline]
    pub fn check(&self) -> Result<(), Error> {
        if self.is_interrupted() { Err(Error::Interrupted) } else { Ok(()) }
    }

    /// Returns the error if the call was interrupted before; does not ask again.
    ///
    /// # Errors
    /// [`Error::Interrupted`]: the call was interrupted.
    pub fn end(&self) -> Result<(), Error> {
        if self.is_interrupted.load(Ordering::Relaxed) { Err(Error::Interrupted) } else { Ok(()) }
    }

    /// Looks at the clock, and asks the hook if it is time.
    #[cold]
    fn look(&self, hook: Hook) -> bool {
        let now = self.start.get_or_init(Instant::now).elapsed().as_nanos() as u64;
        let since = now - self.looked_at.swap(now, Ordering::Relaxed);
        // Steps may take nanoseconds or seconds, so their number follows the time that they took.
        let steps = self.steps.load(Ordering::Relaxed);
        let steps = if since < CLOCK_NANOS { (2 * steps + 1).min(1 << 20) } else { steps / 2 };
        self.steps.store(steps, Ordering::Relaxed);
        self.steps_left.store(steps, Ordering::Relaxed);
        if now - self.asked_at.load(Ordering::Relaxed) < INTERVAL.as_nanos() as u64 {
            return false;
        }
        let is_interrupted = ask(hook);
        self.is_interrupted.store(is_interrupted, Ordering::Relaxed);
        // After the hook, which may take long.
        let now = self.start.get_or_init(Instant::now).elapsed().as_nanos() as u64;
        self.looked_at.store(now, Ordering::Relaxed);
        self.asked_at.store(now, Ordering::Relaxed);
        is_interrupted
    }

    /// Waits until `has_ended` returns true, and asks the hook meanwhile. Who makes it true has to unpark the calling thread.
    pub fn wait(&self, has_ended: impl Fn() -> bool) {
        while !has_ended() {
            thread::park_timeout(INTERVAL);
            let hook = self.hook.filter(|_| !is_pool_thread() && !self.is_interrupted.load(Ordering::Relaxed));
            if hook.is_some_and(ask) {
                self.is_interrupted.store(true, Ordering::Relaxed);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::for_each_chunk_watched;

    /// A watch whose hook interrupts at once.
    fn interrupted() -> Watch {
        Watch { hook: Some(|| true), ..Watch::never() }
    }

    #[test]
    fn an_interruption_during_the_last_chunk_is_an_error_although_all_are_done() {
        static HAS_BEGUN: AtomicBool = AtomicBool::new(false);
        let watch = Watch { hook: Some(|| HAS_BEGUN.load(Ordering::Relaxed)), ..Watch::never() };
        let mut done = [0_u8; 10_000];
        let work = |_: usize, chunk: &mut [u8]| {
            if is_pool_thread() {
                HAS_BEGUN.store(true, Ordering::Relaxed);
                // Long enough for the calling thread to ask the hook.
                thread::sleep(4 * INTERVAL);
            }
            while !HAS_BEGUN.load(Ordering::Relaxed) {
                thread::yield_now();
            }
            chunk.fill(1);
            Ok(())
        };
        let ended = for_each_chunk_watched(&watch, Some(2), &mut done, 5_000, work);
        assert_eq!(ended, Err(Error::Interrupted));
        assert!(done == [1; 10_000]);
    }

    #[test]
    fn a_loop_of_any_speed_ends() {
        for pause in [Duration::ZERO, Duration::from_micros(10), Duration::from_millis(30)] {
            let watch = interrupted();
            while !watch.is_interrupted() {
                thread::sleep(pause);
            }
            assert_eq!((watch.check(), watch.end()), (Err(Error::Interrupted), Err(Error::Interrupted)));
        }
    }

    #[test]
    fn who_waits_asks_the_hook() {
        let watch = interrupted();
        watch.wait(|| watch.is_interrupted.load(Ordering::Relaxed));
        assert_eq!(watch.end(), Err(Error::Interrupted));
    }

    #[test]
    fn a_watch_without_a_hook_never_interrupts() {
        let watch = Watch::never();
        assert!((0..10_000).all(|_| !watch.is_interrupted()));
    }
}
