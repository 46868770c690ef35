//! UASTC (LDR, 4 × 4): blocks of 16 bytes in one of 19 modes, a subset of ASTC's.
//!
//! A block has one to three subsets of texels, each with two endpoints of a line of colours, and a weight for each texel
//! that interpolates between them. Endpoint values consist of some bits and a trit (0 … 2) or quint (0 … 4); Khronos,
//! "Data Format Specification" 1.3, chapter on ASTC, defines their decoding and the partition patterns.

use super::{Damage, Size, Texel, blocks, lay};

/// Bytes per block.
pub(in crate::image) const BLOCK: usize = 16;

/// The remaining bits of a block, the first in the lowest place.
struct Bits(u128);

impl Bits {
    fn take(&mut self, count: u32) -> u32 {
        let bits = (self.0 & ((1 << count) - 1)) as u32;
        self.0 >>= count;
        bits
    }
}

/// The channel of the second weight plane (dual plane).
#[derive(Clone, Copy, PartialEq)]
enum Second {
    None,
    /// Selected by two bits of the block.
    Told,
    Opacity,
}

/// The block layout of a mode.
struct Mode {
    /// The first bits of its blocks, and their number.
    prefix: (u32, u32),
    /// Bits of a weight.
    weight: u32,
    /// Bits of an endpoint value, and its radix: 3 with a trit, 5 with a quint, else 1.
    end: (u32, u32),
    /// ASTC's seeds of the partition patterns, if there are several subsets.
    seeds: &'static [u32],
    subsets: u32,
    second: Second,
    /// 2: luminance and alpha, 3: colour, 4: both.
    channels: usize,
    /// Bits of hints for transcoders to other formats.
    hints: u32,
}

/// Seeds of patterns with two subsets.
const TWO: &[u32] = &[
    28, 20, 16, 29, 91, 9, 107, 72, 149, 204, 50, 114, 496, 17, 78, 39, 252, 828, 43, 156, 116, 210, 476,
    273, 684, 359, 246, 195, 694, 524,
];
/// Seeds of patterns with three subsets.
const THREE: &[u32] = &[260, 74, 32, 156, 183, 15, 745, 0, 335, 902, 254];
/// Seeds of further patterns with two subsets.
const OTHER_TWO: &[u32] =
    &[36, 48, 61, 137, 161, 183, 226, 281, 302, 307, 479, 495, 593, 594, 605, 799, 812, 988, 993];

/// The prefix of blocks of a single colour.
const PLAIN: (u32, u32) = (0x17, 5);

const MODES: [Mode; 18] = {
    const fn mode(prefix: (u32, u32), weight: u32, end: (u32, u32), channels: usize, hints: u32) -> Mode {
        Mode { prefix, weight, end, seeds: &[], subsets: 1, second: Second::None, channels, hints }
    }
    [
        mode((0x1, 4), 4, (6, 3), 3, 15),
        mode((0x35, 6), 2, (8, 1), 3, 15),
        Mode { seeds: TWO, subsets: 2, ..mode((0x1d, 5), 3, (4, 1), 3, 15) },
        Mode { seeds: THREE, subsets: 3, ..mode((0x3, 5), 2, (2, 3), 3, 15) },
        Mode { seeds: TWO, subsets: 2, ..mode((0x13, 5), 2, (3, 5), 3, 15) },
        mode((0xb, 5), 3, (8, 1), 3, 15),
        Mode { second: Second::Told, ..mode((0x1b, 5), 2, (5, 5), 3, 15) },
        Mode { seeds: OTHER_TWO, subsets: 2, ..mode((0x7, 5), 2, (3, 5), 3, 15) },
        Mode { seeds: TWO, subsets: 2, ..mode((0xf, 5), 2, (4, 1), 4, 23) },
        mode((0x2, 3), 4, (4, 3), 4, 17),
        Mode { second: Second::Told, ..mode((0x0, 2), 2, (4, 3), 4, 17) },
        mode((0x6, 3), 3, (6, 3), 4, 17),
        Mode { second: Second::Told, ..mode((0x1f, 5), 1, (8, 1), 4, 23) },
        mode((0xd, 5), 2, (8, 1), 4, 23),
        mode((0x5, 7), 4, (8, 1), 2, 23),
        Mode { seeds: TWO, subsets: 2, ..mode((0x15, 6), 2, (8, 1), 2, 23) },
        Mode { second: Second::Opacity, ..mode((0x25, 6), 2, (8, 1), 2, 23) },
        mode((0x9, 4), 5, (5, 1), 3, 15),
    ]
};

