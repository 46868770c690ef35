//! The surface of plastic as light from all around sees it: what gets through it, and what it reflects back to the base below.
//!
//! Rough surfaces have tables as in Mitsuba 3: by 64 cosines, both ends included, the light that single facets refract to the other
//! side, and inside the mean over these cosines of what they reflect, which is less than the integral by 0.009 or so.

use lookfrom_simd::{Float, Kernel, Simd, f32x8, prelude::*, run_at_baseline};

use crate::core::lanes::{LANES, by_lane};
use crate::core::optics;
use crate::core::parallel;
use crate::core::vector::Vector;
use crate::shading::bsdf::fresnel;
use crate::shading::bsdf::kept::Kept;
use crate::shading::bsdf::layered::{PLANE, lattice};
use crate::shading::bsdf::microfacet::{Microfacets, TrowbridgeReitz};

/// Number of cosines in the table: 0 … 1 in equal steps.
pub(crate) const COSINES: usize = 64;

/// Number of facets per cosine outside, and inside, where only the mean is needed.
const FACETS: [usize; 2] = [2048, 512];

/// A dielectric surface over a diffuse base.
#[derive(Clone, Debug, PartialEq)]
pub struct Interface {
    eta: f32,
    microfacets: Microfacets,
    /// The fractions of light along a direction outside that are reflected and that get through, by its cosine.
    pub(super) sides: [[f32; COSINES]; 2],
    /// The cosine-weighted mean over all directions of what gets through.
    pub(super) mean_transmission: f32,
    /// The fraction of diffuse light inside that is reflected.
    pub(super) internal_reflectance: f32,
}

impl Interface {
    /// By the index of refraction, inside over outside, and the facets.
    pub fn new(eta: f32, microfacets: Microfacets) -> Self {
        let eta = fresnel::valid_eta(eta);
        let cosines: [f32; COSINES] = std::array::from_fn(|k| (k as f32 / (COSINES - 1) as f32).max(1e-6));
        if microfacets.is_smooth() {
            let reflected = cosines.map(|cos| fresnel::dielectric(cos, eta));
            return Self {
                eta,
                microfacets,
                sides: [reflected, reflected.map(|part| 1.0 - part)],
                mean_transmission: 1.0 - smooth_reflectance(eta),
                internal_reflectance: smooth_reflectance(1.0 / eta),
            };
        }
        let mean = |parts: [f32; COSINES]| {
            let sum: f32 = parts.iter().zip(&cosines).map(|(part, cos)| part * cos).sum();
            2.0 * sum / COSINES as f32
        };
        let all_facets: Vec<[f32; 2]> = lattice(FACETS[0] as u32, PLANE).collect();
        // Inside, other facets for each cosine.
        let facets_inside: Vec<[f32; 2]> = lattice((FACETS[1] * COSINES) as u32, PLANE).collect();
        let both_sides = parallel::collect(COSINES, |k| {
            let parts = |eta, points| {
                run_at_baseline(ReflectedAndRefracted { microfacets, eta, cos: cosines[k], points })
            };
            [parts(eta, &all_facets), parts(1.0 / eta, &facets_inside[k * FACETS[1]..][..FACETS[1]])]
        });
        let table = |side: usize, way: usize| std::array::from_fn(|k| both_sides[k][side][way]);
        let sides = [table(0, 0), table(0, 1)];
        Self {
            eta,
            microfacets,
            sides,
            mean_transmission: mean(sides[1]),
            internal_reflectance: mean(table(1, 0)),
        }
    }

    pub(super) fn eta(&self) -> f32 {
        self.eta
    }

    pub(super) fn microfacets(&self) -> Microfacets {
        self.microfacets
    }

    /// As [`Self::new`], once for each surface, and as long as the process.
    pub fn kept(eta: f32, microfacets: Microfacets) -> &'static Self {
        static INTERFACES: Kept<Interface> = Kept::new();
        let eta = fresnel::valid_eta(eta);
        INTERFACES
            .get(|known| known.eta == eta && known.microfacets == microfacets, || Self::new(eta, microfacets))
    }
}

/// The fractions of light along a direction that single facets reflect to its side, and refract to the other.
struct ReflectedAndRefracted<'a> {
    microfacets: Microfacets,
    /// The index beyond over that on the side of the light.
    eta: f32,
    /// Of the direction.
    cos: f32,
    /// The facets, by numbers in [0, 1): a multiple of [`LANES`].
    points: &'a [[f32; 2]],
}

impl Kernel for ReflectedAndRefracted<'_> {
    type Output = [f32; 2];

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> [f32; 2] {
        let Self { microfacets: Microfacets { alpha, kind }, eta, cos, points } = self;
        let [alpha_x, alpha_y, kind, eta] =
            [alpha.alpha_x, alpha.alpha_y, kind, eta].map(|value| f32x8::splat(simd, value));
        let microfacets = Microfacets { alpha: TrowbridgeReitz { alpha_x, alpha_y }, kind };
        let [sin, zero, cos] =
            [(1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos].map(|value| f32x8::splat(simd, value));
        let wo = Vector { x: sin, y: zero, z: cos };
        let mut sums = [0.0_f64; 2];
        for points in points.chunks_exact(LANES) {
            let u = [0, 1].map(|axis| f32x8::load_array(simd, by_lane!(lane => points[lane][axis])));
            let wm = microfacets.sample(wo, u);
            let fresnel = optics::fresnel_dielectric(wo.dot(wm), eta);
            let reflected = optics::reflect(wo, wm);
            let (refracted, is_refracted) = optics::refract(wo, wm, eta);
            let ways = [
                (fresnel, reflected, Float::gt(reflected.z, zero)),
                (1.0 - fresnel, refracted, is_refracted & Float::lt(refracted.z, zero)),
            ];
            for (sum, (part, wi, is_there)) in sums.iter_mut().zip(ways) {
                let [g, g1] = microfacets.g_and_g1(wo, wi);
                let [parts, seen]: [[f32; LANES]; 2] =
                    [part, g / g1].map(|values| <f32x8<S> as Float>::select(is_there, values, zero).into());
                for (part, seen) in parts.into_iter().zip(seen) {
                    *sum += f64::from(part) * f64::from(seen);
                }
            }
        }
        sums.map(|sum| (sum / self.points.len() as f64) as f32)
    }
}

/// The fraction of diffuse light that a smooth surface reflects.
fn smooth_reflectance(eta: f32) -> f32 {
    const STEPS: u32 = 4096;
    let sum: f64 = (0..STEPS)
        .map(|step| {
            let cos = (f64::from(step) + 0.5) / f64::from(STEPS);
            2.0 * cos * f64::from(optics::fresnel_dielectric(cos as f32, eta))
        })
        .sum();
    (sum / f64::from(STEPS)) as f32
}
