//! Rays through the moving part of a tree, after what stands still.

mod batch;
mod trace;

pub(crate) use batch::trace_batch;
pub(crate) use trace::continued;
