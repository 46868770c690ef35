//! Data-parallel loops: on rayon's threads with the feature `parallel`, on the caller's thread without it.
//!
//! Each result has a fixed position, so that results are the same for any number of threads. Closures of loops are
//! type-erased (`dyn Fn`): one instance of rayon's task code.

use std::sync::Mutex;

use lookfrom_scene::Result;
#[cfg(feature = "parallel")]
use lookfrom_scene::{Error, ErrorKind, Location};

/// The most threads of a render: more than machines have processors. Many more would mostly wait for each other.
pub const MOST_THREADS: usize = 1024;

/// Tasks that [`collect`] makes at most.
const MOST_TASKS: usize = 4096;

/// Calls `each` with every number below `count`.
fn for_each(count: usize, each: &(dyn Fn(usize) + Sync)) {
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        (0..count).into_par_iter().for_each(each);
    }
    #[cfg(not(feature = "parallel"))]
    (0..count).for_each(each);
}

/// `make(i)` for each `i` below `count`, in order.
pub(crate) fn collect<T: Send>(count: usize, make: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let size = count.div_ceil(MOST_TASKS).max(1);
    let mut pieces = Vec::new();
    pieces.resize_with(count.div_ceil(size), Vec::new);
    for_chunks_mut(&mut pieces, 1, |number, piece| {
        piece[0] = (number * size..count.min((number + 1) * size)).map(&make).collect();
    });
    pieces.into_iter().flatten().collect()
}

/// Calls `each` with the index and the elements of every chunk of `size` elements; the last chunk may be shorter.
///
/// # Panics
/// If `size` is 0.
pub(crate) fn for_chunks_mut<T: Send>(items: &mut [T], size: usize, each: impl Fn(usize, &mut [T]) + Sync) {
    let chunks: Vec<_> = items.chunks_mut(size).map(Mutex::new).collect();
    for_each(chunks.len(), &|number| {
        each(number, &mut chunks[number].lock().expect("each is locked once"));
    });
}

/// The number of threads that loops use.
pub(crate) fn threads() -> usize {
    #[cfg(feature = "parallel")]
    return rayon::current_num_threads();
    #[cfg(not(feature = "parallel"))]
    1
}

/// Runs both closures, in parallel if possible, and returns both results.
#[cfg(feature = "parallel")]
pub(crate) fn join<A: Send, B: Send>(
    one: impl FnOnce() -> A + Send,
    other: impl FnOnce() -> B + Send,
) -> (A, B) {
    rayon::join(one, other)
}

/// Runs both closures and returns both results.
#[cfg(not(feature = "parallel"))]
pub(crate) fn join<A, B>(one: impl FnOnce() -> A, other: impl FnOnce() -> B) -> (A, B) {
    (one(), other())
}

/// Runs `work` so that its parallel loops use `threads` threads, but at most [`MOST_THREADS`] (`None`: one per hardware thread).
///
/// # Errors
/// `Limit` if the threads cannot be started.
#[cfg(feature = "parallel")]
pub(crate) fn on_threads<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> Result<T> {
    let threads = threads.map_or(0, |threads| threads.min(MOST_THREADS));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|error| Error::new(ErrorKind::Limit, &Location::default(), error.to_string()))?;
    Ok(pool.install(work))
}

/// Runs `work` on the caller's thread, whatever `threads` is.
///
/// # Errors
/// None.
#[cfg(not(feature = "parallel"))]
pub(crate) fn on_threads<T>(_threads: Option<usize>, work: impl FnOnce() -> T) -> Result<T> {
    Ok(work())
}

#[cfg(all(test, feature = "parallel"))]
mod tests {
    use crate::core::parallel::{MOST_THREADS, on_threads, threads};

    #[test]
    fn no_number_of_threads_is_too_large() {
        assert_eq!(on_threads(Some(3), threads).expect("threads"), 3);
        assert_eq!(on_threads(Some(usize::MAX), threads).expect("threads"), MOST_THREADS);
    }
}
