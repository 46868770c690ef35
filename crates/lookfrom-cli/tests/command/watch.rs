//! `render --watch`: pictures that follow their files.

use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use super::stage::{MODEL, SCENE, Stage};

/// A child that does not outlive its test.
struct Watching(Child);

impl Drop for Watching {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Waits until the picture is another one than `before`, and whole.
fn next(stage: &Stage, before: &[u8]) -> Vec<u8> {
    let started = Instant::now();
    while started.elapsed() < Duration::from_secs(60) {
        if let Ok(bytes) = std::fs::read(stage.path("p.ppm"))
            && bytes != before
        {
            return bytes;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    panic!("no new picture");
}

#[test]
fn a_picture_follows_the_scene_and_what_it_reads() {
    let stage = Stage::new("watch");
    let scene = format!("{SCENE}\n[[mesh]]\nfile = \"model.obj\"\n");
    stage.write("scene.toml", &scene);
    let mut command = stage.command("render scene.toml --watch --samples 1 --width 24 -o p.ppm");
    let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut watching = Watching(child);
    let first = next(&stage, &[]);
    stage.write("model.obj", &MODEL.replace("v 1 0 0", "v 3 0 0"));
    let second = next(&stage, &first);
    // While the scene is broken, the last good picture stays.
    stage.write("scene.toml", "[camera]\nlokfrom = 1\n");
    std::thread::sleep(Duration::from_millis(1500));
    assert!(stage.bytes("p.ppm") == second);
    stage.write("scene.toml", &scene.replace("radius = 0.5", "radius = 0.75"));
    next(&stage, &second);
    std::thread::sleep(Duration::from_millis(500));
    let sent = Command::new("kill").args(["-INT", &watching.0.id().to_string()]).status().unwrap();
    assert!(sent.success());
    assert_eq!(watching.0.wait().unwrap().code(), Some(130));
    let mut told = String::new();
    std::io::Read::read_to_string(&mut watching.0.stderr.take().unwrap(), &mut told).unwrap();
    assert!(told.contains("lokfrom = 1") && told.contains("waiting for changes"), "{told}");
}
