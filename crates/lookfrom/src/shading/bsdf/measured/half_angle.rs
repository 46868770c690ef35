//! MERL's tables: values by half vector and difference vector, and densities for sampling that are made of them.
//!
//! A distribution of normals is the eigenvector of what comes back to where light comes from (Dupuy et al. 2015, "Extracting
//! Microfacet-based BRDF Parameters from Arbitrary Materials with Power Iterations"): there `f = D(ω) / (4 σ(ω) cos θ)` but for a factor.

use lookfrom_scene::measured::{HalfAngle, Table};
use lookfrom_simd::{Float, Real};

use super::interpolant::Interpolant;
use super::{across, jacobian, normal_at};
use crate::core::color::Unbounded;
use crate::core::elementary::{angle_in_turns, sin_cos_of_turns};
use crate::core::math::luminance;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;

/// Numbers of angles θ, from 0 to a quarter turn, for which there are densities.
const ANGLES: usize = 16;

/// Columns (by θ) and rows (by φ) of the density of visible normals.
const NORMALS: [usize; 2] = [91, 33];

/// Columns and rows of the density of the numbers that choose one.
const NUMBERS: usize = 32;

/// Rounds of the power iteration.
const ROUNDS: usize = 8;

/// The share of the mean that a density has at the least, for light where tables have some between numbers without it.
const LEAST: f32 = 0.01;

/// Values of a BRDF by half vector and difference vector.
pub(super) struct HalfAngleValues {
    counts: [usize; 3],
    values: Vec<[f32; 3]>,
}

impl HalfAngleValues {
    pub(super) fn new(written: &HalfAngle) -> Self {
        Self { counts: written.counts, values: written.values.clone() }
    }

    /// `f` at a [`place`] of two directions, for wavelengths or for red, green and blue.
    pub(super) fn value(&self, place: [f32; 3], wavelengths: Option<[f32; 4]>) -> Spectrum {
        let rgb = self.between(place);
        match wavelengths {
            Some(wavelengths) => Unbounded::from_rgb(rgb).at(&wavelengths),
            None => Spectrum::from_rgb(rgb),
        }
    }

    /// The value at a place of the unit cube, linear between the middles of cells. The last coordinate is periodic.
    fn between(&self, place: [f32; 3]) -> [f32; 3] {
        let mut cells = [[0; 2]; 3];
        let mut shares = [0.0; 3];
        for k in 0..3 {
            let count = self.counts[k];
            let scaled = place[k].clamp(0.0, 1.0) * count as f32 - 0.5;
            let below = scaled.floor();
            shares[k] = scaled - below;
            let of = |cell: i64| match k {
                2 => cell.rem_euclid(count as i64) as usize,
                _ => cell.clamp(0, count as i64 - 1) as usize,
            };
            cells[k] = [of(below as i64), of(below as i64 + 1)];
        }
        let mut sum = [0.0; 3];
        for corner in 0..8_usize {
            let above = [corner & 1, corner >> 1 & 1, corner >> 2];
            let weight: f32 =
                (0..3).map(|k| if above[k] == 1 { shares[k] } else { 1.0 - shares[k] }).product();
            let [h, d, phi] = [0, 1, 2].map(|k| cells[k][above[k]]);
            let value = self.values[(h * self.counts[1] + d) * self.counts[2] + phi];
            (0..3).for_each(|channel| sum[channel] += weight * value[channel]);
        }
        sum
    }

    fn luminance(&self, wo: Vector<f32>, wi: Vector<f32>) -> f32 {
        luminance(self.between(place(wo, wi)))
    }

    /// The densities of visible normals, and of the numbers that choose one by the luminance of what they reflect.
    pub(super) fn densities(&self) -> [Interpolant<2>; 2] {
        let distribution = self.normals();
        let theta: Vec<f32> =
            (0..ANGLES).map(|k| std::f32::consts::FRAC_PI_2 * (k as f32 + 0.25) / ANGLES as f32).collect();
        let outgoing: Vec<Vector<f32>> = theta.iter().map(|&theta| direction(theta)).collect();

        // D(ω_m) (ω_o · ω_m), and the solid angles of places.
        let [columns, rows] = NORMALS;
        let normal = |column: usize, row: usize| {
            normal_at([column as f32 / (columns - 1) as f32, row as f32 / (rows - 1) as f32], 0.0)
        };
        let solid_angles: Vec<f32> = (0..columns * rows)
            .map(|place| (place % columns) as f32 * across(normal(place % columns, 0)))
            .collect();
        let mut values = Vec::with_capacity(ANGLES * columns * rows);
        for &wo in &outgoing {
            for row in 0..rows {
                values.extend(
                    (0..columns).map(|column| distribution[column] * wo.dot(normal(column, row)).max(0.0)),
                );
            }
        }
        for table in values.chunks_mut(columns * rows) {
            raise(table, &solid_angles);
            table.iter_mut().zip(&solid_angles).for_each(|(value, angle)| *value *= angle);
        }
        let vndf = Interpolant::density(&Table { size: NORMALS, values }, [&[0.0], &theta]);

        // What normals reflect, for the density that they have.
        let mut values = Vec::with_capacity(ANGLES * NUMBERS * NUMBERS);
        for (&theta, &wo) in theta.iter().zip(&outgoing) {
            let between = vndf.between([0.0, theta]);
            for place in 0..NUMBERS * NUMBERS {
                let u = [place % NUMBERS, place / NUMBERS]
                    .map(|k| (k as f32 / (NUMBERS - 1) as f32).clamp(1e-3, 1.0 - 1e-3));
                let reflected = vndf.sample(u, &between).map_or(0.0, |(normal, density)| {
                    let wm = normal_at(normal, 0.0);
                    let wi = wm * (wo.dot(wm) * 2.0) - wo;
                    let is_seen = wi.z > 0.0 && wo.dot(wm) > 0.0;
                    let weight = wi.z * jacobian(wo, wm, normal) / density;
                    if is_seen { self.luminance(wo, wi) * weight } else { 0.0 }
                });
                values.push(reflected);
            }
        }
        values.chunks_mut(NUMBERS * NUMBERS).for_each(|table| raise(table, &[1.0; NUMBERS * NUMBERS]));
        let size = [NUMBERS; 2];
        [vndf, Interpolant::density(&Table { size, values }, [&[0.0], &theta])]
    }

