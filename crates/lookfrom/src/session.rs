//! Sessions: from a file to a finished picture, for the command line and every other API.
//!
//! A [`Session`] reads (or is given) a scene, applies [`Options`], chooses defaults for what both leave open — camera,
//! lights, samples, denoising, AOVs — and owns the compiled [`World`]. Its picture is rendered with progress and
//! cancellation; its camera and settings may be changed and the picture rendered again.
//!
//! ```no_run
//! use lookfrom::session::{Options, Session};
//!
//! let session = Session::open("scene.toml", &Options::default())?;
//! session.render(&())?.save("scene.png")?;
//! # Ok::<(), lookfrom::scene::Error>(())
//! ```

mod change;
mod edit;
mod encode;
mod exposure;
mod film_file;
mod film_parts;
mod finish;
mod header;
mod identity;
mod layers;
mod memory;
mod options;
mod outliers;
mod prepare;
mod provenance;
mod running;
mod save;
mod series;
mod shown;
mod source;
mod spectral;

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use glam::DMat3;
use lookfrom_scene::budget::Reservation;
use lookfrom_scene::camera::Camera;
use lookfrom_scene::contents::Contents;
use lookfrom_scene::count::Counts;
use lookfrom_scene::digest::Digested;
use lookfrom_scene::files::SharedFiles;
use lookfrom_scene::scene::Bounds;
use lookfrom_scene::settings::{ImageSettings, RenderSettings};
use lookfrom_scene::studio::Turntable;
use lookfrom_scene::{
    Budget, Disk, Error, Files, Inputs, LoadContext, Location, Memory, Remedy, Result, Scene, Warning, load,
};

use crate::core::clock::Stopwatch;
use crate::film::allocation;
use crate::film::{Film, Picture};
use crate::render::{Progress, Renderer, StopCriteria, Subject};
use crate::view::View;
use crate::world::World;

pub use encode::Format;
pub use exposure::Exposure;
pub use film_file::FilmFile;
pub use film_parts::FilmParts;
pub use finish::{Developed, Development, Finished};
use identity::Identity;
pub use options::{Fireflies, MOST_SAMPLES, OPTIONS, Options};
pub use outliers::{Outlier, Outliers};
use prepare::Prepared;
pub use prepare::check_parts;
pub use provenance::Provenance;
pub use running::Running;
pub use series::Series;
pub use shown::{Sheet, Shown};
use source::Source;

/// The warning of a camera that would otherwise see nothing.
const BOTH_SIDES: &str = "the camera sees only the backs of single-sided surfaces, which would not be shown: they are shown \
                          from both sides";

/// The notice of a model that mostly faces inward.
const OPEN_FRONTS: &str =
    "from outside mostly backs of single-sided surfaces are seen: half of the light passes their fronts, too";

/// The notice of a scene in which openings are asked for and not sampled.
const NO_OPENINGS: &str = "no openings are sampled: here that would cost more than it brings";

/// A scene that is ready to be rendered, and to be rendered again with another camera or other settings.
///
/// Owns its data; a clone shares the world.
#[derive(Clone, Debug)]
pub struct Session {
    name: String,
    renderer: Renderer,
    camera: Camera,
    /// The scene as it was compiled and its memory, if it is kept.
    kept: Option<(Arc<Scene>, Arc<Reservation>)>,
    /// The source from which the scene can be read again.
    source: Source,
    /// The turntable, if enabled by the options.
    turntable: Option<Turning>,
    stop: StopCriteria,
    /// The number of the first sample.
    first_sample: u32,
    fireflies: Fireflies,
    threads: Option<usize>,
    format: Option<Format>,
    /// The identity of what the scene was read from, if the film is to be kept.
    identity: Option<Identity>,
    budget: Budget,
    /// The memory of the world.
    memory: Arc<Vec<Reservation>>,
    info: SceneInfo,
    warnings: Vec<Warning>,
}

/// A scene that was read or made, with its memory and the warnings of its reader.
struct Given {
    scene: Scene,
    memory: Vec<Reservation>,
    warnings: Vec<Warning>,
}

/// A turntable and the camera on it.
#[derive(Clone, Debug)]
struct Turning {
    turntable: Turntable,
    /// At 0 degrees.
    camera: Camera,
    world: Arc<World>,
    degrees: f64,
}

