//! glTF files made here: what they say comes to what is meant.

// JSON is written where it is passed.
#![allow(clippy::needless_pass_by_value)]

use std::path::{Path, PathBuf};

use glam::{DMat4, DVec3, Vec2, Vec3};
use lookfrom_scene::camera::{Projection, View};
use lookfrom_scene::files::{CameraChoice, ImportOptions};
use lookfrom_scene::image::encode_png;
use lookfrom_scene::light::LightKind;
use lookfrom_scene::material::{BumpMapping, Color, MaterialKind, Principled, Scalar};
use lookfrom_scene::medium::Extinction;
use lookfrom_scene::scene::{MediumId, TextureId};
use lookfrom_scene::settings::{Integrator, Tonemap};
use lookfrom_scene::shape::{Geometry, Mesh, Shape};
use lookfrom_scene::texture::{Channel, Mapping, TexelFilter, TextureKind, Wrap};
use lookfrom_scene::{Error, LoadContext, Memory, Result, Scene, load};
use serde_json::{Value, json};

/// A file on its way: the buffer grows as accessors are added.
#[derive(Default)]
struct Model {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Model {
    fn view(&mut self, bytes: &[u8]) -> usize {
        self.views.push(json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()}));
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn floats(&mut self, kind: &str, numbers: &[f32]) -> usize {
        let view = self.view(&numbers.iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<u8>>());
        let size = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            _ => 4,
        };
        let count = numbers.len() / size;
        self.accessor(json!({"bufferView": view, "componentType": 5126, "count": count, "type": kind}))
    }

    fn indices(&mut self, indices: &[u16]) -> usize {
        let view = self.view(&indices.iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<u8>>());
        self.accessor(
            json!({"bufferView": view, "componentType": 5123, "count": indices.len(), "type": "SCALAR"}),
        )
    }

    /// The positions of a square of size 1 around the z axis, in the order of a strip.
    fn square(&mut self) -> usize {
        self.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0])
    }

    /// The JSON with what is in `rest` besides the buffer.
    fn json(&self, rest: Value) -> Value {
        let mut root = json!({
            "asset": {"version": "2.0"},
            "buffers": [{"uri": "a%20b.bin", "byteLength": self.bytes.len()}],
            "bufferViews": self.views,
            "accessors": self.accessors,
        });
        if let (Value::Object(root), Value::Object(rest)) = (&mut root, rest) {
            root.extend(rest);
        }
        root
    }

    fn memory(&self, rest: Value) -> Memory {
        let json = self.json(rest).to_string().into_bytes();
        Memory([(PathBuf::from("m/a.gltf"), json), (PathBuf::from("m/a b.bin"), self.bytes.clone())].into())
    }

    fn read(&self, rest: Value) -> Result<(Scene, Vec<String>)> {
        self.chosen(rest, ImportOptions::default())
    }

    fn chosen(&self, rest: Value, choice: ImportOptions) -> Result<(Scene, Vec<String>)> {
        let memory = self.memory(rest);
        let mut context = LoadContext::new(&memory);
        context.import = choice;
        let scene = load::scene(Path::new("m/a.gltf"), &mut context)?;
        Ok((scene, context.warnings.iter().map(ToString::to_string).collect()))
    }

    /// Reads what must read without a warning.
    fn scene(&self, rest: Value) -> Scene {
        let (scene, warnings) = self.read(rest).expect("it is valid");
        assert_eq!(warnings, Vec::<String>::new());
        scene
    }

    fn error(&self, rest: Value) -> Error {
        self.read(rest).map(|(_, warnings)| warnings).expect_err("it is not valid")
    }
}

/// A scene of one node with one mesh of one primitive.
fn one(primitive: Value, rest: Value) -> Value {
    let mut root =
        json!({"scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], "meshes": [{"primitives": [primitive]}]});
    if let (Value::Object(root), Value::Object(rest)) = (&mut root, rest) {
        root.extend(rest);
    }
    root
}

fn mesh<'a>(scene: &'a Scene, shape: &Shape) -> &'a Mesh {
    match &shape.geometry {
        Geometry::Mesh(id) => &scene.meshes[id.index()],
        other => panic!("no mesh: {other:?}"),
    }
}

fn principled(scene: &Scene) -> &Principled {
    match &scene.materials[scene.shapes[0].material.index()].kind {
        MaterialKind::Principled(look) => look,
        other => panic!("{other:?}"),
    }
}

/// The look of a square with this material.
fn looking(material: Value, rest: Value) -> Scene {
    let mut model = Model::default();
    let positions = model.square();
    let uvs = model.floats("VEC2", &[0.0; 8]);
    let primitive =
        json!({"attributes": {"POSITION": positions, "TEXCOORD_0": uvs}, "mode": 5, "material": 0});
    let mut root = one(primitive, json!({"materials": [material]}));
    if let (Value::Object(root), Value::Object(rest)) = (&mut root, rest) {
        root.extend(rest);
    }
    model.scene(root)
}

