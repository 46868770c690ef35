//! Disney's surface: its compiled inputs, and its BSDF at a point.

use lookfrom_scene::material as written;

use super::Evaluator;
use super::compile::Compiler;
use crate::core::math::luminance;
use crate::core::spectrum::Spectrum;
use crate::shading::bsdf::disney::Disney;
use crate::shading::texture::{FloatTexture, SpectralMode, SpectrumTexture};

/// Disney's surface, see [`lookfrom_scene::material::Disney`].
#[derive(Clone, Debug)]
pub struct DisneyMaterial {
    /// The base colour.
    pub base_color: SpectrumTexture,
    /// The numbers, in the order of [`written::Disney::scalars`].
    pub numbers: [FloatTexture; 12],
    /// Whether it is a thin sheet.
    pub is_thin: bool,
    /// Whether light passes it nowhere.
    pub is_opaque: bool,
}

impl Compiler<'_> {
    pub(super) fn disney(&self, look: &written::Disney) -> DisneyMaterial {
        DisneyMaterial {
            base_color: self.albedo(look.base_color),
            numbers: look.scalars().map(|(_, scalar)| scalar.into()),
            is_thin: look.is_thin,
            is_opaque: look.is_opaque(),
        }
    }
}

impl Evaluator<'_> {
    pub(super) fn disney(&self, look: &DisneyMaterial) -> Disney {
        let base = self.albedo(&look.base_color);
        let numbers = look.numbers.map(|number| self.float(number));
        let [roughness, anisotropic, metallic, spec_trans, eta, rest @ ..] = numbers;
        let [spec_tint, sheen, sheen_tint, flatness, clearcoat, clearcoat_gloss, diff_trans] = rest;
        let share = |number: f32| if number > 0.0 { number.min(1.0) } else { 0.0 };
        let of_body = |number: f32| if look.is_thin { 0.0 } else { number };
        let brightness = match self.mode {
            SpectralMode::Rgb => luminance(base.rgb()),
            // The mean over wavelengths: it only tints.
            _ => 0.25 * base.0.iter().sum::<f32>(),
        };
        let tint = if brightness >= f32::MIN_POSITIVE { base * (1.0 / brightness) } else { Spectrum::ONE };
        Disney {
            base,
            tint,
            roughness: share(roughness),
            aspect: (1.0 - 0.9 * share(anisotropic)).sqrt(),
            eta: Disney::valid_eta(eta),
            spec_tint: share(spec_tint),
            spec_trans: share(spec_trans),
            sheen: if sheen > 0.0 { sheen } else { 0.0 },
            sheen_tint: share(sheen_tint),
            flatness: share(flatness),
            is_thin: look.is_thin,
            metallic: share(of_body(metallic)),
            clearcoat: share(of_body(clearcoat)),
            clearcoat_alpha: 0.1 + (0.001 - 0.1) * share(clearcoat_gloss),
            diff_trans: if look.is_thin { share(0.5 * diff_trans) } else { 0.0 },
        }
    }
}
