//! The text of a scene, locations in it, and error recovery: after an error, reading continues with a placeholder value, and
//! the scene is discarded in the end.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

use crate::error::{Error, Location};

/// Maximum number of errors recorded per file.
const MOST_ERRORS: usize = 1000;

/// Bytes of a value as the parser returns it, with the tokens from which it is made.
const VALUE: u64 = 200;

/// Bytes of a table as the parser returns it.
const TABLE: u64 = 1000;

/// An estimate of the memory that parsing takes, from the signs without which there is no value, and from the points that
/// are not those of numbers in a list: in keys and headers each may begin a table.
pub(super) fn memory(text: &[u8]) -> u64 {
    let values = text.iter().filter(|byte| matches!(byte, b',' | b'=' | b'[' | b'\n')).count();
    let count = |line: &[u8], sign: u8| line.iter().filter(|&&byte| byte == sign).count() as u64;
    let points = |line: &[u8]| match line.trim_ascii_start().starts_with(b"#") {
        true => 0,
        false => count(line, b'.').saturating_sub(count(line, b',') + 1),
    };
    values as u64 * VALUE + text.split(|&byte| byte == b'\n').map(points).sum::<u64>() * TABLE
}

/// A file's text, its line starts, and the errors recorded so far.
pub(super) struct Document {
    whole: Location,
    text: String,
    line_starts: Vec<usize>,
    /// By byte offset and message, so that each is recorded once.
    errors: RefCell<BTreeMap<(usize, String), Error>>,
    /// Lines and columns of values that could not be determined.
    refused: RefCell<BTreeSet<(u32, u32)>>,
}

impl Document {
    pub(super) fn new(whole: Location, text: String) -> Self {
        let breaks = text.bytes().enumerate().filter(|&(_, byte)| byte == b'\n').map(|(index, _)| index + 1);
        let line_starts = std::iter::once(0).chain(breaks).collect();
        Self { whole, text, line_starts, errors: RefCell::default(), refused: RefCell::default() }
    }

    /// Records an error at a byte offset; reading continues.
    pub(super) fn note(&self, offset: usize, error: Error) {
        let is_consequence = self.refused.borrow().contains(&(error.at.line, error.at.column));
        if !self.is_full() && !error.is_untold() && !is_consequence {
            self.errors.borrow_mut().entry((offset, error.message.clone())).or_insert(error);
        }
    }

    /// Records why the value at a byte offset cannot be determined. Later errors at its place are consequences, which are not
    /// told.
    pub(super) fn refuse(&self, offset: usize, error: Error) {
        self.note(offset, error);
        let Location { line, column, .. } = self.location(offset);
        self.refused.borrow_mut().insert((line, column));
    }

    /// Whether an error was recorded at a byte offset.
    pub(super) fn is_noted(&self, offset: usize) -> bool {
        self.errors.borrow().range((offset, String::new())..).next().is_some_and(|((at, _), _)| *at == offset)
    }

    /// The number of recorded errors.
    pub(super) fn count(&self) -> usize {
        self.errors.borrow().len()
    }

    /// Whether the maximum number of errors is reached.
    pub(super) fn is_full(&self) -> bool {
        self.count() >= MOST_ERRORS
    }

    /// The recorded errors, and some others of the same file, in the order of its lines.
    pub(super) fn errors(&self, others: Vec<Error>) -> Vec<Error> {
        let line = |offset: usize| self.location(offset).line;
        let others = others.into_iter().map(|error| (error.at.line, error));
        let noted = self.errors.take().into_iter().map(|((offset, _), error)| (line(offset), error));
        let mut all: Vec<(u32, Error)> = others.chain(noted).collect();
        all.sort_by_key(|&(line, _)| line);
        all.into_iter().map(|(_, error)| error).collect()
    }

    pub(super) fn text(&self) -> &str {
        &self.text
    }

    /// The line and column of a byte offset.
    pub(super) fn location(&self, offset: usize) -> Location {
        let line = self.line_starts.partition_point(|&start| start <= offset);
        let start = self.line_starts[line - 1];
        let before = self.text.get(start..offset).map_or(0, |text| text.chars().count());
        self.whole.at(u32::try_from(line).unwrap_or(0), u32::try_from(before + 1).unwrap_or(0))
    }
}

impl Error {
    /// An error that is not reported, since it follows from a reported one.
    pub(super) fn untold() -> Self {
        Self::invalid(&Location::default(), "")
    }

    fn is_untold(&self) -> bool {
        self.message.is_empty()
    }
}
