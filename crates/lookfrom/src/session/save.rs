//! Pictures in files, whose extensions determine their formats.

use std::path::Path;

use lookfrom_scene::{Error, ErrorKind, Location, Result};

use super::{Developed, Finished, Format};

impl Developed {
    /// Writes a file of the picture, in the format of its extension. A file of that name is replaced.
    ///
    /// # Errors
    /// `Request` for an extension of no format; as [`Developed::encode`]; `Io` where the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        save(path.as_ref(), |format| self.encode(format))
    }
}

impl Finished {
    /// Writes a file of the picture, in the format of its extension. A file of that name is replaced.
    ///
    /// # Errors
    /// As [`Developed::save`].
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        save(path.as_ref(), |format| self.encode(format))
    }
}

/// Writes what is encoded in the format of a file's extension. What cannot be encoded replaces no file.
fn save(path: &Path, encode: impl FnOnce(Format) -> Result<Vec<u8>>) -> Result<()> {
    let at = Location::file(path);
    let Some(format) = Format::of_path(path) else {
        let all: Vec<_> = Format::EXTENSIONS.iter().map(|(extension, _)| format!(".{extension}")).collect();
        let message = format!("its extension is of no format; pictures are written as {}", all.join(", "));
        return Err(Error::new(ErrorKind::Request, &at, message));
    };
    let bytes = encode(format).map_err(|error| Error { at: at.clone(), ..error })?;
    std::fs::write(path, bytes).map_err(|error| Error::new(ErrorKind::Io, &at, error.to_string()))
}
