//! Conversion of byte offsets in a scene file to line and column.
//!
//! Lines are counted only on demand, and starting from the last count, so a large file is not searched for line ends
//! before it is read, nor again for every shape.

use std::cell::Cell;
use std::path::Path;
use std::rc::Rc;

use crate::budget::Reserved;
use crate::error::{Error, ErrorKind, Location};

/// A file's content, with the state for converting offsets to locations.
pub(super) struct Text {
    whole: Location,
    bytes: Reserved<Vec<u8>>,
    /// The last place that was counted to.
    counted: Cell<Counted>,
}

#[derive(Clone, Copy)]
struct Counted {
    offset: usize,
    /// From 1.
    line: u32,
    /// Characters of the line before it.
    characters: usize,
}

/// The beginning of a file.
const START: Counted = Counted { offset: 0, line: 1, characters: 0 };

impl Text {
    pub(super) fn new(path: &Path, bytes: Reserved<Vec<u8>>) -> Rc<Self> {
        Rc::new(Self { whole: Location::file(path), bytes, counted: Cell::new(START) })
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    fn location(&self, offset: usize) -> Location {
        let counted = self.counted.get();
        let from = if offset < counted.offset { START } else { counted };
        let between = &self.bytes[from.offset..offset];
        let lines = between.iter().filter(|&&byte| byte == b'\n').count() as u32;
        let line_start = between.iter().rposition(|&byte| byte == b'\n').map(|last| last + 1);
        // Bytes that begin a character.
        let characters =
            between[line_start.unwrap_or(0)..].iter().filter(|&byte| byte & 0xC0 != 0x80).count();
        let before = if line_start.is_some() { 0 } else { from.characters };
        let counted =
            Counted { offset, line: from.line.saturating_add(lines), characters: before + characters };
        self.counted.set(counted);
        self.whole.at(counted.line, u32::try_from(counted.characters + 1).unwrap_or(0))
    }
}

/// A byte offset in a file.
#[derive(Clone)]
pub(super) struct Place {
    text: Rc<Text>,
    offset: usize,
}

impl Place {
    pub(super) fn new(text: &Rc<Text>, offset: usize) -> Self {
        Self { text: text.clone(), offset: offset.min(text.bytes.len()) }
    }

    pub(super) fn location(&self) -> Location {
        self.text.location(self.offset)
    }

    /// An error here.
    pub(super) fn error(&self, kind: ErrorKind, message: impl std::fmt::Display) -> Error {
        Error::new(kind, &self.location(), message.to_string())
    }

    /// An error of kind `Syntax` at this place.
    pub(super) fn syntax(&self, message: impl std::fmt::Display) -> Error {
        self.error(ErrorKind::Syntax, message)
    }

    /// An error of kind `Invalid` at this place.
    pub(super) fn invalid(&self, message: impl std::fmt::Display) -> Error {
        self.error(ErrorKind::Invalid, message)
    }

    /// Relocates to here the error of a file that cannot be opened or has no known format; errors inside a file stay there.
    pub(super) fn blame(&self, error: Error) -> Error {
        if error.at.line > 0 || !matches!(error.kind, ErrorKind::Io | ErrorKind::Unsupported) {
            return error;
        }
        self.locate(error)
    }

    /// Relocates to here the error of a file that what is written here is the reason of.
    pub(super) fn locate(&self, error: Error) -> Error {
        let message = format!("{}: {}", error.at, error.message);
        Error { hint: error.hint, ..self.error(error.kind, message) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_counted_forwards_and_backwards() {
        let text = Text::new(Path::new("a"), "one\ntwö x\n\nfour".as_bytes().to_vec().into());
        let at = |offset: usize| {
            let location = Place::new(&text, offset).location();
            (location.line, location.column)
        };
        assert_eq!(
            [at(0), at(4), at(9), at(11), at(12), at(99)],
            [(1, 1), (2, 1), (2, 5), (3, 1), (4, 1), (4, 5)]
        );
        assert_eq!([at(9), at(2), at(12)], [(2, 5), (1, 3), (4, 1)]);
    }
}
