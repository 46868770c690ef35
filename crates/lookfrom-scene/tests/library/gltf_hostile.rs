//! Broken glTF files of any kind: never a panic, never a mesh that breaks its promises.

use std::path::{Path, PathBuf};

use lookfrom_scene::material::Color;
use lookfrom_scene::medium::Extinction;
use lookfrom_scene::shape::Geometry;
use lookfrom_scene::{LoadContext, Memory, Scene, load};
use proptest::prelude::*;

/// A file with something of everything; its buffer is `binary`, in the container.
const JSON: &str = r#"{
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 2, 3, 4]}],
    "extensionsUsed": ["KHR_lights_punctual", "EXT_mesh_gpu_instancing", "KHR_texture_transform", "KHR_animation_pointer"],
    "extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot", "intensity": 3, "spot": {"innerConeAngle": 0.1}}]}},
    "nodes": [
        {"children": [1], "rotation": [0, 0, 0, 1], "scale": [1, -1, 1]}, {"mesh": 0, "translation": [1, 2, 3]},
        {"mesh": 1, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]},
        {"camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"mesh": 1, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 0}}}}
    ],
    "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "aspectRatio": 1.5, "znear": 0.1}}],
    "meshes": [
        {"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 0, "TEXCOORD_0": 1, "COLOR_0": 2}, "indices": 3, "material": 0}]},
        {"primitives": [{"attributes": {"POSITION": 0}, "mode": 1}, {"attributes": {"POSITION": 0}, "mode": 0},
            {"attributes": {"POSITION": 4}, "mode": 6, "material": 1}]}
    ],
    "materials": [
        {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"rotation": 1}}}},
            "alphaMode": "MASK", "emissiveFactor": [1, 0, 0], "normalTexture": {"index": 0}},
        {"extensions": {"KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [0, 1, 1]},
            "KHR_materials_volume_scatter": {"multiscatterColor": [0.5, 1, 0], "scatterAnisotropy": 0.5},
            "KHR_materials_anisotropy": {"anisotropyStrength": 0.5}}}
    ],
    "textures": [{"source": 0, "sampler": 0}], "samplers": [{"wrapS": 33071}],
    "images": [{"uri": "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="}],
    "accessors": [
        {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
        {"bufferView": 0, "byteOffset": 4, "componentType": 5126, "count": 4, "type": "VEC2"},
        {"bufferView": 1, "componentType": 5121, "normalized": true, "count": 4, "type": "VEC4"},
        {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"},
        {"componentType": 5126, "count": 4, "type": "VEC3", "sparse": {"count": 2,
            "indices": {"bufferView": 2, "componentType": 5121, "byteOffset": 1}, "values": {"bufferView": 0, "byteOffset": 12}}},
        {"bufferView": 0, "componentType": 5126, "count": 2, "type": "SCALAR"},
        {"bufferView": 0, "componentType": 5126, "count": 2, "type": "VEC3"}
    ],
    "animations": [{"samplers": [{"input": 5, "output": 6}, {"input": 5, "output": 5, "interpolation": "STEP"}], "channels": [
        {"sampler": 0, "target": {"node": 1, "path": "scale"}},
        {"sampler": 0, "target": {"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": "/materials/0/emissiveFactor"}}}},
        {"sampler": 1, "target": {"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": "/cameras/0/perspective/yfov"}}}}
    ]}],
    "bufferViews": [{"buffer": 0, "byteLength": 48, "byteStride": 12}, {"buffer": 0, "byteOffset": 48, "byteLength": 16},
        {"buffer": 0, "byteOffset": 64, "byteLength": 12}],
    "buffers": [{"byteLength": 76}]
}"#;

fn binary() -> Vec<u8> {
    let positions = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];
    let mut bytes: Vec<u8> = positions.into_iter().flat_map(f32::to_le_bytes).collect();
    bytes.extend([255, 0, 0, 255, 0, 255, 0, 128, 0, 0, 255, 0, 9, 9, 9, 9]);
    bytes.extend([0_u16, 1, 2, 2, 3, 0].into_iter().flat_map(u16::to_le_bytes));
    bytes
}

fn container(json: &str, binary: &[u8]) -> Vec<u8> {
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    glb.extend((28 + json.len() as u32 + binary.len() as u32).to_le_bytes());
    glb.extend((json.len() as u32).to_le_bytes());
    glb.extend(b"JSON");
    glb.extend(json.as_bytes());
    glb.extend((binary.len() as u32).to_le_bytes());
    glb.extend(b"BIN\0");
    glb.extend(binary);
    glb
}

/// Reads a file and checks what the types promise; whether it could be read.
fn read(content: Vec<u8>) -> bool {
    let memory = Memory([(PathBuf::from("a.glb"), content)].into());
    let mut context = LoadContext::new(&memory);
    context.limits.elements = 1 << 16;
    context.limits.texels = 1 << 16;
    context.import.at = Some(0.75);
    match load::scene(Path::new("a.glb"), &mut context) {
        Ok(scene) => {
            check(&scene);
            true
        }
        Err(error) => {
            assert!(error.to_string().starts_with("a.glb"), "{error}");
            false
        }
    }
}