/// Decodes the blocks of a level.
///
/// # Errors
/// If there are too few blocks, or one has an invalid mode.
pub(in crate::image) fn uastc(level: &[u8], size: Size) -> Result<Vec<Texel>, Damage> {
    let [columns, rows] = blocks(size);
    let written = level.as_chunks::<BLOCK>().0;
    let written = written.get(..columns * rows).ok_or("its blocks are cut off")?;
    let damage = "a block has an invalid mode";
    let [width, height] = size;
    let mut texels = vec![[0; 4]; width * height];
    let mut is_whole = true;
    let decoded = written.iter().map(|block| {
        decode(u128::from_le_bytes(*block)).unwrap_or_else(|| {
            is_whole = false;
            [[0; 4]; 16]
        })
    });
    lay(&mut texels, size, decoded);
    if is_whole { Ok(texels) } else { Err(damage) }
}

/// The texels of a block, row by row; `None` if its mode or its partition pattern is invalid.
fn decode(block: u128) -> Option<[Texel; 16]> {
    let bits = &mut Bits(block);
    let begins = |(prefix, length): (u32, u32)| block & ((1 << length) - 1) == u128::from(prefix);
    if begins(PLAIN) {
        bits.take(PLAIN.1);
        let color = [(); 4].map(|()| bits.take(8) as u8);
        return Some([color; 16]);
    }
    let mode = MODES.iter().find(|mode| begins(mode.prefix))?;
    bits.take(mode.prefix.1 + mode.hints);
    let subsets = match mode.subsets {
        1 => [0; 16],
        count => {
            let index = bits.take(if count == 3 { 4 } else { 5 });
            subsets(*mode.seeds.get(index as usize)?, count)
        }
    };
    let second = match mode.second {
        Second::None => None,
        Second::Told => Some(bits.take(2) as usize),
        Second::Opacity => Some(3),
    };
    let ends = ends(mode, bits);
    let weights = weights(mode, &subsets, bits);
    let texel = |(&subset, weights): (&usize, &[u32; 2])| {
        std::array::from_fn(|channel| {
            let index = match (mode.channels, channel) {
                (2, 3) => 1,
                (2, _) => 0,
                (3, 3) => return 255,
                (_, channel) => channel,
            };
            let weight = weights[usize::from(second == Some(channel))];
            let at = 2 * (subset * mode.channels + index);
            // Interpolated in 16 bits, rounded; the upper byte is the result.
            let [from, to] = [ends[at], ends[at + 1]].map(|end| u32::from(end) * 257);
            ((from * (64 - weight) + to * weight + 32) >> 14) as u8
        })
    };
    let mut texels = [[0; 4]; 16];
    for (to, from) in texels.iter_mut().zip(subsets.iter().zip(&weights)) {
        *to = texel(from);
    }
    Some(texels)
}

/// Endpoint values: by subset, then by channel, the first and the second endpoint.
fn ends(mode: &Mode, bits: &mut Bits) -> [u8; 18] {
    let count = 2 * mode.channels * mode.subsets as usize;
    let (length, base) = mode.end;
    // Five trits are packed in 8 bits, three quints in 7; fewer of them in as few bits as possible.
    let packed: &[u32] = match base {
        3 => &[0, 2, 4, 5, 7, 8],
        5 => &[0, 3, 5, 7],
        _ => &[0, 0],
    };
    let mut digits = [0; 18];
    for group in digits[..count].chunks_mut(packed.len() - 1) {
        let mut rest = bits.take(packed[group.len()]);
        for digit in group {
            *digit = rest % base;
            rest /= base;
        }
    }
    let mut ends = [0; 18];
    for (end, digit) in ends.iter_mut().zip(digits).take(count) {
        *end = byte(bits.take(length), length, digit, base);
    }
    ends
}

