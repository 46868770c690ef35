//! Missing files: reading continues without them, and one error at the end lists all.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

/// The number of missing files after which reading stops.
const MOST_MISSING: usize = 1000;

/// The missing files so far.
#[derive(Default)]
pub(super) struct Missing {
    /// In the order of discovery.
    errors: Vec<Error>,
    /// The files of these errors.
    paths: BTreeSet<PathBuf>,
    /// Whether a part of the scene's text is missing, so that unknown names may be defined there.
    has_text: bool,
}

impl Missing {
    /// Records a missing file, once per file.
    ///
    /// # Errors
    /// The given error if there are too many.
    pub(super) fn add(&mut self, path: &Path, error: Error) -> Result<()> {
        if self.errors.len() >= MOST_MISSING {
            return Err(error);
        }
        if self.paths.insert(path.to_owned()) {
            self.errors.push(error);
        }
        Ok(())
    }

    /// As [`add`](Self::add), for a part of the scene's text.
    ///
    /// # Errors
    /// As [`add`](Self::add).
    pub(super) fn add_text(&mut self, path: &Path, error: Error) -> Result<()> {
        self.has_text = true;
        self.add(path, error)
    }

    /// All errors as one: missing files, and the error that stopped reading unless missing text explains it.
    pub(super) fn and(self, result: Result<()>) -> Option<Error> {
        let mut errors = self.errors;
        if !self.has_text || errors.is_empty() {
            errors.extend(result.err());
        }
        Error::all(errors)
    }
}
