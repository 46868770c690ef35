//! glTF's metallic-roughness material with its extensions: a blend of metal, glass and diffuse bodies, under
//! sheen and a clear coat.
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
mod layers;
mod look;
mod scattering;
pub(super) mod sheen;
mod surface;
mod view;

use glam::Vec3;
use lookfrom_simd::Real;

use super::lanes::{Kind, LaneBsdf};
use super::microfacet::TrowbridgeReitz;
use super::{
    BsdfSample, Description, DirectionSample, Lobes, MicrofacetFactors, Mode, ScatteringFunction, fresnel,
};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use film::Film;
pub(crate) use look::Look;
pub(crate) use scattering::LocalScattering;

/// The parameters of a principled surface. All weights and colours are within 0 … 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// The metal's reflectance at normal incidence; the albedo or tint of the rest.
    pub base_color: Spectrum,
    /// Weight of the metal.
    pub metallic: f32,
    /// Roughness of metal, dielectric and transmission. Its x axis is the local frame's.
    pub roughness: TrowbridgeReitz,
    /// Index of refraction, inside over outside; 0 is infinite.
    pub eta: f32,
    /// The dielectric's reflectance at normal incidence, times `f90`.
    pub f0: Spectrum,
    /// The largest of its red, green and blue.
    pub f0_greatest: f32,
    /// The dielectric's reflectance at grazing incidence: `specular`.
    pub f90: f32,
    /// Fraction of the light that is not reflected specularly which is transmitted.
    pub transmission: f32,
    /// True if the surface bounds a body.
    pub is_solid: bool,
    /// Fraction of the diffuse light that is transmitted.
    pub diffuse_transmission: f32,
    /// Colour of the diffuse transmission.
    pub diffuse_transmission_color: Spectrum,
    /// Weight of the clear coat.
    pub clearcoat: f32,
    /// Roughness of the clear coat.
    pub clearcoat_roughness: TrowbridgeReitz,
    /// The coat's normal in the local frame: of unit length, z > 0.
    pub clearcoat_normal: Vec3,
    /// Colour of the sheen.
    pub sheen_color: Spectrum,
    /// The largest of its red, green and blue.
    pub sheen_greatest: f32,
    /// The square root of the sheen's α.
    pub sheen_roughness: f32,
    /// Weight of the thin film on the specular reflection.
    pub iridescence: f32,
    /// The thin film.
    pub film: Film,
    /// Weights of the spectrum's lanes, of sum 1, by which lobes are chosen: positive wherever light matters.
    pub lane_weights: Spectrum,
}

impl Default for Parameters {
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
            clearcoat_normal: Vec3::Z,
            sheen_color: Spectrum::BLACK,
            sheen_greatest: 0.0,
            sheen_roughness: 0.0,
            iridescence: 0.0,
            film: Film { eta: 1.3, thickness: 400.0, wavelengths: None },
            lane_weights: Spectrum([0.25; 4]),
        }
    }
}

/// A number of 0 … 1 in two bytes; 0 and 1 are exact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Share(u16);

impl Share {
    fn new(value: f32) -> Self {
        // NaN is 0.
        Self((value.clamp(0.0, 1.0) * 65_535.0 + 0.5) as u16)
    }

    #[inline]
    fn value(self) -> f32 {
        f32::from(self.0) * (1.0 / 65_535.0)
    }
}

/// Four numbers of 0 … 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shares([Share; 4]);

impl Shares {
    fn new(lanes: Spectrum) -> Self {
        Self(lanes.0.map(Share::new))
    }

    #[inline]
    fn lanes(self) -> Spectrum {
        Spectrum(self.0.map(Share::value))
    }

    fn is_black(self) -> bool {
        self.0 == [Share(0); 4]
    }
}

/// Precision of stored wavelengths: steps per nm.
const WAVELENGTH_STEPS: f32 = 64.0;

/// Weights in 255ths; a positive one stays positive.
#[inline]
fn packed_weights(weights: Spectrum) -> [u8; 4] {
    weights.0.map(|w| (w.clamp(0.0, 1.0) * 255.0).ceil() as u8)
}

/// Wavelengths in steps; 0 for none.
#[inline]
fn packed_wavelengths(wavelengths: Option<[f32; 4]>) -> [u16; 4] {
    wavelengths.map_or([0; 4], |lambda| lambda.map(|nm| (nm * WAVELENGTH_STEPS + 0.5) as u16))
}

