//! Pictures.

use std::sync::Arc;

use lookfrom::film::Film as Sums;
use lookfrom::session::{Developed, FilmFile, Finished, Format, Provenance};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use super::error::raised;
use super::film::Film;
use crate::error::Error;
use crate::parallel;

/// A finished picture, with the film that it was developed from.
#[pyclass(frozen, module = "lookfrom._lookfrom")]
pub(crate) struct Picture {
    developed: Developed,
    film: Arc<Sums>,
    /// Provenance of the film, if it is kept.
    provenance: Option<Provenance>,
    /// Mean number of samples per pixel, why the render ended, rays, and the relative error.
    told: Told,
}

/// Statistics of a render.
#[derive(Clone, Debug, Default)]
struct Told {
    samples: u64,
    reason: String,
    rays: u64,
    error: f64,
}

#[pymethods]
impl Picture {
    /// Columns and rows.
    #[getter]
    fn size(&self) -> (u32, u32) {
        (self.developed.picture.width, self.developed.picture.height)
    }

    /// Mean number of samples per pixel, why the render ended, number of rays, relative error.
    fn told(&self) -> (u64, String, u64, f64) {
        let Told { samples, reason, rays, error } = self.told.clone();
        (samples, reason, rays, error)
    }

    /// Linear light, three numbers a pixel.
    fn linear<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_slice(py, self.developed.picture.pixels.as_flattened())
    }

    /// Alpha, if the picture has it.
    fn alpha<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f32>>> {
        let alpha = &self.developed.picture.alpha;
        (!alpha.is_empty()).then(|| PyArray1::from_slice(py, alpha))
    }

    /// 8-bit sRGB after exposure and tone map, with straight alpha; and whether alpha means anything.
    fn srgb<'py>(&self, py: Python<'py>) -> (Bound<'py, PyArray1<u8>>, bool) {
        let shown = parallel::in_pool(py, 0, || self.developed.shown());
        (shown.rgba.into_pyarray(py), shown.has_alpha)
    }

    /// The further channels of an EXR, by name.
    fn channels<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (name, numbers) in parallel::in_pool(py, 0, || self.developed.channels(&self.film)) {
            dict.set_item(name, numbers.into_pyarray(py))?;
        }
        Ok(dict)
    }

    /// The settings of the picture, by name.
    fn header(&self) -> Vec<(String, String)> {
        self.developed.header.clone()
    }

    /// The bytes of a file, in the format of an extension, with so many bits of a channel.
    fn encode<'py>(
        &self,
        py: Python<'py>,
        extension: &str,
        bits: Option<u8>,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let known = Format::EXTENSIONS;
        let Some((_, format)) = known.iter().find(|(known, _)| *known == extension.to_lowercase()) else {
            let known: Vec<String> = known.iter().map(|(known, _)| format!(".{known}")).collect();
            let message = format!("{extension:?} is no format; pictures are written as {}", known.join(", "));
            return Err(Error::new_err(message));
        };
        let with_bits = bits.map_or(Ok(*format), |bits| format.with_bits(bits));
        let format = &with_bits.map_err(|error| raised(py, &error, &lookfrom::scene::Disk))?;
        let bytes = parallel::in_pool(py, 0, || {
            let mut out = std::io::Cursor::new(Vec::new());
            let written = match (&self.provenance, format) {
                (Some(provenance), Format::Exr) => provenance.write(&self.film, &self.developed, &mut out),
                _ => self.developed.write(Some(&self.film), *format, &mut out),
            };
            written.map(|()| out.into_inner())
        });
        let bytes = bytes.map_err(|error| raised(py, &error, &lookfrom::scene::Disk))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// The film, if the session keeps films.
    fn film(&self) -> Option<Film> {
        let film = Sums::clone(&self.film);
        let provenance = self.provenance.clone()?;
        Some(Film::new(FilmFile { film, provenance }))
    }
}

impl Picture {
    pub(super) fn of_finished(finished: Finished, provenance: Option<Provenance>) -> Self {
        let told = Told {
            samples: finished.samples_taken(),
            reason: finished.rendered.reason.word().to_owned(),
            rays: finished.rendered.rays.total(),
            error: finished.rendered.error,
        };
        let Finished { rendered, developed, .. } = finished;
        Self { developed, film: Arc::new(rendered.film), provenance, told }
    }

    pub(super) fn of_film(file: &FilmFile, developed: Developed) -> Self {
        let film = Arc::new(file.film.clone());
        let pixels = film.area().pixels();
        let told = Told {
            samples: film.ledger().total() / pixels.max(1),
            reason: "film".to_owned(),
            ..Told::default()
        };
        Self { developed, film, provenance: Some(file.provenance.clone()), told }
    }
}
