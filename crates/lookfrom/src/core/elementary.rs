//! Elementary functions of any width: exponential, logarithm, sine, cosine and arc tangent.
//!
//! Additions, multiplications and divisions in a fixed order and no tables, so that the bits are the same at every width and
//! on every machine. Error bounds are stated in units in the last place (ulp) of the result and tested.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, PI};

use lookfrom_simd::{Bits, Float, Real};

/// 1.5 · 2²³: a number plus this, as an f32, has the nearest integer in its last bits.
const ROUNDER: f32 = 12_582_912.0;

/// eˣ to 1 ulp. Below −87.3, where it would be less than the least normal number, 0; above 88.3 infinite; NaN stays.
#[inline(always)]
pub(crate) fn exp<R: Real>(x: R) -> R {
    let (less_one, scale) = reduced_exp(x);
    let is_small = x.lt(x.like(-87.3));
    let is_large = x.gt(x.like(88.3));
    let exp = (less_one + 1.0) * scale;
    R::select(is_small, x.like(0.0), R::select(is_large, x.like(f32::INFINITY), exp))
}

/// 1 − e⁻ˣ for x of 0 and above, to 2 ulp.
#[inline(always)]
pub(crate) fn one_minus_exp<R: Real>(x: R) -> R {
    let one = x.like(1.0);
    let (less_one, scale) = reduced_exp(-x);
    R::select(x.gt(x.like(87.3)), one, one - scale - less_one * scale)
}

/// eʳ − 1 and 2ⁿ, with eˣ = 2ⁿ eʳ and |r| ≤ ½ ln 2, for |x| < 88.
#[inline(always)]
fn reduced_exp<R: Real>(x: R) -> (R, R) {
    // x = n ln 2 + r; n ln 2 in two parts, of which the first is exact.
    let shifted = x * std::f32::consts::LOG2_E + ROUNDER;
    let n = shifted - ROUNDER;
    let r = x - n * 0.693_359_4 + n * 2.121_944_4e-4;
    // eʳ − 1 − r by its series, to r⁷.
    let tail =
        ((((r * (1.0 / 5040.0) + 1.0 / 720.0) * r + 1.0 / 120.0) * r + 1.0 / 24.0) * r + 1.0 / 6.0) * r + 0.5;
    let bits = shifted.to_bits();
    (r + r * r * tail, R::from_bits((bits << 23).wrapping_add(bits.like(0x3f80_0000))))
}

/// The natural logarithm of a positive normal number, to 2 ulp; of 0, −88 or so.
#[inline(always)]
pub(crate) fn ln<R: Real>(x: R) -> R {
    // x = 2ᵉ m with m in [√½, √2).
    const ROOT_HALF: u32 = 0x3f35_04f3;
    let bits = x.to_bits();
    let moved = bits.wrapping_add(bits.like(0x3f80_0000 - ROOT_HALF));
    let mantissa = (moved & bits.like(0x007f_ffff)).wrapping_add(bits.like(ROOT_HALF));
    let e = R::from_integer(moved >> 23) - 127.0;
    let m = R::from_bits(mantissa);
    // ln m = 2 artanh s with s = (m − 1) / (m + 1), by its series; m − 1 is exact.
    let f = m - 1.0;
    let s = f / (m + 1.0);
    let s2 = s * s;
    let tail = (((s2 * (2.0 / 11.0) + 2.0 / 9.0) * s2 + 2.0 / 7.0) * s2 + 2.0 / 5.0) * s2 + 2.0 / 3.0;
    // 2 s = f − s f, which keeps the bits of f.
    let rest = s * (s2 * tail - f) + e * -2.121_944_4e-4;
    e * 0.693_359_4 + (f + rest)
}

/// xⁿ for x and n of 0 and above, 0⁰ = 1; its relative error is at most (2 + 4 |ln xⁿ|) 2⁻²³.
#[inline(always)]
pub(crate) fn power<R: Real>(x: R, n: R) -> R {
    let zero = x.like(0.0);
    let is_zero = x.lt(x.like(f32::MIN_POSITIVE)) & n.gt(zero);
    R::select(is_zero, zero, exp(ln(x) * n))
}

/// Sine and cosine of `t` eighths of a turn (π/4), for |t| ≤ 1, to 2⁻²²: their Taylor series.
#[inline(always)]
pub(crate) fn sin_cos_of_eighths<R: Real>(t: R) -> (R, R) {
    let t2 = t * t;
    let sin = t * ((((t2 * SIN[4] + SIN[3]) * t2 + SIN[2]) * t2 + SIN[1]) * t2 + SIN[0]);
    let cos = ((((t2 * COS[5] + COS[4]) * t2 + COS[3]) * t2 + COS[2]) * t2 + COS[1]) * t2 + COS[0];
    (sin, cos)
}

