//! The thread of a window: renders its view, coarse at first, then pass by pass, and answers its page meanwhile.
//!
//! A message interrupts a pass at the next tile; it is answered, and the pass goes on with the tiles that it lacks. Only
//! coarse pictures are not interrupted: they are chosen to take no longer than a frame, and a hand that moves the camera
//! would never see one.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Instant;

use lookfrom::inspect;
use lookfrom::session::{Format, Session};
use lookfrom_scene::settings::{ImageSettings, RenderSettings};
use lookfrom_scene::{Error, Result};

use crate::cost::{CostMap, Counted};
use crate::develop::{self, Shown};
use crate::document::{Document, Loaded, panicked};
use crate::mailbox::{Letter, Mailbox, Task};
use crate::message::{Answer, FileFormat, Header, Request, Wish};
use crate::shot::{Shot, Stage};
use crate::view::{Variation, refused};
use crate::{lobe, space, words};

/// The most samples of a pixel that are inspected at once: it takes a second or so.
const MOST_INSPECTED: u32 = 4096;

/// Runs until the window is closed.
pub(crate) fn run(mailbox: &Mailbox, document: &Document) {
    let mut window =
        Window { mailbox, document, loaded: None, variation: None, wish: None, shot: None, is_paused: false };
    while let Some(tasks) = mailbox.take(!window.has_work()) {
        for task in tasks {
            let id = match &task {
                Task::Request(request) => request.id(),
                Task::SceneChanged => None,
            };
            window.guarded(id, |window| window.answer(task));
        }
        window.guarded(None, Window::step);
    }
}

/// A window: what it shows.
struct Window<'a> {
    mailbox: &'a Mailbox,
    document: &'a Document,
    loaded: Option<Arc<Loaded>>,
    /// The scene as this window alone wants it.
    variation: Option<(Variation, Session)>,
    wish: Option<Wish>,
    shot: Option<Shot>,
    is_paused: bool,
}

