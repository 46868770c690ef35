//! The other end of a page without a server: one window, on the thread of its caller.

use std::sync::Arc;
use std::time::Duration;

use lookfrom_scene::Inputs;
use lookfrom_scene::files::SharedFiles;

use crate::Settings;
use crate::document::Document;
use crate::lent::Part;
use crate::mailbox::{Mailbox, Outgoing, Task};
use crate::message::Request;
use crate::render::Window;

/// A window whose caller brings the messages of the page, takes away the answers, and gives it turns.
pub struct Desk {
    mailbox: Arc<Mailbox>,
    slice: Duration,
    window: Option<Window>,
    /// Number of scenes so far.
    generation: u64,
}

impl Desk {
    /// Without a scene. A turn renders for about as long as a slice.
    pub fn new(slice: Duration) -> Self {
        Self { mailbox: Arc::default(), slice, window: None, generation: 0 }
    }

    /// Reads a scene among these files, of which the page is told at the next turn: by the scene, or by what is wrong with it. A scene of
    /// the same name is shown in the same view, and the last good one stays until it can be read.
    pub fn open(&mut self, settings: Settings, files: SharedFiles) {
        let name = settings.scene.clone();
        let document = Arc::new(Document::new(settings, files));
        self.generation += 1;
        document.read(self.generation, &Inputs::default());
        match &mut self.window {
            Some(window) if window.document.settings().scene == name => window.document = document,
            _ => self.window = Some(Window::new(self.mailbox.clone(), document, Some(self.slice))),
        }
        self.mailbox.put(Task::SceneChanged);
    }

    /// Takes a message of the page, which is answered at the next turn.
    pub fn hear(&self, text: &str) {
        match Request::of_text(text) {
            Ok(request) => self.mailbox.put(Task::Request(request)),
            Err(answer) => self.mailbox.say(&answer),
        }
    }

    /// Answers what was heard, and renders for a slice of time. Returns whether there is more to render.
    pub fn turn(&mut self) -> bool {
        let Some(window) = &mut self.window else { return false };
        window.turn(self.mailbox.take(false).unwrap_or_default());
        window.has_work()
    }

    /// Some samples of the picture for a helper, a desk with the same scene and the same view; none where all that is left takes
    /// less than twice as long as `least`, as far as is known. The helper's film, or an empty one, has to be [taken](Self::take_part).
    pub fn lend(&mut self, least: Duration) -> Option<Part> {
        let window = self.window.as_mut().filter(|window| window.has_work())?;
        window.render.as_mut()?.lend(least)
    }

    /// Renders a part that another desk lends, and returns its film as a file; `None` where that cannot be. Needs
    /// [`Options::film`](lookfrom::session::Options::film), as does taking it.
    pub fn render_part(&mut self, part: &Part) -> Option<Vec<u8>> {
        let window = self.window.as_mut()?;
        window.hear(self.mailbox.take(false).unwrap_or_default());
        window.render.as_ref()?.render_part(part).ok()
    }

    /// Takes back a part with its film, of which the page is told. Where it cannot be added, its samples are rendered here.
    pub fn take_part(&mut self, part: &Part, film: &[u8]) {
        if let Some(window) = &mut self.window {
            window.take_part(part, film);
        }
    }

    /// The next message for the page, if there is one.
    pub fn say(&self) -> Option<Outgoing> {
        self.mailbox.outgoing()
    }
}
