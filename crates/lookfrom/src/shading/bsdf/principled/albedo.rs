//! Directional albedos of microfacets and sheen, by tables.
//!
//! Needed to divide energy between layers. There is no closed form, so small tables are integrated on first use (a
//! few milliseconds, once per process) and read with linear interpolation.
//!
//! The Fresnel term of a reflector is `F0 + (F90 − F0) s`, where s is 0 at normal and 1 at grazing incidence. So
//! two numbers, the means of 1 − s and of s over the visible normals, give its albedo for every F0 and F90 (the
//! split sum of Karis 2013). With F = 1 their sum is the albedo of single scattering; the rest is multiple
//! scattering (Kulla & Conty 2017).

use glam::Vec3;
use std::f32::consts::PI;
use std::sync::LazyLock;

use super::sheen;
use crate::core::math::{self, schlick};
use crate::shading::bsdf::microfacet::TrowbridgeReitz;

/// Number of rows, by the square root of the cosine.
const COSINES: usize = 32;
/// Number of columns, by the square root of α: glTF's roughness.
const ROUGHNESSES: usize = 24;
/// Number of microfacet normals per table entry: angles over half a circle (the other half is symmetric), and
/// radii.
const STEPS: [usize; 2] = [8, 24];

/// The directional albedo of a rough reflector, as a split sum.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Split {
    /// The mean of 1 − s.
    pub(super) straight: f32,
    /// The mean of s.
    pub(super) grazing: f32,
}

/// The means of 1 − s and of s for a smooth reflector.
pub(super) const SMOOTH_MEAN: Split = Split { straight: 20.0 / 21.0, grazing: 1.0 / 21.0 };

impl Split {
    /// The albedo for a Fresnel term of 1.
    #[inline]
    pub(super) fn all(self) -> f32 {
        self.straight + self.grazing
    }

    /// The albedo for a given F0 and F90.
    #[inline]
    pub(super) fn of(self, f0: f32, f90: f32) -> f32 {
        f0 * self.straight + f90 * self.grazing
    }

    fn mixed(self, other: Self, t: f32) -> Self {
        Self {
            straight: self.straight + t * (other.straight - self.straight),
            grazing: self.grazing + t * (other.grazing - self.grazing),
        }
    }
}

struct Mirrors {
    /// Column by column.
    albedo: Vec<Split>,
    /// By column.
    mean: Vec<Split>,
}

static MIRRORS: LazyLock<Mirrors> = LazyLock::new(|| {
    let albedo: Vec<Split> =
        grid().map(|(cos, roughness)| integrated_mirror(cos, roughness * roughness)).collect();
    let mean = albedo.chunks(COSINES).map(mean).collect();
    Mirrors { albedo, mean }
});

/// The table of the sheen is separate, because it takes longest and few scenes need it.
static SHEENS: LazyLock<Vec<f32>> =
    LazyLock::new(|| grid().map(|(cos, roughness)| sheen::integrated(cos, roughness)).collect());

/// Cosines and roughnesses of the tables, column by column of one roughness.
fn grid() -> impl Iterator<Item = (f32, f32)> {
    (0..ROUGHNESSES).flat_map(|r| (0..COSINES).map(move |c| (cosine(c), fraction(r, ROUGHNESSES))))
}

fn fraction(index: usize, count: usize) -> f32 {
    index as f32 / (count - 1) as f32
}

/// The cosine of a row; the first is not 0, where nothing is visible.
fn cosine(row: usize) -> f32 {
    let x = fraction(row, COSINES);
    (x * x).max(1e-4)
}

/// The position of a value in 0 … 1 among `count` columns: the column before, and the fraction toward the next.
#[inline]
fn place(value: f32, count: usize) -> (usize, f32) {
    let x = value.clamp(0.0, 1.0) * (count - 1) as f32;
    let before = (x as usize).min(count - 2);
    (before, x - before as f32)
}

