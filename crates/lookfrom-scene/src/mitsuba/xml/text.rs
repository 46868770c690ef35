//! The text of a file of XML, and places in it.

use std::cell::Cell;
use std::path::{Path, PathBuf};

use super::MOST_NODES;
use crate::error::{Error, ErrorKind, Location, Result};

/// The text of a file, with the beginnings of its lines.
pub(in crate::mitsuba) struct Text {
    pub(super) whole: Location,
    pub(super) text: String,
    lines: Vec<usize>,
    /// The line, offset and column that were counted last: a file may be one long line.
    counted: Cell<(usize, usize, u32)>,
    /// The folder of the file.
    pub(super) folder: PathBuf,
}

impl Text {
    pub(super) fn new(path: &Path, bytes: &[u8]) -> Result<Self> {
        let whole = Location::file(path);
        let bytes = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes);
        let text = std::str::from_utf8(bytes).map_err(|_| {
            Error::syntax(&whole, "the text is not UTF-8").hint("save it in UTF-8 with a text editor")
        })?;
        let lines = std::iter::once(0).chain(text.match_indices('\n').map(|(index, _)| index + 1)).collect();
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Ok(Self { whole, text: text.to_owned(), lines, counted: Cell::new((1, 0, 1)), folder })
    }

    /// The location of a byte.
    pub(in crate::mitsuba) fn at(&self, offset: usize) -> Location {
        let line = self.lines.partition_point(|&start| start <= offset);
        let (counted_line, from, column) = self.counted.get();
        let (from, column) = if line == counted_line { (from, column) } else { (self.lines[line - 1], 1) };
        let count = |from, to| self.text.get(from..to).map_or(0, |between| between.chars().count() as u32);
        let column = if from <= offset { column + count(from, offset) } else { column - count(offset, from) };
        self.counted.set((line, offset, column));
        self.whole.at(line as u32, column)
    }

    /// An error of the XML parser, at its place in the file.
    pub(super) fn error(&self, error: &roxmltree::Error) -> Error {
        let pos = error.pos();
        let at = self.whole.at(pos.row, pos.col);
        match error {
            roxmltree::Error::DtdDetected => {
                Error::new(ErrorKind::Unsupported, &self.whole, "document type declarations are not read")
                    .hint("take the line with <!DOCTYPE …> out, and entities with it")
            }
            roxmltree::Error::NodesLimitReached => Error::new(
                ErrorKind::Limit,
                &self.whole,
                format!("more than {MOST_NODES} elements, texts and comments"),
            ),
            _ => Error::syntax(&at, error.to_string()),
        }
    }
}
