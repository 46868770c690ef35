//! Values of PLY files: ASCII, and binary of either byte order.

use super::header::{Format, Header, Scalar};
use crate::error::{Error, ErrorKind, Location, Result};
use crate::model::number::{parse_f32, parse_f64};
use crate::model::scan::{Scanner, shown};
use crate::model::tally::Tally;

/// A cursor over values.
pub(super) struct Reader<'a> {
    file: &'a Location,
    bytes: &'a [u8],
    format: Format,
    /// Offset in binary formats.
    position: usize,
    /// The scanner of the text in ASCII.
    scanner: Scanner<'a>,
    header_bytes: usize,
    header_lines: u32,
    /// Number of rows that the header declares.
    rows: u64,
    /// Whether each row of a text has a line of its own; `None` until it matters.
    by_lines: Option<bool>,
    /// Rows of a text with more values than the header declares.
    pub(super) longer: Tally,
}

impl<'a> Reader<'a> {
    /// A cursor at the first value; `bytes` are those after the header.
    pub(super) fn new(bytes: &'a [u8], header: &Header, file: &'a Location) -> Self {
        let scanner = Scanner::new(bytes);
        let (header_bytes, header_lines) = (header.length, header.lines);
        let rows = header.elements.iter().fold(0_u64, |rows, element| rows.saturating_add(element.count));
        Self {
            file,
            bytes,
            format: header.format,
            position: 0,
            scanner,
            header_bytes,
            header_lines,
            rows,
            by_lines: None,
            longer: Tally::default(),
        }
    }

    /// Number of bytes read after the header.
    pub(super) fn position(&self) -> usize {
        if self.format == Format::Ascii { self.scanner.position() } else { self.position }
    }

    /// Number of remaining bytes.
    pub(super) fn left(&self) -> usize {
        self.bytes.len() - self.position()
    }

    /// The line in the file; 0 in binary formats.
    pub(super) fn line(&self) -> u32 {
        if self.format == Format::Ascii { self.header_lines + self.scanner.line() - 1 } else { 0 }
    }

    /// An error at a line (in ASCII) or at an offset after the header (in binary formats).
    pub(super) fn error_at(&self, line: u32, position: usize, kind: ErrorKind, message: String) -> Error {
        let place = if self.format == Format::Ascii {
            String::new()
        } else {
            format!(" (at byte {})", self.header_bytes + position)
        };
        Error::new(kind, &self.file.at(line, 0), message + &place)
    }

    fn ended(&self) -> Error {
        self.error_at(
            self.line(),
            self.position(),
            ErrorKind::Syntax,
            "the file ends before all its values".to_owned(),
        )
        .hint("the file may be cut off, or its header may be wrong")
    }

    pub(super) fn is_binary(&self) -> bool {
        self.format != Format::Ascii
    }

    /// The next value, of which a text may tell more than its type holds.
    pub(super) fn exact_value(&mut self, scalar: Scalar) -> Result<f64> {
        self.value(if scalar == Scalar::F32 && !self.is_binary() { Scalar::F64 } else { scalar })
    }

    /// The next value.
    pub(super) fn value(&mut self, scalar: Scalar) -> Result<f64> {
        match self.format {
            Format::Ascii => {
                let word = self.scanner.word_across_lines();
                if word.is_empty() {
                    return Err(self.ended());
                }
                let number = match scalar {
                    // Parsed as `f32`, so that it is rounded only once.
                    Scalar::F32 => parse_f32(word).map(f64::from),
                    _ => parse_f64(word),
                };
                number.ok_or_else(|| {
                    let at = self.scanner.at(self.file);
                    let at = at.at(self.line(), at.column);
                    Error::syntax(&at, format!("expected a number, found `{}`", shown(word)))
                })
            }
            Format::LittleEndian => self.binary(scalar, false),
            Format::BigEndian => self.binary(scalar, true),
        }
    }

    fn binary(&mut self, scalar: Scalar, big: bool) -> Result<f64> {
        let size = scalar.size();
        let Some(bytes) = self.bytes.get(self.position..self.position + size) else {
            return Err(self.ended());
        };
        self.position += size;
        // The bytes in little-endian order.
        let mut little = [0_u8; 8];
        little[..size].copy_from_slice(bytes);
        if big {
            little[..size].reverse();
        }
        let bits = u64::from_le_bytes(little);
        Ok(match scalar {
            Scalar::I8 => f64::from(bits as i8),
            Scalar::U8 => f64::from(bits as u8),
            Scalar::I16 => f64::from(bits as i16),
            Scalar::U16 => f64::from(bits as u16),
            Scalar::I32 => f64::from(bits as i32),
            Scalar::U32 => f64::from(bits as u32),
            Scalar::F32 => f64::from(f32::from_bits(bits as u32)),
            Scalar::F64 => f64::from_bits(bits),
        })
    }

    /// Calls `each` with the values of the next list.
    pub(super) fn list(&mut self, count: Scalar, item: Scalar, mut each: impl FnMut(f64)) -> Result<()> {
        let position = self.position();
        let values = self.value(count)?;
        if values < 0.0 || values.fract() != 0.0 || values > self.left() as f64 {
            let message = format!(
                "a list of {}, but only {} left",
                crate::plural::counted(values as u64, "value"),
                crate::plural::are(self.left() as u64, "byte")
            );
            return Err(self
                .error_at(self.line(), position, ErrorKind::Syntax, message)
                .hint("the file may be cut off, or its header may be wrong"));
        }
        for _ in 0..values as u64 {
            each(self.value(item)?);
        }
        Ok(())
    }

    /// Ends a row. In a text with a line for each row, what the line has beyond the declared values is skipped.
    pub(super) fn end_row(&mut self) {
        if self.format != Format::Ascii || self.scanner.clone().word().is_empty() {
            return;
        }
        let (bytes, rows) = (self.bytes, self.rows);
        let has_lines = || {
            let lines = bytes.split(|byte| matches!(byte, b'\n' | b'\r'));
            lines.filter(|line| !line.trim_ascii().is_empty()).count() as u64 >= rows
        };
        if *self.by_lines.get_or_insert_with(has_lines) {
            self.longer.add(self.line());
            self.scanner.rest_of_line();
        }
    }

    /// Skips bytes of a binary format; returns false in ASCII.
    pub(super) fn skip_bytes(&mut self, count: u64) -> bool {
        let is_binary = self.format != Format::Ascii;
        if is_binary {
            self.position += count as usize;
        }
        is_binary
    }
}