/// What a file needs for texture 0: a picture of two texels, black over white.
fn pictures() -> Value {
    let png = encode_png(1, 2, &[0, 0, 0, 255, 255, 255]).expect("it is a picture");
    json!({"textures": [{"source": 0}], "images": [{"uri": format!("data:image/png;base64,{}", base64(&png))}]})
}

fn base64(bytes: &[u8]) -> String {
    let alphabet = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for chunk in bytes.chunks(3) {
        let word = chunk.iter().fold(0, |word, &byte| word << 8 | u32::from(byte)) << (8 * (3 - chunk.len()));
        (0..=chunk.len()).for_each(|i| text.push(alphabet[(word >> (18 - 6 * i)) as usize & 63] as char));
    }
    text
}

#[test]
fn a_triangle_is_a_scene() {
    let mut model = Model::default();
    let positions = model.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    let scene = model.scene(one(json!({"attributes": {"POSITION": positions}}), json!({})));
    assert_eq!(scene.render.integrator, Integrator::Path);
    assert_eq!(scene.image.tonemap, Tonemap::PbrNeutral);
    assert!(scene.camera.is_none() && scene.lights.is_empty());
    assert_eq!(mesh(&scene, &scene.shapes[0]).positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!(mesh(&scene, &scene.shapes[0]).triangles, [[0, 1, 2]]);
    assert!(mesh(&scene, &scene.shapes[0]).normals.is_empty(), "flat");
    assert_eq!(*principled(&scene), Principled::default());
    assert!(scene.shapes[0].single_sided && scene.shapes[0].alpha.is_none());
}

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
fn numbers_out_of_range_are_told_by_their_place() {
    let json = br#"{"asset": {"version": "2.0"}, "nodes": [{"translation": [0, 1e309, 0]}]}"#;
    let memory = Memory([(PathBuf::from("a.gltf"), json.to_vec())].into());
    let said = load::scene(Path::new("a.gltf"), &mut LoadContext::new(&memory)).expect_err("not a number");
    let said = said.to_string();
    assert!(said.starts_with("a.gltf#/nodes/0/translation/1: the number is too large"), "{said}");
}

#[test]
fn arrays_of_a_wrong_length_are_told_by_their_place() {
    let said = |scale: Value| Model::default().error(json!({"nodes": [{"scale": scale}]})).to_string();
    let long = said(json!([1, 1, 1, 1]));
    assert!(long.starts_with("m/a.gltf#/nodes/0/scale: the array has too many values"), "{long}");
    assert!(said(json!([1, 1])).starts_with("m/a.gltf#/nodes/0/scale: "));
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
fn cameras_look_along_minus_z() {
    let mut model = Model::default();
    let positions = model.square();
    let root = |extra: Value| {
        let mut root = one(
            json!({"attributes": {"POSITION": positions}, "mode": 5}),
            json!({
                "nodes": [
                    {"mesh": 0},
                    {"camera": 0, "translation": [0, 0, 7], "scale": [3, 3, 3]},
                    {"camera": 1, "name": "above"},
                ],
                "scenes": [{"nodes": [0, 1, 2]}],
                "cameras": [
                    {"type": "perspective", "perspective": {"yfov": 1.0, "aspectRatio": 2.0, "znear": 0.1}},
                    {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 2, "znear": 0, "zfar": 9}},
                ],
            }),
        );
        if let (Value::Object(root), Value::Object(extra)) = (&mut root, extra) {
            root.extend(extra);
        }
        root
    };
    let scene = model.scene(root(json!({})));
    let camera = scene.camera.expect("there is one");
    assert!(
        matches!(camera.projection, Projection::Perspective { fov } if (fov - 1.0_f64.to_degrees()).abs() < 1e-12)
    );
    let View::Matrix(matrix) = camera.view else { panic!("a matrix") };
    assert_eq!(matrix.transform_point3(DVec3::ZERO), DVec3::new(0.0, 0.0, 7.0));
    assert_eq!(matrix.transform_vector3(DVec3::Z), DVec3::NEG_Z, "forward");
    assert_eq!(matrix.transform_vector3(DVec3::X), DVec3::NEG_X, "left");
    assert_eq!((scene.image.width, scene.image.height), (640, 320));

    let above = ImportOptions { camera: CameraChoice::Named("above".to_owned()), ..ImportOptions::default() };
    let (scene, _) = model.chosen(root(json!({})), above).expect("it is there");
    assert_eq!(scene.camera.map(|camera| camera.projection), Some(Projection::Orthographic { height: 4.0 }));
    assert_eq!((scene.image.width, scene.image.height), (320, 640));
    let below = ImportOptions { camera: CameraChoice::Named("below".to_owned()), ..ImportOptions::default() };
    let error = model.chosen(root(json!({})), below).expect_err("it is not there").to_string();
    assert!(error.contains("\"above\""), "{error}");

    // As if the file had none, also for the shape of the picture.
    let none = ImportOptions { camera: CameraChoice::None, ..ImportOptions::default() };
    let (scene, warnings) = model.chosen(root(json!({})), none.clone()).expect("it is valid");
    assert!(scene.camera.is_none() && warnings.is_empty(), "{warnings:?}");
    assert_eq!((scene.image.width, scene.image.height), (640, 480));
    let names: Vec<_> = scene.contents.cameras.iter().map(|camera| camera.name.as_deref()).collect();
    assert_eq!(names, [None, Some("above")], "they are there all the same");
    let mut memory = model.memory(root(json!({})));
    memory.0.insert("a.toml".into(), b"import = \"m/a.gltf\"".to_vec());
    let mut context = LoadContext { import: none, ..LoadContext::new(&memory) };
    let scene = load::scene(Path::new("a.toml"), &mut context).expect("it is valid");
    assert!(scene.camera.is_none());
}

#[test]
fn lamps_have_photometric_units() {
    let lights = json!([
        {"type": "point", "intensity": 314.0, "color": [1, 0.5, 0]},
        {"type": "directional", "intensity": std::f64::consts::PI},
        {"type": "spot", "spot": {"outerConeAngle": 0.5}},
    ]);
    let root = json!({
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": lights}},
        "nodes": [
            {"extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": [1, 2, 3]},
            {"extensions": {"KHR_lights_punctual": {"light": 1}}},
            {"extensions": {"KHR_lights_punctual": {"light": 2}}, "rotation": [0, 1, 0, 0]},
        ],
    });
    let (scene, _) = Model::default().read(root).expect("it is valid");
    let [point, sun, spot] = &scene.lights[..] else { panic!("three lights") };
    // A white diffuse surface at a distance of 1, under E = 314 lx, has the radiance E/π.
    let LightKind::Point { position, intensity: Color::Value(color), .. } = &point.kind else {
        panic!("{point:?}")
    };
    assert_eq!(*position, DVec3::new(1.0, 2.0, 3.0));
    assert!((color[0] - 99.949_3).abs() < 1e-3 && (color[1] - 49.974_6).abs() < 1e-3 && color[2] == 0.0);
    assert!(matches!(
        sun.kind,
        LightKind::Distant { direction: DVec3::NEG_Z, intensity: Color::Value([1.0, 1.0, 1.0]) }
    ));
    let LightKind::Spot { direction, cone_angle, inner_angle, .. } = spot.kind else { panic!("{spot:?}") };
    assert!((direction - DVec3::Z).length() < 1e-12);
    assert!((cone_angle - 0.5_f64.to_degrees()).abs() < 1e-9 && inner_angle == 0.0);
}

/// Where our mapping looks for a glTF coordinate, as glTF's coordinate in the picture.
fn looked_up(mapping: &Mapping, [u, v]: [f32; 2]) -> Vec2 {
    let ours = [u, 1.0 - v, 1.0];
    let [s, t] = match mapping {
        Mapping::Uv { scale, offset } => [ours[0] * scale[0] + offset[0], ours[1] * scale[1] + offset[1]],
        Mapping::Affine { matrix, .. } => matrix.map(|row| row.iter().zip(ours).map(|(a, b)| a * b).sum()),
        other => panic!("{other:?}"),
    };
    Vec2::new(s, 1.0 - t)
}

#[test]
fn texture_coordinates_are_turned_over_and_transformed() {
    let mut model = Model::default();
    let positions = model.square();
    let uvs = model.floats("VEC2", &[0.25, 0.125, 1.0, 0.0, 0.0, 1.0, 3.0, -2.0]);
    let primitive = |material: Value| {
        let primitive = json!({"attributes": {"POSITION": positions, "TEXCOORD_0": uvs, "TEXCOORD_1": uvs}, "mode": 5, "material": 0});
        let mut root = one(primitive, pictures());
        root["materials"] = json!([material]);
        root["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}]);
        root["textures"][0]["sampler"] = json!(0);
        root
    };
    let transform = json!({"offset": [0.5, -0.25], "rotation": 0.7, "scale": [2.0, 3.0], "texCoord": 1});
    let texture = json!({"index": 0, "extensions": {"KHR_texture_transform": transform}});
    let scene = model.scene(primitive(json!({"pbrMetallicRoughness": {"baseColorTexture": texture}})));
    let mesh = mesh(&scene, &scene.shapes[0]);
    assert_eq!(mesh.uvs[0], Vec2::new(0.25, 0.875));
    assert_eq!(
        (mesh.uvs[3], mesh.more_uvs.len(), mesh.more_uvs[0][3]),
        (Vec2::new(3.0, 3.0), 1, Vec2::new(3.0, 3.0))
    );
    let Color::Texture(id) = principled(&scene).base_color else { panic!("a texture") };
    let TextureKind::Image { mapping, wrap, filter, .. } = &scene.textures[id.index()].kind else {
        panic!("a picture")
    };
    assert_eq!((*wrap, *filter), ([Wrap::Clamp, Wrap::Mirror], TexelFilter::Nearest));
    assert!(matches!(mapping, Mapping::Affine { set: 1, .. }));
    // As the extension writes it: translation · rotation · scale, with the rotation's columns (cos, −sin), (sin, cos).
    let (sin, cos) = 0.7_f32.sin_cos();
    for uv @ [u, v] in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.3, 0.9], [-4.0, 7.5]] {
        let expected = Vec2::new(0.5 + cos * 2.0 * u + sin * 3.0 * v, -0.25 - sin * 2.0 * u + cos * 3.0 * v);
        assert!((looked_up(mapping, uv) - expected).length() < 1e-5, "{uv:?}");
    }
    let scene = model.scene(primitive(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}})));
    let Color::Texture(id) = principled(&scene).base_color else { panic!("a texture") };
    let TextureKind::Image { mapping, .. } = &scene.textures[id.index()].kind else { panic!("a picture") };
    assert_eq!(looked_up(mapping, [0.25, 0.125]), Vec2::new(0.25, 0.125));
}

