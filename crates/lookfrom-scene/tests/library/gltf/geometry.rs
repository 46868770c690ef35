//! Primitives, accessors, nodes and instances.

use std::path::{Path, PathBuf};

use glam::{DMat4, DVec3, Vec3};
use lookfrom_scene::material::{Color, MaterialKind};
use lookfrom_scene::settings::Integrator;
use lookfrom_scene::shape::{Geometry, Shape};
use lookfrom_scene::{LoadContext, load};
use serde_json::json;

use super::{Model, mesh, one};

#[test]
fn every_mode_has_its_form() {
    let mut model = Model::default();
    let positions = model.square();
    let indices = model.indices(&[3, 1, 0, 2]);
    let read = |mode: u32| {
        let primitive = json!({"attributes": {"POSITION": positions}, "indices": indices, "mode": mode});
        model.scene(one(primitive, json!({})))
    };
    // Corners by their place in the square: meshes keep only the vertices that they use.
    let triangles = |mode| {
        let scene = read(mode);
        let mesh = mesh(&scene, &scene.shapes[0]);
        let place = |corner: u32| {
            let Vec3 { x, y, .. } = mesh.positions[corner as usize];
            (x + 2.0 * y) as u32
        };
        mesh.triangles.iter().map(|triangle| triangle.map(place)).collect::<Vec<_>>()
    };
    assert_eq!(triangles(4), [[3, 1, 0]]);
    assert_eq!(triangles(5), [[3, 1, 0], [1, 2, 0]]);
    assert_eq!(triangles(6), [[1, 0, 3], [0, 2, 3]]);
    for (mode, count) in [(1, 2), (2, 4), (3, 3)] {
        let scene = read(mode);
        assert!(matches!(&scene.shapes[0].geometry, Geometry::Curves(strands) if strands.len() == count));
        assert!(!scene.shapes[0].single_sided, "lines are seen from everywhere");
    }
    assert!(matches!(&read(0).shapes[0].geometry, Geometry::Spheres(spheres) if spheres.len() == 4));
}

#[test]
fn points_and_lines_have_the_colours_of_their_vertices() {
    let mut model = Model::default();
    let positions = model.square();
    let colors = model.floats("VEC3", &[1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    let half = json!([{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1]}}]);
    let read = |mode: u32| {
        let attributes = json!({"POSITION": positions, "COLOR_0": colors});
        let primitive = json!({"attributes": attributes, "mode": mode, "material": 0});
        let scene = model.scene(one(primitive, json!({"materials": half})));
        let of_shape = |shape: &Shape| {
            let MaterialKind::Principled(look) = &scene.materials[shape.material.index()].kind else {
                panic!()
            };
            let count = match &shape.geometry {
                Geometry::Spheres(spheres) => spheres.len(),
                Geometry::Curves(strands) => strands.len(),
                other => panic!("{other:?}"),
            };
            (look.base_color, count)
        };
        scene.shapes.iter().map(of_shape).collect::<Vec<_>>()
    };
    let (red, blue) = (Color::Value([0.5, 0.0, 0.0]), Color::Value([0.0, 0.0, 0.5]));
    let mut points = read(0);
    points.sort_by_key(|(color, _)| *color == blue);
    assert_eq!(points, [(red, 2), (blue, 2)]);
    // Lines between red and blue.
    assert_eq!(read(1), [(Color::Value([0.25, 0.0, 0.25]), 2)]);
}

#[test]
fn primitives_keep_only_the_vertices_that_they_use() {
    let mut model = Model::default();
    let corners: Vec<f32> = (0..300).flat_map(|i| [i as f32, (i % 2) as f32, 0.0]).collect();
    let positions = model.floats("VEC3", &corners);
    let colors = model.floats("VEC3", &corners);
    let indices = model.indices(&[7, 5, 290]);
    let scene = model.scene(one(
        json!({"attributes": {"POSITION": positions, "COLOR_0": colors}, "indices": indices}),
        json!({}),
    ));
    let mesh = mesh(&scene, &scene.shapes[0]);
    let [a, b, c] = [[5.0, 1.0, 0.0], [7.0, 1.0, 0.0], [290.0, 0.0, 0.0]];
    assert_eq!(mesh.positions, [a, b, c].map(Vec3::from));
    assert_eq!(mesh.colors, [a, b, c]);
    assert_eq!(mesh.triangles, [[1, 0, 2]]);
}

