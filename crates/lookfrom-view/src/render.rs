//! The work of a window: renders its view, coarse at first, then pass by pass, and answers its page meanwhile.
//!
//! A message interrupts a pass at the next tile; it is answered, and the pass goes on with the tiles that it lacks. Where messages
//! arrive only between turns, a pass interrupts itself after a slice of time. Only
//! coarse pictures are not interrupted: they are chosen to take no longer than a frame, and a hand that moves the camera
//! would never see one.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Duration;

use lookfrom::core::clock::Stopwatch;
use lookfrom::film::Film;
use lookfrom::inspect;
use lookfrom::session::{Format, Session};
use lookfrom_scene::settings::{ImageSettings, RenderSettings};
use lookfrom_scene::{Error, Result};

use crate::cost::{CostMap, Counted};
use crate::develop::{self, Shown};
use crate::document::{Document, Loaded, panicked};
use crate::mailbox::{Mailbox, Outgoing, Task};
use crate::message::{Answer, FileFormat, Header, Request, ViewRequest};
use crate::view::{Variation, refused};
use crate::view_render::{Stage, ViewRender};
use crate::{lobe, space, words};

/// The most samples of a pixel that are inspected at once: it takes a second or so.
const MOST_INSPECTED: u32 = 4096;

/// Runs until the window is closed.
#[cfg(feature = "server")]
pub(crate) fn run(mailbox: Arc<Mailbox>, document: Arc<Document>) {
    let mut window = Window::new(mailbox, document, None);
    while let Some(tasks) = window.mailbox.take(!window.has_work()) {
        window.turn(tasks);
    }
}

/// A window: what it shows.
pub(crate) struct Window {
    mailbox: Arc<Mailbox>,
    pub(crate) document: Arc<Document>,
    /// The longest time of a pass between two turns; `None` where messages interrupt it.
    slice: Option<Duration>,
    loaded: Option<Arc<Loaded>>,
    /// The scene as this window alone wants it.
    variation: Option<(Variation, Session)>,
    request: Option<ViewRequest>,
    render: Option<ViewRender>,
    is_paused: bool,
}

impl Window {
    /// A window that shows nothing yet.
    pub(crate) fn new(mailbox: Arc<Mailbox>, document: Arc<Document>, slice: Option<Duration>) -> Self {
        Self {
            mailbox,
            document,
            slice,
            loaded: None,
            variation: None,
            request: None,
            render: None,
            is_paused: false,
        }
    }

    /// Does these tasks, then renders a little more.
    pub(crate) fn turn(&mut self, tasks: Vec<Task>) {
        for task in tasks {
            let id = match &task {
                Task::Request(request) => request.id(),
                Task::SceneChanged => None,
            };
            self.guarded(id, |window| window.answer(task));
        }
        self.guarded(None, Self::step);
    }

    /// Does something; its failure becomes an answer, a panic too.
    fn guarded(&mut self, id: Option<u64>, act: impl FnOnce(&mut Self) -> Result<()>) {
        let done = catch_unwind(AssertUnwindSafe(|| act(self))).unwrap_or_else(|_| Err(panicked()));
        if let Err(error) = done {
            if id.is_none()
                && let Some(render) = &mut self.render
            {
                render.stage = Stage::Done;
            }
            self.mailbox.say(&Answer::of_error(id, &error, &**self.document.files()));
        }
    }

    /// Whether there is something to render. A pause holds up passes, not the first sight of another view.
    pub(crate) fn has_work(&self) -> bool {
        let stage = self.render.as_ref().map_or(Stage::Done, |render| render.stage);
        stage != Stage::Done && !(self.is_paused && stage == Stage::Full)
    }

    fn answer(&mut self, task: Task) -> Result<()> {
        match task {
            Task::SceneChanged => self.scene_changed(),
            Task::Request(Request::View(request)) => self.look(*request),
            Task::Request(Request::Pause { paused }) => {
                self.is_paused = paused;
                Ok(())
            }
            Task::Request(Request::Pixel { id, x, y }) => self.pixel(id, [x, y]),
            Task::Request(Request::Inspect { id, x, y, sample, depth, min_contribution }) => {
                self.inspect(id, [x, y], sample, depth, min_contribution)
            }
            Task::Request(Request::Lobe { id, x, y, sample, address }) => {
                let render = self.render.as_ref().ok_or_else(nothing_yet)?;
                let sample = render.checked([x, y], sample)?;
                let lobe = lobe::answer(render.session.renderer(), id, sample, address)?;
                self.mailbox.say(&Answer::Lobe(Box::new(lobe)));
                Ok(())
            }
            Task::Request(Request::Value { id, x, y }) => self.value(id, x, y),
            Task::Request(Request::Space { id, camera, size }) => {
                let loaded = self.loaded.as_ref().ok_or_else(nothing_yet)?;
                let session = self.render.as_ref().map_or(&loaded.session, |render| &render.session);
                self.mailbox.send(Outgoing::Binary(space::frame(session, id, &camera, size)?));
                Ok(())
            }
            Task::Request(Request::Save { id, format }) => self.save(id, format),
            Task::Request(Request::Words { id }) => {
                let (Some(render), Some(request)) = (&self.render, &self.request) else {
                    return Err(nothing_yet());
                };
                let toml = words::toml(&render.session, request);
                let command = words::command(&render.session, request, &self.document.settings().typed);
                self.mailbox.say(&Answer::Words { id, toml, command });
                Ok(())
            }
        }
    }

