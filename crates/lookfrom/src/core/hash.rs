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

/// FNV-1a of bytes, 64 bits wide (Fowler, Noll & Vo 1991): to tell contents apart, not for secrets.
pub(crate) fn of_bytes(bytes: impl IntoIterator<Item = u8>) -> u64 {
    let step = |hash: u64, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
    bytes.into_iter().fold(0xcbf2_9ce4_8422_2325, step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_have_the_published_hashes() {
        assert_eq!(of_bytes([]), 0xcbf2_9ce4_8422_2325);
        assert_eq!(of_bytes(*b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(of_bytes(*b"foobar"), 0x8594_4171_f739_67e8);
    }

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
