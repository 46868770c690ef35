//! A memory budget: one limit for all that files make us allocate.
//!
//! Memory is reserved before it is allocated, by the size that the file claims; a [`Reservation`] gives its bytes
//! back when it is dropped. What stays in a scene is kept by the [`LoadContext`](crate::LoadContext) that reads it. Large arrays
//! are counted by their lengths, parsed text by an estimate from its length, and small things not at all. Readers may
//! turn an error into a warning (a picture becomes white), but not this one: a budget remembers that it refused.

mod machine;

use std::ops::Deref;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use crate::error::{Error, ErrorKind, Location, Result};
use crate::remedy::Remedy;

/// A limit in bytes, and how much of it is reserved. Clones share both.
#[derive(Clone, Debug)]
pub struct Budget(Arc<Account>);

#[derive(Debug)]
struct Account {
    limit: u64,
    reserved: AtomicU64,
    /// The error of the first reservation that was refused.
    refusal: Mutex<Option<Error>>,
}

/// The budget of this machine: three quarters of the memory that the process may use, by the machine, by its control group
/// (cgroup, version 1 or 2) and by its own limit (`ulimit -v`), so far as Linux tells; 8 GiB elsewhere.
impl Default for Budget {
    fn default() -> Self {
        Self::new(machine::memory() / 4 * 3)
    }
}

impl Budget {
    /// A budget of `limit` bytes, of which none is reserved.
    pub fn new(limit: u64) -> Self {
        Self(Arc::new(Account { limit, reserved: AtomicU64::new(0), refusal: Mutex::new(None) }))
    }

    /// The limit in bytes.
    pub fn limit(&self) -> u64 {
        self.0.limit
    }

    /// The bytes that are not reserved.
    pub fn left(&self) -> u64 {
        self.0.limit - self.0.reserved.load(Ordering::Relaxed)
    }

    /// Reserves bytes for `what` (a noun phrase, for messages), which is about to be allocated.
    ///
    /// # Errors
    /// `Limit` if fewer are left.
    pub fn reserve(&self, bytes: u64, what: &str, at: &Location) -> Result<Reservation> {
        let limit = self.0.limit;
        let more = |reserved: u64| reserved.checked_add(bytes).filter(|&sum| sum <= limit);
        match self.0.reserved.fetch_update(Ordering::Relaxed, Ordering::Relaxed, more) {
            Ok(_) => Ok(Reservation { account: self.0.clone(), bytes }),
            Err(reserved) => {
                let error = refusal(bytes, what, at, limit, limit - reserved);
                self.0.first_refusal().get_or_insert(error.clone());
                Err(error)
            }
        }
    }

    /// The error of the first reservation that was refused since the last call.
    pub fn take_refusal(&self) -> Option<Error> {
        self.0.first_refusal().take()
    }
}

impl Account {
    fn first_refusal(&self) -> std::sync::MutexGuard<'_, Option<Error>> {
        self.refusal.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn refusal(bytes: u64, what: &str, at: &Location, limit: u64, left: u64) -> Error {
    let [wanted, left, limit] = [bytes, left, limit].map(in_units);
    let message =
        format!("{what} takes {wanted} of memory, but of the limit of {limit} only {left} are left");
    Error::new(ErrorKind::Limit, at, message).hint(Remedy::MoreMemory)
}

/// Bytes in the largest unit of which there is at least one.
fn in_units(bytes: u64) -> String {
    let units = [("EiB", 60), ("PiB", 50), ("TiB", 40), ("GiB", 30), ("MiB", 20), ("KiB", 10)];
    match units.into_iter().find(|(_, shift)| bytes >> shift > 0) {
        Some((unit, shift)) => format!("{:.1} {unit}", bytes as f64 / (1_u64 << shift) as f64),
        None => format!("{bytes} bytes"),
    }
}

/// Reserved bytes, given back when this is dropped.
#[derive(Debug)]
pub struct Reservation {
    account: Arc<Account>,
    bytes: u64,
}

impl Reservation {
    /// The number of bytes.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Takes over the bytes of another one of the same budget.
    pub fn join(&mut self, mut other: Self) {
        self.bytes += std::mem::take(&mut other.bytes);
    }

    /// Gives back all but `bytes` of it.
    pub fn shrink(&mut self, bytes: u64) {
        let less = self.bytes.saturating_sub(bytes);
        self.account.reserved.fetch_sub(less, Ordering::Relaxed);
        self.bytes -= less;
    }
}

impl Drop for Reservation {
    fn drop(&mut self) {
        self.shrink(0);
    }
}

/// A value with the memory that is reserved for it.
#[derive(Debug)]
pub struct Reserved<T> {
    value: T,
    /// `None` for a value that takes none of the budget.
    _memory: Option<Reservation>,
}

impl<T> Reserved<T> {
    /// A value in this memory.
    pub fn new(value: T, memory: Reservation) -> Self {
        Self { value, _memory: Some(memory) }
    }
}

/// A value outside of every budget: for tests and small things.
impl<T> From<T> for Reserved<T> {
    fn from(value: T) -> Self {
        Self { value, _memory: None }
    }
}

impl AsRef<[u8]> for Reserved<Vec<u8>> {
    fn as_ref(&self) -> &[u8] {
        &self.value
    }
}

impl<T> Deref for Reserved<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn what_is_reserved_is_given_back() {
        let at = Location::file(Path::new("a.ply"));
        let budget = Budget::new(100);
        let mut first = budget.reserve(60, "a mesh", &at).expect("there are 100");
        let shared = budget.clone();
        assert_eq!(shared.left(), 40);
        let error = shared.reserve(41, "a picture", &at).expect_err("only 40 are left");
        assert_eq!(error.kind, ErrorKind::Limit);
        let message =
            "a picture takes 41 bytes of memory, but of the limit of 100 bytes only 40 bytes are left";
        assert_eq!((&*error.at.file, &*error.message), ("a.ply", message));
        assert_eq!(budget.take_refusal(), Some(error));
        assert_eq!(budget.take_refusal(), None);
        first.shrink(10);
        first.shrink(20);
        assert_eq!((first.bytes(), budget.left()), (10, 90));
        first.join(budget.reserve(5, "more", &at).expect("there are 90"));
        assert_eq!((first.bytes(), budget.left()), (15, 85));
        drop(Reserved::new((), first));
        assert_eq!(budget.left(), 100);
        assert!(budget.reserve(u64::MAX, "everything", &at).is_err());
    }

    #[test]
    fn threads_together_get_no_more_than_the_limit() {
        let (budget, at) = (Budget::new(1000), Location::default());
        let reserve = || (0..300).filter_map(|_| budget.reserve(1, "a byte", &at).ok()).collect::<Vec<_>>();
        let kept: Vec<_> = std::thread::scope(|scope| {
            let threads: Vec<_> = (0..4).map(|_| scope.spawn(reserve)).collect();
            threads.into_iter().map(|thread| thread.join().expect("it does not panic")).collect()
        });
        assert_eq!(kept.iter().map(Vec::len).sum::<usize>(), 1000);
        assert_eq!(budget.left(), 0);
    }

    #[test]
    fn sizes_are_told_in_units() {
        let told = [0, 1023, 1024, 1536 << 20, 1 << 40, u64::MAX].map(in_units);
        assert_eq!(told, ["0 bytes", "1023 bytes", "1.0 KiB", "1.5 GiB", "1.0 TiB", "16.0 EiB"]);
    }
}
