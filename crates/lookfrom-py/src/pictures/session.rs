//! Sessions.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use lookfrom::glam::DMat4;
use lookfrom::inspect::{self, SvgView};
use lookfrom::render::{Label, Progress, SampleId, TileDone};
use lookfrom::scene::camera::{Projection, View, Window};
use lookfrom::scene::image;
use lookfrom::scene::scene::MaterialId;
use lookfrom::scene::{LoadContext, Result as SceneResult, Warning, WarningGroup, WarningKind, json};
use lookfrom::session::{self, FilmFile, Finished, Options};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::command::{Words, asked};
use super::error::{raised, worded};
use super::files::Overlay;
use super::film::Film;
use super::picture::Picture;
use super::{labels, parts, view};
use crate::error::Error;
use crate::parallel;

/// A scene that is ready to be rendered. Calls that change it replace it whole, so that a render that is under way in another
/// thread goes on with what it began with.
#[pyclass(frozen, module = "lookfrom._lookfrom")]
pub(crate) struct Session {
    files: Overlay,
    /// The arguments of `lookfrom render` that open the same session.
    typed: Mutex<Vec<String>>,
    /// Warnings of the reader of the environment map.
    of_environment: Vec<Warning>,
    inner: Mutex<session::Session>,
}

#[pymethods]
impl Session {
    /// Reads a scene from a file, or by its name among files in memory, and compiles it.
    #[new]
    fn new(
        py: Python<'_>,
        path: PathBuf,
        files: HashMap<PathBuf, Vec<u8>>,
        words: Words,
        keep_scene: bool,
    ) -> PyResult<Self> {
        let asked = asked(words)?;
        let (is_on_disk, files) = (!files.contains_key(&path), Overlay::new(files));
        let threads = asked.options.threads.unwrap_or(0);
        let mut of_environment = Vec::new();
        let opened = parallel::in_pool(py, threads, || -> SceneResult<session::Session> {
            let mut context = LoadContext::within(&asked.options.budget, &files);
            let environment = asked.environment.as_deref().map(|path| image::read(path, &mut context));
            of_environment = context.warnings;
            let options =
                Options { environment: environment.transpose()?, keep_scene, ..asked.options.clone() };
            match is_on_disk {
                // So it can be read again for a camera far away.
                true => session::Session::open(&path, &options),
                false => session::Session::read(&path, &files, &options),
            }
        });
        let inner = Mutex::new(opened.map_err(|error| raised(py, &error, &files))?);
        Ok(Self { files, typed: Mutex::new(asked.typed), of_environment, inner })
    }

    /// Changes options, for which nothing is read; `all` are those that the session then has. Returns the name of an option for
    /// which the scene must be read again; then nothing has changed.
    fn change(&self, py: Python<'_>, words: Words, all: Words) -> PyResult<Option<&'static str>> {
        let changed = asked(words)?;
        let lacks_turntable = changed.options.turn.is_some() && !self.now().has_turntable();
        let of_scene = changed
            .options
            .of_scene()
            .or(changed.environment.is_some().then_some("environment"))
            .or(lacks_turntable.then_some("turn"));
        if of_scene.is_some() {
            return Ok(of_scene);
        }
        self.exchange(py, |session| session.change(&changed.options))?;
        // A camera that was moved may exclude the view that the scene was read with: no options then open the same session.
        if let Ok(all) = asked(all) {
            *self.typed.lock().unwrap_or_else(PoisonError::into_inner) = all.typed;
        }
        Ok(None)
    }

    /// Renders the picture, or goes on with a film. `look` is called now and then with the samples so far and in all, of all
    /// pixels. An exception of it, or of a signal's handler, stops the render; it has the picture so far as `picture`.
    fn render(
        &self,
        py: Python<'_>,
        film: Option<PyRef<'_, Film>>,
        look: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Picture> {
        let session = self.now();
        let film = film.as_ref().map(|film| film.file());
        let heard = Heard::default();
        let render = || -> SceneResult<Finished> {
            match &film {
                Some(film) => session.resume(FilmFile::clone(film), &heard),
                None => session.render(&heard),
            }
        };
        let tell = || match &look {
            None => Ok(()),
            Some(look) => {
                let [done, total] = [&heard.done, &heard.total].map(|count| count.load(Ordering::Relaxed));
                look.call1((done, total)).map(|_| ())
            }
        };
        let (finished, told) = parallel::watched(py, 0, render, tell, || heard.cancel());
        let finished = finished.map_err(|error| raised(py, &error, &self.files))?;
        let picture = Picture::of_finished(finished, self.provenance(&session));
        match told {
            Ok(()) => Ok(picture),
            Err(stop) => {
                stop.value(py).setattr("picture", Py::new(py, picture)?)?;
                Err(stop)
            }
        }
    }

    /// Labels of all pixels: arrays by name.
    fn labels<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let session = self.now();
        let (renderer, width, height) = (session.renderer(), session.image().width, session.image().height);
        let mut rows = vec![Vec::new(); height as usize];
        let items = rows.iter_mut().zip(0..height);
        parallel::for_each(py, session.threads().unwrap_or(0), items, || {
            |(row, y): (&mut Vec<Label>, u32)| row.extend((0..width).map(|x| renderer.label([x, y])))
        })?;
        labels::arrays(py, &rows.concat(), &renderer.world().objects())
    }

    /// Names of shapes, of materials and of objects, by index.
    fn names(&self) -> [Vec<String>; 3] {
        labels::names(self.now().renderer())
    }

    /// The camera.
    fn camera<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        view::described(py, self.now().renderer().view().camera())
    }

