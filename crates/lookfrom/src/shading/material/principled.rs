//! The parameters of glTF's material at a point.
//!
//! Dispersion (`KHR_materials_dispersion`) keeps only one wavelength, with the index of Cauchy's equation for its
//! Abbe number. In RGB mode it keeps one of red, green and blue, which stand for the Fraunhofer lines C, d and F:
//! as far apart as the Abbe number says, with d in the middle, as in Khronos' sample renderer.
//!
//! Indices are relative to the surrounding body, where light comes through one of this kind: water in a glass has
//! another relative index than water in air. The clear coat and the film are as in air.

use glam::Vec3;

use super::kind::Principled as PrincipledMaterial;
use super::{Evaluator, Frame, MaterialKind, bump};
use crate::core::spectrum::Spectrum;
use crate::shading::bsdf::microfacet::TrowbridgeReitz;
use crate::shading::bsdf::principled::film::Film;
use crate::shading::bsdf::principled::{Parameters, Principled};
use crate::shading::interaction::ShadingGeometry;
use crate::shading::texture::{SpectralMode, SpectrumTexture};

/// Reflectance of a dielectric at normal incidence by its index; an index of 0 means infinite.
fn straight(ior: f32) -> f32 {
    if ior == 0.0 {
        return 1.0;
    }
    let ratio = (ior - 1.0) / (ior + 1.0);
    ratio * ratio
}

/// True if a body of this material disperses light.
#[inline]
pub(super) fn disperses(look: &PrincipledMaterial) -> bool {
    look.dispersion > 0.0 && look.is_solid && look.ior > 1.0
}

/// The index of refraction for the one wavelength or colour that is kept; the nominal one where there are more.
fn index_of(look: &PrincipledMaterial, lanes: &SpectralMode, share: Spectrum) -> f32 {
    // Twenty times n_F − n_C.
    let spread = (look.ior - 1.0) * look.dispersion;
    match lanes {
        SpectralMode::Spectral(wavelengths) if wavelengths.secondary_terminated() => {
            let [lambda, ..] = wavelengths.lambda;
            let bent = 523_655.0 / (lambda * lambda) - 1.5168;
            (look.ior + spread / 20.0 * bent).max(1.0)
        }
        SpectralMode::Rgb => match share.only_lane() {
            Some(lane) => (look.ior + spread * (0.025 * (lane as f32 - 1.0))).max(1.0),
            None => look.ior,
        },
        SpectralMode::Spectral(_) => look.ior,
    }
}

