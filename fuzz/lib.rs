//! What do hostile files do to the readers?
//!
//! Each target hands the fuzzer's bytes to one reader as a file in memory, and checks what the reader promises: no
//! panic, no hang, and meshes whose indices and numbers can be relied on.
//!
//! ```sh
//! cargo install cargo-fuzz
//! RUSTC_BOOTSTRAP=1 CARGO_PROFILE_RELEASE_STRIP=none cargo fuzz run --features libfuzzer obj -- -max_total_time=60
//! ```

use std::path::{Path, PathBuf};

use lookfrom_scene::files::{Limits, Memory};
use lookfrom_scene::shape::{Geometry, Mesh, Part};
use lookfrom_scene::{LoadContext, Result, Scene};

/// A reader of the content of models.
pub type Reader = fn(&[u8], &Path, &mut LoadContext<'_>, &mut Scene) -> Result<Vec<Part>>;

/// Limits that keep a single run short.
pub fn limits() -> Limits {
    Limits { file_bytes: 1 << 20, elements: 1 << 20, texels: 1 << 16, ..Limits::default() }
}

/// Reads the first of these files, which may name the others.
pub fn read_model(files: &[(&str, &[u8])], reader: Reader) {
    let contents = files.iter().map(|(name, content)| (PathBuf::from(name), content.to_vec())).collect();
    let memory = Memory(contents);
    let mut context = LoadContext::new(&memory);
    context.limits = limits();
    let mut scene = Scene::default();
    if let Ok(parts) = reader(files[0].1, Path::new(files[0].0), &mut context, &mut scene) {
        parts.iter().for_each(|part| check(part, &scene));
    }
}

fn check(part: &Part, scene: &Scene) {
    assert!(part.material.is_none_or(|material| material.index() < scene.materials.len()));
    match &part.geometry {
        Geometry::Mesh(mesh) => check_mesh(&scene.meshes[mesh.index()]),
        Geometry::Spheres(spheres) => {
            for sphere in &**spheres {
                assert!(sphere.center.is_finite() && sphere.radius > 0.0 && sphere.radius.is_finite());
            }
        }
        Geometry::Curves(strands) => {
            for strand in &**strands {
                assert!(strand.points.iter().all(|point| point.is_finite()));
                assert!(strand.width.iter().all(|width| *width > 0.0 && width.is_finite()));
            }
        }
        other => panic!("a model file has no {other:?}"),
    }
}

/// What every mesh promises.
pub fn check_mesh(mesh: &Mesh) {
    let count = mesh.positions.len();
    assert!(mesh.positions.iter().all(|position| position.is_finite()));
    assert!(mesh.triangles.iter().flatten().all(|&vertex| (vertex as usize) < count));
    assert!(mesh.normals.is_empty() || mesh.normals.len() == count);
    assert!(mesh.uvs.is_empty() || mesh.uvs.len() == count);
    assert!(mesh.colors.is_empty() || mesh.colors.len() == count);
    assert!(mesh.normals.iter().all(|normal| normal.is_finite()));
    assert!(mesh.uvs.iter().all(|uv| uv.is_finite()));
}
