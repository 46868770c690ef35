//! Test scenes of Mitsuba itself: each is read, or the plugin is named that is missing here.

use std::path::{Path, PathBuf};

use lookfrom_scene::{Disk, ErrorKind, LoadContext, load};

/// All files below a folder that are scenes, not parts of them.
fn scenes(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()).collect();
    entries.sort();
    for path in entries {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if path.is_dir() && !matches!(&*name, "include" | "fragments") {
            scenes(&path, found);
        } else if name.ends_with(".xml") {
            found.push(path);
        }
    }
}

#[test]
#[ignore = "needs LOOKFROM_SHARED"]
fn every_shared_scene_is_read_or_names_what_is_missing() {
    let root = lookfrom_test_data::shared("mitsuba/tests/scenes");
    let mut paths = Vec::new();
    scenes(&root, &mut paths);
    assert_eq!(paths.len(), 28, "{paths:?}");
    let mut missing = Vec::new();
    for path in &paths {
        let mut context = LoadContext::new(&Disk);
        let name = path.strip_prefix(&root).unwrap_or(path).display();
        match load::scene(path, &mut context) {
            Ok(scene) => {
                println!("{name}: {} shapes, {} lights", scene.shapes.len(), scene.lights.len());
                context.warnings.iter().for_each(|warning| println!("  {warning}"));
                assert!(scene.camera.is_some());
                let mut shapes =
                    scene.shapes.iter().chain(scene.objects.iter().flat_map(|object| &object.shapes));
                assert!(shapes.all(|shape| shape.bounds(&scene.meshes).min.is_finite()));
            }
            Err(error) => {
                println!("{name}: {error}");
                assert_eq!(error.kind, ErrorKind::Unsupported, "{error}");
                assert!(error.at.line > 0 && error.at.column > 0, "{error}");
                missing.push(error.message);
            }
        }
    }
    missing.sort_unstable();
    missing.iter().for_each(|message| println!("{message}"));
    assert!(missing.len() <= 2, "{}", missing.len());
}
