//! The picture so far, written again and again while it is made, by a thread of its own.

use std::sync::Mutex;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::{Duration, Instant};

use lookfrom::film::{Film, Picture};

/// A picture, and how many samples a pixel it has on average, rounded down.
pub(crate) type SoFar = (Picture, u64);

/// Says when it is time for another picture, and hands it on.
pub(crate) struct Preview {
    every: Duration,
    last: Mutex<Instant>,
    sender: SyncSender<SoFar>,
}

impl Preview {
    /// Starts the clock. Who writes takes pictures from the receiver until there are no more.
    pub(crate) fn start(every: Duration) -> (Self, Receiver<SoFar>) {
        let (sender, receiver) = sync_channel(0);
        (Self { every, last: Mutex::new(Instant::now()), sender }, receiver)
    }

    /// Hands on the film's picture if it is time; not if the last one is still being written.
    pub(crate) fn look(&self, film: &Film) {
        let Ok(mut last) = self.last.try_lock() else { return };
        if last.elapsed() >= self.every && self.sender.try_send((film.picture(), mean_samples(film))).is_ok()
        {
            *last = Instant::now();
        }
    }
}

fn mean_samples(film: &Film) -> u64 {
    let area = film.area();
    let pixels = || (area.y0..area.y1).flat_map(|y| (area.x0..area.x1).map(move |x| (x, y)));
    let all: u64 = pixels().map(|(x, y)| film.samples(x, y)).sum();
    all / (pixels().count() as u64).max(1)
}
