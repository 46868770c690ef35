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
use lookfrom::session::Session;
use lookfrom_scene::Result;

use crate::cost::{CostMap, Counted};
use crate::develop::{self, Shown};
use crate::document::{Document, Loaded, panicked};
use crate::lent::Part;
use crate::mailbox::{Mailbox, Task};
use crate::message::{Answer, Header, Request, ViewRequest};
use crate::view::Variation;
use crate::view_render::{Stage, ViewRender};
use crate::{space, told};

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
    pub(crate) mailbox: Arc<Mailbox>,
    pub(crate) document: Arc<Document>,
    /// The longest time of a pass between two turns; `None` where messages interrupt it.
    pub(crate) slice: Option<Duration>,
    pub(crate) loaded: Option<Arc<Loaded>>,
    /// The scene as this window alone wants it.
    variation: Option<(Variation, Session)>,
    pub(crate) request: Option<ViewRequest>,
    pub(crate) render: Option<ViewRender>,
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
        self.hear(tasks);
        self.guarded(None, Self::step);
    }

    /// Does these tasks.
    pub(crate) fn hear(&mut self, tasks: Vec<Task>) {
        for task in tasks {
            let id = match &task {
                Task::Request(request) => request.id(),
                Task::SceneChanged => None,
            };
            self.guarded(id, |window| window.answer(task));
        }
    }

    /// Takes back a part of the picture, and shows it.
    pub(crate) fn take_part(&mut self, part: &Part, film: &[u8]) {
        let (Some(render), Some(loaded)) = (&mut self.render, &self.loaded) else { return };
        if render.take_part(part, film, &loaded.options.budget) {
            self.guarded(None, Self::show);
        }
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
        self.render.as_ref().is_some_and(|render| match render.stage {
            Stage::Coarse(_) => true,
            Stage::Full => !self.is_paused && !render.is_waiting(),
            Stage::Done => false,
        })
    }

    fn answer(&mut self, task: Task) -> Result<()> {
        match task {
            Task::SceneChanged => self.scene_changed(),
            Task::Request(Request::View(request)) => self.look(*request),
            Task::Request(Request::Pause { paused }) => {
                self.is_paused = paused;
                Ok(())
            }
            Task::Request(question) => {
                let answer = self.answer_to(&question)?;
                self.mailbox.send(answer);
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
            self.mailbox.say(&Answer::Scene(Box::new(loaded.told(&loaded.session))));
            (self.loaded, self.variation, self.render) = (Some(loaded), None, None);
            if let Some(request) = self.request.clone() {
                // A view that this scene cannot be shown in is refused as such.
                self.guarded(Some(request.id), |window| window.look(request));
            }
        }
        if let Some(error) = error {
            self.mailbox.say(&error);
        }
        Ok(())
    }

    /// Shows another view, or the same one developed anew.
    pub(crate) fn look(&mut self, request: ViewRequest) -> Result<()> {
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
    pub(crate) fn step(&mut self) -> Result<()> {
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
        self.mailbox.say(&render.progress(request.id));
        let started = Stopwatch::start();
        let denoises = request.denoise && render.samples > 0;
        if denoises && !render.is_done() && render.denoised.is_some_and(|(last, rest)| last.elapsed() < rest)
        {
            return Ok(());
        }
        if let Some(counted) = develop::counted(request)? {
            return self.show_cost(counted);
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
            samples: (render.samples + render.lent.back).max(1),
            of: session.settings().samples,
            done: render.is_done(),
            layer: request.layer.clone().unwrap_or_else(|| "color".to_owned()),
            seconds: render.spent.as_secs_f64(),
            camera: told::camera(&render.session),
            screen_from_world: space::of_points(&render.session),
            sizes: pictures.iter().map(Vec::len).collect(),
        };
        let parts: Vec<&[u8]> = pictures.iter().map(Vec::as_slice).collect();
        self.mailbox.show(header.frame(&parts));
        Ok(())
    }

    /// Sends a heat map of the cost, which is measured once.
    fn show_cost(&mut self, counted: Counted) -> Result<()> {
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
            done: render.is_done(),
            layer: request.layer.clone().unwrap_or_default(),
            seconds: render.spent.as_secs_f64(),
            camera: told::camera(&render.session),
            screen_from_world: space::of_points(&render.session),
            sizes: vec![png.len()],
        };
        render.cost = Some(map);
        self.mailbox.show(header.frame(&[&png]));
        Ok(())
    }
}