impl Turning {
    fn rotation(&self) -> DMat3 {
        DMat3::from_mat4(self.turntable.rotation(self.degrees))
    }
}

/// Contents of a session's file, and the time to prepare them.
#[derive(Clone, Debug)]
pub struct SceneInfo {
    /// Counts of the file's contents, without additions.
    pub counts: Counts,
    /// Contents of the file that can be selected: animations, variants, cameras, scenes.
    pub contents: Contents,
    /// The bounding box of the file's contents.
    pub bounds: Bounds,
    /// Additions: "camera", "lights", "floor".
    pub added: Vec<&'static str>,
    /// The time it took to read the file.
    pub read: Duration,
    /// The time it took to build the world from it.
    pub build: Duration,
}

impl Session {
    /// A session of a scene or model file on disk.
    ///
    /// # Errors
    /// Errors of the file's reader and of [`World::compile`], and `Request` where the options do not suit the scene.
    pub fn open(path: impl AsRef<Path>, options: &Options) -> Result<Self> {
        Self::open_in(path, &(Arc::new(Disk) as SharedFiles), options)
    }

    /// A session of a scene or model file among these files, which it keeps, to rebuild its world for cameras far away
    /// ([`Session::set_camera`]).
    ///
    /// # Errors
    /// As [`Session::open`].
    pub fn open_in(path: impl AsRef<Path>, files: &SharedFiles, options: &Options) -> Result<Self> {
        let path = path.as_ref();
        let source = Source::Files(path.to_owned(), files.clone(), Arc::new(options.clone()));
        Self::read_from(source, path, &**files, options)
    }

    /// As [`Session::open_in`]; every file that is read joins `inputs`.
    ///
    /// # Errors
    /// As [`Session::open`].
    pub fn open_on_record(
        path: impl AsRef<Path>,
        files: &SharedFiles,
        options: &Options,
        inputs: &Inputs,
    ) -> Result<Self> {
        let path = path.as_ref();
        let recorded = inputs.record(&**files, path.display().to_string());
        let source = Source::Files(path.to_owned(), files.clone(), Arc::new(options.clone()));
        Self::read_from(source, path, &recorded, options)
    }

    /// A session of a scene or model file in memory, which is self-contained. The extension of `name` determines its
    /// format. The session keeps the bytes, to rebuild its world for cameras far away ([`Session::set_camera`]).
    ///
    /// # Errors
    /// As [`Session::open`].
    pub fn from_bytes(name: &str, bytes: Vec<u8>, options: &Options) -> Result<Self> {
        let path = PathBuf::from(name);
        let files = Memory([(path.clone(), bytes)].into());
        Self::open_in(path, &(Arc::new(files) as SharedFiles), options)
    }

    /// A session of a scene or model file, read through `files` with all files that it refers to.
    ///
    /// # Errors
    /// As [`Session::open`].
    pub fn read(path: &Path, files: &dyn Files, options: &Options) -> Result<Self> {
        Self::read_from(Source::Elsewhere, path, files, options)
    }

    fn read_from(source: Source, path: &Path, files: &dyn Files, options: &Options) -> Result<Self> {
        let started = Stopwatch::start();
        let digested = Digested::new(files);
        let files: &dyn Files = if options.film { &digested } else { files };
        let mut context = options.context(files);
        let scene = load::scene(path, &mut context)?;
        let LoadContext { warnings, kept: memory, .. } = context;
        let identity = options.film.then(|| Identity::of_files(digested, path, options));
        Self::prepare(Given { scene, memory, warnings }, path, source, identity, started, options)
    }

    /// A session of a scene that was made or read elsewhere.
    ///
    /// # Errors
    /// As [`Session::open`] and [`Scene::validate`].
    pub fn of_scene(scene: Scene, options: &Options) -> Result<Self> {
        scene.validate()?;
        let identity = options.film.then(|| Identity::of_scene(&scene, options));
        let memory = options.budget.reserve(scene.bytes(), "the scene", &Location::default())?;
        Self::prepare(
            Given { scene, memory: vec![memory], warnings: Vec::new() },
            Path::new(""),
            Source::Elsewhere,
            identity,
            Stopwatch::start(),
            options,
        )
    }

