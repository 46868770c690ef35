//! Animations without end: GIF89a, animated PNG (PNG, third edition) and animated WebP (RFC 9649).
//!
//! The latter two are stills in a container; a frame is encoded when it is added, and the container is made at the end,
//! when the number of frames is known.

use gif::{DisposalMethod, Encoder, Repeat};

use super::write::{Pixels, encode_png_of, encode_webp, without_alpha};
use crate::error::{Error, ErrorKind, Location, Result};

/// Effort of GIF's choice of 256 colours, from 1 (most) to 30.
const SPEED: i32 = 10;
/// The shortest time of a frame that viewers of GIFs accept, in hundredths of a second; they slow down shorter ones to a tenth.
const SHORTEST: u64 = 2;
/// The longest side of a GIF.
const LONGEST: u32 = 65_535;
const PNG_SIGNATURE: usize = 8;
/// Bytes of a WebP before its first chunk: `RIFF`, a length and `WEBP`.
const WEBP_HEADER: usize = 12;

/// A format of animations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnimationFormat {
    /// 256 colours a frame; transparent or not.
    Gif,
    /// Without losses, with alpha.
    Apng,
    /// Without losses, with alpha.
    WebP,
}

/// An animation to which frames of one size are added.
#[derive(Debug)]
pub struct Animation {
    size: [u32; 2],
    /// Frames per second.
    fps: f64,
    has_alpha: bool,
    frames: Frames,
}

/// Encoded frames.
#[derive(Debug)]
enum Frames {
    Gif(Vec<gif::Frame<'static>>),
    Png(Vec<Vec<u8>>),
    WebP(Vec<Vec<u8>>),
}

impl Animation {
    /// An animation without frames yet. `size` is width and height, `fps` the number of frames per second, > 0.
    ///
    /// # Errors
    /// `Invalid` for a GIF with a side of more than 65,535 pixels.
    pub fn new(format: AnimationFormat, size: [u32; 2], fps: f64, has_alpha: bool) -> Result<Self> {
        let frames = match format {
            AnimationFormat::Gif if size[0].max(size[1]) > LONGEST => {
                let side = size[0].max(size[1]);
                let message = format!("a GIF has at most {LONGEST} pixels a side, not {side}");
                return Err(Error::invalid(&Location::default(), message));
            }
            AnimationFormat::Gif => Frames::Gif(Vec::new()),
            AnimationFormat::Apng => Frames::Png(Vec::new()),
            AnimationFormat::WebP => Frames::WebP(Vec::new()),
        };
        Ok(Self { size, fps, has_alpha, frames })
    }

    /// Adds a frame of 8-bit sRGB colours with straight alpha, row 0 on top.
    ///
    /// # Errors
    /// `Invalid` if `rgba` are not as many bytes as the size says, or the format has not so many pixels.
    pub fn add(&mut self, rgba: &[u8]) -> Result<()> {
        let [width, height] = self.size;
        super::write::check_channels(width, height, rgba.len(), 4)?;
        let opaque = (!self.has_alpha).then(|| without_alpha(rgba));
        let pixels = opaque.as_deref().map_or(Pixels::Rgba8(rgba), Pixels::Rgb8);
        match &mut self.frames {
            Frames::Png(frames) => frames.push(encode_png_of(self.size, pixels, None)?),
            Frames::WebP(frames) => frames.push(encode_webp(self.size, pixels, None)?),
            Frames::Gif(frames) => {
                // Half a pixel is shown, less is not: a GIF has no alpha.
                let mut whole = rgba.to_vec();
                whole.chunks_exact_mut(4).for_each(|pixel| pixel[3] = if pixel[3] < 128 { 0 } else { 255 });
                let mut frame = gif::Frame::from_rgba_speed(width as u16, height as u16, &mut whole, SPEED);
                frame.dispose = DisposalMethod::Background;
                frame.make_lzw_pre_encoded();
                frames.push(frame);
            }
        }
        Ok(())
    }