    /// The crop window: columns and rows of its corners; `None` for the whole picture.
    fn crop(&self) -> Option<[u32; 4]> {
        self.now().image().crop.map(|crop| [crop.x0, crop.y0, crop.x1, crop.y1])
    }

    /// Columns and rows of the picture, samples per pixel, exposure in stops.
    fn settings(&self) -> (u32, u32, u32, f32) {
        let session = self.now();
        let image = session.image();
        (image.width, image.height, session.settings().samples, image.exposure)
    }

    /// The bounding box of what the file has, lowest and highest corner; `None` where it is empty.
    fn bounds(&self) -> Option<([f64; 3], [f64; 3])> {
        let bounds = self.now().info().bounds;
        (!bounds.is_empty()).then(|| (bounds.min.to_array(), bounds.max.to_array()))
    }

    /// Warnings and notes of the readers, each with whether it is a mere note.
    fn warnings(&self) -> Vec<(String, bool)> {
        let session = self.now();
        let all = self.of_environment.iter().chain(session.warnings());
        let told = |warning: &Warning| warning.clone().worded(worded);
        let groups = WarningGroup::of(&all.map(told).collect::<Vec<_>>());
        groups.iter().map(|group| (group.to_string(), group.kind() != WarningKind::Warning)).collect()
    }

    /// Replaces a material by that of a text in the scene format.
    fn set_material(&self, py: Python<'_>, name: &str, text: &str) -> PyResult<()> {
        let known = &self.names()[1];
        let Some(index) = known.iter().position(|other| other == name) else {
            return Err(Error::new_err(format!(
                "there is no material {name:?}; the scene has {}",
                known.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ")
            )));
        };
        let material = parts::material(text).map_err(|error| raised(py, &error, &parts::files(text)))?;
        self.exchange(py, |session| session.set_material(MaterialId(index as u32), material))
    }

    /// Replaces all lights that are no shapes by those of a text in the scene format.
    fn set_lights(&self, py: Python<'_>, text: &str) -> PyResult<()> {
        let lights = parts::lights(text).map_err(|error| raised(py, &error, &parts::files(text)))?;
        self.exchange(py, |session| session.set_lights(lights))
    }

    /// Moves instances: index and map from the object's space to the world, by rows.
    fn set_poses(&self, py: Python<'_>, poses: Vec<(usize, [[f64; 4]; 4])>) -> PyResult<()> {
        let poses = poses.iter().map(|(index, rows)| (*index, DMat4::from_cols_array_2d(rows).transpose()));
        let poses: Vec<_> = poses.collect();
        self.exchange(py, |session| session.set_poses(poses))
    }

    /// Moves the camera: by the rows of the map from the camera's space (x to the left, y up, z forward) to the world, and by what
    /// it sees of the plane at distance 1, from left to right and from bottom to top, where that changes.
    fn set_camera(
        &self,
        py: Python<'_>,
        world_from_camera: [[f64; 4]; 4],
        window: Option<[[f64; 2]; 2]>,
    ) -> PyResult<()> {
        self.exchange(py, |session| {
            let mut camera = session.camera().clone();
            camera.view = View::Matrix(DMat4::from_cols_array_2d(&world_from_camera).transpose());
            camera.target = None;
            if let Some([x, y]) = window {
                // Half of its height is 1 at distance 1.
                camera.projection = Projection::Perspective { fov: 90.0 };
                camera.window = Some(Window { x, y });
            }
            session.set_camera(camera)
        })
    }

