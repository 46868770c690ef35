//! The coat of a layered BSDF: its parameters, and its boundary as walks need it.

use lookfrom_scene::material::CoatEstimate;
use lookfrom_simd::{Float, Real};

use super::transmittance;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::shading::bsdf::DirectionSample;
use crate::shading::bsdf::dielectric::{Dielectric, Mode};
use crate::shading::bsdf::diffuse::cosine_direction;
use crate::shading::bsdf::lobes::Lobes;
use crate::shading::bsdf::microfacet::{Microfacets, TrowbridgeReitz};

/// A coat: a dielectric boundary and the slab below it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatLayer {
    /// Index of refraction over that outside; 0 counts as 1.
    pub eta: f32,
    /// Roughness of the boundary.
    pub roughness: Microfacets,
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
    /// The weights of these samples.
    pub estimate: CoatEstimate,
    /// Knowledge of its inside, which replaces walks over a diffuse base.
    pub interior: Option<CoatInterior>,
}

/// Number of coefficients of [`CoatInterior::transmission`].
pub(crate) const COEFFICIENTS: usize = 8;

/// Light between a coat without particles and a diffuse base below it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatInterior {
    /// The fraction of the light from the base that comes back to it, through the slab both ways: R in the series 1 + ρR + (ρR)² + …
    /// of light between coat and base.
    pub internal_reflectance: f32,
    /// The fraction of the light along a direction that gets through boundary and slab: a polynomial in the square root of the
    /// cosine, from its constant on. `None` where no polynomial fits; nearly smooth boundaries need none.
    pub transmission: Option<[f32; COEFFICIENTS]>,
}

impl Default for CoatLayer {
    /// pbrt's defaults.
    fn default() -> Self {
        Self {
            eta: 1.5,
            roughness: TrowbridgeReitz::SMOOTH.into(),
            thickness: 0.01,
            albedo: Spectrum::BLACK,
            g: 0.0,
            max_depth: 10,
            samples: 1,
            estimate: CoatEstimate::Pbrt,
            interior: None,
        }
    }
}

/// [`CoatInterior`] at any width, where it may be unknown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffuseInterior<R = f32> {
    /// Negative where it is not known.
    pub(crate) internal_reflectance: R,
    /// 1 where the transmission is known, else 0.
    pub(crate) has_transmission: R,
    /// [`CoatInterior::transmission`].
    pub(crate) transmission: [R; COEFFICIENTS],
}

impl Default for DiffuseInterior {
    fn default() -> Self {
        Self::new(None)
    }
}

impl DiffuseInterior {
    /// The interior of a coat; unknown for `None`.
    pub(crate) fn new(known: Option<CoatInterior>) -> Self {
        let transmission = known.and_then(|known| known.transmission);
        Self {
            internal_reflectance: known.map_or(-1.0, |known| known.internal_reflectance),
            has_transmission: f32::from(transmission.is_some()),
            transmission: transmission.unwrap_or_default(),
        }
    }
}

impl<R: Real> DiffuseInterior<R> {
    /// True where [`Self::transmission_along`] is known.
    #[inline(always)]
    pub(super) fn has_transmission(&self) -> R::Mask {
        self.has_transmission.gt(self.has_transmission.like(0.0))
    }

    /// The fraction of the light along a direction above that gets through boundary and slab.
    #[inline(always)]
    pub(super) fn transmission_along(&self, w: Vector<R>) -> R {
        let root = Float::sqrt(Float::clamp(w.z, 0.0, 1.0));
        Float::clamp(polynomial(&self.transmission, root), 0.0, 1.0)
    }
}

/// The root for a plane.
pub(in crate::shading::bsdf) const PLANE: f64 = 1.324_717_957_244_746;

/// Points of a rank-1 lattice in `D` dimensions, by powers of the root of x^(D+1) = x + 1 (Roberts 2018).
pub(in crate::shading::bsdf) fn lattice<const D: usize>(
    count: u32,
    root: f64,
) -> impl Iterator<Item = [f32; D]> {
    let step: [f64; D] = std::array::from_fn(|k| 1.0 / root.powi(k as i32 + 1));
    (0..count).map(move |point| {
        step.map(|step| {
            let x = 0.5 + f64::from(point + 1) * step;
            ((x - x.floor()) as f32).min(1.0 - f32::EPSILON)
        })
    })
}

