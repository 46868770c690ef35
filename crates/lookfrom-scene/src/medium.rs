//! Participating media.

use crate::error::Location;
use crate::material::Color;
use crate::scene::MediumId;

/// Something that light crosses. It takes light away on the way; what it would scatter is not modelled.
#[derive(Clone, Debug)]
pub struct Medium {
    /// The name that interfaces use.
    pub name: String,
    /// The location in the file.
    pub at: Location,
    /// The part of light that is lost per unit of length, for short lengths: e^(−absorption · length) is left.
    pub absorption: Color,
    /// Multiplies it: ≥ 0.
    pub scale: f32,
}

/// What fills the space on both sides of a surface; `None` is a vacuum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sides {
    /// Behind the outside normal.
    pub inside: Option<MediumId>,
    /// Before it.
    pub outside: Option<MediumId>,
}
