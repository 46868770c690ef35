//! Memory of an integrator that is reused from batch to batch.

use std::any::Any;

/// A value of any type, which an integrator takes for a step and puts back.
#[derive(Debug, Default)]
pub(super) struct Scratch(Option<Box<dyn Any + Send>>);

impl Scratch {
    /// The value that was put back, or a new one.
    pub(super) fn take<T: Any + Default>(&mut self) -> Box<T> {
        self.0.take().and_then(|memory| memory.downcast().ok()).unwrap_or_default()
    }

    /// Keeps a value for the next step.
    pub(super) fn put<T: Any + Send>(&mut self, memory: Box<T>) {
        self.0 = Some(memory);
    }
}