/// glTF's surface. Numbers are packed into two bytes each, to keep the size of all BSDFs small.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Principled {
    base_color: Shares,
    f0: Shares,
    sheen_color: Shares,
    diffuse_transmission_color: Shares,
    /// In 255ths.
    lane_weights: [u8; 4],
    /// In 64ths of a nm; 0 in RGB mode.
    wavelengths: [u16; 4],
    pub(crate) roughness: TrowbridgeReitz,
    pub(crate) eta: f32,
    f0_greatest: Share,
    coat_alpha: f32,
    coat_normal: [f32; 2],
    film_eta: f32,
    film_thickness: f32,
    metallic: Share,
    f90: Share,
    transmission: Share,
    diffuse_transmission: Share,
    coat: Share,
    sheen_greatest: Share,
    sheen_roughness: Share,
    iridescence: Share,
    is_solid: bool,
}

impl Principled {
    /// Every parameter is clamped to its valid range; NaN counts as 0.
    pub fn new(parameters: &Parameters) -> Self {
        let p = parameters;
        let finite = |value: f32, greatest: f32| if value > 0.0 { value.min(greatest) } else { 0.0 };
        let normal = p.clearcoat_normal;
        let is_usable = normal.is_normalized() && normal.z > 0.0;
        Self {
            base_color: Shares::new(p.base_color),
            f0: Shares::new(p.f0),
            sheen_color: Shares::new(p.sheen_color),
            diffuse_transmission_color: Shares::new(p.diffuse_transmission_color),
            lane_weights: packed_weights(p.lane_weights),
            wavelengths: packed_wavelengths(p.film.wavelengths),
            roughness: p.roughness,
            eta: if p.eta > 0.0 { fresnel::valid_eta(p.eta) } else { 0.0 },
            f0_greatest: Share::new(p.f0_greatest),
            coat_alpha: p.clearcoat_roughness.alpha_x,
            coat_normal: if is_usable { [normal.x, normal.y] } else { [0.0; 2] },
            film_eta: finite(p.film.eta, 1e3).max(1.0),
            film_thickness: finite(p.film.thickness, 1e6),
            metallic: Share::new(p.metallic),
            f90: Share::new(p.f90),
            transmission: Share::new(p.transmission),
            diffuse_transmission: Share::new(p.diffuse_transmission),
            coat: Share::new(p.clearcoat),
            sheen_greatest: Share::new(p.sheen_greatest),
            sheen_roughness: Share::new(p.sheen_roughness),
            iridescence: Share::new(p.iridescence),
            is_solid: p.is_solid,
        }
    }

    /// The surface with other values of what mostly varies, and for another path: as [`Principled::new`] has it.
    #[inline]
    pub(crate) fn varied(
        &self,
        base_color: Spectrum,
        metallic: f32,
        roughness: TrowbridgeReitz,
        lane_weights: Spectrum,
        wavelengths: Option<[f32; 4]>,
    ) -> Self {
        Self {
            base_color: Shares::new(base_color),
            metallic: Share::new(metallic),
            roughness,
            lane_weights: packed_weights(lane_weights),
            wavelengths: packed_wavelengths(wavelengths),
            ..*self
        }
    }

    /// The parameters, to the precision with which they are stored.
    pub fn parameters(&self) -> Parameters {
        let [x, y] = self.coat_normal;
        let is_spectral = self.wavelengths != [0; 4];
        Parameters {
            base_color: self.base_color.lanes(),
            metallic: self.metallic.value(),
            roughness: self.roughness,
            eta: self.eta,
            f0: self.f0.lanes(),
            f0_greatest: self.f0_greatest.value(),
            f90: self.f90.value(),
            transmission: self.transmission.value(),
            is_solid: self.is_solid,
            diffuse_transmission: self.diffuse_transmission.value(),
            diffuse_transmission_color: self.diffuse_transmission_color.lanes(),
            clearcoat: self.coat.value(),
            clearcoat_roughness: TrowbridgeReitz { alpha_x: self.coat_alpha, alpha_y: self.coat_alpha },
            clearcoat_normal: Vec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt()),
            sheen_color: self.sheen_color.lanes(),
            sheen_greatest: self.sheen_greatest.value(),
            sheen_roughness: self.sheen_roughness.value(),
            iridescence: self.iridescence.value(),
            film: Film {
                eta: self.film_eta,
                thickness: self.film_thickness,
                wavelengths: is_spectral.then(|| self.wavelengths.map(|w| f32::from(w) / WAVELENGTH_STEPS)),
            },
            lane_weights: Spectrum(self.lane_weights.map(|w| f32::from(w) * (1.0 / 255.0))),
        }
    }

    /// The surface for a fixed outgoing direction.
    pub(super) fn scattering(&self, wo: Vec3, lobes: Lobes) -> LocalScattering {
        LocalScattering::new(&Look::new(self), wo.into(), lobes)
    }
}

