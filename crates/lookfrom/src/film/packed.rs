//! Blocks of sums of pixels, each number in as few bytes as its neighbourhood needs.
//!
//! Sums have 128 bits so that nothing is ever lost; nearly always most of them are zeros or copies of the sign. Of each of its
//! numbers a block stores only the bytes between those that are zero, and those that repeat the sign, in all of its pixels. That is
//! exact, and equal numbers have equal bytes. A block without sums has no bytes.

use std::marker::PhantomData;

use super::stored::Stored;

/// The most numbers of a pixel.
const MOST_NUMBERS: usize = 32;

/// Bytes of a number before it is packed.
const WIDE: usize = size_of::<i128>();

/// Replaces a block, in its own memory if the new one has the same length.
pub(super) fn replace(block: &mut Box<[u8]>, bytes: &[u8]) {
    match block.len() == bytes.len() {
        true => block.copy_from_slice(bytes),
        false => *block = bytes.into(),
    }
}

/// The bytes of a number that are stored.
#[derive(Clone, Copy, Debug, Default)]
struct Kept {
    /// Number of bytes below them, which are 0.
    below: u8,
    /// Number of bytes that are stored; those above repeat the sign.
    bytes: u8,
}

/// A block: what is kept of each number, then the kept bytes pixel by pixel, then [`WIDE`] bytes more, so that a number can be read
/// and written as a whole.
pub(super) struct Packed<'a, T> {
    block: &'a [u8],
    kept: [Kept; MOST_NUMBERS],
    /// Bytes of a pixel.
    pixel: usize,
    of: PhantomData<T>,
}

impl<'a, T: Stored + Default> Packed<'a, T> {
    pub(super) fn of(block: &'a [u8]) -> Self {
        let mut kept = [Kept::default(); MOST_NUMBERS];
        let mut pixel = 0;
        for (kept, pair) in kept.iter_mut().take(T::NUMBERS).zip(block.chunks_exact(2)) {
            *kept = Kept { below: pair[0], bytes: pair[1] };
            pixel += usize::from(kept.bytes);
        }
        Self { block, kept, pixel, of: PhantomData }
    }

    /// The sums of a pixel, by its number in the block.
    #[inline(always)]
    pub(super) fn get(&self, index: usize) -> T {
        if self.block.is_empty() {
            return T::default();
        }
        let mut at = 2 * T::NUMBERS + index * self.pixel;
        let mut kept = self.kept.iter();
        T::take_numbers(&mut || match kept.next() {
            Some(kept) if kept.bytes > 0 => {
                let number = kept.number(&self.block[at..at + WIDE]);
                at += usize::from(kept.bytes);
                number
            }
            _ => 0,
        })
    }
}

impl Kept {
    /// The number of which the first bytes are those that are kept, at least one.
    #[inline(always)]
    fn number(self, wide: &[u8]) -> i128 {
        const HALF: usize = size_of::<i64>();
        let [bytes, below] = [u32::from(self.bytes), 8 * u32::from(self.below)];
        match wide.first_chunk::<HALF>() {
            // Most numbers are short, and 64 bits are faster.
            Some(half) if bytes <= HALF as u32 => {
                let above = 8 * (HALF as u32 - bytes);
                i128::from(i64::from_le_bytes(*half) << above >> above) << below
            }
            _ => {
                let above = 8 * (WIDE as u32 - bytes);
                let number = wide.first_chunk().map_or(0, |wide| i128::from_le_bytes(*wide));
                number << above >> above << below
            }
        }
    }
}

/// The sums of a block's `count` pixels.
pub(super) fn unpack<T: Stored + Default>(block: &[u8], count: usize, sums: &mut Vec<T>) {
    let packed = Packed::of(block);
    sums.clear();
    sums.extend((0..count).map(|index| packed.get(index)));
}

/// The bytes of a block of these pixels.
pub(super) fn pack<T: Stored + Default + PartialEq>(sums: &[T], bytes: &mut Vec<u8>) {
    const { assert!(T::NUMBERS <= MOST_NUMBERS) };
    bytes.clear();
    let none = T::default();
    if sums.iter().all(|sums| *sums == none) {
        return;
    }
    // The bits that are set in any pixel, and those that differ from the sign.
    let mut bits = [[0_u128; 2]; MOST_NUMBERS];
    for sums in sums {
        let mut all = bits.iter_mut();
        sums.put_numbers(&mut |number: i128| {
            if let Some([set, unlike_sign]) = all.next() {
                *set |= number.cast_unsigned();
                *unlike_sign |= (number ^ (number >> 127)).cast_unsigned();
            }
        });
    }
    let kept = bits.map(|[set, unlike_sign]| {
        if set == 0 {
            return Kept::default();
        }
        // With a bit for the sign.
        let end = (128 - unlike_sign.leading_zeros()) / 8 + 1;
        let below = set.trailing_zeros() / 8;
        Kept { below: below as u8, bytes: (end - below) as u8 }
    });
    let pixel: usize = kept.iter().take(T::NUMBERS).map(|kept| usize::from(kept.bytes)).sum();
    bytes.extend(kept.iter().take(T::NUMBERS).flat_map(|kept| [kept.below, kept.bytes]));
    let mut at = bytes.len();
    bytes.resize(at + sums.len() * pixel + WIDE, 0);
    for sums in sums {
        let mut kept = kept.iter();
        sums.put_numbers(&mut |number: i128| {
            if let Some(&Kept { below, bytes: stored }) = kept.next() {
                let number = number >> (8 * u32::from(below));
                bytes[at..at + WIDE].copy_from_slice(&number.to_le_bytes());
                at += usize::from(stored);
            }
        });
    }
    // Of the last number, the bytes that are not kept.
    bytes[at..].fill(0);
}

#[cfg(test)]
mod tests {
    use super::super::Pixel;
    use super::super::pixel::any_pixel;
    use super::*;
    use crate::aov::LayerSums;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn numbers_come_back(sums in prop::collection::vec(any_pixel(), 1..30)) {
            let (mut bytes, mut again) = (Vec::new(), Vec::<Pixel>::new());
            pack(&sums, &mut bytes);
            unpack(&bytes, sums.len(), &mut again);
            prop_assert_eq!(again, sums);
        }
    }

    #[test]
    fn extremes_come_back() {
        for extreme in [i128::MIN, i128::MAX, -1, 1, i128::from(u64::MAX), -128, 127, 128] {
            let sums = [extreme; 3];
            let sums =
                [Pixel { sums, squares: [u128::MAX, 1 << 127, 0], samples: u64::MAX }, Pixel::default()];
            let (mut bytes, mut again) = (Vec::new(), Vec::<Pixel>::new());
            pack(&sums, &mut bytes);
            unpack(&bytes, 2, &mut again);
            assert_eq!(again, sums);
        }
    }

    #[test]
    fn what_has_no_samples_takes_no_memory() {
        let mut bytes = vec![1];
        pack(&[Pixel::default(); 9], &mut bytes);
        assert!(bytes.is_empty());
        pack(&[LayerSums::default(); 9], &mut bytes);
        assert!(bytes.is_empty());
    }
}
