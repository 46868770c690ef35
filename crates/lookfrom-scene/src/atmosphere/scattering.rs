//! Light that the air scatters: once along a direction, and further in a table.

use std::f64::consts::PI;

use glam::DVec3;

use super::air::{self, Air, GROUND, TOP};
use super::bands::{Bands, COUNT};

/// Heights and cosines of the sun in the table, and the directions and steps from each.
const TABLE: [usize; 2] = [10, 24];
const DIRECTIONS: [u32; 2] = [8, 4];
const TABLE_STEPS: u32 = 12;
/// Steps along a direction.
const STEPS: u32 = 40;
/// The asymmetry of scattering by aerosol.
const ASYMMETRY: f64 = 0.76;

/// The light of the sun, of irradiance 1 at each wavelength, in the air.
pub(super) struct Scattering<'a> {
    air: &'a Air,
    /// The mean over all directions of the radiance that was scattered at least once, by height and cosine of the sun.
    mean: Vec<Bands>,
    steps: u32,
}

/// Light that a ray gathers: light scattered once by all kinds alike, and what of a uniform radiance 1 it would scatter.
#[derive(Clone, Copy)]
struct Gathered {
    once: Bands,
    again: Bands,
}

impl<'a> Scattering<'a> {
    pub(super) fn new(air: &'a Air, albedo: f64) -> Self {
        let entries = (0..TABLE[0] * TABLE[1]).collect();
        let mean = crate::parallel::map(entries, |entry: usize| {
            let height = (entry / TABLE[1]) as f64 / (TABLE[0] - 1) as f64;
            let r = GROUND + (TOP - GROUND) * height * height;
            mean_radiance(air, albedo, r, sun_of(entry % TABLE[1]))
        });
        Self { air, mean, steps: STEPS }
    }

    /// The integrator with many more steps along each direction.
    #[cfg(test)]
    pub(super) fn with_steps(self, steps: u32) -> Self {
        Self { steps, ..self }
    }

    /// The radiance from a direction above the horizon for an observer on the ground; the sun's disk is not in it. Both
    /// directions are of unit length, with z up.
    pub(super) fn radiance(&self, view: DVec3, sun: DVec3) -> Bands {
        let cos = view.dot(sun).clamp(-1.0, 1.0);
        let phases = [rayleigh_phase(cos), cornette_shanks(cos)];
        let mut sum = [0.0; COUNT];
        march(self.air, GROUND, view.z, air::to_top(GROUND, view.z), self.steps, |step| {
            let up = (DVec3::new(0.0, 0.0, GROUND) + step.distance * view) / step.r;
            let mu = up.dot(sun);
            let sunlight = self.air.sunlight(step.r, mu);
            let further = self.mean_at(step.r, mu);
            for i in 0..COUNT {
                let scattered = (0..2)
                    .map(|kind| step.scattering[kind][i] * (phases[kind] * sunlight[i] + further[i]))
                    .sum::<f64>();
                sum[i] += step.weight[i] * scattered;
            }
        });
        sum
    }

    fn mean_at(&self, r: f64, mu: f64) -> Bands {
        let place = |part: f64, count: usize| {
            let place = part.clamp(0.0, 1.0) * (count - 1) as f64;
            let below = (place as usize).min(count - 2);
            (below, place - below as f64)
        };
        let (row, t) = place(((r - GROUND).max(0.0) / (TOP - GROUND)).sqrt(), TABLE[0]);
        let (column, s) = place(0.5 + 0.5 * mu.abs().sqrt().copysign(mu), TABLE[1]);
        let at = |row: usize, column: usize| &self.mean[row * TABLE[1] + column];
        let corners = [at(row, column), at(row, column + 1), at(row + 1, column), at(row + 1, column + 1)];
        let weights = [(1.0 - t) * (1.0 - s), (1.0 - t) * s, t * (1.0 - s), t * s];
        std::array::from_fn(|i| corners.iter().zip(weights).map(|(corner, weight)| corner[i] * weight).sum())
    }
}

/// The cosine of the sun in a column of the table: close to each other where it sets.
fn sun_of(column: usize) -> f64 {
    let x = 2.0 * column as f64 / (TABLE[1] - 1) as f64 - 1.0;
    x * x.abs()
}

