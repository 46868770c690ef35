//! The proof that a document is read back to the scene that it was written from: written again, it is the same, and so are its files.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::{Sources, Written, write};
use crate::budget::Budget;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::{Files, LoadContext};
use crate::load;

impl Written {
    /// Reads the document back, and compares.
    ///
    /// # Errors
    /// Errors of the reader, and `Unsupported` for a document that says something else than the scene: with the first line that does.
    pub fn check(&self, folder: &str, budget: &Budget) -> Result<()> {
        let name = format!("{folder}.toml");
        let files = OfDocument::new(self, &name);
        let mut context = LoadContext::within(budget, &files);
        let scene = load::scene(Path::new(&name), &mut context)?;
        let paths = self.files.iter().map(|(name, _)| PathBuf::from(name)).collect();
        let again = write(&scene, folder, &Sources { files: &files, paths, budget: budget.clone() })?;
        let differs =
            |message: String| Err(Error::new(ErrorKind::Unsupported, &Location::default(), message));
        if self.text != again.text {
            let pairs = self.text.lines().zip(again.text.lines().chain(std::iter::repeat("")));
            let line = pairs.enumerate().find(|(_, (before, after))| before != after);
            let (line, (before, after)) = line.unwrap_or_default();
            let message = "the document does not give the scene back";
            return differs(format!("{message}: line {} is `{before}`, and would be `{after}`", line + 1));
        }
        let other = self.files.iter().zip(&again.files).find(|(before, after)| before != after);
        match other {
            Some(((name, _), _)) => differs(format!("the file {name} does not give the scene back")),
            None if self.files.len() != again.files.len() => {
                differs(format!("there would be {} files, and not {}", again.files.len(), self.files.len()))
            }
            None => Ok(()),
        }
    }
}

/// The files of a document that is in memory.
struct OfDocument<'a>(BTreeMap<&'a Path, &'a [u8]>);

impl<'a> OfDocument<'a> {
    /// The document has a name of its own.
    fn new(written: &'a Written, name: &'a str) -> Self {
        let files = written.files.iter().map(|(name, bytes)| (Path::new(name), &bytes[..]));
        Self(files.chain([(Path::new(name), written.text.as_bytes())]).collect())
    }
}

impl Files for OfDocument<'_> {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>> {
        let found = self.0.get(path).filter(|bytes| bytes.len() as u64 <= limit);
        found
            .map(|bytes| bytes.to_vec())
            .ok_or_else(|| Error::new(ErrorKind::Io, &Location::file(path), "no such file"))
    }

    fn length(&self, path: &Path) -> Option<u64> {
        self.0.get(path).map(|bytes| bytes.len() as u64)
    }
}