    /// The bytes of the file. The same frames give the same bytes.
    ///
    /// # Errors
    /// `Invalid` without frames.
    pub fn finish(self) -> Result<Vec<u8>> {
        let Self { size, fps, has_alpha, frames } = self;
        let count = match &frames {
            Frames::Gif(frames) => frames.len(),
            Frames::Png(frames) | Frames::WebP(frames) => frames.len(),
        };
        if count == 0 {
            return Err(Error::invalid(&Location::default(), "an animation without frames"));
        }
        match frames {
            Frames::Gif(frames) => gif(size, fps, frames),
            Frames::Png(frames) => Ok(apng(size, fps, &frames)),
            Frames::WebP(frames) => Ok(webp(size, fps, has_alpha, &frames)),
        }
    }
}

/// The time of a frame in units of a fraction of a second, rounded so that the sum does not drift.
fn delay(frame: usize, fps: f64, units: f64) -> u64 {
    let end_of = |frames: usize| (frames as f64 * units / fps).round() as u64;
    end_of(frame + 1) - end_of(frame)
}

fn gif(size: [u32; 2], fps: f64, frames: Vec<gif::Frame<'static>>) -> Result<Vec<u8>> {
    let failed = |error: gif::EncodingError| {
        Error::new(ErrorKind::Io, &Location::default(), format!("cannot encode: {error}"))
    };
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, size[0] as u16, size[1] as u16, &[]).map_err(failed)?;
    if frames.len() > 1 {
        encoder.set_repeat(Repeat::Infinite).map_err(failed)?;
    }
    for (index, mut frame) in frames.into_iter().enumerate() {
        frame.delay = delay(index, fps, 100.0).clamp(SHORTEST, u16::MAX.into()) as u16;
        encoder.write_lzw_pre_encoded_frame(&frame).map_err(failed)?;
    }
    drop(encoder);
    Ok(bytes)
}

/// The frames of an animated PNG: the first as in a still, the data of the others in chunks of their own, all numbered.
fn apng([width, height]: [u32; 2], fps: f64, stills: &[Vec<u8>]) -> Vec<u8> {
    let [numerator, denominator] = match fps >= 1.0 {
        true => [100.0, 100.0 * fps],
        false => [1000.0 / fps, 1000.0],
    }
    .map(|number| number.round().clamp(1.0, u16::MAX.into()) as u16);
    let mut bytes = stills[0][..PNG_SIGNATURE].to_vec();
    let mut number = 0_u32;
    let mut next = || {
        number += 1;
        (number - 1).to_be_bytes()
    };
    for (index, still) in stills.iter().enumerate() {
        let is_first = index == 0;
        let mut is_told = false;
        for (kind, data) in chunks(still) {
            if &kind == b"IDAT" && !is_told {
                let mut control = next().to_vec();
                [width, height, 0, 0].iter().for_each(|side| control.extend(side.to_be_bytes()));
                control.extend([numerator, denominator].map(u16::to_be_bytes).as_flattened());
                // Whole frames, which replace what was before.
                control.extend([0, 0]);
                push_chunk(&mut bytes, b"fcTL", &control);
                is_told = true;
            }
            match &kind {
                b"IDAT" if is_first => push_chunk(&mut bytes, &kind, data),
                b"IDAT" => push_chunk(&mut bytes, b"fdAT", &[&next(), data].concat()),
                b"IEND" => {}
                _ if is_first => push_chunk(&mut bytes, &kind, data),
                _ => {}
            }
            if is_first && &kind == b"IHDR" {
                let count = (stills.len() as u32).to_be_bytes();
                push_chunk(&mut bytes, b"acTL", &[count, [0; 4]].concat());
            }
        }
    }
    push_chunk(&mut bytes, b"IEND", &[]);
    bytes
}

/// The chunks of a PNG that was written here: their types and data.
fn chunks(png: &[u8]) -> impl Iterator<Item = ([u8; 4], &[u8])> {
    let mut rest = &png[PNG_SIGNATURE..];
    std::iter::from_fn(move || {
        let (length, behind) = rest.split_first_chunk::<4>()?;
        let (kind, behind) = behind.split_first_chunk::<4>()?;
        let (data, behind) = behind.split_at_checked(u32::from_be_bytes(*length) as usize)?;
        rest = behind.get(4..)?;
        Some((*kind, data))
    })
}

fn push_chunk(png: &mut Vec<u8>, kind: &[u8; 4], data: &[u8]) {
    png.extend((data.len() as u32).to_be_bytes());
    let start = png.len();
    png.extend(kind);
    png.extend(data);
    let checksum = crc32fast::hash(&png[start..]);
    png.extend(checksum.to_be_bytes());
}

