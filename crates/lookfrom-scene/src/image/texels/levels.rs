//! The levels of MIP maps (Williams 1983): an image at half its size, and half of that, down to one texel.
//!
//! Each texel is the mean of the image over its area, also where a size is odd: then three texels of the finer level share its width (Guthe &
//! Heckbert 2005, "Non-power-of-two mipmap creation"). So every level has the mean of the image. Levels are stored as the image is: bytes
//! are rounded to the nearest one in linear light.

use super::{Image, Texels};

impl Image {
    /// The coarser levels of this image's MIP map, the finest first; none for an image of one texel.
    pub fn coarser_levels(&self) -> Vec<Self> {
        let mut levels: Vec<Self> = Vec::new();
        while let Some(level) = levels.last().unwrap_or(self).halved() {
            levels.push(level);
        }
        levels
    }

    /// Widths and heights of all [`Image::coarser_levels`].
    pub fn sizes_of_levels(&self) -> impl Iterator<Item = [u32; 2]> {
        let next = |size: [u32; 2]| (size.into_iter().max() > Some(1)).then(|| size.map(half));
        std::iter::successors(next([self.width, self.height]), move |size| next(*size))
    }

    /// Bytes of all [`Image::coarser_levels`].
    pub fn bytes_of_levels(&self) -> u64 {
        let texels: u64 =
            self.sizes_of_levels().map(|size| size.map(u64::from).iter().product::<u64>()).sum();
        self.bytes() / self.len().max(1) as u64 * texels
    }

    /// The image at half its size, rounded down, but at least 1; `None` for one texel.
    fn halved(&self) -> Option<Self> {
        if self.len() <= 1 {
            return None;
        }
        let [width, height] = [self.width, self.height].map(half);
        let columns: Vec<Share> = (0..width).map(|column| Share::new(column, self.width)).collect();
        let mean_at = |row: u32, columns: &Share| {
            let rows = Share::new(row, self.height);
            let mut mean = [0.0; 4];
            for (y, by_row) in rows.texels() {
                for (x, by_column) in columns.texels() {
                    let index = y as usize * self.width as usize + x as usize;
                    for (sum, value) in mean.iter_mut().zip(self.rgba(index)) {
                        *sum += by_row * by_column * value;
                    }
                }
            }
            mean
        };
        let means = (0..height).flat_map(|row| columns.iter().map(move |share| (row, share)));
        let means = means.map(|(row, share)| mean_at(row, share));
        let texels = match &self.texels {
            Texels::Bytes { table, .. } => {
                let texels = means.map(|[r, g, b, alpha]| {
                    let [r, g, b] = [r, g, b].map(|value| nearest_byte(&table[..], value));
                    [r, g, b, (255.0 * alpha + 0.5) as u8]
                });
                Texels::Bytes { texels: texels.collect(), table: table.clone() }
            }
            Texels::Floats { alpha, .. } => {
                let is_opaque = alpha.is_empty();
                let (texels, alpha) = means.map(|[r, g, b, alpha]| ([r, g, b], alpha)).unzip();
                Texels::Floats { texels, alpha: if is_opaque { Vec::new() } else { alpha } }
            }
        };
        Some(Self { name: self.name.clone(), width, height, texels, has_alpha: self.has_alpha })
    }
}

/// The size of the next level.
fn half(size: u32) -> u32 {
    (size / 2).max(1)
}

/// The texels along an axis that a texel of the next level covers, and their shares of it.
struct Share {
    first: u32,
    shares: [f32; 3],
}

impl Share {
    /// The shares of a texel of the level that is half as wide as `size` texels.
    fn new(index: u32, size: u32) -> Self {
        let half = size / 2;
        match (half, size % 2) {
            (0, _) => Self { first: 0, shares: [1.0, 0.0, 0.0] },
            (_, 0) => Self { first: 2 * index, shares: [0.5, 0.5, 0.0] },
            _ => {
                let shares = [half - index, half, index + 1].map(|part| part as f32 / size as f32);
                Self { first: 2 * index, shares }
            }
        }
    }

    fn texels(&self) -> impl Iterator<Item = (u32, f32)> {
        (self.first..).zip(self.shares).filter(|(_, share)| *share > 0.0)
    }
}

