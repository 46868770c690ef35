//! Photon beam diffusion: the light that leaves a flat medium around the point where a perpendicular beam enters.
//!
//! The beam is a line of sources below the surface, over which integrals are sums of samples with exponentially increasing
//! depth. Light that is scattered often is that of dipoles with Grosjean's diffusion coefficient and a boundary that reflects
//! (d'Eon & Irving 2011); light that is scattered once is integrated without approximation.
//!
//! Habel, Christensen & Jarosz 2013.

use std::f64::consts::PI;

/// Samples of the beam, as many as pbrt-v4 takes: its profiles depend on them.
const SAMPLES: usize = 100;

/// A medium of extinction 1 below a smooth boundary.
pub(super) struct BeamDiffusion {
    g: f64,
    eta: f64,
    /// Moments of the Fresnel reflectance from inside.
    moments: [f64; 2],
    /// Depths of the samples, for an extinction of 1.
    depths: [f64; SAMPLES],
}

impl BeamDiffusion {
    pub(super) fn new(g: f64, eta: f64) -> Self {
        let part = |i: usize| (i as f64 + 0.5) / SAMPLES as f64;
        Self {
            g,
            eta,
            moments: [1, 2].map(|order| fresnel_moment(1.0 / eta, order)),
            depths: std::array::from_fn(|i| -libm::log(1.0 - part(i))),
        }
    }

    /// The exitance at the distance `r`, for a beam of power 1 and a single-scattering albedo.
    pub(super) fn exitance(&self, albedo: f64, r: f64) -> f64 {
        self.single(albedo, r) + self.multiple(albedo, r)
    }

    /// The profile of light scattered more than once.
    fn multiple(&self, scattering: f64, r: f64) -> f64 {
        let absorption = 1.0 - scattering;
        // Reduced coefficients: as if scattering were the same in all directions (similarity theory).
        let reduced = scattering * (1.0 - self.g);
        let extinction = absorption + reduced;
        let albedo = reduced / extinction;
        let diffusion = (2.0 * absorption + reduced) / (3.0 * extinction * extinction);
        let transport = (absorption / diffusion).sqrt();
        // The mirror source is above the plane where the fluence of a reflecting boundary is extrapolated to 0.
        let [first, second] = self.moments;
        let extrapolation = 2.0 * diffusion * (1.0 + 3.0 * second) / (1.0 - 2.0 * first);
        // The parts of fluence and flux in the exitance.
        let (of_fluence, of_flux) = (0.25 * (1.0 - 2.0 * first), 0.5 * (1.0 - 3.0 * second));
        let point = |depth: f64, distance: f64| {
            let decay = libm::exp(-transport * distance) / (4.0 * PI * distance);
            let flux = depth * (1.0 + transport * distance) * decay / (distance * distance);
            of_fluence * decay / diffusion + of_flux * flux
        };
        let of_sample = |depth: f64| {
            let depth = depth / extinction;
            let mirrored = depth + 2.0 * extrapolation;
            let [to_source, to_mirror] = [depth, mirrored].map(|depth| (r * r + depth * depth).sqrt());
            // Diffusion is too bright near the source (Habel et al., equation 9).
            let correction = 1.0 - libm::exp(-2.0 * extinction * (to_source + depth));
            correction * (point(depth, to_source) - point(-mirrored, to_mirror))
        };
        albedo * albedo * self.mean(of_sample)
    }

    /// The profile of light scattered once.
    fn single(&self, albedo: f64, r: f64) -> f64 {
        // Light from above this depth is reflected totally.
        let critical = r * (self.eta * self.eta - 1.0).max(0.0).sqrt();
        albedo
            * self.mean(|depth| {
                let depth = critical + depth;
                let distance = (r * r + depth * depth).sqrt();
                let cos = depth / distance;
                let phase = henyey_greenstein(cos, self.g);
                let transmitted = 1.0 - fresnel(cos, 1.0 / self.eta);
                libm::exp(-(distance + critical)) / (distance * distance) * phase * transmitted * cos
            })
    }

    fn mean(&self, of_sample: impl Fn(f64) -> f64) -> f64 {
        self.depths.iter().map(|depth| of_sample(*depth)).sum::<f64>() / SAMPLES as f64
    }
}

/// The phase function for light that leaves against the direction from which it has come, by the cosine of that angle.
fn henyey_greenstein(cos: f64, g: f64) -> f64 {
    let denominator = 1.0 + g * g + 2.0 * g * cos;
    (1.0 - g * g) / (4.0 * PI * denominator * denominator.sqrt())
}

/// The Fresnel reflectance for a cosine of at least 0; `eta` is the index of refraction beyond the surface over the one before.
fn fresnel(cos: f64, eta: f64) -> f64 {
    let sin2 = (1.0 - cos * cos) / (eta * eta);
    if sin2 >= 1.0 {
        return 1.0;
    }
    let refracted = (1.0 - sin2).sqrt();
    let parallel = (eta * cos - refracted) / (eta * cos + refracted);
    let perpendicular = (cos - eta * refracted) / (cos + eta * refracted);
    0.5 * (parallel * parallel + perpendicular * perpendicular)
}

/// ∫ F(cos θ) cosᵏ θ d cos θ from 0 to 1, by the midpoint rule. (pbrt has polynomials for it, which are as good as 0.6 %.)
pub(crate) fn fresnel_moment(eta: f64, order: i32) -> f64 {
    const STEPS: u32 = 4096;
    let cos = |step: u32| (f64::from(step) + 0.5) / f64::from(STEPS);
    let weighted = |cos: f64| fresnel(cos, eta) * if order == 1 { cos } else { cos * cos };
    (0..STEPS).map(|step| weighted(cos(step))).sum::<f64>() / f64::from(STEPS)
}
