//! Bytes that are read one after the other.

use crate::error::{Error, ErrorKind, Result};
use crate::volume::bytes::Bytes;

/// Bytes, and the position of the next one.
pub(super) struct Cursor<'a> {
    pub(super) bytes: Bytes<'a>,
    pub(super) at: u64,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(bytes: Bytes<'a>, at: u64) -> Self {
        Self { bytes, at }
    }

    /// The next bytes.
    ///
    /// # Errors
    /// `Syntax` if there are fewer, as in all that follows.
    pub(super) fn slice(&mut self, length: u64, what: &str) -> Result<&'a [u8]> {
        let slice = self.bytes.slice(self.at, length, what)?;
        self.at += length;
        Ok(slice)
    }

    pub(super) fn u8(&mut self) -> Result<u8> {
        self.number().map(u8::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Result<u32> {
        self.number().map(u32::from_le_bytes)
    }

    pub(super) fn i32(&mut self) -> Result<i32> {
        self.number().map(i32::from_le_bytes)
    }

    pub(super) fn i64(&mut self) -> Result<i64> {
        self.number().map(i64::from_le_bytes)
    }

    pub(super) fn f64(&mut self) -> Result<f64> {
        self.number().map(f64::from_le_bytes)
    }

    fn number<const N: usize>(&mut self) -> Result<[u8; N]> {
        let number = self.bytes.number(self.at)?;
        self.at += N as u64;
        Ok(number)
    }

    /// A text, which follows its length.
    pub(super) fn text(&mut self, what: &str) -> Result<&'a [u8]> {
        let length = self.u32()?.into();
        self.slice(length, what)
    }

    /// Passes metadata, and tells of the name, the position and the bytes of each value.
    ///
    /// # Errors
    /// Errors of `of`, besides.
    pub(super) fn metadata(&mut self, mut of: impl FnMut(&[u8], u64, &[u8]) -> Result<()>) -> Result<()> {
        for _ in 0..self.u32()? {
            let name = self.text("the name of a value")?;
            self.text("the type of a value")?;
            let at = self.at + 4;
            of(name, at, self.text("a value")?)?;
        }
        Ok(())
    }

    /// An error at the position.
    pub(super) fn error(&self, kind: ErrorKind, message: impl std::fmt::Display) -> Error {
        self.bytes.error(self.at, kind, message)
    }

    /// The error that what is at the position cannot be.
    pub(super) fn damaged(&self, message: impl std::fmt::Display) -> Error {
        self.error(ErrorKind::Syntax, message).hint("the file may be damaged: write it again")
    }
}