#[test]
fn accessors_are_read_in_all_their_forms() {
    let mut model = Model::default();
    // Interleaved: positions as floats and colours as normalised bytes, 16 bytes a vertex.
    let mut bytes = Vec::new();
    for (position, color) in
        [([0.0_f32, 0.0, 0.0], [255_u8, 0, 51, 255]), ([1.0, 0.0, 0.0], [0; 4]), ([0.0, 1.0, 0.0], [9; 4])]
    {
        bytes.extend(position.into_iter().flat_map(f32::to_le_bytes));
        bytes.extend(color);
    }
    let view = model.view(&bytes);
    model.views[view]["byteStride"] = json!(16);
    let positions =
        model.accessor(json!({"bufferView": view, "componentType": 5126, "count": 3, "type": "VEC3"}));
    let colors = model.accessor(
        json!({"bufferView": view, "byteOffset": 12, "componentType": 5121, "normalized": true, "count": 3, "type": "VEC4"}),
    );
    // Normals that are zeros but for one.
    let (places, values) = (model.view(&[1]), model.view(&[0, 129, 0, 0]));
    let normals = model.accessor(json!({
        "componentType": 5120, "normalized": true, "count": 3, "type": "VEC3",
        "sparse": {
            "count": 1,
            "indices": {"bufferView": places, "componentType": 5121},
            "values": {"bufferView": values},
        },
    }));
    let primitive = json!({"attributes": {"POSITION": positions, "NORMAL": normals, "COLOR_0": colors}});
    let scene = model.scene(one(primitive, json!({})));
    let mesh = mesh(&scene, &scene.shapes[0]);
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!(mesh.colors[0], [1.0, 0.0, 0.2]);
    assert_eq!(mesh.opacities, [1.0, 0.0, 9.0 / 255.0]);
    assert_eq!(mesh.normals, [Vec3::ZERO, Vec3::NEG_Y, Vec3::ZERO]);
}

#[test]
fn nodes_stand_where_their_ancestors_put_them() {
    let mut model = Model::default();
    let positions = model.square();
    let root = json!({
        "scenes": [{"nodes": [2]}],
        "nodes": [
            {"mesh": 0, "translation": [1, 0, 0]},
            {"mesh": 0, "matrix": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1]},
            {"children": [0, 1], "scale": [-2, 2, 2], "rotation": [0, 0, 0.5f64.sqrt(), 0.5f64.sqrt()]},
            {"mesh": 0},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": positions}, "mode": 5}]}],
    });
    let scene = model.scene(root);
    assert_eq!(
        (scene.shapes.len(), scene.meshes.len()),
        (2, 1),
        "one mesh, twice, and not what is in no scene"
    );
    let place = |shape: usize, point: DVec3| scene.shapes[shape].world_from_object.transform_point3(point);
    // (2, 0, 0) is mirrored to (−4, 0, 0), then turned to (0, −4, 0).
    assert!((place(0, DVec3::X) - DVec3::new(0.0, -4.0, 0.0)).length() < 1e-12);
    // (1, 0, 0) goes to (0, 1, 5), (0, 2, 10), (−2, 0, 10).
    assert!((place(1, DVec3::X) - DVec3::new(-2.0, 0.0, 10.0)).length() < 1e-12);
}

