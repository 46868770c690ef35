//! The scenes of the repository are read without an error or a warning, and `docs/guide/scene-format.md` tells of every
//! key that there is.

use std::path::{Path, PathBuf};

use glam::DVec3;
use lookfrom_scene::camera::{Look, Projection};
use lookfrom_scene::lens::LensConvention;
use lookfrom_scene::{Disk, LoadContext, load, toml};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn scenes(folder: &str) -> Vec<PathBuf> {
    let mut paths: Vec<PathBuf> = std::fs::read_dir(root().join(folder))
        .expect("the folder is there")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .collect();
    paths.sort();
    paths
}

fn guide() -> String {
    std::fs::read_to_string(root().join("docs/guide/scene-format.md")).expect("the guide is there")
}

#[test]
fn all_scenes_are_read() {
    let (own, snippets) = (scenes("scenes"), scenes("docs/guide/scenes"));
    assert!(own.len() >= 10 && snippets.len() >= 10);
    for path in own.iter().chain(&snippets) {
        let mut context = LoadContext::new(&Disk);
        let scene = load::scene(path, &mut context).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(context.warnings, [], "{}", path.display());
        assert!(scene.camera.is_some(), "{} has no camera", path.display());
        assert!(!scene.bounds().is_empty(), "{} is empty", path.display());
    }
    for path in &own {
        let text = std::fs::read_to_string(path).expect("a scene");
        assert!(text.starts_with("# "), "{} does not say what it shows", path.display());
    }
}

#[test]
fn the_guide_tells_of_every_key() {
    let guide = guide();
    for (table, keys) in toml::vocabulary() {
        for key in keys {
            assert!(
                guide.contains(&format!("`{key}`")),
                "scene-format.md does not tell of `{key}` in {table}"
            );
        }
    }
}

#[test]
fn the_guide_shows_every_small_scene() {
    let guide = guide();
    for path in scenes("docs/guide/scenes") {
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        assert!(guide.contains(&format!("](img/{name}.png)")), "scene-format.md does not show {name}");
        assert!(
            guide.contains(&format!("(scenes/{name}.toml)")),
            "scene-format.md does not name {name}.toml"
        );
    }
}

#[test]
fn a_lens_file_makes_a_lens_system() {
    let path = root().join("docs/guide/scenes/camera-lens-system.toml");
    let scene = load::scene(&path, &mut LoadContext::new(&Disk)).unwrap_or_else(|error| panic!("{error}"));
    let camera = scene.camera.expect("a camera");
    let Projection::LensSystem(system) = &camera.projection else { panic!("{:?}", camera.projection) };
    assert_eq!((system.surfaces.len(), system.film_diagonal, system.millimetre), (11, 43.3, 0.012));
    assert_eq!((system.stop_diameter, system.convention), (None, LensConvention::AsPinhole));
    // Focused on a point at this distance along the axis, and still so after a move.
    assert!((system.focus_distance - 5.746).abs() < 0.01, "{}", system.focus_distance);
    let mut moved = camera.clone();
    let look = Look { lookfrom: DVec3::new(0.0, 0.6, 3.0), lookat: DVec3::new(0.0, 0.6, 0.0), up: DVec3::Y };
    moved.set_look(look, DVec3::ZERO);
    assert_eq!(moved.focus_distance(), Some(3.0));
    assert_eq!(camera.focus_distance(), Some(system.focus_distance));
    assert_eq!(system.scaled(2.0).millimetre, 0.024);
}

/// Every snippet of the guide is a scene, or becomes one with what the guide takes for granted.
#[test]
fn the_snippets_of_the_guide_are_read() {
    let guide = guide();
    let snippets: Vec<&str> =
        guide.split("```toml\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    assert!(snippets.len() > 15);
    let root = root().canonicalize().expect("a place");
    for (index, snippet) in snippets.iter().enumerate() {
        let mut files = lookfrom_scene::Memory::default();
        for file in ["images/tiles.png", "models/knot.obj", "models/star.ply", "textures.toml"] {
            files.0.insert(file.into(), std::fs::read(root.join("scenes").join(file)).expect("our own file"));
        }
        let font = std::fs::read(root.join("docs/guide/scenes/parts/letters.ttf")).expect("our own font");
        files.0.insert("letters.ttf".into(), font);
        let lens =
            std::fs::read(root.join("docs/guide/scenes/parts/double-gauss.dat")).expect("our own lens");
        files.0.insert("double-gauss.dat".into(), lens);
        files.0.insert("jack.obj".into(), b"v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n".to_vec());
        let fox = r#"{"asset": {"version": "2.0"}, "animations": [{"name": "Run", "channels": [], "samplers": []}]}"#;
        files.0.insert("fox.glb".into(), fox.into());
        // Names that other snippets give.
        let names = "[materials.red]\n[materials.glass]\n[textures.wood]\ntype = \"noise\"\n[[objects.tree.sphere]]\n";
        files.0.insert("names.toml".into(), names.as_bytes().to_vec());
        let own = |name: &str| snippet.contains(name);
        let needs_names = !own("import") && !own("[materials.") && !own("[textures.") && !own("[[objects.");
        let text = format!("{}{snippet}", if needs_names { "import = \"names.toml\"\n" } else { "" });
        files.0.insert("snippet.toml".into(), text.into_bytes());
        if let Err(error) = load::scene(Path::new("snippet.toml"), &mut LoadContext::new(&files)) {
            panic!("snippet {index} of scene-format.md: {error}\nin\n{snippet}");
        }
    }
}

/// The blocks of the tutorial, one after the other, are the scene that it shows.
#[test]
fn the_tutorial_makes_its_scene() {
    let tutorial = std::fs::read_to_string(root().join("docs/guide/tutorial.md")).expect("the tutorial");
    let scene = std::fs::read_to_string(root().join("scenes/still-life.toml")).expect("its scene");
    let blocks: Vec<&str> =
        tutorial.split("```toml\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    let (_, written) = scene.split_once("\n\n").expect("a line about it");
    assert_eq!(blocks.join("\n"), written);
    // After each of them there is a scene without errors, once there is anything to see.
    for count in 2..=blocks.len() {
        let files =
            lookfrom_scene::Memory([("s.toml".into(), blocks[..count].join("\n").into_bytes())].into());
        if let Err(error) = load::scene(Path::new("s.toml"), &mut LoadContext::new(&files)) {
            panic!("after block {count}: {error}");
        }
    }
}
