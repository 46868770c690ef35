//! State of a worker of the page: the files of its scene, and the window that shows it.

use std::cell::RefCell;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use lookfrom::session::Options;
use lookfrom_scene::{Budget, json};
use lookfrom_view::{Desk, Outgoing, Settings};

use crate::dropped::Dropped;

/// The time that a turn renders: messages of the page wait for so long.
const SLICE: Duration = Duration::from_millis(40);

/// The time that a part for a helper takes: much longer than its film needs to be packed and added.
const WORTHWHILE: Duration = Duration::from_secs(1);

/// Memory for all scenes and films. The address space of WebAssembly has four gigabytes, and browsers may give less.
const MEMORY: u64 = 3 << 30;

/// A worker: texts and files in, messages out.
pub(crate) struct Worker {
    /// The arguments of a call, written by the page before it.
    pub(crate) input: Vec<u8>,
    /// The result of a call, read by the page after it.
    pub(crate) output: Vec<u8>,
    files: Dropped,
    desk: Desk,
}

thread_local! {
    /// The only one of this thread.
    pub(crate) static WORKER: RefCell<Worker> = RefCell::new(Worker {
        input: Vec::new(),
        output: Vec::new(),
        files: Dropped::default(),
        desk: Desk::new(SLICE),
    });
}

impl Worker {
    /// Takes the input as a text of this many bytes, and the bytes after it.
    fn take(&mut self, text: usize) -> (String, Vec<u8>) {
        let mut input = std::mem::take(&mut self.input);
        let rest = input.split_off(text.min(input.len()));
        (String::from_utf8_lossy(&input).into_owned(), rest)
    }

    /// Adds a file; the input is its path, of this many bytes, and its content.
    pub(crate) fn add_file(&mut self, path: usize) {
        let (path, bytes) = self.take(path);
        self.files.add(&path, bytes);
    }

    /// Forgets all files.
    pub(crate) fn forget_files(&mut self) {
        self.files = Dropped::default();
    }

    /// Opens a scene; the input is its path, of this many bytes, and that of a picture to compare it with, or nothing.
    pub(crate) fn open(&mut self, scene: usize) {
        let (scene, reference) = self.take(scene);
        let reference = String::from_utf8(reference).ok().filter(|path| !path.is_empty());
        let settings = Settings {
            scene: scene.into(),
            options: Options { budget: Budget::new(MEMORY), film: true, ..Options::default() },
            environment: None,
            reference: reference.map(PathBuf::from),
            typed: Vec::new(),
        };
        self.desk.open(settings, Arc::new(self.files.clone()));
    }

    /// Takes the message that the input is.
    pub(crate) fn hear(&mut self) {
        let (text, _) = self.take(usize::MAX);
        self.desk.hear(&text);
    }

    /// Answers, and renders for a slice of time; returns whether there is more to render.
    pub(crate) fn turn(&mut self) -> bool {
        self.desk.turn()
    }

    /// Puts a part of the picture for a helper into the output, as JSON; whether there is one.
    pub(crate) fn lend(&mut self) -> bool {
        let part = self.desk.lend(WORTHWHILE);
        self.output = part.as_ref().map(json::line).unwrap_or_default().into_bytes();
        part.is_some()
    }

    /// Renders the part of another worker that the input is, and puts its film into the output; nothing where that cannot be.
    pub(crate) fn render_part(&mut self) {
        let (part, _) = self.take(usize::MAX);
        let film = serde_json::from_str(&part).ok().and_then(|part| self.desk.render_part(&part));
        self.output = film.unwrap_or_default();
        // Nobody listens to a helper.
        while self.desk.say().is_some() {}
    }

    /// Takes back a part; the input is the part, of this many bytes, and its film.
    pub(crate) fn take_part(&mut self, part: usize) {
        let (part, film) = self.take(part);
        if let Ok(part) = serde_json::from_str(&part) {
            self.desk.take_part(&part, &film);
        }
    }

    /// Puts the next message of the page into the output, and returns its kind: 0 for none, 1 for a text, 2 for a frame.
    pub(crate) fn say(&mut self) -> u32 {
        let (kind, bytes) = match self.desk.say() {
            None => (0, Vec::new()),
            Some(Outgoing::Text(text)) => (1, text.into_bytes()),
            Some(Outgoing::Binary(bytes)) => (2, bytes),
        };
        self.output = bytes;
        kind
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn put(worker: &mut Worker, text: &str, rest: &[u8]) -> usize {
        worker.input = [text.as_bytes(), rest].concat();
        text.len()
    }

    #[test]
    fn files_and_messages_go_in_and_a_picture_comes_out() {
        let mut worker = Worker {
            input: Vec::new(),
            output: Vec::new(),
            files: Dropped::default(),
            desk: Desk::new(SLICE),
        };
        let scene =
            b"image = { width = 8, height = 8 }\nrender = { samples = 1 }\nsphere = [{ radius = 1 }]\n";
        let path = put(&mut worker, "a/scene.toml", scene);
        worker.add_file(path);
        let path = put(&mut worker, "a/scene.toml", b"");
        worker.open(path);
        worker.turn();
        assert_eq!(worker.say(), 1);
        assert!(
            worker.output.starts_with(br#"{"type":"scene""#),
            "{}",
            String::from_utf8_lossy(&worker.output)
        );
        put(&mut worker, r#"{"type": "view", "id": 1}"#, b"");
        worker.hear();
        while worker.turn() {}
        let mut kinds = Vec::new();
        while let kind @ 1.. = worker.say() {
            kinds.push(kind);
        }
        assert_eq!(kinds.last(), Some(&2), "a picture is last");

        worker.forget_files();
        let path = put(&mut worker, "a/scene.toml", b"");
        worker.open(path);
        worker.turn();
        assert_eq!(worker.say(), 1);
        assert!(worker.output.starts_with(br#"{"type":"error""#), "it is forgotten");
    }
}