#[test]
fn what_is_scaled_flat_is_still_seen() {
    let mut model = Model::default();
    let positions = model.square();
    let root = json!({
        "nodes": [{"mesh": 0, "scale": [2, 3, 0]}, {"mesh": 0, "scale": [0, 0, 0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": positions}, "mode": 5}]}],
    });
    let scene = model.scene(root);
    assert_eq!(scene.shapes.len(), 1);
    assert_eq!(scene.shapes[0].world_from_object, DMat4::IDENTITY);
    assert_eq!(mesh(&scene, &scene.shapes[0]).positions[3], Vec3::new(2.0, 3.0, 0.0));
}

#[test]
fn instances_are_instances() {
    let mut model = Model::default();
    let positions = model.square();
    let translations = model.floats("VEC3", &[0.0, 0.0, 0.0, 0.0, 0.0, 5.0]);
    let root = one(
        json!({"attributes": {"POSITION": positions}, "mode": 5}),
        json!({"nodes": [{
            "mesh": 0, "scale": [2, 2, 2],
            "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": translations}}},
        }]}),
    );
    let scene = model.scene(root.clone());
    assert_eq!((scene.shapes.len(), scene.objects.len(), scene.instances.len()), (0, 1, 2));
    assert_eq!(scene.instances[1].world_from_object.transform_point3(DVec3::X), DVec3::new(2.0, 0.0, 10.0));

    // In a scene of ours they are shapes, which stand where the scene puts the model.
    let mut memory = model.memory(root);
    let toml = "[[mesh]]\nfile = \"m/a.gltf\"\ntranslate = [1, 0, 0]\n";
    memory.0.insert(PathBuf::from("a.toml"), toml.as_bytes().to_vec());
    let scene = load::scene(Path::new("a.toml"), &mut LoadContext::new(&memory)).expect("it is valid");
    assert_eq!((scene.shapes.len(), scene.instances.len()), (2, 0));
    assert_eq!(scene.shapes[1].world_from_object.transform_point3(DVec3::X), DVec3::new(3.0, 0.0, 10.0));
    assert_eq!(scene.render.integrator, Integrator::Path);
}

#[test]
fn instances_keep_the_names_of_their_nodes_in_scenes_of_ours() {
    let mut model = Model::default();
    let positions = model.square();
    // So many that nodes with the same mesh are instances.
    let indices = model.indices(&[0, 1, 2].repeat((1 << 18) + 1));
    let nodes = json!([{"name": "left", "mesh": 0}, {"name": "right", "mesh": 0, "translation": [2, 0, 0]}]);
    let root = one(
        json!({"attributes": {"POSITION": positions}, "indices": indices}),
        json!({"scenes": [{"nodes": [0, 1]}], "nodes": nodes}),
    );
    let mut memory = model.memory(root);
    memory.0.insert(PathBuf::from("a.toml"), b"import = \"m/a.gltf\"\n".to_vec());
    let scene = load::scene(Path::new("a.toml"), &mut LoadContext::new(&memory)).expect("it is valid");
    let names: Vec<_> = scene.shapes.iter().map(|shape| shape.name.as_deref()).collect();
    assert_eq!(names, [Some("left"), Some("right")]);
    let scene = load::scene(Path::new("m/a.gltf"), &mut LoadContext::new(&memory)).expect("it is valid");
    assert_eq!(scene.instances.len(), 2);
}

#[test]
fn many_triangles_are_read_at_once() {
    let side = 224_u16;
    let mut model = Model::default();
    let grid = || (0..side).flat_map(|row| (0..side).map(move |column| [f32::from(row), f32::from(column)]));
    let positions: Vec<f32> = grid().flat_map(|[x, z]| [x, (x * z).sin(), z]).collect();
    let normals: Vec<f32> = grid().flat_map(|_| [0.0, 1.0, 0.0]).collect();
    let uvs: Vec<f32> = grid().flatten().collect();
    let squares = (0..side - 1).flat_map(|row| (0..side - 1).map(move |column| row * side + column));
    let indices: Vec<u16> =
        squares.flat_map(|a| [a, a + 1, a + side, a + 1, a + side + 1, a + side]).collect();
    let (positions, normals) = (model.floats("VEC3", &positions), model.floats("VEC3", &normals));
    let (uvs, indices) = (model.floats("VEC2", &uvs), model.indices(&indices));
    let attributes = json!({"POSITION": positions, "NORMAL": normals, "TEXCOORD_0": uvs});
    let root = one(json!({"attributes": attributes, "indices": indices}), json!({}));
    let memory = model.memory(root);
    let start = std::time::Instant::now();
    let scene = load::scene(Path::new("m/a.gltf"), &mut LoadContext::new(&memory)).expect("it is valid");
    let elapsed = start.elapsed();
    assert_eq!(mesh(&scene, &scene.shapes[0]).triangles.len(), 99_458);
    println!("99458 triangles in {:.1} ms", elapsed.as_secs_f64() * 1e3);
    assert!(elapsed.as_secs_f64() < 1.0, "{elapsed:?}");
}
