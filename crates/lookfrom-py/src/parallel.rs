//! Work on several threads, without the GIL, that Ctrl-C stops.
//!
//! Threads live as long as the call that started them. So nothing is left that a fork would lose: a process that was forked
//! off calls as its parent does.

use std::num::NonZero;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use pyo3::prelude::*;

/// Interval at which the calling thread checks for signals.
const BETWEEN_LOOKS: Duration = Duration::from_millis(50);

/// The number of threads for a call that asks for `threads`: 0 stands for all cores.
fn thread_count(threads: usize) -> usize {
    // Asked once: it takes longer than a few rays.
    static CORES: OnceLock<usize> = OnceLock::new();
    match threads {
        0 => *CORES.get_or_init(|| thread::available_parallelism().map_or(1, NonZero::get)),
        _ => threads,
    }
}

/// Works on each item once, on up to `threads` threads, of which the calling one is the first. `start` makes the worker of a
/// thread, with its memory.
///
/// # Errors
/// An exception of a signal's handler, such as `KeyboardInterrupt`; some items are then left.
// Of `check_signals` itself no closure can be made, for reasons of lifetimes.
#[allow(clippy::redundant_closure_for_method_calls)]
pub(crate) fn for_each<T: Send, W: FnMut(T)>(
    py: Python<'_>,
    threads: usize,
    items: impl ExactSizeIterator<Item = T> + Send,
    start: impl Fn() -> W + Sync,
) -> PyResult<()> {
    py.detach(|| {
        let threads = thread_count(threads).min(items.len());
        let items = Mutex::new(items);
        let stopped = AtomicBool::new(false);
        let next = || {
            let mut items = items.lock().unwrap_or_else(PoisonError::into_inner);
            if stopped.load(Ordering::Relaxed) { None } else { items.next() }
        };
        thread::scope(|scope| {
            for _ in 1..threads {
                let work = || {
                    let mut work = start();
                    while let Some(item) = next() {
                        work(item);
                    }
                };
                // Where there are no more threads, fewer do the work.
                let _ = thread::Builder::new().spawn_scoped(scope, work);
            }
            let mut work = start();
            let mut looked = Instant::now();
            while let Some(item) = next() {
                work(item);
                if looked.elapsed() > BETWEEN_LOOKS {
                    if let Err(interrupt) = Python::attach(|py| py.check_signals()) {
                        stopped.store(true, Ordering::Relaxed);
                        return Err(interrupt);
                    }
                    looked = Instant::now();
                }
            }
            Ok(())
        })
    })
}

/// Runs a function that divides its work by `rayon`, on threads of its own, without the GIL.
pub(crate) fn in_pool<R: Send>(py: Python<'_>, threads: usize, run: impl FnOnce() -> R + Send) -> R {
    py.detach(|| on_threads(threads, run))
}

/// Runs a function on threads of its own, or where there are none for it, on this one.
fn on_threads<R: Send>(threads: usize, run: impl FnOnce() -> R + Send) -> R {
    match rayon::ThreadPoolBuilder::new().num_threads(thread_count(threads)).build() {
        Ok(pool) => pool.install(run),
        Err(_) => run(),
    }
}

/// Runs a function that divides its work by `rayon`, on threads of its own, without the GIL; meanwhile the calling thread looks for
/// signals and calls `look`, several times a second. Where either raises, `stop` is called, and the result is still waited for.
pub(crate) fn watched<R: Send>(
    py: Python<'_>,
    threads: usize,
    run: impl FnOnce() -> R + Send,
    mut look: impl FnMut() -> PyResult<()>,
    stop: impl Fn(),
) -> (R, PyResult<()>) {
    let caller = thread::current();
    let mut told = Ok(());
    let result = thread::scope(|scope| {
        let work = scope.spawn(|| {
            let _ending = Ending(caller);
            on_threads(threads, run)
        });
        while !work.is_finished() {
            py.detach(|| thread::park_timeout(BETWEEN_LOOKS));
            if told.is_ok() {
                told = py.check_signals().and_then(|()| look());
                if told.is_err() {
                    stop();
                }
            }
        }
        work.join()
    });
    (result.unwrap_or_else(|panic| std::panic::resume_unwind(panic)), told)
}

/// Wakes the calling thread at the end of the work, also by a panic.
struct Ending(thread::Thread);

impl Drop for Ending {
    fn drop(&mut self) {
        self.0.unpark();
    }
}
