//! Errors of readers, with location, message and hint.
//!
//! Every reader returns [`Error`] for what stops it and collects [`Warning`](crate::Warning)s for recoverable problems.
//! Nothing here prints.

use std::fmt;
use std::path::Path;
use std::sync::Arc;

use crate::remedy::Remedy;

/// A location in a file. Lines and columns count from 1; 0 means that only the file (or only the line) is known.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Location {
    /// The name of the file as given by the user or by the file that includes it.
    pub file: Arc<str>,
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
    /// The location in a JSON document, as a pointer (RFC 6901) such as `/meshes/3/name`; empty for the whole document.
    pub pointer: Arc<str>,
}

impl Location {
    /// A file as a whole.
    pub fn file(path: &Path) -> Self {
        Self { file: path.display().to_string().into(), ..Self::default() }
    }

    /// Another location in the same file.
    pub fn at(&self, line: u32, column: u32) -> Self {
        Self { file: self.file.clone(), line, column, ..Self::default() }
    }

    /// A JSON pointer in the same file.
    pub fn pointer(&self, pointer: &str) -> Self {
        Self { file: self.file.clone(), pointer: pointer.into(), ..Self::default() }
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // One line, whatever the name.
        let name = if self.file.is_empty() { "<scene>".into() } else { self.file.replace('\n', "\u{fffd}") };
        match (self.line, self.column) {
            (0, _) if !self.pointer.is_empty() => write!(f, "{name}#{}", self.pointer),
            (0, _) => write!(f, "{name}"),
            (line, 0) => write!(f, "{name}:{line}"),
            (line, column) => write!(f, "{name}:{line}:{column}"),
        }
    }
}

/// The category of an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The file could not be read or written.
    Io,
    /// The bytes violate the format.
    Syntax,
    /// The syntax is correct, but a value is not meaningful (an index out of range, a radius of zero).
    Invalid,
    /// Valid, but not supported by this program.
    Unsupported,
    /// Larger or deeper than the stated limits allow.
    Limit,
    /// Options given in addition to the file do not suit the scene.
    Request,
}

/// An error: what was found and expected, its location, and a hint.
#[derive(Clone, Debug, PartialEq)]
pub struct Error {
    /// The category.
    pub kind: ErrorKind,
    /// The location.
    pub at: Location,
    /// The message: what was found and what was expected.
    pub message: String,
    /// A remedy, if one is known.
    pub hint: Option<Remedy>,
    /// Further errors found in the same run.
    pub more: Vec<Error>,
}

/// Maximum number of errors that are written out, including further ones; the rest are counted.
const MOST_WRITTEN: usize = 20;

impl Error {
    /// An error of `kind` at a location.
    pub fn new(kind: ErrorKind, at: &Location, message: impl Into<String>) -> Self {
        Self { kind, at: at.clone(), message: message.into(), hint: None, more: Vec::new() }
    }

    /// An error of kind [`ErrorKind::Syntax`]: the bytes violate the format.
    pub fn syntax(at: &Location, message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Syntax, at, message)
    }

    /// An error of kind [`ErrorKind::Invalid`]: a value that the format allows is not meaningful.
    pub fn invalid(at: &Location, message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Invalid, at, message)
    }

    /// Adds a remedy.
    pub fn hint(mut self, hint: impl Into<Remedy>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// Puts remedies, also those of further errors, into the words of a front end.
    #[must_use]
    pub fn worded(mut self, words: impl Fn(&Remedy) -> String) -> Self {
        let hints = std::iter::once(&mut self.hint).chain(self.more.iter_mut().map(|error| &mut error.hint));
        hints.flatten().for_each(|hint| *hint = Remedy::Words(words(hint)));
        self
    }

    /// All errors of a run as one: the first, with the others as further ones. `None` if there are none.
    pub fn all(errors: Vec<Self>) -> Option<Self> {
        let mut flat = errors.into_iter().flat_map(|mut error| {
            let more = std::mem::take(&mut error.more);
            std::iter::once(error).chain(more)
        });
        let first = flat.next()?;
        Some(Self { more: flat.collect(), ..first })
    }

    /// This error and its further ones.
    pub fn each(&self) -> impl Iterator<Item = &Self> {
        std::iter::once(self).chain(&self.more)
    }

    /// The first errors of [`each`](Self::each), which are written out, and the number of the others.
    pub fn first_few(&self) -> (impl Iterator<Item = &Self>, usize) {
        (self.each().take(MOST_WRITTEN), (1 + self.more.len()).saturating_sub(MOST_WRITTEN))
    }
}

/// For logs and messages: each error as `file:line:column: message` and an indented remedy, and the number of errors left
/// out. The lines they point at are not shown: see [`Excerpts`](crate::excerpt::Excerpts).
impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (written, left) = self.first_few();
        for (index, error) in written.enumerate() {
            let separator = if index == 0 { "" } else { "\n" };
            write!(f, "{separator}{}: {}", error.at, error.message)?;
            if let Some(hint) = &error.hint {
                write!(f, "\n  help: {hint}")?;
            }
        }
        if left > 0 { write!(f, "\n… and {left} more") } else { Ok(()) }
    }
}

impl std::error::Error for Error {}

/// The result of readers.
pub type Result<T> = std::result::Result<T, Error>;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remedies_are_told_in_the_words_of_a_front_end() {
        let error = |line| Error::invalid(&Location::default().at(line, 1), "no film").hint(Remedy::KeptFilm);
        let both = Error::all(vec![error(1), error(2)]).expect("two errors");
        let help = "help: render it with the option `film`";
        assert_eq!(both.to_string().matches(help).count(), 2, "{both}");
        assert_eq!(both.worded(|_| "film = true".into()).to_string().matches("help: film = true").count(), 2);
    }

    #[test]
    fn many_errors_are_one_that_writes_the_first_twenty() {
        let at = |line| Location::file(Path::new("a.toml")).at(line, 1);
        assert_eq!(Error::all(Vec::new()), None);
        let inner = Error::all(vec![Error::invalid(&at(1), "one"), Error::invalid(&at(2), "two")]);
        let all = vec![inner.expect("two errors"), Error::invalid(&at(3), "three").hint("count")];
        let all = Error::all(all).expect("three errors");
        assert_eq!(all.to_string(), "a.toml:1:1: one\na.toml:2:1: two\na.toml:3:1: three\n  help: count");
        assert!(all.more.iter().all(|error| error.more.is_empty()));
        let many = Error::all((1..=51).map(|line| Error::invalid(&at(line), "wrong")).collect());
        let text = many.expect("51 errors").to_string();
        assert!(text.ends_with("a.toml:20:1: wrong\n… and 31 more"), "{text}");
    }
}
