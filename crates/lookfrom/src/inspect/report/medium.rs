//! The reports of media that scatter: flights, collisions, phase functions.

use serde::Serialize;

use super::Factor;

/// A flight in a homogeneous medium that scatters. The distance is sampled with the extinction of one lane, chosen by the throughput.
#[derive(Clone, Debug, Serialize)]
pub struct FlightReport {
    /// σ_t: the extinction coefficient, per unit of length.
    pub extinction: Factor,
    /// σ_s: the scattering coefficient.
    pub scattering: Factor,
    /// P: the probability of each lane, β / Σ β.
    pub choice: Factor,
    /// The index of the lane that was chosen.
    pub lane: u32,
    /// The distance of what the ray hits; infinite where it hits nothing.
    pub limit: f32,
    /// The distance that was sampled, `−ln(1 − u) / σ_t`: the ray is scattered where it is less than `limit`.
    pub distance: f32,
    /// The point where it is scattered, in the world; `None` where it arrives.
    pub scattered_at: Option<[f64; 3]>,
    /// T: `exp(−σ_t · length)` up to the point or the hit.
    pub transmittance: Factor,
    /// The density `q = Σ P σ_t T` of the distance, per unit of length, where it is scattered; else the probability `Q = Σ P T` of
    /// arriving.
    pub density: f32,
    /// The throughput after it: `β σ_s T / q`, or `β T / Q`.
    pub throughput: Factor,
}

/// Scattering by the phase function of a medium, which is its own density: β stays.
#[derive(Clone, Debug, Serialize)]
pub struct PhaseReport {
    /// The sampled direction, unit length.
    pub wi: [f32; 3],
    /// The phase function in that direction, per steradian: its value and its density.
    pub pdf: f32,
    /// The survival probability of Russian roulette.
    pub survival: f32,
    /// Whether the path goes on.
    pub survives: bool,
    /// β of the next ray: β / survival; `None` where there is none.
    pub next_throughput: Option<Factor>,
}

/// The way of a ray through a medium that varies, by collisions whose density is a majorant of the extinction.
#[derive(Clone, Debug, Serialize)]
pub struct TrackingReport {
    /// The distance of what the ray hits; infinite where it hits nothing.
    pub limit: f32,
    /// Its collisions, in order: all are null, but for the last where the medium scatters it.
    pub collisions: Vec<CollisionReport>,
    /// The point where it is scattered, in the world; `None` where it arrives.
    pub scattered_at: Option<[f64; 3]>,
    /// The throughput at the end.
    pub throughput: Factor,
}

/// A collision of a ray with a medium.
#[derive(Clone, Debug, Serialize)]
pub struct CollisionReport {
    /// Its distance, per unit of length.
    pub t: f32,
    /// m: the majorant, the density of collisions.
    pub majorant: f32,
    /// σ_a: the absorption coefficient there.
    pub absorption: Factor,
    /// σ_s: the scattering coefficient there.
    pub scattering: Factor,
    /// β σ_a L_e / m: the light that the medium adds.
    pub emitted: Factor,
    /// q: the probability that it is real, `Σ σ_t β / Σ β / m`.
    pub probability: f32,
    /// Whether it is real: the ray is scattered.
    pub is_real: bool,
    /// The throughput after it: `β σ_s / (m q)` where it is real, else `β (m − σ_t) / (m (1 − q))`. What has become weak may be ended by
    /// Russian roulette, or four times as strong.
    pub throughput: Factor,
}

/// A null collision of a shadow ray with a medium.
#[derive(Clone, Debug, Serialize)]
pub struct NullReport {
    /// Its distance.
    pub t: f32,
    /// m: the majorant, the density of collisions.
    pub majorant: f32,
    /// σ_t: the extinction coefficient there.
    pub extinction: Factor,
    /// The estimate of the transmittance after it, by `(m − σ_t) / m`, and by Russian roulette where it is weak.
    pub transmittance: Factor,
}
