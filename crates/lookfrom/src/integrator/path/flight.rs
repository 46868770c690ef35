//! Free flights: how far a path travels in a medium before that scatters it.
//!
//! Where the extinction σ_t differs from lane to lane, the distance is sampled with that of one lane, chosen by the share
//! P of each in the path's throughput, and its density is that of all choices together: the balance heuristic over lanes in
//! one sample (Veach 1997, section 9.2.4). Choosing by throughput is that of Kutz et al. 2017 (Spectral and Decomposition
//! Tracking, "history-aware"): a path that one lane alone carries is sampled as that lane asks, and in a medium that absorbs
//! nothing the sum of the lanes stays what it was.

use crate::core::math::chosen;
use crate::core::spectrum::Spectrum;
use crate::medium::Coefficients;

/// A sampled flight.
#[derive(Clone, Copy, Debug)]
pub struct Flight {
    /// σ_t: the extinction coefficient, per unit of length.
    pub extinction: Spectrum,
    /// σ_s: the scattering coefficient.
    pub scattering: Spectrum,
    /// P: the probability of each lane.
    pub choice: Spectrum,
    /// The lane that was chosen.
    pub lane: u32,
    /// The distance of what the ray hits; infinite where it hits nothing.
    pub limit: f32,
    /// The distance that was sampled.
    pub distance: f32,
    /// T: the transmittance over the way, e^(−σ_t · length).
    pub transmittance: Spectrum,
    /// The density of the distance of scattering, q = Σ P σ_t T; where the path is not scattered, its probability Q = Σ P T.
    pub density: f32,
    /// The throughput before …
    pub before: Spectrum,
    /// … and at the end of the way: β σ_s T / q, or β T / Q.
    pub after: Spectrum,
}

impl Flight {
    /// Samples a flight of a path with a throughput, which is not black, by `u ∈ [0, 1)²`: the lane and the distance.
    pub(super) fn sample(medium: &Coefficients, beta: Spectrum, limit: f32, [which, u]: [f32; 2]) -> Self {
        let (extinction, scattering) = (medium.extinction(), medium.scattering);
        let choice = beta / beta.0.iter().sum::<f32>();
        let lane = chosen(&choice.0, which);
        let distance = match extinction.0[lane] {
            0.0 => f32::INFINITY,
            sigma => -libm::log1pf(-u) / sigma,
        };
        let is_scattered = distance < limit;
        let length = distance.min(limit);
        let transmittance =
            extinction.map(|sigma| if sigma == 0.0 { 1.0 } else { libm::expf(-sigma * length) });
        let part = if is_scattered { extinction * transmittance } else { transmittance };
        let density = (choice * part).0.iter().sum::<f32>();
        let kept = if is_scattered { scattering * transmittance } else { transmittance };
        let after = beta * kept / density;
        Self {
            extinction,
            scattering,
            choice,
            lane: lane as u32,
            limit,
            distance,
            transmittance,
            density,
            before: beta,
            after,
        }
    }

    /// Whether the medium scatters the path before it arrives.
    pub fn is_scattered(&self) -> bool {
        self.distance < self.limit
    }
}

#[cfg(test)]
mod tests;