    fn prepare(
        Given { mut scene, memory, mut warnings }: Given,
        path: &Path,
        source: Source,
        identity: Option<Identity>,
        started: Stopwatch,
        options: &Options,
    ) -> Result<Self> {
        let read = started.elapsed();
        let started = Stopwatch::start();
        let (counts, bounds) = (Counts::of(&scene), scene.bounds());
        let contents = std::mem::take(&mut scene.contents);
        let Prepared { added, turntable, has_own_lights } =
            prepare::prepare(&mut scene, path, options, &mut warnings)?;
        if options.format.is_some_and(|format| !format.has_layers()) {
            scene.image = scene.image.without_layers();
        }
        let range = options.range(&scene.render)?;
        scene.render.samples = range.end;
        let camera = scene.camera.clone().unwrap_or_default();
        let (view, settings) = (View::of_scene(&scene)?, scene.render.clone());
        let subject = Subject::of_scene(&scene, bounds);
        let kept = if options.keep_scene { Some(keep(&scene, &options.budget)?) } else { None };
        let (world, memory) = memory::compile(scene, memory, &options.budget, path, &mut warnings)?;
        let renderer = Renderer::new(Arc::new(world), view, settings).map_err(in_file(path))?;
        let (renderer, shows_backs) = seeing_backs(renderer).map_err(in_file(path))?;
        let world = renderer.world().clone();
        if shows_backs {
            warnings.push(Warning::new(&Location::file(path), BOTH_SIDES));
        }
        if world.has_open_fronts {
            warnings.push(Warning::notice(&Location::file(path), OPEN_FRONTS));
        }
        if renderer.has_given_up_guide() {
            warnings.push(Warning::notice(&Location::file(path), NO_OPENINGS));
        }
        let turntable = turntable.map(|turntable| Turning {
            turntable,
            camera: camera.clone(),
            world: world.clone(),
            degrees: 0.0,
        });
        let mut session = Self {
            name: path.display().to_string(),
            renderer,
            camera,
            kept,
            source,
            turntable,
            stop: options.stop,
            first_sample: range.start,
            fireflies: options.fireflies,
            threads: options.threads,
            format: options.format,
            identity,
            budget: options.budget.clone(),
            memory: Arc::new(memory),
            info: SceneInfo { counts, contents, bounds, added, read, build: started.elapsed() },
            warnings,
        };
        if options.exposure.map_or(has_own_lights, |exposure| exposure == Exposure::Auto) {
            let stops = session.expose()?;
            session.warnings.push(exposure::notice(stops, path));
        }
        if let Some(degrees) = options.turn {
            session.set_turn(degrees)?;
        }
        session.renderer.check_view(&subject, &mut session.warnings);
        for warning in &mut session.warnings {
            // What was added to the scene has no place in its file.
            if warning.at.file.is_empty() {
                warning.at = Location::file(path);
            }
        }
        session.info.build = started.elapsed();
        Ok(session)
    }

    /// The file's name as it was given; empty for a scene that was passed to [`Session::of_scene`].
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Warnings from reading and compiling.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Contents of the file, and additions.
    pub fn info(&self) -> &SceneInfo {
        &self.info
    }

    /// The scene's camera, with the options applied.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The image settings.
    pub fn image(&self) -> &ImageSettings {
        self.renderer.view().image()
    }

    /// The render settings.
    pub fn settings(&self) -> &RenderSettings {
        self.renderer.settings()
    }

    /// The numbers of samples that a pixel of the picture may have: only one, unless they are allocated by noise. A limit of noise
    /// or time may end a render before.
    pub fn samples_of_pixel(&self) -> RangeInclusive<u32> {
        allocation::of_pixel(self.settings())
    }

    /// The number of threads of a render; `None` for one on each core.
    pub fn threads(&self) -> Option<usize> {
        self.threads
    }

    /// Whether the scene is on a turntable, which [`Session::set_turn`] turns.
    pub fn has_turntable(&self) -> bool {
        self.turntable.is_some()
    }

    /// The compiled world.
    pub fn world(&self) -> &Arc<World> {
        self.renderer.world()
    }

    /// The renderer of the picture.
    pub fn renderer(&self) -> &Renderer {
        &self.renderer
    }

    /// Renders and finishes the picture.
    ///
    /// # Errors
    /// `Limit` if memory for the film ([`Options::budget`]) or threads are not available.
    pub fn render(&self, progress: &dyn Progress) -> Result<Finished> {
        let _memory = self.room_for_picture()?;
        self.render_onto(Film::for_image(self.image())?, progress)
    }

