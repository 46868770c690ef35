//! A front end in the browser: pictures while they render, and the reason of every pixel.
//!
//! A [`Server`] serves a page and a WebSocket on a local port. It draws everything itself, by the kernel and the development
//! of every other front end; the page shows pictures and numbers. Each window of the page has a view, a film and a thread of
//! its own; all share the `document`: the scene, which is read again when one of its files changes.
//!
//! A [`Desk`] is the other end of the same page where there is no server, in a worker of the browser: one window, whose caller brings
//! the messages, and gives it turns.
//!
//! The messages are in `message`. The page is in `assets/`: embedded in release builds, read from disk at each request in
//! builds with debug assertions.

mod answers;
mod assets;
mod bundle;
mod compare;
mod cost;
mod desk;
mod develop;
mod document;
mod handout;
mod heat;
mod lent;
mod lobe;
mod mailbox;
mod message;
mod parts;
#[cfg(feature = "server")]
mod patience;
mod render;
#[cfg(feature = "server")]
mod server;
mod source;
mod space;
mod told;
mod view;
mod view_render;
#[cfg(feature = "server")]
mod window;
mod words;

use std::path::PathBuf;

use lookfrom::session::Options;

pub use desk::Desk;
pub use handout::handout;
pub use lent::Part;
pub use mailbox::Outgoing;
#[cfg(feature = "server")]
pub use server::{Address, Server};

/// The scene that is shown.
#[derive(Clone, Debug)]
pub struct Settings {
    /// A scene or model file.
    pub scene: PathBuf,
    /// Options of its session, without an environment map.
    pub options: Options,
    /// An environment map, read again when it changes.
    pub environment: Option<PathBuf>,
    /// A picture that the view can be compared with.
    pub reference: Option<PathBuf>,
    /// The words of the command line after `lookfrom render` that give these options: "copy as command line" begins with
    /// them.
    pub typed: Vec<String>,
}
