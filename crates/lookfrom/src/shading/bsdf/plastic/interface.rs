//! The surface of plastic as light from all around sees it: what gets through it, and what it reflects back to the base below.
//!
//! Rough surfaces have tables as in Mitsuba 3: by 64 cosines, both ends included, the light that single facets refract to the other
//! side, and inside the mean over these cosines of what they reflect, which is less than the integral by 0.009 or so.

use std::sync::{Mutex, PoisonError};

use lookfrom_simd::Vector;

use crate::core::optics;
use crate::shading::bsdf::fresnel;
use crate::shading::bsdf::layered::{PLANE, lattice};
use crate::shading::bsdf::microfacet::Microfacets;

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
        let outside = cosines.map(|cos| {
            let points = lattice(FACETS[0] as u32, PLANE);
            reflected_and_refracted(microfacets, eta, cos, points)
        });
        // Other facets for each cosine.
        let mut points = lattice((FACETS[1] * COSINES) as u32, PLANE);
        let inside = cosines
            .map(|cos| reflected_and_refracted(microfacets, 1.0 / eta, cos, points.by_ref().take(FACETS[1])));
        let sides = [0, 1].map(|side| outside.map(|parts| parts[side]));
        Self {
            eta,
            microfacets,
            sides,
            mean_transmission: mean(sides[1]),
            internal_reflectance: mean(inside.map(|[reflected, _]| reflected)),
        }
    }

    pub(super) fn eta(&self) -> f32 {
        self.eta
    }

    pub(super) fn microfacets(&self) -> Microfacets {
        self.microfacets
    }

    /// As [`Self::new`], once for each surface, and as long as the process: BSDFs are copied, and refer to it.
    pub fn kept(eta: f32, microfacets: Microfacets) -> &'static Self {
        static KEPT: Mutex<Vec<&'static Interface>> = Mutex::new(Vec::new());
        let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
        let eta = fresnel::valid_eta(eta);
        match kept.iter().find(|known| known.eta == eta && known.microfacets == microfacets) {
            Some(known) => known,
            None => {
                let made: &'static Self = Box::leak(Box::new(Self::new(eta, microfacets)));
                kept.push(made);
                made
            }
        }
    }
}

/// The fractions of light along a direction of the given cosine that single facets reflect to its side, and refract to the other, by
/// numbers in [0, 1). `eta` is the index beyond over that on the side of the light.
fn reflected_and_refracted(
    microfacets: Microfacets,
    eta: f32,
    cos: f32,
    points: impl Iterator<Item = [f32; 2]>,
) -> [f32; 2] {
    let wo = Vector { x: (1.0 - cos * cos).max(0.0).sqrt(), y: 0.0, z: cos };
    let seen = |wi| {
        let [g, g1] = microfacets.g_and_g1(wo, wi);
        f64::from(g / g1)
    };
    let (mut sums, mut count) = ([0.0; 2], 0.0);
    for u in points {
        count += 1.0;
        let wm = microfacets.sample(wo, u);
        let fresnel = optics::fresnel_dielectric(wo.dot(wm), eta);
        let reflected = optics::reflect(wo, wm);
        if reflected.z > 0.0 {
            sums[0] += f64::from(fresnel) * seen(reflected);
        }
        let (refracted, is_refracted) = optics::refract(wo, wm, eta);
        if is_refracted && refracted.z < 0.0 {
            sums[1] += f64::from(1.0 - fresnel) * seen(refracted);
        }
    }
    sums.map(|sum| (sum / count) as f32)
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