#[test]
fn a_picture_is_decoded_once_for_each_meaning() {
    let material = json!({
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 0}, "roughnessFactor": 0.5},
        "emissiveTexture": {"index": 0}, "emissiveFactor": [1, 1, 1],
        "occlusionTexture": {"index": 0},
        "normalTexture": {"index": 0, "scale": 2},
    });
    let scene = looking(material, pictures());
    // Colours, numbers, normals.
    assert_eq!(scene.images.len(), 3);
    assert!(scene.images.iter().all(|image| (image.width, image.height) == (1, 2)));
    let Scalar::Texture(roughness) = principled(&scene).roughness else { panic!("a texture") };
    let TextureKind::Image { channel, scale, .. } = scene.textures[roughness.index()].kind else {
        panic!("a picture")
    };
    assert_eq!((channel, scale), (Channel::Green, 0.5));
    let bump_mapping = scene.materials[0].bump_mapping;
    assert!(matches!(bump_mapping, BumpMapping::NormalTexture(normals) if normals.scale == 2.0));
    assert!(scene.shapes[0].emission.is_some_and(|emission| !emission.two_sided));
}

#[test]
fn a_missing_picture_is_a_warning() {
    let mut model = Model::default();
    let positions = model.square();
    let material = json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
    let root = one(
        json!({"attributes": {"POSITION": positions}, "mode": 5, "material": 0}),
        json!({"materials": [material], "textures": [{"source": 0}], "images": [{"uri": "none.png"}]}),
    );
    let (scene, warnings) = model.read(root).expect("it is survived");
    assert_eq!(scene.images[0].texel(0), [1.0; 3]);
    assert!(warnings[0].contains("m/a.gltf#/images/0") && warnings[0].contains("none.png"), "{warnings:?}");
}

