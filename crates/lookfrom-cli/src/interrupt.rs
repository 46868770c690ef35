//! Ctrl-C and SIGTERM: while a picture is being made, the first asks for an end that keeps what there is; the second, or one
//! when there is nothing to keep, ends at once.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::exit::{INTERRUPTED, say};

static ASKED: AtomicBool = AtomicBool::new(false);
static SOMETHING_TO_KEEP: AtomicBool = AtomicBool::new(false);

/// Listens from now on. Call it once.
pub(crate) fn listen() {
    let listening = ctrlc::set_handler(|| {
        let asked_before = ASKED.swap(true, Ordering::SeqCst);
        if asked_before || !SOMETHING_TO_KEEP.load(Ordering::SeqCst) {
            std::process::exit(INTERRUPTED.into());
        }
    });
    if let Err(error) = listening {
        say(&format!("warning: Ctrl-C will end at once, without a picture: {error}"));
    }
}

/// Whether an end was asked for.
pub(crate) fn asked() -> bool {
    ASKED.load(Ordering::SeqCst)
}

/// Does work that heeds [`asked`] by itself and keeps what there is.
pub(crate) fn keeping<T>(work: impl FnOnce() -> T) -> T {
    SOMETHING_TO_KEEP.store(true, Ordering::SeqCst);
    let result = work();
    SOMETHING_TO_KEEP.store(false, Ordering::SeqCst);
    result
}
