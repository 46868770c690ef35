//! Progress: a bar on stderr, and cancellation.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use lookfrom::film::Film;
use lookfrom::render::{Progress, TileDone};

use crate::exit::stderr_is_terminal;
use crate::film::Checkpoints;
use crate::interrupt;
use crate::preview::Preview;

/// Progress of a render: the bar on stderr, the count of samples, the preview and checkpoints.
pub(crate) struct Watcher<'a> {
    bar: Option<ProgressBar>,
    started: Instant,
    done: AtomicU64,
    /// The time limit of the render.
    time: Option<Duration>,
    preview: Option<Preview>,
    checkpoints: Option<&'a Checkpoints<'a>>,
}

impl<'a> Watcher<'a> {
    /// Starts the clock. A bar is shown, after the words of what is done, unless `quiet` or where stderr is not a terminal; it ends
    /// at `time` if there is one.
    pub(crate) fn start(
        quiet: bool,
        doing: Option<String>,
        time: Option<Duration>,
        preview: Option<Preview>,
        checkpoints: Option<&'a Checkpoints<'a>>,
    ) -> Self {
        let bar = (!quiet && stderr_is_terminal()).then(|| {
            let style = ProgressStyle::with_template("{prefix}{bar:40} {percent:>3} %  {msg}  {eta} left");
            let bar = ProgressBar::with_draw_target(Some(1), ProgressDrawTarget::stderr());
            bar.with_prefix(doing.unwrap_or_default())
                .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        Self { bar, started: Instant::now(), done: AtomicU64::new(0), time, preview, checkpoints }
    }

    /// Removes the bar and returns the number of samples taken.
    pub(crate) fn finish(self) -> u64 {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        self.done.into_inner()
    }
}

impl Progress for Watcher<'_> {
    fn tile(&self, tile: TileDone) {
        let TileDone { done, total, rays, .. } = tile;
        // Threads may report out of order; the largest count is the latest.
        self.done.fetch_max(done, Ordering::Relaxed);
        if let Some(bar) = &self.bar {
            let elapsed = self.started.elapsed();
            let rate = rays as f64 * 1e-6 / elapsed.as_secs_f64();
            let done = self.done.load(Ordering::Relaxed);
            let milliseconds = |time: Duration| time.as_millis() as u64;
            let (position, length) = match self.time {
                Some(time) if elapsed.as_secs_f64() * total as f64 > time.as_secs_f64() * done as f64 => {
                    (milliseconds(elapsed).min(milliseconds(time)), milliseconds(time))
                }
                _ => (done, total),
            };
            bar.set_length(length);
            bar.set_position(position);
            bar.set_message(format!("{rate:.2} Mrays/s"));
        }
        if let Some(preview) = &self.preview {
            preview.add(tile);
        }
    }

    fn wants_pixels(&self) -> bool {
        self.preview.is_some()
    }

    fn cancelled(&self) -> bool {
        interrupt::asked()
    }

    fn wants_checkpoint(&self) -> bool {
        self.checkpoints.is_some_and(Checkpoints::is_due)
    }

    fn checkpoint(&self, film: &Film) {
        if let Some(checkpoints) = self.checkpoints {
            checkpoints.write(film);
        }
    }
}
