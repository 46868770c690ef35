//! Texel storage: 8-bit images stay bytes, four to a texel; others are 32-bit floats.
//!
//! A table of 256 numbers decodes the bytes, so that a byte gives exactly the value that decoding the whole image in
//! advance would give.

mod levels;

use super::encoding::{Encoding, Table};

/// An image of linear colours and optional alpha, row 0 on top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    /// The file that it was read from.
    pub name: String,
    /// Width: > 0.
    pub width: u32,
    /// Height: > 0.
    pub height: u32,
    texels: Texels,
    has_alpha: bool,
}

/// `width * height` texels, row by row.
#[derive(Clone, Debug, PartialEq)]
enum Texels {
    /// Red, green and blue, decoded by the table; alpha in units of 1/255.
    Bytes { texels: Vec<[u8; 4]>, table: Table },
    /// Linear Rec. 709; `alpha` is empty if the image is opaque.
    Floats { texels: Vec<[f32; 3]>, alpha: Vec<f32> },
}

/// Four texels, as an image stores them: fetched from memory before they are decoded, so that the waits of several fetches overlap.
#[derive(Clone, Copy, Debug)]
pub struct Quad(Stored);

#[derive(Clone, Copy, Debug)]
enum Stored {
    Bytes([[u8; 4]; 4]),
    Floats([[f32; 4]; 4]),
}

impl Quad {
    /// Four black texels without opacity, of any image.
    pub const BLACK: Self = Self(Stored::Bytes([[0; 4]; 4]));
}

impl Default for Texels {
    fn default() -> Self {
        Self::Floats { texels: Vec::new(), alpha: Vec::new() }
    }
}

impl Image {
    /// An image of `width * height` linear Rec. 709 colours, row by row from the top.
    ///
    /// # Panics
    /// If the number of texels differs.
    pub fn from_linear(name: impl Into<String>, width: u32, height: u32, texels: Vec<[f32; 3]>) -> Self {
        Self::from_linear_and_alpha(name, width, height, texels, Vec::new())
    }

    /// An image with alpha: one per texel, or none.
    ///
    /// # Panics
    /// If the number of texels differs.
    pub fn from_linear_and_alpha(
        name: impl Into<String>,
        width: u32,
        height: u32,
        texels: Vec<[f32; 3]>,
        mut alpha: Vec<f32>,
    ) -> Self {
        check(width, height, texels.len());
        let has_alpha = alpha.iter().any(|&alpha| alpha != 1.0);
        if has_alpha {
            check(width, height, alpha.len());
        } else {
            alpha = Vec::new();
        }
        Self { name: name.into(), width, height, texels: Texels::Floats { texels, alpha }, has_alpha }
    }

    /// An image of `width * height` texels of red, green, blue and alpha in bytes, row by row from the top.
    ///
    /// # Panics
    /// If the number of texels differs.
    pub fn from_bytes(
        name: impl Into<String>,
        width: u32,
        height: u32,
        texels: Vec<[u8; 4]>,
        encoding: Encoding<'_>,
    ) -> Self {
        check(width, height, texels.len());
        let has_alpha = texels.iter().any(|texel| texel[3] != 255);
        let texels = Texels::Bytes { texels, table: encoding.table() };
        Self { name: name.into(), width, height, texels, has_alpha }
    }

    /// Number of texels.
    pub fn len(&self) -> usize {
        match &self.texels {
            Texels::Bytes { texels, .. } => texels.len(),
            Texels::Floats { texels, .. } => texels.len(),
        }
    }

    /// Bytes of its texels.
    pub fn bytes(&self) -> u64 {
        let bytes = match &self.texels {
            Texels::Bytes { texels, .. } => size_of_val(&**texels),
            Texels::Floats { texels, alpha } => size_of_val(&**texels) + size_of_val(&**alpha),
        };
        bytes as u64
    }

    /// Whether the image has no texels.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether the image has an alpha channel.
    pub fn has_alpha(&self) -> bool {
        self.has_alpha
    }