    /// Shows the scene as it is now, in the same view.
    fn scene_changed(&mut self) -> Result<()> {
        let (loaded, error) = self.document.now();
        if let Some(loaded) = loaded
            && self.loaded.as_ref().is_none_or(|before| before.generation != loaded.generation)
        {
            self.mailbox.say(&Answer::Scene(Box::new(loaded.told())));
            (self.loaded, self.variation, self.render) = (Some(loaded), None, None);
            if let Some(request) = self.request.clone() {
                self.look(request)?;
            }
        }
        if let Some(error) = error {
            self.mailbox.say(&error);
        }
        Ok(())
    }

    /// Shows another view, or the same one developed anew.
    fn look(&mut self, request: ViewRequest) -> Result<()> {
        let Some(loaded) = self.loaded.clone() else {
            self.request = Some(request);
            return Ok(());
        };
        develop::check(&request, &loaded)?;
        if let (Some(render), Some(before)) = (&mut self.render, &self.request)
            && before.light() == request.light()
        {
            render.take_samples(&request, &loaded)?;
            if !request.moving && render.stage == Stage::Done && render.film.is_none() {
                render.stage = render.after_coarse();
            }
            render.denoised = None;
            self.request = Some(request);
            return self.show();
        }
        // What cannot be shown leaves the view as it is.
        let session = request.applied(self.base(&request, &loaded)?)?;
        let pace = self.render.as_ref().and_then(|render| render.pace);
        let render = match ViewRender::new(session.clone(), pace) {
            Ok(render) => render,
            // Perhaps there is memory for it in place of the last one.
            Err(_) if self.render.take().is_some() => ViewRender::new(session, pace)?,
            Err(error) => return Err(error),
        };
        (self.render, self.request) = (Some(render), Some(request));
        Ok(())
    }

    /// The session of the scene in the variation that is asked for.
    fn base(&mut self, request: &ViewRequest, loaded: &Loaded) -> Result<Session> {
        let Some(variation) = request.variation(loaded) else { return Ok(loaded.session.clone()) };
        if let Some((known, session)) = &self.variation
            && *known == variation
        {
            return Ok(session.clone());
        }
        let session = variation.open(loaded, self.document.files())?;
        self.variation = Some((variation, session.clone()));
        Ok(session)
    }

    /// Renders a little more.
    fn step(&mut self) -> Result<()> {
        if !self.has_work() {
            return Ok(());
        }
        let (Some(render), Some(request)) = (&mut self.render, &self.request) else { return Ok(()) };
        let has_more = match render.stage {
            Stage::Coarse(scale) => render.render_coarse(scale, request.moving, &self.mailbox)?,
            Stage::Full => render.render_pass(&self.mailbox, self.slice)?,
            Stage::Done => false,
        };
        if has_more { self.show() } else { Ok(()) }
    }

    /// Sends the picture as it is.
    fn show(&mut self) -> Result<()> {
        let (Some(render), Some(request), Some(loaded)) = (&mut self.render, &self.request, &self.loaded)
        else {
            return Ok(());
        };
        let of = render.session.settings().samples;
        let is_done = render.film.is_some() && render.stage == Stage::Done;
        let seconds = render.spent.as_secs_f64();
        self.mailbox.say(&Answer::Progress {
            view: request.id,
            samples: render.samples,
            of,
            seconds,
            rays_per_second: render.rays as f64 / seconds.max(1e-9),
            done: is_done,
            hash: render.film.as_ref().filter(|_| is_done).map(Film::hash),
        });
        let started = Stopwatch::start();
        let denoises = request.denoise && render.samples > 0;
        if denoises && !is_done && render.denoised.is_some_and(|(last, rest)| last.elapsed() < rest) {
            return Ok(());
        }
        if let Some(counted) = develop::counted(request)? {
            return self.show_cost(counted, is_done);
        }
        let (session, film, scale) = match (&render.film, &render.coarse) {
            (Some(film), _) if render.samples > 0 => (&render.session, film, 1),
            (_, Some(coarse)) => (&coarse.session, &coarse.film, coarse.scale),
            _ => return Ok(()),
        };
        let shown = Shown { session, film, is_coarse: scale > 1, loaded, request };
        let pictures = shown.pictures()?;
        if denoises {
            render.denoised = Some((Stopwatch::start(), 3 * started.elapsed()));
        }
        let header = Header::Picture {
            view: request.id,
            width: film.width(),
            height: film.height(),
            scale,
            samples: render.samples.max(1),
            of,
            done: is_done,
            layer: request.layer.clone().unwrap_or_else(|| "color".to_owned()),
            seconds,
            sizes: pictures.iter().map(Vec::len).collect(),
        };
        let parts: Vec<&[u8]> = pictures.iter().map(Vec::as_slice).collect();
        self.mailbox.show(header.frame(&parts));
        Ok(())
    }

