//! Integer hashes.
//!
//! The mixing function behind random numbers ([`crate::core::sampler`]) and lattices ([`crate::core::noise`]). The
//! inputs and their order are up to the caller.
//!
//! Steele, Lea & Flood 2014 (SplitMix), with the multipliers of Stafford's variant 13.

use lookfrom_simd::Bits;

/// 2⁶⁴ divided by the golden ratio, made odd: its multiples are spread evenly over the 64-bit numbers.
pub(crate) const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// A bijection of the 64-bit numbers in which each bit of the input flips each bit of the output about half the
/// time. Zero maps to zero.
#[inline(always)]
pub(crate) fn mix<B: Bits<Scalar = u64>>(bits: B) -> B {
    let bits = (bits ^ (bits >> 30)).wrapping_mul(bits.like(0xbf58_476d_1ce4_e5b9));
    let bits = (bits ^ (bits >> 27)).wrapping_mul(bits.like(0x94d0_49bb_1331_11eb));
    bits ^ (bits >> 31)
}

/// A bijection of the 32-bit numbers, of any width, that is good enough for random walks (Wellons 2018, "lowbias32").
/// Zero stays zero.
#[inline(always)]
pub(crate) fn mix32<B: Bits<Scalar = u32>>(bits: B) -> B {
    let bits = (bits ^ (bits >> 16)).wrapping_mul(bits.like(0x7feb_352d));
    let bits = (bits ^ (bits >> 15)).wrapping_mul(bits.like(0x846c_a68b));
    bits ^ (bits >> 16)
}

/// A 64-bit hash of two numbers, which depends on their order.
#[inline]
pub(crate) fn pair(a: u64, b: u64) -> u64 {
    mix(mix(a.wrapping_add(GOLDEN)) ^ b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_input_bit_reaches_every_output_bit() {
        const TRIALS: u64 = 4096;
        for input in 0..64 {
            let mut flips = [0_u32; 64];
            for trial in 0..TRIALS {
                let bits = trial.wrapping_mul(GOLDEN);
                let difference = mix(bits) ^ mix(bits ^ (1 << input));
                for (output, count) in flips.iter_mut().enumerate() {
                    *count += (difference >> output & 1) as u32;
                }
            }
            for (output, &count) in flips.iter().enumerate() {
                let share = f64::from(count) / TRIALS as f64;
                assert!(
                    (share - 0.5).abs() < 0.08,
                    "bit {input} flips bit {output} with probability {share}"
                );
            }
        }
    }

    #[test]
    fn pairs_of_small_numbers_are_all_different() {
        let mut hashes: Vec<u64> = (0..40_000).map(|i| pair(i % 200, i / 200)).collect();
        hashes.sort_unstable();
        hashes.dedup();
        assert_eq!(hashes.len(), 40_000);
    }

    #[test]
    fn bits_are_pinned() {
        assert_eq!(mix(0_u64), 0);
        assert_eq!(mix(GOLDEN), 0xe220_a839_7b1d_cdaf);
        assert_eq!(mix(GOLDEN.wrapping_mul(2)), 0x6e78_9e6a_a1b9_65f4);
    }
}
