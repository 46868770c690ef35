//! Films: the exact sums of samples, in memory and in files.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use lookfrom::scene::{Budget, Disk, Error, ErrorKind, LoadContext, Location, Result as SceneResult};
use lookfrom::session::{Exposure, FilmFile, Fireflies};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use super::command::{Words, asked};
use super::error::raised;
use super::picture::Picture;
use crate::parallel;

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
            std::fs::write(&path, written(&self.file)?)
                .map_err(|error| Error::new(ErrorKind::Io, &Location::file(&path), error.to_string()))
        });
        saved.map_err(|error| raised(py, &error, &Disk))
    }

    /// The picture, developed as it was to be, or otherwise.
    fn develop(&self, py: Python<'_>, words: Words) -> PyResult<Picture> {
        let asked = asked(words)?;
        let file = &self.file;
        let mut development = file.provenance.development;
        let options = asked.options;
        if let Some(Exposure::Stops(stops)) = options.exposure {
            development.exposure = stops;
        }
        development.tonemap = options.tonemap.unwrap_or(development.tonemap);
        development.background = options.background.unwrap_or(development.background);
        development.denoise = options.denoise.unwrap_or(development.denoise);
        if options.fireflies != Fireflies::Keep {
            development.fireflies = options.fireflies;
        }
        Ok(Picture::of_film(file, parallel::in_pool(py, 0, || file.develop(&development))))
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
