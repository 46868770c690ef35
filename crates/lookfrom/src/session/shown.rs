//! Pictures as a screen shows them: cells of contact sheets, and frames of animations.

use lookfrom_scene::image::{
    Animation, Pixels, encode_jpeg, encode_png_of, encode_ppm, encode_webp, without_alpha,
};
use lookfrom_scene::settings::Background;
use lookfrom_scene::{Error, Location, Result};

use super::encode::behind;
use super::{Developed, Development, Format, options};
use crate::film::Picture;
use crate::post::develop::{srgb8_before, srgba8};

/// A picture after exposure and tone map, in 8-bit sRGB.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shown {
    /// Pixels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green, blue and straight alpha of each pixel, row by row from the top left.
    pub rgba: Vec<u8>,
    /// Whether any pixel may be transparent.
    pub has_alpha: bool,
}

impl Developed {
    /// The picture as a screen shows it.
    pub fn shown(&self) -> Shown {
        Shown::new(&self.picture, &self.development)
    }
}

impl Shown {
    pub(super) fn new(picture: &Picture, development: &Development) -> Self {
        let &Development { exposure, tonemap, background, .. } = development;
        let has_alpha = background == Background::Transparent;
        let rgba = match has_alpha {
            true => srgba8(picture, exposure, tonemap),
            false => srgb8_before(picture, behind(background), exposure, tonemap)
                .chunks_exact(3)
                .flat_map(|rgb| [rgb[0], rgb[1], rgb[2], 255])
                .collect(),
        };
        Self { width: picture.width, height: picture.height, rgba, has_alpha }
    }

    /// The bytes of a file.
    ///
    /// # Errors
    /// `Request` for a format of linear light or of 16 bits, and for one without alpha where this has alpha; `Invalid` where the format cannot hold so many pixels.
    pub fn encode(&self, format: Format) -> Result<Vec<u8>> {
        let size = [self.width, self.height];
        let rgb = || without_alpha(&self.rgba);
        if self.has_alpha {
            format.check_background(Background::Transparent)?;
        }
        match format {
            Format::Png if self.has_alpha => encode_png_of(size, Pixels::Rgba8(&self.rgba), None),
            Format::Png => encode_png_of(size, Pixels::Rgb8(&rgb()), None),
            Format::WebP if self.has_alpha => encode_webp(size, Pixels::Rgba8(&self.rgba), None),
            Format::WebP => encode_webp(size, Pixels::Rgb8(&rgb()), None),
            Format::Jpeg(quality) => encode_jpeg(size, &rgb(), quality, None),
            Format::Ppm => encode_ppm(self.width, self.height, &rgb()),
            Format::Gif | Format::Apng => {
                let mut alone = Animation::new(format.animation()?, size, 1.0, self.has_alpha)?;
                alone.add(&self.rgba)?;
                alone.finish()
            }
            Format::Png16 | Format::Exr | Format::Exr16 | Format::Hdr | Format::Pfm => {
                Err(options::unsuitable(
                    "sheets and animations have 8 bits a channel, for a screen: PNG, JPEG, WebP, PPM or GIF"
                        .to_owned(),
                ))
            }
        }
    }
}

/// A contact sheet: pictures in rows, each in the middle of a cell as large as the largest.
#[derive(Clone, Debug)]
pub struct Sheet {
    columns: u32,
    rows: u32,
    cells: Vec<Option<Shown>>,
}

impl Sheet {
    /// A sheet without pictures; at least one column and row.
    pub fn new(columns: u32, rows: u32) -> Self {
        Self { columns: columns.max(1), rows: rows.max(1), cells: Vec::new() }
    }

    /// Fills the next cell, row by row from the top left; `None` leaves it empty. Those beyond the last are not shown.
    pub fn add(&mut self, picture: Option<Shown>) {
        self.cells.push(picture);
    }

    /// The sheet: transparent between the pictures if one of them is, and else white.
    ///
    /// # Errors
    /// `Invalid` without pictures, or where they are too large for one.
    pub fn shown(&self) -> Result<Shown> {
        let pictures = || self.cells.iter().flatten();
        let most = |side: fn(&Shown) -> u32| pictures().map(side).max().unwrap_or(0);
        let [cell_width, cell_height] = [most(|shown| shown.width), most(|shown| shown.height)];
        let sides = self.columns.checked_mul(cell_width).zip(self.rows.checked_mul(cell_height));
        let invalid = |message: &str| Error::invalid(&Location::default(), message);
        let (width, height) = sides.ok_or_else(|| invalid("a sheet of too many pixels"))?;
        if width == 0 || height == 0 {
            return Err(invalid("a sheet without pictures"));
        }
        let bytes = u64::from(width) * u64::from(height) * 4;
        if bytes > MOST_BYTES {
            return Err(
                invalid("a sheet of too many pixels").hint("make it of smaller pictures, or of fewer")
            );
        }
        let has_alpha = pictures().any(|picture| picture.has_alpha);
        let between = if has_alpha { [255, 255, 255, 0] } else { [255; 4] };
        let mut rgba = between.repeat(bytes as usize / 4);
        let cells = self.columns as usize * self.rows as usize;
        for (index, picture) in self.cells.iter().take(cells).enumerate() {
            let Some(picture) = picture else { continue };
            let [column, row] = [index as u32 % self.columns, index as u32 / self.columns];
            let left = column * cell_width + (cell_width - picture.width) / 2;
            let top = row * cell_height + (cell_height - picture.height) / 2;
            for (y, line) in picture.rgba.chunks_exact(4 * picture.width as usize).enumerate() {
                let start = 4 * ((top as usize + y) * width as usize + left as usize);
                rgba[start..start + line.len()].copy_from_slice(line);
            }
        }
        Ok(Shown { width, height, rgba, has_alpha })
    }
}

/// The most bytes of a sheet in memory.
const MOST_BYTES: u64 = 4 << 30;

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(width: u32, height: u32, rgba: [u8; 4]) -> Shown {
        let count = width as usize * height as usize;
        Shown { width, height, rgba: rgba.repeat(count), has_alpha: rgba[3] < 255 }
    }

    #[test]
    fn cells_are_filled_row_by_row() {
        let mut sheet = Sheet::new(2, 2);
        sheet.add(Some(plain(2, 2, [9, 9, 9, 255])));
        sheet.add(None);
        sheet.add(Some(plain(4, 2, [5, 5, 5, 255])));
        let Shown { width, height, rgba, has_alpha } = sheet.shown().unwrap();
        assert_eq!((width, height, has_alpha), (8, 4, false));
        let reds: Vec<u8> = rgba.chunks(4).map(|pixel| pixel[0]).collect();
        let first = [255, 9, 9, 255, 255, 255, 255, 255];
        let second = [5, 5, 5, 5, 255, 255, 255, 255];
        assert_eq!(reds, [first, first, second, second].concat());
        assert!(Sheet::new(3, 1).shown().is_err());
        let mut huge = Sheet::new(1 << 20, 1 << 20);
        huge.add(Some(plain(8, 8, [0; 4])));
        assert!(huge.shown().is_err());
    }
}