#[test]
fn the_plain_picture_stands_in_for_one_that_is_not_read() {
    let mut files = pictures();
    files["images"].as_array_mut().expect("a list").push(json!({"uri": "data:image/ktx2;base64,AAAA"}));
    files["textures"][0]["extensions"] = json!({"KHR_texture_basisu": {"source": 1}});
    let scene = looking(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}), files);
    assert_eq!((scene.images[0].width, scene.images[0].height), (1, 2));
}

#[test]
fn extensions_of_materials_are_read() {
    let scene = looking(
        json!({
            "doubleSided": true,
            "emissiveFactor": [0.5, 0, 0.25],
            "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 1], "metallicFactor": 0, "roughnessFactor": 0.25},
            "extensions": {
                "KHR_materials_emissive_strength": {"emissiveStrength": 8},
                "KHR_materials_ior": {"ior": 1.33},
                "KHR_materials_dispersion": {"dispersion": 0.2},
                "KHR_materials_transmission": {"transmissionFactor": 0.75},
                "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [1, 0.5, 0.25]},
                "KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [2, 1, 0]},
                "KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.125},
                "KHR_materials_sheen": {"sheenColorFactor": [0, 0, 1], "sheenRoughnessFactor": 0.5},
                "KHR_materials_iridescence": {"iridescenceFactor": 1, "iridescenceIor": 1.8},
                "KHR_materials_anisotropy": {"anisotropyStrength": 0.5, "anisotropyRotation": 1},
                "KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.25, "diffuseTransmissionColorFactor": [1, 0, 0]},
            },
        }),
        json!({}),
    );
    let look = principled(&scene);
    assert_eq!(look.base_color, Color::Value([0.1, 0.2, 0.3]));
    assert_eq!((look.metallic, look.roughness), (Scalar::Value(0.0), Scalar::Value(0.25)));
    assert_eq!((look.ior, look.dispersion, look.transmission), (1.33, 0.2, Scalar::Value(0.75)));
    assert!(look.is_solid);
    // After the distance, the colour is left.
    let left = look.absorption.map(|absorption| (-2.0 * absorption).exp());
    assert!((Vec3::from(left) - Vec3::new(1.0, 0.5, 0.25)).length() < 1e-6);
    assert_eq!((look.specular, look.specular_color), (Scalar::Value(0.5), Color::Value([2.0, 1.0, 0.0])));
    assert_eq!((look.clearcoat, look.clearcoat_roughness), (Scalar::Value(1.0), Scalar::Value(0.125)));
    assert_eq!((look.sheen_color, look.sheen_roughness), (Color::Value([0.0, 0.0, 1.0]), Scalar::Value(0.5)));
    assert_eq!((look.iridescence, look.iridescence_ior), (Scalar::Value(1.0), 1.8));
    assert_eq!(look.iridescence_thickness, Scalar::Value(400.0));
    assert!(
        look.anisotropy
            .is_some_and(|own| own.strength == 0.5 && own.rotation == 1.0 && own.texture.is_none())
    );
    assert_eq!(
        (look.diffuse_transmission, look.diffuse_transmission_color),
        (Scalar::Value(0.25), Color::Value([1.0, 0.0, 0.0]))
    );
    let emission = scene.shapes[0].emission.expect("it shines");
    assert_eq!((emission.radiance, emission.two_sided), (Color::Value([4.0, 0.0, 2.0]), true));
    assert!(!scene.shapes[0].single_sided);
}

