//! glTF's material at a point: textures looked up, colours clamped, directions of brushed metal and coat in one frame.
//!
//! A glTF file's `KHR_materials_dispersion` counts in spectral mode, where a wavelength is left alone with its own index
//! (Cauchy's equation by Abbe's number); in RGB mode the index is the same for all.

use glam::Vec3;
use lookfrom_scene::material::{Color, Principled as Written, Scalar};

use super::{At, Frame, relief};
use crate::bsdf::Bsdf;
use crate::bsdf::microfacet::TrowbridgeReitz;
use crate::bsdf::principled::film::Film;
use crate::bsdf::principled::{Parameters, Principled};
use crate::spectrum::Spectrum;
use crate::surface::Surface;
use crate::texture::{Lanes, Usage};

/// What a dielectric of an index mirrors straight on; an index of 0 is infinite.
fn straight(ior: f32) -> f32 {
    if ior == 0.0 {
        return 1.0;
    }
    let ratio = (ior - 1.0) / (ior + 1.0);
    ratio * ratio
}

impl At<'_> {
    /// The scattering function, and the frame turned to where brushed metal's grain runs.
    pub(super) fn principled(
        &mut self,
        look: &Written,
        surface: &Surface,
        mut frame: Frame,
    ) -> (Bsdf, Frame) {
        let share = |at: &Self, scalar| at.scalar(scalar).clamp(0.0, 1.0);
        let transmission = share(self, look.transmission);
        let metallic = share(self, look.metallic);
        let eta = self.index(look, transmission * (1.0 - metallic));

        // Roughness, drawn out along the grain.
        let alpha = |roughness: f32| roughness * roughness;
        let across = alpha(share(self, look.roughness));
        let mut along = across;
        if let Some(grain) = &look.anisotropy {
            let mut strength = grain.strength;
            let mut direction = [1.0, 0.0];
            if let Some(texture) = grain.texture {
                let [r, g, b] = self.textures.rgb(Color::Texture(texture), Usage::Unbounded, self.point);
                (direction, strength) = ([2.0 * r - 1.0, 2.0 * g - 1.0], strength * b);
            }
            let strength = strength.clamp(0.0, 1.0);
            along = across + (1.0 - across) * strength * strength;
            let (sin, cos) = libm::sincosf(grain.rotation);
            let [x, y] = direction;
            let [s, t] = relief::tangents(surface);
            frame = frame.along((x * cos - y * sin) * s + (x * sin + y * cos) * t);
        }

        // What the dielectric mirrors.
        let specular = share(self, look.specular);
        let (color, greatest) = self.with_greatest(look.specular_color);
        let mirrored = straight(eta);
        let f0 = color.map(|lane| (mirrored * lane).clamp(0.0, 1.0) * specular);

        let clearcoat = share(self, look.clearcoat);
        let mut clearcoat_normal = Vec3::Z;
        if clearcoat > 0.0 {
            let bent =
                look.clearcoat_normal.map(|map| relief::mapped(&map, self.textures, surface, self.point));
            clearcoat_normal = frame.local(relief::valid(bent.unwrap_or(surface.ns), surface));
        }
        let coat_alpha = alpha(share(self, look.clearcoat_roughness));
        let (sheen_color, sheen_greatest) = match look.sheen_color {
            Color::BLACK => (Spectrum::BLACK, 0.0),
            color => self.with_greatest(color),
        };
        let diffuse_transmission = share(self, look.diffuse_transmission);
        let parameters = Parameters {
            base_color: self.albedo(look.base_color),
            metallic,
            roughness: TrowbridgeReitz::new(along, across),
            eta,
            f0,
            f0_greatest: (mirrored * greatest).clamp(0.0, 1.0) * specular,
            f90: specular,
            transmission,
            is_solid: look.is_solid,
            diffuse_transmission,
            diffuse_transmission_color: if diffuse_transmission > 0.0 {
                self.albedo(look.diffuse_transmission_color)
            } else {
                Spectrum::BLACK
            },
            clearcoat,
            clearcoat_roughness: TrowbridgeReitz::new(coat_alpha, coat_alpha),
            clearcoat_normal,
            sheen_color,
            sheen_greatest,
            sheen_roughness: share(self, look.sheen_roughness),
            iridescence: if look.iridescence == Scalar::Value(0.0) {
                0.0
            } else {
                share(self, look.iridescence)
            },
            film: Film {
                eta: look.iridescence_ior,
                thickness: self.scalar(look.iridescence_thickness),
                wavelengths: match self.lanes {
                    Lanes::Rgb => None,
                    Lanes::Spectral(wavelengths) => Some(wavelengths.lambda),
                },
            },
        };
        (Bsdf::Principled(Principled::new(&parameters)), frame)
    }

    /// The index of refraction; one that differs by wavelength leaves only the first, where light passes.
    fn index(&mut self, look: &Written, passing: f32) -> f32 {
        match self.lanes {
            Lanes::Spectral(wavelengths) if look.dispersion > 0.0 && look.is_solid && passing > 0.0 => {
                wavelengths.terminate_secondary();
                let [lambda, ..] = wavelengths.lambda;
                let bent = 523_655.0 / (lambda * lambda) - 1.5168;
                (look.ior + (look.ior - 1.0) * look.dispersion / 20.0 * bent).max(1.0)
            }
            _ => look.ior,
        }
    }

    /// A factor, and its greatest primary. White changes nothing.
    fn with_greatest(&self, color: Color) -> (Spectrum, f32) {
        if color == Color::gray(1.0) {
            return (Spectrum([1.0; 4]), 1.0);
        }
        let rgb = self.textures.rgb(color, Usage::Unbounded, self.point);
        let lanes = match self.lanes {
            Lanes::Rgb => Spectrum::from_rgb(rgb),
            Lanes::Spectral(_) => self.textures.spectrum(color, Usage::Unbounded, self.point, self.lanes),
        };
        (lanes, rgb.into_iter().fold(0.0, f32::max))
    }
}