    /// Goes on with a film of this session's picture: renders the samples that it lacks, and finishes the picture, which
    /// is the same as if the film had not been interrupted. Where the limit of noise, or the mean number of samples of an
    /// adaptive allocation, is another one than that of the film, pixels may get other numbers of samples than in one render.
    ///
    /// # Errors
    /// `Invalid` for a film of another picture; `Request` for one with samples that this session would not take; as
    /// [`Session::render`].
    pub fn resume(&self, file: FilmFile, progress: &dyn Progress) -> Result<Finished> {
        let provenance = self.provenance()?;
        provenance.check_same(&file.provenance)?;
        let FilmFile { mut film, provenance: before } = file;
        if !film.is_for(self.image()) {
            let message = "this film has other pixels than the picture, or other sums";
            return Err(Error::invalid(&Location::default(), message).hint(Remedy::SamePicture));
        }
        let wanted = self.first_sample..*self.samples_of_pixel().end();
        if let Some(range) = film.ledger().range()
            && (range.start < wanted.start || range.end > wanted.end)
        {
            return Err(options::unsuitable(format!(
                "the film has samples {}..{}, and samples {}..{} are asked for: it is one of another part, or has more already",
                range.start, range.end, wanted.start, wanted.end
            )));
        }
        if !provenance.adapts_as(&before) {
            film.ledger_mut().forget_goals();
        }
        let _memory = self.room_for_picture()?;
        self.render_onto(film, progress)
    }

    fn render_onto(&self, film: Film, progress: &dyn Progress) -> Result<Finished> {
        let rendered =
            self.renderer.render_onto(film, self.first_sample, &self.stop, self.threads, progress)?;
        Ok(self.finish(rendered))
    }

    /// The origin of the film of this session's picture, for its file.
    ///
    /// # Errors
    /// `Request` for a session without [`Options::film`].
    pub fn provenance(&self) -> Result<Provenance> {
        let Some(identity) = &self.identity else {
            let message = "this session keeps no film: enable it by the option `film`";
            return Err(options::unsuitable(message.to_owned()));
        };
        Ok(identity.provenance(self))
    }

    /// The settings by which pictures of this session are developed.
    pub fn development(&self) -> Development {
        Development::of_image(self.image(), self.fireflies)
    }

    /// The bytes of a file of an unfinished picture, after `mean_samples` samples per pixel: without AOVs, firefly
    /// suppression and denoising.
    ///
    /// # Errors
    /// As [`Developed::encode`].
    pub fn encode_preview(&self, picture: &Picture, mean_samples: u64, format: Format) -> Result<Vec<u8>> {
        let (samples, mean) = (self.settings().samples.to_string(), mean_samples.to_string());
        let header = header::with_samples(&header::header(self), samples, Some(mean));
        let (layers, development) = (layers::Layers::Given(&[]), self.development());
        encode::bytes(|out| encode::write(format, picture, &layers, &development, &header, out))
    }

    /// Whether the picture's format, if it is known, can hold AOVs.
    fn has_room_for_layers(&self) -> bool {
        self.format.is_none_or(Format::has_layers)
    }
}

/// A copy of a scene, and its memory.
///
/// # Errors
/// `Limit` if the budget is exceeded.
fn keep(scene: &Scene, budget: &Budget) -> Result<(Arc<Scene>, Arc<Reservation>)> {
    let memory = budget.reserve(scene.bytes(), "the scene that is kept", &Location::default())?;
    Ok((Arc::new(scene.clone()), Arc::new(memory)))
}

/// A renderer of the same picture that shows surfaces from both sides, where it would otherwise see nothing but backs of
/// single-sided ones; and whether it does so.
fn seeing_backs(renderer: Renderer) -> Result<(Renderer, bool)> {
    if !renderer.sees_only_backs() {
        return Ok((renderer, false));
    }
    let world = Arc::new(renderer.world().with_both_sides());
    Ok((renderer.with_world(world, renderer.view().clone())?, true))
}

/// Completes an error that has no location by the scene's file.
fn in_file(path: &Path) -> impl Fn(Error) -> Error {
    move |mut error| {
        if error.at.file.is_empty() && !path.as_os_str().is_empty() {
            error.at = Location::file(path);
        }
        error
    }
}
