//! A view and its films: a coarse picture, then the film, pass by pass.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use lookfrom::core::clock::Stopwatch;
use lookfrom::film::Film;
use lookfrom::render::{Progress, SampleId, StopCriteria, StopReason, TileDone};
use lookfrom::session::{MOST_SAMPLES, Session};
use lookfrom_scene::Result;
use lookfrom_scene::budget::Reservation;
use lookfrom_scene::settings::{ImageSettings, RenderSettings};

use crate::cost::CostMap;
use crate::document::Loaded;
use crate::lent::Lent;
use crate::mailbox::Mailbox;
use crate::message::{Answer, ViewRequest};
use crate::view::refused;

/// The time that a coarse picture may take while the camera is moved.
const FRAME: Duration = Duration::from_millis(50);

/// The time that a pass shall take.
const PASS: Duration = Duration::from_millis(400);

/// Pixels of the view per pixel of the first coarse picture, while nothing is known of its cost.
const FIRST_SCALE: u32 = 8;

/// The coarsest picture.
const COARSEST: u32 = 32;

/// A view and its films.
pub(crate) struct ViewRender {
    pub(crate) session: Session,
    /// The last coarse picture.
    pub(crate) coarse: Option<Coarse>,
    pub(crate) film: Option<Film>,
    pub(crate) cost: Option<CostMap>,
    /// Samples that every pixel of the film has.
    pub(crate) samples: u32,
    /// Samples of the next pass.
    pub(crate) pass: u32,
    pub(crate) rays: u64,
    pub(crate) spent: Duration,
    /// Seconds for one sample of one pixel, if known.
    pub(crate) pace: Option<f64>,
    /// The time of the next pass so far, of which messages may have interrupted it.
    spent_on_pass: Duration,
    /// Stopwatch of the last denoised picture, and the shortest time from it to the next: denoising takes time from the render.
    pub(crate) denoised: Option<(Stopwatch, Duration)>,
    pub(crate) stage: Stage,
    pub(crate) lent: Lent,
    /// The memory of the film and its pictures.
    _memory: Reservation,
}

pub(crate) struct Coarse {
    _memory: Reservation,
    pub(crate) scale: u32,
    pub(crate) session: Session,
    pub(crate) film: Film,
}

/// The stage of a picture that is to be rendered next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stage {
    Coarse(u32),
    Full,
    Done,
}

impl ViewRender {
    /// # Errors
    /// `Limit` where there is no memory left for it.
    pub(crate) fn new(session: Session, pace: Option<f64>) -> Result<Self> {
        let memory = session.room_for_picture()?;
        let scale = pace.map_or(FIRST_SCALE, |pace| scale_of(session.image(), pace));
        let lent = Lent::none(session.settings().samples);
        Ok(Self {
            session,
            coarse: None,
            film: None,
            cost: None,
            samples: 0,
            pass: 1,
            rays: 0,
            spent: Duration::ZERO,
            pace,
            spent_on_pass: Duration::ZERO,
            denoised: None,
            stage: Stage::Coarse(scale),
            lent,
            _memory: memory,
        })
    }

    /// Takes over the number of samples of a request for the same light.
    pub(crate) fn take_samples(&mut self, request: &ViewRequest, loaded: &Loaded) -> Result<()> {
        let samples = request.samples.unwrap_or(loaded.session.settings().samples);
        if samples == self.session.settings().samples {
            return Ok(());
        }
        self.session.set_settings(RenderSettings { samples, ..self.session.settings().clone() })?;
        // The last samples of the former number may be in the film.
        if samples < self.samples || self.lent.back > 0 {
            (self.film, self.samples, self.pass, self.rays, self.spent) = (None, 0, 1, 0, Duration::ZERO);
        }
        self.lent = Lent::none(samples);
        if self.stage == Stage::Done && samples != self.samples {
            self.stage = Stage::Full;
        }
        Ok(())
    }

    /// Renders one sample of each pixel of a smaller picture.
    pub(crate) fn render_coarse(&mut self, scale: u32, moving: bool, mailbox: &Mailbox) -> Result<bool> {
        let mut session = self.session.clone();
        let mut image = session.image().clone();
        image.resize(image.width.div_ceil(scale), image.height.div_ceil(scale));
        session.set_image(ImageSettings { denoise: false, ..image })?;
        session.set_settings(RenderSettings { samples: 1, ..session.settings().clone() })?;
        // The last one is needed no more.
        self.coarse = None;
        let memory = session.room_for_picture()?;
        let film = Film::for_image(session.image())?;
        let pixels = film.width() as f64 * film.height() as f64;
        let started = Stopwatch::start();
        let rendered = session.renderer().render_onto(
            film,
            0,
            &StopCriteria::default(),
            None,
            &Watch::new(mailbox, false, None),
        )?;
        self.pace = Some(started.elapsed().as_secs_f64() / pixels);
        self.coarse = Some(Coarse { _memory: memory, scale, session, film: rendered.film });
        self.stage = if moving { Stage::Done } else { self.after_coarse() };
        Ok(rendered.reason != StopReason::Cancelled)
    }

