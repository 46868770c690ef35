//! Eight paths side by side: arrays by lane, and their gathering into vectors.

pub(crate) mod width;

use lookfrom_bvh::Ray;
use lookfrom_simd::{Kernel, LaneMask, Simd, dispatch_wide, f32x4, f32x8, f64x8, is_wide, level, prelude::*};

use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use width::{Double, Lanes, WideLanes, Width};

/// Number of paths in a vector.
pub(crate) const LANES: usize = 8;

/// An array of the values of an expression for each lane. (Closures of `from_fn` and `map` are not compiled for the
/// level.)
macro_rules! by_lane {
    ($lane:ident => $value:expr) => {{
        let mut $lane = 0;
        let first = $value;
        let mut all = [first; $crate::core::lanes::LANES];
        $lane = 1;
        while $lane < $crate::core::lanes::LANES {
            all[$lane] = $value;
            $lane += 1;
        }
        all
    }};
}

pub(crate) use by_lane;

/// The lanes of a mask of which something is true, as a mask.
#[inline(always)]
pub(crate) fn lanes_where(mask: u32, is: impl Fn(usize) -> bool) -> u32 {
    LaneMask(mask).fold(0, |lanes, lane| lanes | u32::from(is(lane)) << lane)
}

/// The first eight items; where there are fewer, the last fills the other lanes of `memory`.
#[inline(always)]
pub(crate) fn filled<'a, T: Copy>(items: &'a [T], memory: &'a mut Option<[T; LANES]>) -> &'a [T; LANES] {
    match items.first_chunk::<LANES>() {
        Some(eight) => eight,
        None => memory.insert(by_lane!(lane => items[lane.min(items.len() - 1)])),
    }
}

/// Whether paths are shaded side by side on this machine: kernels that shade are not compiled for the least level of x86-64.
#[inline]
pub(crate) fn are_shaded_together() -> bool {
    is_wide(level())
}

/// Runs a kernel that shades, where [`are_shaded_together`].
#[inline(always)]
pub(crate) fn shade_together<K: Kernel>(kernel: K) -> K::Output {
    dispatch_wide(level(), kernel).expect("paths are shaded one by one at this level")
}

/// The components of something in eight lanes: for each component the numbers of the lanes.
pub(crate) type Columns<const N: usize, T = f32> = [[T; LANES]; N];

/// The components in one lane.
#[inline(always)]
pub(crate) fn row<const N: usize, T: Copy>(columns: &Columns<N, T>, lane: usize) -> [T; N] {
    std::array::from_fn(|component| columns[component][lane % LANES])
}

/// Replaces the components in one lane.
#[inline(always)]
pub(crate) fn set_row<const N: usize, T: Copy>(columns: &mut Columns<N, T>, lane: usize, row: [T; N]) {
    for (column, component) in columns.iter_mut().zip(row) {
        column[lane % LANES] = component;
    }
}

/// Vectors from their columns.
#[inline(always)]
pub(crate) fn load<W: Width>(width: W, [x, y, z]: &Columns<3>) -> Vector<W::Real> {
    Vector { x: width.load_f32(x), y: width.load_f32(y), z: width.load_f32(z) }
}

/// Vectors of double precision from their columns.
#[inline(always)]
pub(crate) fn load_f64<W: Width>(width: W, [x, y, z]: &Columns<3, f64>) -> Vector<Double<W>> {
    Vector { x: width.load_f64(x), y: width.load_f64(y), z: width.load_f64(z) }
}

/// Spectra from their columns.
#[inline(always)]
pub(crate) fn load_spectrum<W: Width>(width: W, [a, b, c, d]: &Columns<4>) -> Spectrum<W::Real> {
    Spectrum([width.load_f32(a), width.load_f32(b), width.load_f32(c), width.load_f32(d)])
}

/// One spectrum in each lane.
#[inline(always)]
pub(crate) fn splat_spectrum<W: Width>(width: W, Spectrum([a, b, c, d]): Spectrum) -> Spectrum<W::Real> {
    Spectrum([width.splat(a), width.splat(b), width.splat(c), width.splat(d)])
}

/// The columns of vectors.
#[inline(always)]
pub(crate) fn store<R: Lanes>(v: Vector<R>) -> Columns<3> {
    [v.x.column(), v.y.column(), v.z.column()]
}

/// The columns of vectors of double precision.
#[inline(always)]
pub(crate) fn store_f64<F: WideLanes>(v: Vector<F>) -> Columns<3, f64> {
    [v.x.column(), v.y.column(), v.z.column()]
}

/// The columns of spectra.
#[inline(always)]
pub(crate) fn store_spectrum<R: Lanes>(s: Spectrum<R>) -> Columns<4> {
    [s.0[0].column(), s.0[1].column(), s.0[2].column(), s.0[3].column()]
}