/// The frames of an animated WebP: whole ones, which replace what was before.
fn webp(size: [u32; 2], fps: f64, has_alpha: bool, stills: &[Vec<u8>]) -> Vec<u8> {
    const ANIMATION: u8 = 2;
    const ALPHA: u8 = 16;
    const DO_NOT_BLEND: u8 = 2;
    let three = |number: u64| {
        let [a, b, c, ..] = number.min(0xff_ffff).to_le_bytes();
        [a, b, c]
    };
    let sides = size.map(|side| three(u64::from(side) - 1)).concat();
    let mut body = b"WEBP".to_vec();
    let mut push = |kind: &[u8; 4], data: &[u8]| {
        body.extend(kind);
        body.extend((data.len() as u32).to_le_bytes());
        body.extend(data);
        body.extend(&[0][..data.len() % 2]);
    };
    let flags = ANIMATION | if has_alpha { ALPHA } else { 0 };
    push(b"VP8X", &[&[flags, 0, 0, 0], &*sides].concat());
    push(b"ANIM", &[0; 6]);
    for (index, still) in stills.iter().enumerate() {
        let time = three(delay(index, fps, 1000.0));
        push(b"ANMF", &[&[0; 6], &*sides, &time, &[DO_NOT_BLEND], &still[WEBP_HEADER..]].concat());
    }
    [b"RIFF", &(body.len() as u32).to_le_bytes()[..], &body].concat()
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use ::image::AnimationDecoder;
    use ::image::codecs::gif::GifDecoder;
    use ::image::codecs::png::PngDecoder;
    use ::image::codecs::webp::WebPDecoder;

    use super::*;

    const SIZE: [u32; 2] = [5, 3];

    /// A frame with a plain colour and one pixel of another that moves.
    fn frame(number: usize, has_alpha: bool) -> Vec<u8> {
        let mut rgba = [200, 30, 30, if has_alpha { 0 } else { 255 }].repeat(15);
        rgba[4 * number..4 * number + 4].copy_from_slice(&[0, 0, 255, 255]);
        rgba
    }

    /// The frames of a file, and the milliseconds of each.
    fn decoded(format: AnimationFormat, bytes: Vec<u8>) -> Vec<(Vec<u8>, f64)> {
        let bytes = Cursor::new(bytes);
        let frames = match format {
            AnimationFormat::Gif => GifDecoder::new(bytes).expect("a GIF").into_frames(),
            AnimationFormat::Apng => {
                PngDecoder::new(bytes).expect("a PNG").apng().expect("animated").into_frames()
            }
            AnimationFormat::WebP => WebPDecoder::new(bytes).expect("a WebP").into_frames(),
        };
        let frames = frames.collect_frames().expect("whole frames");
        let time = |frame: &::image::Frame| {
            let (numerator, denominator) = frame.delay().numer_denom_ms();
            f64::from(numerator) / f64::from(denominator)
        };
        frames
            .into_iter()
            .map(|frame| (time(&frame), frame))
            .map(|(t, f)| (f.into_buffer().into_raw(), t))
            .collect()
    }

    #[test]
    fn frames_come_back_in_their_time() {
        for format in [AnimationFormat::Gif, AnimationFormat::Apng, AnimationFormat::WebP] {
            for has_alpha in [false, true] {
                let mut animation = Animation::new(format, SIZE, 24.0, has_alpha).unwrap();
                let frames: Vec<_> = (0..12).map(|number| frame(number, has_alpha)).collect();
                frames.iter().for_each(|frame| animation.add(frame).unwrap());
                let found = decoded(format, animation.finish().unwrap());
                assert_eq!(found.len(), 12, "{format:?}");
                for (index, (expected, (found, _))) in frames.iter().zip(&found).enumerate() {
                    for (expected, found) in expected.chunks(4).zip(found.chunks(4)) {
                        let is_same = expected == found || (expected[3] == 0 && found[3] == 0);
                        assert!(is_same, "{format:?}, frame {index}: {found:?}, not {expected:?}");
                    }
                }
                let whole: f64 = found.iter().map(|(_, time)| time).sum();
                assert!((whole - 500.0).abs() < 6.0, "{format:?} takes {whole} ms");
            }
        }
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let mut animation = Animation::new(AnimationFormat::Apng, SIZE, 24.0, false).unwrap();
        assert!(animation.add(&[0; 12]).is_err() && animation.finish().is_err());
        assert!(Animation::new(AnimationFormat::Gif, [70_000, 1], 24.0, false).is_err());
    }
}
