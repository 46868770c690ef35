//! The coat of a layered BSDF: its parameters, and its boundary as walks need it.

use lookfrom_simd::Real;

use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::shading::bsdf::dielectric::Dielectric;
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
        }
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
