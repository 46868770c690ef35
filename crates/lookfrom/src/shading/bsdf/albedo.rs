//! Directional albedos of microfacets and sheen, by tables.
//!
//! Needed to divide energy between layers. There is no closed form, so small tables are integrated on first use (a
//! few milliseconds, once per process) and read with linear interpolation.
//!
//! The Fresnel term of a reflector is `F0 + (F90 − F0) s`, where s is 0 at normal and 1 at grazing incidence. So
//! two numbers, the means of 1 − s and of s over the visible normals, give its albedo for every F0 and F90 (the
//! split sum of Karis 2013). With F = 1 their sum is the albedo of single scattering; the rest is multiple
//! scattering (Kulla & Conty 2017).

mod anisotropic;

use std::f32::consts::PI;
use std::sync::{LazyLock, OnceLock};

use glam::Vec3;
use lookfrom_simd::{Float, Mask, Real};

use super::microfacet::TrowbridgeReitz;
use super::principled::sheen;
use crate::core::math::{self, schlick};
use crate::core::vector::Vector;

/// Number of rows, by the square root of the cosine.
const COSINES: usize = 32;
/// Number of columns, by the square root of α: glTF's roughness.
const ROUGHNESSES: usize = 24;
/// Number of microfacet normals per table entry: angles over half a circle (the other half is symmetric), and
/// radii.
const STEPS: [usize; 2] = [8, 24];

/// The directional albedo of a rough reflector, as a split sum.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Split<R = f32> {
    /// The mean of 1 − s.
    pub(super) straight: R,
    /// The mean of s.
    pub(super) grazing: R,
}

impl<R: Real> Split<R> {
    /// The albedo for a Fresnel term of 1.
    #[inline(always)]
    pub(super) fn all(self) -> R {
        self.straight + self.grazing
    }

    /// The albedo for a given F0 and F90.
    #[inline(always)]
    pub(super) fn of(self, f0: R, f90: R) -> R {
        f0 * self.straight + f90 * self.grazing
    }

    /// `yes` where the mask is set, `no` elsewhere.
    #[inline(always)]
    pub(super) fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        Self {
            straight: R::select(mask, yes.straight, no.straight),
            grazing: R::select(mask, yes.grazing, no.grazing),
        }
    }

    #[inline(always)]
    fn mixed(self, other: Self, t: R) -> Self {
        Self { straight: mix(self.straight, other.straight, t), grazing: mix(self.grazing, other.grazing, t) }
    }

    /// The entries of a table at indices.
    #[inline(always)]
    fn lookup(index: R::Bits, entry: impl Fn(usize) -> Split) -> Self {
        Self {
            straight: R::lookup(
                index,
                #[inline(always)]
                |index| entry(index).straight,
            ),
            grazing: R::lookup(
                index,
                #[inline(always)]
                |index| entry(index).grazing,
            ),
        }
    }
}

#[inline(always)]
fn mix<R: Real>(a: R, b: R, t: R) -> R {
    a + t * (b - a)
}

/// The albedos of reflectors of one roughness, by cosine.
struct Mirrors {
    albedo: [Split; COSINES],
    mean: Split,
}

/// By roughness; each is integrated on first use, since most scenes have few.
static MIRRORS: [OnceLock<Mirrors>; ROUGHNESSES] = [const { OnceLock::new() }; ROUGHNESSES];

impl Mirrors {
    /// The albedos of a column of the table.
    #[inline(always)]
    fn of(column: usize) -> &'static Self {
        MIRRORS[column].get_or_init(|| Self::integrated(column))
    }

    #[cold]
    fn integrated(column: usize) -> Self {
        let roughness = fraction(column, ROUGHNESSES);
        let albedo = std::array::from_fn(|row| integrated_mirror(cosine(row), roughness * roughness));
        Self { mean: mean(&albedo), albedo }
    }
}

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
#[inline(always)]
fn place<R: Real>(value: R, count: usize) -> (R, R) {
    let x = Float::clamp(value, 0.0, 1.0) * (count - 1) as f32;
    let before = Float::min(Float::floor(x), x.like((count - 2) as f32));
    (before, x - before)
}

/// The index of an entry of a table, from its row and its column.
#[inline(always)]
fn index<R: Real>(row: R, column: R) -> R::Bits {
    (column * COSINES as f32 + row).to_integer()
}

/// The energy of multiple scattering between facets, by the mean Fresnel reflectance and the mean albedo of one
/// bounce.
#[inline(always)]
pub(super) fn multiple<R: Real>(fresnel: R, mean: R) -> R {
    let one = fresnel.like(1.0);
    fresnel * fresnel * mean / (one - fresnel * (one - mean))
}

/// α of an isotropic reflector that stands for a roughness, √(α_x α_y) ≤ 1; 0 where it is smooth.
#[inline(always)]
pub(super) fn even_alpha<R: Real>(roughness: TrowbridgeReitz<R>) -> R {
    let (zero, one) = (roughness.alpha_x.like(0.0), roughness.alpha_x.like(1.0));
    let alpha = Float::min(Float::sqrt(roughness.alpha_x * roughness.alpha_y), one);
    R::select(roughness.is_smooth(), zero, alpha)
}

/// True for rough surfaces with two roughnesses, by their [`even_alpha`].
#[inline(always)]
fn has_grain<R: Real>(roughness: &TrowbridgeReitz<R>, alpha: R) -> R::Mask {
    alpha.gt(alpha.like(0.0)) & !Float::eq(roughness.alpha_x, roughness.alpha_y)
}

