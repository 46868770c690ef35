//! Films: the exact sums of samples, in memory and in files.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use lookfrom::scene::settings::Background;
use lookfrom::scene::{Budget, Disk, Error, ErrorKind, LoadContext, Location, Result as SceneResult};
use lookfrom::session::{Exposure, FilmFile};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use super::command::{Words, asked};
use super::error::raised;
use super::picture::Picture;
use super::replace::replace;
use crate::error::Error as Nonsense;
use crate::parallel;

/// The options of a film's development.
const OF_DEVELOPMENT: [&str; 5] = ["background", "denoise", "exposure", "fireflies", "tonemap"];

/// The film of a picture.
#[pyclass(frozen, module = "lookfrom._lookfrom")]
pub(crate) struct Film {
    file: Arc<FilmFile>,
}

#[pymethods]
impl Film {
    /// Reads a film's file.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let read = parallel::in_pool(py, 0, || -> SceneResult<FilmFile> {
            let budget = Budget::default();
            let bytes = LoadContext::within(&budget, &Disk).read(&path)?;
            FilmFile::read(&bytes, &path, &budget)
        });
        Ok(Self::new(read.map_err(|error| raised(py, &error, &Disk))?))
    }

    /// The film of the bytes of its file.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, bytes: Vec<u8>) -> PyResult<Self> {
        let read = parallel::in_pool(py, 0, || FilmFile::read(&bytes, Path::new(""), &Budget::default()));
        Ok(Self::new(read.map_err(|error| raised(py, &error, &Disk))?))
    }

    /// The bytes of its file, with its picture.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = parallel::in_pool(py, 0, || written(&self.file));
        Ok(PyBytes::new(py, &bytes.map_err(|error| raised(py, &error, &Disk))?))
    }

    /// A copy with the samples of another film of the same picture.
    fn merged(&self, py: Python<'_>, other: PyRef<'_, Self>) -> PyResult<Self> {
        let (mut file, other) = (FilmFile::clone(&self.file), other.file());
        let merged = parallel::in_pool(py, 0, || file.merge(&other));
        merged.map_err(|error| raised(py, &error, &Disk))?;
        Ok(Self::new(file))
    }

    /// Writes the file, with its picture.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let saved = parallel::in_pool(py, 0, || {
            replace(&[(&path, &written(&self.file)?)])
                .map_err(|(path, error)| Error::new(ErrorKind::Io, &Location::file(path), error.to_string()))
        });
        saved.map_err(|error| raised(py, &error, &Disk))
    }

    /// The picture, developed as it was to be, or otherwise.
    fn develop(&self, py: Python<'_>, words: Words) -> PyResult<Picture> {
        let names: Vec<String> = words.iter().map(|(name, _)| name.clone()).collect();
        let options = asked(words)?.options;
        if let Some(name) = names.iter().find(|name| !OF_DEVELOPMENT.contains(&name.as_str())) {
            let known = OF_DEVELOPMENT.join(", ");
            let message = format!("{name} needs another render; the development of a film has {known}");
            return Err(Nonsense::new_err(message));
        }
        let file = &self.file;
        let mut development = file.provenance.development;
        if let Some(Exposure::Stops(stops)) = options.exposure {
            development.exposure = stops;
        }
        if let Some(background) = options.background.filter(|other| *other != development.background) {
            let reason = match (development.background, background) {
                (Background::Environment, _) => "the film has no alpha",
                (_, Background::Environment) => "the film has no environment any more",
                _ => "",
            };
            if !reason.is_empty() {
                return Err(Nonsense::new_err(format!("background cannot become {background}: {reason}")));
            }
            development.background = background;
        }
        development.tonemap = options.tonemap.unwrap_or(development.tonemap);
        development.denoise = options.denoise.unwrap_or(development.denoise);
        // Without this word, a session has the filter off.
        if names.iter().any(|name| name == "fireflies") {
            development.fireflies = options.fireflies;
        }
        let mut developed = parallel::in_pool(py, 0, || file.develop(&development));
        if options.exposure == Some(Exposure::Auto) {
            developed.expose(Path::new(""));
        }
        Ok(Picture::of_film(file, developed))
    }

    /// Columns and rows, samples of all pixels together, and whether all are there that were to be.
    fn told(&self) -> (u32, u32, u64, bool) {
        let FilmFile { film, provenance } = &*self.file;
        (film.width(), film.height(), film.ledger().total(), provenance.is_complete(film))
    }

    /// The scene and the keywords of the command that it is of.
    fn origin(&self) -> (Option<String>, Vec<String>) {
        let provenance = &self.file.provenance;
        (provenance.scene.clone(), provenance.arguments.clone())
    }
}

impl Film {
    pub(super) fn new(file: FilmFile) -> Self {
        Self { file: Arc::new(file) }
    }

    pub(super) fn file(&self) -> Arc<FilmFile> {
        self.file.clone()
    }
}

/// The bytes of a film's file, with its picture as it was to be developed.
fn written(file: &FilmFile) -> SceneResult<Vec<u8>> {
    let mut out = std::io::Cursor::new(Vec::new());
    file.write(&file.develop(&file.provenance.development), &mut out)?;
    Ok(out.into_inner())
}
