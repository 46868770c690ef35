//! Data-parallel maps: on rayon's threads with the feature `parallel`, on the caller's thread without it.
//!
//! Results come in the order of the items, so that they are the same for any number of threads. Closures are
//! type-erased (`dyn Fn`): one instance of rayon's task code.

use std::sync::Mutex;

/// `make(item)` for each item, in order.
pub(crate) fn map<T: Send, U: Send>(items: Vec<T>, make: impl Fn(T) -> U + Sync) -> Vec<U> {
    let slots: Vec<_> = items.into_iter().map(|item| Mutex::new((Some(item), None))).collect();
    for_each(slots.len(), &|number| {
        let mut slot = slots[number].lock().expect("each is locked once");
        slot.1 = slot.0.take().map(&make);
    });
    slots.into_iter().filter_map(|slot| slot.into_inner().expect("no task has failed").1).collect()
}

fn for_each(count: usize, each: &(dyn Fn(usize) + Sync)) {
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        (0..count).into_par_iter().for_each(each);
    }
    #[cfg(not(feature = "parallel"))]
    (0..count).for_each(each);
}

/// The number of threads that [`map`] uses.
pub(crate) fn threads() -> usize {
    #[cfg(feature = "parallel")]
    return rayon::current_num_threads();
    #[cfg(not(feature = "parallel"))]
    1
}
