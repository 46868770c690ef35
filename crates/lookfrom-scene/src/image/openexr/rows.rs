//! OpenEXR files, read row by row: numbers as they are in the file, not converted.

use std::io::Cursor;
use std::ops::Range;

use ::exr::block::reader::{ChunksReader, Reader};
use ::exr::block::{BlockIndex, UncompressedBlock};
use ::exr::compression::Compression;
use ::exr::meta::BlockDescription;
use ::exr::meta::attribute::SampleType;

use super::write::{CHECKSUM, ExrChannel, ExrHeader};
use super::{ExrError, MOST_CHANNELS, fault};
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::Limits;
use crate::image::read::check_size;

/// The most bytes of pixels in a byte of a file: run lengths pack 128 bytes in two.
const MOST_IN_RUNS: u64 = 64;

/// The highest ratio of compression, deflate's 1032; nothing that we read packs more.
const MOST_PACKED: u64 = 1040;

/// An OpenEXR file of one part of scan lines, whose channels have 32 bits a number.
#[derive(Debug)]
pub struct ExrRows<B> {
    header: ExrHeader,
    reader: Reader<Cursor<B>>,
    at: Location,
}

impl<B: AsRef<[u8]>> ExrRows<B> {
    /// Reads the header.
    ///
    /// # Errors
    /// `Syntax` for a file that is damaged, by its checksum or its size, or is no OpenEXR file; `Unsupported` for one of
    /// another kind; `Limit` for one that is too large.
    pub fn open(file: B, at: &Location, limits: &Limits) -> Result<Self> {
        let bytes = file.as_ref();
        let reader =
            Reader::read_from_buffered(Cursor::new(bytes), false).map_err(|error| fault(&error, at))?;
        let [found] = reader.headers() else {
            return Err(unsupported(at, "several parts"));
        };
        let (width, height) = (found.layer_size.0 as u64, found.layer_size.1 as u64);
        check_size(width, height, at, limits)?;
        let a_pixel = found.channels.list.len() as u64 * 4;
        if found.channels.list.len() as u64 > MOST_CHANNELS {
            return Err(Error::new(ErrorKind::Limit, at, "more than 1024 channels"));
        }
        let is_fast = found.compression == Compression::RLE;
        let most = if is_fast { MOST_IN_RUNS } else { MOST_PACKED };
        if width * height / most * a_pixel > bytes.len() as u64 {
            let claim = format!("{} bytes cannot hold {width} × {height} pixels", bytes.len());
            return Err(Error::syntax(at, format!("not a whole OpenEXR picture: {claim}")));
        }
        if found.deep || found.blocks != BlockDescription::ScanLines {
            return Err(unsupported(at, "tiles or deep data"));
        }
        let channels = found.channels.list.iter().map(|channel| {
            let kind = match channel.sample_type {
                SampleType::F32 => ExrChannel::Float,
                SampleType::U32 => ExrChannel::Uint,
                SampleType::F16 => return Err(unsupported(at, "numbers of 16 bits")),
            };
            match channel.sampling.0 == 1 && channel.sampling.1 == 1 {
                true => Ok((channel.name.to_string(), kind)),
                false => Err(unsupported(at, "subsampled channels")),
            }
        });
        let mut attributes = texts(bytes).ok_or_else(|| Error::syntax(at, "a damaged OpenEXR header"))?;
        attributes.sort();
        let checksum = attributes.iter().position(|(name, _)| name == CHECKSUM);
        let checksum = checksum.map(|index| attributes.remove(index).1);
        if let Some(checksum) = &checksum {
            test_checksum(bytes, checksum, at)?;
        }
        let header = ExrHeader {
            width: width as u32,
            height: height as u32,
            crop: None,
            channels: channels.collect::<Result<_>>()?,
            attributes,
            is_fast,
            has_checksum: checksum.is_some(),
        };
        let reader =
            Reader::read_from_buffered(Cursor::new(file), false).map_err(|error| fault(&error, at))?;
        Ok(Self { header, reader, at: at.clone() })
    }

    /// The header: channels in the order of the file, attributes by name, without those that are not texts.
    pub fn header(&self) -> &ExrHeader {
        &self.header
    }

    /// Calls `each` with every row and its numbers: `width` of the first channel, `width` of the second …
    ///
    /// # Errors
    /// `Syntax` where a row is damaged, missing or there twice, and those of `each`.
    pub fn read(self, each: &mut dyn FnMut(u32, &[u32]) -> Result<()>) -> Result<()> {
        let Self { header: ExrHeader { width, height, channels, .. }, reader, at } = self;
        let a_row = width as usize * channels.len();
        let mut numbers = vec![0_u32; a_row];
        let mut is_read = vec![false; height as usize];
        let chunks = reader.all_chunks(false).map_err(|error| fault(&error, &at))?;
        for block in chunks.sequential_decompressor(false) {
            let block = block.map_err(|error| fault(&error, &at))?;
            let first = block.index.pixel_position.1;
            for (index, row) in block.data.chunks_exact(a_row * 4).enumerate() {
                match is_read.get_mut(first + index) {
                    Some(is_read) if !*is_read => *is_read = true,
                    _ => return Err(Error::syntax(&at, "not a whole OpenEXR picture: a row is there twice")),
                }
                for (number, bytes) in numbers.iter_mut().zip(row.chunks_exact(4)) {
                    *number = u32::from_ne_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
                }
                each((first + index) as u32, &numbers)?;
            }
        }
        match is_read.iter().position(|is_read| !is_read) {
            None => Ok(()),
            Some(row) => {
                Err(Error::syntax(&at, format!("not a whole OpenEXR picture: row {row} is missing")))
            }
        }
    }
}