/// The directional albedo of a rough reflector with α, for an outgoing direction of the given cosine.
#[inline]
pub(super) fn mirror(cos: f32, alpha: f32) -> Split {
    if alpha == 0.0 {
        let grazing = schlick(cos);
        return Split { straight: 1.0 - grazing, grazing };
    }
    let (row, down) = place(cos.sqrt(), COSINES);
    let (column, right) = place(alpha.sqrt(), ROUGHNESSES);
    let table = &MIRRORS.albedo[column * COSINES + row..];
    let (left, next) = (table[0].mixed(table[1], down), table[COSINES].mixed(table[COSINES + 1], down));
    left.mixed(next, right)
}

/// The cosine-weighted mean of [`mirror`] over all directions.
#[inline]
pub(super) fn mirror_mean(alpha: f32) -> Split {
    let (column, right) = place(alpha.sqrt(), ROUGHNESSES);
    let table = &MIRRORS.mean;
    table[column].mixed(table[column + 1], right)
}

/// The directional albedo of white sheen, for an outgoing direction of the given cosine.
#[inline]
pub(super) fn sheen(cos: f32, roughness: f32) -> f32 {
    let (row, down) = place(cos.sqrt(), COSINES);
    let (column, right) = place(roughness, ROUGHNESSES);
    let table = &SHEENS[column * COSINES + row..];
    let mix = |a: f32, b: f32, t: f32| a + t * (b - a);
    mix(mix(table[0], table[1], down), mix(table[COSINES], table[COSINES + 1], down), right)
}

/// Integrates over visible normals: each is weighted by the shadowing of the reflected direction.
fn integrated_mirror(cos: f32, alpha: f32) -> Split {
    let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
    if alpha == 0.0 {
        return mirror(cos, 0.0);
    }
    let roughness = TrowbridgeReitz { alpha_x: alpha, alpha_y: alpha };
    let g1 = roughness.g1(wo.into());
    let mut sum = Split::default();
    let w = Vec3::new(alpha * wo.x, 0.0, wo.z).normalize();
    for radius in 0..STEPS[1] {
        // Denser toward the horizon, where the distribution has its long tail.
        let x = 1.0 - (radius as f32 + 0.5) / STEPS[1] as f32;
        let (depth, weight) = ((1.0 - x * x * x) * (1.0 + w.z), 3.0 * x * x);
        let sin = (depth * (2.0 - depth)).max(0.0).sqrt();
        for turn in 0..STEPS[0] {
            // A visible normal, as in TrowbridgeReitz::sample.
            let (s, c) = libm::sincosf(PI * (turn as f32 + 0.5) / STEPS[0] as f32);
            let h = Vec3::new(sin * c, sin * s, 1.0 - depth) + w;
            let wm = Vec3::new(alpha * h.x, alpha * h.y, h.z.max(1e-6)).normalize();
            let wi = math::reflect(wo, wm);
            if wi.z > 0.0 {
                let seen = weight * roughness.g(wo.into(), wi.into()) / g1;
                let s = schlick(wo.dot(wm));
                sum.straight += (1.0 - s) * seen;
                sum.grazing += s * seen;
            }
        }
    }
    let count = (STEPS[0] * STEPS[1]) as f32;
    Split { straight: sum.straight / count, grazing: sum.grazing / count }
}

/// `2 ∫ E(μ) μ dμ` of the table's rows with their interpolation.
fn mean(rows: &[Split]) -> Split {
    const STEPS: usize = 8;
    let mut sum = Split::default();
    for row in 0..COSINES - 1 {
        for step in 0..STEPS {
            let t = (step as f32 + 0.5) / STEPS as f32;
            let x = (row as f32 + t) / (COSINES - 1) as f32;
            // μ = x², so 2 μ dμ = 4 x³ dx.
            let weight = 4.0 * x * x * x / (STEPS * (COSINES - 1)) as f32;
            let here = rows[row].mixed(rows[row + 1], t);
            sum.straight += weight * here.straight;
            sum.grazing += weight * here.grazing;
        }
    }
    sum
}