    /// The distribution of normals by columns of places, but for a factor.
    fn normals(&self) -> Vec<f32> {
        let count = NORMALS[0];
        let theta_of = |k: usize| {
            let x = k as f32 / (count - 1) as f32;
            std::f32::consts::FRAC_PI_2 * x * x
        };
        let directions: Vec<Vector<f32>> = (0..count).map(|k| direction(theta_of(k))).collect();
        let back: Vec<f32> = directions.iter().map(|&w| self.luminance(w, w) * w.z.max(0.0)).collect();

        // ∫ max(0, ω · ω_m) dφ, times the solid angle of a column of normals.
        const AROUND: usize = 64;
        let seen = |w: Vector<f32>, k: usize| {
            let wm = directions[k];
            let turn = (0..AROUND).map(|step| sin_cos_of_turns((step as f32 + 0.5) / AROUND as f32).1);
            let sum: f32 = turn.map(|cos| (w.x * wm.x * cos + w.z * wm.z).max(0.0)).sum();
            sum * wm.x * k as f32
        };
        let kernel: Vec<f32> = directions
            .iter()
            .flat_map(|&w| (0..count).map(move |k| (w, k)))
            .map(|(w, k)| seen(w, k))
            .collect();

        let mut density = vec![1.0; count];
        for _ in 0..ROUNDS {
            let sigma =
                kernel.chunks(count).map(|row| row.iter().zip(&density).map(|(a, b)| a * b).sum::<f32>());
            let next: Vec<f32> = sigma.zip(&back).map(|(sigma, back)| sigma * back).collect();
            let most = next.iter().copied().fold(0.0, f32::max);
            if !(most > 0.0) {
                return vec![1.0; count];
            }
            density = next.into_iter().map(|value| value / most).collect();
        }
        density
    }
}

/// The place of two directions on the outside in the unit cube of tables.
#[inline(always)]
pub(super) fn place<R: Real>(wo: Vector<R>, wi: Vector<R>) -> [R; 3] {
    let (zero, one) = (wi.z.like(0.0), wi.z.like(1.0));
    let (wm, exists) = (wo + wi).try_normalize();
    let wm = Vector::select(exists, wm, Vector::splat(zero, [0.0; 3]));

    // Light in a frame of the half vector, whose x points away from the normal.
    let (sin_h, cos_h) = (across(wm), wm.z);
    let is_turned = sin_h.gt(zero);
    let cos_phi = R::select(is_turned, wm.x / sin_h, one);
    let sin_phi = R::select(is_turned, wm.y / sin_h, zero);
    let along = cos_phi * wi.x + sin_phi * wi.y;
    let d = Vector {
        x: cos_h * along - sin_h * wi.z,
        y: cos_phi * wi.y - sin_phi * wi.x,
        z: sin_h * along + cos_h * wi.z,
    };

    // Quarter turns of θ_h and θ_d, half turns of φ_d.
    let theta_h = angle_in_turns(sin_h, cos_h) * 4.0;
    let theta_d = angle_in_turns(across(d), d.z) * 4.0;
    let phi = angle_in_turns(d.y, d.x) * 2.0;
    [Float::sqrt(Float::max(theta_h, zero)), theta_d, phi - Float::floor(phi)]
}

/// The direction at an angle to the normal, above the x axis.
fn direction(theta: f32) -> Vector<f32> {
    let (sin, cos) = sin_cos_of_turns(theta / (2.0 * std::f32::consts::PI));
    Vector { x: sin, y: 0.0, z: cos }
}

/// Raises the numbers of a table to a share of their weighted mean; without any they become 1.
fn raise(table: &mut [f32], weights: &[f32]) {
    let sum: f32 = table.iter().zip(weights).map(|(value, weight)| value * weight).sum();
    let least = if sum > 0.0 { LEAST * sum / weights.iter().sum::<f32>() } else { 1.0 };
    table.iter_mut().for_each(|value| *value = value.max(least));
}

#[cfg(test)]
mod tests;
