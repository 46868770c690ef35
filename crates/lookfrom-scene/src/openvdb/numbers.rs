//! Numbers of grids: the types of trees that are read.

use half::f16;

use crate::error::{ErrorKind, Result};
use crate::volume::bytes::Bytes;

/// Types of trees, and the bytes of their numbers: of single ones, and of those in arrays.
const TYPES: [(&str, Precision); 5] = [
    ("Tree_float_5_4_3", Precision { single: 4, array: 4 }),
    ("Tree_float_5_4_3_HalfFloat", Precision { single: 4, array: 2 }),
    ("Tree_double_5_4_3", Precision { single: 8, array: 8 }),
    ("Tree_double_5_4_3_HalfFloat", Precision { single: 8, array: 2 }),
    ("Tree_half_5_4_3", Precision { single: 2, array: 2 }),
];

/// Bytes of numbers.
#[derive(Clone, Copy)]
pub(super) struct Precision {
    /// Bytes of a single number: of backgrounds, tiles of roots, inactive values.
    pub(super) single: u64,
    /// Bytes of a number in the arrays of nodes.
    pub(super) array: u64,
}

impl Precision {
    /// By the type of the tree of a grid at a position.
    ///
    /// # Errors
    /// `Unsupported` for other types.
    pub(super) fn of(tree: &str, bytes: Bytes<'_>, at: u64) -> Result<Self> {
        let known = TYPES.iter().find(|(name, _)| *name == tree);
        known.map(|(_, precision)| *precision).ok_or_else(|| {
            let message =
                format!("a grid of the type {tree:?}, expected a tree of float, double or half, 5_4_3");
            bytes.error(at, ErrorKind::Unsupported, message).hint("convert it to a grid of the type float")
        })
    }
}

/// A number of two, four or eight bytes.
pub(super) fn number(bytes: &[u8]) -> f32 {
    match *bytes {
        [a, b] => f16::from_le_bytes([a, b]).to_f32(),
        [a, b, c, d] => f32::from_le_bytes([a, b, c, d]),
        [a, b, c, d, e, f, g, h] => f64::from_le_bytes([a, b, c, d, e, f, g, h]) as f32,
        _ => f32::NAN,
    }
}
