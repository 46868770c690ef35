//! OpenEXR files, written row by row: whole pictures of floats, and pictures of many integer channels that are not in
//! memory as a whole.

use std::io::{Cursor, Seek, SeekFrom, Write};
use std::ops::Range;

use crc32fast::Hasher;
use half::f16;

use super::MAGIC;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::image::write::check;
use crate::parallel;

/// The compression level: of 10, the fastest that searches for repetitions: files are 1 to 5 % larger than at level 4, which takes four times as
/// long.
const DEFLATE_LEVEL: u8 = 1;

/// Number of rows that ZIP compresses together.
const ZIP_ROWS: u32 = 16;

/// The name of the checksum's attribute: the CRC-32 of the whole file, in which its eight hexadecimal digits are zeros.
pub(super) const CHECKSUM: &str = "crc32";

/// The header of a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ExrHeader {
    /// Width of the picture in pixels: that of the display window.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// The columns and the rows that are in the file, a part of the picture that is not empty: the data window. `None` for all.
    pub crop: Option<[Range<u32>; 2]>,
    /// The channels by name, in any order; they are sorted in the file.
    pub channels: Vec<(String, ExrChannel)>,
    /// Texts, under names that the format does not use itself.
    pub attributes: Vec<(String, String)>,
    /// Whether to compress for speed (run lengths) in place of size (deflate); both are lossless.
    pub is_fast: bool,
    /// Whether the file has a checksum, against which [`ExrRows`](super::ExrRows) tests it.
    pub has_checksum: bool,
}

/// The numbers of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExrChannel {
    /// Floats of 32 bits.
    Float,
    /// Floats of 16 bits, the nearest to those of 32 bits that are given; beyond their largest number that one.
    Half,
    /// Unsigned integers of 32 bits.
    Uint,
}

impl ExrHeader {
    /// The columns and the rows of the picture.
    fn all(&self) -> [Range<u32>; 2] {
        [0..self.width, 0..self.height]
    }

    /// The columns and the rows in the file.
    fn held(&self) -> [Range<u32>; 2] {
        self.crop.clone().unwrap_or(self.all())
    }
}

impl ExrChannel {
    /// The format's number of it.
    fn pixel_type(self) -> i32 {
        match self {
            Self::Uint => 0,
            Self::Half => 1,
            Self::Float => 2,
        }
    }
}

/// The rows of a picture that is written.
pub trait ExrFill: Sync {
    /// Makes these rows ready, before any of them is filled. They follow those of the call before, from the top on.
    ///
    /// # Errors
    /// The errors of what the rows come from.
    fn prepare(&mut self, _rows: Range<u32>) -> Result<()> {
        Ok(())
    }

    /// Writes the numbers of a row in little endian, of 32 bits each: `width` of the first channel of the header, `width` of the
    /// second …; they are zeros before. It is called from several threads.
    fn fill(&self, row: u32, bytes: &mut [u8]);
}

impl<F: Fn(u32, &mut [u8]) + Sync> ExrFill for F {
    fn fill(&self, row: u32, bytes: &mut [u8]) {
        self(row, bytes);
    }
}

/// Writes an OpenEXR file: one part of scan lines, whose rows come from `fill`. The same input gives the same bytes.
///
/// # Errors
/// `Invalid` if a name is empty, too long, duplicate or reserved, the picture has no pixels, or the crop is not a part of it; `Io`
/// where `out` fails; those of `fill`.
pub fn write_exr(header: &ExrHeader, fill: &mut impl ExrFill, out: &mut (impl Write + Seek)) -> Result<()> {
    check_names(header)?;
    let blocks: Vec<Range<u32>> = blocks(header).collect();
    let mut order: Vec<usize> = (0..header.channels.len()).collect();
    order.sort_by(|&a, &b| header.channels[a].0.as_bytes().cmp(header.channels[b].0.as_bytes()));

    // The header and a table of offsets, both of known length, are written twice: the second time they are complete.
    let mut head = head(header, &order);
    let checksum_at = head.len() - 1 - CHECKSUM_DIGITS;
    let table = head.len();
    head.resize(table + blocks.len() * 8, 0);
    let failed = |error: std::io::Error| Error::new(ErrorKind::Io, &Location::default(), error.to_string());
    let start = out.stream_position().map_err(failed)?;
    out.write_all(&head).map_err(failed)?;
    let mut offset = head.len() as u64;
    let mut checksum = Hasher::new();
    let batch = 8 * parallel::threads();
    for (number, batch_of_blocks) in blocks.chunks(batch).enumerate() {
        if let (Some(first), Some(last)) = (batch_of_blocks.first(), batch_of_blocks.last()) {
            fill.prepare(first.start..last.end)?;
        }
        let fill = &*fill;
        let packed = parallel::map(batch_of_blocks.to_vec(), |rows| {
            let block = block(header, &order, rows, fill);
            let mut hasher = Hasher::new();
            hasher.update(&block);
            (block, hasher)
        });
        for (index, (block, hasher)) in packed.iter().enumerate() {
            head[table + (number * batch + index) * 8..][..8].copy_from_slice(&offset.to_le_bytes());
            offset += block.len() as u64;
            checksum.combine(hasher);
            out.write_all(block).map_err(failed)?;
        }
    }
    if header.has_checksum {
        let mut all = Hasher::new();
        all.update(&head);
        all.combine(&checksum);
        let digits = format!("{:08x}", all.finalize());
        head[checksum_at..][..CHECKSUM_DIGITS].copy_from_slice(digits.as_bytes());
    }
    out.seek(SeekFrom::Start(start)).map_err(failed)?;
    out.write_all(&head).map_err(failed)?;
    out.seek(SeekFrom::Start(start + offset)).map_err(failed)?;
    out.flush().map_err(failed)
}

