//! Files that can be read only once, named pipes and process substitutions; and that others are read only once, too.

use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicU32, Ordering};

use lookfrom_scene::{Disk, Files, LoadContext, Memory, Result, load};

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

/// Files that count how often they are read.
struct Counting(Memory, AtomicU32);

impl Files for Counting {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>> {
        self.1.fetch_add(1, Ordering::Relaxed);
        self.0.read(path, limit)
    }
}

#[test]
fn a_file_without_a_known_name_is_read_once() {
    let contents = [
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
        "[[sphere]]\nradius = 1\n",
        "WorldBegin\nShape \"sphere\"\n",
        r#"{"asset": {"version": "2.0"}}"#,
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n",
    ];
    for content in contents {
        let memory = Memory([("scene".into(), content.as_bytes().to_vec())].into());
        let files = Counting(memory, AtomicU32::new(0));
        load::scene(Path::new("scene"), &mut LoadContext::new(&files))
            .unwrap_or_else(|error| panic!("{content}: {error}"));
        assert_eq!(files.1.into_inner(), 1, "{content}");
    }
}