    /// The linear Rec. 709 colour of a texel; indices go row by row.
    ///
    /// # Panics
    /// If there is no such texel.
    #[inline]
    pub fn texel(&self, index: usize) -> [f32; 3] {
        match &self.texels {
            Texels::Bytes { texels, table } => {
                let [r, g, b, _] = texels[index];
                [r, g, b].map(|byte| table[usize::from(byte)])
            }
            Texels::Floats { texels, .. } => texels[index],
        }
    }

    /// The four texels in two columns and two rows of the image, as they are stored: those of the first row, then those of the
    /// second.
    ///
    /// # Panics
    /// If they are beyond the last texel.
    #[inline(always)]
    pub fn quad(&self, [left, right]: [u32; 2], [top, bottom]: [u32; 2]) -> Quad {
        let width = self.width as usize;
        let [top, bottom] = [top as usize * width, bottom as usize * width];
        let (left, right) = (left as usize, right as usize);
        let [a, b, c, d] = [top + left, top + right, bottom + left, bottom + right];
        Quad(match &self.texels {
            Texels::Bytes { texels, .. } => Stored::Bytes([texels[a], texels[b], texels[c], texels[d]]),
            Texels::Floats { texels, alpha } => {
                let mut quad = [[1.0; 4]; 4];
                for (texel, index) in quad.iter_mut().zip([a, b, c, d]) {
                    [texel[0], texel[1], texel[2]] = texels[index];
                }
                if self.has_alpha {
                    for (texel, index) in quad.iter_mut().zip([a, b, c, d]) {
                        texel[3] = alpha[index];
                    }
                }
                Stored::Floats(quad)
            }
        })
    }

    /// The linear colours and opacities of four texels of this image.
    #[inline(always)]
    pub fn decoded(&self, quad: &Quad) -> [[f32; 4]; 4] {
        match (&quad.0, &self.texels) {
            (Stored::Bytes(quad), Texels::Bytes { table, .. }) => {
                let mut decoded = [[1.0; 4]; 4];
                for (texel, [r, g, b, _]) in decoded.iter_mut().zip(quad) {
                    *texel = [table[usize::from(*r)], table[usize::from(*g)], table[usize::from(*b)], 1.0];
                }
                if self.has_alpha {
                    for (texel, [.., alpha]) in decoded.iter_mut().zip(quad) {
                        texel[3] = f32::from(*alpha) / 255.0;
                    }
                }
                decoded
            }
            (Stored::Floats(quad), _) => *quad,
            (Stored::Bytes(_), Texels::Floats { .. }) => [[0.0; 4]; 4],
        }
    }

    /// The opacity of a texel; indices go row by row: 1 if the image has no alpha.
    ///
    /// # Panics
    /// If there is no such texel in an image with alpha.
    #[inline]
    pub fn alpha(&self, index: usize) -> f32 {
        if !self.has_alpha {
            return 1.0;
        }
        match &self.texels {
            Texels::Bytes { texels, .. } => f32::from(texels[index][3]) / 255.0,
            Texels::Floats { alpha, .. } => alpha[index],
        }
    }

    /// The colour and opacity of a texel; indices go row by row.
    ///
    /// # Panics
    /// If there is no such texel.
    #[inline]
    pub fn rgba(&self, index: usize) -> [f32; 4] {
        let [r, g, b] = self.texel(index);
        [r, g, b, self.alpha(index)]
    }

