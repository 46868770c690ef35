//! Samplers: the random numbers of a sample, as pure functions of pixel, sample index, dimension and seed.
//!
//! Step 3 in the computation of a pixel, and all random decisions after it. A number is a pure function of (seed,
//! pixel, sample, dimension): nothing is stored or counted, any thread may compute any of them in any order, and
//! the result has the same bits on every machine. Warping the numbers is left to [`crate::core::warp`] and
//! [`crate::core::filter`].
//!
//! *Sobol*: each dimension has a two-dimensional pattern of its own, *padded* beside the others. It is Sobol's
//! (0,2)-sequence (the first two of his dimensions) with the scrambling of Owen (1995). The order of the samples is
//! shuffled by the same kind of scrambling, so that patterns of different dimensions and pixels are independent
//! (Burley 2020, Practical Hash-based Owen Scrambling). Every aligned run of 2ᵐ samples of one pattern stays a
//! (0,m,2)-net: each of the 2ᵐ boxes of any shape 2⁻ᵃ × 2⁻⁽ᵐ⁻ᵃ⁾ holds exactly one. So 2ᵐ samples are best, and a
//! render can be continued at any count.
//!
//! The first decisions at what the camera sees vary with the point in the pixel, as at the edge of a penumbra: their pattern
//! is the third and fourth dimension of the pixel's own. The four are a (0,4)-sequence in base 4, each two a (0,2)-sequence
//! of Sobol' (Ahmed et al. 2024, SZ Sequences): of 4ᵐ samples, each of the 4ᵐ boxes whose sides are powers of ¼ holds one.
//!
//! *Independent*: random numbers without a pattern, each a hash of its address.

pub(crate) mod lanes;

use std::cmp::Ordering;

use lookfrom_scene::settings::Sampler as Kind;
use lookfrom_simd::{Bits, Mask, Real};

use crate::core::hash::{GOLDEN, mix};

/// The dimension of the point in the pixel.
pub(crate) const PIXEL: u32 = 0;

/// The largest f32 below 1, and the largest number of a sampler: 1 − 2⁻²⁴.
pub const ONE_MINUS_EPSILON: f32 = 1.0 - f32::EPSILON / 2.0;

/// Identifies a sample of a pixel. The order is by row, column, sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleId {
    /// Column and row from the top left.
    pub pixel: [u32; 2],
    /// Number of the sample in its pixel.
    pub sample: u32,
}

impl Ord for SampleId {
    fn cmp(&self, other: &Self) -> Ordering {
        let in_order = |id: &Self| (id.pixel[1], id.pixel[0], id.sample);
        in_order(self).cmp(&in_order(other))
    }
}

impl PartialOrd for SampleId {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// A source of random numbers in [0, 1).
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    kind: Kind,
    key: u64,
}

/// The random numbers of one pixel.
#[derive(Clone, Copy, Debug)]
pub struct PixelSampler {
    kind: Kind,
    key: u64,
}

impl Sampler {
    /// The sampler of one render. Another `seed` gives other noise. Sample 5 of 16 is equal to sample 5 of 64, so
    /// that a render can be continued.
    pub fn new(kind: Kind, seed: u64) -> Self {
        Self { kind, key: mix(seed.wrapping_add(GOLDEN)) }
    }

    /// The sampler of one pixel, for repeated use.
    #[inline]
    pub fn of_pixel(&self, [x, y]: [u32; 2]) -> PixelSampler {
        let key = mix(self.key ^ (u64::from(x) | u64::from(y) << 32));
        PixelSampler { kind: self.kind, key }
    }

    /// A number in [0, 1): the first of [`Sampler::two`] at the same address.
    #[inline]
    pub fn one(&self, pixel: [u32; 2], sample: u32, dimension: u32) -> f32 {
        self.of_pixel(pixel).one(sample, dimension)
    }

    /// A point in [0, 1)². Coordinates are multiples of 2⁻²⁴.
    ///
    /// `dimension` identifies the decision that the point is for; each decision along a path needs a dimension of
    /// its own. Points of the same dimension over the samples of a pixel are well distributed; points of different
    /// dimensions, pixels or seeds are independent.
    #[inline]
    pub fn two(&self, pixel: [u32; 2], sample: u32, dimension: u32) -> [f32; 2] {
        self.of_pixel(pixel).two(sample, dimension)
    }
}

