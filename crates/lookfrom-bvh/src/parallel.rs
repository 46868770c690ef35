//! Parallel loops: on rayon's threads with the feature `parallel`, on the caller's thread without it. Results are the same.
//!
//! Closures of loops are type-erased (`dyn Fn`) where results need not be written in place: one instance of rayon's task code.

use std::sync::Mutex;

/// Minimum number of small items per task.
pub(crate) const GRAIN: usize = 4096;

/// Calls `each` with every number below `count`.
pub(crate) fn for_each(count: usize, each: &(dyn Fn(usize) + Sync)) {
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        (0..count).into_par_iter().for_each(each);
    }
    #[cfg(not(feature = "parallel"))]
    (0..count).for_each(each);
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

/// The results of a function for each number below `count`, in order; each task has at least `grain` of them. They are written where
/// they stay: there may be a gigabyte of them.
#[cfg(feature = "parallel")]
pub(crate) fn collect<T: Send>(
    count: usize,
    grain: usize,
    make: impl Fn(usize) -> T + Sync + Send,
) -> Vec<T> {
    use rayon::prelude::*;
    (0..count).into_par_iter().with_min_len(grain).map(make).collect()
}

/// The results of a function for each number below `count`, in order.
#[cfg(not(feature = "parallel"))]
pub(crate) fn collect<T>(count: usize, _grain: usize, make: impl Fn(usize) -> T) -> Vec<T> {
    (0..count).map(make).collect()
}

/// The results of a function for each chunk of a few thousand items of a slice, in order.
pub(crate) fn chunks<T: Sync, U: Send>(items: &[T], make: impl Fn(&[T]) -> U + Sync) -> Vec<U> {
    let results: Vec<_> = items.chunks(GRAIN).map(|chunk| (chunk, Mutex::new(None))).collect();
    for_each(results.len(), &|number| {
        let (chunk, result) = &results[number];
        *result.lock().expect("each is locked once") = Some(make(chunk));
    });
    results.into_iter().filter_map(|(_, result)| result.into_inner().expect("no task has failed")).collect()
}