    /// All colours, row by row.
    pub fn texels(&self) -> impl ExactSizeIterator<Item = [f32; 3]> + '_ {
        (0..self.len()).map(|index| self.texel(index))
    }

    /// The mean of its linear colours.
    pub fn mean(&self) -> [f32; 3] {
        let mut sums = [0.0_f64; 3];
        for texel in self.texels() {
            sums.iter_mut().zip(texel).for_each(|(sum, channel)| *sum += f64::from(channel));
        }
        sums.map(|sum| (sum / self.len().max(1) as f64) as f32)
    }

    /// Red, green, blue and alpha of all texels, row by row, of an image that is stored in bytes.
    pub(crate) fn bytes_of_texels(&self) -> Option<&[[u8; 4]]> {
        match &self.texels {
            Texels::Bytes { texels, .. } => Some(texels),
            Texels::Floats { .. } => None,
        }
    }

    /// The linear value of a byte of a colour; `None` of an image that is stored in floats.
    pub(crate) fn decoded_byte(&self, byte: u8) -> Option<f32> {
        match &self.texels {
            Texels::Bytes { table, .. } => Some(table[usize::from(byte)]),
            Texels::Floats { .. } => None,
        }
    }

    /// Whether it has the size, the texels and the opacity of another image, bit by bit and stored alike. The name may differ.
    pub fn has_values_of(&self, other: &Self) -> bool {
        let bits = |values: &[f32]| -> Vec<u32> { values.iter().map(|value| value.to_bits()).collect() };
        let are_same = match (&self.texels, &other.texels) {
            (Texels::Bytes { texels: a, table: s }, Texels::Bytes { texels: b, table: t }) => {
                a == b && bits(&s[..]) == bits(&t[..])
            }
            (Texels::Floats { texels: a, alpha: s }, Texels::Floats { texels: b, alpha: t }) => {
                bits(a.as_flattened()) == bits(b.as_flattened()) && bits(s) == bits(t)
            }
            _ => false,
        };
        are_same && (self.width, self.height, self.has_alpha) == (other.width, other.height, other.has_alpha)
    }

    /// A copy of the image with other colours, each made of the linear one.
    pub fn with_colors(&self, color: impl Fn([f32; 3]) -> [f32; 3]) -> Self {
        let texels = self.texels().map(color).collect();
        let alpha =
            if self.has_alpha { (0..self.len()).map(|k| self.alpha(k)).collect() } else { Vec::new() };
        Self::from_linear_and_alpha(self.name.clone(), self.width, self.height, texels, alpha)
    }
}

fn check(width: u32, height: u32, count: usize) {
    assert_eq!(width as usize * height as usize, count, "texels of a picture of {width}×{height}");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::linear_from_srgb;

    #[test]
    fn a_byte_stands_for_exactly_the_number_that_it_encodes() {
        let bytes: Vec<[u8; 4]> = (0..=255).map(|k| [k, 255 - k, k ^ 0x55, k]).collect();
        let square = |x: f32| x * x;
        for encoding in [Encoding::Srgb, Encoding::Linear, Encoding::Curve(&square)] {
            let image = Image::from_bytes("", 16, 16, bytes.clone(), encoding);
            for (index, &[r, g, b, a]) in bytes.iter().enumerate() {
                let [r, g, b, a] = [r, g, b, a].map(|byte| f32::from(byte) / 255.0);
                let expected = match encoding {
                    Encoding::Srgb => [r, g, b].map(linear_from_srgb),
                    Encoding::Linear => [r, g, b],
                    Encoding::Curve(_) => [r, g, b].map(square),
                };
                assert_eq!((image.texel(index), image.alpha(index)), (expected, a), "{encoding:?}");
                assert_eq!(
                    image.decoded(&image.quad([index as u32 % 16; 2], [index as u32 / 16; 2])),
                    [[expected[0], expected[1], expected[2], a]; 4]
                );
            }
        }
    }

    #[test]
    fn opaque_pictures_have_no_alpha() {
        let opaque = Image::from_bytes("", 2, 1, vec![[1, 2, 3, 255]; 2], Encoding::Srgb);
        assert!(!opaque.has_alpha() && opaque.alpha(1) == 1.0);
        let clear = Image::from_linear_and_alpha("", 1, 2, vec![[0.5; 3]; 2], vec![1.0, 0.25]);
        assert!(clear.has_alpha());
        let tinted = clear.with_colors(|[r, g, _]| [2.0 * r, g, 0.0]);
        assert_eq!((tinted.texel(1), tinted.alpha(1), tinted.len()), ([1.0, 0.5, 0.0], 0.25, 2));
    }
}
