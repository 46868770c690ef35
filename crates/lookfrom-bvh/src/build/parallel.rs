//! Parallel helpers: on several threads with the feature `parallel`, sequential without it. Results are the same.

/// Minimum number of items per task.
pub(super) const GRAIN: usize = 4096;

/// Runs both closures, in parallel if possible, and returns both results.
#[cfg(feature = "parallel")]
pub(super) fn join<A: Send, B: Send>(
    one: impl FnOnce() -> A + Send,
    other: impl FnOnce() -> B + Send,
) -> (A, B) {
    rayon::join(one, other)
}

/// Runs both closures and returns both results.
#[cfg(not(feature = "parallel"))]
pub(super) fn join<A, B>(one: impl FnOnce() -> A, other: impl FnOnce() -> B) -> (A, B) {
    (one(), other())
}

/// The results of a function for each number below `count`, in order; each task has at least `grain` of them.
#[cfg(feature = "parallel")]
pub(super) fn collect<T: Send>(
    count: usize,
    grain: usize,
    make: impl Fn(usize) -> T + Send + Sync,
) -> Vec<T> {
    use rayon::prelude::*;
    (0..count).into_par_iter().with_min_len(grain).map(make).collect()
}

/// The results of a function for each number below `count`, in order.
#[cfg(not(feature = "parallel"))]
pub(super) fn collect<T>(count: usize, _grain: usize, make: impl Fn(usize) -> T) -> Vec<T> {
    (0..count).map(make).collect()
}

/// The results of a function for each chunk of a few thousand items of a slice, in order.
pub(super) fn chunks<T: Sync, U: Send>(items: &[T], make: impl Fn(&[T]) -> U + Send + Sync) -> Vec<U> {
    let chunk = |number: usize| &items[number * GRAIN..items.len().min((number + 1) * GRAIN)];
    collect(items.len().div_ceil(GRAIN), 1, |number| make(chunk(number)))
}
