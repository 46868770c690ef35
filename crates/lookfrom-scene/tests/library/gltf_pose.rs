//! glTF models at one moment: nodes, joints and morph targets are where animations have them.

use std::path::{Path, PathBuf};

use glam::{DVec3, Vec3, Vec4};
use lookfrom_scene::files::ImportOptions;
use lookfrom_scene::{Disk, LoadContext, Memory, Result, Scene, gltf, load};
use serde_json::{Value, json};

/// Accessors of floats, and of bytes for joints.
#[derive(Default)]
struct Numbers {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Numbers {
    fn push(&mut self, bytes: &[u8], component: u32, count: usize, kind: &str) -> usize {
        self.views.push(json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()}));
        self.bytes.extend(bytes);
        let view = self.views.len() - 1;
        self.accessors
            .push(json!({"bufferView": view, "componentType": component, "count": count, "type": kind}));
        self.accessors.len() - 1
    }

    fn floats<const N: usize>(&mut self, kind: &str, elements: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = elements.as_flattened().iter().flat_map(|number| number.to_le_bytes()).collect();
        self.push(&bytes, 5126, elements.len(), kind)
    }

    fn joints(&mut self, elements: &[[u8; 4]]) -> usize {
        self.push(elements.as_flattened(), 5121, elements.len(), "VEC4")
    }

    fn read(
        &self,
        mut root: Value,
        animation: Option<&str>,
        at: impl Into<Option<f64>>,
    ) -> Result<(Scene, Vec<String>)> {
        root["asset"] = json!({"version": "2.0"});
        root["buffers"] = json!([{"uri": "b", "byteLength": self.bytes.len()}]);
        root["bufferViews"] = json!(self.views);
        root["accessors"] = json!(self.accessors);
        let files =
            [(PathBuf::from("a.gltf"), root.to_string().into_bytes()), ("b".into(), self.bytes.clone())];
        let files = Memory(files.into());
        let mut context = LoadContext::new(&files);
        context.import = ImportOptions {
            animation: animation.map(str::to_owned),
            at: at.into(),
            ..ImportOptions::default()
        };
        let scene = gltf::read(Path::new("a.gltf"), &mut context)?;
        Ok((scene, context.warnings.iter().map(ToString::to_string).collect()))
    }

    /// Where the vertices of the first mesh are in the world, of what must read without a warning.
    fn places(&self, root: &Value, animation: Option<&str>, at: impl Into<Option<f64>>) -> Vec<DVec3> {
        let (scene, warnings) = self.read(root.clone(), animation, at).expect("it is valid");
        assert_eq!(warnings, Vec::<String>::new());
        let world_from_object = scene.shapes[0].world_from_object;
        scene.meshes[0].positions.iter().map(|p| world_from_object.transform_point3(p.as_dvec3())).collect()
    }
}

fn near(found: DVec3, expected: [f64; 3]) {
    assert!((found - DVec3::from_array(expected)).length() < 1e-6, "{found}, not {expected:?}");
}

const TRIANGLE: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
const HALF: f32 = std::f32::consts::FRAC_1_SQRT_2;