impl PixelSampler {
    /// As [`Sampler::one`].
    #[inline]
    pub fn one(&self, sample: u32, dimension: u32) -> f32 {
        let [first, _] = self.two(sample, dimension);
        first
    }

    /// As [`Sampler::two`].
    #[inline]
    pub fn two(&self, sample: u32, dimension: u32) -> [f32; 2] {
        two::<f32>(self.kind, self.key, sample, u64::from(dimension))
    }

    /// As [`PixelSampler::two`], with points that are also well distributed together with those of [`PIXEL`]. Those of two
    /// such dimensions are independent where the point in the pixel is given, but not well distributed together: no term
    /// of the light may depend on both.
    #[inline]
    pub(crate) fn two_with_pixel(&self, sample: u32, dimension: u32) -> [f32; 2] {
        two_with_pixel::<f32>(self.kind, self.key, sample, u64::from(dimension), true)
    }
}

/// A point in [0, 1)² for each pixel's key, sample and dimension (below 2³²).
#[inline(always)]
fn two<R: Real>(kind: Kind, key: R::Bits64, sample: R::Bits, dimension: R::Bits64) -> [R; 2] {
    let pattern = pattern::<R>(key, dimension);
    match kind {
        Kind::Sobol => scrambled(shuffled(sample, R::low_half(pattern)), pattern),
        Kind::Independent => independent(pattern, sample),
    }
}

/// [`two`]; in the lanes of a mask, in the third and fourth dimension of [`PIXEL`]'s pattern.
#[inline(always)]
fn two_with_pixel<R: Real>(
    kind: Kind,
    key: R::Bits64,
    sample: R::Bits,
    dimension: R::Bits64,
    mask: R::Mask,
) -> [R; 2] {
    if kind == Kind::Independent || !mask.any() {
        return two(kind, key, sample, dimension);
    }
    let pattern = pattern::<R>(key, dimension);
    let of_pixel = self::pattern::<R>(key, key.like(u64::from(PIXEL)));
    let order = R::select_bits(mask, R::low_half(of_pixel), R::low_half(pattern));
    let index = shuffled(sample, order);
    scrambled(R::select_bits(mask, third(index), index), pattern)
}

/// The 64 bits that identify the pattern of a pixel in a dimension.
#[inline(always)]
fn pattern<R: Real>(key: R::Bits64, dimension: R::Bits64) -> R::Bits64 {
    mix(key ^ dimension)
}

/// The index of a sample in the order of a pattern.
#[inline(always)]
fn shuffled<B: Bits<Scalar = u32>>(sample: B, order: B) -> B {
    reversed(scramble_from_the_low_end(reversed(sample), order))
}

/// The point of Sobol's (0,2)-sequence with an index, scrambled.
#[inline(always)]
fn scrambled<R: Real>(index: R::Bits, pattern: R::Bits64) -> [R; 2] {
    // As an integer the first coordinate is the index itself, whose bits would be mirrored at the binary point
    // (van der Corput 1935).
    let first = scramble_from_the_low_end(index, R::low_half(pattern >> 32));
    let seed = mix(pattern.wrapping_add(pattern.like(GOLDEN)));
    let second = scramble_from_the_low_end(pascal(index), R::low_half(seed));
    [unit(reversed(first)), unit(reversed(second))]
}

/// A hash of the address.
#[inline(always)]
fn independent<R: Real>(pattern: R::Bits64, sample: R::Bits) -> [R; 2] {
    let number = R::extend(sample);
    let number = number.wrapping_add(number.like(1)).wrapping_mul(number.like(GOLDEN));
    let bits = mix(pattern.wrapping_add(number));
    [unit(R::low_half(bits >> 32)), unit(R::low_half(bits))]
}

/// 32 bits behind the binary point, truncated to the 24 that an f32 below 1 always holds: never rounded up to 1, and
/// never out of the box of a net that the point belongs to.
#[inline(always)]
fn unit<R: Real>(bits: R::Bits) -> R {
    R::from_integer(bits >> 8) * (1.0 / 16_777_216.0)
}

