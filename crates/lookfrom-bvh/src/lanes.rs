//! Operations across the eight lanes of vectors.

use lookfrom_simd::{Simd, f32x8, f32x16, prelude::*};

/// Number of lanes.
pub(crate) const LANES: usize = 8;

/// Two vectors in eight lanes each, side by side.
#[inline(always)]
pub(crate) fn combined<S: Simd>(simd: S, a: [f32x8<S>; 3], b: [f32x8<S>; 3]) -> [f32x16<S>; 3] {
    [simd.combine_f32x8(a[0], b[0]), simd.combine_f32x8(a[1], b[1]), simd.combine_f32x8(a[2], b[2])]
}

/// A vector in all lanes.
#[inline(always)]
pub(crate) fn splat_all<S: Simd>(simd: S, [x, y, z]: [f32; 3]) -> [f32x8<S>; 3] {
    [f32x8::splat(simd, x), f32x8::splat(simd, y), f32x8::splat(simd, z)]
}

/// The largest magnitude, lane by lane.
#[inline(always)]
pub(crate) fn greatest<S: Simd>([x, y, z]: [f32x8<S>; 3]) -> f32x8<S> {
    x.abs().max(y.abs()).max(z.abs())
}

/// The minimum of the lanes.
#[inline(always)]
pub(crate) fn least<S: Simd>(numbers: f32x8<S>) -> f32 {
    let numbers: [f32; LANES] = numbers.into();
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| smaller(numbers[i], numbers[i + 4]));
    smaller(smaller(a, b), smaller(c, d))
}

/// The minimum of each of eight vectors.
#[inline(always)]
pub(crate) fn least_of_each<S: Simd>([a, b, c, d, e, f, g, h]: [f32x8<S>; LANES]) -> f32x8<S> {
    let [[a, b], [c, d]] = [[halve(a, e), halve(c, g)], [halve(b, f), halve(d, h)]];
    halve(halve(a, b), halve(c, d))
}

/// The lesser ones of each vector's halves; the lanes of the two vectors alternate.
#[inline(always)]
fn halve<S: Simd>(a: f32x8<S>, b: f32x8<S>) -> f32x8<S> {
    a.zip_low(b).min(a.zip_high(b))
}

/// The smaller of two numbers; the second where one is NaN.
#[inline(always)]
pub(crate) fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_of_each_vector_is_in_its_lane() {
        let simd = fearless_simd::Fallback::new();
        let lanes = |i: usize| (0..LANES).map(move |lane| ((37 * i + 11 * lane) % 64) as f32);
        let vectors: [_; LANES] =
            std::array::from_fn(|i| f32x8::from_fn(simd, |lane| lanes(i).nth(lane).unwrap()));
        let least: [f32; LANES] = least_of_each(vectors).into();
        assert_eq!(least, std::array::from_fn(|i| lanes(i).fold(99.0, f32::min)));
    }
}
