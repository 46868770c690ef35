//! Memory of any type that is reused from batch to batch.

use std::any::Any;

/// A value of any type, which is taken and put back.
#[derive(Debug, Default)]
pub(crate) struct Scratch(Option<Box<dyn Any + Send>>);

impl Scratch {
    /// The value that was put back, or a new one.
    pub(crate) fn take<T: Any + Default>(&mut self) -> Box<T> {
        self.0.take().and_then(|memory| memory.downcast().ok()).unwrap_or_default()
    }

    /// Keeps a value for the next step.
    pub(crate) fn put<T: Any + Send>(&mut self, memory: Box<T>) {
        self.0 = Some(memory);
    }
}
