//! Batches: sharing the work between threads, and checking that all rows are finite.

use std::num::NonZero;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rayon::ThreadPool;

use crate::crew;
use crate::error::Error;
use crate::fork::Lock;
use crate::interrupt::{Watch, is_pool_thread};
use crate::lazy::Lazy;

/// Largest number of threads that a caller may ask for.
pub const MAX_THREADS: usize = 1024;

/// Number of thread pools that are kept for later calls.
const MAX_POOLS: usize = 4;

/// The thread pools that were used last, each with another number of threads.
static POOLS: Lock<Pools> = Lock::new(Pools { process: 0, last_used: Vec::new() });

struct Pools {
    /// The process that started the threads. A forked process inherits the memory of its parent, but none of its threads.
    process: u32,
    /// At most [`MAX_POOLS`] pools, the most recently used one at the end.
    last_used: Vec<Arc<ThreadPool>>,
}

/// Smallest batch, in elements, that is shared between threads.
const MIN_SHARED: usize = 4096;

/// Number of rows that one thread checks at a time.
const ROWS_PER_CHECK: usize = 4096;

/// Calls `work(index, chunk)` for each chunk of `length` elements, on `threads` threads (default: all cores). The last chunk
/// may be shorter.
///
/// # Errors
/// - [`Error::Count`]: `threads` is 0 or more than 1024.
/// - [`Error::Threads`]: the system could not start the threads.
/// - An error of `work`. Some chunks are not worked on then.
/// - [`Error::Interrupted`]: the call was interrupted. Some chunks may not be worked on then.
pub fn for_each_chunk<T: Send>(
    threads: Option<usize>,
    elements: &mut [T],
    length: usize,
    work: impl Fn(usize, &mut [T]) -> Result<(), Error> + Sync,
) -> Result<(), Error> {
    for_each_chunk_watched(&Watch::new(), threads, elements, length, work)
}

/// The same for elements that take the work of `weight` elements each, such as a number for a whole scan.
///
/// # Errors
/// Those of [`for_each_chunk`].
pub fn for_each_heavy_chunk<T: Send>(
    threads: Option<usize>,
    elements: &mut [T],
    weight: usize,
    length: usize,
    work: impl Fn(usize, &mut [T]) -> Result<(), Error> + Sync,
) -> Result<(), Error> {
    for_each_heavy_chunk_watched(&Watch::new(), threads, elements, weight, length, work)
}

/// The same with a watch of the caller, which `work` may look at if a chunk takes long.
///
/// # Errors
/// Those of [`for_each_chunk`].
pub fn for_each_heavy_chunk_watched<T: Send>(
    watch: &Watch,
    threads: Option<usize>,
    elements: &mut [T],
    weight: usize,
    length: usize,
    work: impl Fn(usize, &mut [T]) -> Result<(), Error> + Sync,
) -> Result<(), Error> {
    let pool = pool_for(threads, elements.len().saturating_mul(weight))?;
    for_each_chunk_in(pool, watch, elements, length, work)
}

/// The same with a watch of the caller, which `work` may look at if a chunk takes long.
///
/// # Errors
/// Those of [`for_each_chunk`].
pub fn for_each_chunk_watched<T: Send>(
    watch: &Watch,
    threads: Option<usize>,
    elements: &mut [T],
    length: usize,
    work: impl Fn(usize, &mut [T]) -> Result<(), Error> + Sync,
) -> Result<(), Error> {
    for_each_chunk_in(pool_for(threads, elements.len())?, watch, elements, length, work)
}

fn for_each_chunk_in<T: Send>(
    pool: Option<Arc<ThreadPool>>,
    watch: &Watch,
    elements: &mut [T],
    length: usize,
    work: impl Fn(usize, &mut [T]) -> Result<(), Error> + Sync,
) -> Result<(), Error> {
    let count = elements.len().div_ceil(length);
    let work = |(index, chunk): (usize, &mut [T])| watch.check().and_then(|()| work(index, chunk));
    let Some(pool) = pool.filter(|_| count > 1) else {
        elements.chunks_mut(length).enumerate().try_for_each(work)?;
        return watch.end();
    };
    let chunks = Mutex::new(elements.chunks_mut(length).enumerate());
    let failure: Mutex<Option<(usize, Error)>> = Mutex::new(None);
    let next = || locked(&chunks).next();
    crew::work(&pool, helpers(&pool, count), watch, &|| {
        while let Some((index, chunk)) = next() {
            let Err(error) = work((index, chunk)) else { continue };
            *locked(&chunks) = <&mut [T]>::default().chunks_mut(length).enumerate();
            let mut failure = locked(&failure);
            // The chunks before this one have all been begun, so the first error is the same for any number of threads.
            if failure.as_ref().is_none_or(|&(first, _)| index < first) {
                *failure = Some((index, error));
            }
        }
    });
    if let Some((_, error)) = locked(&failure).take() {
        return Err(error);
    }
    // If the call was interrupted while the last chunks were worked on, the exception of the hook must not get lost.
    watch.end()
}

