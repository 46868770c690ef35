//! The scenes that the founders share are read whole, and as pbrt reads them.

use std::path::{Path, PathBuf};

use lookfrom_scene::settings::{Integrator, Sampler};
use lookfrom_scene::shape::Geometry;
use lookfrom_scene::{Disk, LoadContext, Scene, load};

/// All files below a folder that end in `.pbrt` and begin a world.
fn scenes(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            scenes(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "pbrt")
            && std::fs::read_to_string(&path).expect("a text").contains("WorldBegin")
        {
            found.push(path);
        }
    }
}

fn read(path: &Path) -> (Scene, Vec<String>) {
    let mut context = LoadContext::new(&Disk);
    let scene = load::scene(path, &mut context).unwrap_or_else(|error| panic!("{error}"));
    (scene, context.warnings.iter().map(ToString::to_string).collect())
}

#[test]
#[ignore = "needs LOOKFROM_SHARED"]
fn every_shared_scene_is_read() {
    let root = lookfrom_test_data::shared("scenes");
    let mut paths = Vec::new();
    scenes(&root, &mut paths);
    assert!(paths.len() >= 7, "{paths:?}");
    for path in paths {
        let start = std::time::Instant::now();
        let (scene, warnings) = read(&path);
        let triangles: usize = scene.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
        println!(
            "{}: {} shapes, {triangles} triangles, {} materials, {} lights, {} ms",
            path.display(),
            scene.shapes.len(),
            scene.materials.len(),
            scene.lights.len(),
            start.elapsed().as_millis()
        );
        warnings.iter().for_each(|warning| println!("  {warning}"));
        assert!(scene.camera.is_some() && !scene.shapes.is_empty());
        assert!(!scene.lights.is_empty() || scene.shapes.iter().any(|shape| shape.emission.is_some()));
        for shape in &scene.shapes {
            assert!(shape.bounds(&scene.meshes).min.is_finite(), "{:?}", shape.at);
            if let Geometry::Mesh(id) = shape.geometry {
                assert!(!scene.meshes[id.index()].triangles.is_empty(), "{:?}", shape.at);
            }
        }
    }
}

#[test]
#[ignore = "needs LOOKFROM_SHARED"]
fn the_coffee_maker_is_as_it_was_written() {
    let root = lookfrom_test_data::shared("scenes");
    let (scene, warnings) = read(&root.join("coffee/scene.pbrt"));
    assert_eq!((scene.image.width, scene.image.height), (200, 250));
    assert_eq!(scene.render.integrator, Integrator::Path);
    assert_eq!((scene.render.depth, scene.render.samples, scene.render.sampler), (17, 64, Sampler::Sobol));
    assert_eq!(scene.shapes.len(), 20 + 3);
    assert_eq!(scene.shapes.iter().filter(|shape| shape.emission.is_some()).count(), 3);
    assert!(warnings.iter().all(|warning| warning.contains("without area")), "{warnings:?}");
}
