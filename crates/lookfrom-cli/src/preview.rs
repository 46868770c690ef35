//! The picture so far, written again and again while it is made, by a thread of its own.

use std::sync::Mutex;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::{Duration, Instant};

use lookfrom::film::{Film, Picture};

/// Says when it is time for another picture, and hands it on.
pub(crate) struct Preview {
    every: Duration,
    last: Mutex<Instant>,
    sender: SyncSender<Picture>,
}

impl Preview {
    /// Starts the clock. Who writes takes pictures from the receiver until there are no more.
    pub(crate) fn start(every: Duration) -> (Self, Receiver<Picture>) {
        let (sender, receiver) = sync_channel(0);
        (Self { every, last: Mutex::new(Instant::now()), sender }, receiver)
    }

    /// Hands on the film's picture if it is time; not if the last one is still being written.
    pub(crate) fn look(&self, film: &Film) {
        let Ok(mut last) = self.last.try_lock() else { return };
        if last.elapsed() >= self.every && self.sender.try_send(film.picture()).is_ok() {
            *last = Instant::now();
        }
    }
}