/// The byte that some bits with a trit or quint decode to (unquantisation).
fn byte(value: u32, length: u32, digit: u32, base: u32) -> u8 {
    // The bits but the lowest, spread to their places, and the factor of the trit or quint.
    let high = value >> 1;
    let (spread, factor) = match (length, base) {
        (2, 3) => (high << 8 | high << 4 | high << 2 | high << 1, 93),
        (4, 3) => (high << 6 | high, 22),
        (6, 3) => (high << 4 | high >> 4, 5),
        (3, 5) => (high << 7 | high << 1 | high >> 1, 26),
        (5, 5) => (high << 5 | high >> 3, 6),
        // Without trits and quints, the bits are replicated.
        (4, _) => return (value * 17) as u8,
        (5, _) => return (value << 3 | value >> 2) as u8,
        _ => return value as u8,
    };
    let all = if value & 1 == 1 { 0x1ff } else { 0 };
    let sum = (digit * factor + spread) ^ all;
    (all & 0x80 | sum >> 2) as u8
}

/// Weights of the texels from 0 to 64: for all channels, and for the channel of the second plane.
fn weights(mode: &Mode, subsets: &[usize; 16], bits: &mut Bits) -> [[u32; 2]; 16] {
    let planes = if mode.second == Second::None { 1 } else { 2 };
    let mut has_begun = [false; 3];
    let mut weights = [[0; 2]; 16];
    for (weights, &subset) in weights.iter_mut().zip(subsets) {
        // The highest bit of the first texel's weight in each subset is 0 and not stored.
        let is_first = !std::mem::replace(&mut has_begun[subset], true);
        let length = mode.weight - u32::from(is_first);
        for weight in weights.iter_mut().take(planes) {
            // Expanded to six bits by replication; then 63 becomes 64.
            let written = bits.take(length);
            let six = match mode.weight {
                1 => written * 63,
                2 => written * 21,
                3 => written * 9,
                4 => written << 2 | written >> 2,
                _ => written << 1 | written >> 4,
            };
            *weight = six + u32::from(six > 32);
        }
    }
    weights
}

/// The subset of each texel, of two or three, by ASTC's partition function for small blocks.
pub(super) fn subsets(seed: u32, count: u32) -> [usize; 16] {
    let seed = seed + (count - 1) * 1024;
    let mut hash = seed;
    hash ^= hash >> 15;
    hash = hash.wrapping_sub(hash << 17);
    hash = hash.wrapping_add(hash << 7);
    hash = hash.wrapping_add(hash << 4);
    hash ^= hash >> 5;
    hash = hash.wrapping_add(hash << 16);
    hash ^= hash >> 7;
    hash ^= hash >> 3;
    hash ^= hash << 6;
    hash ^= hash >> 17;
    let by_seed = if seed & 2 == 2 { 4 } else { 5 };
    let by_count = if count == 3 { 6 } else { 5 };
    let shifts = if seed & 1 == 1 { [by_seed, by_count] } else { [by_count, by_seed] };
    // Gradients of three planes in x and in y.
    let slope = |index: u32| {
        let nibble = hash >> (4 * index) & 15;
        (nibble * nibble) >> shifts[index as usize % 2]
    };
    std::array::from_fn(|texel| {
        // Coordinates are doubled for blocks of fewer than 31 texels.
        let [x, y] = [texel % 4, texel / 4].map(|place| 2 * place as u32);
        let height =
            |index: u32| (slope(2 * index) * x + slope(2 * index + 1) * y + (hash >> (14 - 4 * index))) & 63;
        let [a, b, c] = [height(0), height(1), if count == 3 { height(2) } else { 0 }];
        if a >= b && a >= c {
            0
        } else if b >= c {
            1
        } else {
            2
        }
    })
}
