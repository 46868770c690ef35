//! Global data of BasisLZ: codebooks of endpoints and selectors, and the Huffman tables of the slices.

use super::Damage;
use super::huffman::{Bits, Code};

/// The modifiers of a block's colour for each of the four selectors, by its intensity (ETC1).
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

/// The colours that a block chooses from.
#[derive(Clone, Copy)]
pub(super) struct Endpoint {
    /// Red, green, blue in 5 bits.
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
    /// A byte for each row of a block, two bits for each texel, the leftmost in the least.
    pub(super) selectors: Vec<[u8; 4]>,
    pub(super) codes: Codes,
}

/// The codes that slices are written in.
pub(super) struct Codes {
    /// The endpoint predictors of four blocks.
    pub(super) predictors: Code,
    /// The delta of an endpoint index from the one before.
    pub(super) endpoints: Code,
    /// Numbers of selectors, places in the list of recent ones, and a run of the first of these.
    pub(super) selectors: Code,
    /// Lengths of such runs.
    pub(super) runs: Code,
    /// The length of the selector history: > 0.
    pub(super) recent: usize,
}

impl Codebook {
    /// Reads what all slices share, from a file's supercompression global data; `images` is the number of its pictures.
    ///
    /// # Errors
    /// If it is not whole.
    pub(super) fn read(global: &[u8], images: usize) -> Result<Self, Damage> {
        let short = "what its slices share is cut off";
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
        return Err("its selectors are of a kind that the format has given up");
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
        0 => Err("it has no room for recent selectors"),
        _ => Ok(Codes { predictors, endpoints, selectors, runs, recent }),
    }
}
