//! Reader and writer for arrays of NumPy: `.npy` files (NumPy Enhancement Proposal 1), versions 1 to 3, of integers and floating-point numbers in
//! little-endian order.

use crate::error::{Error, ErrorKind, Location, Result};

const MAGIC: &[u8] = b"\x93NUMPY";

/// A number from its bytes.
type Decode = fn(&[u8]) -> f64;

/// The types of numbers: how the header writes them, and their sizes in bytes.
const TYPES: &[(&str, usize, Decode)] = &[
    ("<f4", 4, |b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]))),
    ("<f8", 8, |b| f64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]])),
    ("|i1", 1, |b| f64::from(b[0] as i8)),
    ("|u1", 1, |b| f64::from(b[0])),
    ("<i2", 2, |b| f64::from(i16::from_le_bytes([b[0], b[1]]))),
    ("<u2", 2, |b| f64::from(u16::from_le_bytes([b[0], b[1]]))),
    ("<i4", 4, |b| f64::from(i32::from_le_bytes([b[0], b[1], b[2], b[3]]))),
    ("<u4", 4, |b| f64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]]))),
    ("<i8", 8, |b| i64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]]) as f64),
    ("<u8", 8, |b| u64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]]) as f64),
];

/// The rows of an array of the shape `(n, N)`, with at most `limit` of them.
///
/// # Errors
/// `Syntax` for bytes that are no such file, or of another length than their header says; `Invalid` for an array of another shape;
/// `Unsupported` for other types of numbers; `Limit` for more rows.
pub fn rows<const N: usize>(bytes: &[u8], at: &Location, limit: u64) -> Result<Vec<[f64; N]>> {
    let header = header(bytes, at)?;
    match *header.shape {
        [count, columns] if columns == N as u64 => rows_of(&header, Some(count), at, limit),
        [count] if N == 1 => rows_of(&header, Some(count), at, limit),
        _ => Err(header.misshaped(&format!("(n, {N})"), at)),
    }
}

/// The size along x, y and z of an array of the shape `(z, y, x)`, or `(z, y, x, N)` of N numbers, and its values, x fastest; at most
/// `limit` of them.
///
/// # Errors
/// As [`rows`].
pub fn grid<const N: usize>(bytes: &[u8], at: &Location, limit: u64) -> Result<([u32; 3], Vec<[f64; N]>)> {
    let header = header(bytes, at)?;
    let [z, y, x] = match *header.shape {
        [z, y, x] if N == 1 => [z, y, x],
        [z, y, x, columns] if columns == N as u64 => [z, y, x],
        _ => {
            let expected = if N == 1 { "(z, y, x)".to_owned() } else { format!("(z, y, x, {N})") };
            return Err(header.misshaped(&expected, at));
        }
    };
    if header.is_by_columns {
        let message = "an array in the order of Fortran; expected that of C";
        return Err(Error::new(ErrorKind::Unsupported, at, message)
            .hint("`numpy.ascontiguousarray(array)` converts it"));
    }
    let side = |cells: u64| u32::try_from(cells).unwrap_or(u32::MAX);
    let count = z.checked_mul(y).and_then(|plane| plane.checked_mul(x));
    Ok(([x, y, z].map(side), rows_of(&header, count, at, limit)?))
}

/// The bytes of a file of an array of this shape, of numbers of single precision.
pub fn write_f32(shape: &[usize], numbers: impl Iterator<Item = f32>) -> Vec<u8> {
    written("<f4", shape, numbers.flat_map(f32::to_le_bytes))
}

/// As [`write_f32`], of double precision.
pub fn write_f64(shape: &[usize], numbers: impl Iterator<Item = f64>) -> Vec<u8> {
    written("<f8", shape, numbers.flat_map(f64::to_le_bytes))
}

/// As [`write_f32`], of whole numbers.
pub fn write_u32(shape: &[usize], numbers: impl Iterator<Item = u32>) -> Vec<u8> {
    written("<u4", shape, numbers.flat_map(u32::to_le_bytes))
}

fn written(kind: &str, shape: &[usize], data: impl Iterator<Item = u8>) -> Vec<u8> {
    let sides: String = shape.iter().map(|side| format!("{side}, ")).collect();
    let mut header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({sides}), }}");
    // Numbers begin at a multiple of 64 bytes.
    let length = (MAGIC.len() + 4 + header.len() + 1).next_multiple_of(64) - MAGIC.len() - 4;
    header.extend(std::iter::repeat_n(' ', length - 1 - header.len()));
    header.push('\n');
    let mut bytes = MAGIC.to_vec();
    bytes.extend([1, 0]);
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

/// The numbers of an array in rows of N, of so many rows; `None` for more than can be counted.
fn rows_of<const N: usize>(
    header: &Header<'_>,
    count: Option<u64>,
    at: &Location,
    limit: u64,
) -> Result<Vec<[f64; N]>> {
    let &Header { kind, is_by_columns, data, .. } = header;
    let &(_, size, decode) = TYPES.iter().find(|(name, ..)| *name == kind).ok_or_else(|| {
        let known: Vec<&str> = TYPES.iter().map(|(name, ..)| *name).collect();
        let message = format!("numbers of the type {kind:?}; expected one of {}", known.join(", "));
        Error::new(ErrorKind::Unsupported, at, message).hint("`array.astype('<f4')` converts them")
    })?;
    let count = count.unwrap_or(u64::MAX);
    if count > limit {
        let message = format!("{count} rows are more than the limit of {limit}");
        return Err(Error::new(ErrorKind::Limit, at, message));
    }
    let expected = count * (N * size) as u64;
    if data.len() as u64 != expected {
        let message = format!("{} bytes of numbers; its header says {expected}", data.len());
        return Err(Error::syntax(at, message).hint("the file is damaged: write it again"));
    }
    let count = count as usize;
    let number = |row: usize, column: usize| {
        let index = if is_by_columns { column * count + row } else { row * N + column };
        decode(&data[index * size..][..size])
    };
    Ok((0..count).map(|row| std::array::from_fn(|column| number(row, column))).collect())
}