/// Sine and cosine of `turns` whole turns (2π), for |turns| < 2¹⁸, to 2⁻²².
#[inline(always)]
pub(crate) fn sin_cos_of_turns<R: Real>(turns: R) -> (R, R) {
    // The nearest quarter, and what is left in eighths: exact.
    let quarters = turns * 4.0;
    let shifted = quarters + ROUNDER;
    let (sin, cos) = sin_cos_of_eighths((quarters - (shifted - ROUNDER)) * 2.0);
    // Each quarter turns (cos, sin) into (−sin, cos).
    let bits = shifted.to_bits();
    let is_odd = R::from_integer(bits & bits.like(1)).gt(turns.like(0.0));
    let (x, y) = (R::select(is_odd, sin, cos), R::select(is_odd, cos, sin));
    let sign_of_sin = (bits & bits.like(2)) << 30;
    let sign_of_cos = (bits.wrapping_add(bits.like(1)) & bits.like(2)) << 30;
    (R::from_bits(y.to_bits() ^ sign_of_sin), R::from_bits(x.to_bits() ^ sign_of_cos))
}

/// The angle of the point (x, y) from the x axis in whole turns (2π), from −½ to ½, to 2⁻²²; 0 for the origin.
#[inline(always)]
pub(crate) fn angle_in_turns<R: Real>(y: R, x: R) -> R {
    let (width, height) = (Float::abs(x), Float::abs(y));
    let is_steep = height.gt(width);
    let slope = R::select(is_steep, width, height) / R::select(is_steep, height, width);
    // The tangent of half the angle, at most tan(π/8), and the series of that angle.
    let t = slope / (Float::sqrt(slope * slope + 1.0) + 1.0);
    let t2 = t * t;
    let mut sum = t2.like(ARC_TANGENT[9] as f32);
    let mut k = 9;
    while k > 0 {
        k -= 1;
        sum = sum * t2 + ARC_TANGENT[k] as f32;
    }
    let angle = t * sum * (1.0 / PI) as f32;
    let angle = R::select(is_steep, -angle + 0.25, angle);
    let angle = R::select(x.lt(x.like(0.0)), -angle + 0.5, angle);
    Float::copysign(R::select(Float::eq(slope, slope), angle, x.like(0.0)), y)
}

/// Sine and cosine of an angle of 0 … 2π in double precision, to 2⁻⁵⁰.
#[inline(always)]
pub(crate) fn sin_cos<F: Float<Scalar = f64>>(angle: F) -> (F, F) {
    // The nearest quarter of a turn, and what is left: |rest| ≤ π/4.
    let quarters = angle * angle.like(FRAC_2_PI) + angle.like(ROUNDER_F64) - angle.like(ROUNDER_F64);
    let rest = angle - quarters * angle.like(HALF_PI[0]) - quarters * angle.like(HALF_PI[1]);
    let square = rest * rest;
    let (sin, cos) = (rest * series(square, &SINE), series(square, &COSINE));
    let [first, second, third] = [1.0, 2.0, 3.0].map(|quarter| angle.like(quarter));
    let (first, second, third) =
        (Float::eq(quarters, first), Float::eq(quarters, second), Float::eq(quarters, third));
    (
        F::select(first, cos, F::select(second, -sin, F::select(third, -cos, sin))),
        F::select(first, -sin, F::select(second, -cos, F::select(third, sin, cos))),
    )
}

/// The angle of the point (x, y), y ≥ 0, from the x axis in [0, π] in double precision, to 2⁻⁵⁰ of itself; 0 for the origin.
#[inline(always)]
pub(crate) fn atan2<F: Float<Scalar = f64>>(y: F, x: F) -> F {
    let width = Float::abs(x);
    let is_steep = y.gt(width);
    let slope = F::select(is_steep, width, y) / F::select(is_steep, y, width);
    // The tangent of a quarter of the angle, at most tan(π/16), and the series of that angle.
    let t = halved(halved(slope));
    let angle = t * series(t * t, &ARC_TANGENT) * t.like(4.0);
    let angle = F::select(is_steep, angle.like(FRAC_PI_2) - angle, angle);
    let angle = F::select(x.lt(x.like(0.0)), angle.like(PI) - angle, angle);
    F::select(Float::eq(slope, slope), angle, angle.like(0.0))
}

/// The tangent of half the angle, from that of the angle.
#[inline(always)]
fn halved<F: Float<Scalar = f64>>(tangent: F) -> F {
    let one = tangent.like(1.0);
    tangent / (Float::sqrt(tangent * tangent + one) + one)
}

/// The power series with these coefficients, the lowest first.
#[inline(always)]
fn series<F: Float<Scalar = f64>, const N: usize>(x: F, coefficients: &[f64; N]) -> F {
    let mut sum = x.like(coefficients[N - 1]);
    let mut k = N - 1;
    while k > 0 {
        k -= 1;
        sum = sum * x + x.like(coefficients[k]);
    }
    sum
}

