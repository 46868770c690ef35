//! The parameters of glTF's material at a point.
//!
//! Dispersion (`KHR_materials_dispersion`) keeps only one wavelength, with the index of Cauchy's equation for its
//! Abbe number. In RGB mode it keeps one of red, green and blue, which stand for the Fraunhofer lines C, d and F:
//! as far apart as the Abbe number says, with d in the middle, as in Khronos' sample renderer.
//!
//! Indices are relative to the surrounding body, where light comes through one of this kind: water in a glass has
//! another relative index than water in air. The clear coat and the film are as in air.

use glam::Vec3;

use super::kind::PrincipledMaterial;
use super::{Evaluator, Frame, MaterialKind, ShadingContext, Side, bump};
use crate::core::spectrum::Spectrum;
use crate::shading::bsdf::microfacet::TrowbridgeReitz;
use crate::shading::bsdf::principled::film::ThinFilm;
use crate::shading::bsdf::principled::{Gltf, Principled};
use crate::shading::interaction::ShadingGeometry;
use crate::shading::interior_stack::InteriorStack;
use crate::shading::texture::{FloatTexture, SpectralMode, SpectrumTexture, TexturePoint, Textures};

/// Reflectance of a dielectric at normal incidence by its index; an index of 0 means infinite.
fn straight(ior: f32) -> f32 {
    if ior == 0.0 {
        return 1.0;
    }
    let ratio = (ior - 1.0) / (ior + 1.0);
    ratio * ratio
}

/// The refraction of a material.
#[derive(Clone, Copy)]
pub(super) struct Refraction {
    /// Index of refraction; 0 means infinite.
    pub(super) ior: f32,
    /// 20 over the Abbe number: 0 is none.
    pub(super) dispersion: f32,
    /// True if the surface bounds a body.
    pub(super) is_solid: bool,
}

impl Refraction {
    /// That of a material of layers.
    #[inline]
    pub(super) fn of(kind: &MaterialKind) -> Option<Self> {
        match kind {
            MaterialKind::Principled(look) => Some(look.refraction()),
            MaterialKind::OpenPbr(look) => Some(look.refraction()),
            _ => None,
        }
    }

    /// True if a body disperses light.
    #[inline]
    pub(super) fn disperses(self) -> bool {
        self.dispersion > 0.0 && self.is_solid && self.ior > 1.0
    }
}

impl PrincipledMaterial {
    #[inline]
    pub(super) fn refraction(&self) -> Refraction {
        Refraction { ior: self.ior, dispersion: self.dispersion, is_solid: self.is_solid }
    }

    /// Whether its BSDF depends on the shading frame: by a lobe that is stretched along the surface, or a coat's normal.
    #[inline]
    pub(super) fn depends_on_frame(&self) -> bool {
        self.anisotropy.is_some() || !self.clearcoat.is(0.0)
    }
}

