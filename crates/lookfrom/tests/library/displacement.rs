//! Displaced PLY meshes of pbrt's scenes.

use std::path::{Path, PathBuf};

use glam::{DVec3, Vec3};
use lookfrom::world::World;
use lookfrom_bvh::Ray;
use lookfrom_scene::scene::Scene;
use lookfrom_scene::shape::Geometry;
use lookfrom_scene::{LoadContext, Memory, Result, load};

/// A square of side 2 around the origin, with texture coordinates, as two triangles.
const SQUARE: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
    property float u\nproperty float v\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n\
    -1 -1 0 0 0\n1 -1 0 1 0\n1 1 0 1 1\n-1 1 0 0 1\n3 0 1 2\n3 0 2 3\n";

fn read(options: &str, shape: &str, ply: &str) -> Result<(Scene, Vec<String>)> {
    let text = format!(
        "{options} Camera \"perspective\" WorldBegin Translate 5 0 0 Scale 3 3 2\n\
         Texture \"tilted\" \"float\" \"bilerp\" \"float v00\" 0 \"float v10\" 0.25 \"float v01\" 0.5 \"float v11\" 0.75\n\
         Texture \"saddle\" \"float\" \"bilerp\" \"float v00\" 0 \"float v10\" 1 \"float v01\" 1 \"float v11\" 0\n\
         Shape \"plymesh\" \"string filename\" \"square.ply\" {shape}"
    );
    let files = [("a.pbrt", text.as_str()), ("square.ply", ply)];
    let files = Memory(files.map(|(name, text)| (PathBuf::from(name), text.as_bytes().to_vec())).into());
    let mut context = LoadContext::new(&files);
    let scene = load::scene(Path::new("a.pbrt"), &mut context)?;
    Ok((scene, context.warnings.iter().map(ToString::to_string).collect()))
}

fn scene(options: &str, shape: &str) -> Scene {
    let (scene, warnings) = read(options, shape, SQUARE).expect("a good scene");
    assert!(warnings.is_empty(), "{warnings:?}");
    scene
}

/// The height and the normal of the surface below a point of the plane z = 9.
fn below(world: &World, x: f64, y: f64) -> (f64, DVec3) {
    let from = DVec3::new(x, y, 9.0) - world.origin();
    let ray = Ray::new(from.as_vec3().to_array(), Vec3::NEG_Z.to_array());
    let hit = world.bvh().closest_hit(&ray);
    assert!(hit.is_hit(), "nothing below {x} {y}");
    let surface = world.surface(&ray, &hit);
    ((DVec3::from_array(surface.point.position) + world.origin()).z, surface.ns.as_dvec3())
}

#[test]
fn a_mesh_is_moved_by_its_texture_before_its_transform() {
    let displaced = "\"texture displacement\" \"tilted\" \"float displacement.edgelength\" 0.5";
    let world = World::compile(scene("", displaced), &mut Vec::new()).expect("a world");
    for (x, y) in [(5.0, 0.01), (2.5, 2.2), (7.3, -1.9)] {
        let (u, v) = ((x - 2.0) / 6.0, (y + 3.0) / 6.0);
        let (z, n) = below(&world, x, y);
        assert!((z - 2.0 * (0.25 * u + 0.5 * v)).abs() < 1e-5, "{x} {y}: {z}");
        // Slopes of 0.5 / 6 and 1 / 6.
        let expected = DVec3::new(-0.5 / 6.0, -1.0 / 6.0, 1.0).normalize();
        assert!((n - expected).length() < 1e-5, "{n}, not {expected}");
    }
}

#[test]
fn shorter_edges_follow_the_texture_more_closely() {
    let mut before = f64::INFINITY;
    for length in [4.0, 1.0, 0.25] {
        let displaced =
            format!("\"texture displacement\" \"saddle\" \"float displacement.edgelength\" {length}");
        let world = World::compile(scene("", &displaced), &mut Vec::new()).expect("a world");
        let worst = (0..400).map(|i| {
            let (u, v) = ((f64::from(i % 20) + 0.37) / 20.0, (f64::from(i / 20) + 0.61) / 20.0);
            let (z, _) = below(&world, 2.0 + 6.0 * u, 6.0 * v - 3.0);
            (z - 2.0 * (u + v - 2.0 * u * v)).abs()
        });
        let worst = worst.fold(0.0, f64::max);
        assert!(worst < before / 4.0, "{length}: {worst} after {before}");
        before = worst;
    }
    assert!(before < 0.01, "{before}");
}

#[test]
fn edges_are_measured_in_the_world() {
    // Sides of 6 and a diagonal of 8.5.
    let triangles = |options: &str, length: f32| {
        let displaced = format!("\"float displacement\" 0.1 \"float displacement.edgelength\" {length}");
        let scene = scene(options, &displaced);
        let Geometry::Mesh(mesh) = scene.shapes[0].geometry else { panic!("no mesh") };
        scene.meshes[mesh.index()].triangles.len()
    };
    assert_eq!([9.0, 8.0, 6.0].map(|length| triangles("", length)), [2, 4, 8]);
    assert_eq!(triangles("Option \"float displacementedgescale\" 2", 4.5), 2);
}

#[test]
fn meshes_that_cannot_be_displaced_are_refused() {
    let without_uvs: String = SQUARE
        .replace("property float u\nproperty float v\n", "")
        .replace(" 0 0 0\n", " 0\n")
        .replace(" 0 1 0\n", " 0\n")
        .replace(" 0 1 1\n", " 0\n")
        .replace(" 0 0 1\n", " 0\n");
    let error = read("", "\"texture displacement\" \"tilted\"", &without_uvs).expect_err("no uv").to_string();
    assert!(error.contains("no texture coordinates") && error.contains("a.pbrt:4"), "{error}");
    let tiny = "\"texture displacement\" \"tilted\" \"float displacement.edgelength\" 1e-9";
    let error = read("", tiny, SQUARE).expect_err("too many").to_string();
    assert!(error.contains("67108864 triangles") && error.contains("raise"), "{error}");
}
