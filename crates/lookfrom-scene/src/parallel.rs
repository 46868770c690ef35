//! Data-parallel maps: on rayon's threads with the feature `parallel`, on the caller's thread without it.
//!
//! Results come in the order of the items, so that they are the same for any number of threads.

/// `make(item)` for each item, in order.
#[cfg(feature = "parallel")]
pub(crate) fn map<T: Send, U: Send>(items: Vec<T>, make: impl Fn(T) -> U + Send + Sync) -> Vec<U> {
    use rayon::prelude::*;
    items.into_par_iter().map(make).collect()
}

/// `make(item)` for each item, in order.
#[cfg(not(feature = "parallel"))]
pub(crate) fn map<T, U>(items: Vec<T>, make: impl Fn(T) -> U) -> Vec<U> {
    items.into_iter().map(make).collect()
}

/// The number of threads that [`map`] uses.
pub(crate) fn threads() -> usize {
    #[cfg(feature = "parallel")]
    return rayon::current_num_threads();
    #[cfg(not(feature = "parallel"))]
    1
}
