//! Directional albedos of anisotropic reflectors, by a table of four dimensions: the roughness along both axes, the angle
//! between the direction and the first axis, and its cosine to the normal. A pair of roughnesses is integrated when a surface first
//! needs it (about a millisecond).

use std::f32::consts::{FRAC_PI_2, PI};
use std::sync::OnceLock;

use glam::Vec3;
use lookfrom_simd::{Float, Real};

use super::{Split, integrated, place};
use crate::core::math::both;
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

/// The albedos of reflectors of two roughnesses, by angle and cosine.
struct Reflectors {
    albedo: [Split; TURNS * COSINES],
    mean: Split,
}

/// By roughness along x and y; each is integrated on first use, since most scenes have few.
static REFLECTORS: [OnceLock<Reflectors>; ROUGHNESSES * ROUGHNESSES] =
    [const { OnceLock::new() }; ROUGHNESSES * ROUGHNESSES];

impl Reflectors {
    /// The albedos of a pair of roughnesses: x times [`ROUGHNESSES`] and y.
    #[inline(always)]
    fn of(pair: usize) -> &'static Self {
        REFLECTORS[pair].get_or_init(|| Self::integrated([pair / ROUGHNESSES, pair % ROUGHNESSES]))
    }

    #[cold]
    fn integrated([x, y]: [usize; 2]) -> Self {
        // Turned by a right angle it is the same surface.
        let is_turned = y > x;
        let columns = if is_turned { [y, x] } else { [x, y] };
        let albedo = std::array::from_fn(|at| {
            let turn = at / COSINES;
            entry(columns, if is_turned { TURNS - 1 - turn } else { turn }, at % COSINES)
        });
        Self { mean: mean(&albedo), albedo }
    }
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
        || interpolated(wo, roughness),
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
            let at = (x * ROUGHNESSES as f32 + y).to_integer();
            let [here, next] = both(
                [0, ROUGHNESSES],
                #[inline(always)]
                |row| mean_at(at, row).mixed(mean_at(at, row + 1), down),
            );
            here.mixed(next, right)
        },
    )
}

/// The means of the pairs that are a distance from others.
#[inline(always)]
fn mean_at<R: Real>(pairs: R::Bits, distance: usize) -> Split<R> {
    Split::lookup(
        pairs,
        #[inline(always)]
        move |at| Reflectors::of(at + distance).mean,
    )
}

#[inline(always)]
fn interpolated<R: Real>(wo: Vector<R>, roughness: TrowbridgeReitz<R>) -> Split<R> {
    let (x, x_part) = place(Float::sqrt(roughness.alpha_x), ROUGHNESSES);
    let (y, y_part) = place(Float::sqrt(roughness.alpha_y), ROUGHNESSES);
    let [(turn, turn_part), (row, row_part)] = directions(wo);
    let at = x * STRIDES[0] as f32 + y * STRIDES[1] as f32 + turn * STRIDES[2] as f32 + row;
    let parts = [x_part, y_part, turn_part, row_part];
    sum_of_corners(
        at.to_integer(),
        parts,
        STRIDES,
        #[inline(always)]
        |at| Reflectors::of(at / STRIDES[1]).albedo[at % STRIDES[1]],
    )
}

/// The place of a direction among the turns and the cosines of the table.
#[inline(always)]
fn directions<R: Real>(wo: Vector<R>) -> [(R, R); 2] {
    let (zero, one) = (wo.z.like(0.0), wo.z.like(1.0));
    let along = Float::abs(wo.x) + Float::abs(wo.y);
    let turn = R::select(along.gt(zero), Float::abs(wo.x) / along, zero);
    [place(turn, TURNS), place(Float::sqrt(Float::min(wo.z, one)), COSINES)]
}

/// Linear interpolation along some axes of a table.
#[inline(always)]
fn sum_of_corners<R: Real, const AXES: usize>(
    at: R::Bits,
    parts: [R; AXES],
    strides: [usize; AXES],
    entry: impl Fn(usize) -> Split,
) -> Split<R> {
    let (zero, one) = (parts[0].like(0.0), parts[0].like(1.0));
    let mut sum = Split { straight: zero, grazing: zero };
    let mut corner = 0;
    while corner < 1 << AXES {
        let (mut weight, mut distance, mut axis) = (one, 0, 0);
        while axis < AXES {
            let is_next = corner >> axis & 1 == 1;
            weight = weight * if is_next { parts[axis] } else { one - parts[axis] };
            distance += if is_next { strides[axis] } else { 0 };
            axis += 1;
        }
        let Split { straight, grazing }: Split<R> = Split::lookup(
            at,
            #[inline(always)]
            |at| entry(at + distance),
        );
        sum.straight = sum.straight + straight * weight;
        sum.grazing = sum.grazing + grazing * weight;
        corner += 1;
    }
    sum
}

/// `(2/π) ∫∫ E(μ, φ) μ dμ dφ` over a quarter of the circle, of the entries of one pair of roughnesses with their
/// interpolation.
fn mean(albedo: &[Split; TURNS * COSINES]) -> Split {
    const STEPS: usize = 32;
    const ANGLES: usize = 8;
    let mut sum = Split::<f32>::default();
    for angle in 0..ANGLES {
        let (s, c) = libm::sincosf(FRAC_PI_2 * (angle as f32 + 0.5) / ANGLES as f32);
        for step in 0..STEPS {
            let x = (step as f32 + 0.5) / STEPS as f32;
            let cos = x * x;
            let sin = (1.0 - cos * cos).sqrt();
            let [(turn, turn_part), (row, row_part)] = directions(Vector { x: sin * c, y: sin * s, z: cos });
            let at = (turn * COSINES as f32 + row) as u32;
            let here: Split<f32> = sum_of_corners(at, [turn_part, row_part], [COSINES, 1], |at| albedo[at]);
            // μ = x², so 2 μ dμ = 4 x³ dx.
            let weight = 4.0 * x * x * x / (STEPS * ANGLES) as f32;
            sum.straight += weight * here.straight;
            sum.grazing += weight * here.grazing;
        }
    }
    sum
}