/// The bytes of an OpenEXR file: one part of scan lines, 32-bit floats, lossless ZIP compression. The channels have their
/// names in the file ("R", "G", "B"; others as "albedo.R"); `attributes` are texts for the header, under names that the
/// format does not use itself. The same input gives the same bytes, whatever the order of the channels.
///
/// # Errors
/// `Invalid` if a channel has not `width * height` values, or a name is empty, too long, duplicate or reserved.
pub fn encode_exr(
    width: u32,
    height: u32,
    channels: &[(String, &[f32])],
    attributes: &[(String, String)],
) -> Result<Vec<u8>> {
    for (_, values) in channels {
        check(width, height, values.len())?;
    }
    let header = ExrHeader {
        width,
        height,
        channels: channels.iter().map(|(name, _)| (name.clone(), ExrChannel::Float)).collect(),
        attributes: attributes.to_vec(),
        ..ExrHeader::default()
    };
    let width = width as usize;
    let mut fill = |row: u32, bytes: &mut [u8]| {
        for ((_, values), bytes) in channels.iter().zip(bytes.chunks_exact_mut(width * 4)) {
            for (value, bytes) in values[row as usize * width..].iter().zip(bytes.chunks_exact_mut(4)) {
                bytes.copy_from_slice(&value.to_le_bytes());
            }
        }
    };
    let mut bytes = Cursor::new(Vec::new());
    write_exr(&header, &mut fill, &mut bytes)?;
    Ok(bytes.into_inner())
}

/// The rows that are compressed together.
fn blocks(header: &ExrHeader) -> impl Iterator<Item = Range<u32>> {
    let (rows, [_, held]) = (if header.is_fast { 1 } else { ZIP_ROWS }, header.held());
    let end = held.end;
    held.step_by(rows as usize).map(move |row| row..end.min(row.saturating_add(rows)))
}

/// A block as it is in the file: its first row, its length, its packed bytes.
fn block(header: &ExrHeader, order: &[usize], rows: Range<u32>, fill: &impl ExrFill) -> Vec<u8> {
    let a_channel = header.width as usize * 4;
    let [columns, _] = header.held();
    let columns = columns.start as usize * 4..columns.end as usize * 4;
    let mut raw = Vec::with_capacity(rows.len() * order.len() * columns.len());
    let mut row_bytes = vec![0; order.len() * a_channel];
    for row in rows.clone() {
        row_bytes.fill(0);
        fill.fill(row, &mut row_bytes);
        for &channel in order {
            let numbers = &row_bytes[channel * a_channel..][columns.clone()];
            match header.channels[channel].1 {
                ExrChannel::Half => raw.extend(numbers.as_chunks().0.iter().flat_map(|&bytes| half(bytes))),
                ExrChannel::Float | ExrChannel::Uint => raw.extend_from_slice(numbers),
            }
        }
    }
    let predicted = predicted(&raw);
    let packed = match header.is_fast {
        true => run_lengths(&predicted),
        false => miniz_oxide::deflate::compress_to_vec_zlib(&predicted, DEFLATE_LEVEL),
    };
    let stored = if packed.len() < raw.len() { packed } else { raw };
    let mut block = Vec::with_capacity(stored.len() + 8);
    block.extend(rows.start.to_le_bytes());
    block.extend((stored.len() as u32).to_le_bytes());
    block.extend(stored);
    block
}

/// The half nearest to a float.
fn half(float: [u8; 4]) -> [u8; 2] {
    let largest = f16::MAX.to_f32();
    let number = f32::from_le_bytes(float);
    let is_too_large = number.is_finite() && number.abs() > largest;
    f16::from_f32(if is_too_large { largest.copysign(number) } else { number }).to_le_bytes()
}

/// Even and odd bytes separated, each as the difference from the previous one: what both compressions begin with.
fn predicted(raw: &[u8]) -> Vec<u8> {
    let mut parted: Vec<u8> = raw.iter().step_by(2).chain(raw.iter().skip(1).step_by(2)).copied().collect();
    let mut before = parted.first().copied().unwrap_or(0);
    for byte in parted.iter_mut().skip(1) {
        let difference = byte.wrapping_sub(before).wrapping_add(128);
        before = *byte;
        *byte = difference;
    }
    parted
}

