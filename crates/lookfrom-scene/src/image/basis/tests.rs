//! Blocks and codes by hand, random images from a BasisLZ writer, and damaged copies of them.
//!
//! The checksums of [`sum`] were taken when 300 000 UASTC blocks and 4 000 ETC1S images, generated in this way, decoded to
//! the same bytes as with the crate `basisu` 0.1.0, which wraps Binomial's transcoder.

use super::huffman::{Bits, Code};
use super::uastc::subsets;
use super::*;

/// A random number generator (xorshift, Marsaglia 2003).
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 >> 16
    }

    /// A number below `count`.
    fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }
}

/// A checksum of texels that depends on their order (FNV-1a).
fn sum(texels: &[[u8; 4]], sum: u64) -> u64 {
    texels.as_flattened().iter().fold(sum, |sum, &byte| (sum ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

/// A bit stream writer, from the lowest bit of each byte.
#[derive(Default)]
struct Writer {
    bytes: Vec<u8>,
    free: u32,
}

/// Codes and their lengths in bits.
type Written = Vec<(u32, u8)>;

impl Writer {
    fn put(&mut self, value: u32, count: u32) {
        for bit in 0..count {
            if self.free == 0 {
                self.bytes.push(0);
                self.free = 8;
            }
            *self.bytes.last_mut().unwrap() |= ((value >> bit & 1) as u8) << (8 - self.free);
            self.free -= 1;
        }
    }

    fn symbol(&mut self, codes: &Written, symbol: usize) {
        let (code, length) = codes[symbol];
        assert!(length > 0);
        (0..length).rev().for_each(|bit| self.put(code >> bit & 1, 1));
    }

    fn number(&mut self, mut number: u32, group: u32) {
        loop {
            let rest = number >> group;
            self.put(number & ((1 << group) - 1) | u32::from(rest > 0) << group, group + 1);
            number = rest;
            if rest == 0 {
                break;
            }
        }
    }

    /// Writes a random code for some symbols, with every way of storing code lengths.
    fn code(&mut self, symbols: usize, chance: &mut Chance) -> Written {
        let mut lengths: Vec<u8> = vec![1; symbols.min(2)];
        while lengths.len() < symbols {
            let place = chance.below(lengths.len());
            if lengths[place] < 16 {
                lengths[place] += 1;
                lengths.push(lengths[place]);
            }
        }
        // Symbols that do not occur are among the others.
        lengths.resize(symbols, 0);
        self.put(symbols as u32, 14);
        self.put(21, 5);
        let of_lengths: [u8; 21] = std::array::from_fn(|symbol| if symbol < 11 { 4 } else { 5 });
        for symbol in [17, 18, 19, 20, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15, 16] {
            self.put(of_lengths[symbol].into(), 3);
        }
        let of_lengths = codes(&of_lengths);
        let mut place = 0;
        while place < symbols {
            let length = lengths[place];
            let same = lengths[place..].iter().take_while(|&&other| other == length).count();
            let is_repeated = place > 0 && lengths[place - 1] == length;
            place += match same {
                7.. if is_repeated => {
                    self.symbol(&of_lengths, 20);
                    self.put(same.min(134) as u32 - 7, 7);
                    same.min(134)
                }
                3.. if is_repeated => {
                    self.symbol(&of_lengths, 19);
                    self.put(same as u32 - 3, 2);
                    same
                }
                _ => {
                    self.symbol(&of_lengths, length.into());
                    1
                }
            };
        }
        codes(&lengths)
    }
}

/// The canonical codes of these lengths.
fn codes(lengths: &[u8]) -> Written {
    let mut codes = vec![(0, 0); lengths.len()];
    let mut next = 0;
    for length in 1..=16 {
        for (code, _) in codes.iter_mut().zip(lengths).filter(|(_, of_symbol)| **of_symbol == length) {
            *code = (next, length);
            next += 1;
        }
        next <<= 1;
    }
    codes
}

/// A random ETC1S image.
struct Picture {
    size: Size,
    global: Vec<u8>,
    level: Vec<u8>,
}

impl Picture {
    fn by_chance(chance: &mut Chance) -> Self {
        let size = [1 + chance.below(40), 1 + chance.below(40)];
        let (endpoints, selectors, recent) =
            (1 + chance.below(40), 1 + chance.below(60), 1 + chance.below(20));

        let mut bits = Writer::default();
        let by_level = [(); 3].map(|()| bits.code(32, chance));
        let intensities = bits.code(8, chance);
        let channels = [1, 3][chance.below(2)];
        bits.put(u32::from(channels == 1), 1);
        let mut last = [16; 3];
        for _ in 0..endpoints {
            bits.symbol(&intensities, chance.below(8));
            for channel in &mut last[..channels] {
                let code = &by_level[usize::from(*channel > 9) + usize::from(*channel > 21)];
                let change = chance.below(32);
                bits.symbol(code, change);
                *channel = (*channel + change) & 31;
            }
        }
        let mut parts = vec![std::mem::take(&mut bits)];

        let is_raw = chance.below(2) == 1;
        bits.put(u32::from(is_raw) << 2, 3);
        let changes = if is_raw { Vec::new() } else { bits.code(256, chance) };
        for row in 0..4 * selectors {
            let byte = chance.below(256);
            if is_raw || row < 4 { bits.put(byte as u32, 8) } else { bits.symbol(&changes, byte) }
        }
        parts.push(std::mem::take(&mut bits));

        let codes = [257, endpoints, selectors + recent + 1, 64].map(|symbols| bits.code(symbols, chance));
        bits.put(recent as u32, 13);
        parts.push(bits);

        let has_opacity = chance.below(2) == 1;
        let counts = [endpoints, selectors, recent];
        let colors = slice(size, &codes, counts, chance);
        let opacities = if has_opacity { slice(size, &codes, counts, chance) } else { Vec::new() };
        let mut global = [endpoints, selectors].map(|count| (count as u16).to_le_bytes()).concat();
        let lengths = parts.iter().map(|part| part.bytes.len());
        for field in lengths.chain([0, 0, 0, colors.len(), colors.len(), opacities.len()]) {
            global.extend((field as u32).to_le_bytes());
        }
        parts.iter().for_each(|part| global.extend(&part.bytes));
        Self { size, global, level: [colors, opacities].concat() }
    }

    fn read(&self) -> Result<Vec<Texel>, Damage> {
        etc1s(&self.global, &self.level, 1, self.size)
    }
}

/// Writes a slice of random blocks.
fn slice(
    size: Size,
    [predictors, ends, choices, runs]: &[Written; 4],
    [endpoints, selectors, recent]: [usize; 3],
    chance: &mut Chance,
) -> Vec<u8> {
    let [columns, rows] = blocks(size);
    let mut bits = Writer::default();
    let (mut told, mut last, mut repeats, mut run) = (vec![0; columns], 0, 0, 0);
    for (y, x) in (0..rows).flat_map(|y| (0..columns).map(move |x| (y, x))) {
        if x % 2 == 0 && y % 2 == 0 {
            if repeats > 0 {
                repeats -= 1;
            } else if last == 255 && chance.below(3) == 0 {
                let more = chance.below(40) as u32;
                bits.symbol(predictors, 256);
                bits.number(more, 4);
                repeats = more + 2;
            } else {
                // Like its neighbour to the left or above, if there is one, or coded anew.
                let mut one = |x: usize, y: usize| {
                    let like = chance.below(4);
                    let is_there = [x > 0, y > 0, x > 0 && y > 0, true][like];
                    if is_there { like } else { 3 }
                };
                last = one(x, y) | one(x + 1, y) << 2 | one(x, y + 1) << 4 | one(x + 1, y + 1) << 6;
                bits.symbol(predictors, last);
            }
            told[x] = last;
        }
        let shift = 2 * (x % 2) + 4 * (y % 2);
        if told[x - x % 2] >> shift & 3 == 3 {
            bits.symbol(ends, chance.below(endpoints));
        }
        if run > 0 {
            run -= 1;
            continue;
        }
        let left = columns * (rows - y) - x;
        let choice = chance.below(selectors + recent + usize::from(left >= 3));
        bits.symbol(choices, choice);
        if choice == selectors + recent {
            let more = chance.below(left - 2);
            bits.symbol(runs, more.min(63));
            if more >= 63 {
                bits.number(more as u32, 7);
            }
            run = more + 2;
        }
    }
    bits.bytes
}

#[test]
fn bits_come_from_the_least_on_and_are_zero_beyond_the_end() {
    let mut bits = Bits::new(&[0b1010_0110, 0xff]);
    assert_eq!([bits.take(3), bits.take(0), bits.take(6)], [0b110, 0, 0b11_0100]);
    assert!(!bits.is_past_end());
    assert_eq!(bits.take(16), 0x7f);
    assert!(bits.is_past_end());
    let mut writer = Writer::default();
    let numbers = [0, 15, 16, 1 << 20, u32::MAX];
    numbers.iter().for_each(|&number| writer.number(number, 4));
    let mut bits = Bits::new(&writer.bytes);
    assert_eq!(numbers.map(|_| bits.number(4)), numbers);
}

#[test]
fn codes_are_read_as_they_are_written() {
    let chance = &mut Chance(7);
    for symbols in [1, 2, 3, 40, 700] {
        let mut writer = Writer::default();
        let codes = writer.code(symbols, chance);
        let written: Vec<usize> = (0..300).map(|_| chance.below(symbols)).collect();
        written.iter().for_each(|&symbol| writer.symbol(&codes, symbol));
        let mut bits = Bits::new(&writer.bytes);
        let code = Code::read(&mut bits).unwrap().expect("it has symbols");
        assert!(written.iter().all(|&symbol| code.symbol(&mut bits) == Ok(symbol as u32)));
        assert!(!bits.is_past_end());
    }
}

#[test]
fn patterns_of_subsets_are_astcs() {
    assert_eq!(subsets(28, 2), [0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1]);
    assert_eq!(subsets(74, 3), [1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 2, 2, 2, 2]);
    assert_eq!(subsets(524, 2), [1, 0, 0, 1, 0, 0, 1, 1, 0, 1, 1, 0, 1, 1, 0, 0]);
}

#[test]
fn blocks_of_every_mode_are_texels_of_known_values() {
    // A block of one colour: its mode in five bits, then a byte for each channel.
    let plain = 0x17_u128 | 0x0403_0201 << 5;
    assert_eq!(uastc(&plain.to_le_bytes(), [4, 4]).unwrap(), [[1, 2, 3, 4]; 16]);
    let chance = &mut Chance(42);
    let (mut all, mut damaged) = (0xcbf2_9ce4_8422_2325, 0);
    for _ in 0..20_000 {
        let block: [u8; 16] = std::array::from_fn(|_| chance.next() as u8);
        match uastc(&block, [4, 4]) {
            Ok(texels) => all = sum(&texels, all),
            Err(_) => damaged += 1,
        }
    }
    assert_eq!((all, damaged), (0xf683_b749_04c7_794e, 676));
    assert!(uastc(&[0; 31], [5, 4]).is_err());
}

#[test]
fn pictures_of_etc1s_are_read_as_they_are_written() {
    let chance = &mut Chance(1);
    let all = (0..200).fold(0xcbf2_9ce4_8422_2325, |all, index| {
        let picture = Picture::by_chance(chance);
        let texels = picture.read().unwrap_or_else(|damage| panic!("picture {index}: {damage}"));
        assert_eq!(texels.len(), picture.size[0] * picture.size[1]);
        sum(&texels, all)
    });
    assert_eq!(all, 0xc273_d4c8_204a_dfc6);
}

#[test]
fn whatever_bytes_there_are_nothing_panics() {
    let chance = &mut Chance(3);
    let mut damaged = 0;
    for _ in 0..100 {
        let Picture { size, global, level } = Picture::by_chance(chance);
        for _ in 0..60 {
            let mut picture = Picture { size, global: global.clone(), level: level.clone() };
            for _ in 0..=chance.below(4) {
                let part = if chance.below(3) == 0 { &mut picture.level } else { &mut picture.global };
                let place = chance.below(part.len().max(1));
                match chance.below(4) {
                    0 => part.truncate(place),
                    1 => part.insert(place.min(part.len()), chance.next() as u8),
                    2 => part[place..].iter_mut().take(9).for_each(|byte| *byte = chance.next() as u8),
                    _ => part.iter_mut().skip(place).take(1).for_each(|byte| *byte ^= 1 << chance.below(8)),
                }
            }
            if chance.below(8) == 0 {
                picture.size = [1 + chance.below(300), 1 + chance.below(300)];
            }
            match picture.read() {
                Ok(texels) => assert_eq!(texels.len(), picture.size[0] * picture.size[1]),
                Err(_) => damaged += 1,
            }
        }
    }
    assert!(damaged > 1000, "{damaged}");
    // And random bytes.
    for _ in 0..20_000 {
        let length = chance.below(200);
        let bytes: Vec<u8> = (0..length).map(|_| chance.next() as u8).collect();
        let (global, level) = bytes.split_at(length * 3 / 4);
        let _ = etc1s(global, level, chance.below(4), [9, 9]);
        let _ = Code::read(&mut Bits::new(&bytes));
    }
}
