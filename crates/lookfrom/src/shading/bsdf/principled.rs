//! glTF's metallic-roughness material with its extensions: a blend of metal, glass and diffuse bodies, under
//! sheen and a clear coat. OpenPBR is the same with more parameters ([`open_pbr`]).
//!
//! The layers are those of glTF 2.0's appendix B and of the extensions' texts:
//!
//! ```text
//! coat      a dielectric reflector of index 1.5 with a normal of its own
//! sheen     fibres (Charlie)
//! surface   metallic            a reflector, Schlick from the base colour to 1
//!           1 − metallic        a dielectric reflector over
//!               1 − transmission    a diffuse body, reflecting and transmitting
//!               transmission        straight through a thin sheet, or refracted into a body
//! ```
//!
//! The specifications leave some points open. They are resolved so that energy is never gained and,
//! where the texts allow, never lost:
//! - **Multiple scattering** between the facets of a rough reflector is a lobe of Kulla & Conty 2017, for metals,
//!   dielectrics and thin sheets.
//! - **Bodies of rough glass** have Walter's facets (2007), weighted by their visibility (Heitz 2018). Light that
//!   leaves a facet is never shadowed by others, and light that would leave to the wrong side is mirrored at the
//!   surface. So no energy is lost, whatever the roughness and the index. This is the only lobe that is not
//!   reciprocal.
//! - **The diffuse base below the specular layer** gets what that layer leaves on the way in and out, divided by
//!   the mean: `(1 − E(ω_o))(1 − E(ω_i)) / (1 − Ē)`, with E the specular albedo (Kelemen & Szirmay-Kalos 2001). It is
//!   reciprocal, and white stays white. Where the specular colour is not grey, its largest primary counts, as in
//!   `KHR_materials_specular`.
//! - **Coat and sheen** attenuate the layers below by the larger of their albedos along the two directions: one
//!   factor, as in the extensions, and reciprocal.
//! - **Glass** uses Fresnel's equations instead of Schlick's approximation (rescaled by `specular`), so that it
//!   agrees with `dielectric`.
//! - **Anisotropic** reflectors have tables of albedo of their own.
//!
//! Both sides scatter alike, except that the inside of a body is below. Everything is a deterministic function of
//! its arguments without Monte Carlo estimates, and the density is exact. Tangents and the rotation of anisotropy
//! are left to the local frame, absorption to media.

mod choice;
mod facing;
mod factors;
pub mod film;
mod fuzz;
mod gather;
mod layers;
mod model;
pub mod open_pbr;
mod prepared;
mod rough_diffuse;
mod scattering;
pub(super) mod sheen;
mod surface;

use glam::Vec3;
use lookfrom_simd::Real;

use super::lanes::{ClassTraits, LaneBsdf};
use super::microfacet::TrowbridgeReitz;
use super::{Description, DirectionSample, Lobes, MicrofacetFactors, ScatteringFunction, fresnel};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use film::ThinFilm;
pub use model::{Gltf, Model};
pub use scattering::LocalScattering;

/// A surface of layers, by glTF's model or another. All weights and colours are within 0 … 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Principled<R: Real = f32, M = Gltf> {
    /// The metal's reflectance at normal incidence; the albedo or tint of the rest.
    pub base_color: Spectrum<R>,
    /// Weight of the metal.
    pub metallic: R,
    /// Roughness of metal, dielectric and transmission. Its x axis is the local frame's.
    pub roughness: TrowbridgeReitz<R>,
    /// Index of refraction, inside over outside; 0 is infinite.
    pub eta: R,
    /// The dielectric's reflectance at normal incidence, times `f90`.
    pub f0: Spectrum<R>,
    /// The largest of its red, green and blue.
    pub f0_greatest: R,
    /// The dielectric's reflectance at grazing incidence: `specular`.
    pub f90: R,
    /// Fraction of the light that is not reflected specularly which is transmitted.
    pub transmission: R,
    /// True if the surface bounds a body.
    pub is_solid: R::Mask,
    /// Fraction of the diffuse light that is transmitted.
    pub diffuse_transmission: R,
    /// Colour of the diffuse transmission.
    pub diffuse_transmission_color: Spectrum<R>,
    /// Weight of the clear coat.
    pub clearcoat: R,
    /// Roughness of the clear coat, the same along both axes.
    pub clearcoat_roughness: TrowbridgeReitz<R>,
    /// The coat's normal in the local frame: of unit length, z > 0.
    pub clearcoat_normal: Vector<R>,
    /// Colour of the sheen.
    pub sheen_color: Spectrum<R>,
    /// The largest of its red, green and blue.
    pub sheen_greatest: R,
    /// The square root of the sheen's α.
    pub sheen_roughness: R,
    /// Weight of the thin film on the specular reflection.
    pub iridescence: R,
    /// The thin film.
    pub film: ThinFilm<R>,
    /// Weights of the spectrum's lanes, of sum 1, by which lobes are chosen: positive wherever light matters.
    pub lane_weights: Spectrum<R>,
    /// The model, with its additional parameters.
    pub model: M,
}