/// Returns how many threads of a pool help the calling thread with some chunks.
fn helpers(pool: &ThreadPool, chunks: usize) -> usize {
    // A pool thread gets no help: those who could help may wait for what it does.
    if is_pool_thread() { 0 } else { pool.current_num_threads().min(chunks - 1) }
}

/// Locks a mutex that only one call uses, in which nothing panics.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns true if `holds` is true for every chunk of `length` elements; runs on `threads` threads (default: all cores).
///
/// # Errors
/// Those of [`for_each_chunk`].
pub fn all_chunks<T: Sync>(
    threads: Option<usize>,
    elements: &[T],
    length: usize,
    holds: impl Fn(&[T]) -> bool + Sync + Send,
) -> Result<bool, Error> {
    let watch = Watch::new();
    let (next, all) = (AtomicUsize::new(0), AtomicBool::new(true));
    let check = || {
        while all.load(Ordering::Relaxed) && !watch.is_interrupted() {
            let start = next.fetch_add(length, Ordering::Relaxed);
            let Some(rest) = elements.get(start..).filter(|rest| !rest.is_empty()) else { break };
            if !holds(&rest[..length.min(rest.len())]) {
                all.store(false, Ordering::Relaxed);
            }
        }
    };
    match pool_for(threads, elements.len())?.filter(|_| elements.len() > length) {
        None => check(),
        Some(pool) => crew::work(&pool, helpers(&pool, elements.len().div_ceil(length)), &watch, &check),
    }
    watch.end()?;
    Ok(all.into_inner())
}

/// Checks that every row is finite, on `threads` threads (default: all cores).
///
/// # Errors
/// - [`Error::Row`]: names the first row that is not finite.
/// - Those of [`for_each_chunk`].
pub fn check_rows(name: &'static str, rows: &[[f64; 3]], threads: Option<usize>) -> Result<(), Error> {
    // This loop has no early exit, so the compiler can vectorise it. The bad row is searched for only if there is one.
    let are_finite = |rows: &[[f64; 3]]| rows.as_flattened().iter().fold(true, |all, number| all & number.is_finite());
    if all_chunks(threads, rows, ROWS_PER_CHECK, are_finite)? {
        return Ok(());
    }
    let is_finite = |row: &[f64; 3]| row.iter().all(|number| number.is_finite());
    let row = rows.iter().position(|row| !is_finite(row)).unwrap_or(0);
    Err(Error::Row { name, row, value: rows[row] })
}

/// Returns the number of threads that work on a batch of this many elements.
///
/// # Errors
/// [`Error::Count`]: `threads` is 0 or more than 1024.
pub fn thread_count(threads: Option<usize>, elements: usize) -> Result<usize, Error> {
    /// Number of cores. Determined once, because the system reads several files for it.
    static CORES: Lazy<usize> = Lazy::new();
    if let Some(count @ (0 | 1025..)) = threads {
        return Err(Error::Count { name: "threads", value: count, needed: "in 1..1024" });
    }
    let cores = || Ok(std::thread::available_parallelism().map_or(1, NonZero::get).min(MAX_THREADS));
    match threads {
        _ if elements < MIN_SHARED => Ok(1),
        Some(threads) => Ok(threads),
        None => CORES.get_or_build(cores).copied(),
    }
}

/// Returns the pool that helps the calling thread with a batch of this many elements; `None` if it needs no help.
fn pool_for(threads: Option<usize>, elements: usize) -> Result<Option<Arc<ThreadPool>>, Error> {
    match thread_count(threads, elements)? {
        1 => Ok(None),
        threads => pool(threads - 1).map(Some),
    }
}

/// Returns a pool of this many threads. A pool that is not kept any longer ends with the last call that uses it.
fn pool(threads: usize) -> Result<Arc<ThreadPool>, Error> {
    let mut pools = POOLS.lock();
    let process = std::process::id();
    if pools.process != process {
        // To end a pool is to talk to its threads, which do not exist here.
        std::mem::forget(std::mem::take(&mut pools.last_used));
        pools.process = process;
    }
    let pools = &mut pools.last_used;
    if let Some(index) = pools.iter().position(|pool| pool.current_num_threads() == threads) {
        pools[index..].rotate_left(1);
    } else {
        let builder = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = builder.build().map_err(|error| Error::Threads { threads, reason: error.to_string() })?;
        if !is_pool_thread() {
            // Waits until all threads have started, so that no fork cuts what they set up once for each process. A pool
            // thread would run other tasks meanwhile. For its pool, all this is set up.
            pool.broadcast(|_| ());
        }
        if pools.len() == MAX_POOLS {
            pools.remove(0);
        }
        pools.push(Arc::new(pool));
    }
    Ok(Arc::clone(&pools[pools.len() - 1]))
}