/// The mean radiance at a radius: the first scattering, and the sum of the geometric series that follows, where each
/// scattering is taken to be isotropic and as likely as the one before (Hillaire 2020, section 5.5).
fn mean_radiance(air: &Air, albedo: f64, r: f64, mu_sun: f64) -> Bands {
    let sun = DVec3::new((1.0 - mu_sun * mu_sun).max(0.0).sqrt(), 0.0, mu_sun);
    let mut mean = Gathered { once: [0.0; COUNT], again: [0.0; COUNT] };
    for index in 0..DIRECTIONS[0] * DIRECTIONS[1] {
        let up = 2.0 * (f64::from(index / DIRECTIONS[1]) + 0.5) / f64::from(DIRECTIONS[0]) - 1.0;
        let level = (1.0 - up * up).sqrt();
        // The sun is in the plane y = 0, which mirrors the other half.
        let (y, x) = libm::sincos(PI * (f64::from(index % DIRECTIONS[1]) + 0.5) / f64::from(DIRECTIONS[1]));
        let gathered = gather(air, albedo, r, DVec3::new(level * x, level * y, up), sun);
        for i in 0..COUNT {
            mean.once[i] += gathered.once[i] / f64::from(DIRECTIONS[0] * DIRECTIONS[1]);
            mean.again[i] += gathered.again[i] / f64::from(DIRECTIONS[0] * DIRECTIONS[1]);
        }
    }
    std::array::from_fn(|i| mean.once[i] / (1.0 - mean.again[i].min(0.99)))
}

fn gather(air: &Air, albedo: f64, r: f64, view: DVec3, sun: DVec3) -> Gathered {
    let mut gathered = Gathered { once: [0.0; COUNT], again: [0.0; COUNT] };
    let ground = air::to_ground(r, view.z);
    let length = ground.unwrap_or_else(|| air::to_top(r, view.z));
    let origin = DVec3::new(0.0, 0.0, r);
    let passed = march(air, r, view.z, length, TABLE_STEPS, |step| {
        let up = (origin + step.distance * view) / step.r;
        let sunlight = air.sunlight(step.r, up.dot(sun));
        for (i, sunlight) in sunlight.into_iter().enumerate() {
            let scattered = step.weight[i] * (step.scattering[0][i] + step.scattering[1][i]);
            gathered.once[i] += scattered * sunlight / (4.0 * PI);
            gathered.again[i] += scattered;
        }
    });
    if let Some(distance) = ground {
        let mu = ((origin + distance * view) / GROUND).dot(sun);
        let sunlight = air.sunlight(GROUND, mu);
        for i in 0..COUNT {
            gathered.once[i] += passed[i] * sunlight[i] * mu.max(0.0) * albedo / PI;
        }
    }
    gathered
}

/// A piece of a ray: where it is, what scatters there, and what of the light scattered per km arrives.
struct Step {
    distance: f64,
    r: f64,
    scattering: [Bands; 2],
    weight: Bands,
}

/// Visits the pieces of a ray from its origin on, short ones first. Returns the transmittance of all.
fn march(air: &Air, r: f64, mu: f64, length: f64, steps: u32, mut visit: impl FnMut(Step)) -> Bands {
    let mut passed = [1.0; COUNT];
    for step in 0..steps {
        let [begin, end] = [step, step + 1].map(|step| {
            let part = f64::from(step) / f64::from(steps);
            length * part * part
        });
        let distance = 0.5 * (begin + end);
        let radius = (r * r + 2.0 * r * mu * distance + distance * distance).sqrt();
        let (extinction, scattering) = air.at(radius);
        let mut weight = [0.0; COUNT];
        for i in 0..COUNT {
            let thickness = extinction[i] * (end - begin);
            let absorbed = -libm::expm1(-thickness);
            weight[i] = passed[i] * if thickness > 0.0 { absorbed / extinction[i] } else { end - begin };
            passed[i] *= 1.0 - absorbed;
        }
        visit(Step { distance, r: radius, scattering, weight });
    }
    passed
}

fn rayleigh_phase(cos: f64) -> f64 {
    3.0 / (16.0 * PI) * (1.0 + cos * cos)
}

fn cornette_shanks(cos: f64) -> f64 {
    let g2 = ASYMMETRY * ASYMMETRY;
    let base = 1.0 + g2 - 2.0 * ASYMMETRY * cos;
    3.0 / (8.0 * PI) * (1.0 - g2) / (2.0 + g2) * (1.0 + cos * cos) / (base * base.sqrt())
}