/// A white body in which half of the light is left after a length of 2, with this scattering and more extensions.
fn scattering(scatter: Value, more: Value) -> (Scene, Vec<String>) {
    let mut extensions = json!({
        "KHR_materials_transmission": {"transmissionFactor": 1},
        "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [0.5, 0.5, 1]},
        "KHR_materials_volume_scatter": scatter,
    });
    if let (Value::Object(extensions), Value::Object(more)) = (&mut extensions, more) {
        extensions.extend(more);
    }
    let mut model = Model::default();
    let positions = model.square();
    let primitive = json!({"attributes": {"POSITION": positions}, "mode": 5, "material": 0});
    let used = ["KHR_materials_transmission", "KHR_materials_volume", "KHR_materials_volume_scatter"];
    let materials = json!([{"name": "wax", "extensions": extensions}]);
    let root = one(primitive, json!({"materials": materials, "extensionsUsed": used}));
    model.read(root).expect("it is valid")
}

#[test]
fn volumes_that_scatter_are_filled_with_a_medium() {
    // By the texts of 2025 and of 2026.
    for name in ["multiscatterColor", "multiscatterColorFactor"] {
        let (scene, warnings) = scattering(json!({name: [1, 0.5, 1], "scatterAnisotropy": 0.25}), json!({}));
        assert_eq!(warnings, Vec::<String>::new());
        assert_eq!(scene.materials[0].medium.map(MediumId::index), Some(0));
        let medium = &scene.media[0];
        assert_eq!((medium.name.as_str(), medium.g, medium.scale), ("wax", 0.25, 1.0));
        assert_eq!(medium.at.to_string(), "m/a.gltf#/materials/0/extensions/KHR_materials_volume_scatter");
        let Extinction::Parts { absorption: Color::Value(absorption), scattering: Color::Value(scattering) } =
            medium.extinction
        else {
            panic!("values")
        };
        let attenuation = 0.5_f32.ln() / -2.0;
        let total = Vec3::from(absorption) + Vec3::from(scattering);
        assert!((total - Vec3::new(attenuation, attenuation, 0.0)).length() < 1e-6, "{total}");
        assert!(absorption[0] < 1e-7 * attenuation, "white absorbs nothing");
        // s of a half is 4.09712 + 2.104315 − √(9.59217 + 20.8404 + 4.42815) = 0.297138.
        let s2 = 0.297_138_f32 * 0.297_138;
        let albedo = (1.0 - s2) / (1.0 - 0.25 * s2);
        assert!((scattering[1] / attenuation - albedo).abs() < 1e-5, "{}", scattering[1] / attenuation);
        // Light bounces often in there.
        assert_eq!((scene.render.integrator, scene.render.depth), (Integrator::Path, 200));
    }
}

