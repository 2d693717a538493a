//! Crews: the calling thread and helpers from a thread pool that work on the same task.
//!
//! To wake a thread takes as long as a thousand beams. So the calling thread begins at once, and when nothing is left to do it
//! waits only for helpers that have begun. A helper that wakes up too late finds the door closed:
//!
//! ```text
//! caller   --work-------------------close--wait--.
//! helper 1      wake--enter--work----------leave-'
//! helper 2             wake------------------------(closed)
//! ```
//!
//! It also means that a call never waits for a helper that is busy with another call.
#![allow(unsafe_code, reason = "a task that borrows from the caller is sent to threads that outlive the call")]

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, Thread};
use std::time::{Duration, Instant};

use rayon::ThreadPool;

use crate::interrupt::Watch;

/// Time for which the calling thread looks for the end of its helpers before it sleeps. To sleep and to be woken takes longer.
const SPIN: Duration = Duration::from_micros(30);

/// A task that lives at least as long as the door to it is open, or a helper is inside.
struct Task(*const (dyn Fn() + Sync));

// SAFETY: the task may be called from any thread, because it is `Sync`.
unsafe impl Send for Task {}
// SAFETY: as above; nothing else is done with the pointer.
unsafe impl Sync for Task {}

/// What the caller and its helpers share.
struct Crew {
    task: Task,
    door: Mutex<Door>,
    caller: Thread,
}

#[derive(Default)]
struct Door {
    is_closed: bool,
    /// Number of helpers that work on the task.
    inside: usize,
    /// The first panic of a helper.
    panic: Option<Box<dyn Any + Send>>,
}

impl Crew {
    fn door(&self) -> MutexGuard<'_, Door> {
        // Nothing panics while the door is locked.
        self.door.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Works on the task, unless the caller has closed the door.
    fn help(&self) {
        {
            let mut door = self.door();
            if door.is_closed {
                return;
            }
            door.inside += 1;
        }
        // SAFETY: the caller does not return while someone is inside, so the task and what it borrows live until then.
        let result = catch_unwind(AssertUnwindSafe(|| unsafe { (*self.task.0)() }));
        let mut door = self.door();
        door.inside -= 1;
        if let Err(panic) = result {
            door.panic.get_or_insert(panic);
        }
        if door.inside == 0 && door.is_closed {
            self.caller.unpark();
        }
    }
}

/// Closes the door when the caller has nothing left to do, or panics, and waits until nobody is inside.
struct Closing<'a>(&'a Crew, &'a Watch);

impl Drop for Closing<'_> {
    fn drop(&mut self) {
        let Self(crew, watch) = self;
        crew.door().is_closed = true;
        let is_empty = || crew.door().inside == 0;
        let start = Instant::now();
        while !is_empty() {
            if start.elapsed() > SPIN {
                return watch.wait(is_empty);
            }
            for _ in 0..64 {
                std::hint::spin_loop();
            }
        }
    }
}

/// Calls `task` on the calling thread, and on up to `helpers` threads of a pool at the same time. Each call has to return when
/// nothing is left to do.
///
/// # Panics
/// If a call of the task does.
pub fn work(pool: &ThreadPool, helpers: usize, watch: &Watch, task: &(impl Fn() + Sync)) {
    // SAFETY: only the lifetime of what the task borrows is changed, which `Crew::help` and `Closing` see to.
    let lasting = unsafe { std::mem::transmute::<&(dyn Fn() + Sync), &'static (dyn Fn() + Sync)>(task) };
    let crew = Arc::new(Crew { task: Task(lasting), door: Mutex::default(), caller: thread::current() });
    {
        let _closing = Closing(&crew, watch);
        call_in(&crew, helpers, Some(pool));
        task();
    }
    if let Some(panic) = crew.door().panic.take() {
        resume_unwind(panic);
    }
}

/// Calls helpers from a pool; `None` is that of the current thread. Each calls some of the others, so that the caller can begin soon.
fn call_in(crew: &Arc<Crew>, helpers: usize, pool: Option<&ThreadPool>) {
    let mut left = helpers;
    while left > 0 {
        let own = left.div_ceil(2);
        let crew = Arc::clone(crew);
        let errand = move || {
            call_in(&crew, own - 1, None);
            crew.help();
        };
        match pool {
            Some(pool) => pool.spawn(errand),
            None => rayon::spawn(errand),
        }
        left -= own;
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    fn pool(threads: usize) -> ThreadPool {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool")
    }

    #[test]
    fn each_piece_is_worked_on_once() {
        for helpers in [0, 1, 2, 7] {
            let (pool, next) = (pool(helpers.max(1)), AtomicUsize::new(0));
            let done: Vec<_> = (0..1000).map(|_| AtomicUsize::new(0)).collect();
            work(&pool, helpers, &Watch::never(), &|| {
                while let Some(piece) = done.get(next.fetch_add(1, Ordering::Relaxed)) {
                    piece.fetch_add(1, Ordering::Relaxed);
                    thread::yield_now();
                }
            });
            assert!(done.iter().all(|piece| piece.load(Ordering::Relaxed) == 1), "{helpers} helpers");
        }
    }

    #[test]
    fn helpers_do_help() {
        let (pool, workers) = (pool(3), AtomicUsize::new(0));
        work(&pool, 3, &Watch::never(), &|| {
            workers.fetch_add(1, Ordering::Relaxed);
            while workers.load(Ordering::Relaxed) < 4 {
                thread::yield_now();
            }
        });
        assert_eq!(workers.into_inner(), 4);
    }

    #[test]
    fn a_call_does_not_wait_for_helpers_that_are_busy() {
        let (pool, is_free) = (pool(1), AtomicUsize::new(0));
        pool.in_place_scope(|scope| {
            scope.spawn(|_| {
                while is_free.load(Ordering::Relaxed) == 0 {
                    thread::yield_now();
                }
            });
            let calls = AtomicUsize::new(0);
            work(&pool, 1, &Watch::never(), &|| {
                calls.fetch_add(1, Ordering::Relaxed);
            });
            assert_eq!(calls.into_inner(), 1, "only the caller");
            is_free.store(1, Ordering::Relaxed);
        });
    }

    #[test]
    fn a_panic_ends_the_call_after_all_have_left() {
        for of_caller in [true, false] {
            let (pool, caller, workers) = (pool(2), thread::current().id(), AtomicUsize::new(0));
            let inside = AtomicUsize::new(0);
            let panics = || {
                work(&pool, 2, &Watch::never(), &|| {
                    inside.fetch_add(1, Ordering::Relaxed);
                    workers.fetch_add(1, Ordering::Relaxed);
                    while workers.load(Ordering::Relaxed) < 3 {
                        thread::yield_now();
                    }
                    let is_caller = thread::current().id() == caller;
                    thread::sleep(Duration::from_millis(if is_caller == of_caller { 0 } else { 20 }));
                    inside.fetch_sub(1, Ordering::Relaxed);
                    assert_ne!(is_caller, of_caller, "a bug");
                });
            };
            assert!(catch_unwind(AssertUnwindSafe(panics)).is_err());
            assert_eq!(inside.load(Ordering::Relaxed), 0);
        }
    }
}
