//! Real and broken files of other programs: all good ones are read, every bad one gives an error, none a panic.
//!
//! The files belong to others and are test data outside the repository (`LOOKFROM_SHARED`).

use std::ffi::OsStr;
use std::path::Path;

use lookfrom_scene::shape::Geometry;
use lookfrom_scene::{Disk, LoadContext, Scene, model};

/// What each file holds: triangles, points, parts.
const EXPECTED: &[(&str, usize, usize, usize)] = &[
    ("OBJ/box.obj", 12, 0, 1),
    ("OBJ/box_UTF16BE.obj", 12, 0, 1),
    ("OBJ/box_mat_with_spaces.obj", 12, 0, 1),
    ("OBJ/box_without_lineending.obj", 12, 0, 1),
    ("OBJ/cube_mtllib_after_g.obj", 12, 0, 1),
    ("OBJ/cube_usemtl.obj", 12, 0, 3),
    ("OBJ/cube_with_vertexcolors.obj", 12, 0, 1),
    ("OBJ/mtl_different_folder.obj", 12, 0, 1),
    ("OBJ/multiple_spaces.obj", 1, 0, 1),
    ("OBJ/only_a_part_of_vertexcolors.obj", 3, 0, 1),
    ("OBJ/point_cloud.obj", 0, 3, 1),
    ("OBJ/spider.obj", 1312, 0, 4),
    ("OBJ/testmixed.obj", 12, 0, 2),
    ("OBJ/testpoints.obj", 0, 8, 1),
    ("PLY/cube.ply", 12, 0, 1),
    ("PLY/cube_binary.ply", 12, 0, 1),
    ("PLY/cube_binary_header_with_RN_newline.ply", 12, 0, 1),
    ("PLY/cube_binary_starts_with_nl.ply", 12, 0, 1),
    ("PLY/cube_uv.ply", 12, 0, 1),
    ("PLY/float-color.ply", 1, 0, 1),
    ("PLY/points.ply", 0, 4, 4),
    ("PLY/Wuson.ply", 3732, 0, 1),
    ("STL/Spider_ascii.stl", 1312, 0, 1),
    ("STL/Spider_binary.stl", 1312, 0, 1),
    ("STL/Wuson.stl", 3732, 0, 1),
    ("STL/formatDetection", 1, 0, 1),
    ("STL/triangle.stl", 1, 0, 1),
    ("STL/triangle_with_empty_solid.stl", 1, 0, 1),
    ("STL/triangle_with_two_solids.stl", 2, 0, 2),
];

#[test]
fn the_corpus_is_read() {
    let Some(corpus) = lookfrom_test_data::shared("corpus/assimp") else { return };
    let mut found = Vec::new();
    for folder in ["OBJ", "PLY", "STL"] {
        for entry in std::fs::read_dir(corpus.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let ending = path.extension().map(OsStr::to_ascii_lowercase);
            if path.is_dir() || ending.is_some_and(|ending| ending == "mtl" || ending == "jpg") {
                continue;
            }
            let name = path.strip_prefix(&corpus).unwrap().to_str().unwrap().to_owned();
            let counts = counts(&path);
            println!("{name}: {counts:?}");
            found.push((name, counts));
        }
    }
    for &(name, triangles, points, parts) in EXPECTED {
        let counts = &found.iter().find(|(other, _)| other == name).expect(name).1;
        assert_eq!(*counts, Ok((triangles, points, parts)), "{name}");
    }
}

fn counts(path: &Path) -> Result<(usize, usize, usize), String> {
    let mut context = LoadContext::new(&Disk);
    let mut scene = Scene::default();
    let parts = model::read(path, &mut context, &mut scene);
    for warning in &context.warnings {
        println!("    {warning}");
    }
    let parts = parts.map_err(|error| error.to_string())?;
    let (mut triangles, mut points) = (0, 0);
    for part in &parts {
        match &part.geometry {
            Geometry::Mesh(mesh) => triangles += scene.meshes[mesh.index()].triangles.len(),
            Geometry::Spheres(spheres) => points += spheres.len(),
            Geometry::Curves(_) => {}
            other => panic!("unexpected {other:?}"),
        }
    }
    Ok((triangles, points, parts.len()))
}
