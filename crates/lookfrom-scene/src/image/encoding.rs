//! Transfer functions from integer texels to linear light or other values.

use std::fmt;
use std::sync::{Arc, LazyLock};

use super::linear_from_srgb;

/// The decoded value of each byte value.
pub(super) type Table = Arc<[f32; 256]>;

/// The transfer function from integers, scaled to [0, 1], to values.
#[derive(Clone, Copy)]
pub enum Encoding<'a> {
    /// The sRGB curve: for colours.
    Srgb,
    /// The identity: for bump maps, weights, normals.
    Linear,
    /// Any other curve.
    Curve(&'a dyn Fn(f32) -> f32),
}

impl Encoding<'_> {
    /// The identity: integers, scaled to [0, 1].
    pub fn decode(self, encoded: f32) -> f32 {
        match self {
            Self::Srgb => linear_from_srgb(encoded),
            Self::Linear => encoded,
            Self::Curve(curve) => curve(encoded),
        }
    }

    /// [`Self::decode`] of every byte; images in the usual encodings share one table. Values that are not finite become 0.
    pub(super) fn table(self) -> Table {
        static SRGB: LazyLock<Table> = LazyLock::new(|| tabulated(Encoding::Srgb));
        static LINEAR: LazyLock<Table> = LazyLock::new(|| tabulated(Encoding::Linear));
        match self {
            Self::Srgb => SRGB.clone(),
            Self::Linear => LINEAR.clone(),
            Self::Curve(_) => tabulated(self),
        }
    }
}

fn tabulated(encoding: Encoding<'_>) -> Table {
    Arc::new(std::array::from_fn(|byte| {
        let value = encoding.decode(byte as f32 / 255.0);
        if value.is_finite() { value } else { 0.0 }
    }))
}

impl fmt::Debug for Encoding<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Srgb => "Srgb",
            Self::Linear => "Linear",
            Self::Curve(_) => "Curve",
        })
    }
}
