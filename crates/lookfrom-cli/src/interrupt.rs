//! Ctrl-C and SIGTERM. While a picture is rendered, the first signal requests a stop that keeps the picture so far; a second
//! one, or one while there is nothing to keep, ends the process at once.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::exit::{INTERRUPTED, say};

static ASKED: AtomicBool = AtomicBool::new(false);
static SOMETHING_TO_KEEP: AtomicBool = AtomicBool::new(false);

/// Installs the signal handler. Call it once.
pub(crate) fn listen() {
    let listening = ctrlc::set_handler(|| {
        let asked_before = ASKED.swap(true, Ordering::SeqCst);
        if asked_before || !SOMETHING_TO_KEEP.load(Ordering::SeqCst) {
            std::process::exit(INTERRUPTED.into());
        }
    });
    if let Err(error) = listening {
        say(&format!("warning: Ctrl-C will end the process at once, without writing the picture: {error}"));
    }
}

/// Whether a stop was requested.
pub(crate) fn asked() -> bool {
    ASKED.load(Ordering::SeqCst)
}

/// Runs work that checks [`asked`] by itself and keeps its result when stopped.
pub(crate) fn keeping<T>(work: impl FnOnce() -> T) -> T {
    SOMETHING_TO_KEEP.store(true, Ordering::SeqCst);
    let result = work();
    SOMETHING_TO_KEEP.store(false, Ordering::SeqCst);
    result
}
