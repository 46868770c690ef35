//! Radiance pictures (`.hdr`, `.pic`): red, green, blue or X, Y, Z with a common exponent (Ward 1991, "Real Pixels"; the format:
//! radsite.lbl.gov/radiance/refer/filefmts.pdf).
//!
//! The signature `#?…` is optional, lines may end as on Windows, and all eight orientations are read. `EXPOSURE` and `COLORCORR` are
//! factors that a program has applied to the light; they are divided out. `PRIMARIES` are the colours of red, green, blue and white.

use super::read::{By, Floats, Reading, WHOLE, check_size, room};
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::LoadContext;
use crate::spectrum::space::Chromaticities;

/// The word before the kind of pixels.
const FORMAT: &[u8] = b"FORMAT=32-bit_rle_";

/// Bytes in which the header of a file without a signature names its kind.
const HEAD: usize = 4096;

/// Whether a file is a Radiance picture.
pub(super) fn is(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(HEAD)];
    bytes.starts_with(b"#?") || head.split(|&byte| byte == b'\n').any(|line| line.starts_with(FORMAT))
}

/// The header of a file.
struct Header {
    is_xyz: bool,
    /// Factors of the channels that are in the pixels.
    applied: [f64; 3],
    chromaticities: Option<Chromaticities>,
    /// The axis from line to line, then the one along a line.
    axes: [Axis; 2],
}

/// An axis of the picture, as the resolution line tells.
#[derive(Clone, Copy)]
struct Axis {
    is_x: bool,
    /// From the left to the right, or from the top to the bottom.
    is_forward: bool,
    count: u32,
}

impl Axis {
    fn place(self, index: u32) -> usize {
        (if self.is_forward { index } else { self.count - 1 - index }) as usize
    }
}

/// Decodes a Radiance picture.
pub(super) fn decode(
    bytes: &[u8],
    at: &Location,
    reading: &Reading<'_>,
    context: &mut LoadContext<'_>,
) -> Result<Floats> {
    let mut rest = bytes;
    let header = header(&mut rest, at, context)?;
    let [lines, along] = header.axes;
    let (width, height) = if along.is_x { (along.count, lines.count) } else { (lines.count, along.count) };
    check_size(width.into(), height.into(), at, &context.limits)?;
    let memory = room([width, height], size_of::<[f32; 3]>() as u64, at, context)?;

    let scale = scale(header.applied, reading, at, context);
    let powers: [f32; 256] = std::array::from_fn(|exponent| match exponent {
        0 => 0.0,
        exponent => libm::ldexpf(1.0, exponent as i32 - (128 + 8)),
    });
    let mut texels = vec![[0.0; 3]; width as usize * height as usize];
    let mut line = vec![[0; 4]; along.count as usize];
    for index in 0..lines.count {
        read_line(&mut rest, &mut line).ok_or_else(|| {
            Error::syntax(
                at,
                format!("not a complete picture: ends in line {} of {}", index + 1, lines.count),
            )
            .hint(WHOLE)
        })?;
        for (place, [r, g, b, exponent]) in (0..).zip(&line) {
            let (across, along_line) = (lines.place(index), along.place(place));
            let (column, row) = if along.is_x { (along_line, across) } else { (across, along_line) };
            let power = powers[usize::from(*exponent)];
            let light = [*r, *g, *b].map(|mantissa| f32::from(mantissa) * power);
            texels[row * width as usize + column] = std::array::from_fn(|k| light[k] * scale[k]);
        }
    }
    let chromaticities = if header.is_xyz { Some(Chromaticities::XYZ) } else { header.chromaticities };
    let to_rec709 = chromaticities
        .filter(|_| !reading.is_data())
        .and_then(|colors| colors.rec709(reading.by == By::PbrtLight));
    Ok(Floats { width, height, texels, alpha: Vec::new(), to_rec709, memory })
}

/// The factors that undo those that were applied, with a note; pbrt-v4 does not undo them.
fn scale(applied: [f64; 3], reading: &Reading<'_>, at: &Location, context: &mut LoadContext<'_>) -> [f32; 3] {
    if applied == [1.0; 3] || reading.by != By::Standard {
        return [1.0; 3];
    }
    let told = match applied {
        [r, g, b] if r == g && g == b => format!("{r}"),
        [r, g, b] => format!("{r}, {g}, {b}"),
    };
    context.notice(at, format!("its header tells an exposure of {told}; the light is divided by it"));
    applied.map(|factor| (1.0 / factor) as f32)
}