/// The index of refraction for the one wavelength or colour that is kept; the nominal one where there are more.
fn index_of(look: Refraction, mode: &SpectralMode, share: Spectrum) -> f32 {
    // Twenty times n_F − n_C.
    let spread = (look.ior - 1.0) * look.dispersion;
    match mode {
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

/// The BSDF of a material with any base colour, metalness and roughness, which [`Evaluator::principled`] replaces; `None`
/// where more of it varies, or depends on the surface or on wavelengths.
pub(super) fn template(look: &PrincipledMaterial, textures: &Textures) -> Option<Principled> {
    let (roughnesses, film) = ([look.clearcoat_roughness, look.sheen_roughness], look.iridescence_thickness);
    let is_even = ![look.specular, look.transmission, film].iter().chain(&roughnesses).any(|x| x.varies());
    let is_plain = look.specular_color.is_gray(1.0)
        && look.sheen_color.is_gray(0.0)
        && [look.clearcoat, look.diffuse_transmission, look.iridescence].iter().all(|weight| weight.is(0.0));
    if look.is_solid || look.anisotropy.is_some() || !is_even || !is_plain {
        return None;
    }
    let (mut mode, mut throughput) = (SpectralMode::Rgb, Spectrum::ONE);
    let interior = InteriorStack::default();
    let context =
        ShadingContext { mode: &mut mode, throughput: &mut throughput, interior, u: 0.0, seed: 0.0 };
    let mut evaluator = Evaluator::new(&[], textures, &TexturePoint::NOWHERE, context);
    evaluator.principled_in_any_frame(look, Side { material: 0, front: true })
}

/// The microfacet distribution's α of a roughness.
fn alpha(roughness: f32) -> f32 {
    roughness * roughness
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
        if let Some(bsdf) = self.template_of(look) {
            return (bsdf, frame);
        }
        let transmission = self.share(look.transmission);
        let metallic = self.share(look.metallic);
        let ior = self.index(look.refraction(), transmission * (1.0 - metallic));
        let around = self.around(look.is_solid, material, surface.front);
        let is_hidden = around.is_none();
        let eta = around.map_or(1.0, |around| ior / around);

        // Roughness, stretched along the direction of anisotropy.
        let across = alpha(self.share(look.roughness));
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
        let specular = if is_hidden { 0.0 } else { self.share(look.specular) };
        let (color, greatest) = self.with_greatest(&look.specular_color);
        let mirrored = straight(eta);
        let f0 = color.map(|lane| (mirrored * lane).clamp(0.0, 1.0) * specular);

        let clearcoat = if is_hidden { 0.0 } else { self.share(look.clearcoat) };
        let mut clearcoat_normal = Vec3::Z;
        if clearcoat > 0.0 {
            let bent =
                look.clearcoat_normal.map(|map| bump::mapped(&map, self.textures, surface, self.point));
            clearcoat_normal = frame.local(bump::valid(bent.unwrap_or(surface.ns), surface));
        }
        let coat_alpha = alpha(self.share(look.clearcoat_roughness));
        let (sheen_color, sheen_greatest) = match &look.sheen_color {
            color if is_hidden || color.is_gray(0.0) => (Spectrum::BLACK, 0.0),
            color => self.with_greatest(color),
        };
        let diffuse_transmission = self.share(look.diffuse_transmission);
        let bsdf = Principled {
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
            clearcoat_normal: clearcoat_normal.into(),
            sheen_color,
            sheen_greatest,
            sheen_roughness: self.share(look.sheen_roughness),
            iridescence: if look.iridescence.is(0.0) || is_hidden {
                0.0
            } else {
                self.share(look.iridescence)
            },
            film: ThinFilm {
                eta: look.iridescence_ior,
                thickness: self.float(look.iridescence_thickness),
                wavelengths: self.wavelengths(),
            },
            lane_weights: self.lane_weights(),
            model: Gltf,
        };
        (bsdf.clamped(), frame)
    }

    /// The BSDF by that of its [`template`], where it has one and is in no body.
    #[inline]
    pub(super) fn template_of(&self, look: &PrincipledMaterial) -> Option<Principled> {
        let template = look.template.as_ref().filter(|_| self.interior.material().is_none())?;
        let alpha = alpha(self.share(look.roughness));
        Some(Principled {
            base_color: self.albedo(&look.base_color),
            metallic: self.share(look.metallic),
            roughness: TrowbridgeReitz::new(alpha, alpha),
            film: ThinFilm { wavelengths: self.wavelengths(), ..template.film },
            lane_weights: self.lane_weights(),
            ..*template
        })
    }

    /// The BSDF of a material that does not [depend on the frame](PrincipledMaterial::depends_on_frame).
    pub(super) fn principled_in_any_frame(
        &mut self,
        look: &PrincipledMaterial,
        side: Side,
    ) -> Option<Principled> {
        let surface = ShadingGeometry {
            ng: Vec3::Z,
            ns: Vec3::Z,
            dpdu: Vec3::X,
            dpdv: Vec3::Y,
            derivatives: [Vec3::X, Vec3::Y],
            wo: Vec3::Z,
            front: side.front,
        };
        let frame = bump::plain(&surface);
        (!look.depends_on_frame()).then(|| self.principled(look, side.material, &surface, frame).0)
    }

    /// A number of 0 … 1.
    pub(super) fn share(&self, number: FloatTexture) -> f32 {
        self.float(number).clamp(0.0, 1.0)
    }

    /// The wavelengths of the sample's lanes; `None` in RGB.
    pub(super) fn wavelengths(&self) -> Option<[f32; 4]> {
        match &*self.mode {
            SpectralMode::Rgb => None,
            SpectralMode::Spectral(wavelengths) => Some(wavelengths.lambda),
        }
    }

    /// The weights of the lanes in the choice of lobes: the path's throughput, so that a lobe whose colour can no longer
    /// matter is seldom chosen.
    pub(super) fn lane_weights(&self) -> Spectrum {
        if let SpectralMode::Spectral(wavelengths) = &self.mode
            && wavelengths.secondary_terminated()
        {
            return Spectrum([1.0, 0.0, 0.0, 0.0]);
        }
        let sum: f32 = self.throughput.0.iter().sum();
        if sum > 0.0 && sum.is_finite() { *self.throughput / sum } else { Spectrum([0.25; 4]) }
    }

    /// The index of refraction. Where light is transmitted, one that varies with wavelength keeps only the first
    /// wavelength, one that varies with colour only one colour.
    pub(super) fn index(&mut self, look: Refraction, passing: f32) -> f32 {
        if !look.disperses() || !(passing > 0.0) {
            return look.ior;
        }
        match self.mode {
            SpectralMode::Spectral(wavelengths) => wavelengths.terminate_secondary(),
            SpectralMode::Rgb => self.throughput.leave_one(self.u),
        }
        index_of(look, self.mode, *self.throughput)
    }

    /// The index of refraction on the other side of a surface of a material; `None` where the surface is hidden
    /// because a body that was entered later is on both of its sides.
    pub(super) fn around(&self, is_solid: bool, material: u32, front: bool) -> Option<f32> {
        let leaves = is_solid && !front;
        if leaves && self.interior.hides(material) {
            return None;
        }
        let outside = if leaves { self.interior.left(material) } else { self.interior };
        let around = outside.material().map(|index| &self.materials[index as usize].kind);
        Some(match around {
            Some(kind) => match Refraction::of(kind) {
                Some(body) if body.ior > 0.0 => index_of(body, self.mode, *self.throughput),
                _ => 1.0,
            },
            None => 1.0,
        })
    }

    /// A colour factor and its largest primary. White is the identity.
    fn with_greatest(&self, color: &SpectrumTexture) -> (Spectrum, f32) {
        if color.is_gray(1.0) {
            return (Spectrum([1.0; 4]), 1.0);
        }
        let rgb = self.textures.rgb(color, self.point);
        let spectrum = match self.mode {
            SpectralMode::Rgb => Spectrum::from_rgb(rgb),
            SpectralMode::Spectral(_) => self.textures.spectrum(color, self.point, self.mode),
        };
        (spectrum, rgb.into_iter().fold(0.0, f32::max))
    }
}

#[cfg(test)]
mod tests {
    use lookfrom_scene::material::{self as written, Color, Scalar};
    use lookfrom_scene::scene::TextureId;
    use lookfrom_scene::settings::ColorMode;
    use lookfrom_scene::texture::{Mapping, TextureKind};

    use super::*;
    use crate::core::color::Wavelengths;
    use crate::core::hash;
    use crate::shading::material::compile::Compiler;

    #[test]
    fn a_template_is_the_whole_evaluation() {
        let mut count = 0;
        let mut number = || {
            count += 1;
            (hash::pair(count, 5) >> 40) as f32 / 16_777_216.0
        };
        let mut templates = 0;
        for round in 0..400 {
            let mode = if round % 2 == 0 { ColorMode::Rgb } else { ColorMode::Spectral };
            let checker = TextureKind::Checker {
                even: Color::Value([number(), number(), number()]),
                odd: Color::Value([1.2 * number(); 3]),
                footprint: 0.0,
                mapping: Mapping::UV,
            };
            let textures = Textures::new(&[checker], Vec::new(), Vec::new(), mode);
            let texture = TextureId(0);
            let mut scalar = |rare: f32| match number() {
                u if u < 0.3 => Scalar::Texture(texture),
                u if u < rare => Scalar::Value(0.0),
                u => Scalar::Value(u),
            };
            let look = written::Principled {
                metallic: scalar(0.0),
                roughness: scalar(0.0),
                clearcoat: scalar(0.95),
                iridescence: Scalar::Value(0.0),
                ..written::Principled::default()
            };
            let base_color =
                if number() < 0.5 { Color::Texture(texture) } else { Color::Value([number(); 3]) };
            let look = written::Principled {
                base_color,
                transmission: Scalar::Value((2.0 * number() - 1.0).max(0.0)),
                ior: 1.0 + number(),
                is_solid: number() < 0.1,
                ..look
            };
            let kind = written::MaterialKind::Principled(Box::new(look));
            let written = written::Material::new("", lookfrom_scene::Location::default(), kind);
            let (material, _) =
                Compiler::new(&textures, lookfrom_scene::scene::VertexNormals::Smooth).compile(&written);
            let MaterialKind::Principled(look) = &material.kind else { panic!("{:?}", material.kind) };
            let whole = PrincipledMaterial { template: None, ..(**look).clone() };
            let uv = glam::Vec2::new(4.0 * number(), 4.0 * number());
            let point = TexturePoint { uv, ..TexturePoint::NOWHERE };
            let surface = ShadingGeometry {
                ng: Vec3::Z,
                ns: Vec3::new(0.0, 0.6, 0.8),
                dpdu: Vec3::X,
                dpdv: Vec3::Y,
                derivatives: [Vec3::X, Vec3::Y],
                wo: Vec3::Z,
                front: true,
            };
            let mut mode = match mode {
                ColorMode::Rgb => SpectralMode::Rgb,
                ColorMode::Spectral => SpectralMode::Spectral(Wavelengths::sample_visible(number())),
            };
            let throughput = Spectrum([number(), number(), number(), number()]);
            let mut evaluate = |look: &PrincipledMaterial| {
                let (interior, mut throughput) = (InteriorStack::default(), throughput);
                let (mode, throughput) = (&mut mode, &mut throughput);
                let context = ShadingContext { mode, throughput, interior, u: 0.5, seed: 0.0 };
                let mut evaluator = Evaluator::new(&[], &textures, &point, context);
                evaluator.principled(look, 0, &surface, bump::plain(&surface)).0
            };
            assert_eq!(evaluate(look), evaluate(&whole), "{look:?}");
            templates += usize::from(look.template.is_some());
        }
        assert!((100..350).contains(&templates), "{templates} of 400");
    }
}