/// A triangle on the forearm of a bent arm: two joints beside the mesh's node, the second turned by 90° within a second.
fn arm() -> (Numbers, Value) {
    let mut numbers = Numbers::default();
    let position = numbers.floats("VEC3", &[[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 1.0, 1.0]]);
    let joints = numbers.joints(&[[0, 0, 0, 0], [1, 0, 0, 0], [0, 1, 0, 0]]);
    let weights =
        numbers.floats("VEC4", &[[1.0, 0.0, 0.0, 0.0], [0.25, 0.0, 0.0, 0.0], [3.0, 3.0, 0.0, 0.0]]);
    let identity = |x: f32| {
        let mut columns = [0.0; 16];
        for i in 0..4 {
            columns[5 * i] = 1.0;
        }
        columns[12] = x;
        columns
    };
    let bound = numbers.floats("MAT4", &[identity(0.0), identity(-1.0)]);
    let times = numbers.floats("SCALAR", &[[1.0], [2.0]]);
    let turns = numbers.floats("VEC4", &[[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, HALF, HALF]]);
    let slides = numbers.floats("VEC3", &[[0.0, 0.0, 0.0], [0.0, 0.0, 4.0]]);
    let root = json!({
        "nodes": [
            {"mesh": 0, "skin": 0, "translation": [100, 0, 0]},
            {"children": [2], "translation": [0, 5, 0]},
            {"children": [3]},
            {"translation": [1, 0, 0]}
        ],
        "scenes": [{"nodes": [0, 1]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": position, "JOINTS_0": joints, "WEIGHTS_0": weights}}]}],
        "skins": [{"joints": [2, 3], "inverseBindMatrices": bound}],
        "animations": [
            {"name": "bend",
             "channels": [{"sampler": 0, "target": {"node": 3, "path": "rotation"}}],
             "samplers": [{"input": times, "output": turns}]},
            {"name": "slide",
             "channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}],
             "samplers": [{"input": times, "output": slides, "interpolation": "STEP"}]}
        ]
    });
    (numbers, root)
}

#[test]
fn joints_take_the_mesh_along_and_its_own_node_does_not() {
    let (numbers, root) = arm();
    let at_rest = numbers.places(&root, None, None);
    near(at_rest[0], [0.0, 5.0, 0.0]);
    near(at_rest[1], [2.0, 5.0, 0.0]);
    // Before the first key, between both, and after the last.
    near(numbers.places(&root, Some("bend"), 0.5)[1], [2.0, 5.0, 0.0]);
    let half = f64::from(HALF);
    near(numbers.places(&root, Some("bend"), 1.5)[1], [1.0 + half, 5.0 + half, 0.0]);
    let bent = numbers.places(&root, Some("0"), 99.0);
    near(bent[0], [0.0, 5.0, 0.0]);
    near(bent[1], [1.0, 6.0, 0.0]);
    // Half with each joint: at (1, 1, 1) and at (0, 0, 1).
    near(bent[2], [0.5, 5.5, 1.0]);
    near(numbers.places(&root, Some("slide"), 1.99)[1], [2.0, 0.0, 0.0]);
    near(numbers.places(&root, Some("slide"), 2.0)[1], [2.0, 0.0, 4.0]);
    // A time without a name is that of the first animation.
    near(numbers.places(&root, None, 2.0)[1], [1.0, 6.0, 0.0]);
    // So is its beginning, which need not be the pose at rest.
    let mut sliding = root.clone();
    sliding["animations"] = json!([root["animations"][1]]);
    near(numbers.places(&sliding, None, None)[1], [2.0, 5.0, 0.0]);
    near(numbers.places(&sliding, None, 0.0)[1], [2.0, 0.0, 0.0]);
}

/// A scene whose time begins by itself, with a model that would jump from its rest to its animation.
#[test]
fn while_the_shutter_is_open_models_of_a_scene_are_animated_from_the_beginning() {
    let (numbers, mut root) = arm();
    root["animations"] = json!([root["animations"][1]]);
    root["asset"] = json!({"version": "2.0"});
    root["buffers"] = json!([{"uri": "b", "byteLength": numbers.bytes.len()}]);
    root["bufferViews"] = json!(numbers.views);
    root["accessors"] = json!(numbers.accessors);
    let scene = "[camera]\nlookfrom = [\"= t\", 1, 9]\nlookat = [0, 0, 0]\n[[mesh]]\nfile = \"a.gltf\"\n";
    let files = [("a.gltf", root.to_string().into_bytes()), ("b", numbers.bytes), ("a.toml", scene.into())];
    let files = Memory(files.map(|(name, bytes)| (PathBuf::from(name), bytes)).into());
    let read = |name: &str, at: Option<f64>| {
        let mut context = LoadContext::new(&files);
        (context.import.shutter, context.import.at) = (Some(1.0), at);
        let scene = load::scene(Path::new(name), &mut context).expect("a scene");
        (scene, context.warnings.iter().map(|warning| warning.message.clone()).collect::<Vec<_>>())
    };
    let (alone, at_begin) = (read("a.toml", None).0, read("a.toml", Some(0.0)).0);
    assert!(alone.camera.is_some_and(|camera| camera.motion.is_some()));
    assert!(alone.meshes[0].later.is_empty(), "before its first keyframe it stands still");
    assert_eq!(alone.meshes[0].positions, at_begin.meshes[0].positions);
    // A model alone is at rest without a time, which a shutter that is asked for does not change, but tells.
    let (model, said) = read("a.gltf", None);
    assert!(model.meshes[0].later.is_empty());
    assert!(said.iter().any(|warning| warning.starts_with("not blurred: ")), "{said:?}");
}

#[test]
fn errors_of_poses_say_what_there_is() {
    let (numbers, root) = arm();
    let error = |root: &Value, animation: &str| numbers.read(root.clone(), Some(animation), 1.0).unwrap_err();
    let unknown = error(&root, "bent").to_string();
    assert!(unknown.contains("a.gltf#/animations: there is no animation \"bent\""), "{unknown}");
    assert!(unknown.contains("did you mean \"bend\"? there are: \"bend\", \"slide\""), "{unknown}");
    let cases = [
        ("/skins/0/joints/1", json!(7), "/skins/0/joints/1: node 7"),
        ("/animations/0/channels/0/sampler", json!(3), "/animations/0/channels/0/sampler: sampler 3"),
        ("/animations/0/channels/0/target/node", json!(9), "/animations/0/channels/0/target/node: node 9"),
        ("/animations/0/samplers/0/output", json!(0), "/animations/0/samplers/0/output: accessor 0 is VEC3"),
        (
            "/animations/0/samplers/0/interpolation",
            json!("CUBICSPLINE"),
            "2 keys: each has CUBICSPLINE values",
        ),
        (
            "/animations/0/samplers/0/interpolation",
            json!("cubic"),
            "the interpolation \"cubic\" is not known",
        ),
        ("/nodes/0/skin", json!(1), "/nodes/0/skin: skin 1 is used"),
        ("/skins/0/joints", json!([2]), "attributes/JOINTS_0: joint 1 is used, but the skin has only 1"),
        ("/meshes/0/primitives/0/attributes/WEIGHTS_0", json!(5), "2 weights for 3 vertices"),
    ];
    for (pointer, value, expected) in cases {
        let mut root = root.clone();
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        match root.pointer_mut(parent).unwrap() {
            Value::Array(list) => list[key.parse::<usize>().unwrap()] = value,
            object => object[key] = value,
        }
        let message = error(&root, "bend").to_string();
        assert!(message.contains(expected), "{pointer}: {message}");
    }
}

#[test]
fn damaged_numbers_are_survived() {
    let (mut numbers, root) = arm();
    let odd = [0, 1, 0x3f, 0x7f, 0x80, 0xc0, 0xff];
    for place in 0..numbers.bytes.len() {
        let before = numbers.bytes[place];
        for value in odd {
            numbers.bytes[place] = value;
            for (animation, time) in [("bend", 1.5), ("slide", f64::NAN)] {
                let Ok((scene, _)) = numbers.read(root.clone(), Some(animation), time) else { continue };
                let mut places = scene.meshes.iter().flat_map(|mesh| &mesh.positions);
                assert!(places.all(|place| place.is_finite()), "{value} at {place}");
            }
        }
        numbers.bytes[place] = before;
    }
}

#[test]
fn channels_that_are_not_known_are_passed_over() {
    let (numbers, mut root) = arm();
    root["animations"][0]["channels"] = json!([
        {"sampler": 0, "target": {"node": 3, "path": "pointer"}},
        {"sampler": 0, "target": {"path": "rotation"}}
    ]);
    let (scene, warnings) = numbers.read(root, Some("bend"), 2.0).unwrap();
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert_eq!(scene.meshes[0].positions[1], Vec3::new(2.0, 5.0, 0.0));
    // Without any animation a time is a warning.
    let (numbers, mut root) = arm();
    root["animations"] = json!([]);
    assert_eq!(numbers.read(root, None, 2.0).unwrap().1.len(), 1);
}

#[test]
fn morph_targets_are_added_by_their_weights() {
    let mut numbers = Numbers::default();
    let position = numbers.floats("VEC3", &TRIANGLE);
    let normal = numbers.floats("VEC3", &[[0.0, 0.0, 1.0]; 3]);
    let uv = numbers.floats("VEC2", &[[0.25, 0.25]; 3]);
    let color = numbers.floats("VEC4", &[[0.5, 0.5, 0.5, 1.0]; 3]);
    let step = numbers.floats("VEC3", &[[0.0, 0.0, 2.0], [0.0, 0.0, 4.0], [0.0; 3]]);
    let other = numbers.floats("VEC3", &[[1.0, 0.0, 0.0]; 3]);
    let uv_step = numbers.floats("VEC2", &[[0.5, 0.25]; 3]);
    let color_step = numbers.floats("VEC4", &[[1.0, -0.25, -4.0, -0.5]; 3]);
    let times = numbers.floats("SCALAR", &[[0.0], [2.0]]);
    let weights = numbers.floats("SCALAR", &[[0.0], [0.0], [1.0], [-2.0]]);
    let root = json!({
        "nodes": [{"mesh": 0}],
        "meshes": [{"weights": [0.5, 1.0], "primitives": [{
            "attributes": {"POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv, "COLOR_0": color},
            "targets": [
                {"POSITION": step},
                {"POSITION": other, "NORMAL": other, "TEXCOORD_0": uv_step, "COLOR_0": color_step, "_OTHER": 99}
            ]
        }]}],
        "animations": [{
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}],
            "samplers": [{"input": times, "output": weights}]
        }]
    });
    // The mesh's own weights, then those of the node, then those of the animation.
    let places = numbers.places(&root, None, None);
    near(places[0], [1.0, 0.0, 1.0]);
    near(places[1], [2.0, 0.0, 2.0]);
    let (scene, _) = numbers.read(root.clone(), None, None).unwrap();
    let mesh = &scene.meshes[0];
    assert!((mesh.normals[0] - Vec3::new(HALF, 0.0, HALF)).length() < 1e-6);
    assert!((mesh.uvs[0] - glam::Vec2::new(0.75, 0.5)).length() < 1e-6, "v runs up: {}", mesh.uvs[0]);
    assert_eq!((mesh.colors[0], mesh.opacities[0]), ([1.0, 0.25, 0.0], 0.5));

    let mut own = root.clone();
    own["nodes"] = json!([{"mesh": 0, "weights": [1.0]}, {"mesh": 0, "weights": [0.0, 3.0]}, {"mesh": 0}]);
    let (scene, _) = numbers.read(own, None, None).unwrap();
    let firsts: Vec<Vec3> = scene.meshes.iter().map(|mesh| mesh.positions[0]).collect();
    assert_eq!(firsts, [Vec3::new(0.0, 0.0, 2.0), Vec3::new(3.0, 0.0, 0.0), Vec3::new(1.0, 0.0, 1.0)]);

    let at = |time: f64| numbers.places(&root, Some("0"), time)[0];
    near(at(0.0), [0.0, 0.0, 0.0]);
    near(at(0.5), [-0.5, 0.0, 0.5]);
    near(at(5.0), [-2.0, 0.0, 2.0]);
}

#[test]
fn relief_and_grain_bring_tangents() {
    let mut numbers = Numbers::default();
    let position = numbers.floats("VEC3", &TRIANGLE);
    let normal = numbers.floats("VEC3", &[[0.0, 0.0, 1.0]; 3]);
    // As an exporter has it: v runs down.
    let uv = numbers.floats("VEC2", &[[0.0, 1.0], [1.0, 1.0], [0.0, 0.0]]);
    let root = |material: Value| {
        json!({
            "nodes": [{"mesh": 0}],
            "materials": [material],
            "meshes": [{"primitives": [{
                "attributes": {"POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv}, "material": 0
            }]}]
        })
    };
    let plain = numbers.read(root(json!({})), None, None).unwrap().0;
    assert!(plain.meshes[0].tangents.is_empty());
    let brushed = json!({"extensions": {"KHR_materials_anisotropy": {"anisotropyStrength": 1.0}}});
    let brushed = numbers.read(root(brushed), None, None).unwrap().0;
    // The picture's up is y.
    assert_eq!(brushed.meshes[0].tangents, [Vec4::new(1.0, 0.0, 0.0, 1.0); 3]);
}

/// The vertices of a file of the corpus, in the world.
/// A file in which an animation moves properties reads, at any time, as one that has their values then.
#[test]
fn properties_are_where_pointers_take_them() {
    let mut numbers = Numbers::default();
    let position = numbers.floats("VEC3", &TRIANGLE);
    let times = numbers.floats("SCALAR", &[[0.0], [2.0]]);
    let mut channels = Vec::new();
    let mut samplers = Vec::new();
    let mut moved = |pointer: &str, output: usize, interpolation: &str| {
        samplers.push(json!({"input": times, "output": output, "interpolation": interpolation}));
        let extensions = json!({"KHR_animation_pointer": {"pointer": pointer}});
        let target = json!({"path": "pointer", "extensions": extensions});
        channels.push(json!({"sampler": channels.len(), "target": target}));
    };
    let color = numbers.floats("VEC4", &[[1.0, 0.0, 0.0, 1.0], [0.0, 0.5, 1.0, 1.0]]);
    moved("/materials/0/pbrMetallicRoughness/baseColorFactor", color, "LINEAR");
    // Neither the factor nor the extension is in the file.
    let strength = numbers.floats("SCALAR", &[[0.0], [4.0]]);
    moved("/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength", strength, "LINEAR");
    // One component of an array.
    moved("/materials/0/emissiveFactor/1", strength, "STEP");
    moved("/extensions/KHR_lights_punctual/lights/0/intensity", strength, "LINEAR");
    let field = numbers.floats("SCALAR", &[[0.4], [0.8]]);
    moved("/cameras/0/perspective/yfov", field, "LINEAR");
    let turn = numbers.floats("VEC4", &[[0.0, 0.0, 0.0, 1.0], [0.0, HALF, 0.0, HALF]]);
    moved("/nodes/0/rotation", turn, "LINEAR");
    let seen = numbers.push(&[0, 1], 5121, 2, "SCALAR");
    moved("/nodes/2/extensions/KHR_node_visibility/visible", seen, "STEP");

    let root = json!({
        "scenes": [{"nodes": [0, 1, 2]}],
        "nodes": [{"mesh": 0}, {"camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}}, {"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": position}, "material": 0}]}],
        "materials": [{"emissiveFactor": [0.5, 0.0, 0.25]}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point"}]}},
        "animations": [{"samplers": samplers, "channels": channels}],
    });
    let written = |part: f64, is_late: bool| {
        let mut root = root.clone();
        let material = &mut root["materials"][0];
        let color = [1.0 - part, 0.5 * part, part, 1.0];
        material["pbrMetallicRoughness"]["baseColorFactor"] = json!(color);
        material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = json!(4.0 * part);
        material["emissiveFactor"][1] = json!(if is_late { 4.0 } else { 0.0 });
        root["extensions"]["KHR_lights_punctual"]["lights"][0]["intensity"] = json!(4.0 * part);
        let [from, to] = [0.4_f32, 0.8].map(f64::from);
        root["cameras"][0]["perspective"]["yfov"] = json!(from + part * (to - from));
        // Half of the angle of the quaternion: the keys are rounded, so the angle is not 90°.
        let half = f64::atan2(f64::from(HALF), f64::from(HALF)) * part;
        root["nodes"][0]["rotation"] = json!([0.0, half.sin(), 0.0, half.cos()]);
        root["nodes"][2]["extensions"]["KHR_node_visibility"]["visible"] = json!(is_late);
        numbers.read(root, None, None).expect("it is valid")
    };
    for (time, part) in [(-1.0, 0.0), (0.0, 0.0), (0.5, 0.25), (1.0, 0.5), (2.0, 1.0), (9.0, 1.0)] {
        let (moving, warnings) = numbers.read(root.clone(), None, time).expect("it is valid");
        assert_eq!(warnings, Vec::<String>::new());
        let (still, _) = written(part, part == 1.0);
        assert_eq!(moving.shapes.len(), if part == 1.0 { 2 } else { 1 });
        let turned = |scene: &Scene| scene.shapes[0].world_from_object;
        assert!(turned(&moving).abs_diff_eq(turned(&still), 1e-7), "{time}");
        let all_else = |mut scene: Scene| {
            scene.shapes[0].world_from_object = glam::DMat4::IDENTITY;
            format!("{scene:#?}")
        };
        assert_eq!(all_else(moving), all_else(still), "{time}");
    }
    // Without a time the file is as it is written.
    assert_eq!(numbers.read(root, None, None).expect("it is valid").0.shapes.len(), 2);
}

fn corpus(name: &str, animation: Option<&str>, at: impl Into<Option<f64>>) -> Vec<DVec3> {
    let path = lookfrom_test_data::shared(&format!("corpus/{name}"));
    let mut context = LoadContext::new(&Disk);
    context.import =
        ImportOptions { animation: animation.map(str::to_owned), at: at.into(), ..ImportOptions::default() };
    let scene = gltf::read(&path, &mut context).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(context.warnings, []);
    let world_from_object = scene.shapes[0].world_from_object;
    scene.meshes[0].positions.iter().map(|p| world_from_object.transform_point3(p.as_dvec3())).collect()
}

#[test]
#[ignore = "needs LOOKFROM_SHARED"]
fn the_simple_skin_of_the_corpus_bends_around_its_joint() {
    let rest = corpus("gltf/SimpleSkin/SimpleSkin.gltf", None, None);
    for time in [0.5, 1.0, 1.7, 2.5, 4.0, 5.5] {
        let bent = corpus("gltf/SimpleSkin/SimpleSkin.gltf", Some("0"), time);
        // The lowest row stays, the uppermost keeps its distance from the joint at (0, 1).
        near(bent[0], rest[0].to_array());
        let joint = DVec3::Y;
        for vertex in [8, 9] {
            assert!((bent[vertex].distance(joint) - rest[vertex].distance(joint)).abs() < 1e-3);
        }
    }
    let quarter = corpus("gltf/SimpleSkin/SimpleSkin.gltf", Some("0"), 1.5);
    assert!(quarter[8].distance(rest[8]) > 1.0, "at 1.5 s it is bent by 90°");
}

#[test]
#[ignore = "needs LOOKFROM_SHARED"]
fn the_fox_of_the_corpus_walks() {
    let rest = corpus("gltf/Fox/Fox.glb", None, None);
    let size = |places: &[DVec3]| {
        let [low, high] = [DVec3::min, DVec3::max].map(|f| places.iter().copied().reduce(f).unwrap());
        high - low
    };
    let mut before = rest.clone();
    for time in [0.1, 0.35, 0.6] {
        let walking = corpus("gltf/Fox/Fox.glb", Some("Walk"), time);
        assert_eq!(walking.len(), rest.len());
        // It moves, but stays as large as a fox, up to its tail and legs.
        let ratio = size(&walking) / size(&rest);
        assert!(ratio.min_element() > 0.6 && ratio.max_element() < 1.7, "{ratio}");
        let step = walking.iter().zip(&before).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        assert!(step > 1.0 && step < size(&rest).length() / 2.0, "{step}");
        before = walking;
    }
    // The last key holds on.
    let [end, later] = [0.75, 99.0].map(|time| corpus("gltf/Fox/Fox.glb", Some("Walk"), time));
    assert_eq!(end, later);
}

#[test]
#[ignore = "needs LOOKFROM_SHARED"]
fn the_simple_morph_of_the_corpus_is_raised() {
    let name = "assimp/glTF2/SimpleMorph/glTF/SimpleMorph.gltf";
    let rest = corpus(name, None, None);
    // Weights ½ and ½ of (−1, 1) and (1, 1) raise the tip from ½ to 1½; the animation begins with neither.
    near(rest[2], [0.5, 1.5, 0.0]);
    near(corpus(name, Some("0"), 0.0)[2], [0.5, 0.5, 0.0]);
}
