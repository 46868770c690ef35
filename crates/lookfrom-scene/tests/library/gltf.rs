//! glTF files made here: what they say comes to what is meant.

// JSON is written where it is passed.
#![allow(clippy::needless_pass_by_value)]

mod cameras_and_lights;
mod errors;
mod geometry;
mod materials;
mod textures;

use std::path::{Path, PathBuf};

use glam::{DVec3, Vec3};
use lookfrom_scene::camera::{Projection, View};
use lookfrom_scene::files::ImportOptions;
use lookfrom_scene::image::encode_png;
use lookfrom_scene::light::LightKind;
use lookfrom_scene::material::{MaterialKind, Principled};
use lookfrom_scene::settings::{Integrator, Tonemap};
use lookfrom_scene::shape::{Geometry, Mesh, Shape};
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