/// The answers of the lanes: that of lane i in bit i.
#[inline(always)]
pub(crate) fn bitmask(lanes: &[bool; LANES]) -> u32 {
    let (mut bits, mut lane) = (0, 0);
    while lane < LANES {
        bits |= u32::from(lanes[lane]) << lane;
        lane += 1;
    }
    bits
}

/// The columns of rows of four numbers.
#[inline(always)]
fn transposed<S: Simd>(simd: S, rows: [f32x4<S>; LANES]) -> [f32x8<S>; 4] {
    let [a, b, c, d, e, f, g, h] = rows;
    let [low, high] = [transposed_half(simd, [a, b, c, d]), transposed_half(simd, [e, f, g, h])];
    [
        simd.combine_f32x4(low[0], high[0]),
        simd.combine_f32x4(low[1], high[1]),
        simd.combine_f32x4(low[2], high[2]),
        simd.combine_f32x4(low[3], high[3]),
    ]
}

#[inline(always)]
fn transposed_half<S: Simd>(simd: S, [a, b, c, d]: [f32x4<S>; 4]) -> [f32x4<S>; 4] {
    let [ac, bd] = [simd.zip_low_f32x4(a, c), simd.zip_low_f32x4(b, d)];
    let [more_ac, more_bd] = [simd.zip_high_f32x4(a, c), simd.zip_high_f32x4(b, d)];
    [
        simd.zip_low_f32x4(ac, bd),
        simd.zip_high_f32x4(ac, bd),
        simd.zip_low_f32x4(more_ac, more_bd),
        simd.zip_high_f32x4(more_ac, more_bd),
    ]
}

/// A vector in each lane.
#[inline(always)]
pub(crate) fn gather<S: Simd>(simd: S, rows: &[[f32; 3]; LANES]) -> Vector<f32x8<S>> {
    // The number after a row, the first of the next, goes to the fourth column, which is not used.
    let all = rows.as_flattened();
    let last = rows[LANES - 1];
    let [x, y, z, _] = transposed(
        simd,
        [
            f32x4::from_slice(simd, &all[0..4]),
            f32x4::from_slice(simd, &all[3..7]),
            f32x4::from_slice(simd, &all[6..10]),
            f32x4::from_slice(simd, &all[9..13]),
            f32x4::from_slice(simd, &all[12..16]),
            f32x4::from_slice(simd, &all[15..19]),
            f32x4::from_slice(simd, &all[18..22]),
            f32x4::load_array(simd, [last[0], last[1], last[2], 0.0]),
        ],
    );
    Vector { x, y, z }
}

/// Vectors from their rows; the fourth numbers are not used.
#[inline(always)]
pub(crate) fn from_rows<S: Simd>(simd: S, rows: [f32x4<S>; LANES]) -> Vector<f32x8<S>> {
    let [x, y, z, _] = transposed(simd, rows);
    Vector { x, y, z }
}

/// A vector of a list as a row, with any fourth number.
#[inline(always)]
pub(crate) fn row_at<S: Simd>(simd: S, list: &[[f32; 3]], index: u32) -> f32x4<S> {
    let index = index as usize;
    // With the first component of the next vector, if there is one, it is one load: stores of single numbers would be
    // waited for.
    if let Some(four) = list.as_flattened().get(3 * index..3 * index + 4) {
        return f32x4::from_slice(simd, four);
    }
    let [x, y, z] = list[index];
    f32x4::load_array(simd, [x, y, z, 0.0])
}

/// A vector of double precision in each lane.
#[inline(always)]
pub(crate) fn gather_f64<S: Simd>(simd: S, rows: &[[f64; 3]; LANES]) -> Vector<f64x8<S>> {
    Vector {
        x: f64x8::load_array(simd, by_lane!(lane => rows[lane][0])),
        y: f64x8::load_array(simd, by_lane!(lane => rows[lane][1])),
        z: f64x8::load_array(simd, by_lane!(lane => rows[lane][2])),
    }
}

/// Four numbers in each lane.
#[inline(always)]
pub(crate) fn gather_four<S: Simd>(simd: S, rows: &[[f32; 4]; LANES]) -> [f32x8<S>; 4] {
    transposed(
        simd,
        [
            f32x4::load_array(simd, rows[0]),
            f32x4::load_array(simd, rows[1]),
            f32x4::load_array(simd, rows[2]),
            f32x4::load_array(simd, rows[3]),
            f32x4::load_array(simd, rows[4]),
            f32x4::load_array(simd, rows[5]),
            f32x4::load_array(simd, rows[6]),
            f32x4::load_array(simd, rows[7]),
        ],
    )
}

/// A spectrum in each lane.
#[inline(always)]
pub(crate) fn gather_spectrum<S: Simd>(simd: S, rows: &[Spectrum; LANES]) -> Spectrum<f32x8<S>> {
    Spectrum(gather_four(simd, &by_lane!(lane => rows[lane].0)))
}

