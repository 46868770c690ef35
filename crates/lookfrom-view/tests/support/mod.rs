//! A server of a scene in a temporary folder, and pages without a browser.

use std::io::{BufRead, BufReader, Write};
use std::net::{Ipv4Addr, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use futures_util::{SinkExt, StreamExt};
use lookfrom::session::Options;
use lookfrom_view::{Address, Server, Settings};
use serde_json::{Value, json};
use tokio::net::TcpStream as AsyncStream;
use tokio::runtime::Runtime;
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::{MaybeTlsStream, WebSocketStream, connect_async};

/// The longest wait for anything.
const PATIENCE: Duration = Duration::from_secs(60);

/// A small scene.
pub(crate) const SCENE: &str = r#"
[camera]
lookfrom = [0, 1, 5]
lookat = [0, 0, 0]

[image]
width = 64
height = 48

[render]
samples = 4

[[sphere]]
center = [0, 0, 0]
radius = 1

[[light]]
type = "point"
position = [3, 4, 5]
intensity = [20, 20, 20]
"#;

/// A server that ends when it is dropped.
pub(crate) struct Served {
    pub(crate) url: String,
    pub(crate) scene: PathBuf,
    pub(crate) windows: Arc<AtomicUsize>,
    stopped: Arc<AtomicBool>,
    thread: Option<JoinHandle<std::io::Result<()>>>,
}

impl Served {
    /// Serves a scene file of this text.
    pub(crate) fn new(name: &str, text: &str) -> Self {
        Self::with_reference(name, text, |_| None)
    }

    /// Serves a scene file of this text, with a picture that `reference` makes of it.
    pub(crate) fn with_reference(
        name: &str,
        text: &str,
        reference: impl FnOnce(&Path) -> Option<PathBuf>,
    ) -> Self {
        let options = Options::default();
        Self::with(name, Some(text), options, reference, Duration::from_secs(60))
    }

    /// The same with options and a longest silence; without a text there is no file yet.
    pub(crate) fn with(
        name: &str,
        text: Option<&str>,
        options: Options,
        reference: impl FnOnce(&Path) -> Option<PathBuf>,
        patience: Duration,
    ) -> Self {
        let folder = std::env::temp_dir().join(format!("lookfrom-view-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a temporary folder");
        let scene = folder.join("scene.toml");
        match text {
            Some(text) => std::fs::write(&scene, text).expect("a temporary file"),
            // One that an earlier run has left.
            None => drop(std::fs::remove_file(&scene)),
        }
        let reference = reference(&scene);
        Self::start(scene, options, reference, patience)
    }

    /// Serves a scene file that is there; its folder ends with the server.
    pub(crate) fn of(scene: &Path) -> Self {
        Self::start(scene.to_owned(), Options::default(), None, Duration::from_secs(60))
    }

    fn start(scene: PathBuf, options: Options, reference: Option<PathBuf>, patience: Duration) -> Self {
        let settings =
            Settings { scene: scene.clone(), options, environment: None, reference, typed: Vec::new() };
        let address = Address { host: Ipv4Addr::LOCALHOST.into(), port: 0, may_be_framed: false };
        let server = Server::bind(settings, address).expect("a free port").with_patience(patience);
        let (url, windows) = (server.url(), server.windows());
        let stopped = Arc::new(AtomicBool::new(false));
        let thread = {
            let stopped = stopped.clone();
            std::thread::spawn(move || server.run(|| stopped.load(Ordering::Relaxed)))
        };
        Self { url, scene, windows, stopped, thread: Some(thread) }
    }

    /// Replaces the scene's file.
    pub(crate) fn write(&self, text: &str) {
        std::fs::write(&self.scene, text).expect("the file is ours");
    }

    /// `127.0.0.1:port`.
    pub(crate) fn host(&self) -> &str {
        self.url.trim_start_matches("http://").split('/').next().expect("a host")
    }

    pub(crate) fn token(&self) -> &str {
        self.url.split('=').nth(1).expect("a token")
    }

    /// The first line of the answer to a request with these headers.
    pub(crate) fn status(&self, path: &str, headers: &str) -> String {
        let mut stream = TcpStream::connect(self.host()).expect("it listens");
        let request = format!("GET {path} HTTP/1.1\r\n{headers}\r\n");
        stream.write_all(request.as_bytes()).expect("it reads");
        let mut answer = String::new();
        BufReader::new(stream).read_line(&mut answer).expect("it answers");
        answer
    }

    /// Opens a window.
    pub(crate) fn open(&self) -> Page {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
        let url = format!("ws://{}/socket?token={}", self.host(), self.token());
        let (socket, _) = runtime.block_on(connect_async(url)).expect("a socket");
        Page { runtime, socket }
    }

    /// Waits until this many windows have threads.
    pub(crate) fn wait_for_windows(&self, count: usize) {
        let started = Instant::now();
        while self.windows.load(Ordering::Acquire) != count {
            assert!(started.elapsed() < PATIENCE, "{} windows", self.windows.load(Ordering::Acquire));
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.stopped.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let ended = thread.join().expect("it does not panic");
            assert!(ended.is_ok() || std::thread::panicking(), "{ended:?}");
        }
        let _ = std::fs::remove_dir_all(self.scene.parent().unwrap_or(Path::new("")));
    }
}

/// A window of a page.
pub(crate) struct Page {
    runtime: Runtime,
    socket: WebSocketStream<MaybeTlsStream<AsyncStream>>,
}

/// A binary frame.
#[derive(Debug)]
pub(crate) struct Frame {
    pub(crate) header: Value,
    pub(crate) payload: Vec<u8>,
}

/// Anything from the server.
#[derive(Debug)]
pub(crate) enum Heard {
    Text(Value),
    Frame(Frame),
}

impl Page {
    pub(crate) fn say(&mut self, message: &Value) {
        self.say_text(message.to_string());
    }

    /// Sends a text. If the server has hung up, the next message is `None`.
    pub(crate) fn say_text(&mut self, text: String) {
        let _ = self.runtime.block_on(self.socket.send(Message::text(text)));
    }

    /// The next message; `None` once the socket is closed.
    pub(crate) fn hear(&mut self) -> Option<Heard> {
        let socket = &mut self.socket;
        let mut heard = async || loop {
            match socket.next().await {
                Some(Ok(Message::Ping(_) | Message::Pong(_))) => {}
                other => return other,
            }
        };
        let next = self.runtime.block_on(async { tokio::time::timeout(PATIENCE, heard()).await });
        match next.expect("an answer in time") {
            Some(Ok(Message::Text(text))) => {
                Some(Heard::Text(serde_json::from_str(&text).expect("it is JSON")))
            }
            Some(Ok(Message::Binary(bytes))) => {
                let length = u32::from_le_bytes(bytes[..4].try_into().expect("four bytes")) as usize;
                let header = serde_json::from_slice(&bytes[4..4 + length]).expect("it is JSON");
                Some(Heard::Frame(Frame { header, payload: bytes[4 + length..].to_vec() }))
            }
            _ => None,
        }
    }

    /// Does nothing for a time but what every browser does by itself: it answers pings.
    pub(crate) fn rest(&mut self, time: Duration) {
        let socket = &mut self.socket;
        let mut pings = async || while let Some(Ok(Message::Ping(_))) = socket.next().await {};
        let rested = self.runtime.block_on(async { tokio::time::timeout(time, pings()).await });
        assert!(rested.is_err(), "the server has hung up");
    }

    /// The next text of a type; others are passed over.
    pub(crate) fn text(&mut self, kind: &str) -> Value {
        loop {
            match self.hear().expect("the socket is open") {
                Heard::Text(text) if text["type"] == kind => return text,
                Heard::Text(text) => assert!(text["type"] != "error", "instead of a {kind}: {text}"),
                Heard::Frame(_) => {}
            }
        }
    }

    /// The next frame of a kind; others are passed over.
    pub(crate) fn frame(&mut self, kind: &str) -> Frame {
        loop {
            match self.hear().expect("the socket is open") {
                Heard::Frame(frame) if frame.header["kind"] == kind => return frame,
                Heard::Text(text) => assert!(text["type"] != "error", "instead of a {kind}: {text}"),
                Heard::Frame(_) => {}
            }
        }
    }

    /// The finished picture of a view.
    pub(crate) fn finished(&mut self, view: u64) -> Frame {
        loop {
            let frame = self.frame("picture");
            if frame.header["view"] == view && frame.header["done"] == true {
                return frame;
            }
        }
    }
}

/// The message for a view of the scene as it is.
pub(crate) fn view(id: u64) -> Value {
    json!({ "type": "view", "id": id })
}

/// The message for a view from somewhere.
pub(crate) fn view_from(id: u64, lookfrom: [f64; 3], moving: bool) -> Value {
    let camera = json!({ "lookfrom": lookfrom, "lookat": [0, 0, 0], "up": [0, 1, 0], "fov": null });
    json!({ "type": "view", "id": id, "camera": camera, "moving": moving, "tonemap": "clamp", "layer": "color" })
}
