//! Decoders for the Basis Universal formats of KTX 2 files, ETC1S in BasisLZ and UASTC, to 8-bit RGBA.
//!
//! Arbitrary bytes give texels or a [`Damage`]: codes and indices are looked up with `get`, bit counts come from tables
//! here. Khronos, "KTX File Format Specification", version 2.0 (2021), sections on BasisLZ; Binomial, "UASTC LDR 4x4
//! Texture Specification" (2020). ETC1S, BasisLZ and UASTC are by Rich Geldreich and Stephanie Hurlburt.

mod codebook;
mod etc1s;
mod huffman;
mod uastc;

pub(super) use self::etc1s::etc1s;
pub(super) use self::uastc::{BLOCK, uastc};

/// A description of the damage to a file.
pub(super) type Damage = &'static str;

/// Width and height.
pub(super) type Size = [usize; 2];

/// Red, green, blue, alpha.
type Texel = [u8; 4];

/// The number of columns and rows of blocks that cover an image.
fn blocks(size: Size) -> Size {
    size.map(|length| length.div_ceil(4))
}

/// Copies 4 × 4 blocks to their places, row by row from the top; texels beyond the image are dropped.
fn lay<const N: usize>(
    texels: &mut [[u8; N]],
    [width, _]: Size,
    blocks: impl Iterator<Item = [[u8; N]; 16]>,
) {
    let mut blocks = blocks;
    for rows in texels.chunks_mut(4 * width) {
        for column in 0..width.div_ceil(4) {
            let Some(block) = blocks.next() else { return };
            for (row, from) in rows.chunks_mut(width).zip(block.as_chunks::<4>().0) {
                row.iter_mut().skip(4 * column).zip(from).for_each(|(to, from)| *to = *from);
            }
        }
    }
}

#[cfg(test)]
mod tests;
