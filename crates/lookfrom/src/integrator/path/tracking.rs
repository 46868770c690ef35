//! Delta tracking: how far a path travels in a medium that varies before that scatters it (Woodcock et al. 1965).
//!
//! Collisions have the density of a majorant m. Each is real with a probability q that follows from the throughput, as flights in
//! homogeneous media do: q = Σ P σ_t / m, where P is the share of each lane in the throughput. A real one scatters the path, with
//! β σ_s / (m q); after a null one it goes on, with β (m − σ_t) / (m (1 − q)). This is the expectation over the choice of one lane to
//! track by (Kutz et al. 2017, "history-aware"; the balance heuristic of Miller, Georgiev & Jarosz 2019 over all lanes): in a medium that
//! absorbs nothing the sum of the lanes stays what it was.

use crate::core::hash;
use crate::core::random::Random;
use crate::core::spectrum::Spectrum;
use crate::integrator::SampleStream;
use crate::medium::{Collision, Medium, Way, survives};
use crate::shading::texture::{SpectralMode, Textures};

use super::dimension;

/// The way of a path through a medium that varies.
#[derive(Clone, Debug, Default)]
pub struct Tracking {
    /// The throughput before …
    pub before: Spectrum,
    /// … and at the end of the way.
    pub after: Spectrum,
    /// The light that the medium emits on the way, in its mean, times the throughput.
    pub emitted: Spectrum,
    /// The distance of what the ray hits; infinite where it hits nothing.
    pub limit: f32,
    /// The distance at which the path is scattered, if it is.
    pub scattered_at: Option<f32>,
    /// All collisions, for a probe; otherwise none.
    pub collisions: Vec<Tracked>,
}

/// A collision on the way of a path.
#[derive(Clone, Copy, Debug)]
pub struct Tracked {
    /// The point and the coefficients.
    pub collision: Collision,
    /// q: the probability that it is real.
    pub probability: f32,
    /// Whether it is: less than q was drawn.
    pub is_real: bool,
    /// β σ_a L_e / m: the light that the medium adds by this collision.
    pub emitted: Spectrum,
    /// The throughput after it.
    pub beta: Spectrum,
}

impl Tracking {
    /// Tracks a path with a throughput, which is not black. `listens` keeps the collisions.
    pub(super) fn sample(
        medium: &Medium,
        textures: (&Textures, &SpectralMode),
        (way, beta): (&Way, Spectrum),
        stream: &SampleStream,
        listens: bool,
    ) -> Self {
        let [u, seed] = stream.two(dimension::FLIGHT);
        let mut random = Random::new(hash::pair(u64::from(u.to_bits()), u64::from(seed.to_bits())));
        let mut tracking = Self { before: beta, after: beta, limit: way.length, ..Self::default() };
        let Some(mut collisions) = medium.collisions(way, textures, u) else { return tracking };
        while let Some(collision) = collisions.next(&mut random) {
            let Collision { majorant, coefficients, t } = collision;
            let beta = tracking.after;
            let emitted = beta * coefficients.absorption * coefficients.emission / majorant;
            tracking.emitted += emitted;
            let probability = match medium.scattering {
                Some(_) => (mean(coefficients.extinction(), beta) / majorant).min(1.0),
                None => 0.0,
            };
            let is_real = random.one() < probability;
            tracking.after = match is_real {
                true => beta * coefficients.scattering / (majorant * probability),
                false => beta * collision.null() / (majorant * (1.0 - probability)),
            };
            if listens {
                let beta = tracking.after;
                tracking.collisions.push(Tracked { collision, probability, is_real, emitted, beta });
            }
            if is_real {
                tracking.scattered_at = Some(t);
                break;
            }
            // Absorption alone makes the throughput weak.
            if !survives(&mut tracking.after, tracking.before.max_lane(), &mut random) {
                break;
            }
        }
        tracking
    }
}

/// The mean of a spectrum by shares of the throughput.
fn mean(of: Spectrum, beta: Spectrum) -> f32 {
    (of * beta).0.iter().sum::<f32>() / beta.0.iter().sum::<f32>()
}