    /// Sends a heat map of the cost, which is measured once.
    fn show_cost(&mut self, counted: Counted, done: bool) -> Result<()> {
        let (Some(render), Some(request)) = (&mut self.render, &self.request) else { return Ok(()) };
        let map = match render.cost.take() {
            Some(map) => map,
            None => CostMap::new(&render.session)?,
        };
        let png = map.png(counted)?;
        let header = Header::Picture {
            view: request.id,
            width: map.width,
            height: map.height,
            scale: map.scale,
            samples: 1,
            of: render.session.settings().samples,
            done,
            layer: request.layer.clone().unwrap_or_default(),
            seconds: render.spent.as_secs_f64(),
            sizes: vec![png.len()],
        };
        render.cost = Some(map);
        self.mailbox.show(header.frame(&[&png]));
        Ok(())
    }

    fn pixel(&self, id: u64, pixel: [u32; 2]) -> Result<()> {
        let session = self.as_shown()?;
        let samples = session.settings().samples.min(MOST_INSPECTED);
        let report = Box::new(inspect::inspect_pixel(session.renderer(), pixel, 0..samples)?);
        self.mailbox.say(&Answer::Pixel { id, report });
        Ok(())
    }

    /// The session, developed as the picture on the screen is.
    fn as_shown(&self) -> Result<Session> {
        let (Some(render), Some(request)) = (&self.render, &self.request) else { return Err(nothing_yet()) };
        let mut session = render.session.clone();
        let own = session.image().clone();
        let tonemap = request.tonemap(own.tonemap)?;
        session.set_image(ImageSettings {
            exposure: request.exposure,
            tonemap,
            denoise: request.denoise,
            ..own
        })?;
        Ok(session)
    }

    fn inspect(
        &self,
        id: u64,
        pixel: [u32; 2],
        sample: u32,
        depth: Option<u32>,
        min_contribution: Option<f32>,
    ) -> Result<()> {
        let render = self.render.as_ref().ok_or_else(nothing_yet)?;
        let sample = render.checked(pixel, sample)?;
        let mut session = self.as_shown()?;
        let own = session.settings().clone();
        session.set_settings(RenderSettings {
            depth: depth.unwrap_or(own.depth).min(256),
            min_contribution: min_contribution.unwrap_or(own.min_contribution),
            ..own
        })?;
        let inspection = inspect::inspect(session.renderer(), sample);
        let text = inspection.to_string();
        self.mailbox.say(&Answer::Inspection { id, inspection: Box::new(inspection), text });
        Ok(())
    }

    fn value(&self, id: u64, x: u32, y: u32) -> Result<()> {
        let render = self.render.as_ref().ok_or_else(nothing_yet)?;
        render.check_pixel([x, y])?;
        let film = render.film.as_ref().ok_or_else(nothing_yet)?;
        let reference = self.loaded.as_ref().and_then(|loaded| loaded.reference.as_ref());
        let reference = reference.filter(|image| x < image.width && y < image.height);
        self.mailbox.say(&Answer::Value {
            id,
            x,
            y,
            rgb: film.mean(x, y),
            samples: film.samples(x, y),
            variance: film.variance(x, y),
            reference: reference.map(|image| image.texel(y as usize * image.width as usize + x as usize)),
        });
        Ok(())
    }

    fn save(&self, id: u64, format: FileFormat) -> Result<()> {
        let (Some(render), Some(request), Some(loaded)) = (&self.render, &self.request, &self.loaded) else {
            return Err(nothing_yet());
        };
        let film = render.film.as_ref().ok_or_else(nothing_yet)?;
        let (format, extension, mime) = match format {
            FileFormat::Png => (Format::Png, "png", "image/png"),
            FileFormat::Exr => (Format::Exr, "exr", "image/x-exr"),
        };
        let shown = Shown { session: &render.session, film, is_coarse: false, loaded, request };
        let bytes = shown.file(format)?;
        let stem = self.document.settings().scene.file_stem().unwrap_or_default().to_string_lossy();
        let header = Header::File { id, name: format!("{stem}.{extension}"), mime };
        self.mailbox.send(Outgoing::Binary(header.frame(&[&bytes])));
        Ok(())
    }
}

fn nothing_yet() -> Error {
    refused("there is no picture yet")
}
