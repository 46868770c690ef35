//! Directional albedos of anisotropic reflectors, by a table of four dimensions: the roughness along both axes, the angle
//! between the direction and the first axis, and its cosine to the normal. It is integrated when the first anisotropic
//! surface is shaded (about a tenth of a second).

use std::f32::consts::{FRAC_PI_2, PI};
use std::sync::LazyLock;

use glam::Vec3;
use lookfrom_simd::{Float, Real};

use super::{Split, integrated, place};
use crate::core::vector::Vector;
use crate::shading::bsdf::microfacet::TrowbridgeReitz;

/// Number of entries by the square root of the cosine.
const COSINES: usize = 16;
/// Number of entries by the angle φ to the first axis, as |cos φ| / (|cos φ| + |sin φ|).
const TURNS: usize = 9;
/// Number of entries by the square root of α along each axis.
const ROUGHNESSES: usize = 16;

/// Distances of neighbours in the table.
const STRIDES: [usize; 4] = [TURNS * COSINES * ROUGHNESSES, TURNS * COSINES, COSINES, 1];

struct Reflectors {
    /// By α along x, α along y, angle and cosine.
    albedo: Vec<Split>,
    /// By α along x and y.
    mean: Vec<Split>,
}

static REFLECTORS: LazyLock<Reflectors> = LazyLock::new(|| {
    let mut albedo = vec![Split::<f32>::default(); STRIDES[0] * ROUGHNESSES];
    for x in 0..ROUGHNESSES {
        for y in 0..=x {
            for turn in 0..TURNS {
                for row in 0..COSINES {
                    let entry = entry([x, y], turn, row);
                    albedo[index([x, y], turn, row)] = entry;
                    // Turned by a right angle it is the same surface.
                    albedo[index([y, x], TURNS - 1 - turn, row)] = entry;
                }
            }
        }
    }
    let mean = (0..ROUGHNESSES * ROUGHNESSES)
        .map(|cell| mean(&albedo, [cell / ROUGHNESSES, cell % ROUGHNESSES].map(alpha)))
        .collect();
    Reflectors { albedo, mean }
});

fn index([x, y]: [usize; 2], turn: usize, row: usize) -> usize {
    x * STRIDES[0] + y * STRIDES[1] + turn * STRIDES[2] + row * STRIDES[3]
}

fn fraction(index: usize, count: usize) -> f32 {
    index as f32 / (count - 1) as f32
}

/// The α of a column; the first is not 0, where there are no facets.
fn alpha(column: usize) -> f32 {
    let roughness = fraction(column, ROUGHNESSES);
    (roughness * roughness).max(1e-4)
}

fn entry(columns: [usize; 2], turn: usize, row: usize) -> Split {
    let [alpha_x, alpha_y] = columns.map(alpha);
    let root = fraction(row, COSINES);
    let cos = (root * root).max(1e-4);
    let turn = fraction(turn, TURNS);
    let sin = (1.0 - cos * cos).max(0.0).sqrt() / (turn * turn + (1.0 - turn) * (1.0 - turn)).sqrt();
    let wo = Vec3::new(sin * turn, sin * (1.0 - turn), cos);
    integrated(wo, TrowbridgeReitz { alpha_x, alpha_y }, 2.0 * PI)
}

/// The directional albedo of a reflector for an outgoing direction of unit length above the surface.
///
/// Not inlined, as the next one, since it is needed in several places.
#[inline(never)]
pub(super) fn mirror<R: Real>(wo: Vector<R>, roughness: TrowbridgeReitz<R>) -> Split<R> {
    wo.z.at_level(
        #[inline(always)]
        || interpolated(&REFLECTORS.albedo, wo, roughness),
    )
}

/// The cosine-weighted mean of [`mirror`] over all directions.
#[inline(never)]
pub(super) fn mirror_mean<R: Real>(roughness: TrowbridgeReitz<R>) -> Split<R> {
    roughness.alpha_x.at_level(
        #[inline(always)]
        || {
            let (x, right) = place(Float::sqrt(roughness.alpha_x), ROUGHNESSES);
            let (y, down) = place(Float::sqrt(roughness.alpha_y), ROUGHNESSES);
            let (table, at) = (&REFLECTORS.mean, (x * ROUGHNESSES as f32 + y).to_integer());
            let here = Split::lookup(table, at, 0).mixed(Split::lookup(table, at, 1), down);
            let next =
                Split::lookup(table, at, ROUGHNESSES).mixed(Split::lookup(table, at, ROUGHNESSES + 1), down);
            here.mixed(next, right)
        },
    )
}

#[inline(always)]
fn interpolated<R: Real>(table: &[Split], wo: Vector<R>, roughness: TrowbridgeReitz<R>) -> Split<R> {
    let (zero, one) = (wo.z.like(0.0), wo.z.like(1.0));
    let along = Float::abs(wo.x) + Float::abs(wo.y);
    let turn = R::select(along.gt(zero), Float::abs(wo.x) / along, zero);
    let (x, x_part) = place(Float::sqrt(roughness.alpha_x), ROUGHNESSES);
    let (y, y_part) = place(Float::sqrt(roughness.alpha_y), ROUGHNESSES);
    let (turn, turn_part) = place(turn, TURNS);
    let (row, row_part) = place(Float::sqrt(Float::min(wo.z, one)), COSINES);
    let at = x * STRIDES[0] as f32 + y * STRIDES[1] as f32 + turn * STRIDES[2] as f32 + row;
    let at = at.to_integer();
    let mut sum = Split { straight: zero, grazing: zero };
    let mut corner = 0;
    while corner < 16 {
        let (mut weight, mut distance, mut axis) = (one, 0, 0);
        while axis < 4 {
            let part = [x_part, y_part, turn_part, row_part][axis];
            let is_next = corner >> axis & 1 == 1;
            weight = weight * if is_next { part } else { one - part };
            distance += if is_next { STRIDES[axis] } else { 0 };
            axis += 1;
        }
        let Split { straight, grazing }: Split<R> = Split::lookup(table, at, distance);
        sum.straight = sum.straight + straight * weight;
        sum.grazing = sum.grazing + grazing * weight;
        corner += 1;
    }
    sum
}

/// `(2/π) ∫∫ E(μ, φ) μ dμ dφ` over a quarter of the circle, of the table's rows with their interpolation.
fn mean(table: &[Split], [alpha_x, alpha_y]: [f32; 2]) -> Split {
    const STEPS: usize = 32;
    const ANGLES: usize = 8;
    let mut sum = Split::<f32>::default();
    for angle in 0..ANGLES {
        let (s, c) = libm::sincosf(FRAC_PI_2 * (angle as f32 + 0.5) / ANGLES as f32);
        for step in 0..STEPS {
            let x = (step as f32 + 0.5) / STEPS as f32;
            let cos = x * x;
            let sin = (1.0 - cos * cos).sqrt();
            let wo = Vector { x: sin * c, y: sin * s, z: cos };
            let here = interpolated(table, wo, TrowbridgeReitz { alpha_x, alpha_y });
            // μ = x², so 2 μ dμ = 4 x³ dx.
            let weight = 4.0 * x * x * x / (STEPS * ANGLES) as f32;
            sum.straight += weight * here.straight;
            sum.grazing += weight * here.grazing;
        }
    }
    sum
}