/// Reads the lines up to the pixels.
fn header(rest: &mut &[u8], at: &Location, context: &mut LoadContext<'_>) -> Result<Header> {
    let bad = |message: String| {
        Error::syntax(at, message)
            .hint("a Radiance picture has a line `FORMAT=32-bit_rle_rgbe`, an empty line, and one such as `-Y 512 +X 1024`")
    };
    let mut found = Header {
        is_xyz: false,
        applied: [1.0; 3],
        chromaticities: None,
        axes: [Axis { is_x: false, is_forward: true, count: 0 }; 2],
    };
    for number in 1_u32.. {
        let end = rest
            .iter()
            .position(|&byte| byte == b'\n')
            .ok_or_else(|| bad("ends in the header, without a line for the resolution".to_owned()))?;
        let line = String::from_utf8_lossy(&rest[..end]);
        *rest = &rest[end + 1..];
        let line = line.trim();
        if let Some(axes) = resolution(line) {
            found.axes = axes;
            return Ok(found);
        }
        let Some((name, value)) = line.split_once('=') else { continue };
        let value = value.trim();
        let numbers: Vec<f64> = value.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        let at = Location { line: number, ..at.clone() };
        match (name.trim(), numbers.as_slice()) {
            ("FORMAT", _) => match value {
                "32-bit_rle_rgbe" => {}
                "32-bit_rle_xyze" => found.is_xyz = true,
                _ => {
                    let message = format!("pixels of the format {value:?} are not read");
                    return Err(Error::new(ErrorKind::Unsupported, &at, message)
                        .hint("there are: 32-bit_rle_rgbe, 32-bit_rle_xyze"));
                }
            },
            ("EXPOSURE", &[exposure]) if is_factor(exposure) => {
                found.applied = found.applied.map(|factor| factor * exposure);
            }
            ("COLORCORR", &[r, g, b]) if [r, g, b].into_iter().all(is_factor) => {
                let corrections = [r, g, b];
                found.applied = std::array::from_fn(|k| found.applied[k] * corrections[k]);
            }
            ("PRIMARIES", &[rx, ry, gx, gy, bx, by, wx, wy]) => {
                found.chromaticities =
                    Some(Chromaticities { primaries: [[rx, ry], [gx, gy], [bx, by]], white: [wx, wy] });
            }
            (name @ ("EXPOSURE" | "COLORCORR" | "PRIMARIES"), _) => {
                context.warn(&at, format!("{name}={value:?} makes no sense and is ignored"));
            }
            _ => {}
        }
    }
    Err(bad("has no line for the resolution".to_owned()))
}

fn is_factor(factor: f64) -> bool {
    factor > 0.0 && factor.is_finite() && (factor as f32) > 0.0 && ((1.0 / factor) as f32).is_finite()
}

/// The axes of a line such as `-Y 512 +X 1024`, if it is one.
fn resolution(line: &str) -> Option<[Axis; 2]> {
    let mut words = line.split_whitespace();
    let mut axis = || {
        let (is_x, is_forward) = match words.next()? {
            "+X" => (true, true),
            "-X" => (true, false),
            "-Y" => (false, true),
            "+Y" => (false, false),
            _ => return None,
        };
        Some(Axis { is_x, is_forward, count: words.next()?.parse().ok()? })
    };
    let axes = [axis()?, axis()?];
    (axes[0].is_x != axes[1].is_x && words.next().is_none()).then_some(axes)
}

/// Reads a line of pixels in any of the three packings; `None` if the file ends, or a run is longer than the line.
fn read_line(rest: &mut &[u8], line: &mut [[u8; 4]]) -> Option<()> {
    const RUNS: std::ops::RangeInclusive<usize> = 8..=0x7fff;
    if let Some((&[2, 2, high, low], behind)) = rest.split_first_chunk::<4>()
        && RUNS.contains(&line.len())
        && usize::from(high) << 8 | usize::from(low) == line.len()
    {
        *rest = behind;
        return (0..4).try_for_each(|channel| read_runs(rest, line, channel));
    }
    // Pixels one by one; a pixel of 1, 1, 1 repeats the one before it, and several in a row count with more digits.
    let (mut filled, mut shift) = (0, 0);
    while filled < line.len() {
        let (&pixel, behind) = rest.split_first_chunk::<4>()?;
        *rest = behind;
        if let [1, 1, 1, count] = pixel
            && filled > 0
        {
            let count = usize::from(count).checked_shl(shift)?;
            let end = filled.checked_add(count).filter(|&end| end <= line.len())?;
            let repeated = line[filled - 1];
            line[filled..end].fill(repeated);
            filled = end;
            shift += 8;
        } else {
            line[filled] = pixel;
            filled += 1;
            shift = 0;
        }
    }
    Some(())
}

/// Reads one channel of a line in runs: up to 128 bytes as they are, or one byte up to 127 times.
fn read_runs(rest: &mut &[u8], line: &mut [[u8; 4]], channel: usize) -> Option<()> {
    let mut filled = 0;
    while filled < line.len() {
        let (&code, behind) = rest.split_first()?;
        let (count, is_run) =
            if code > 128 { (usize::from(code) - 128, true) } else { (usize::from(code), false) };
        let pixels = line.get_mut(filled..filled + count).filter(|pixels| !pixels.is_empty())?;
        let (values, behind) = behind.split_at_checked(if is_run { 1 } else { count })?;
        for (index, pixel) in pixels.iter_mut().enumerate() {
            pixel[channel] = values[if is_run { 0 } else { index }];
        }
        *rest = behind;
        filled += count;
    }
    Some(())
}