fn check(scene: &Scene) {
    for mesh in &scene.meshes {
        let count = mesh.positions.len();
        assert!(mesh.positions.iter().all(|position| position.is_finite()));
        assert!(mesh.triangles.iter().flatten().all(|&vertex| (vertex as usize) < count));
        assert!(mesh.normals.is_empty() || mesh.normals.len() == count);
        assert!(mesh.uvs.is_empty() || mesh.uvs.len() == count);
        assert!(mesh.colors.is_empty() || mesh.colors.len() == count);
        assert!(mesh.opacities.is_empty() || mesh.opacities.len() == count);
        assert!(mesh.tangents.is_empty() || mesh.tangents.len() == count);
        assert!(mesh.normals.iter().all(|normal| normal.is_finite()));
        assert!(mesh.uvs.iter().all(|uv| uv.is_finite()));
        assert!(mesh.colors.iter().flatten().all(|color| color.is_finite()));
    }
    let objects = scene.objects.iter().flat_map(|object| &object.shapes);
    for shape in scene.shapes.iter().chain(objects) {
        assert!(shape.material.index() < scene.materials.len());
        assert!(shape.world_from_object.is_finite() && shape.world_from_object.inverse().is_finite());
        match &shape.geometry {
            Geometry::Mesh(id) => assert!(id.index() < scene.meshes.len()),
            Geometry::Spheres(spheres) => {
                assert!(
                    spheres.iter().all(|s| s.center.is_finite() && s.radius > 0.0 && s.radius.is_finite())
                );
            }
            Geometry::Curves(strands) => {
                assert!(strands.iter().all(|s| s.points.iter().all(|p| p.is_finite()) && s.width[0] > 0.0));
            }
            other => panic!("{other:?}"),
        }
    }
    for medium in &scene.media {
        assert!(medium.g.abs() < 1.0);
        let Extinction::Parts { absorption, scattering } = medium.extinction else { panic!("{medium:?}") };
        for color in [absorption, scattering] {
            let Color::Value(rgb) = color else { panic!("{color:?}") };
            assert!(rgb.into_iter().all(|sigma| sigma.is_finite() && sigma >= 0.0), "{rgb:?}");
        }
    }
    assert!(scene.instances.iter().all(|instance| instance.world_from_object.inverse().is_finite()));
}

#[test]
fn the_seed_is_good() {
    assert!(read(container(JSON, &binary())));
}

#[test]
fn a_file_may_end_anywhere() {
    let whole = container(JSON, &binary());
    for length in 0..whole.len() {
        assert!(
            !read(whole[..length].to_vec()) || length + 4 >= whole.len(),
            "{length} bytes are not enough"
        );
    }
    for length in 0..JSON.len() {
        read(JSON.as_bytes()[..length].to_vec());
    }
}

#[test]
fn every_number_may_be_another() {
    let numbers: Vec<(usize, usize)> = {
        let is_number = |byte: u8| byte.is_ascii_digit() || byte == b'.' || byte == b'-';
        let bytes = JSON.as_bytes();
        let starts = (1..bytes.len()).filter(|&i| is_number(bytes[i]) && b" [,:".contains(&bytes[i - 1]));
        starts.map(|start| (start, (start..).take_while(|&i| is_number(bytes[i])).count())).collect()
    };
    assert!(numbers.len() > 100);
    for (start, length) in numbers {
        for other in [
            "0",
            "-1",
            "1",
            "5",
            "70000",
            "4294967295",
            "18446744073709551615",
            "1e30",
            "1e300",
            "-1e300",
            "0.5",
            "null",
            "{}",
            "\"a\"",
        ] {
            let json = [&JSON[..start], other, &JSON[start + length..]].concat();
            read(container(&json, &binary()));
        }
    }
}

#[test]
fn deep_nests_and_long_chains_are_survived() {
    for (open, close) in [("[", "]"), ("{\"a\":", "}")] {
        let deep = format!("{}1{}", open.repeat(100_000), close.repeat(100_000));
        read(deep.clone().into_bytes());
        read(format!("{{\"asset\": {{\"version\": \"2.0\"}}, \"extras\": {deep}}}").into_bytes());
        read(format!("{{\"asset\": {{\"version\": \"2.0\"}}, \"nodes\": {deep}}}").into_bytes());
    }
    let chain: Vec<String> = (1..50_000).map(|i| format!("{{\"children\": [{i}]}}")).collect();
    let json = format!("{{\"asset\": {{\"version\": \"2.0\"}}, \"nodes\": [{}, {{}}]}}", chain.join(","));
    assert!(read(json.into_bytes()));
}

#[test]
fn one_accessor_cannot_be_asked_for_without_end() {
    let zeros = r#"{"componentType": 5126, "count": 60000, "type": "VEC3"}"#;
    let primitives = vec![r#"{"attributes": {"POSITION": 0}}"#; 5000].join(",");
    let json = format!(
        r#"{{"asset": {{"version": "2.0"}}, "accessors": [{zeros}], "meshes": [{{"primitives": [{primitives}]}}], "nodes": [{{"mesh": 0}}]}}"#
    );
    assert!(!read(json.into_bytes()), "5000 · 60000 vertices are more than the limit");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn damaged_files_are_survived(places in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8)) {
        let mut content = container(JSON, &binary());
        for (place, byte) in places {
            let place = place.index(content.len());
            content[place] = byte;
        }
        read(content);
    }

    #[test]
    fn damaged_numbers_are_survived(places in prop::collection::vec((0_usize..76, any::<u8>()), 1..16)) {
        let mut binary = binary();
        for (place, byte) in places {
            binary[place] = byte;
        }
        read(container(JSON, &binary));
    }

    #[test]
    fn parts_may_change_places(a in any::<prop::sample::Index>(), b in any::<prop::sample::Index>(), length in 0_usize..200) {
        let (a, b) = (a.index(JSON.len()), b.index(JSON.len()));
        let piece = &JSON.as_bytes()[a..(a + length).min(JSON.len())];
        let json = [&JSON.as_bytes()[..b], piece, &JSON.as_bytes()[b..]].concat();
        read(container(&String::from_utf8_lossy(&json), &binary()));
    }
}
