//! A folder of its own for each test, with small scenes in it, where the command runs.

use std::path::PathBuf;
use std::process::{Command, Output};

use serde_json::Value;

/// A small scene that every part of the program has something to do with, and that no test has to wait for.
pub(super) const SCENE: &str = r#"
[camera]
lookfrom = [0, 1, 5]
lookat = [0, 0.5, 0]
fov = 40

[image]
width = 40
height = 30

[render]
samples = 4

[materials.mirror]
diffuse = 0.2
mirror = 0.7

[[sphere]]
center = [0, 0.5, 0]
radius = 0.5
material = "mirror"

[[quad]]
corner = [-5, 0, 5]
edge_u = [10, 0, 0]
edge_v = [0, 0, -10]

[[light]]
type = "point"
position = [3, 4, 5]
intensity = 20
"#;

/// One triangle.
pub(super) const MODEL: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// A folder that is gone after the test.
pub(super) struct Stage {
    folder: PathBuf,
}

/// What a run of the command came to.
#[derive(Debug)]
pub(super) struct Run {
    pub(super) code: Option<i32>,
    pub(super) stdout: Vec<u8>,
    pub(super) stderr: String,
}

impl Stage {
    /// A new folder with `scene.toml` and `model.obj`; `name` is that of the test.
    pub(super) fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("lookfrom-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let stage = Self { folder };
        stage.write("scene.toml", SCENE);
        stage.write("model.obj", MODEL);
        stage
    }

    /// A path in the folder.
    pub(super) fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Writes a file.
    pub(super) fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).unwrap();
    }

    /// The bytes of a file.
    pub(super) fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// The names of all files, sorted.
    pub(super) fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.folder).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// The command, ready to run in the folder with arguments that are separated by spaces.
    pub(super) fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_lookfrom"));
        command.current_dir(&self.folder).args(arguments.split_whitespace());
        command
    }

    /// Runs the command.
    pub(super) fn run(&self, arguments: &str) -> Run {
        self.command(arguments).output().unwrap().into()
    }

    /// Runs the command, which must succeed.
    pub(super) fn done(&self, arguments: &str) -> Run {
        let run = self.run(arguments);
        assert_eq!(run.code, Some(0), "{arguments}: {}", run.stderr);
        run
    }

    /// Runs the command, which must succeed and answer with one JSON object over many lines.
    pub(super) fn json_document(&self, arguments: &str) -> Value {
        serde_json::from_slice(&self.done(arguments).stdout).unwrap()
    }

    /// Runs the command, which must succeed and answer with JSON objects, one a line.
    pub(super) fn json(&self, arguments: &str) -> Vec<Value> {
        self.done(arguments).json()
    }
}

impl Drop for Stage {
    fn drop(&mut self) {
        // What is left of a temporary folder is the system's to clear.
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

impl Run {
    /// The JSON objects on stdout.
    pub(super) fn json(&self) -> Vec<Value> {
        let text = std::str::from_utf8(&self.stdout).unwrap();
        text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    }

    /// The run must have ended with this code, said this on stderr, and nothing on stdout.
    #[track_caller]
    pub(super) fn fails(&self, code: i32, says: &[&str]) {
        assert_eq!(self.code, Some(code), "{}", self.stderr);
        for word in says {
            assert!(self.stderr.contains(word), "{word:?} is not in: {}", self.stderr);
        }
        assert!(!self.stderr.contains("panicked"), "{}", self.stderr);
        assert!(self.stdout.is_empty(), "{}", String::from_utf8_lossy(&self.stdout));
    }
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code(),
            stdout: output.stdout,
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }
}