    /// The stage after the coarse picture, if the camera stands still.
    pub(crate) fn after_coarse(&self) -> Stage {
        let finer = self.pace.map_or(FIRST_SCALE, |pace| scale_of(self.session.image(), pace / 4.0));
        match &self.coarse {
            None => Stage::Coarse(FIRST_SCALE),
            Some(coarse) if coarse.scale > 2 && finer > 1 => Stage::Coarse(2),
            Some(_) => Stage::Full,
        }
    }

    /// Adds samples to the film, for at most as long as a slice, where there is one. Whether there is a whole pass more.
    pub(crate) fn render_pass(&mut self, mailbox: &Mailbox, slice: Option<Duration>) -> Result<bool> {
        let end = self.lent.start.min(self.samples.saturating_add(self.pass));
        let film = match self.film.take() {
            Some(film) => film,
            None => Film::for_image(self.session.image())?,
        };
        let settings = RenderSettings { samples: end, ..self.session.settings().clone() };
        let renderer = self.session.renderer().with_settings(settings)?;
        let started = Stopwatch::start();
        let watch = Watch::new(mailbox, true, slice);
        let rendered = renderer.render_onto(film, 0, &StopCriteria::default(), None, &watch)?;
        let elapsed = started.elapsed();
        self.film = Some(rendered.film);
        self.rays += rendered.rays.total();
        self.spent += elapsed;
        self.spent_on_pass += elapsed;
        if rendered.reason == StopReason::Cancelled {
            return Ok(false);
        }
        self.samples = end;
        if std::mem::take(&mut self.spent_on_pass) < PASS / 2 {
            self.pass = self.pass.saturating_mul(2);
        }
        self.settle();
        Ok(true)
    }

    /// Whether all that is left is lent.
    pub(crate) fn is_waiting(&self) -> bool {
        self.samples == self.lent.start && self.lent.out > 0
    }

    /// Ends the render if every sample is there.
    pub(crate) fn settle(&mut self) {
        if self.samples == self.lent.start && self.lent.out == 0 {
            self.samples = self.session.settings().samples;
            self.lent = Lent::none(self.samples);
            self.stage = Stage::Done;
        }
    }

    /// Whether the film is finished.
    pub(crate) fn is_done(&self) -> bool {
        self.film.is_some() && self.stage == Stage::Done
    }

    /// The progress of the view of this number.
    pub(crate) fn progress(&self, view: u64) -> Answer {
        let seconds = self.spent.as_secs_f64();
        Answer::Progress {
            view,
            samples: self.samples + self.lent.back,
            of: self.session.settings().samples,
            seconds,
            rays_per_second: self.rays as f64 / seconds.max(1e-9),
            done: self.is_done(),
            hash: self.film.as_ref().filter(|_| self.is_done()).map(Film::hash),
        }
    }

    /// A sample of this view.
    pub(crate) fn checked(&self, pixel: [u32; 2], sample: u32) -> Result<SampleId> {
        self.check_pixel(pixel)?;
        match sample < MOST_SAMPLES {
            true => Ok(SampleId { pixel, sample }),
            false => Err(refused(format!("there is no sample {sample}"))),
        }
    }

    pub(crate) fn check_pixel(&self, [x, y]: [u32; 2]) -> Result<()> {
        let ImageSettings { width, height, .. } = *self.session.image();
        if x >= width || y >= height {
            return Err(refused(format!(
                "pixel {x} {y} is outside of the picture of {width} × {height} pixels"
            )));
        }
        Ok(())
    }
}

/// The finest scale whose picture takes no longer than a frame.
fn scale_of(image: &ImageSettings, pace: f64) -> u32 {
    let whole = f64::from(image.width) * f64::from(image.height) * pace;
    let mut scale = 1;
    while scale < COARSEST && whole / f64::from(scale * scale) > FRAME.as_secs_f64() {
        scale *= 2;
    }
    scale
}

/// Ends a render when its window is closed, and a pass when there is a message, or its slice of time is over.
struct Watch<'a> {
    mailbox: &'a Mailbox,
    is_interruptible: bool,
    started: Stopwatch,
    slice: Option<Duration>,
    /// Whether the slice is over. A tile that has begun is finished: else a slice could be too short for any.
    is_over: AtomicBool,
}

impl<'a> Watch<'a> {
    fn new(mailbox: &'a Mailbox, is_interruptible: bool, slice: Option<Duration>) -> Self {
        Self {
            mailbox,
            is_interruptible,
            started: Stopwatch::start(),
            slice,
            is_over: AtomicBool::new(false),
        }
    }
}

impl Progress for Watch<'_> {
    fn tile(&self, _: TileDone) {
        if self.slice.is_some_and(|slice| self.started.elapsed() >= slice) {
            self.is_over.store(true, Ordering::Relaxed);
        }
    }

    fn cancelled(&self) -> bool {
        self.mailbox.is_closed()
            || self.is_interruptible && self.mailbox.has_tasks()
            || self.is_over.load(Ordering::Relaxed)
    }
}