/// 1.5 · 2⁵²: a number plus this, less this, is the nearest integer.
const ROUNDER_F64: f64 = 6_755_399_441_055_744.0;

/// π/2 in two parts; products of the first with small integers are exact.
const HALF_PI: [f64; 2] = {
    let first = f64::from_bits(FRAC_PI_2.to_bits() & !0xff_ffff);
    [first, FRAC_PI_2 - first + 6.123_233_995_736_766e-17]
};

/// (−1)ᵏ / (2k + 1)!
const SINE: [f64; 9] = factorials(1);

/// (−1)ᵏ / (2k)!
const COSINE: [f64; 9] = factorials(0);

/// (−1)ᵏ / (2k + 1)
const ARC_TANGENT: [f64; 12] = {
    let mut terms = [1.0; 12];
    let mut k = 1;
    while k < 12 {
        terms[k] = if k % 2 == 0 { 1.0 } else { -1.0 } / (2 * k + 1) as f64;
        k += 1;
    }
    terms
};

/// (−1)ᵏ / (2k + first)!
const fn factorials(first: usize) -> [f64; 9] {
    let mut terms = [1.0; 9];
    let mut k = 1;
    while k < 9 {
        let n = 2 * k + first;
        terms[k] = -terms[k - 1] / (n * (n - 1)) as f64;
        k += 1;
    }
    terms
}

/// π/4, squared.
const SQUARE: f64 = std::f64::consts::FRAC_PI_4 * std::f64::consts::FRAC_PI_4;

/// (−1)ᵏ (π/4)²ᵏ⁺¹ / (2k + 1)!
const SIN: [f32; 5] = {
    let first = std::f64::consts::FRAC_PI_4;
    let third = -first * SQUARE / 6.0;
    let fifth = -third * SQUARE / 20.0;
    let seventh = -fifth * SQUARE / 42.0;
    let ninth = -seventh * SQUARE / 72.0;
    [first as f32, third as f32, fifth as f32, seventh as f32, ninth as f32]
};

/// (−1)ᵏ (π/4)²ᵏ / (2k)!
const COS: [f32; 6] = {
    let second = -SQUARE / 2.0;
    let fourth = -second * SQUARE / 12.0;
    let sixth = -fourth * SQUARE / 30.0;
    let eighth = -sixth * SQUARE / 56.0;
    let tenth = -eighth * SQUARE / 90.0;
    [1.0, second as f32, fourth as f32, sixth as f32, eighth as f32, tenth as f32]
};

#[cfg(test)]
mod tests {
    use lookfrom_simd::{Kernel, Simd, dispatch, f32x8, level, prelude::*};

    use super::*;
    use crate::core::hash;

    /// A number below 2ᵐᵃˣ in size, of any exponent from 2⁻³⁰.
    fn number(count: u64, max: i32) -> f32 {
        let bits = hash::pair(count, 9);
        let mantissa = 1.0 + (bits >> 40) as f64 / 16_777_216.0;
        let exponent = (bits % (max + 30) as u64) as i32 - 30;
        let sign = if bits & 1 << 39 == 0 { 1.0 } else { -1.0 };
        (sign * mantissa * libm::exp2(f64::from(exponent))) as f32
    }

    /// The distance from the true value in units in the last place of that.
    fn ulps(value: f32, truth: f64) -> f64 {
        let (_, exponent) = libm::frexp(truth);
        (f64::from(value) - truth).abs() / libm::exp2(f64::from(exponent.max(-125) - 24))
    }

