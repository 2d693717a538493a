//! The threads that batches run on.

use std::collections::BTreeMap;
use std::num::NonZero;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

use rayon::ThreadPool;
use rayon::prelude::*;

use crate::error::Error;

/// The largest number of threads that may be asked for.
pub const MAX_THREADS: usize = 1024;

/// Pools that were started, by process and number of threads.
///
/// A process that was forked has its parent's memory but none of its threads: its pools have to be its own.
static POOLS: Mutex<BTreeMap<(u32, usize), Arc<ThreadPool>>> = Mutex::new(BTreeMap::new());

/// Fewer elements than this are not worth waking a thread for.
const WORTH_SHARING: usize = 4096;

/// Calls `work(index, chunk)` for each chunk of `length` elements, on `threads` threads or, if `None`, on all cores.
///
/// # Errors
/// Zero threads, more than 1024, or none to be had from the system.
pub fn for_each_chunk<T: Send>(
    threads: Option<usize>,
    elements: &mut [T],
    length: usize,
    work: impl Fn(usize, &mut [T]) + Sync,
) -> Result<(), Error> {
    match workers(threads, elements.len())? {
        None => elements.chunks_mut(length).enumerate().for_each(|(index, chunk)| work(index, chunk)),
        Some(pool) => pool.install(|| {
            elements.par_chunks_mut(length).enumerate().for_each(|(index, chunk)| work(index, chunk));
        }),
    }
    Ok(())
}

/// Whether something holds of each chunk of `length` elements, as seen by `threads` threads or, if `None`, as many as there are cores.
///
/// # Errors
/// Those of [`for_each_chunk`].
pub fn all_chunks<T: Sync>(
    threads: Option<usize>,
    elements: &[T],
    length: usize,
    holds: impl Fn(&[T]) -> bool + Sync + Send,
) -> Result<bool, Error> {
    Ok(match workers(threads, elements.len())? {
        None => holds(elements),
        Some(pool) => pool.install(|| elements.par_chunks(length).all(holds)),
    })
}

/// The threads that share so many elements, or none if the caller's is to do it alone.
fn workers(threads: Option<usize>, elements: usize) -> Result<Option<Arc<ThreadPool>>, Error> {
    match sharing(threads, elements)? {
        1 => Ok(None),
        threads => pool(threads).map(Some),
    }
}

/// How many threads share so many elements.
///
/// # Errors
/// Zero threads, or more than 1024.
pub fn sharing(threads: Option<usize>, elements: usize) -> Result<usize, Error> {
    /// Asked once: the system reads several files to tell.
    static CORES: LazyLock<usize> =
        LazyLock::new(|| std::thread::available_parallelism().map_or(1, NonZero::get).min(MAX_THREADS));
    if let Some(count @ (0 | 1025..)) = threads {
        return Err(Error::Count { name: "threads", value: count, needed: "in 1..1024" });
    }
    Ok(if elements < WORTH_SHARING { 1 } else { threads.unwrap_or_else(|| *CORES) })
}

fn pool(threads: usize) -> Result<Arc<ThreadPool>, Error> {
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    let key = (std::process::id(), threads);
    if let Some(pool) = pools.get(&key) {
        return Ok(Arc::clone(pool));
    }
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads);
    let pool = builder.build().map_err(|error| Error::Threads { threads, reason: error.to_string() })?;
    let pool = Arc::new(pool);
    pools.insert(key, Arc::clone(&pool));
    Ok(pool)
}
