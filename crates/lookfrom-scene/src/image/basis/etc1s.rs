//! ETC1S: blocks of four colours that differ in brightness, as indices into codebooks of endpoints and selectors.

use super::codebook::{Codebook, Endpoint};
use super::huffman::Bits;
use super::{Damage, Size, Texel, blocks, lay};

/// The symbol for a run of equal predictors.
const REPEAT: u32 = 256;

/// The shortest runs, of predictors and of selectors.
const LEAST_RUN: u32 = 3;

/// The run length symbol after which the length follows as a number.
const LONG_RUN: u32 = 63;

/// Decodes a file's first image: `global` is the global data, `level` the first level, `images` the number of images.
///
/// # Errors
/// If it is damaged.
pub(in crate::image) fn etc1s(
    global: &[u8],
    level: &[u8],
    images: usize,
    size: Size,
) -> Result<Vec<Texel>, Damage> {
    let codebook = Codebook::read(global, images)?;
    // The descriptor of the first image: flags, then offset and length of its colour slice and of its alpha slice.
    let field = |index: usize| {
        let bytes = global.get(20 + 4 * index..)?.first_chunk()?;
        usize::try_from(u32::from_le_bytes(*bytes)).ok()
    };
    let slice = |index: usize| {
        let (offset, length) = (field(index)?, field(index + 1)?);
        level.get(offset..)?.get(..length)
    };
    let read = |index: usize| codebook.slice(slice(index).ok_or("a slice is cut off")?, size);
    let colors = read(1)?;
    let has_opacity = field(4).is_some_and(|length| length > 0);
    let opacities = if has_opacity { Some(read(3)?) } else { None };

    let [width, height] = size;
    let mut texels = vec![[0; 4]; width * height];
    let mut opacities = opacities.into_iter().flatten();
    let opaque = [[255; 4]; 16];
    let both = colors.into_iter().map(|color| {
        let opacity = opacities.next().map_or(opaque, |(endpoint, choices)| block(endpoint, choices));
        let mut block = block(color.0, color.1);
        for (texel, [_, opacity, ..]) in block.iter_mut().zip(opacity) {
            texel[3] = opacity;
        }
        block
    });
    lay(&mut texels, size, both);
    Ok(texels)
}

/// The texels of a block, from its endpoint and its selectors.
fn block(endpoint: Endpoint, choices: [u8; 4]) -> [Texel; 16] {
    let colors = endpoint.colors();
    std::array::from_fn(|index| {
        let [r, g, b] = colors[usize::from(choices[index / 4] >> (2 * (index % 4)) & 3)];
        [r, g, b, 255]
    })
}

/// Approximate move-to-front history of selectors: those used again move towards the front.
struct Recent {
    selectors: Vec<u32>,
    /// The index of the next insertion, in the second half.
    next: usize,
}

impl Recent {
    fn new(count: usize) -> Self {
        Self { selectors: vec![0; count], next: count / 2 }
    }

    fn add(&mut self, selector: u32) {
        let half = self.selectors.len() / 2;
        if let Some(entry) = self.selectors.get_mut(self.next) {
            *entry = selector;
        }
        self.next = if self.next + 1 < self.selectors.len() { self.next + 1 } else { half };
    }

    fn again(&mut self, index: usize) -> Option<u32> {
        let selector = self.selectors.get(index).copied()?;
        self.selectors.swap(index, index / 2);
        Some(selector)
    }
}

impl Codebook {
    /// The blocks of a slice, row by row: endpoint and selectors of each.
    fn slice(&self, bytes: &[u8], size: Size) -> Result<Vec<(Endpoint, [u8; 4])>, Damage> {
        let [columns, rows] = blocks(size);
        let bits = &mut Bits::new(bytes);
        let count = self.endpoints.len() as u32;
        let recent = Recent::new(self.codes.recent);
        let mut selectors = Selectors { recent, run: 0, blocks: columns as u64 * rows as u64 };
        let (mut predictors, mut repeats) = (0, 0_u32);
        // Endpoint indices of the row above and of this row, and predictors that were coded with the row above.
        let (mut above, mut row) = (vec![0; columns], Vec::with_capacity(columns));
        let mut told = vec![0; columns.div_ceil(2)];
        let mut last = 0;
        let mut found = Vec::new();
        for y in 0..rows {
            row.clear();
            let mut predictor = 0;
            for x in 0..columns {
                if x % 2 == 0 {
                    let told = &mut told[x / 2];
                    if y % 2 == 0 {
                        if repeats > 0 {
                            repeats -= 1;
                        } else {
                            match self.codes.predictors.symbol(bits)? {
                                REPEAT => repeats = bits.number(4).saturating_add(LEAST_RUN - 1),
                                symbol => predictors = symbol,
                            }
                        }
                        (predictor, *told) = (predictors, predictors >> 4);
                    } else {
                        predictor = *told;
                    }
                }
                let from_above = if y > 0 { Some(&above) } else { None };
                last = match predictor & 3 {
                    0 if x > 0 => last,
                    1 => *from_above
                        .ok_or("a block is predicted from outside its slice")?
                        .get(x)
                        .ok_or("a block is predicted from outside its slice")?,
                    2 if x > 0 => *from_above
                        .and_then(|above| above.get(x - 1))
                        .ok_or("a block is predicted from outside its slice")?,
                    3 => {
                        let endpoint = self.codes.endpoints.symbol(bits)? + last;
                        if endpoint >= count { endpoint - count } else { endpoint }
                    }
                    _ => return Err("a block is predicted from outside its slice"),
                };
                predictor >>= 2;
                row.push(last);
                let endpoint =
                    self.endpoints.get(last as usize).ok_or("an endpoint index is outside the codebook")?;
                let selector = selectors.next(self, bits)?;
                let choices = self
                    .selectors
                    .get(selector as usize)
                    .ok_or("a selector index is outside the codebook")?;
                found.push((*endpoint, *choices));
            }
            if bits.is_past_end() {
                return Err("a slice ends too early");
            }
            std::mem::swap(&mut above, &mut row);
        }
        Ok(found)
    }
}

/// Decoder of a slice's selectors, block after block.
struct Selectors {
    recent: Recent,
    /// Remaining run length of the first selector of the history.
    run: u32,
    /// Number of blocks of the slice.
    blocks: u64,
}

impl Selectors {
    fn next(&mut self, codebook: &Codebook, bits: &mut Bits<'_>) -> Result<u32, Damage> {
        let (codes, count) = (&codebook.codes, codebook.selectors.len() as u32);
        let mut index = 0;
        if self.run > 0 {
            self.run -= 1;
        } else {
            let symbol = codes.selectors.symbol(bits)?;
            if symbol < count {
                self.recent.add(symbol);
                return Ok(symbol);
            }
            index = (symbol - count) as usize;
            if index == codes.recent {
                let run = match codes.runs.symbol(bits)? {
                    LONG_RUN => bits.number(7),
                    run => run,
                };
                (self.run, index) = (run.saturating_add(LEAST_RUN - 1), 0);
                if u64::from(self.run) >= self.blocks {
                    return Err("a run is longer than its slice");
                }
            }
        }
        self.recent.again(index).ok_or("a selector index is outside the history")
    }
}
