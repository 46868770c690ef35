//! Participating media.

use crate::error::Location;
use crate::material::Color;
use crate::scene::MediumId;

/// A participating medium. It absorbs light; scattering is not modelled.
#[derive(Clone, Debug)]
pub struct Medium {
    /// The name that interfaces use.
    pub name: String,
    /// The location in the file.
    pub at: Location,
    /// Absorption coefficient: the transmittance is e^(−absorption · length).
    pub absorption: Color,
    /// Multiplies it: ≥ 0.
    pub scale: f32,
}

/// The media on both sides of a surface; `None` is a vacuum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sides {
    /// On the side opposite to the outward normal.
    pub inside: Option<MediumId>,
    /// On the side of the outward normal.
    pub outside: Option<MediumId>,
}
