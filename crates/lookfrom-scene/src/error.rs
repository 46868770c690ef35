//! What can be wrong with what is on disk, where, and what to do about it.
//!
//! Every reader returns [`Error`] for what stops it and collects [`Warning`]s for what can be survived. Nothing here prints.

use std::fmt;
use std::path::Path;
use std::sync::Arc;

/// A place in a file. Lines and columns count from 1; 0 means that only the file (or only the line) is known.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Location {
    /// The file as it was named by the person or by the file that includes it.
    pub file: Arc<str>,
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
    /// Where in a JSON document, as a pointer (RFC 6901) such as `/meshes/3/name`; empty is the whole of it.
    pub pointer: Arc<str>,
}

impl Location {
    /// The whole of a file.
    pub fn file(path: &Path) -> Self {
        Self { file: path.display().to_string().into(), ..Self::default() }
    }

    /// Another place in the same file.
    pub fn at(&self, line: u32, column: u32) -> Self {
        Self { file: self.file.clone(), line, column, ..Self::default() }
    }

    /// A place in the same file that is a JSON document, by its pointer.
    pub fn pointer(&self, pointer: &str) -> Self {
        Self { file: self.file.clone(), pointer: pointer.into(), ..Self::default() }
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name: &str = if self.file.is_empty() { "<scene>" } else { &self.file };
        match (self.line, self.column) {
            (0, _) if !self.pointer.is_empty() => write!(f, "{name}#{}", self.pointer),
            (0, _) => write!(f, "{name}"),
            (line, 0) => write!(f, "{name}:{line}"),
            (line, column) => write!(f, "{name}:{line}:{column}"),
        }
    }
}

/// Whose fault it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// The file could not be read or written.
    Io,
    /// The bytes are not what the format allows.
    Syntax,
    /// The format is right, but what it says cannot be (an index out of range, a radius of zero).
    Invalid,
    /// Valid, but this program does not know it.
    Unsupported,
    /// Larger or deeper than the stated limits allow.
    Limit,
    /// What is asked of a scene, besides what its file says, does not suit it.
    Request,
}

/// What was found, what was expected, where, and what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error {
    /// Whose fault it is.
    pub kind: ErrorKind,
    /// Where.
    pub at: Location,
    /// What was found and what was expected.
    pub message: String,
    /// What to do about it, where that is known.
    pub hint: Option<String>,
}

impl Error {
    /// An error of `kind` at a place.
    pub fn new(kind: ErrorKind, at: &Location, message: impl Into<String>) -> Self {
        Self { kind, at: at.clone(), message: message.into(), hint: None }
    }

    /// The bytes are not what the format allows.
    pub fn syntax(at: &Location, message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Syntax, at, message)
    }

    /// What is said cannot be.
    pub fn invalid(at: &Location, message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Invalid, at, message)
    }

    /// The same error with a remedy.
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.at, self.message)?;
        match &self.hint {
            Some(hint) => write!(f, "\n  help: {hint}"),
            None => Ok(()),
        }
    }
}

impl std::error::Error for Error {}

/// Something that can be survived: the picture is made, but may differ from what was meant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// Where.
    pub at: Location,
    /// What was found and what was done instead.
    pub message: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.at, self.message)
    }
}

/// What a reader gives back.
pub type Result<T> = std::result::Result<T, Error>;