#[test]
fn volumes_that_only_absorb_have_no_medium() {
    let nothing = |scatter: Value, more: Value, expected: &[&str]| {
        let (scene, warnings) = scattering(scatter, more);
        assert_eq!((scene.media.len(), scene.materials[0].medium, scene.render.depth), (0, None, 8));
        assert_eq!(warnings.len(), expected.len(), "{warnings:?}");
        for (warning, expected) in warnings.iter().zip(expected) {
            assert!(warning.contains(expected), "{warning}");
        }
    };
    let white = json!({"multiscatterColorFactor": [1, 1, 1]});
    nothing(json!({}), json!({}), &[]);
    nothing(json!({"multiscatterColor": [0, 0, 0]}), json!({}), &[]);
    nothing(json!({"multiscatterColor": [-1, -0.5, 0]}), json!({}), &[]);
    let volume = |volume: Value| json!({"KHR_materials_volume": volume});
    nothing(white.clone(), volume(json!({"thicknessFactor": 1})), &[]);
    let clear = json!({"thicknessFactor": 1, "attenuationDistance": 1});
    nothing(white.clone(), volume(clear), &[]);
    let thin = "KHR_materials_volume_scatter: nothing is scattered in a thin sheet";
    let sheet = json!({"attenuationDistance": 1, "attenuationColor": [0, 0, 0]});
    nothing(white.clone(), volume(sheet), &[thin]);
    nothing(white.clone(), volume(Value::Null), &[thin]);
    nothing(white, json!({"KHR_materials_unlit": {}}), &[]);
}

#[test]
fn scattering_out_of_range_is_clamped() {
    let (scene, warnings) = scattering(
        json!({"multiscatterColorFactor": [2, -1, 1e300], "multiscatterColorTexture": {"index": 7}, "scatterAnisotropy": -1}),
        json!({}),
    );
    let expected = [
        "KHR_materials_volume_scatter/multiscatterColorTexture: the texture is ignored",
        "KHR_materials_volume_scatter/multiscatterColorFactor: the factor is [2, -1, 1000",
        "KHR_materials_volume_scatter/scatterAnisotropy: the anisotropy is -1; expected a number between -1 and 1: -0.999 is used",
    ];
    assert_eq!(warnings.len(), expected.len(), "{warnings:?}");
    for (warning, expected) in warnings.iter().zip(expected) {
        assert!(warning.contains(expected), "{warning}");
    }
    assert_eq!(scene.media[0].g, -0.999);
    scene.validate().expect("it is valid");
    let (scene, warnings) =
        scattering(json!({"multiscatterColor": [1, 1, 1], "scatterAnisotropy": 1e30}), json!({}));
    assert_eq!((scene.media[0].g, warnings.len()), (0.999, 1));
    // The densest that can be written.
    let dense =
        json!({"thicknessFactor": 1, "attenuationDistance": 1e-300, "attenuationColor": [0, -1, 0.5]});
    let (scene, _) =
        scattering(json!({"multiscatterColor": [1, 0.5, 1]}), json!({"KHR_materials_volume": dense}));
    scene.validate().expect("it is valid");
}

#[test]
fn glossy_and_unlit_materials_are_converted() {
    let glossy = json!({"extensions": {"KHR_materials_pbrSpecularGlossiness": {
        "diffuseFactor": [0.5, 0.25, 0, 1], "specularFactor": [0.1, 0.2, 0.3], "glossinessFactor": 0.75,
    }}});
    let scene = looking(glossy, json!({}));
    let look = principled(&scene);
    assert_eq!(
        (look.base_color, look.specular_color),
        (Color::Value([0.5, 0.25, 0.0]), Color::Value([0.1, 0.2, 0.3]))
    );
    assert_eq!((look.metallic, look.roughness, look.ior), (Scalar::Value(0.0), Scalar::Value(0.25), 0.0));

    let unlit = json!({"extensions": {"KHR_materials_unlit": {}}, "pbrMetallicRoughness": {"baseColorFactor": [0, 1, 0, 1]}});
    let scene = looking(unlit, json!({}));
    assert_eq!(scene.materials[0].kind, MaterialKind::Unlit { color: Color::Value([0.0, 1.0, 0.0]) });
}

