//! Renders in the background, which can be cancelled.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use lookfrom_scene::{Error, ErrorKind, Location, Result};

use super::{Finished, Session};
use crate::film::Film;
use crate::render::{Progress, TileDone};

/// A render in the background. Dropping it detaches the render, which goes on.
#[derive(Debug)]
pub struct Running {
    cancelled: Arc<AtomicBool>,
    thread: JoinHandle<Result<Finished>>,
}

impl Session {
    /// Starts to render in the background. The session may be changed and started again at any time: a running render
    /// keeps its own view and settings, and shares the world.
    ///
    /// # Errors
    /// `Limit` if no thread is available.
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
    /// Stops the render after the tiles that are in progress; its picture consists of the samples so far.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Whether the render has ended, so that [`Running::finish`] will not wait.
    pub fn is_finished(&self) -> bool {
        self.thread.is_finished()
    }

    /// Waits for the end, and returns the finished picture.
    ///
    /// # Errors
    /// As [`Session::render`].
    pub fn finish(self) -> Result<Finished> {
        self.thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

/// Progress with a flag that cancels the render.
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

    fn wants_checkpoint(&self) -> bool {
        self.progress.wants_checkpoint()
    }

    fn checkpoint(&self, film: &Film) {
        self.progress.checkpoint(film);
    }

    fn cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed) || self.progress.cancelled()
    }
}
