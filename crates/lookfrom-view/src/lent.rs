//! Samples that helpers render: other workers of a page, with the same scene and view. Their films add up exactly, as those of a picture
//! that several machines render.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use serde::{Deserialize, Serialize};

/// Samples of all pixels of a picture.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Part {
    /// Tells pictures apart.
    pub(crate) picture: u64,
    pub(crate) samples: Range<u32>,
}

/// The last samples of a picture, which are lent.
#[derive(Debug)]
pub(crate) struct Lent {
    pub(crate) picture: u64,
    /// The first of them; those before it are rendered here.
    pub(crate) start: u32,
    /// Parts that are out.
    pub(crate) out: u32,
    /// Samples that have come back.
    pub(crate) back: u32,
}

impl Lent {
    /// None of so many samples.
    pub(crate) fn none(of: u32) -> Self {
        static PICTURES: AtomicU64 = AtomicU64::new(0);
        Self { picture: PICTURES.fetch_add(1, Ordering::Relaxed), start: of, out: 0, back: 0 }
    }
}