#[test]
fn what_is_not_there_lets_light_through() {
    let alpha = |mode: &str, alpha: f64| {
        let material =
            json!({"alphaMode": mode, "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, alpha]}});
        looking(material, json!({})).shapes[0].alpha
    };
    assert_eq!(alpha("OPAQUE", 0.25), None);
    assert_eq!(alpha("BLEND", 0.25), Some(Scalar::Value(0.25)));
    assert_eq!(alpha("BLEND", 1.0), None);
    assert_eq!(alpha("MASK", 0.75), None);
    assert_eq!(alpha("MASK", 0.25), Some(Scalar::Value(0.0)));

    let material = json!({"alphaMode": "MASK", "alphaCutoff": 0.3, "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
    let scene = looking(material, pictures());
    let Some(Scalar::Texture(TextureId(id))) = scene.shapes[0].alpha else { panic!("a texture") };
    let TextureKind::Threshold { value: Scalar::Texture(inner), edge } = scene.textures[id as usize].kind
    else {
        panic!("an edge")
    };
    assert_eq!(edge, 0.3);
    assert!(matches!(scene.textures[inner.index()].kind, TextureKind::Image { channel: Channel::Alpha, .. }));
    assert_eq!(scene.images.len(), 1, "colour and opacity are of one picture");
}

#[test]
fn variants_are_chosen() {
    let mut model = Model::default();
    let positions = model.square();
    let primitive = json!({
        "attributes": {"POSITION": positions}, "mode": 5, "material": 0,
        "extensions": {"KHR_materials_variants": {"mappings": [{"material": 1, "variants": [1]}]}},
    });
    let root = one(
        primitive,
        json!({
            "materials": [{"name": "plain"}, {"name": "fancy"}],
            "extensions": {"KHR_materials_variants": {"variants": [{"name": "a"}, {"name": "b"}]}},
        }),
    );
    let worn = |variant: Option<&str>| {
        let choice = ImportOptions { variant: variant.map(ToOwned::to_owned), ..ImportOptions::default() };
        model.chosen(root.clone(), choice).map(|(scene, _)| scene.materials[0].name.clone())
    };
    assert_eq!(worn(None).expect("valid"), "plain");
    assert_eq!(worn(Some("a")).expect("valid"), "plain");
    assert_eq!(worn(Some("b")).expect("valid"), "fancy");
    assert_eq!(worn(Some("1")).expect("valid"), "fancy");
    let error = worn(Some("c")).expect_err("there is none").to_string();
    assert!(error.contains("there is no variant \"c\"") && error.contains("\"a\", \"b\""), "{error}");
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
fn a_container_is_known_by_its_content() {
    let mut model = Model::default();
    let positions = model.square();
    let mut root = model.json(one(json!({"attributes": {"POSITION": positions}, "mode": 5}), json!({})));
    root["buffers"] = json!([{"byteLength": model.bytes.len()}]);
    let glb = container(&root, &model.bytes);
    let memory = Memory([(PathBuf::from("a.download"), glb)].into());
    let scene = load::scene(Path::new("a.download"), &mut LoadContext::new(&memory)).expect("it is valid");
    assert_eq!(mesh(&scene, &scene.shapes[0]).positions.len(), 4);

    root["buffers"] =
        json!([{"byteLength": model.bytes.len(), "uri": format!("data:;base64,{}", base64(&model.bytes))}]);
    let memory = Memory([(PathBuf::from("a.json"), root.to_string().into_bytes())].into());
    let scene = load::scene(Path::new("a.json"), &mut LoadContext::new(&memory)).expect("it is valid");
    assert_eq!(mesh(&scene, &scene.shapes[0]).positions.len(), 4);
}

fn container(root: &Value, binary: &[u8]) -> Vec<u8> {
    let mut json = root.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut glb = b"glTF".to_vec();
    glb.extend(2_u32.to_le_bytes());
    glb.extend((28 + json.len() as u32 + binary.len() as u32).to_le_bytes());
    glb.extend((json.len() as u32).to_le_bytes());
    glb.extend(b"JSON");
    glb.extend(json);
    glb.extend((binary.len() as u32).to_le_bytes());
    glb.extend(b"BIN\0");
    glb.extend(binary);
    glb
}

#[test]
fn errors_name_the_place() {
    let mut model = Model::default();
    let positions = model.square();
    let indices = model.indices(&[0, 1, 9]);
    let long = model.accessor(json!({"bufferView": 0, "componentType": 5126, "count": 5, "type": "VEC3"}));
    let vast = model.accessor(json!({"componentType": 5126, "count": 1u64 << 40, "type": "VEC3"}));
    let attributes = |index: usize| json!({"attributes": {"POSITION": index}});
    let at = |rest: Value| model.error(rest).to_string().lines().next().unwrap_or_default().to_owned();
    let cases = [
        (
            one(attributes(long), json!({})),
            "m/a.gltf#/meshes/0/primitives/0/attributes/POSITION: 5 elements of 12 bytes",
        ),
        (
            one(attributes(vast), json!({})),
            "m/a.gltf#/meshes/0/primitives/0/attributes/POSITION: 1099511627776 values",
        ),
        (
            one(attributes(indices), json!({})),
            "m/a.gltf#/meshes/0/primitives/0/attributes/POSITION: accessor 1 is SCALAR",
        ),
        (
            one(attributes(99), json!({})),
            "m/a.gltf#/meshes/0/primitives/0/attributes/POSITION: accessor 99 is used",
        ),
        (
            one(json!({"attributes": {"POSITION": positions}, "indices": indices}), json!({})),
            "m/a.gltf#/meshes/0/primitives/0/indices: vertex 9 is used, but there are only 4",
        ),
        (
            one(json!({"attributes": {"POSITION": positions}, "mode": 7}), json!({})),
            "m/a.gltf#/meshes/0/primitives/0/mode: the mode 7 is not known",
        ),
        (
            one(
                json!({"attributes": {"POSITION": positions}, "mode": 5, "material": 0}),
                json!({"materials": [{"normalTexture": {"index": 3}}]}),
            ),
            "m/a.gltf#/materials/0/normalTexture/index: texture 3 is used, but the file has none",
        ),
        (
            json!({"nodes": [{"children": [1]}, {"children": [0]}]}),
            "m/a.gltf#/nodes/0: this node is its own ancestor",
        ),
        (json!({"nodes": [{"children": [7]}]}), "m/a.gltf#/nodes/0/children/0: node 7 is used"),
        (json!({"nodes": [{"scale": "big"}]}), "m/a.gltf#/nodes/0/scale: invalid type: string \"big\""),
        (
            json!({"asset": {"version": "1.0"}}),
            "m/a.gltf#/asset/version: glTF 1.0 is not read, only glTF 2.0",
        ),
        (
            json!({"asset": {"version": "new"}}),
            "m/a.gltf#/asset/version: the version \"new\" is not like \"2.0\"",
        ),
    ];
    for (rest, expected) in cases {
        let found = at(rest);
        assert!(found.starts_with(expected), "found    {found}\nexpected {expected}");
    }
}

#[test]
fn unknown_extensions_are_warned_of() {
    let mut model = Model::default();
    let positions = model.square();
    let root = one(
        json!({"attributes": {"POSITION": positions}, "mode": 5}),
        json!({"extensionsUsed": ["KHR_materials_ior", "A_b", "C_d"], "extensionsRequired": ["C_d"]}),
    );
    let (_, warnings) = model.read(root).expect("it is valid");
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert!(warnings[0].starts_with("m/a.gltf#/extensionsRequired/0: the file requires the extension C_d"));
    assert!(warnings[1].starts_with("m/a.gltf#/extensionsUsed/1: the extension A_b"));
}

#[test]
fn a_scene_of_ours_takes_what_it_asks_for() {
    let mut model = Model::default();
    let positions = model.square();
    let root = one(
        json!({"attributes": {"POSITION": positions}, "mode": 5, "material": 0,
            "extensions": {"KHR_materials_variants": {"mappings": [{"material": 1, "variants": [0]}]}}}),
        json!({
            "materials": [{"name": "plain"}, {"name": "fancy"}],
            "extensions": {
                "KHR_materials_variants": {"variants": [{"name": "b"}]},
                "KHR_lights_punctual": {"lights": [{"type": "point"}]},
            },
            "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 0, 7], "extensions": {"KHR_lights_punctual": {"light": 0}}}],
            "scenes": [{"nodes": [0, 1]}],
            "cameras": [{"orthographic": {"xmag": 1, "ymag": 1}}],
        }),
    );
    let read = |toml: &str| {
        let mut memory = model.memory(root.clone());
        memory.0.insert(PathBuf::from("a.toml"), toml.as_bytes().to_vec());
        load::scene(Path::new("a.toml"), &mut LoadContext::new(&memory))
    };
    let worn =
        |scene: &Scene, shape: usize| scene.materials[scene.shapes[shape].material.index()].name.clone();
    let plain = read("[[mesh]]\nfile = \"m/a.gltf\"\n").expect("it is valid");
    assert!(plain.camera.is_none() && plain.lights.is_empty() && worn(&plain, 0) == "plain");

    let all = read(
        "[[mesh]]\nfile = \"m/a.gltf\"\nscale = 2\ncamera = true\nlights = true\n[[mesh]]\nfile = \"m/a.gltf\"\nvariant = \"b\"\n",
    )
    .expect("it is valid");
    assert_eq!((worn(&all, 0), worn(&all, 1)), ("plain".to_owned(), "fancy".to_owned()));
    let camera = all.camera.expect("the file's");
    assert_eq!(camera.projection, Projection::Orthographic { height: 4.0 });
    assert!(
        matches!(camera.view, View::Matrix(matrix) if matrix.w_axis.z == 14.0 && matrix.z_axis.z == -1.0)
    );
    assert!(
        matches!(all.lights[0].kind, LightKind::Point { position, .. } if position == DVec3::new(0.0, 0.0, 14.0))
    );

    let imported = read("import = \"m/a.gltf\"\n").expect("it is valid");
    assert!(imported.camera.is_some() && imported.lights.len() == 1 && imported.shapes.len() == 1);
    let error =
        read("[[objects.a.mesh]]\nfile = \"m/a.gltf\"\nlights = true\n").expect_err("objects have no lights");
    assert!(error.to_string().starts_with("a.toml:3:10: an object cannot have `lights`"), "{error}");
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
