//! Hair: from its parameters at a point to a BSDF of fibres.

use lookfrom_scene::material as written;
use lookfrom_scene::material::{Color, Pigment as Written, Scalar};

use super::{Compiler, Evaluator};
use crate::core::elementary::exp;
use crate::core::spectrum::Spectrum;
use crate::shading::bsdf::hair::Hair;
use crate::shading::texture::{FloatTexture, SpectralMode, SpectrumTexture, SpectrumType, spectrum_of};

/// Fibres of hair or fur, see [`lookfrom_scene::material::Hair`].
#[derive(Clone, Debug)]
pub struct HairMaterial {
    /// Its colour.
    pub pigment: Pigment,
    /// Index of refraction, inside over outside.
    pub eta: FloatTexture,
    /// Longitudinal roughness.
    pub beta_m: FloatTexture,
    /// Azimuthal roughness.
    pub beta_n: FloatTexture,
    /// Angle of the scales, in degrees.
    pub alpha: FloatTexture,
    /// A fibre without pigment, met in its middle, where all but the pigment is the same everywhere.
    even: Option<Hair>,
}

/// The pigment of a fibre.
#[derive(Clone, Debug)]
pub enum Pigment {
    /// The absorption coefficient, per radius of the fibre.
    Absorption(SpectrumTexture),
    /// By the colour of much hair.
    Reflectance(SpectrumTexture),
    /// By concentrations of eumelanin and of pheomelanin that vary.
    Melanin([FloatTexture; 2]),
}

/// Absorption by the concentrations of eumelanin and pheomelanin, for red, green and blue.
fn absorption_of_melanins([eumelanin, pheomelanin]: [f32; 2]) -> [f32; 3] {
    let [brown, red] = Written::MELANINS;
    std::array::from_fn(|k| eumelanin.max(0.0) * brown[k] + pheomelanin.max(0.0) * red[k])
}

impl Compiler<'_> {
    pub(super) fn hair(&self, hair: &written::Hair) -> HairMaterial {
        let pigment = match hair.pigment {
            Written::Absorption(color) => Pigment::Absorption(self.unbounded(color)),
            Written::Reflectance(color) => Pigment::Reflectance(self.albedo(color)),
            Written::Melanin {
                eumelanin: Scalar::Value(eumelanin),
                pheomelanin: Scalar::Value(pheomelanin),
            } => {
                let color = absorption_of_melanins([eumelanin, pheomelanin]);
                Pigment::Absorption(self.unbounded(Color::Value(color)))
            }
            Written::Melanin { eumelanin, pheomelanin } => {
                Pigment::Melanin([eumelanin.into(), pheomelanin.into()])
            }
        };
        let even = match (hair.eta, hair.beta_m, hair.beta_n, hair.alpha) {
            (Scalar::Value(eta), Scalar::Value(m), Scalar::Value(n), Scalar::Value(alpha)) => {
                Some(Hair::new(0.0, eta, Spectrum::BLACK, [m, n], alpha))
            }
            _ => None,
        };
        HairMaterial {
            pigment,
            eta: hair.eta.into(),
            beta_m: hair.beta_m.into(),
            beta_n: hair.beta_n.into(),
            alpha: hair.alpha.into(),
            even,
        }
    }
}

impl HairMaterial {
    /// The colour of the light that many such fibres reflect together, in RGB, by the values of colours and numbers.
    pub(super) fn reflectance(
        &self,
        color: impl Fn(&SpectrumTexture) -> Spectrum,
        float: impl Fn(FloatTexture) -> f32,
    ) -> Spectrum {
        let absorption = match &self.pigment {
            Pigment::Reflectance(reflectance) => return color(reflectance),
            Pigment::Absorption(absorption) => color(absorption),
            Pigment::Melanin(amounts) => Spectrum::from_rgb(absorption_of_melanins(amounts.map(&float))),
        };
        let spread = Hair::spread(float(self.beta_n));
        absorption.map(|lane| exp(-(lane.max(0.0).sqrt() * spread)))
    }
}

impl Evaluator<'_> {
    /// The fibre, met at the place across it that the texture coordinate v tells.
    pub(super) fn hair(&self, hair: &HairMaterial) -> Hair {
        let h = self.point.uv.y * 2.0 - 1.0;
        let number = |texture| self.textures.float(texture, self.point);
        let mut absorption = match &hair.pigment {
            Pigment::Absorption(color) => self.textures.spectrum(color, self.point, self.mode),
            Pigment::Reflectance(color) => {
                Hair::absorption_of_reflectance(self.albedo(color), number(hair.beta_n))
            }
            Pigment::Melanin(amounts) => {
                let rgb = absorption_of_melanins(amounts.map(number));
                spectrum_of(rgb, SpectrumType::Unbounded, self.mode)
            }
        };
        if let SpectralMode::Rgb = self.mode {
            // All lanes choose among the lobes: the unused one as green does.
            absorption.0[3] = absorption.0[1];
        }
        match hair.even {
            Some(even) => even.at(h, absorption),
            None => {
                let betas = [number(hair.beta_m), number(hair.beta_n)];
                Hair::new(h, number(hair.eta), absorption, betas, number(hair.alpha))
            }
        }
    }
}
