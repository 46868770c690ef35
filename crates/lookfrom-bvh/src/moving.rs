//! Rays through the moving part of a tree, after what stands still.

mod batch;
mod trace;

pub(crate) use batch::go_on_through_moving;
pub(crate) use trace::continued;
