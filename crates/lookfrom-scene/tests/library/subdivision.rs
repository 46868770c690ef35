//! Subdivision surfaces of files: polygons, materials, texture coordinates, limits.

use std::path::{Path, PathBuf};

use glam::Vec3;
use lookfrom_scene::scene::Scene;
use lookfrom_scene::shape::Mesh;
use lookfrom_scene::{ImportOptions, LoadContext, Memory, load};

/// A house: a box with a roof, whose gables are pentagons, with a material for the roof.
const HOUSE: &str = "
v -1 0 -1\nv 1 0 -1\nv 1 1 -1\nv 0 2 -1\nv -1 1 -1
v -1 0 1\nv 1 0 1\nv 1 1 1\nv 0 2 1\nv -1 1 1
vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1
usemtl wall
f 5 4 3 2 1
f 6 7 8 9 10
f 1/1 2/2 7/3 6/4
f 2 3 8 7
f 5 1 6 10
usemtl roof
f 3/1 4/2 9/3 8/4
f 4 5 10 9
";

fn read(name: &str, text: &str, levels: u32) -> Result<(Scene, Vec<String>), String> {
    let files = Memory([(PathBuf::from(name), text.as_bytes().to_vec())].into());
    let mut context = LoadContext::new(&files);
    context.import = ImportOptions { subdivision: levels, ..ImportOptions::default() };
    let scene = load::scene(Path::new(name), &mut context).map_err(|error| error.to_string())?;
    Ok((scene, context.warnings.iter().map(ToString::to_string).collect()))
}

fn edges(meshes: &[Mesh]) -> std::collections::BTreeMap<[[u32; 3]; 2], i32> {
    let mut edges = std::collections::BTreeMap::new();
    for mesh in meshes {
        for triangle in &mesh.triangles {
            let at = |k: usize| (mesh.positions[triangle[k % 3] as usize] + 0.0).to_array().map(f32::to_bits);
            for k in 0..3 {
                let (a, b) = (at(k), at(k + 1));
                *edges.entry(if a < b { [a, b] } else { [b, a] }).or_insert(0) += if a < b { 1 } else { -1 };
            }
        }
    }
    edges
}

#[test]
fn polygons_of_all_materials_are_one_surface() {
    let (scene, warnings) = read("house.obj", HOUSE, 2).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(scene.meshes.len(), 2);
    // A pentagon becomes five quadrilaterals: (2 · 5 + 5 · 4) · 4 in the second level, and two triangles of each.
    assert_eq!(scene.meshes.iter().map(|mesh| mesh.triangles.len()).sum::<usize>(), 240);
    // Closed, and of one orientation: each edge once in each direction, between the materials too.
    assert!(edges(&scene.meshes).values().all(|&sum| sum == 0));
    for mesh in &scene.meshes {
        assert_eq!((mesh.normals.len(), mesh.uvs.len()), (mesh.positions.len(), mesh.positions.len()));
        let center = Vec3::new(0.0, 0.9, 0.0);
        for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
            assert!(normal.dot(*position - center) > 0.0 && (normal.length() - 1.0).abs() < 1e-5);
        }
        assert!(mesh.uvs.iter().any(|uv| uv.x == 0.5) && mesh.uvs.iter().all(|uv| uv.max_element() <= 1.0));
    }
    // Without subdivision the file is as it is.
    let (plain, _) = read("house.obj", HOUSE, 0).unwrap();
    assert_eq!(plain.meshes.iter().map(|mesh| mesh.triangles.len()).sum::<usize>(), 16);
}

#[test]
fn other_formats_are_subdivided_too() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        element face 4\nproperty list uchar int vertex_indices\nend_header\n\
        1 1 1\n-1 -1 1\n-1 1 -1\n1 -1 -1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
    let (scene, _) = read("tetrahedron.ply", ply, 3).unwrap();
    // Its triangles meet at sharper angles than those of quadrilaterals: each becomes three.
    assert_eq!(scene.meshes[0].triangles.len(), 4 * 3 * 16 * 2);
    assert!(edges(&scene.meshes).values().all(|&sum| sum == 0));
    let toml = "[[mesh]]\npositions = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]\n\
        triangles = [[0, 1, 2], [0, 2, 3]]\nsubdivision = 2\n[camera]\nlookfrom = [0, 0, 3]\nlookat = [0, 0, 0]\n";
    let (scene, _) = read("square.toml", toml, 0).unwrap();
    // One quadrilateral, whose corners stay.
    assert_eq!(scene.meshes[0].triangles.len(), 32);
    assert!(scene.meshes[0].positions.contains(&Vec3::new(1.0, 1.0, 0.0)));
}

#[test]
fn what_cannot_be_smooth_is_told() {
    let book = "v 0 0 0\nv 0 0 1\nv 1 0 0\nv -1 1 0\nv -1 -1 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n";
    let (scene, warnings) = read("book.obj", book, 2).unwrap();
    assert!(warnings.iter().any(|warning| warning.contains("more than two faces")), "{warnings:?}");
    assert!(scene.meshes[0].positions.iter().all(|position| position.is_finite()));
    // The same vertex twice in a face, a face of two points, and one that is not finite.
    let broken = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 nan 0\nf 1 1 2 3\nf 1 2 2 1\nf 1 2 4\n";
    let (scene, warnings) = read("broken.obj", broken, 1).unwrap();
    assert_eq!(scene.meshes[0].triangles.len(), 6);
    assert!(warnings.iter().any(|warning| warning.contains("infinite or not a number")), "{warnings:?}");
    // Too many faces are an error before any memory is taken.
    let faces: String = (0..5000).map(|_| "f 1 2 3\n").collect();
    let many = format!("v 0 0 0\nv 1 0 0\nv 1 1 0\n{faces}");
    let error = read("many.obj", &many, 8).unwrap_err();
    assert!(error.contains("more than the limit of") && error.contains("subdivide fewer times"), "{error}");
}