    #[test]
    fn errors_are_within_their_bounds() {
        for count in 0..400_000 {
            let x = number(count, 7);
            if (-87.3..88.3).contains(&x) {
                let error = ulps(exp(x), libm::exp(f64::from(x)));
                assert!(error <= 1.0, "exp({x}): {error} ulp");
            }
            let x = number(count, 10).abs();
            let error = ulps(one_minus_exp(x), -libm::expm1(f64::from(-x)));
            assert!(error <= 2.0, "1 - exp(-{x}): {error} ulp");
            let x = number(count, 126).abs();
            let error = ulps(ln(x), libm::log(f64::from(x)));
            assert!(error <= 2.0, "ln({x}): {error} ulp");
            let (x, n) = (number(2 * count, 1).abs(), number(2 * count + 1, 14).abs());
            let truth = libm::pow(f64::from(x), f64::from(n));
            if (1.3e-38..1e38).contains(&truth) {
                let error = (f64::from(power(x, n)) / truth - 1.0).abs();
                let bound = (2.0 + 4.0 * libm::log(truth).abs()) / 8_388_608.0;
                assert!(error <= bound, "{x} to the {n}: {error}, bound {bound}");
            }
            // Near 1, where the logarithm is small.
            let x = 1.0 + number(count, -2);
            let error = ulps(ln(x), libm::log(f64::from(x)));
            assert!(error <= 2.0, "ln({x}): {error} ulp");
            let x = number(count, 10);
            let (sin, cos) = sin_cos_of_turns(x);
            let angle = (f64::from(x) - f64::from(x).round()) * std::f64::consts::TAU;
            let error =
                (f64::from(sin) - libm::sin(angle)).abs().max((f64::from(cos) - libm::cos(angle)).abs());
            assert!(error <= 1.0 / 4_194_304.0, "{x} turns: {error}");
            let (x, y) = (number(count, 60), number(count + 7, 60));
            let turns = libm::atan2(f64::from(y), f64::from(x)) / std::f64::consts::TAU;
            let error = (f64::from(angle_in_turns(y, x)) - turns).abs();
            assert!(error <= 1.0 / 4_194_304.0, "turns of ({x}, {y}): {error}");
            let bound = libm::exp2(-50.0);
            let (y, x) = (f64::from(number(count, 60).abs()), f64::from(number(count + 1, 60)));
            let angle = libm::atan2(y, x);
            let error = (atan2(y, x) - angle).abs() / angle;
            assert!(error <= bound, "angle of ({x}, {y}): {error}");
            let (s, c) = sin_cos(2.0 * angle);
            let error = (s - libm::sin(2.0 * angle)).abs().max((c - libm::cos(2.0 * angle)).abs());
            assert!(error <= bound, "sine and cosine of {angle}: {error}");
        }
    }

    #[test]
    fn angles_on_the_axes() {
        let angles = [[0.0, 1.0], [1.0, 0.0], [0.0, -1.0], [0.0, 0.0]].map(|[y, x]| atan2(y, x));
        assert_eq!(angles, [0.0, FRAC_PI_2, PI, 0.0]);
        let turns = [[0.0, 1.0], [1.0, 0.0], [-1.0, 0.0], [0.0, -1.0], [0.0, 0.0], [-2.0, -2.0]];
        assert_eq!(turns.map(|[y, x]| angle_in_turns(y, x)), [0.0, 0.25, -0.25, 0.5, 0.0, -0.375]);
    }

    #[test]
    fn ends_of_the_exponential() {
        assert_eq!(exp(0.0), 1.0);
        assert_eq!((exp(-88.0), exp(f32::NEG_INFINITY), exp(90.0)), (0.0, 0.0, f32::INFINITY));
        assert_eq!([0.0, 90.0, 1e30, f32::INFINITY].map(one_minus_exp), [0.0, 1.0, 1.0, 1.0]);
        assert!(exp(88.29).is_finite() && exp(-87.29) > f32::MIN_POSITIVE && exp(f32::NAN).is_nan());
    }

    struct All([f32; 8]);

    impl Kernel for All {
        type Output = ([[f32; 8]; 6], [[f64; 8]; 3]);
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let x = f32x8::load_array(simd, self.0);
            let (sin, cos) = sin_cos_of_turns(x);
            let size = SimdBase::abs(x);
            let wide = Real::widen(size);
            let angle = atan2(wide, Real::widen(x));
            let (s, c) = sin_cos(angle);
            let turns = angle_in_turns(x, size - 1.0);
            (
                [
                    exp(x).into(),
                    ln(size).into(),
                    sin.into(),
                    cos.into(),
                    turns.into(),
                    one_minus_exp(size).into(),
                ],
                [angle.into(), s.into(), c.into()],
            )
        }
    }

    #[test]
    fn eight_at_once_are_eight_one_by_one() {
        for round in 0..20_000 {
            let x: [f32; 8] = std::array::from_fn(|lane| match number(8 * round + lane as u64, 8) {
                _ if round == 0 => {
                    [0.0, -0.0, f32::INFINITY, f32::NEG_INFINITY, 1e-40, 88.3, -87.3, 1.0][lane]
                }
                x => x,
            });
            let ([e, l, s, c, t, m], wide) = dispatch(level(), All(x));
            for (lane, &x) in x.iter().enumerate() {
                let (sin, cos) = sin_cos_of_turns(x);
                let turns = angle_in_turns(x, x.abs() - 1.0);
                let less = one_minus_exp(x.abs());
                let expected = [exp(x), ln(x.abs()), sin, cos, turns, less].map(f32::to_bits);
                let got = [e[lane], l[lane], s[lane], c[lane], t[lane], m[lane]].map(f32::to_bits);
                assert_eq!(got, expected, "{x}");
                let angle = atan2(f64::from(x.abs()), f64::from(x));
                let (sin, cos) = sin_cos(angle);
                let expected = [angle, sin, cos].map(f64::to_bits);
                assert_eq!(wide.map(|of| of[lane].to_bits()), expected, "{x}");
            }
        }
    }
}
