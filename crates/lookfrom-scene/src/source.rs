//! A file as it comes in: read once, unpacked, with its format.

use std::path::Path;

use crate::budget::Reserved;
use crate::error::{Error, Location, Result};
use crate::files::LoadContext;
use crate::format::Format;
use crate::packed;

/// The content of a file and its format.
pub(crate) struct Source<'p> {
    /// The path, which files that it names are relative to.
    pub(crate) path: &'p Path,
    /// The content, unpacked.
    pub(crate) bytes: Reserved<Vec<u8>>,
    /// The format; `None` if neither the name nor the content is that of a known one.
    pub(crate) format: Option<Format>,
}

impl<'p> Source<'p> {
    /// Reads a file.
    ///
    /// # Errors
    /// `Io` and `Limit` if it cannot be read, `Syntax` if it is damaged, or empty and no scene by its name.
    pub(crate) fn open(path: &'p Path, context: &LoadContext<'_>) -> Result<Self> {
        let named = Format::of_name(path);
        let bytes = match named {
            Some(format) if !format.may_be_packed() => context.read(path)?,
            _ => packed::read(path, context)?,
        };
        if bytes.is_empty() && named.is_none_or(Format::is_model) {
            return Err(Error::syntax(&Location::file(path), "the file is empty"));
        }
        Ok(Self { path, format: Format::of_content(&bytes, named), bytes })
    }
}
