//! Renders in the background, which can be cancelled.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use lookfrom_scene::{Error, ErrorKind, Location, Result};

use super::{Finished, Session};
use crate::render::{Progress, TileDone};

/// A render in the background. Dropping it lets the render go on, unheard.
#[derive(Debug)]
pub struct Running {
    cancelled: Arc<AtomicBool>,
    thread: JoinHandle<Result<Finished>>,
}

impl Session {
    /// Starts to render in the background. Change the session and start again whenever you like: what runs keeps its own
    /// view and settings, and shares the world.
    ///
    /// # Errors
    /// `Limit` where there is no thread to be had.
    pub fn start(&self, progress: impl Progress + Send + 'static) -> Result<Running> {
        let cancelled = Arc::new(AtomicBool::new(false));
        let (session, heard) = (self.clone(), Heard { progress, cancelled: cancelled.clone() });
        let thread =
            std::thread::Builder::new().name("render".to_owned()).spawn(move || session.render(&heard));
        let thread =
            thread.map_err(|error| Error::new(ErrorKind::Limit, &Location::default(), error.to_string()))?;
        Ok(Running { cancelled, thread })
    }
}

impl Running {
    /// Asks the render to stop after the tiles that are being worked on; what there is by then is its picture.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Whether [`Running::finish`] will not wait.
    pub fn is_finished(&self) -> bool {
        self.thread.is_finished()
    }

    /// Waits for the end, and gives the finished picture.
    ///
    /// # Errors
    /// As [`Session::render`].
    pub fn finish(self) -> Result<Finished> {
        self.thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

/// Progress that can be cancelled from elsewhere.
struct Heard<P> {
    progress: P,
    cancelled: Arc<AtomicBool>,
}

impl<P: Progress> Progress for Heard<P> {
    fn tile(&self, done: TileDone) {
        self.progress.tile(done);
    }

    fn wants_pixels(&self) -> bool {
        self.progress.wants_pixels()
    }

    fn cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed) || self.progress.cancelled()
    }
}
