//! Tracking: rays through a medium that varies, by collisions whose density is a majorant m of the extinction σ_t (Woodcock et al. 1965).
//!
//! Of a path (delta tracking) each collision is real with a probability q that follows from the throughput, as flights in homogeneous
//! media do: q = Σ P σ_t / m, where P is the share of each lane in the throughput. A real one scatters the path, with β σ_s / (m q);
//! after a null one it goes on, with β (m − σ_t) / (m (1 − q)). This is the expectation over the choice of one lane to track by (Kutz et
//! al. 2017, "history-aware"; the balance heuristic of Miller, Georgiev & Jarosz 2019 over all lanes): in a medium that absorbs nothing the
//! sum of the lanes stays what it was. Of a shadow ray (ratio tracking, Novák et al. 2014) all collisions are null: q = 0.
//!
//! Eight rays are tracked side by side, and where one ends the next takes its lane. What becomes of a ray does not depend on the others.

mod lanes;

use lanes::Tracker;

use super::{Coefficients, Medium, Profile, Way};
use crate::core::lanes::width::One;
use crate::core::lanes::{are_shaded_together, shade_together};
use crate::core::spectrum::Spectrum;
use crate::shading::texture::{SpectralMode, Textures};

/// A ray to be tracked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TrackedRay<'a> {
    pub(crate) way: Way,
    /// Its throughput at the beginning, which is not black.
    pub(crate) throughput: Spectrum,
    /// A random number in [0, 1), for the first collision.
    pub(crate) u: f32,
    /// The seed of all others.
    pub(crate) seed: u64,
    pub(crate) mode: &'a SpectralMode,
}

/// The quantity that is estimated along rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Estimate {
    /// The distance at which the medium scatters a ray, and the light that it emits on the way.
    Flight,
    /// The transmittance over the way.
    Transmittance,
}

/// The way of a ray through a medium that varies.
#[derive(Clone, Debug, Default)]
pub struct Tracking {
    /// The throughput before …
    pub before: Spectrum,
    /// … and at the end of the way.
    pub after: Spectrum,
    /// The light that the medium emits on the way, in its mean, times the throughput.
    pub emitted: Spectrum,
    /// The distance of what the ray hits or, where it hits nothing, of the end of a medium that fills space; infinite where that has none.
    pub limit: f32,
    /// The distance at which the path is scattered, if it is.
    pub scattered_at: Option<f32>,
    /// All collisions, for a probe; otherwise none.
    pub collisions: Vec<Collision>,
    /// The medium along the way, for a probe of a flight.
    pub profile: Option<Box<Profile>>,
}

/// A point of a ray at which it may interact with a medium.
#[derive(Clone, Copy, Debug)]
pub struct Collision {
    /// The distance of the ray.
    pub t: f32,
    /// m: the density of collisions, per unit of length, no less than σ_t in any lane.
    pub majorant: f32,
    /// The coefficients there.
    pub coefficients: Coefficients,
    /// q: the probability that it is real.
    pub probability: f32,
    /// Whether it is: less than q was drawn.
    pub is_real: bool,
    /// β σ_a L_e / m: the light that the medium adds by this collision.
    pub emitted: Spectrum,
    /// The throughput after it.
    pub beta: Spectrum,
}

impl Medium {
    /// Tracks rays; `None` in a homogeneous medium. `listens` keeps collisions and profiles.
    pub(crate) fn track(
        &self,
        textures: &Textures,
        estimate: Estimate,
        rays: &[TrackedRay<'_>],
        listens: bool,
    ) -> Option<Vec<Tracking>> {
        let varying = self.varying.as_deref()?;
        let is_flight = estimate == Estimate::Flight;
        let begun = |ray: &TrackedRay<'_>| Tracking {
            before: ray.throughput,
            after: ray.throughput,
            limit: ray.way.length,
            profile: match listens && is_flight {
                true => self.profile(&ray.way, (textures, ray.mode)),
                false => None,
            },
            ..Tracking::default()
        };
        let mut tracked: Vec<Tracking> = rays.iter().map(begun).collect();
        let tracker = Tracker {
            medium: self,
            varying,
            textures,
            rays,
            tracked: &mut tracked,
            scatters: is_flight && self.phase.is_some(),
            emits: is_flight && self.emission.is_some(),
            listens,
        };
        match rays.len() > 1 && are_shaded_together() {
            true => shade_together(tracker),
            false => tracker.track(One),
        }
        Some(tracked)
    }

    /// An estimate of the transmittance over a way through a medium that varies, by random numbers that are a function of the way.
    /// `None` in a homogeneous medium.
    pub(crate) fn estimated_transmittance(
        &self,
        way: &Way,
        (textures, mode): (&Textures, &SpectralMode),
        listens: bool,
    ) -> Option<Tracking> {
        self.track(textures, Estimate::Transmittance, &[TrackedRay::of_shadow(way, mode)], listens)?.pop()
    }
}

impl<'a> TrackedRay<'a> {
    /// A ray whose transmittance is asked for; its random numbers are a function of the way.
    pub(crate) fn of_shadow(way: &Way, mode: &'a SpectralMode) -> Self {
        Self { way: *way, throughput: mode.one(), u: way.number(), seed: way.hash(), mode }
    }
}

impl Collision {
    /// Coefficient of null collisions: the majorant less the extinction coefficient, at least 0.
    pub fn null(&self) -> Spectrum {
        self.coefficients.extinction().map(|sigma| (self.majorant - sigma).max(0.0))
    }
}