/// The bits in reverse order.
#[inline(always)]
fn reversed<B: Bits<Scalar = u32>>(x: B) -> B {
    let x = swapped(swapped(x, 1, 0x5555_5555), 2, 0x3333_3333);
    let x = swapped(swapped(x, 4, 0x0f0f_0f0f), 8, 0x00ff_00ff);
    (x >> 16) | (x << 16)
}

/// Exchanges the bits of a mask with those that many places higher.
#[inline(always)]
fn swapped<B: Bits<Scalar = u32>>(x: B, places: u32, mask: u32) -> B {
    ((x >> places) & x.like(mask)) | ((x & x.like(mask)) << places)
}

/// The generator matrix of the second Sobol' dimension, Pascal's triangle modulo 2, times a vector of bits (bit 0
/// first).
///
/// C(j, i) is odd just where the bits of i are among those of j (Lucas 1878). So bit i of the product is the parity of
/// all bits j ⊇ i, which one pass for each of the five bits of j sums up.
#[inline(always)]
fn pascal<B: Bits<Scalar = u32>>(bits: B) -> B {
    let bits = bits ^ ((bits >> 1) & bits.like(0x5555_5555));
    let bits = bits ^ ((bits >> 2) & bits.like(0x3333_3333));
    let bits = bits ^ ((bits >> 4) & bits.like(0x0f0f_0f0f));
    let bits = bits ^ ((bits >> 8) & bits.like(0x00ff_00ff));
    bits ^ (bits >> 16)
}

/// The generator matrix of a third dimension that makes a (0,4)-sequence with those of Sobol' and with `pascal` of itself,
/// times a vector of bits (bit 0 first).
///
/// Digits of two bits are numbers of GF(4) = {0, 1, α, α + 1}, α² = α + 1. The generalised Pascal matrices C(j, i) aʲ⁻ⁱ
/// are those of Niederreiter's sequence of as many dimensions as there are a (1987); their product for a and b is that for a + b. So
/// a = 0 (the index), 1 (`pascal`, whose digits are scrambled besides), α (this one) and α + 1 (both) are four dimensions.
/// As in `pascal`, digit i sums up all j ⊇ i, times a power of α for each bit that j has more: α¹, α², α⁴ = α, α⁸ = α².
#[inline(always)]
fn third<B: Bits<Scalar = u32>>(bits: B) -> B {
    let bits = bits ^ times_alpha((bits >> 2) & bits.like(0x3333_3333));
    let bits = bits ^ times_alpha(times_alpha((bits >> 4) & bits.like(0x0f0f_0f0f)));
    let bits = bits ^ times_alpha((bits >> 8) & bits.like(0x00ff_00ff));
    bits ^ times_alpha(times_alpha(bits >> 16))
}

/// Digits of GF(4), two bits each, times α: h α + l becomes (h + l) α + h.
#[inline(always)]
fn times_alpha<B: Bits<Scalar = u32>>(digits: B) -> B {
    let high = (digits >> 1) & digits.like(0x5555_5555);
    high ^ ((digits << 1) & digits.like(0xaaaa_aaaa)) ^ (high << 1)
}

/// Owen scrambling of a number whose bits are in reverse order (the most significant one is bit 0): each bit is flipped
/// or not as a hash of all bits below it says.
///
/// Every step lets bits act upward only: x ^ (x · even), x + seed, x · odd. That is the construction of Laine & Karras
/// (2011), here with the steps and constants of Vegdahl (2021, "Building a Better LK Hash"): with the original ones,
/// some pairs among the 63 uppermost nodes agree with a probability that is 0.32 off from ½; with these, none is 0.02
/// off.
#[inline(always)]
fn scramble_from_the_low_end<B: Bits<Scalar = u32>>(bits: B, seed: B) -> B {
    let bits = bits ^ bits.wrapping_mul(bits.like(0x3d20_adea));
    let bits = bits.wrapping_add(seed);
    let bits = bits.wrapping_mul((seed >> 16) | seed.like(1));
    let bits = bits ^ bits.wrapping_mul(bits.like(0x0552_6c56));
    bits ^ bits.wrapping_mul(bits.like(0x53a2_2864))
}

#[cfg(test)]
mod tests;
