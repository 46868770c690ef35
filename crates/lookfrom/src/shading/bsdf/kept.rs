//! Values that BSDFs refer to, each made once and kept as long as the process: BSDFs are copied.

use std::sync::{Mutex, PoisonError};

/// Values of a kind.
pub(super) struct Kept<T: 'static>(Mutex<Vec<&'static T>>);

impl<T> Kept<T> {
    pub(super) const fn new() -> Self {
        Self(Mutex::new(Vec::new()))
    }

    /// The value that is the one, or a new one. It is not made under the lock: a thread that waits for others may do other work
    /// meanwhile, which may want a value, too.
    pub(super) fn get(&self, is_the_one: impl Fn(&T) -> bool, make: impl FnOnce() -> T) -> &'static T {
        let kept = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let known = |kept: &[&'static T]| kept.iter().copied().find(|known| is_the_one(known));
        if let Some(known) = known(&kept()) {
            return known;
        }
        let made = make();
        let mut kept = kept();
        known(&kept).unwrap_or_else(|| {
            let made: &'static T = Box::leak(Box::new(made));
            kept.push(made);
            made
        })
    }
}
