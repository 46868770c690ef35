//! A front end in the browser: pictures while they render, and the reason of every pixel.
//!
//! A [`Server`] serves a page and a WebSocket on a local port. It draws everything itself, by the kernel and the development
//! of every other front end; the page shows pictures and numbers. Each window of the page has a view, a film and a thread of
//! its own; all share the `document`: the scene, which is read again when one of its files changes.
//!
//! The messages are in `message`. The page is in `assets/`: embedded in release builds, read from disk at each request in
//! builds with debug assertions.

mod assets;
mod compare;
mod cost;
mod develop;
mod document;
mod heat;
mod lobe;
mod mailbox;
mod message;
mod patience;
mod render;
mod server;
mod space;
mod told;
mod view;
mod view_render;
mod window;
mod words;

use std::net::IpAddr;
use std::path::PathBuf;

use lookfrom::session::Options;

pub use server::Server;

/// The scene that is shown, and the address of its page.
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
    /// The address to listen at.
    pub host: IpAddr,
    /// The port; 0 for any that is free.
    pub port: u16,
    /// Whether pages of this machine, such as notebooks, may show it in a frame.
    pub may_be_framed: bool,
}
