//! Two things at once where the feature `parallel` is on, and one after the other where it is not. Results are the same.

/// Less than this is one thread's work.
pub(super) const GRAIN: usize = 4096;

/// Both answers.
#[cfg(feature = "parallel")]
pub(super) fn join<A: Send, B: Send>(
    one: impl FnOnce() -> A + Send,
    other: impl FnOnce() -> B + Send,
) -> (A, B) {
    rayon::join(one, other)
}

/// Both answers.
#[cfg(not(feature = "parallel"))]
pub(super) fn join<A, B>(one: impl FnOnce() -> A, other: impl FnOnce() -> B) -> (A, B) {
    (one(), other())
}

/// The results of a function for each number below `count`, in order; `grain` of them at least are one thread's work.
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

/// The results of a function for each few thousand items of a slice, in order.
pub(super) fn chunks<T: Sync, U: Send>(items: &[T], make: impl Fn(&[T]) -> U + Send + Sync) -> Vec<U> {
    let chunk = |number: usize| &items[number * GRAIN..items.len().min((number + 1) * GRAIN)];
    collect(items.len().div_ceil(GRAIN), 1, |number| make(chunk(number)))
}
