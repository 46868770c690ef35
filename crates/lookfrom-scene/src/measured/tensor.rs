//! Tensor files: named arrays of numbers, little endian, as the RGL material database has them.
//!
//! After `tensor_file\0`, a version 1.0 and the number of fields each field has its name, its number of dimensions, the type of its
//! numbers, the place of its data in the file, and its shape.

use crate::error::{Error, ErrorKind, Location, Result};

const MAGIC: &[u8; 12] = b"tensor_file\0";

/// The type of numbers of single precision.
const FLOAT32: u8 = 10;

/// The most fields, and the most dimensions of one, that are read.
const MOST: u64 = 64;

/// The fields of a file.
pub(super) struct Tensors<'a> {
    bytes: &'a [u8],
    at: &'a Location,
    fields: Vec<(&'a [u8], Entry)>,
}

/// The place of a field in the file, and its shape.
struct Entry {
    kind: u8,
    offset: u64,
    shape: Vec<u64>,
}

/// An array of numbers of single precision.
pub(super) struct Field<'a> {
    bytes: &'a [u8],
    pub(super) shape: Vec<usize>,
}

impl Field<'_> {
    pub(super) fn values(&self) -> impl Iterator<Item = f32> + '_ {
        self.bytes.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes))
    }
}

/// Whether a file begins as those of tensors.
pub(super) fn is_tensor_file(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

impl<'a> Tensors<'a> {
    /// The fields of a file for which [`is_tensor_file`].
    ///
    /// # Errors
    /// `Syntax` for one that is cut off; `Unsupported` for another version.
    pub(super) fn new(bytes: &'a [u8], at: &'a Location) -> Result<Self> {
        let mut header = Header { bytes, place: 0, at };
        header.place = MAGIC.len();
        let version = header.take::<2>()?;
        if version != [1, 0] {
            let message = format!("version {}.{} of tables; expected 1.0", version[0], version[1]);
            return Err(Error::new(ErrorKind::Unsupported, at, message));
        }
        let count = u32::from_le_bytes(header.take()?);
        let mut fields = Vec::new();
        let count = header.within(count.into(), "fields")?;
        for _ in 0..count {
            let length = u16::from_le_bytes(header.take()?);
            let name = header.slice(length.into())?;
            let dimensions = u16::from_le_bytes(header.take()?);
            let dimensions = header.within(dimensions.into(), "dimensions")?;
            let [kind] = header.take()?;
            let offset = u64::from_le_bytes(header.take()?);
            let shape =
                (0..dimensions).map(|_| header.take().map(u64::from_le_bytes)).collect::<Result<_>>()?;
            fields.push((name, Entry { kind, offset, shape }));
        }
        Ok(Self { bytes, at, fields })
    }

    /// A field of numbers of single precision in so many dimensions.
    ///
    /// # Errors
    /// `Invalid` if there is none, or one of another type or number of dimensions; `Syntax` if its data are cut off.
    pub(super) fn floats(&self, name: &str, dimensions: usize) -> Result<Field<'a>> {
        let Some((_, entry)) = self.fields.iter().find(|(known, _)| *known == name.as_bytes()) else {
            return Err(Error::invalid(self.at, format!("there is no field {name:?}"))
                .hint("the .bsdf files of the RGL material database have it"));
        };
        if entry.kind != FLOAT32 || entry.shape.len() != dimensions {
            let message = format!(
                "{name:?} has numbers of type {} in {} dimensions; expected type {FLOAT32} in {dimensions}",
                entry.kind,
                entry.shape.len()
            );
            return Err(Error::invalid(self.at, message));
        }
        let bytes = entry.shape.iter().try_fold(4_u64, |product, &count| product.checked_mul(count));
        let end = bytes.and_then(|bytes| entry.offset.checked_add(bytes));
        match end {
            Some(end) if end <= self.bytes.len() as u64 => Ok(Field {
                bytes: &self.bytes[entry.offset as usize..end as usize],
                shape: entry.shape.iter().map(|&count| count as usize).collect(),
            }),
            _ => {
                let message = format!("the numbers of {name:?} end after the file");
                Err(Error::new(ErrorKind::Syntax, self.at, message)
                    .hint("the file may be cut off, or damaged"))
            }
        }
    }
}

/// The beginning of a file, as far as it is read.
struct Header<'a> {
    bytes: &'a [u8],
    place: usize,
    at: &'a Location,
}

impl<'a> Header<'a> {
    fn slice(&mut self, length: usize) -> Result<&'a [u8]> {
        let slice = self.bytes.get(self.place..).and_then(|left| left.get(..length)).ok_or_else(|| {
            Error::new(ErrorKind::Syntax, self.at, "the file ends within the list of its fields")
                .hint("the file may be cut off, or damaged")
        })?;
        self.place += length;
        Ok(slice)
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N]> {
        let mut taken = [0; N];
        taken.copy_from_slice(self.slice(N)?);
        Ok(taken)
    }

    /// A count that is not too large.
    fn within(&self, count: u64, what: &str) -> Result<u64> {
        match count <= MOST {
            true => Ok(count),
            false => {
                let message = format!("the file has {count} {what}; at most {MOST} are read");
                Err(Error::new(ErrorKind::Limit, self.at, message))
            }
        }
    }
}
