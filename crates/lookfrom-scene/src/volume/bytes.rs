//! Numbers at places in bytes, little endian.

use crate::error::{Error, ErrorKind, Location, Result};

/// Bytes of a file.
#[derive(Clone, Copy)]
pub(crate) struct Bytes<'a> {
    bytes: &'a [u8],
    /// The position of the first of them, for messages.
    start: u64,
    file: &'a Location,
    /// Suffix of positions in messages.
    of: &'static str,
}

impl<'a> Bytes<'a> {
    /// Bytes of `file`; `of` follows their positions in messages.
    pub(crate) fn new(bytes: &'a [u8], file: &'a Location, of: &'static str) -> Self {
        Self { bytes, start: 0, file, of }
    }

    pub(crate) fn length(&self) -> u64 {
        self.bytes.len() as u64
    }

    /// The bytes from a position on.
    ///
    /// # Errors
    /// `Syntax` if there are fewer.
    pub(crate) fn slice(&self, at: u64, length: u64, what: &str) -> Result<&'a [u8]> {
        let end = at.checked_add(length).filter(|&end| end <= self.length());
        let slice = end.and_then(|end| self.bytes.get(at as usize..end as usize));
        slice.ok_or_else(|| {
            let left = self.length().saturating_sub(at);
            let message =
                format!("{what} takes {length} bytes, but {} left", crate::plural::are(left, "byte"));
            self.error(at, ErrorKind::Syntax, message).hint("the file may be cut off, or damaged")
        })
    }

    /// As [`slice`](Self::slice), with the same positions in messages.
    ///
    /// # Errors
    /// `Syntax` if there are fewer.
    pub(crate) fn part(&self, at: u64, length: u64, what: &str) -> Result<Self> {
        Ok(Self { bytes: self.slice(at, length, what)?, start: self.start + at, ..*self })
    }

    /// The number at a position, by its bytes.
    pub(crate) fn number<const N: usize>(&self, at: u64) -> Result<[u8; N]> {
        let mut bytes = [0; N];
        bytes.copy_from_slice(self.slice(at, N as u64, "a number")?);
        Ok(bytes)
    }

    pub(crate) fn u16(&self, at: u64) -> Result<u16> {
        self.number(at).map(u16::from_le_bytes)
    }

    pub(crate) fn u32(&self, at: u64) -> Result<u32> {
        self.number(at).map(u32::from_le_bytes)
    }

    pub(crate) fn i32(&self, at: u64) -> Result<i32> {
        self.number(at).map(i32::from_le_bytes)
    }

    pub(crate) fn u64(&self, at: u64) -> Result<u64> {
        self.number(at).map(u64::from_le_bytes)
    }

    pub(crate) fn f32(&self, at: u64) -> Result<f32> {
        self.number(at).map(f32::from_le_bytes)
    }

    pub(crate) fn f64(&self, at: u64) -> Result<f64> {
        self.number(at).map(f64::from_le_bytes)
    }

    /// An error at a position.
    pub(crate) fn error(&self, at: u64, kind: ErrorKind, message: impl std::fmt::Display) -> Error {
        let at = self.start.saturating_add(at);
        Error::new(kind, self.file, format!("{message} (at byte {at}{})", self.of))
    }
}
