//! Files that can be read only once: named pipes and process substitutions.

use std::process::Command;

use lookfrom_scene::{Disk, LoadContext, load};

/// A named pipe into which a text is written once.
fn pipe(name: &str, text: &'static str) -> std::path::PathBuf {
    let path = std::env::temp_dir().join(format!("lookfrom-pipe-{}-{name}", std::process::id()));
    let _ = std::fs::remove_file(&path);
    assert!(Command::new("mkfifo").arg(&path).status().expect("mkfifo").success());
    let written = path.clone();
    std::thread::spawn(move || std::fs::write(written, text));
    path
}

#[test]
fn pipes_are_read_once() {
    let obj = pipe("model", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let toml = pipe("scene", "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n");
    let pbrt = pipe("pbrt", "WorldBegin\nShape \"sphere\"\n");
    for path in [obj, toml, pbrt] {
        let scene =
            load::scene(&path, &mut LoadContext::new(&Disk)).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(scene.shapes.len(), 1, "{}", path.display());
        std::fs::remove_file(path).expect("it is there");
    }
}