impl CoatInterior {
    /// The most by which the polynomial may differ from what it fits.
    const MOST_ERROR: f64 = 4e-3;

    /// That of a coat by its relative index, its roughness and its thickness in mean free paths. The error of the reflectance is
    /// about 10⁻⁴, of the transmission 10⁻³, and up to 4 · 10⁻³ where it is grazing.
    pub fn new(eta: f32, roughness: impl Into<Microfacets>, thickness: f32) -> Self {
        let coat = Dielectric::new(eta, roughness);
        let thickness = thickness.max(f32::MIN_POSITIVE);
        Self {
            internal_reflectance: internal_reflectance(&coat, thickness),
            transmission: transmission(&coat, thickness),
        }
    }
}

fn internal_reflectance(coat: &Dielectric, thickness: f32) -> f32 {
    const POINTS: u32 = 8192;
    let mut sum = 0.0;
    for u in lattice::<4>(POINTS, 1.167_303_978_261_418_7) {
        // Up to the coat, by the cosine; seen from there it comes from below.
        let up = cosine_direction([u[0], u[1]], 1.0_f32);
        let sample = sample_coat(coat, -up, 0.5, [u[2], u[3]], Mode::Radiance, Lobes::REFLECTION);
        if sample.is_valid {
            let reflected = sample.f.0[0] * (sample.wi.z.abs() / sample.pdf);
            let passed = transmittance(thickness, up) * transmittance(thickness, sample.wi);
            sum += f64::from(reflected * passed);
        }
    }
    (sum / f64::from(POINTS)) as f32
}

/// [`CoatInterior::transmission`]: the polynomial through the values at Chebyshev's points, if it fits between them, too.
fn transmission(coat: &Dielectric, thickness: f32) -> Option<[f32; COEFFICIENTS]> {
    const POINTS: u32 = 4096;
    let alpha = coat.roughness.alpha;
    let is_even = alpha.alpha_x == alpha.alpha_y;
    if coat.is_specular() || !is_even {
        return None;
    }
    let passed = |x: f64| {
        let cos = (x * x) as f32;
        let wo = Vector { x: (1.0 - cos * cos).max(0.0).sqrt(), y: 0.0, z: cos };
        let sum: f64 = lattice::<2>(POINTS, PLANE)
            .map(|u| {
                let sample = sample_coat(coat, wo, 0.5, u, Mode::Importance, Lobes::TRANSMISSION);
                if !sample.is_valid {
                    return 0.0;
                }
                let share = sample.f.0[0] * (sample.wi.z.abs() / sample.pdf);
                f64::from(share * transmittance(thickness, sample.wi))
            })
            .sum();
        sum / f64::from(POINTS)
    };
    let node = |k: usize| {
        let angle = std::f64::consts::PI * (k as f64 + 0.5) / COEFFICIENTS as f64;
        0.5 + 0.5 * libm::cos(angle)
    };
    // Newton's divided differences, expanded to powers of x.
    let nodes: [f64; COEFFICIENTS] = std::array::from_fn(node);
    let mut differences = nodes.map(passed);
    for order in 1..COEFFICIENTS {
        for k in (order..COEFFICIENTS).rev() {
            differences[k] = (differences[k] - differences[k - 1]) / (nodes[k] - nodes[k - order]);
        }
    }
    let mut powers = [0.0; COEFFICIENTS];
    for k in (0..COEFFICIENTS).rev() {
        // powers · (x − node) + difference
        for j in (0..COEFFICIENTS).rev() {
            powers[j] = if j > 0 { powers[j - 1] } else { 0.0 } - nodes[k] * powers[j];
        }
        powers[0] += differences[k];
    }
    let powers = powers.map(|c| c as f32);
    let fits = (0..12).all(|k| {
        let x = (f64::from(k) + 0.5) / 12.0;
        (f64::from(polynomial(&powers, x as f32)) - passed(x)).abs() < CoatInterior::MOST_ERROR
    });
    fits.then_some(powers)
}

/// A polynomial by its coefficients from the constant on.
#[inline(always)]
fn polynomial<R: Real>(coefficients: &[R; COEFFICIENTS], x: R) -> R {
    let mut sum = coefficients[COEFFICIENTS - 1];
    let mut power = COEFFICIENTS - 1;
    while power > 0 {
        power -= 1;
        sum = sum * x + coefficients[power];
    }
    sum
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
