//! The coat of a layered BSDF: its parameters, and its boundary as walks need it.

use lookfrom_scene::material::CoatEstimate;
use lookfrom_simd::Real;

use super::transmittance;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::shading::bsdf::dielectric::Dielectric;
use crate::shading::bsdf::diffuse::cosine_direction;
use crate::shading::bsdf::lobes::Lobes;
use crate::shading::bsdf::microfacet::TrowbridgeReitz;
use crate::shading::bsdf::{DirectionSample, Mode};

/// A coat: a dielectric boundary and the slab below it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatLayer {
    /// Index of refraction over that outside; 0 counts as 1.
    pub eta: f32,
    /// Roughness of the boundary.
    pub roughness: TrowbridgeReitz,
    /// Thickness of the slab, in mean free paths.
    pub thickness: f32,
    /// Single-scattering albedo of the slab's particles, clamped to 0 … 1; black for no particles.
    pub albedo: Spectrum,
    /// Mean cosine of the phase function.
    pub g: f32,
    /// Maximum number of steps of a walk.
    pub max_depth: u16,
    /// Number of walks that are averaged, at least one.
    pub samples: u16,
    /// How they are weighted.
    pub estimate: CoatEstimate,
    /// [`CoatLayer::internal_reflectance`] where it is known beforehand: it replaces walks over a diffuse base.
    pub internal_reflectance: Option<f32>,
}

impl Default for CoatLayer {
    /// pbrt's defaults.
    fn default() -> Self {
        Self {
            eta: 1.5,
            roughness: TrowbridgeReitz::SMOOTH,
            thickness: 0.01,
            albedo: Spectrum::BLACK,
            g: 0.0,
            max_depth: 10,
            samples: 1,
            estimate: CoatEstimate::Pbrt,
            internal_reflectance: None,
        }
    }
}

impl CoatLayer {
    /// The fraction of the light from a diffuse base that comes back to it from a coat over a slab without particles, through
    /// the slab both ways: R in the series 1 + ρR + (ρR)² + … of light between coat and base.
    ///
    /// By a rank-1 lattice in four dimensions (powers of the root of x⁵ = x + 1; Roberts 2018); the error is about 10⁻⁴.
    pub fn internal_reflectance(eta: f32, roughness: TrowbridgeReitz, thickness: f32) -> f32 {
        const POINTS: u32 = 8192;
        const ROOT: f64 = 1.167_303_978_261_418_7;
        let coat = Dielectric::new(eta, roughness);
        let thickness = thickness.max(f32::MIN_POSITIVE);
        let step: [f64; 4] = std::array::from_fn(|k| 1.0 / ROOT.powi(k as i32 + 1));
        let mut sum = 0.0;
        for point in 0..POINTS {
            let u = step.map(|step| {
                let x = 0.5 + f64::from(point + 1) * step;
                ((x - x.floor()) as f32).min(1.0 - f32::EPSILON)
            });
            // Up to the coat, by the cosine; seen from there it comes from below.
            let up = cosine_direction([u[0], u[1]], 1.0_f32);
            let sample = sample_coat(&coat, -up, 0.5, [u[2], u[3]], Mode::Radiance, Lobes::REFLECTION);
            if sample.is_valid {
                let reflected = sample.f.0[0] * (sample.wi.z.abs() / sample.pdf);
                let passed = transmittance(thickness, up) * transmittance(thickness, sample.wi);
                sum += f64::from(reflected * passed);
            }
        }
        (sum / f64::from(POINTS)) as f32
    }
}

/// [`Dielectric::sample`], where it carries light.
///
/// Not inlined, as the next two: in all their places they would take compilers minutes.
#[inline(never)]
pub(super) fn sample_coat<R: Real>(
    coat: &Dielectric<R>,
    wo: Vector<R>,
    uc: R,
    u: [R; 2],
    mode: Mode,
    lobes: Lobes,
) -> DirectionSample<R> {
    uc.at_level(
        #[inline(always)]
        || coat.sample(wo, uc, u, mode, lobes).if_lit(),
    )
}

/// [`Dielectric::f`], which is the same in all lanes of a spectrum.
#[inline(never)]
pub(super) fn coat_f<R: Real>(coat: &Dielectric<R>, wo: Vector<R>, wi: Vector<R>, mode: Mode) -> R {
    coat.eta.at_level(
        #[inline(always)]
        || coat.f(wo, wi, mode).0[0],
    )
}

/// [`Dielectric::pdf`].
#[inline(never)]
pub(super) fn coat_pdf<R: Real>(coat: &Dielectric<R>, wo: Vector<R>, wi: Vector<R>, lobes: Lobes) -> R {
    coat.eta.at_level(
        #[inline(always)]
        || coat.pdf(wo, wi, lobes),
    )
}