/// The vectors of the lanes.
#[inline(always)]
pub(crate) fn scatter<S: Simd>(v: Vector<f32x8<S>>) -> [[f32; 3]; LANES] {
    let [x, y, z]: [[f32; LANES]; 3] = [v.x.into(), v.y.into(), v.z.into()];
    by_lane!(lane => [x[lane], y[lane], z[lane]])
}

/// The vectors of double precision of the lanes.
#[inline(always)]
pub(crate) fn scatter_f64<S: Simd>(v: Vector<f64x8<S>>) -> [[f64; 3]; LANES] {
    let [x, y, z]: [[f64; LANES]; 3] = [v.x.into(), v.y.into(), v.z.into()];
    by_lane!(lane => [x[lane], y[lane], z[lane]])
}

/// The spectra of the lanes.
#[inline(always)]
pub(crate) fn scatter_spectrum<S: Simd>(s: Spectrum<f32x8<S>>) -> [Spectrum; LANES] {
    let [a, b, c, d] = s.0;
    let [ac, bd] = [a.zip_low(c), b.zip_low(d)];
    let [more_ac, more_bd] = [a.zip_high(c), b.zip_high(d)];
    let [first, second] = two_rows(ac.zip_low(bd));
    let [third, fourth] = two_rows(ac.zip_high(bd));
    let [fifth, sixth] = two_rows(more_ac.zip_low(more_bd));
    let [seventh, eighth] = two_rows(more_ac.zip_high(more_bd));
    [first, second, third, fourth, fifth, sixth, seventh, eighth]
}

/// Two spectra of which one follows the other.
#[inline(always)]
fn two_rows<S: Simd>(rows: f32x8<S>) -> [Spectrum; 2] {
    let (low, high) = rows.simd.split_f32x8(rows);
    [Spectrum(low.into()), Spectrum(high.into())]
}

/// Rays by lane, which start at t = 0.
#[inline(always)]
pub(crate) fn scatter_rays<S: Simd>(
    simd: S,
    origin: Vector<f32x8<S>>,
    direction: Vector<f32x8<S>>,
    t_max: f32x8<S>,
) -> [Ray; LANES] {
    let zero = f32x8::splat(simd, 0.0);
    let rows = lookfrom_simd::transposed([
        origin.x,
        origin.y,
        origin.z,
        zero,
        direction.x,
        direction.y,
        direction.z,
        t_max,
    ]);
    by_lane!(lane => {
        let [ox, oy, oz, t_min, dx, dy, dz, t_max]: [f32; LANES] = rows[lane].into();
        Ray { origin: [ox, oy, oz], t_min, direction: [dx, dy, dz], t_max }
    })
}

/// The origins and the directions of rays.
#[inline(always)]
pub(crate) fn gather_rays<S: Simd>(simd: S, rays: &[&Ray; LANES]) -> [Vector<f32x8<S>>; 2] {
    let rows = by_lane!(lane => {
        let Ray { origin: [ox, oy, oz], t_min, direction: [dx, dy, dz], t_max } = *rays[lane];
        f32x8::load_array(simd, [ox, oy, oz, t_min, dx, dy, dz, t_max])
    });
    let [ox, oy, oz, _, dx, dy, dz, _] = lookfrom_simd::transposed(rows);
    [Vector { x: ox, y: oy, z: oz }, Vector { x: dx, y: dy, z: dz }]
}

#[cfg(test)]
mod tests {
    use lookfrom_simd::{Kernel, Level, dispatch};

    use super::*;

    /// Rays and spectra in lanes and back.
    struct ThereAndBack<'a>(&'a [Ray; LANES], &'a [Spectrum; LANES]);

    impl Kernel for ThereAndBack<'_> {
        type Output = ([Ray; LANES], [Spectrum; LANES]);
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let [origin, direction] = gather_rays(simd, &by_lane!(lane => &self.0[lane]));
            let spectra = gather_spectrum(simd, self.1);
            (scatter_rays(simd, origin, direction, f32x8::splat(simd, 7.0)), scatter_spectrum(spectra))
        }
    }

    #[test]
    fn rows_become_columns_and_rows_again() {
        let number = |lane: usize, k: usize| (10 * lane + k) as f32;
        let three = |lane: usize, first: usize| [0, 1, 2].map(|k| number(lane, first + k));
        let rays = std::array::from_fn(|lane| Ray::new(three(lane, 0), three(lane, 3)).with_t_max(7.0));
        let spectra = std::array::from_fn(|lane| Spectrum([0, 1, 2, 3].map(|k| number(lane, k))));
        let mut levels = vec![Level::baseline(), Level::new()];
        #[cfg(target_arch = "x86_64")]
        levels.extend(Level::new().as_avx2().map(Level::Avx2));
        for level in levels {
            assert_eq!(dispatch(level, ThereAndBack(&rays, &spectra)), (rays, spectra));
        }
    }
}
