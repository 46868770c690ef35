//! Parallel loops: on rayon's threads with the feature `parallel`, on the caller's thread without it. Results are the same.
//!
//! What runs is called through trait objects where it can be, so that rayon's tasks are compiled once and not for each caller.

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

/// Runs both closures and returns both results.
pub(crate) fn join<A: Send, B: Send>(
    one: impl FnOnce() -> A + Send,
    other: impl FnOnce() -> B + Send,
) -> (A, B) {
    let (mut one, mut other) = (Some(one), Some(other));
    let (mut of_one, mut of_other) = (None, None);
    both(&mut || of_one = one.take().map(|one| one()), &mut || of_other = other.take().map(|other| other()));
    (of_one.expect("it has run"), of_other.expect("it has run"))
}

fn both(one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send)) {
    #[cfg(feature = "parallel")]
    rayon::join(one, other);
    #[cfg(not(feature = "parallel"))]
    {
        one();
        other();
    }
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
