//! Canonical Huffman codes (Huffman 1952) in a bit stream, least significant bit first.

use super::Damage;

/// Maximum length of a code in bits.
const LONGEST: usize = 16;

/// Number of symbols of the code that encodes another code's lengths.
const LENGTH_SYMBOLS: usize = 21;

/// The order in which the lengths of that code are stored.
const ORDER: [usize; LENGTH_SYMBOLS] =
    [17, 18, 19, 20, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15, 16];

/// A bit stream. Beyond its end all bits are 0.
pub(super) struct Bits<'a> {
    bytes: &'a [u8],
    /// Number of bits read.
    taken: usize,
}

impl<'a> Bits<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, taken: 0 }
    }

    /// The next bits, at least 25 of the 32 valid.
    fn peek(&self) -> u32 {
        let from = self.taken / 8;
        let byte = |index: usize| self.bytes.get(from + index).copied().unwrap_or(0);
        u32::from_le_bytes(std::array::from_fn(byte)) >> (self.taken % 8)
    }

    /// The next `count` bits as a number: at most 16.
    pub(super) fn take(&mut self, count: u32) -> u32 {
        debug_assert!(count <= 16);
        let bits = self.peek() & ((1 << count) - 1);
        self.taken += count as usize;
        bits
    }

    /// A variable-length integer in groups of bits, the lowest first; a bit after each tells whether another follows.
    pub(super) fn number(&mut self, group: u32) -> u32 {
        let (mut number, mut shift) = (0_u32, 0);
        while shift < 32 {
            let bits = self.take(group + 1);
            number |= (bits & ((1 << group) - 1)) << shift;
            shift += group;
            if bits >> group == 0 {
                break;
            }
        }
        number
    }

    /// Whether more bits were read than the stream has.
    pub(super) fn is_past_end(&self) -> bool {
        self.taken > self.bytes.len().saturating_mul(8)
    }
}

/// A canonical Huffman code.
pub(super) struct Code {
    /// Length of the longest code in bits.
    longest: u32,
    /// By this many bits: the symbol and the length of its code, 0 for bits that are not a code.
    table: Vec<(u16, u8)>,
}

impl Code {
    /// The canonical code with these code lengths, which must be complete or have a single symbol. `None` if no symbol has a
    /// code.
    fn new(lengths: &[u8]) -> Result<Option<Self>, Damage> {
        let mut counts = [0_u32; LONGEST + 1];
        for &length in lengths {
            *counts.get_mut(usize::from(length)).ok_or("a code is too long")? += 1;
        }
        counts[0] = 0;
        let Some(longest) = counts.iter().rposition(|&count| count > 0) else { return Ok(None) };
        // The first code of each length, and a count that shows whether the codes are complete.
        let mut first = [0_u32; LONGEST + 1];
        let mut next = 0_u32;
        for (first, count) in first.iter_mut().zip(counts).skip(1) {
            next <<= 1;
            *first = next;
            next += count;
        }
        if next != 1 << LONGEST && counts.iter().sum::<u32>() != 1 {
            return Err("a code is not complete");
        }
        let mut table = vec![(0, 0); 1 << longest];
        for (symbol, &length) in lengths.iter().enumerate().filter(|(_, length)| **length > 0) {
            let code = &mut first[usize::from(length)];
            // Codes are stored with their first bit in the lowest place.
            let bits = code.reverse_bits() >> (32 - u32::from(length));
            *code += 1;
            for entry in table.iter_mut().skip(bits as usize).step_by(1 << length) {
                *entry = (symbol as u16, length);
            }
        }
        Ok(Some(Self { longest: longest as u32, table }))
    }

    /// Reads the description of a code; `None` if it has no symbols.
    ///
    /// # Errors
    /// If the description is invalid.
    pub(super) fn read(bits: &mut Bits<'_>) -> Result<Option<Self>, Damage> {
        let count = bits.take(14) as usize;
        if count == 0 {
            return Ok(None);
        }
        let written = bits.take(5) as usize;
        let mut lengths = [0; LENGTH_SYMBOLS];
        for &symbol in ORDER.get(..written).ok_or("a code has too many lengths")? {
            lengths[symbol] = bits.take(3) as u8;
        }
        let of_lengths = Self::new(&lengths)?.ok_or("the code of code lengths has no symbols")?;
        let mut lengths: Vec<u8> = Vec::with_capacity(count);
        while lengths.len() < count {
            let last = || {
                lengths
                    .last()
                    .copied()
                    .filter(|&last| last > 0)
                    .ok_or("a code length is repeated before the first")
            };
            let (length, times) = match of_lengths.symbol(bits)? {
                length @ ..=16 => (length as u8, 1),
                17 => (0, bits.take(3) + 3),
                18 => (0, bits.take(7) + 11),
                19 => (last()?, bits.take(2) + 3),
                _ => (last()?, bits.take(7) + 7),
            };
            lengths.resize(lengths.len() + times as usize, length);
        }
        if lengths.len() > count {
            return Err("a code has more symbols than declared");
        }
        Self::new(&lengths)
    }

    /// Decodes the next symbol.
    ///
    /// # Errors
    /// If the bits are not a code.
    pub(super) fn symbol(&self, bits: &mut Bits<'_>) -> Result<u32, Damage> {
        let index = bits.peek() & ((1 << self.longest) - 1);
        match self.table.get(index as usize) {
            Some(&(symbol, length)) if length > 0 => {
                bits.taken += usize::from(length);
                Ok(u32::from(symbol))
            }
            _ => Err("the bits are not a code"),
        }
    }
}