impl ScatteringFunction for Principled {
    fn f(&self, wo: Vec3, wi: Vec3, mode: Mode) -> Spectrum {
        self.scattering(wo, Lobes::ALL).f(wi.into(), mode)
    }

    fn pdf(&self, wo: Vec3, wi: Vec3, _: Mode, lobes: Lobes) -> f32 {
        self.scattering(wo, lobes).pdf(wi.into())
    }

    fn sample(&self, wo: Vec3, uc: f32, u: [f32; 2], mode: Mode, lobes: Lobes) -> Option<BsdfSample> {
        self.scattering(wo, lobes).sample(uc, u, mode).scalar(Kind::PLAIN)
    }

    fn lobes(&self) -> Lobes {
        let of = |roughness: TrowbridgeReitz| match roughness.is_smooth() {
            true => Lobes::SPECULAR,
            false => Lobes::GLOSSY,
        };
        let p = self.parameters();
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
        if !self.sheen_color.is_black() {
            lobes |= Lobes::GLOSSY;
        }
        lobes
    }

    fn regularize(&mut self) {
        self.roughness.regularize();
        let mut coat = TrowbridgeReitz { alpha_x: self.coat_alpha, alpha_y: self.coat_alpha };
        coat.regularize();
        self.coat_alpha = coat.alpha_x;
    }

    fn diffuse_share(&self, wo: Vec3, wi: Vec3, f: Spectrum) -> Spectrum {
        self.scattering(wo, Lobes::ALL).diffuse_f(wi.into()).share_of(f)
    }

    fn factors(&self, wo: Vec3, wi: Vec3, is_specular: bool) -> Vec<MicrofacetFactors> {
        match is_specular {
            true => Vec::new(),
            false => self.scattering(wo, Lobes::ALL).factors(wi.into()),
        }
    }

    fn description(&self) -> Description {
        let p = self.parameters();
        Description {
            kind: "principled",
            does: "glTF's layers: a mix of metal, glass and diffuse, under sheen and a clear coat",
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

impl<R: Real> LaneBsdf<R> for Look<R> {
    type View = LocalScattering<R>;

    #[inline(always)]
    fn kind(&self) -> Kind {
        Kind { needs_agreement: true, ..Kind::PLAIN }
    }
    #[inline(always)]
    fn view(&self, wo: Vector<R>) -> LocalScattering<R> {
        LocalScattering::new(self, wo, Lobes::ALL)
    }
    #[inline(always)]
    fn f(&self, view: &LocalScattering<R>, wi: Vector<R>) -> Spectrum<R> {
        view.f(wi, Mode::Radiance)
    }
    #[inline(always)]
    fn pdf(&self, view: &LocalScattering<R>, wi: Vector<R>) -> R {
        view.pdf(wi)
    }
    #[inline(always)]
    fn f_and_pdf(&self, view: &LocalScattering<R>, wi: Vector<R>) -> (Spectrum<R>, R) {
        view.f_and_pdf(wi, Mode::Radiance)
    }
    #[inline(always)]
    fn sample(&self, view: &LocalScattering<R>, uc: R, u: [R; 2]) -> DirectionSample<R> {
        view.sample(uc, u, Mode::Radiance)
    }
    #[inline(always)]
    fn has_density(&self) -> R::Mask {
        self.has_density()
    }
    #[inline(always)]
    fn diffuse_share(&self, view: &LocalScattering<R>, wi: Vector<R>, f: Spectrum<R>) -> Spectrum<R> {
        view.diffuse_f(wi).share_of(f)
    }
}

#[cfg(test)]
pub(in crate::shading::bsdf) mod tests;
