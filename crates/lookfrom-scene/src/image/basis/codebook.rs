//! Global data of BasisLZ: codebooks of endpoints and selectors, and the Huffman tables of the slices.

use super::Damage;
use super::huffman::{Bits, Code};

/// The intensity modifiers of the four selectors, by the block's intensity table (ETC1).
const MODIFIERS: [[i32; 4]; 8] = [
    [-8, -2, 2, 8],
    [-17, -5, 5, 17],
    [-29, -9, 9, 29],
    [-42, -13, 13, 42],
    [-60, -18, 18, 60],
    [-80, -24, 24, 80],
    [-106, -33, 33, 106],
    [-183, -47, 47, 183],
];

/// An endpoint of the codebook: the base colour and intensity table of a block.
#[derive(Clone, Copy)]
pub(super) struct Endpoint {
    /// Red, green, blue in 5 bits each.
    color: [u8; 3],
    /// 0 … 7.
    intensity: u8,
}

impl Endpoint {
    /// The four colours.
    pub(super) fn colors(self) -> [[u8; 3]; 4] {
        let base = self.color.map(|channel| i32::from(channel << 3 | channel >> 2));
        let modifiers = MODIFIERS[usize::from(self.intensity & 7)];
        modifiers.map(|modifier| base.map(|channel| (channel + modifier).clamp(0, 255) as u8))
    }
}

/// The data that all slices share.
pub(super) struct Codebook {
    pub(super) endpoints: Vec<Endpoint>,
    /// A byte for each row of a block, two bits per texel, the leftmost in the lowest bits.
    pub(super) selectors: Vec<[u8; 4]>,
    pub(super) codes: Codes,
}

/// The Huffman codes of the slices.
pub(super) struct Codes {
    /// The endpoint predictors of four blocks.
    pub(super) predictors: Code,
    /// The delta from the previous endpoint index.
    pub(super) endpoints: Code,
    /// Selector indices, indices into the history of recent selectors, and the symbol for a run of its first entry.
    pub(super) selectors: Code,
    /// Lengths of these runs.
    pub(super) runs: Code,
    /// Length of the selector history: > 0.
    pub(super) recent: usize,
}

impl Codebook {
    /// Reads a file's supercompression global data; `images` is the number of its images.
    ///
    /// # Errors
    /// If it is damaged or cut off.
    pub(super) fn read(global: &[u8], images: usize) -> Result<Self, Damage> {
        let short = "its global data is cut off";
        let number = |offset: usize, bytes: usize| {
            let bytes = global.get(offset..offset + bytes).ok_or(short)?;
            Ok::<_, Damage>(bytes.iter().rev().fold(0, |number, &byte| number << 8 | usize::from(byte)))
        };
        let mut rest =
            images.checked_mul(20).and_then(|length| global.get(20..)?.get(length..)).ok_or(short)?;
        let mut part = |length: usize| {
            let (part, after) = rest.split_at_checked(length).ok_or(short)?;
            rest = after;
            Ok::<_, Damage>(part)
        };
        let endpoints = endpoints(part(number(4, 4)?)?, number(0, 2)?)?;
        let selectors = selectors(part(number(8, 4)?)?, number(2, 2)?)?;
        Ok(Self { endpoints, selectors, codes: codes(part(number(12, 4)?)?)? })
    }
}

fn endpoints(bytes: &[u8], count: usize) -> Result<Vec<Endpoint>, Damage> {
    let bits = &mut Bits::new(bytes);
    let mut code = || Code::read(bits)?.ok_or("a code of its endpoints has no symbols");
    let by_level = [code()?, code()?, code()?];
    let intensities = code()?;
    let is_gray = bits.take(1) == 1;
    let mut last = Endpoint { color: [16; 3], intensity: 0 };
    let mut endpoints = Vec::with_capacity(count);
    for _ in 0..count {
        last.intensity = (intensities.symbol(bits)? as u8).wrapping_add(last.intensity) & 7;
        for channel in last.color.iter_mut().take(if is_gray { 1 } else { 3 }) {
            let code = match *channel {
                ..=9 => &by_level[0],
                10..=21 => &by_level[1],
                _ => &by_level[2],
            };
            *channel = (code.symbol(bits)? as u8).wrapping_add(*channel) & 31;
        }
        let [red, ..] = last.color;
        endpoints.push(if is_gray { Endpoint { color: [red; 3], ..last } } else { last });
    }
    if bits.is_past_end() { Err("its endpoints are cut off") } else { Ok(endpoints) }
}

fn selectors(bytes: &[u8], count: usize) -> Result<Vec<[u8; 4]>, Damage> {
    let bits = &mut Bits::new(bytes);
    if bits.take(2) != 0 {
        return Err("its selectors use a deprecated encoding");
    }
    let is_raw = bits.take(1) == 1;
    let code = if is_raw { None } else { Code::read(bits)? };
    let mut last = [0; 4];
    let mut selectors = Vec::with_capacity(count);
    for index in 0..count {
        for row in &mut last {
            *row = match &code {
                _ if is_raw || index == 0 => bits.take(8) as u8,
                Some(code) => *row ^ code.symbol(bits)? as u8,
                None => return Err("the code of its selectors has no symbols"),
            };
        }
        selectors.push(last);
    }
    if bits.is_past_end() { Err("its selectors are cut off") } else { Ok(selectors) }
}

fn codes(bytes: &[u8]) -> Result<Codes, Damage> {
    let bits = &mut Bits::new(bytes);
    let mut code = || Code::read(bits)?.ok_or("a code of its slices has no symbols");
    let (predictors, endpoints, selectors, runs) = (code()?, code()?, code()?, code()?);
    let recent = bits.take(13) as usize;
    match recent {
        _ if bits.is_past_end() => Err("the codes of its slices are cut off"),
        0 => Err("the length of its selector history is 0"),
        _ => Ok(Codes { predictors, endpoints, selectors, runs, recent }),
    }
}