/// OpenEXR's RLE: a count n ≥ 0 and a byte that is repeated n + 1 times, or a negative count −n and n bytes.
fn run_lengths(bytes: &[u8]) -> Vec<u8> {
    const LONGEST: usize = 127;
    const SHORTEST_RUN: usize = 3;
    let mut packed = Vec::with_capacity(bytes.len() / 2);
    let run_at = |at: usize| {
        let most = (at + LONGEST).min(bytes.len());
        bytes[at..most].iter().take_while(|&&byte| byte == bytes[at]).count()
    };
    let mut at = 0;
    while at < bytes.len() {
        let run = run_at(at);
        if run >= SHORTEST_RUN {
            packed.extend([(run - 1) as u8, bytes[at]]);
            at += run;
            continue;
        }
        let start = at;
        while at < bytes.len() && at - start < LONGEST && run_at(at) < SHORTEST_RUN {
            at += 1;
        }
        packed.push((-((at - start) as i64)) as u8);
        packed.extend_from_slice(&bytes[start..at]);
    }
    packed
}

/// Attribute names reserved by the format, and ours for the checksum.
const RESERVED: [&str; 11] = [
    "channels",
    "compression",
    "dataWindow",
    "displayWindow",
    "lineOrder",
    "pixelAspectRatio",
    "screenWindowCenter",
    "screenWindowWidth",
    "name",
    "type",
    CHECKSUM,
];

fn check_names(header: &ExrHeader) -> Result<()> {
    let wrong = |message: String| Err(Error::invalid(&Location::default(), message));
    if header.width == 0 || header.height == 0 {
        return wrong(format!("a picture of {} × {} has no pixels", header.width, header.height));
    }
    let (width, height) = (header.width, header.height);
    let [Range { start: x0, end: x1 }, Range { start: y0, end: y1 }] = header.held();
    if x0 >= x1 || y0 >= y1 || x1 > width || y1 > height {
        return wrong(format!(
            "the crop {x0},{y0},{x1},{y1} is no part of a picture of {width} × {height} pixels"
        ));
    }
    if header.channels.is_empty() {
        return wrong("an OpenEXR picture needs at least one channel".to_owned());
    }
    let channel_names = || header.channels.iter().map(|(name, _)| name.as_str());
    let attribute_names = || header.attributes.iter().map(|(name, _)| name.as_str());
    for name in channel_names().chain(attribute_names()) {
        if name.is_empty() || name.len() > 31 || name.contains('\0') {
            return wrong(format!("OpenEXR name {name:?} must have 1 to 31 bytes, none of them zero"));
        }
    }
    if let Some(name) = attribute_names().find(|name| RESERVED.contains(name)) {
        return wrong(format!("attribute {name:?} is one of OpenEXR's own"));
    }
    for mut names in [channel_names().collect::<Vec<_>>(), attribute_names().collect()] {
        names.sort_unstable();
        if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return wrong(format!("OpenEXR name {:?} is given twice", pair[0]));
        }
    }
    Ok(())
}

/// Digits of the checksum, the last bytes of the header but for its end.
const CHECKSUM_DIGITS: usize = 8;

/// The file up to the table of offsets.
fn head(header: &ExrHeader, order: &[usize]) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    bytes.extend(2_i32.to_le_bytes());
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        for text in [name, kind] {
            bytes.extend(text.as_bytes());
            bytes.push(0);
        }
        bytes.extend((value.len() as i32).to_le_bytes());
        bytes.extend(value);
    };

    // Each channel: its name, pixel type, not perceptually linear, no subsampling.
    let mut list = Vec::new();
    for (name, kind) in order.iter().map(|&channel| &header.channels[channel]) {
        list.extend(name.as_bytes());
        list.push(0);
        for number in [kind.pixel_type(), 0, 1, 1] {
            list.extend(number.to_le_bytes());
        }
    }
    list.push(0);
    let window = |[columns, rows]: [Range<u32>; 2]| {
        let edges = [columns.start as i32, rows.start as i32, columns.end as i32 - 1, rows.end as i32 - 1];
        edges.iter().flat_map(|edge| edge.to_le_bytes()).collect::<Vec<u8>>()
    };
    let one = 1.0_f32.to_le_bytes();
    // 1: run lengths, 3: ZIP of 16 rows.
    let compression = if header.is_fast { [1] } else { [3] };
    let rows_downwards = [0];
    attribute("channels", "chlist", &list);
    attribute("compression", "compression", &compression);
    attribute("dataWindow", "box2i", &window(header.held()));
    attribute("displayWindow", "box2i", &window(header.all()));
    attribute("lineOrder", "lineOrder", &rows_downwards);
    attribute("pixelAspectRatio", "float", &one);
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &one);
    for (name, text) in &header.attributes {
        attribute(name, "string", text.as_bytes());
    }
    if header.has_checksum {
        attribute(CHECKSUM, "string", &[b'0'; CHECKSUM_DIGITS]);
    }
    bytes.push(0);
    bytes
}