impl Default for Principled {
    /// Smooth white plastic without further layers.
    fn default() -> Self {
        Self {
            base_color: Spectrum([1.0; 4]),
            metallic: 0.0,
            roughness: TrowbridgeReitz::SMOOTH,
            eta: 1.5,
            f0: Spectrum([0.04; 4]),
            f0_greatest: 0.04,
            f90: 1.0,
            transmission: 0.0,
            is_solid: false,
            diffuse_transmission: 0.0,
            diffuse_transmission_color: Spectrum([1.0; 4]),
            clearcoat: 0.0,
            clearcoat_roughness: TrowbridgeReitz::SMOOTH,
            clearcoat_normal: Vec3::Z.into(),
            sheen_color: Spectrum::BLACK,
            sheen_greatest: 0.0,
            sheen_roughness: 0.0,
            iridescence: 0.0,
            film: ThinFilm { eta: 1.3, thickness: 400.0, wavelengths: None },
            lane_weights: Spectrum([0.25; 4]),
            model: Gltf,
        }
    }
}

impl<M: Copy> Principled<f32, M> {
    /// The surface with every parameter clamped to its valid range; NaN counts as 0.
    #[must_use]
    pub fn clamped(&self) -> Self {
        let share = |value: f32| if value > 0.0 { value.min(1.0) } else { 0.0 };
        let finite = |value: f32, greatest: f32| if value > 0.0 { value.min(greatest) } else { 0.0 };
        let normal = Vec3::from(self.clearcoat_normal);
        let is_usable = normal.is_normalized() && normal.z > 0.0;
        let coat_alpha = self.clearcoat_roughness.alpha_x;
        Self {
            base_color: self.base_color.map(share),
            metallic: share(self.metallic),
            roughness: self.roughness,
            eta: if self.eta > 0.0 { fresnel::valid_eta(self.eta) } else { 0.0 },
            f0: self.f0.map(share),
            f0_greatest: share(self.f0_greatest),
            f90: share(self.f90),
            transmission: share(self.transmission),
            is_solid: self.is_solid,
            diffuse_transmission: share(self.diffuse_transmission),
            diffuse_transmission_color: self.diffuse_transmission_color.map(share),
            clearcoat: share(self.clearcoat),
            clearcoat_roughness: TrowbridgeReitz { alpha_x: coat_alpha, alpha_y: coat_alpha },
            clearcoat_normal: if is_usable { self.clearcoat_normal } else { Vec3::Z.into() },
            sheen_color: self.sheen_color.map(share),
            sheen_greatest: share(self.sheen_greatest),
            sheen_roughness: share(self.sheen_roughness),
            iridescence: share(self.iridescence),
            film: ThinFilm {
                eta: finite(self.film.eta, 1e3).max(1.0),
                thickness: finite(self.film.thickness, 1e6),
                wavelengths: self.film.wavelengths,
            },
            lane_weights: self.lane_weights.map(share),
            model: self.model,
        }
    }
}

impl<M: Model<f32>> Principled<f32, M> {
    /// The surface for a fixed outgoing direction.
    pub(super) fn scattering(&self, wo: Vec3) -> LocalScattering<f32, M> {
        LocalScattering::new(self, wo.into())
    }
}

