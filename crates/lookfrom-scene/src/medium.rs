//! Participating media.

use crate::error::Location;
use crate::material::Color;
use crate::scene::MediumId;

/// A participating medium, the same everywhere.
#[derive(Clone, Debug)]
pub struct Medium {
    /// The name that interfaces use.
    pub name: String,
    /// The location in the file.
    pub at: Location,
    /// Absorption coefficient, per unit of length.
    pub absorption: Color,
    /// Scattering coefficient: the transmittance is e^(−(absorption + scattering) · length).
    pub scattering: Color,
    /// Mean cosine of the angle between the directions before and after scattering, by the phase function of Henyey & Greenstein:
    /// between −1 and 1, 0 for all directions alike.
    pub g: f32,
    /// Multiplies both coefficients: ≥ 0.
    pub scale: f32,
    /// The radiance that the medium emits, times its absorption coefficient, per unit of length …
    pub emission: Color,
    /// … and a factor of it: ≥ 0.
    pub emission_scale: f32,
}

impl Medium {
    /// Whether it may scatter light.
    pub fn scatters(&self) -> bool {
        self.scale > 0.0 && !is_black(self.scattering)
    }

    /// Whether it may emit light.
    pub fn emits(&self) -> bool {
        self.scale > 0.0 && self.emission_scale > 0.0 && !is_black(self.emission)
    }
}

fn is_black(color: Color) -> bool {
    matches!(color, Color::Value(rgb) if rgb == [0.0; 3])
}

/// The media on both sides of a surface; `None` is a vacuum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sides {
    /// On the side opposite to the outward normal.
    pub inside: Option<MediumId>,
    /// On the side of the outward normal.
    pub outside: Option<MediumId>,
}