/// The byte whose value in an ascending table is nearest.
fn nearest_byte(table: &[f32], value: f32) -> u8 {
    let above = table.partition_point(|known| *known < value).min(table.len() - 1);
    let below = above.saturating_sub(1);
    (if value - table[below] < table[above] - value { below } else { above }) as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Encoding;

    /// A number in 0 … 1 that looks random.
    fn number(seed: u32) -> f32 {
        let bits = seed.wrapping_mul(0x9e37_79b9) ^ 0x85eb_ca6b;
        (bits.wrapping_mul(bits | 1) >> 8) as f32 / 16_777_216.0
    }

    fn mean(image: &Image) -> [f64; 4] {
        let mut sums = [0.0; 4];
        for index in 0..image.len() {
            let [r, g, b] = image.texel(index);
            for (sum, value) in sums.iter_mut().zip([r, g, b, image.alpha(index)]) {
                *sum += f64::from(value) / image.len() as f64;
            }
        }
        sums
    }

    #[test]
    fn every_level_has_the_mean_of_the_image() {
        for (width, height) in [(1, 1), (1, 17), (64, 64), (37, 5), (100, 3), (127, 129), (2, 1), (3, 3)] {
            let count = width * height;
            let texels: Vec<_> = (0..count).map(|k| [0, 1, 2].map(|c| 5.0 * number(3 * k + c))).collect();
            let alpha = (0..count).map(|k| number(k + 7)).collect();
            let image = Image::from_linear_and_alpha("", width, height, texels, alpha);
            let (levels, expected) = (image.coarser_levels(), mean(&image));
            assert_eq!(levels.len() as u32, width.max(height).ilog2(), "{width}×{height}");
            for level in &levels {
                for (found, expected) in mean(level).into_iter().zip(expected) {
                    assert!((found - expected).abs() < 1e-5, "{found} of {expected}, {width}×{height}");
                }
            }
            let sizes = levels.iter().map(|level| [level.width, level.height]);
            assert!(sizes.eq(image.sizes_of_levels()), "{width}×{height}");
            let bytes: u64 = levels.iter().map(Image::bytes).sum();
            assert_eq!(bytes, image.bytes_of_levels(), "{width}×{height}");
        }
    }

    #[test]
    fn texels_are_means_of_areas() {
        let (width, height) = (7, 5);
        let texels: Vec<_> = (0..35).map(|k| [number(k), 0.0, k as f32]).collect();
        let image = Image::from_linear("", width, height, texels);
        let level = image.halved().expect("it has more than one texel");
        assert_eq!([level.width, level.height], [3, 2]);
        // The slow way: the image on a grid so fine that both are whole numbers of its cells.
        let (fine_width, fine_height) = (7 * 3, 5 * 2);
        for (x, y) in (0..3).flat_map(|x| (0..2).map(move |y| (x, y))) {
            let mut sum = [0.0_f64; 3];
            for (i, j) in (7 * x..7 * (x + 1)).flat_map(|i| (5 * y..5 * (y + 1)).map(move |j| (i, j))) {
                let texel = image.texel((j * height / fine_height * width + i * width / fine_width) as usize);
                sum.iter_mut().zip(texel).for_each(|(sum, value)| *sum += f64::from(value) / 35.0);
            }
            for (found, expected) in level.texel((3 * y + x) as usize).into_iter().zip(sum) {
                assert!((f64::from(found) - expected).abs() < 1e-5, "{found} {expected} at {x}, {y}");
            }
        }
    }

    #[test]
    fn bytes_stay_bytes() {
        let texels: Vec<[u8; 4]> =
            (0..64 * 64_u32).map(|k| [0, 1, 2, 3].map(|c| (k * (c + 3)) as u8)).collect();
        for encoding in [Encoding::Srgb, Encoding::Linear, Encoding::Curve(&|x| x * x)] {
            let image = Image::from_bytes("", 64, 64, texels.clone(), encoding);
            let levels = image.coarser_levels();
            assert_eq!(levels.iter().map(Image::bytes).sum::<u64>(), 4 * (1024 + 256 + 64 + 16 + 4 + 1));
            for (found, expected) in mean(&levels[5]).into_iter().zip(mean(&image)) {
                assert!((found - expected).abs() < 0.006, "{found} of {expected}, {encoding:?}");
            }
        }
        // Even pictures stay as they are.
        for byte in [0, 1, 17, 254, 255] {
            let image = Image::from_bytes("", 3, 9, vec![[byte; 4]; 27], Encoding::Srgb);
            for level in image.coarser_levels() {
                assert_eq!((level.texel(0), level.alpha(0)), (image.texel(0), image.alpha(0)), "{byte}");
            }
        }
    }
}
