//! Shadow catchers: the reflectance with which an unshadowed floor looks like its background.
//!
//! A diffuse floor of reflectance ρ under the irradiance E has the radiance ρ E / π in all directions. Let ρ depend on
//! the direction of view: π B / E₀, where B is the background's radiance behind the floor in that direction and E₀ the
//! unoccluded irradiance. Then the floor's radiance is B · E / E₀: exactly the background where no shadow falls. All
//! light that counts for E₀ comes from infinitely far away, so that E₀ is the same all over the floor, and computed
//! once.

use glam::Vec3;
use lookfrom_bvh::Ray;

use super::World;
use crate::core::spectrum::Spectrum;
use crate::light::Light;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::material::MaterialKind;
use crate::shading::texture::{SpectralMode, SpectrumType, Textures, spectrum_of};

/// Lower bound of the reflectance: that of a darker floor is corrected by a factor for camera rays.
const LEAST_REFLECTANCE: f32 = 1e-3;

/// Irradiance from lights infinitely far away on a surface with the unit normal `n`.
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
    /// Unoccluded irradiance of the shadow catcher from lights infinitely far away; `None` where there is no catcher.
    pub(super) fn unoccluded_irradiance(&self) -> Option<[f32; 3]> {
        let normal = self.materials.iter().find_map(|material| match material.kind {
            MaterialKind::ShadowCatcher { normal } => Some(normal),
            _ => None,
        });
        normal.map(|n| irradiance(&self.lights, &self.textures, n))
    }

    /// Whether a surface is a shadow catcher.
    pub(crate) fn is_catcher(&self, surface: &SurfaceInteraction) -> bool {
        self.catcher_irradiance.is_some()
            && matches!(self.materials[surface.material as usize].kind, MaterialKind::ShadowCatcher { .. })
    }

    /// The floor's reflectance, with which it looks like the environment behind it, within physical limits (at most 1).
    pub(super) fn catcher_reflectance(&self, surface: &SurfaceInteraction, mode: &SpectralMode) -> Spectrum {
        self.reflectance_seen_along(-surface.wo, mode)
    }

    /// Factor of the floor's light for camera rays: with it, the unshadowed floor looks like `behind` instead of what
    /// its reflectance in the path tracer yields; `direction` is the camera ray's, of any length.
    pub fn catcher_correction(&self, direction: Vec3, behind: Spectrum, mode: &SpectralMode) -> Spectrum {
        let irradiance = self.light_of(self.catcher_irradiance.unwrap_or_default(), mode);
        let reflected = self.reflectance_seen_along(direction.normalize(), mode) * irradiance;
        let pi_behind = behind * std::f32::consts::PI;
        pi_behind.zip(reflected, |behind, reflected| if reflected > 0.0 { behind / reflected } else { 0.0 })
    }

    fn reflectance_seen_along(&self, direction: Vec3, mode: &SpectralMode) -> Spectrum {
        let e0 = self.catcher_irradiance.unwrap_or_default();
        let ray = Ray::new([0.0; 3], direction.to_array());
        let sky = self.sky(&ray, &SpectralMode::Rgb).rgb();
        let rho: [f32; 3] = std::array::from_fn(|c| {
            let rho = if e0[c] > 0.0 { std::f32::consts::PI * sky[c] / e0[c] } else { 0.0 };
            rho.clamp(LEAST_REFLECTANCE, 1.0)
        });
        spectrum_of(rho, SpectrumType::Albedo, mode)
    }
}
