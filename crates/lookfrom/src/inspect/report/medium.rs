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
    /// The distance of what the ray hits or, where it hits nothing, of the end of a medium that fills space; infinite where that has none.
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
    /// The cosine of the angle between the directions before and after it.
    pub cos: f32,
    /// The phase function in that direction, per steradian: its value and its density.
    pub pdf: f32,
    /// The lobes whose mix it is.
    pub lobes: Vec<PhaseLobeReport>,
    /// The survival probability of Russian roulette.
    pub survival: f32,
    /// Whether the path goes on.
    pub survives: bool,
    /// β of the next ray: β / survival; `None` where there is none.
    pub next_throughput: Option<Factor>,
}

/// A lobe of a phase function.
#[derive(Clone, Debug, Serialize)]
pub struct PhaseLobeReport {
    /// `Henyey-Greenstein` or `Draine`.
    pub name: &'static str,
    /// Its share.
    pub weight: f32,
    /// g: its mean cosine; of Draine's lobe a parameter beside it.
    pub g: f32,
    /// α: 0 in that of Henyey and Greenstein.
    pub alpha: f32,
    /// Its value in the sampled direction, per steradian.
    pub value: f32,
    /// Whether the direction was sampled by it.
    pub is_sampled: bool,
}

/// The way of a ray through a medium that varies, by collisions whose density is a majorant of the extinction.
#[derive(Clone, Debug, Serialize)]
pub struct TrackingReport {
    /// The distance of what the ray hits or, where it hits nothing, of the end of a medium that fills space; infinite where that has none.
    pub limit: f32,
    /// Its collisions, in order: all are null, but for the last where the medium scatters it.
    pub collisions: Vec<CollisionReport>,
    /// The medium along the whole way, whether the ray goes on to there or not; `None` where it does not meet it.
    pub profile: Option<ProfileReport>,
    /// The point where it is scattered, in the world; `None` where it arrives.
    pub scattered_at: Option<[f64; 3]>,
    /// The throughput at the end.
    pub throughput: Factor,
}

/// Density along a ray: at the middles of as many equal parts of its way as there are numbers.
#[derive(Clone, Debug, Serialize)]
pub struct ProfileReport {
    /// The distance from which on there is something of the medium.
    pub start: f32,
    /// The distance up to which.
    pub end: f32,
    /// σ_t, in the mean of the lanes.
    pub extinction: Vec<f32>,
    /// The majorants of the cells there.
    pub majorant: Vec<f32>,
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