/// The directional albedo of a reflector for an outgoing direction `up` of unit length above the surface, by its roughness and
/// its [`even_alpha`].
#[inline(always)]
pub(super) fn reflector<R: Real>(up: Vector<R>, roughness: TrowbridgeReitz<R>, alpha: R) -> Split<R> {
    let isotropic = mirror(Float::min(up.z, up.z.like(1.0)), alpha);
    let has_grain = has_grain(&roughness, alpha);
    if !has_grain.any() {
        return isotropic;
    }
    Split::select(has_grain, anisotropic::mirror(up, roughness), isotropic)
}

/// The cosine-weighted mean of [`reflector`] over all directions.
#[inline(always)]
pub(super) fn reflector_mean<R: Real>(roughness: TrowbridgeReitz<R>, alpha: R) -> Split<R> {
    let isotropic = mirror_mean(alpha);
    let has_grain = has_grain(&roughness, alpha);
    if !has_grain.any() {
        return isotropic;
    }
    Split::select(has_grain, anisotropic::mirror_mean(roughness), isotropic)
}

/// The directional albedo of a rough reflector with α, for an outgoing direction of the given cosine.
///
/// Not inlined, as the next two, since it is needed in many places.
#[inline(never)]
pub(super) fn mirror<R: Real>(cos: R, alpha: R) -> Split<R> {
    cos.at_level(
        #[inline(always)]
        || {
            let grazing = schlick(cos);
            let smooth = Split { straight: cos.like(1.0) - grazing, grazing };
            let is_smooth = Float::eq(alpha, alpha.like(0.0));
            if is_smooth.all() {
                return smooth;
            }
            let (row, down) = place(Float::sqrt(cos), COSINES);
            let (column, right) = place(Float::sqrt(alpha), ROUGHNESSES);
            let at = index(row, column);
            let entry = |distance: usize| {
                Split::lookup(
                    at,
                    #[inline(always)]
                    move |at| Mirrors::of((at + distance) / COSINES).albedo[(at + distance) % COSINES],
                )
            };
            let left = entry(0).mixed(entry(1), down);
            let next = entry(COSINES).mixed(entry(COSINES + 1), down);
            Split::select(is_smooth, smooth, left.mixed(next, right))
        },
    )
}

/// The cosine-weighted mean of [`mirror`] over all directions.
#[inline(never)]
pub(super) fn mirror_mean<R: Real>(alpha: R) -> Split<R> {
    alpha.at_level(
        #[inline(always)]
        || {
            let smooth = Split { straight: alpha.like(20.0 / 21.0), grazing: alpha.like(1.0 / 21.0) };
            let is_smooth = Float::eq(alpha, alpha.like(0.0));
            if is_smooth.all() {
                return smooth;
            }
            let (column, right) = place(Float::sqrt(alpha), ROUGHNESSES);
            let at = column.to_integer();
            let mean = |distance: usize| {
                Split::lookup(
                    at,
                    #[inline(always)]
                    move |at| Mirrors::of(at + distance).mean,
                )
            };
            let rough = mean(0).mixed(mean(1), right);
            Split::select(is_smooth, smooth, rough)
        },
    )
}

/// The directional albedo of white sheen, for an outgoing direction of the given cosine.
#[inline(never)]
pub(super) fn sheen<R: Real>(cos: R, roughness: R) -> R {
    cos.at_level(
        #[inline(always)]
        || {
            let (row, down) = place(Float::sqrt(cos), COSINES);
            let (column, right) = place(roughness, ROUGHNESSES);
            let at = index(row, column);
            let left = mix(sheen_at(at, 0), sheen_at(at, 1), down);
            mix(left, mix(sheen_at(at, COSINES), sheen_at(at, COSINES + 1), down), right)
        },
    )
}

/// The entries of the sheen's table at some distance from each index.
#[inline(always)]
fn sheen_at<R: Real>(index: R::Bits, distance: usize) -> R {
    let table = &*SHEENS;
    R::lookup(
        index,
        #[inline(always)]
        |index| table[index + distance],
    )
}

/// The directional albedo of an isotropic reflector.
fn integrated_mirror(cos: f32, alpha: f32) -> Split {
    if alpha == 0.0 {
        return mirror(cos, 0.0);
    }
    let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
    // The other half of the circle is symmetric.
    integrated(wo, TrowbridgeReitz { alpha_x: alpha, alpha_y: alpha }, PI)
}

/// Integrates over visible normals up to an angle about the surface normal: each is weighted by the shadowing of the
/// reflected direction.
fn integrated(wo: Vec3, roughness: TrowbridgeReitz, angle: f32) -> Split {
    let TrowbridgeReitz { alpha_x, alpha_y } = roughness;
    let g1 = roughness.g1(wo.into());
    let mut sum = Split::<f32>::default();
    let w = Vec3::new(alpha_x * wo.x, alpha_y * wo.y, wo.z).normalize();
    for radius in 0..STEPS[1] {
        // Denser toward the horizon, where the distribution has its long tail.
        let x = 1.0 - (radius as f32 + 0.5) / STEPS[1] as f32;
        let (depth, weight) = ((1.0 - x * x * x) * (1.0 + w.z), 3.0 * x * x);
        let sin = (depth * (2.0 - depth)).max(0.0).sqrt();
        for turn in 0..STEPS[0] {
            // A visible normal, as in TrowbridgeReitz::sample.
            let (s, c) = libm::sincosf(angle * (turn as f32 + 0.5) / STEPS[0] as f32);
            let h = Vec3::new(sin * c, sin * s, 1.0 - depth) + w;
            let wm = Vec3::new(alpha_x * h.x, alpha_y * h.y, h.z.max(1e-6)).normalize();
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
    let mut sum = Split::<f32>::default();
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

#[cfg(test)]
mod tests;
