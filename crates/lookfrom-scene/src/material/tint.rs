//! Colours of glass.

use super::Color;

/// Factors of what a dielectric reflects and of what it lets through each time. Both are 1 in nature, where glass gets its colour from
/// what it absorbs inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tint {
    /// The factor of the reflected light.
    pub reflectance: Color,
    /// The factor of the transmitted light.
    pub transmittance: Color,
}

impl Default for Tint {
    /// No tint.
    fn default() -> Self {
        Self { reflectance: Color::gray(1.0), transmittance: Color::gray(1.0) }
    }
}

impl Tint {
    pub(super) fn colors(&self) -> [(&'static str, Color); 2] {
        [("specular_reflectance", self.reflectance), ("specular_transmittance", self.transmittance)]
    }
}