impl Evaluator<'_> {
    /// The BSDF, and the frame rotated to the direction of anisotropy.
    pub(super) fn principled(
        &mut self,
        look: &PrincipledMaterial,
        material: u32,
        surface: &ShadingGeometry,
        mut frame: Frame,
    ) -> (Principled, Frame) {
        let share = |at: &Self, texture| at.float(texture).clamp(0.0, 1.0);
        let transmission = share(self, look.transmission);
        let metallic = share(self, look.metallic);
        let ior = self.index(look, transmission * (1.0 - metallic));
        let around = self.around(look, material, surface.front);
        let is_hidden = around.is_none();
        let eta = around.map_or(1.0, |around| ior / around);

        // Roughness, stretched along the direction of anisotropy.
        let alpha = |roughness: f32| roughness * roughness;
        let across = alpha(share(self, look.roughness));
        let mut along = across;
        if let Some(grain) = &look.anisotropy {
            let mut strength = grain.strength;
            let mut direction = [1.0, 0.0];
            if let Some(texture) = &grain.texture {
                let [r, g, b] = self.textures.rgb(texture, self.point);
                (direction, strength) = ([2.0 * r - 1.0, 2.0 * g - 1.0], strength * b);
            }
            let strength = strength.clamp(0.0, 1.0);
            along = across + (1.0 - across) * strength * strength;
            let [sin, cos] = grain.sin_cos;
            let [x, y] = direction;
            let [s, t] = bump::tangents(surface);
            frame = frame.along((x * cos - y * sin) * s + (x * sin + y * cos) * t);
        }

        // Specular reflection of the dielectric.
        let specular = if is_hidden { 0.0 } else { share(self, look.specular) };
        let (color, greatest) = self.with_greatest(&look.specular_color);
        let mirrored = straight(eta);
        let f0 = color.map(|lane| (mirrored * lane).clamp(0.0, 1.0) * specular);

        let clearcoat = if is_hidden { 0.0 } else { share(self, look.clearcoat) };
        let mut clearcoat_normal = Vec3::Z;
        if clearcoat > 0.0 {
            let bent =
                look.clearcoat_normal.map(|map| bump::mapped(&map, self.textures, surface, self.point));
            clearcoat_normal = frame.local(bump::valid(bent.unwrap_or(surface.ns), surface));
        }
        let coat_alpha = alpha(share(self, look.clearcoat_roughness));
        let (sheen_color, sheen_greatest) = match &look.sheen_color {
            color if is_hidden || color.is_gray(0.0) => (Spectrum::BLACK, 0.0),
            color => self.with_greatest(color),
        };
        let diffuse_transmission = share(self, look.diffuse_transmission);
        let parameters = Parameters {
            base_color: self.albedo(&look.base_color),
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
                self.albedo(&look.diffuse_transmission_color)
            } else {
                Spectrum::BLACK
            },
            clearcoat,
            clearcoat_roughness: TrowbridgeReitz::new(coat_alpha, coat_alpha),
            clearcoat_normal,
            sheen_color,
            sheen_greatest,
            sheen_roughness: share(self, look.sheen_roughness),
            iridescence: if look.iridescence.is(0.0) || is_hidden {
                0.0
            } else {
                share(self, look.iridescence)
            },
            film: Film {
                eta: look.iridescence_ior,
                thickness: self.float(look.iridescence_thickness),
                wavelengths: match self.lanes {
                    SpectralMode::Rgb => None,
                    SpectralMode::Spectral(wavelengths) => Some(wavelengths.lambda),
                },
            },
            lane_weights: self.lane_weights(),
        };
        (Principled::new(&parameters), frame)
    }

    /// The weights of the lanes in the choice of lobes: the path's throughput, so that a lobe whose colour can no longer
    /// matter is seldom chosen.
    fn lane_weights(&self) -> Spectrum {
        if let SpectralMode::Spectral(wavelengths) = &self.lanes
            && wavelengths.secondary_terminated()
        {
            return Spectrum([1.0, 0.0, 0.0, 0.0]);
        }
        let sum: f32 = self.throughput.0.iter().sum();
        if sum > 0.0 && sum.is_finite() { *self.throughput / sum } else { Spectrum([0.25; 4]) }
    }

    /// The index of refraction. Where light is transmitted, one that varies with wavelength keeps only the first
    /// wavelength, one that varies with colour only one colour.
    fn index(&mut self, look: &PrincipledMaterial, passing: f32) -> f32 {
        if !disperses(look) || !(passing > 0.0) {
            return look.ior;
        }
        match self.lanes {
            SpectralMode::Spectral(wavelengths) => wavelengths.terminate_secondary(),
            SpectralMode::Rgb => self.throughput.leave_one(self.u),
        }
        index_of(look, self.lanes, *self.throughput)
    }

    /// The index of refraction on the other side of a surface of a material; `None` where the surface is hidden
    /// because a body that was entered later is on both of its sides.
    fn around(&self, look: &PrincipledMaterial, material: u32, front: bool) -> Option<f32> {
        let leaves = look.is_solid && !front;
        if leaves && self.interior.hides(material) {
            return None;
        }
        let outside = if leaves { self.interior.left(material) } else { self.interior };
        let around = outside.material().map(|index| &self.materials[index as usize].kind);
        Some(match around {
            Some(MaterialKind::Principled(body)) if body.ior > 0.0 => {
                index_of(body, self.lanes, *self.throughput)
            }
            _ => 1.0,
        })
    }

    /// A colour factor and its largest primary. White is the identity.
    fn with_greatest(&self, color: &SpectrumTexture) -> (Spectrum, f32) {
        if color.is_gray(1.0) {
            return (Spectrum([1.0; 4]), 1.0);
        }
        let rgb = self.textures.rgb(color, self.point);
        let lanes = match self.lanes {
            SpectralMode::Rgb => Spectrum::from_rgb(rgb),
            SpectralMode::Spectral(_) => self.textures.spectrum(color, self.point, self.lanes),
        };
        (lanes, rgb.into_iter().fold(0.0, f32::max))
    }
}