    /// The session as it is now, which no later change of this one changes.
    fn snapshot(&self) -> Self {
        let typed = self.typed.lock().unwrap_or_else(PoisonError::into_inner).clone();
        Self {
            files: self.files.clone(),
            typed: Mutex::new(typed),
            of_environment: self.of_environment.clone(),
            inner: Mutex::new(self.now()),
        }
    }

    /// A report on one sample of a pixel as JSON, or on all (`sample` is `None`).
    fn inspect(&self, py: Python<'_>, x: u32, y: u32, sample: Option<u32>) -> PyResult<String> {
        let session = self.checked(x, y, sample)?;
        let report = parallel::in_pool(py, 0, || -> SceneResult<String> {
            let renderer = session.renderer();
            Ok(match sample {
                Some(sample) => json::line(&inspect::inspect(renderer, SampleId { pixel: [x, y], sample })),
                None => json::line(&inspect::inspect_pixel(renderer, [x, y], 0..session.settings().samples)?),
            })
        });
        report.map_err(|error| raised(py, &error, &self.files))
    }

    /// The report on a sample as text for people.
    fn inspect_text(&self, py: Python<'_>, x: u32, y: u32, sample: u32) -> PyResult<String> {
        let session = self.checked(x, y, Some(sample))?;
        let id = SampleId { pixel: [x, y], sample };
        Ok(parallel::in_pool(py, 0, || inspect::inspect(session.renderer(), id).to_string()))
    }

    /// A drawing of the sample's rays, as SVG.
    fn inspect_svg(&self, py: Python<'_>, x: u32, y: u32, sample: u32) -> PyResult<String> {
        let session = self.checked(x, y, Some(sample))?;
        let id = SampleId { pixel: [x, y], sample };
        let drawn = parallel::in_pool(py, 0, || {
            let renderer = session.renderer();
            inspect::svg(renderer, &inspect::inspect(renderer, id), SvgView::default())
        });
        drawn.map_err(|error| raised(py, &error, &self.files))
    }
}

impl Session {
    /// The session as it is now.
    fn now(&self) -> session::Session {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Changes a copy of the session, and replaces the session by it if that succeeds.
    fn exchange(
        &self,
        py: Python<'_>,
        change: impl FnOnce(&mut session::Session) -> SceneResult<()> + Send,
    ) -> PyResult<()> {
        let mut session = self.now();
        let changed = parallel::in_pool(py, 0, || change(&mut session));
        changed.map_err(|error| raised(py, &error, &self.files))?;
        *self.inner.lock().unwrap_or_else(PoisonError::into_inner) = session;
        Ok(())
    }

    /// The session, if it has this sample of this pixel.
    fn checked(&self, x: u32, y: u32, sample: Option<u32>) -> PyResult<session::Session> {
        let session = self.now();
        let (width, height) = (session.image().width, session.image().height);
        if x >= width || y >= height {
            let message = format!("pixel ({x}, {y}) is outside of the picture of {width} × {height} pixels");
            return Err(PyIndexError::new_err(message));
        }
        let samples = session.samples_of_pixel();
        if let Some(sample) = sample.filter(|sample| sample >= samples.end()) {
            let at_most = if samples.start() < samples.end() { "at most " } else { "" };
            let message = format!(
                "there is no sample {sample}: a pixel has {at_most}{}, counted from 0",
                samples.end()
            );
            return Err(PyIndexError::new_err(message));
        }
        Ok(session)
    }

    /// Provenance of this session's films, if it keeps them.
    fn provenance(&self, session: &session::Session) -> Option<session::Provenance> {
        let mut provenance = session.provenance().ok()?;
        let scene = Path::new(session.name());
        provenance.scene = scene.is_file().then(|| scene.display().to_string());
        provenance.arguments.clone_from(&self.typed.lock().unwrap_or_else(PoisonError::into_inner));
        Some(provenance)
    }
}

/// Hears how far a render is, and can end it.
#[derive(Default)]
struct Heard {
    done: AtomicU64,
    total: AtomicU64,
    is_cancelled: AtomicBool,
}

impl Heard {
    fn cancel(&self) {
        self.is_cancelled.store(true, Ordering::Relaxed);
    }
}

impl Progress for Heard {
    fn tile(&self, done: TileDone) {
        self.done.fetch_max(done.done, Ordering::Relaxed);
        self.total.store(done.total, Ordering::Relaxed);
    }

    fn cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::Relaxed)
    }
}