impl Window<'_> {
    /// Does something; its failure becomes an answer, a panic too.
    fn guarded(&mut self, id: Option<u64>, act: impl FnOnce(&mut Self) -> Result<()>) {
        let done = catch_unwind(AssertUnwindSafe(|| act(self))).unwrap_or_else(|_| Err(panicked()));
        if let Err(error) = done {
            if id.is_none()
                && let Some(shot) = &mut self.shot
            {
                shot.stage = Stage::Done;
            }
            self.mailbox.say(&Answer::of_error(id, &error));
        }
    }

    /// Whether there is something to render. A pause holds up passes, not the first sight of another view.
    fn has_work(&self) -> bool {
        let stage = self.shot.as_ref().map_or(Stage::Done, |shot| shot.stage);
        stage != Stage::Done && !(self.is_paused && stage == Stage::Full)
    }

    fn answer(&mut self, task: Task) -> Result<()> {
        match task {
            Task::SceneChanged => self.scene_changed(),
            Task::Request(Request::View(wish)) => self.look(*wish),
            Task::Request(Request::Pause { paused }) => {
                self.is_paused = paused;
                Ok(())
            }
            Task::Request(Request::Pixel { id, x, y }) => self.pixel(id, [x, y]),
            Task::Request(Request::Inspect { id, x, y, sample, depth, min_contribution }) => {
                self.inspect(id, [x, y], sample, depth, min_contribution)
            }
            Task::Request(Request::Lobe { id, x, y, sample, address }) => {
                let shot = self.shot.as_ref().ok_or_else(nothing_yet)?;
                let sample = shot.checked([x, y], sample)?;
                let lobe = lobe::answer(shot.session.renderer(), id, sample, address)?;
                self.mailbox.say(&Answer::Lobe(Box::new(lobe)));
                Ok(())
            }
            Task::Request(Request::Value { id, x, y }) => self.value(id, x, y),
            Task::Request(Request::Space { id, camera, size }) => {
                let loaded = self.loaded.as_ref().ok_or_else(nothing_yet)?;
                let session = self.shot.as_ref().map_or(&loaded.session, |shot| &shot.session);
                self.mailbox.send(Letter::Binary(space::frame(session, id, &camera, size)?));
                Ok(())
            }
            Task::Request(Request::Save { id, format }) => self.save(id, format),
            Task::Request(Request::Words { id }) => {
                let (Some(shot), Some(wish)) = (&self.shot, &self.wish) else { return Err(nothing_yet()) };
                let toml = words::toml(&shot.session, wish);
                let command = words::command(&shot.session, wish, &self.document.settings().typed);
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
            (self.loaded, self.variation, self.shot) = (Some(loaded), None, None);
            if let Some(wish) = self.wish.clone() {
                self.look(wish)?;
            }
        }
        if let Some(error) = error {
            self.mailbox.say(&error);
        }
        Ok(())
    }

    /// Shows another view, or the same one developed anew.
    fn look(&mut self, wish: Wish) -> Result<()> {
        let Some(loaded) = self.loaded.clone() else {
            self.wish = Some(wish);
            return Ok(());
        };
        develop::check(&wish, &loaded)?;
        if let (Some(shot), Some(before)) = (&mut self.shot, &self.wish)
            && before.light() == wish.light()
        {
            shot.take_samples(&wish, &loaded)?;
            if !wish.moving && shot.stage == Stage::Done && shot.film.is_none() {
                shot.stage = shot.after_coarse();
            }
            shot.denoised_until = None;
            self.wish = Some(wish);
            return self.show();
        }
        // What cannot be shown leaves the view as it is.
        let session = wish.applied(self.base(&wish, &loaded)?)?;
        let pace = self.shot.as_ref().and_then(|shot| shot.pace);
        let shot = match Shot::new(session.clone(), pace) {
            Ok(shot) => shot,
            // Perhaps there is memory for it in place of the last one.
            Err(_) if self.shot.take().is_some() => Shot::new(session, pace)?,
            Err(error) => return Err(error),
        };
        (self.shot, self.wish) = (Some(shot), Some(wish));
        Ok(())
    }

    /// The session of the scene in the variation that is asked for.
    fn base(&mut self, wish: &Wish, loaded: &Loaded) -> Result<Session> {
        let Some(variation) = wish.variation(loaded) else { return Ok(loaded.session.clone()) };
        if let Some((known, session)) = &self.variation
            && *known == variation
        {
            return Ok(session.clone());
        }
        let session = variation.open(loaded)?;
        self.variation = Some((variation, session.clone()));
        Ok(session)
    }

    /// Renders a little more.
    fn step(&mut self) -> Result<()> {
        if !self.has_work() {
            return Ok(());
        }
        let (Some(shot), Some(wish)) = (&mut self.shot, &self.wish) else { return Ok(()) };
        let has_more = match shot.stage {
            Stage::Coarse(scale) => shot.render_coarse(scale, wish.moving, self.mailbox)?,
            Stage::Full => shot.render_pass(self.mailbox)?,
            Stage::Done => false,
        };
        if has_more { self.show() } else { Ok(()) }
    }

    /// Sends the picture as it is.
    fn show(&mut self) -> Result<()> {
        let (Some(shot), Some(wish), Some(loaded)) = (&mut self.shot, &self.wish, &self.loaded) else {
            return Ok(());
        };
        let of = shot.session.settings().samples;
        let is_done = shot.film.is_some() && shot.stage == Stage::Done;
        let seconds = shot.spent.as_secs_f64();
        self.mailbox.say(&Answer::Progress {
            view: wish.id,
            samples: shot.samples,
            of,
            seconds,
            rays_per_second: shot.rays as f64 / seconds.max(1e-9),
            done: is_done,
        });
        let started = Instant::now();
        let denoises = wish.denoise && shot.samples > 0;
        if denoises && !is_done && shot.denoised_until.is_some_and(|until| started < until) {
            return Ok(());
        }
        if let Some(counted) = develop::counted(wish)? {
            return self.show_cost(counted, is_done);
        }
        let (session, film, scale) = match (&shot.film, &shot.coarse) {
            (Some(film), _) if shot.samples > 0 => (&shot.session, film, 1),
            (_, Some(coarse)) => (&coarse.session, &coarse.film, coarse.scale),
            _ => return Ok(()),
        };
        let shown = Shown { session, film, is_coarse: scale > 1, loaded, wish };
        let pictures = shown.pictures()?;
        if denoises {
            shot.denoised_until = Some(Instant::now() + 3 * started.elapsed());
        }
        let header = Header::Picture {
            view: wish.id,
            width: film.width(),
            height: film.height(),
            scale,
            samples: shot.samples.max(1),
            of,
            done: is_done,
            layer: wish.layer.clone().unwrap_or_else(|| "color".to_owned()),
            seconds,
            sizes: pictures.iter().map(Vec::len).collect(),
        };
        let parts: Vec<&[u8]> = pictures.iter().map(Vec::as_slice).collect();
        self.mailbox.show(header.frame(&parts));
        Ok(())
    }

    /// Sends a heat map of the cost, which is measured once.
    fn show_cost(&mut self, counted: Counted, done: bool) -> Result<()> {
        let (Some(shot), Some(wish)) = (&mut self.shot, &self.wish) else { return Ok(()) };
        let map = match shot.cost.take() {
            Some(map) => map,
            None => CostMap::new(&shot.session)?,
        };
        let png = map.png(counted)?;
        let header = Header::Picture {
            view: wish.id,
            width: map.width,
            height: map.height,
            scale: map.scale,
            samples: 1,
            of: shot.session.settings().samples,
            done,
            layer: wish.layer.clone().unwrap_or_default(),
            seconds: shot.spent.as_secs_f64(),
            sizes: vec![png.len()],
        };
        shot.cost = Some(map);
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
        let (Some(shot), Some(wish)) = (&self.shot, &self.wish) else { return Err(nothing_yet()) };
        let mut session = shot.session.clone();
        let own = session.image().clone();
        let tonemap = wish.tonemap(own.tonemap)?;
        session.set_image(ImageSettings {
            exposure: wish.exposure,
            tonemap,
            denoise: wish.denoise,
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
        let shot = self.shot.as_ref().ok_or_else(nothing_yet)?;
        let sample = shot.checked(pixel, sample)?;
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
        let shot = self.shot.as_ref().ok_or_else(nothing_yet)?;
        shot.check_pixel([x, y])?;
        let film = shot.film.as_ref().ok_or_else(nothing_yet)?;
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
        let (Some(shot), Some(wish), Some(loaded)) = (&self.shot, &self.wish, &self.loaded) else {
            return Err(nothing_yet());
        };
        let film = shot.film.as_ref().ok_or_else(nothing_yet)?;
        let (format, extension, mime) = match format {
            FileFormat::Png => (Format::Png, "png", "image/png"),
            FileFormat::Exr => (Format::Exr, "exr", "image/x-exr"),
        };
        let shown = Shown { session: &shot.session, film, is_coarse: false, loaded, wish };
        let bytes = shown.file(format)?;
        let stem = self.document.settings().scene.file_stem().unwrap_or_default().to_string_lossy();
        let header = Header::File { id, name: format!("{stem}.{extension}"), mime };
        self.mailbox.send(Letter::Binary(header.frame(&[&bytes])));
        Ok(())
    }
}

fn nothing_yet() -> Error {
    refused("there is no picture yet")
}
