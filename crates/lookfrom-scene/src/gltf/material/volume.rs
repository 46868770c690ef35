//! The insides of bodies: attenuation (`KHR_materials_volume`) and scattering (`KHR_materials_volume_scatter`).
//!
//! The latter is a draft (Khronos' pull request 2453). Read are the property `multiscatterColor` of its texts of 2025, and
//! `multiscatterColorFactor`, as it has been called since April 2026. Its successor, `KHR_materials_scatter` (pull request 2579),
//! differs in volumes only by a strength, and by the anisotropy in the albedo, which is taken from there.

use super::{Reader, positive};
use crate::gltf::json;
use crate::material::{Color, Principled};
use crate::medium::{Extinction, Medium};
use crate::scene::MediumId;

const SCATTER: &str = "/extensions/KHR_materials_volume_scatter";

/// Largest magnitude of the anisotropy, whose range is open.
const MOST_ANISOTROPY: f64 = 0.999;

impl Reader<'_, '_, '_> {
    /// The medium that bodies of a material are filled with; `None` where nothing is scattered in them. What the material
    /// absorbs is then the attenuation of the medium: what is absorbed and scattered together.
    pub(super) fn medium(
        &mut self,
        entry: &json::Material,
        name: &str,
        look: &Principled,
    ) -> Option<MediumId> {
        let own = entry.extensions.volume_scatter.as_ref()?;
        if own.multiscatter_color_texture.is_some() {
            let message = "the texture is ignored: a medium has one colour";
            self.warn(&format!("{SCATTER}/multiscatterColorTexture"), message.into());
        }
        let color = match (own.multiscatter_color_factor, own.multiscatter_color) {
            (Some(color), _) => self.reflectance(color, &format!("{SCATTER}/multiscatterColorFactor")),
            (None, Some(color)) => self.reflectance(color, &format!("{SCATTER}/multiscatterColor")),
            (None, None) => return None,
        };
        if color == [0.0; 3] {
            return None;
        }
        if !look.is_solid {
            let message =
                "nothing is scattered in a thin sheet: KHR_materials_volume has no thicknessFactor above 0";
            self.warn(SCATTER, message.into());
            return None;
        }
        if look.absorption == [0.0; 3] {
            return None;
        }
        let g = self.anisotropy(own.scatter_anisotropy.unwrap_or(0.0));
        let albedo = color.map(|color| single_scattering_albedo(color.into(), g));
        let attenuation = look.absorption.map(f64::from);
        let scattering = std::array::from_fn(|k| positive(attenuation[k] * albedo[k]));
        let absorption = std::array::from_fn(|k| positive(attenuation[k] * (1.0 - albedo[k])));
        let medium = Medium {
            extinction: Extinction::Parts {
                absorption: Color::Value(absorption),
                scattering: Color::Value(scattering),
            },
            g: g as f32,
            ..Medium::clear(name, self.document.at(&format!("{}{SCATTER}", self.pointer)))
        };
        self.scene.media.push(medium);
        Some(MediumId(self.scene.media.len() as u32 - 1))
    }

    fn anisotropy(&mut self, g: f64) -> f64 {
        if g.abs() < 1.0 {
            return g.clamp(-MOST_ANISOTROPY, MOST_ANISOTROPY);
        }
        let clamped = MOST_ANISOTROPY.copysign(g);
        let message = format!("the anisotropy is {g}; expected a number between -1 and 1: {clamped} is used");
        self.warn(&format!("{SCATTER}/scatterAnisotropy"), message);
        clamped
    }

    /// Beer–Lambert law: white light has the attenuation colour after the distance, so the attenuation coefficient is
    /// −ln(colour) / distance.
    pub(super) fn attenuation(&mut self, volume: &json::Volume) -> [f32; 3] {
        const VOLUME: &str = "/extensions/KHR_materials_volume";
        let distance = volume.attenuation_distance.unwrap_or(f64::INFINITY);
        if distance <= 0.0 {
            let message = format!("the distance is {distance}; expected more than 0: nothing is absorbed");
            self.warn(&format!("{VOLUME}/attenuationDistance"), message);
        }
        if !(distance > 0.0 && distance.is_finite()) {
            return [0.0; 3];
        }
        let color = volume.attenuation_color.unwrap_or([1.0; 3]);
        self.check_reflectance(color, &format!("{VOLUME}/attenuationColor"));
        // A colour of 0 would need infinite attenuation, so it is clamped.
        color.map(|c| positive(-libm::log(c.clamp(1e-6, 1.0)) / distance))
    }
}

/// The fraction of collisions that scatter in a medium that reflects the fraction `color` of light after all its bounces (Kulla
/// & Conty 2017, "Revisiting Physically Based Shading at Imageworks"). `g` counts by similarity: a medium of isotropic scattering
/// with the albedo 1 − s² looks like it.
fn single_scattering_albedo(color: f64, g: f64) -> f64 {
    let s = 4.09712 + 4.20863 * color - (9.59217 + color * (41.6808 + color * 17.7126)).sqrt();
    let s2 = s * s;
    ((1.0 - s2) / (1.0 - g * s2)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reflected fraction of light by the albedo: the fit that is inverted (Kulla & Conty 2017).
    fn color(albedo: f64, g: f64) -> f64 {
        let s = ((1.0 - albedo) / (1.0 - g * albedo)).sqrt();
        (1.0 - s) * (1.0 - 0.139 * s) / (1.0 + 1.17 * s)
    }

    #[test]
    fn the_albedo_gives_the_colour_back() {
        for g in [-0.9, -0.3, 0.0, 0.5, 0.95] {
            for step in 0..=100 {
                let wanted = f64::from(step) / 100.0;
                let albedo = single_scattering_albedo(wanted, g);
                assert!((color(albedo, g) - wanted).abs() < 1e-4, "{wanted} {g}: {albedo}");
            }
        }
        // White stays white: nothing is lost in a furnace.
        assert!(1.0 - single_scattering_albedo(1.0, 0.0) < 1e-9);
    }
}
