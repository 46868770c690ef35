//! TIFF (Adobe's TIFF 6.0, 1992; BigTIFF): grey, colours, CMYK and Y′CbCr, of integers and of floats, as pictures of the crate `image`. Its own
//! reader has no floats of one channel, as which heights and displacements are stored.

use std::array;
use std::io::{Cursor, Read, Seek};
use std::panic::{AssertUnwindSafe, catch_unwind};

use ::image::{DynamicImage, ImageBuffer, Rgb, Rgba};
use ::tiff::decoder::{ChunkType, Decoder, DecodingResult, Limits};
use ::tiff::tags::Tag;
use ::tiff::{ColorType, TiffError};

use super::read::{KNOWN, WHOLE, check_size, room};
use crate::budget::Reservation;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::LoadContext;
use crate::plural::counted;

/// GDAL's tag: as text, the value of texels where nothing was measured.
const NO_DATA: Tag = Tag::Unknown(42113);

/// Whether these are the first bytes of a TIFF file.
pub(super) fn is(bytes: &[u8]) -> bool {
    [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"].iter().any(|mark| bytes.starts_with(*mark))
}

/// The first picture. The decoder asserts what it should check: that is damage, too.
///
/// # Errors
/// As [`read`](super::read()).
pub(super) fn decode(
    bytes: &[u8],
    at: &Location,
    context: &mut LoadContext<'_>,
) -> Result<(DynamicImage, Reservation)> {
    catch_unwind(AssertUnwindSafe(|| first(bytes, at, context)))
        .unwrap_or_else(|_| Err(Error::syntax(at, "not a complete picture").hint(WHOLE)))
}

/// The first picture. Signed integers and those of 32 and 64 bits become floats: signed ones are the numbers themselves, others in
/// [0, 1]. Floats and signed numbers where nothing was measured (GDAL) become the least of the others, with a warning.
fn first(bytes: &[u8], at: &Location, context: &mut LoadContext<'_>) -> Result<(DynamicImage, Reservation)> {
    let unsupported = |what: &str| {
        Error::new(ErrorKind::Unsupported, at, format!("a kind of TIFF that is not read: {what}"))
            .hint(format!("save it in grey or RGB, or as another of {KNOWN}"))
    };
    let fault = |error: TiffError| match error {
        TiffError::UnsupportedError(what) => unsupported(&what.to_string()),
        TiffError::LimitsExceeded => {
            Error::new(ErrorKind::Limit, at, "needs more memory than its texels").hint(WHOLE)
        }
        error => Error::syntax(at, format!("not a complete picture: {error}")).hint(WHOLE),
    };

    // Memory for samples as they are, as floats, and for the picture, before anything is decoded.
    let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(fault)?;
    let (width, height) = decoder.dimensions().map_err(fault)?;
    check_size(width.into(), height.into(), at, &context.limits)?;
    let color = decoder.colortype().map_err(fault)?;
    let layout = decoder.image_buffer_layout().map_err(fault)?;
    let is_planar = layout.planes > 1;
    // Of which the decoder cuts the lowest row of tiles in the first plane only (version 0.11.3).
    if is_planar && decoder.get_chunk_type() == ChunkType::Tile && height % decoder.chunk_dimensions().1 != 0
    {
        return Err(unsupported("planes of tiles that do not fill them"));
    }
    let bytes_of_texel = layout.complete_len.div_ceil(width as usize * height as usize);
    let converted = bytes_of_texel + 4 * usize::from(color.num_samples()) + 16;
    let memory = room([width, height], (bytes_of_texel + converted) as u64, at, context)?;
    let mut limits = Limits::default();
    limits.decoding_buffer_size = layout.complete_len;
    limits.intermediate_buffer_size = layout.complete_len.saturating_add(64 << 20);
    let mut decoder = decoder.with_limits(limits);

    let mut samples = DecodingResult::U8(Vec::new());
    decoder.read_image_to_buffer(&mut samples).map_err(fault)?;
    let stored = Stored { width, height, color, is_planar, has_alpha: has_alpha(&mut decoder) };
    let picture = match samples {
        DecodingResult::U8(samples) if color.bit_depth() < 8 => stored.unpacked(&samples),
        DecodingResult::U8(samples) => stored.picture(&samples),
        DecodingResult::U16(samples) if color.bit_depth() == 16 => stored.picture(&samples),
        DecodingResult::U16(_) => None,
        samples => {
            let mut floats = floats_of(samples);
            let filled = no_data(&mut decoder).and_then(|value| fill(&mut floats, value));
            if let Some((count, least)) = filled {
                let values = counted(count, "value");
                context
                    .warn(at, format!("{values} without data: {least}, the least of the others, is there"));
            }
            stored.picture(&floats)
        }
    };
    picture.map(|picture| (picture, memory)).ok_or_else(|| unsupported(&format!("{color:?}")))
}

/// Whether the first channel beyond the colour is the opacity. Damage was found before.
fn has_alpha<R: Read + Seek>(decoder: &mut Decoder<R>) -> bool {
    const OPACITIES: [u16; 2] = [1, 2];
    let extra = decoder.find_tag_unsigned_vec::<u16>(Tag::ExtraSamples).ok().flatten();
    extra.and_then(|extra| extra.first().copied()).is_some_and(|first| OPACITIES.contains(&first))
}

/// The value of texels where nothing was measured; where it cannot be read, there is none.
fn no_data<R: Read + Seek>(decoder: &mut Decoder<R>) -> Option<f32> {
    let text = decoder.find_tag(NO_DATA).ok()??.into_string().ok()?;
    text.trim_matches(['\0', ' ']).parse().ok()
}

/// Replaces `value`: how many there were, and the least of the others, which is in their place.
fn fill(floats: &mut [f32], value: f32) -> Option<(usize, f32)> {
    let is_it = |float: f32| float == value || float.is_nan() && value.is_nan();
    let others = floats.iter().copied().filter(|&float| !is_it(float) && float.is_finite());
    let least = others.reduce(f32::min)?;
    let count = floats.iter_mut().filter(|float| is_it(**float)).map(|float| *float = least).count();
    (count > 0).then_some((count, least))
}

/// Samples that are neither of 8 nor of 16 bits without sign.
fn floats_of(samples: DecodingResult) -> Vec<f32> {
    fn map<T>(samples: Vec<T>, float: impl Fn(T) -> f32) -> Vec<f32> {
        samples.into_iter().map(float).collect()
    }
    match samples {
        DecodingResult::U8(samples) => map(samples, |value| f32::from(value) / 255.0),
        DecodingResult::U16(samples) => map(samples, |value| f32::from(value) / 65535.0),
        DecodingResult::U32(samples) => map(samples, |value| (f64::from(value) / f64::from(u32::MAX)) as f32),
        DecodingResult::U64(samples) => map(samples, |value| (value as f64 / u64::MAX as f64) as f32),
        DecodingResult::I8(samples) => map(samples, f32::from),
        DecodingResult::I16(samples) => map(samples, f32::from),
        DecodingResult::I32(samples) => map(samples, |value| value as f32),
        DecodingResult::I64(samples) => map(samples, |value| value as f32),
        DecodingResult::F16(samples) => map(samples, f32::from),
        DecodingResult::F32(samples) => samples,
        DecodingResult::F64(samples) => map(samples, |value| value as f32),
    }
}

/// A channel of a texel. `WHITE` is its largest number.
trait Sample: Copy + Into<f32> + ::image::Primitive {
    const WHITE: f32;

    /// The nearest to a number in [0, `WHITE`].
    fn nearest(number: f32) -> Self;
}

impl Sample for u8 {
    const WHITE: f32 = u8::MAX as f32;

    fn nearest(number: f32) -> Self {
        (number + 0.5) as Self
    }
}

impl Sample for u16 {
    const WHITE: f32 = u16::MAX as f32;

    fn nearest(number: f32) -> Self {
        (number + 0.5) as Self
    }
}

impl Sample for f32 {
    const WHITE: f32 = 1.0;

    fn nearest(number: f32) -> Self {
        number
    }
}

/// The layout of samples.
struct Stored {
    width: u32,
    height: u32,
    color: ColorType,
    /// Whether each channel has a plane of its own.
    is_planar: bool,
    /// Whether the opacity follows the colour.
    has_alpha: bool,
}

impl Stored {
    /// The picture of samples of 1, 2 or 4 bits, of which rows begin at whole bytes.
    fn unpacked(&self, samples: &[u8]) -> Option<DynamicImage> {
        let depth = self.color.bit_depth();
        if !matches!(depth, 1 | 2 | 4) || self.is_planar {
            return None;
        }
        let (of_row, in_byte) =
            (self.width as usize * usize::from(self.color.num_samples()), 8 / usize::from(depth));
        let white = u8::MAX >> (8 - depth);
        let sample = |row: &[u8], index: usize| {
            let shift = 8 - depth * (index % in_byte + 1) as u8;
            (row[index / in_byte] >> shift & white) * (u8::MAX / white)
        };
        let rows = samples.chunks_exact(of_row.div_ceil(in_byte));
        let unpacked: Vec<u8> =
            rows.flat_map(|row| (0..of_row).map(move |index| sample(row, index))).collect();
        self.picture(&unpacked)
    }

    /// The picture in RGB, with its opacity. `None` for other kinds of colours.
    fn picture<T: Sample>(&self, samples: &[T]) -> Option<DynamicImage>
    where
        Rgb<T>: ::image::Pixel<Subpixel = T>,
        Rgba<T>: ::image::Pixel<Subpixel = T>,
        DynamicImage: From<ImageBuffer<Rgb<T>, Vec<T>>> + From<ImageBuffer<Rgba<T>, Vec<T>>>,
    {
        let texels = self.width as usize * self.height as usize;
        let count = samples.len() / texels;
        if count < usize::from(self.color.num_samples()) {
            return None;
        }
        let (of_texel, of_channel) = if self.is_planar { (1, texels) } else { (count, 1) };
        let first_four = |texel: usize| {
            array::from_fn(|channel| samples[texel * of_texel + channel.min(count - 1) * of_channel])
        };
        let rgb = |color: &dyn Fn([T; 4]) -> [T; 3]| {
            let values = (0..texels).flat_map(|texel| color(first_four(texel))).collect();
            ImageBuffer::<Rgb<T>, _>::from_raw(self.width, self.height, values).map(DynamicImage::from)
        };
        let rgba = |color: &dyn Fn([T; 4]) -> [T; 4]| {
            let values = (0..texels).flat_map(|texel| color(first_four(texel))).collect();
            ImageBuffer::<Rgba<T>, _>::from_raw(self.width, self.height, values).map(DynamicImage::from)
        };
        match self.color {
            // Of more bands the first is the grey one.
            ColorType::Multiband { .. } if self.has_alpha => {
                rgba(&|[grey, alpha, ..]| [grey, grey, grey, alpha])
            }
            ColorType::Gray(_) | ColorType::Multiband { .. } => rgb(&|[grey, ..]| [grey; 3]),
            ColorType::RGB(_) => rgb(&|[r, g, b, _]| [r, g, b]),
            ColorType::RGBA(_) => rgba(&|rgba| rgba),
            ColorType::CMYK(_) | ColorType::CMYKA(_) => rgb(&|inks| {
                let [c, m, y, k] = inks.map(|ink| T::WHITE - ink.into());
                [c, m, y].map(|light| T::nearest(light * k / T::WHITE))
            }),
            ColorType::YCbCr(8) => rgb(&|stored| {
                let [y, cb, cr, _] = stored.map(Into::into);
                let (blue, red) = (cb - 128.0, cr - 128.0);
                // Rec. 601, by which JPEG stores colours (JFIF 1.02, 1992).
                let color = [y + 1.402 * red, y - 0.344_136 * blue - 0.714_136 * red, y + 1.772 * blue];
                color.map(|value| T::nearest(value.clamp(0.0, T::WHITE)))
            }),
            _ => None,
        }
    }
}
