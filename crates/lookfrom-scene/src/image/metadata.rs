//! Metadata of picture files: the software and its settings (Exif 2.32), and sRGB as the colour space (an ICC profile).

use ::image::{ImageEncoder, ImageError, ImageResult};
use moxcms::ColorProfile;

/// The metadata of a picture.
#[derive(Clone, Debug)]
pub struct Metadata {
    exif: Vec<u8>,
    icc_profile: Vec<u8>,
}

impl Metadata {
    /// Metadata of a picture made by a program, from a text with its settings. The same texts give the same bytes.
    pub fn new(software: &str, description: &str) -> Self {
        Self { exif: exif(software, description), icc_profile: srgb_profile() }
    }

    /// Hands it to an encoder.
    pub(super) fn tell(metadata: Option<&Self>, encoder: &mut impl ImageEncoder) -> ImageResult<()> {
        if let Some(Self { exif, icc_profile }) = metadata {
            encoder.set_exif_metadata(exif.clone()).map_err(ImageError::Unsupported)?;
            encoder.set_icc_profile(icc_profile.clone()).map_err(ImageError::Unsupported)?;
        }
        Ok(())
    }
}

/// The ICC profile of sRGB, dated as the standard is, so that it is always the same.
fn srgb_profile() -> Vec<u8> {
    /// Bytes of the date in the header (ICC.1:2022, 7.2.10): year, month, day, hours, minutes, seconds.
    const DATE: std::ops::Range<usize> = 24..36;
    // Without a profile a picture is sRGB as well.
    let mut profile = ColorProfile::new_srgb().encode().unwrap_or_default();
    if let Some(date) = profile.get_mut(DATE) {
        date.copy_from_slice(&[7, 207, 0, 10, 0, 18, 0, 0, 0, 0, 0, 0]);
    }
    profile
}

/// A field of a directory: its tag, type and count, and its value or where that is.
type Field = (u16, u16, u32, u32);

/// Types of fields (TIFF 6.0).
const ASCII: u16 = 2;
const SHORT: u16 = 3;
const LONG: u16 = 4;

/// The Exif of a picture in sRGB: a TIFF file without pixels.
fn exif(software: &str, description: &str) -> Vec<u8> {
    const HEADER: u32 = 8;
    /// Number of fields of the first directory.
    const FIELDS: u32 = 3;
    /// Longest text, so that all fit into a segment of a JPEG.
    const LONGEST: usize = 30_000;
    let texts = [description, software].map(|text| terminated(text, LONGEST));
    // The first directory, its texts, and the second directory.
    let first_text = HEADER + 2 + 12 * FIELDS + 4;
    let second_text = first_text + texts[0].len() as u32;
    let second = second_text + texts[1].len() as u32;
    let mut bytes = b"II*\0".to_vec();
    bytes.extend(HEADER.to_le_bytes());
    let first: [Field; FIELDS as usize] = [
        (0x010e, ASCII, texts[0].len() as u32, first_text),
        (0x0131, ASCII, texts[1].len() as u32, second_text),
        (0x8769, LONG, 1, second),
    ];
    directory(&mut bytes, &first);
    texts.iter().for_each(|text| bytes.extend(text));
    // The colour space: sRGB.
    directory(&mut bytes, &[(0xa001, SHORT, 1, 1)]);
    bytes
}

/// Adds a directory that is the last of its chain.
fn directory(bytes: &mut Vec<u8>, fields: &[Field]) {
    bytes.extend((fields.len() as u16).to_le_bytes());
    for (tag, kind, count, value) in fields {
        bytes.extend(tag.to_le_bytes());
        bytes.extend(kind.to_le_bytes());
        bytes.extend(count.to_le_bytes());
        bytes.extend(value.to_le_bytes());
    }
    bytes.extend([0; 4]);
}

/// A text with the NUL at its end: of even length, and longer than the four bytes that would be held in the field itself.
fn terminated(text: &str, longest: usize) -> Vec<u8> {
    let mut bytes: Vec<u8> = text.bytes().filter(|byte| *byte != 0).take(longest).collect();
    bytes.push(0);
    while bytes.len() < 6 || !bytes.len().is_multiple_of(2) {
        bytes.push(0);
    }
    bytes
}
