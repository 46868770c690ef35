//! Tables of radial profiles: by albedo and optical radius, for one phase function and index of refraction.
//!
//! Profiles are interpolated by Catmull–Rom splines in both; the nodes are pbrt-v4's.

use std::f64::consts::TAU;

use super::beam_diffusion::BeamDiffusion;
use super::spline::{Cubic, Nodes};
use crate::core::parallel;

const ALBEDOS: usize = 100;
const RADII: usize = 64;

/// The part of a profile's light that is as near as the radius of the probing sphere: pbrt's, whose pictures lack the rest.
const WITHIN: f32 = 0.999;

/// The profiles of all media of one phase function below one kind of boundary.
#[derive(Debug)]
pub(crate) struct ProfileTable {
    albedos: Nodes,
    /// Distances times the extinction coefficient.
    radii: Nodes,
    /// By albedo.
    rows: Vec<Row>,
    /// By albedo, the light that leaves at any distance.
    effective_albedo: Vec<Cubic>,
}

/// The profile of one albedo, by radius.
#[derive(Debug)]
struct Row {
    /// 2π r S_r: the light that leaves at a radius, by radius.
    light: Vec<Cubic>,
    /// Its integrals from 0; the last is the effective albedo.
    integrals: Vec<f64>,
}

impl ProfileTable {
    /// For the mean cosine of the scattering angle and the index of refraction, inside over outside.
    pub(crate) fn new(g: f32, eta: f32) -> Self {
        let radius = |i: usize| if i == 0 { 0.0 } else { 2.5e-3 * (1..i).fold(1.0, |power, _| power * 1.2) };
        let distances: Vec<f64> = (0..RADII).map(radius).collect();
        let radii = Nodes::new(distances.clone());
        let albedo = |i: usize| libm::expm1(-8.0 * i as f64 / (ALBEDOS - 1) as f64) / libm::expm1(-8.0);
        let diffusion = BeamDiffusion::new(g.into(), eta.into());
        let rows: Vec<Row> = parallel::collect(ALBEDOS, |i| {
            let light = |r: &f64| if *r > 0.0 { TAU * r * diffusion.exitance(albedo(i), *r) } else { 0.0 };
            let light: Vec<f64> = distances.iter().map(light).collect();
            let light = radii.cubics(&light);
            let integrals = radii.integrals(&light);
            Row { light, integrals }
        });
        let albedos = Nodes::new((0..ALBEDOS).map(albedo).collect());
        let effective: Vec<f64> = rows.iter().map(|row| row.integrals[RADII - 1]).collect();
        let effective_albedo = albedos.cubics(&effective);
        Self { albedos, radii, rows, effective_albedo }
    }

    /// The fraction of the light that has entered which leaves again, by the single-scattering albedo.
    pub(crate) fn effective_albedo(&self, albedo: f32) -> f32 {
        self.effective_albedo_at(self.place(albedo)) as f32
    }

    /// The single-scattering albedo of an effective one; 1 where that is greater than any.
    pub(crate) fn albedo_of(&self, effective: f32) -> f32 {
        self.albedos.inverse(&self.effective_albedo, effective.into()) as f32
    }

    /// The profile of a medium.
    pub(super) fn profile(&self, extinction: f32, albedo: f32) -> Profile<'_> {
        let place = self.place(albedo);
        let rows = self.albedos.weights(place).map(|(row, weight)| (&self.rows[row], weight));
        let effective_albedo = if extinction > 0.0 { self.effective_albedo_at(place) } else { 0.0 };
        Profile { radii: &self.radii, extinction, rows, effective_albedo: effective_albedo as f32 }
    }

    /// The interval of an albedo, and the part of it.
    fn place(&self, albedo: f32) -> (usize, f64) {
        // NaN, of coefficients without bounds, counts as 0.
        let albedo = if albedo > 0.0 { f64::from(albedo).min(1.0) } else { 0.0 };
        self.albedos.place(albedo).expect("nodes from 0 to 1")
    }

    fn effective_albedo_at(&self, (interval, t): (usize, f64)) -> f64 {
        self.effective_albedo[interval].value(t)
    }
}

/// The profile S_r of a medium.
#[derive(Clone, Copy, Debug)]
pub(super) struct Profile<'a> {
    radii: &'a Nodes,
    extinction: f32,
    /// Those next to its albedo, with their weights.
    rows: [(&'a Row, f64); 4],
    /// The light that leaves at any distance; 0 where nothing is scattered.
    pub(super) effective_albedo: f32,
}

impl Profile<'_> {
    /// The part of the light that has entered which leaves at a distance, per area.
    pub(super) fn value(&self, distance: f32) -> f32 {
        let extinction = f64::from(self.extinction);
        let radius = f64::from(distance) * extinction;
        let Some((interval, t)) = self.radii.place(radius).filter(|_| radius > 0.0) else { return 0.0 };
        let per_area = self.light(interval).value(t) / (TAU * radius) * (extinction * extinction);
        (per_area as f32).max(0.0)
    }

    /// The density of points, per area, at a distance that [`Self::sample`] has chosen.
    pub(super) fn pdf(&self, distance: f32) -> f32 {
        if self.effective_albedo > 0.0 { self.value(distance) / self.effective_albedo } else { 0.0 }
    }

    /// A distance, by `u ∈ [0, 1)`, where anything is scattered.
    pub(super) fn sample(&self, u: f32) -> f32 {
        let wanted = f64::from(u) * self.integral(RADII - 1);
        let radius = self.radii.sample(|j| self.light(j), |j| self.integral(j), wanted);
        (radius / f64::from(self.extinction)) as f32
    }

    /// The distance within which other points are looked for.
    pub(super) fn reach(&self) -> f32 {
        self.sample(WITHIN)
    }

    fn light(&self, interval: usize) -> Cubic {
        let mut sum = [0.0; 4];
        for (row, weight) in self.rows {
            let cubic = row.light[interval].0;
            sum = std::array::from_fn(|k| sum[k] + weight * cubic[k]);
        }
        Cubic(sum)
    }

    fn integral(&self, node: usize) -> f64 {
        self.rows.iter().map(|(row, weight)| weight * row.integrals[node]).sum()
    }
}
