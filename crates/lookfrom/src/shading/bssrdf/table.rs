//! Tables of radial profiles: by albedo and optical radius, for one phase function and index of refraction.
//!
//! Profiles are interpolated by Catmull–Rom splines in both; the nodes are pbrt-v4's.

use std::f64::consts::TAU;

use super::beam_diffusion::BeamDiffusion;
use super::spline::{Weights, integrals, inverse, sample};
use crate::core::parallel;

const ALBEDOS: usize = 100;
const RADII: usize = 64;

/// The part of a profile's light that is as near as the radius of the probing sphere: pbrt's, whose pictures lack the rest.
const WITHIN: f32 = 0.999;

/// The profiles of all media of one phase function below one kind of boundary.
#[derive(Debug)]
pub(crate) struct ProfileTable {
    albedos: Vec<f64>,
    /// Distances times the extinction coefficient.
    radii: Vec<f64>,
    /// By albedo.
    rows: Vec<Row>,
}

/// The profile of one albedo, by radius.
#[derive(Debug)]
struct Row {
    /// 2π r S_r: the light that leaves at a radius, by radius.
    light: Vec<f64>,
    /// Its integrals from 0; the last is the effective albedo.
    integrals: Vec<f64>,
}

impl ProfileTable {
    /// For the mean cosine of the scattering angle and the index of refraction, inside over outside.
    pub(crate) fn new(g: f32, eta: f32) -> Self {
        let radius = |i: usize| if i == 0 { 0.0 } else { 2.5e-3 * (1..i).fold(1.0, |power, _| power * 1.2) };
        let radii: Vec<f64> = (0..RADII).map(radius).collect();
        let albedo = |i: usize| libm::expm1(-8.0 * i as f64 / (ALBEDOS - 1) as f64) / libm::expm1(-8.0);
        let albedos: Vec<f64> = (0..ALBEDOS).map(albedo).collect();
        let diffusion = BeamDiffusion::new(g.into(), eta.into());
        let rows = parallel::collect(ALBEDOS, |i| {
            let light: Vec<f64> = radii
                .iter()
                .map(|r| if *r > 0.0 { TAU * r * diffusion.exitance(albedos[i], *r) } else { 0.0 })
                .collect();
            let integrals = integrals(&radii, |j| light[j]);
            Row { light, integrals }
        });
        Self { albedos, radii, rows }
    }

    /// The fraction of the light that has entered which leaves again, by the single-scattering albedo.
    pub(crate) fn effective_albedo(&self, albedo: f32) -> f32 {
        self.weights(albedo).sum(|i| self.rows[i].effective_albedo()) as f32
    }

    /// The single-scattering albedo of an effective one; 1 where that is greater than any.
    pub(crate) fn albedo_of(&self, effective: f32) -> f32 {
        inverse(&self.albedos, |i| self.rows[i].effective_albedo(), effective.into()) as f32
    }

    /// The profile of a medium.
    pub(super) fn profile(&self, extinction: f32, albedo: f32) -> Profile<'_> {
        let weights = self.weights(albedo);
        let effective_albedo = if extinction > 0.0 { self.effective_albedo(albedo) } else { 0.0 };
        Profile { table: self, extinction, weights, effective_albedo }
    }

    fn weights(&self, albedo: f32) -> Weights {
        // NaN, of coefficients without bounds, counts as 0.
        let albedo = if albedo > 0.0 { f64::from(albedo).min(1.0) } else { 0.0 };
        Weights::at(&self.albedos, albedo).expect("nodes from 0 to 1")
    }
}

impl Row {
    fn effective_albedo(&self) -> f64 {
        *self.integrals.last().expect("as many as radii")
    }
}

/// The profile S_r of a medium.
#[derive(Clone, Copy, Debug)]
pub(super) struct Profile<'a> {
    table: &'a ProfileTable,
    extinction: f32,
    weights: Weights,
    /// The light that leaves at any distance; 0 where nothing is scattered.
    pub(super) effective_albedo: f32,
}

impl Profile<'_> {
    /// The part of the light that has entered which leaves at a distance, per area.
    pub(super) fn value(&self, distance: f32) -> f32 {
        let radius = f64::from(distance) * f64::from(self.extinction);
        let Some(radii) = Weights::at(&self.table.radii, radius).filter(|_| radius > 0.0) else { return 0.0 };
        let light = radii.sum(|j| self.light(j));
        let per_area = light / (TAU * radius) * f64::from(self.extinction) * f64::from(self.extinction);
        (per_area as f32).max(0.0)
    }

    /// The density of points, per area, at a distance that [`Self::sample`] has chosen.
    pub(super) fn pdf(&self, distance: f32) -> f32 {
        if self.effective_albedo > 0.0 { self.value(distance) / self.effective_albedo } else { 0.0 }
    }

    /// A distance, by `u ∈ [0, 1)`, where anything is scattered.
    pub(super) fn sample(&self, u: f32) -> f32 {
        let integral = |j: usize| self.weights.sum(|i| self.table.rows[i].integrals[j]);
        (sample(&self.table.radii, |j| self.light(j), integral, u.into()) / f64::from(self.extinction)) as f32
    }

    /// The distance within which other points are looked for.
    pub(super) fn reach(&self) -> f32 {
        self.sample(WITHIN)
    }

    fn light(&self, j: usize) -> f64 {
        self.weights.sum(|i| self.table.rows[i].light[j])
    }
}
