//! Data-parallel loops: on rayon's threads with the feature `parallel`, on the caller's thread without it.
//!
//! Each result has a fixed position, so that results are the same for any number of threads.

use lookfrom_scene::Result;
#[cfg(feature = "parallel")]
use lookfrom_scene::{Error, ErrorKind, Location};

/// `make(i)` for each `i` below `count`, in order.
#[cfg(feature = "parallel")]
pub(crate) fn collect<T: Send>(count: usize, make: impl Fn(usize) -> T + Send + Sync) -> Vec<T> {
    use rayon::prelude::*;
    (0..count).into_par_iter().map(make).collect()
}

/// `make(i)` for each `i` below `count`, in order.
#[cfg(not(feature = "parallel"))]
pub(crate) fn collect<T>(count: usize, make: impl Fn(usize) -> T) -> Vec<T> {
    (0..count).map(make).collect()
}

/// Calls `each` with the index and the elements of every chunk of `size` elements; the last chunk may be shorter.
///
/// # Panics
/// If `size` is 0.
#[cfg(feature = "parallel")]
pub(crate) fn for_chunks_mut<T: Send>(
    items: &mut [T],
    size: usize,
    each: impl Fn(usize, &mut [T]) + Send + Sync,
) {
    use rayon::prelude::*;
    items.par_chunks_mut(size).enumerate().for_each(|(number, chunk)| each(number, chunk));
}

/// Calls `each` with the index and the elements of every chunk of `size` elements; the last chunk may be shorter.
///
/// # Panics
/// If `size` is 0.
#[cfg(not(feature = "parallel"))]
pub(crate) fn for_chunks_mut<T>(items: &mut [T], size: usize, each: impl Fn(usize, &mut [T])) {
    items.chunks_mut(size).enumerate().for_each(|(number, chunk)| each(number, chunk));
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

/// Runs `work` so that its parallel loops use `threads` threads (`None`: one per hardware thread).
///
/// # Errors
/// `Limit` if the threads cannot be started.
#[cfg(feature = "parallel")]
pub(crate) fn on_threads<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> Result<T> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build();
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