impl<B: AsRef<[u8]> + Send + 'static> ExrRows<B> {
    /// Some rows, one after the other from the top.
    ///
    /// # Errors
    /// `Syntax` where the file is damaged.
    pub fn stream(self, rows: Range<u32>) -> Result<ExrRowStream> {
        let Self { header: ExrHeader { width, channels, .. }, reader, at } = self;
        let is_wanted = |block: &BlockIndex| {
            let top = block.pixel_position.1;
            top < rows.end as usize && top + block.pixel_size.1 > rows.start as usize
        };
        let chunks = reader
            .filter_chunks(false, |_, _, block| is_wanted(&block))
            .map_err(|error| fault(&error, &at))?;
        Ok(ExrRowStream {
            blocks: Box::new(chunks.sequential_decompressor(false)),
            block: Vec::new(),
            first: 0,
            row: rows.start,
            numbers: vec![0; width as usize * channels.len()],
            at,
        })
    }
}

/// Rows of a file that are read one after the other.
pub struct ExrRowStream {
    blocks: Box<dyn Iterator<Item = std::result::Result<UncompressedBlock, ExrError>> + Send>,
    /// The last block that was read, and the row that it begins with.
    block: Vec<u8>,
    first: u32,
    /// The next row.
    row: u32,
    numbers: Vec<u32>,
    at: Location,
}

impl ExrRowStream {
    /// The numbers of the next row: `width` of the first channel, `width` of the second …
    ///
    /// # Errors
    /// `Syntax` where a row is damaged, missing or out of order.
    pub fn next_row(&mut self) -> Result<&[u32]> {
        let Self { blocks, block, first, row, numbers, at } = self;
        let a_row = numbers.len() * 4;
        while *row as usize >= *first as usize + block.len() / a_row {
            let missing = || Error::syntax(at, format!("not a whole OpenEXR picture: row {row} is missing"));
            let next = blocks.next().ok_or_else(missing)?.map_err(|error| fault(&error, at))?;
            (*first, *block) = (next.index.pixel_position.1 as u32, next.data);
            if *first > *row {
                return Err(missing());
            }
        }
        let bytes = &block[(*row - *first) as usize * a_row..][..a_row];
        for (number, bytes) in numbers.iter_mut().zip(bytes.chunks_exact(4)) {
            *number = u32::from_ne_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        }
        *row += 1;
        Ok(numbers)
    }
}

/// The attributes that are texts, by name. (The crate keeps some, `software` for one, apart from the others, each in a place
/// of its own.) `None` for a header that ends early.
fn texts(bytes: &[u8]) -> Option<Vec<(String, String)>> {
    fn name<'a>(bytes: &mut &'a [u8]) -> Option<&'a [u8]> {
        let end = bytes.iter().position(|&byte| byte == 0)?;
        let name = &bytes[..end];
        *bytes = &bytes[end + 1..];
        Some(name)
    }
    let mut texts = Vec::new();
    let mut rest = bytes.get(8..)?;
    loop {
        let attribute = name(&mut rest)?;
        if attribute.is_empty() {
            return Some(texts);
        }
        let kind = name(&mut rest)?;
        let (length, behind) = rest.split_first_chunk::<4>()?;
        let (value, behind) = behind.split_at_checked(u32::from_le_bytes(*length) as usize)?;
        if kind == b"string" {
            let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
            texts.push((text(attribute), text(value)));
        }
        rest = behind;
    }
}

fn unsupported(at: &Location, what: &str) -> Error {
    Error::new(ErrorKind::Unsupported, at, format!("OpenEXR with {what} is not read here"))
}

/// Compares the file with the checksum that it states.
fn test_checksum(bytes: &[u8], stated: &str, at: &Location) -> Result<()> {
    // The digits are the value of an attribute of known name, type and length.
    let marker = [CHECKSUM.as_bytes(), b"\0string\0", &8_u32.to_le_bytes()].concat();
    let place = bytes.windows(marker.len()).position(|window| window == marker);
    let computed =
        place.map(|place| place + marker.len()).filter(|digits| digits + 8 <= bytes.len()).map(|digits| {
            let mut hasher = crc32fast::Hasher::new();
            hasher.update(&bytes[..digits]);
            hasher.update(b"00000000");
            hasher.update(&bytes[digits + 8..]);
            format!("{:08x}", hasher.finalize())
        });
    match computed {
        Some(computed) if computed == stated => Ok(()),
        _ => Err(Error::syntax(at, "this file is damaged: its checksum does not agree with its content")
            .hint("make it again, or take another copy of it")),
    }
}
