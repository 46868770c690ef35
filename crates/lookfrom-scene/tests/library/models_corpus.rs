//! Real and broken files of other programs: all good ones are read, every bad one gives an error. The tables have each file.
//!
//! The files belong to others and are test data outside the repository (`LOOKFROM_SHARED`).

use std::ffi::OsStr;
use std::path::Path;

use lookfrom_scene::shape::Geometry;
use lookfrom_scene::{Disk, LoadContext, Scene, model};

/// What each good file holds: triangles that have an area, points, parts.
const GOOD: &[(&str, usize, usize, usize)] = &[
    ("OBJ/WusonOBJ.obj", 3732, 0, 1),
    ("OBJ/box.obj", 12, 0, 1),
    ("OBJ/box_UTF16BE.obj", 12, 0, 1),
    ("OBJ/box_longline.obj", 478, 0, 1),
    ("OBJ/box_mat_with_spaces.obj", 12, 0, 1),
    ("OBJ/box_without_lineending.obj", 12, 0, 1),
    ("OBJ/concave_polygon.obj", 64, 0, 1),
    ("OBJ/cube_mtllib_after_g.obj", 12, 0, 1),
    ("OBJ/cube_usemtl.obj", 12, 0, 3),
    ("OBJ/cube_with_vertexcolors.obj", 12, 0, 1),
    ("OBJ/cube_with_vertexcolors_uni.obj", 12, 0, 1),
    ("OBJ/empty_mat.obj", 256, 0, 1),
    ("OBJ/mtl_different_folder.obj", 12, 0, 1),
    ("OBJ/multiple_spaces.obj", 1, 0, 1),
    // Its only triangle has no area.
    ("OBJ/number_formats.obj", 0, 0, 0),
    ("OBJ/only_a_part_of_vertexcolors.obj", 3, 0, 1),
    ("OBJ/point_cloud.obj", 0, 3, 1),
    ("OBJ/regr01.obj", 2706, 0, 12),
    ("OBJ/regr_3429812.obj", 4, 0, 1),
    ("OBJ/space_in_material_name.obj", 64, 0, 1),
    ("OBJ/spider.obj", 1312, 0, 4),
    ("OBJ/testline.obj", 0, 0, 1),
    ("OBJ/testmixed.obj", 12, 0, 2),
    ("OBJ/testpoints.obj", 0, 8, 1),
    ("PLY/Wuson.ply", 3732, 0, 1),
    ("PLY/cube.ply", 12, 0, 1),
    ("PLY/cube_binary.ply", 12, 0, 1),
    ("PLY/cube_binary_header_with_RN_newline.ply", 12, 0, 1),
    ("PLY/cube_binary_starts_with_nl.ply", 12, 0, 1),
    ("PLY/cube_uv.ply", 12, 0, 1),
    ("PLY/float-color.ply", 1, 0, 1),
    ("PLY/points.ply", 0, 4, 4),
    ("PLY/pond.0.ply", 0, 70051, 512),
    ("STL/3DSMaxExport.STL", 2000, 0, 1),
    ("STL/Spider_ascii.stl", 1312, 0, 1),
    ("STL/Spider_binary.stl", 1312, 0, 1),
    ("STL/Wuson.stl", 3732, 0, 1),
    ("STL/formatDetection", 1, 0, 1),
    ("STL/sphereWithHole.stl", 285, 0, 1),
    ("STL/triangle.stl", 1, 0, 1),
    ("STL/triangle_with_empty_solid.stl", 1, 0, 1),
    ("STL/triangle_with_two_solids.stl", 2, 0, 2),
];

/// What is said of each bad one.
const BAD: &[(&str, &str)] = &[
    ("PLY/issue623.ply", "a list of 7 values, but only 1288 bytes are left"),
    ("PLY/payload_JVN42386607", "element `vertex` is declared twice"),
];

#[test]
#[ignore = "needs LOOKFROM_SHARED"]
fn the_corpus_is_read() {
    let corpus = lookfrom_test_data::shared("corpus/assimp");
    let mut found = 0;
    for folder in ["OBJ", "PLY", "STL"] {
        for entry in std::fs::read_dir(corpus.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let ending = path.extension().map(OsStr::to_ascii_lowercase);
            if path.is_dir() || ending.is_some_and(|ending| ending == "mtl" || ending == "jpg") {
                continue;
            }
            let name = path.strip_prefix(&corpus).unwrap().to_str().unwrap();
            let good = GOOD.iter().find(|(good, ..)| *good == name);
            let bad = BAD.iter().find(|(bad, _)| *bad == name);
            match (counts(&path), good, bad) {
                (Ok(counts), Some(&(_, triangles, points, parts)), None) => {
                    assert_eq!(counts, (triangles, points, parts), "{name}");
                }
                (Err(error), None, Some((_, says))) => assert!(error.contains(says), "{error}"),
                (counts, ..) => panic!("{name}: {counts:?}"),
            }
            found += 1;
        }
    }
    assert_eq!(found, GOOD.len() + BAD.len());
}

fn counts(path: &Path) -> Result<(usize, usize, usize), String> {
    let mut context = LoadContext::new(&Disk);
    let mut scene = Scene::default();
    let parts = model::read(path, &mut context, &mut scene);
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