/// The header of a file, a literal of Python, and what follows.
struct Header<'a> {
    kind: &'a str,
    is_by_columns: bool,
    shape: Vec<u64>,
    data: &'a [u8],
}

impl Header<'_> {
    fn misshaped(&self, expected: &str, at: &Location) -> Error {
        let found: Vec<String> = self.shape.iter().map(u64::to_string).collect();
        Error::invalid(at, format!("an array of the shape ({}); expected {expected}", found.join(", ")))
    }
}

fn header<'a>(bytes: &'a [u8], at: &Location) -> Result<Header<'a>> {
    let no_array = || Error::syntax(at, "no array of NumPy: its header is not that of a .npy file");
    let [major, _, rest @ ..] = bytes.strip_prefix(MAGIC).ok_or_else(no_array)? else {
        return Err(no_array());
    };
    let (length, rest) = match (major, rest) {
        (1, [a, b, rest @ ..]) => (u32::from(u16::from_le_bytes([*a, *b])), rest),
        (2 | 3, [a, b, c, d, rest @ ..]) => (u32::from_le_bytes([*a, *b, *c, *d]), rest),
        _ => return Err(no_array()),
    };
    let (text, data) = rest.split_at_checked(length as usize).ok_or_else(no_array)?;
    let text = std::str::from_utf8(text).map_err(|_| no_array())?;
    let value = |key: &str| Some(text.split_once(&format!("'{key}':"))?.1.trim_start());
    let quoted = |text: &'a str| text.strip_prefix('\'')?.split_once('\'').map(|(quoted, _)| quoted);
    let listed = |text: &'a str| text.strip_prefix('(')?.split_once(')').map(|(listed, _)| listed);
    let kind = value("descr").and_then(quoted).ok_or_else(no_array)?;
    let order = value("fortran_order").ok_or_else(no_array)?;
    let shape = value("shape").and_then(listed).ok_or_else(no_array)?;
    let sides = shape.split(',').map(str::trim).filter(|side| !side.is_empty());
    let shape = sides.map(|side| side.parse().map_err(|_| no_array())).collect::<Result<_>>()?;
    Ok(Header { kind, is_by_columns: order.starts_with("True"), shape, data })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(version: u8, header: &str, data: &[u8]) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend([version, 0]);
        match version {
            1 => bytes.extend((header.len() as u16).to_le_bytes()),
            _ => bytes.extend((header.len() as u32).to_le_bytes()),
        }
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    fn read(bytes: &[u8]) -> Result<Vec<[f64; 2]>> {
        rows(bytes, &Location::default(), 100)
    }

    #[test]
    fn rows_and_columns_of_all_versions() {
        let numbers: Vec<u8> = [1.0_f32, 2.0, 3.0, 4.0].iter().flat_map(|x| x.to_le_bytes()).collect();
        for version in [1, 2, 3] {
            let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2), }    \n";
            assert_eq!(read(&file(version, header, &numbers)).unwrap(), [[1.0, 2.0], [3.0, 4.0]]);
        }
        let by_columns = "{'descr': '<f4', 'fortran_order': True, 'shape': (2, 2), }";
        assert_eq!(read(&file(1, by_columns, &numbers)).unwrap(), [[1.0, 3.0], [2.0, 4.0]]);
        let bytes = "{'descr': '|i1', 'fortran_order': False, 'shape': (1, 2), }";
        assert_eq!(read(&file(1, bytes, &[7, 255])).unwrap(), [[7.0, -1.0]]);
        let none = "{'descr': '<i8', 'fortran_order': False, 'shape': (0, 2), }";
        assert_eq!(read(&file(1, none, &[])).unwrap(), [[0.0; 2]; 0]);
    }

    #[test]
    fn what_is_wrong_is_told() {
        let of = |header: &str, data: &[u8]| read(&file(1, header, data)).unwrap_err();
        let shaped = |shape: &str| format!("{{'descr': '|u1', 'fortran_order': False, 'shape': {shape}, }}");
        assert!(of(&shaped("(2,)"), &[1, 2]).message.contains("the shape (2); expected (n, 2)"));
        assert!(of(&shaped("(2, 3)"), &[0; 6]).message.contains("the shape (2, 3)"));
        assert!(of(&shaped("(2, 2)"), &[0; 3]).message.contains("3 bytes of numbers; its header says 4"));
        assert_eq!(of(&shaped("(101, 2)"), &[0; 202]).kind, ErrorKind::Limit);
        assert_eq!(of(&shaped("(9223372036854775807, 2)"), &[]).kind, ErrorKind::Limit);
        let big_endian = "{'descr': '>f4', 'fortran_order': False, 'shape': (0, 2), }";
        assert_eq!(of(big_endian, &[]).kind, ErrorKind::Unsupported);
        for bytes in [
            &b""[..],
            b"\x93NUMPY",
            b"\x93NUMPY\x01\x00\xff\xff",
            b"\x93NUMPY\x04\x00\x00\x00",
            b"PK\x03\x04",
        ] {
            assert_eq!(read(bytes).unwrap_err().kind, ErrorKind::Syntax);
        }
        assert_eq!(of("{'descr': 4}", &[]).kind, ErrorKind::Syntax);
    }
}
