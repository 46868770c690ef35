//! The scale of a light's colour, by the brightness that is written for it.

/// The brightness that is written for a light: the operands of [`Scale::value`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// The factor of its colour or power.
    pub factor: f32,
    /// The luminance of its curve, where the brightness of the curve does not count.
    pub of_curve: Option<f32>,
    /// Its power, where that is written.
    pub total: Option<Total>,
}

/// A power that is written for a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Total {
    /// All light that it emits, or an illuminance: see [`Power::total`](lookfrom_scene::light::Power::total).
    pub power: f32,
    /// The scale, if its colour were white of luminance 1.
    pub of_white: f32,
    /// The luminance of its colour; 1 for one that is divided by it already.
    pub luminance: f32,
}

impl Scale {
    /// The factor of the colour; 0 for light without luminance.
    pub fn value(&self) -> f32 {
        let mut scale = self.factor;
        if let Some(luminance) = self.of_curve {
            scale = if luminance > 0.0 { scale / luminance } else { 0.0 };
        }
        if let Some(Total { power, of_white, luminance }) = self.total {
            let whole = of_white * luminance;
            scale = if whole > 0.0 { scale * power / whole } else { 0.0 };
        }
        scale
    }
}