impl<M: Model<f32>> ScatteringFunction for Principled<f32, M> {
    fn lobes(&self) -> Lobes {
        let of = |roughness: TrowbridgeReitz| match roughness.is_smooth() {
            true => Lobes::SPECULAR,
            false => Lobes::GLOSSY,
        };
        let p = self;
        let mut lobes = Lobes::REFLECTION | of(p.roughness);
        let is_body = p.metallic < 1.0;
        if is_body && p.transmission > 0.0 {
            lobes |= Lobes::TRANSMISSION;
            if p.is_solid && (self.eta == 1.0 || self.eta == 0.0) {
                lobes |= Lobes::SPECULAR;
            }
        }
        if is_body && p.transmission < 1.0 {
            lobes |= Lobes::DIFFUSE;
            if p.diffuse_transmission > 0.0 {
                lobes |= Lobes::TRANSMISSION;
            }
        }
        if p.clearcoat > 0.0 {
            lobes |= of(p.clearcoat_roughness);
        }
        if !p.sheen_color.is_black() {
            lobes |= Lobes::GLOSSY;
        }
        lobes
    }

    fn regularize(&mut self) {
        self.roughness.regularize();
        self.clearcoat_roughness.regularize();
    }

    fn factors(&self, wo: Vec3, wi: Vec3, is_specular: bool) -> Vec<MicrofacetFactors> {
        match is_specular {
            true => Vec::new(),
            false => self.scattering(wo).factors(wi.into()),
        }
    }

    fn description(&self) -> Description {
        let p = self;
        let (kind, does) = match p.model.open_pbr() {
            None => (
                "principled",
                "glTF's layers: a mix of metal, glass and diffuse, under sheen and a clear coat",
            ),
            Some(_) => {
                ("openpbr", "OpenPBR's layers: a mix of metal, glass and diffuse, under a coat and fuzz")
            }
        };
        Description {
            kind,
            does,
            numbers: vec![
                ("base color", p.base_color.into()),
                ("metallic", p.metallic.into()),
                ("alpha", p.roughness.into()),
                ("eta", p.eta.into()),
                ("f0", p.f0.into()),
                ("specular", p.f90.into()),
                ("transmission", p.transmission.into()),
                ("diffuse transmission", p.diffuse_transmission.into()),
                ("clearcoat", p.clearcoat.into()),
                ("clearcoat alpha", p.clearcoat_roughness.alpha_x.into()),
                ("sheen color", p.sheen_color.into()),
                ("sheen roughness", p.sheen_roughness.into()),
                ("iridescence", p.iridescence.into()),
            ],
        }
    }
}

impl<R: Real, M: Model<R>> LaneBsdf<R> for Principled<R, M> {
    type Prepared = LocalScattering<R, M>;

    #[inline(always)]
    fn traits(&self) -> ClassTraits {
        ClassTraits { needs_agreement: true, ..ClassTraits::PLAIN }
    }
    #[inline(always)]
    fn prepare(&self, wo: Vector<R>) -> LocalScattering<R, M> {
        LocalScattering::new(self, wo)
    }
    #[inline(always)]
    fn f(&self, prepared: &LocalScattering<R, M>, wi: Vector<R>) -> Spectrum<R> {
        prepared.f(wi)
    }
    #[inline(always)]
    fn pdf(&self, prepared: &LocalScattering<R, M>, wi: Vector<R>) -> R {
        prepared.pdf(wi)
    }
    #[inline(always)]
    fn f_and_pdf(&self, prepared: &LocalScattering<R, M>, wi: Vector<R>) -> (Spectrum<R>, R) {
        prepared.f_and_pdf(wi)
    }
    #[inline(always)]
    fn sample(&self, prepared: &LocalScattering<R, M>, uc: R, u: [R; 2]) -> DirectionSample<R> {
        prepared.sample(uc, u)
    }
    #[inline(always)]
    fn has_density(&self) -> R::Mask {
        let (zero, one) = (self.metallic.like(0.0), self.metallic.like(1.0));
        let is_diffuse = self.metallic.lt(one) & self.transmission.lt(one);
        let has_coat = self.clearcoat.gt(zero) & !self.clearcoat_roughness.is_smooth();
        !self.roughness.is_smooth() | is_diffuse | has_coat | !self.sheen_color.is_black()
    }
    #[inline(always)]
    fn diffuse_share(&self, prepared: &LocalScattering<R, M>, wi: Vector<R>, f: Spectrum<R>) -> Spectrum<R> {
        prepared.diffuse_f(wi).share_of(f)
    }
}

#[cfg(test)]
pub(in crate::shading::bsdf) mod tests;
