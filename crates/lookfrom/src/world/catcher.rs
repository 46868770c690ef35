//! Shadow catchers: the reflectance with which a floor looks like its background.
//!
//! A matte floor of reflectance ρ under the irradiance E emits light with ρ E / π to all sides. Let ρ depend on the direction that
//! the floor is seen from: π B / E₀, where B is what lies behind the floor in that direction and E₀ what arrives where
//! nothing is in the way. Then the floor is B · E / E₀: exactly the background where no shadow falls. All light that
//! counts for E₀ comes from infinitely far, so that E₀ is the same all over the floor, and computed once.

use glam::Vec3;
use lookfrom_bvh::Ray;

use super::World;
use crate::core::spectrum::Spectrum;
use crate::light::Light;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::material::MaterialKind;
use crate::shading::texture::{SpectralMode, SpectrumType, Textures, spectrum_of};

/// The least reflectance that is reckoned with: what the camera sees of a darker floor is multiplied later.
const LEAST_REFLECTANCE: f32 = 1e-3;

/// What arrives from infinitely far on a surface with the unit normal `n`.
fn irradiance(lights: &[Light], textures: &Textures, n: Vec3) -> [f32; 3] {
    lights.iter().fold([0.0; 3], |sum, light| {
        let add = match light {
            Light::Environment(environment) if environment.illuminates => environment.irradiance(textures, n),
            Light::Distant { toward, irradiance } => {
                (irradiance.even(textures, &SpectralMode::Rgb) * toward.dot(n).max(0.0)).rgb()
            }
            _ => [0.0; 3],
        };
        std::array::from_fn(|c| sum[c] + add[c])
    })
}

impl World {
    /// What arrives from infinitely far on the shadow catcher where nothing is in the way; `None` where there is none.
    pub(super) fn unoccluded_irradiance(&self) -> Option<[f32; 3]> {
        let normal = self.materials.iter().find_map(|material| match material.kind {
            MaterialKind::ShadowCatcher { normal } => Some(normal),
            _ => None,
        });
        normal.map(|n| irradiance(&self.lights, &self.textures, n))
    }

    /// Whether a surface is a floor that is seen only by the shadows on it.
    pub(crate) fn is_catcher(&self, surface: &SurfaceInteraction) -> bool {
        self.catcher_irradiance.is_some()
            && matches!(self.materials[surface.material as usize].kind, MaterialKind::ShadowCatcher { .. })
    }

    /// The floor's reflectance: that with which it looks like the environment behind it, as far as matter can.
    pub(super) fn catcher_reflectance(&self, surface: &SurfaceInteraction, lanes: &SpectralMode) -> Spectrum {
        self.reflectance_seen_along(-surface.wo, lanes)
    }

    /// What the camera's light from the floor is to be multiplied by for the floor to look like `behind` in place of what
    /// its reflectance in the path tracer makes of it; `direction` is the camera ray's, of any length.
    pub fn catcher_correction(&self, direction: Vec3, behind: Spectrum, lanes: &SpectralMode) -> Spectrum {
        let irradiance = self.light_of(self.catcher_irradiance.unwrap_or_default(), lanes);
        let reflected = self.reflectance_seen_along(direction.normalize(), lanes) * irradiance;
        let pi_behind = behind * std::f32::consts::PI;
        pi_behind.zip(reflected, |behind, reflected| if reflected > 0.0 { behind / reflected } else { 0.0 })
    }

    fn reflectance_seen_along(&self, direction: Vec3, lanes: &SpectralMode) -> Spectrum {
        let e0 = self.catcher_irradiance.unwrap_or_default();
        let ray = Ray::new([0.0; 3], direction.to_array());
        let sky = self.sky(&ray, &SpectralMode::Rgb).rgb();
        let rho: [f32; 3] = std::array::from_fn(|c| {
            let rho = if e0[c] > 0.0 { std::f32::consts::PI * sky[c] / e0[c] } else { 0.0 };
            rho.clamp(LEAST_REFLECTANCE, 1.0)
        });
        spectrum_of(rho, SpectrumType::Albedo, lanes)
    }
}
