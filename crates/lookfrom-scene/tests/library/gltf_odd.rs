//! glTF files as they come: older ones, pointers in place of models, names from other systems, extensions half known.

use std::path::{Path, PathBuf};

use lookfrom_scene::files::ImportOptions;
use lookfrom_scene::image::encode_png;
use lookfrom_scene::shape::Geometry;
use lookfrom_scene::{Disk, Files, LoadContext, Memory, Result, Scene, load};

type Read = Result<(Scene, Vec<String>)>;

fn read_by(name: &str, files: &dyn Files, choice: ImportOptions) -> Read {
    let mut context = LoadContext { import: choice, ..LoadContext::new(files) };
    let scene = load::scene(Path::new(name), &mut context)?;
    Ok((scene, context.warnings.iter().map(ToString::to_string).collect()))
}

fn read<const N: usize>(files: [(&str, &[u8]); N]) -> Read {
    let memory = Memory(files.map(|(name, content)| (PathBuf::from(name), content.to_vec())).into());
    read_by(files[0].0, &memory, ImportOptions::default())
}

/// The error of one file.
fn error(name: &str, content: &[u8]) -> String {
    let error = read([(name, content)]).map(|(_, warnings)| warnings).expect_err("it is not valid");
    format!("{error}")
}

/// A GLB container with this JSON.
fn container(json: &[u8]) -> Vec<u8> {
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((20 + json.len() as u32).to_le_bytes());
    bytes.extend((json.len() as u32).to_le_bytes());
    bytes.extend(b"JSON");
    bytes.extend(json);
    bytes
}

/// Three vertices at (0, 0, 0), (1, 0, 0), (0, 1, 0), and what else the file says.
fn triangle(rest: &str) -> String {
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
        "buffers": [{{"byteLength": 36, "uri": "data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}}], {rest}}}"#
    )
}

#[test]
fn the_first_version_is_told_by_name() {
    // There, nodes have names in place of numbers: that they are no numbers is not what is wrong.
    let old = br#"{"asset": {"version": "1.0"}, "scene": "all", "scenes": {"all": {"nodes": ["box"]}}}"#;
    let message = error("a.gltf", old);
    assert!(message.starts_with("a.gltf#/asset/version: glTF 1.0 is not read, only glTF 2.0"), "{message}");
    // In a file of the second version it is.
    let message = error("a.gltf", br#"{"asset": {"version": "2.0"}, "scene": "all"}"#);
    assert!(message.starts_with("a.gltf#/scene: "), "{message}");
}

#[test]
fn what_stands_in_place_of_a_model_is_told() {
    let pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 12\n";
    assert!(error("a.glb", pointer).contains("`git lfs pull`"));
    let first = error("a.gltf", br#"{"asset": {"version": 1}, "scene": "all"}"#);
    assert!(first.contains("glTF 1 is not read, only glTF 2.0"), "{first}");
    assert!(error("a.glb", b"<!DOCTYPE html><html></html>").contains("web page"));
    assert!(error("a.gltf", b"").starts_with("a.gltf: the file is empty"));
    assert!(error("a.gltf", b" \n").starts_with("a.gltf: the file contains only spaces"));
    assert!(error("a.glb", &container(b"")).starts_with("a.glb: the JSON of the GLB container is empty"));
    let zeros = error("a.glb", &container(&[0; 8]));
    assert!(
        zeros.starts_with("a.glb: the JSON of the GLB container contains only spaces and zeros"),
        "{zeros}"
    );
}

#[test]
fn names_from_windows_are_found() {
    let file = triangle(
        r#""meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}], "images": [{"uri": "maps\\red%20one.png"}]"#,
    );
    let png = encode_png(1, 1, &[255, 0, 0]).expect("it is a picture");
    let (scene, warnings) =
        read([("m/a.gltf", file.as_bytes()), ("m/maps/red one.png", &png)]).expect("it is valid");
    assert_eq!(warnings, Vec::<String>::new());
    assert_eq!((scene.images.len(), scene.images[0].width), (1, 1));
    // Without the picture, the name is told as it stands in the file.
    let (_, warnings) = read([("m/a.gltf", file.as_bytes())]).expect("it is valid");
    assert!(warnings.len() == 1 && warnings[0].contains(r"maps\red one.png: no such file"), "{warnings:?}");
}

#[test]
fn zeros_that_no_bytes_stand_for_have_a_limit() {
    let accessors = |count: u64| {
        format!(
            r#"{{"asset": {{"version": "2.0"}}, "nodes": [{{"mesh": 0}}], "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
            "accessors": [{{"componentType": 5126, "count": {count}, "type": "VEC3"}}]}}"#
        )
    };
    assert!(read([("a.gltf", accessors(1000).as_bytes())]).is_ok());
    let message = error("a.gltf", accessors(1 << 29).as_bytes());
    assert!(message.contains("536870912 elements without a buffer view"), "{message}");
}

#[test]
fn instances_at_one_place_are_one() {
    let file = triangle(
        r#""meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "extensionsUsed": ["EXT_mesh_gpu_instancing"]"#,
    );
    let instanced = file
        .replace(
            r#""type": "VEC3"}]"#,
            r#""type": "VEC3"}, {"componentType": 5126, "count": 1000000, "type": "VEC3"}]"#,
        )
        .replace(
            r#"[{"mesh": 0}]"#,
            r#"[{"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 1}}}}]"#,
        );
    let (scene, warnings) = read([("a.gltf", instanced.as_bytes())]).expect("it is valid");
    assert_eq!((scene.instances.len(), warnings), (1, vec![]));
}

#[test]
fn what_is_beyond_all_numbers_of_rays_is_left_out() {
    let file = triangle(r#""meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}]"#);
    let far = file.replace(
        r#""scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}]"#,
        r#""scenes": [{"nodes": [0, 1]}], "nodes": [{"mesh": 0, "translation": [1e300, 0, 0]}, {"mesh": 0}]"#,
    );
    assert!(far != file);
    let (scene, warnings) = read([("a.gltf", far.as_bytes())]).expect("it is valid");
    assert_eq!(scene.shapes.len(), 1);
    assert!(
        warnings.len() == 1 && warnings[0].starts_with("a.gltf#/nodes/0: the node is too far"),
        "{warnings:?}"
    );
}

#[test]
fn pointers_of_animations_to_nothing_are_told_of() {
    // The accessor of positions has the numbers 0 0 0, 1 0 0, 0 1 0; that of times has none in the file: zeros.
    let at_once = |pointer: &str| {
        let file = triangle(&format!(
            r#""meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}], "materials": [{{"name": "a"}}],
            "animations": [{{"samplers": [{{"input": 1, "output": 0}}],
            "channels": [{{"sampler": 0, "target": {{"path": "pointer", "extensions": {{"KHR_animation_pointer": {{"pointer": "{pointer}"}}}}}}}}]}}]"#
        ));
        let file = file.replace(
            r#""type": "VEC3"}]"#,
            r#""type": "VEC3"}, {"componentType": 5126, "count": 3, "type": "SCALAR"}]"#,
        );
        let memory = Memory([(PathBuf::from("a.gltf"), file.into_bytes())].into());
        let choice = ImportOptions { at: Some(0.5), ..ImportOptions::default() };
        read_by("a.gltf", &memory, choice).expect("it is valid").1
    };
    assert_eq!(at_once("/materials/0/emissiveFactor"), Vec::<String>::new());
    let still = |named: &str| {
        format!(
            "a.gltf#/animations/0/channels/0: {named:?} cannot take the channel's values, and stays as it is"
        )
    };
    let nowhere =
        ["", "/", "x", "/asset/version", "/accessors/0/count", "/meshes/0", "/materials/1/emissiveFactor"];
    for pointer in nowhere.into_iter().chain(["/materials/0/name", "/nodes/0/mesh"]) {
        assert_eq!(at_once(pointer), [still(pointer)]);
    }
    // What the file does not have could take any numbers, but the item is not read with them.
    for property in ["alphaCutoff", "doubleSided", "pbrMetallicRoughness/baseColorFactor", "alphaMode/a"] {
        assert_eq!(at_once(&format!("/materials/0/{property}")), [still("/materials/0")]);
    }
}

/// The extension allows strips, but compressed streams have triangles one by one.
#[cfg(feature = "draco")]
#[test]
fn a_compressed_mesh_is_made_of_triangles_even_where_strips_are_announced() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/guide/scenes/gltf");
    let path = folder.join("draco-compression.gltf");
    let file = std::fs::read_to_string(&path).expect("the guide has it");
    let (listed, _) =
        read_by(&path.display().to_string(), &Disk, ImportOptions::default()).expect("it is valid");
    let strips = file.replace(r#""indices": 5,"#, r#""indices": 5, "mode": 5,"#);
    assert!(strips != file);
    let (announced, _) = read([("a.gltf", strips.as_bytes())]).expect("it is valid");
    let triangles = |scene: &Scene| {
        let Geometry::Mesh(id) = scene.shapes[1].geometry else { panic!("no mesh") };
        scene.meshes[id.index()].triangles.clone()
    };
    assert_eq!(triangles(&announced), triangles(&listed));
    assert!(triangles(&listed).len() > 2000);
}

#[test]
fn colours_above_one_are_told_of() {
    let warnings = |material: &str| {
        let mesh = r#""meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}]"#;
        let text = triangle(&format!(r#"{mesh}, "materials": [{material}]"#));
        read([("a.gltf", text.as_bytes())]).expect("it is read").1
    };
    let found = warnings(r#"{"pbrMetallicRoughness": {"baseColorFactor": [255, 128, 0, 1]}}"#);
    let at = "a.gltf#/materials/0/pbrMetallicRoughness/baseColorFactor: the factor is [255, 128, 0]";
    assert!(found.len() == 1 && found[0].starts_with(at), "{found:?}");
    let sheen = r#"{"extensions": {"KHR_materials_sheen": {"sheenColorFactor": [2, 0, 0]}}}"#;
    let found = warnings(sheen);
    assert!(found.len() == 1 && found[0].contains("/sheenColorFactor: the factor is [2, 0, 0]"), "{found:?}");
    assert!(warnings(r#"{"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 0, 1]}}"#).is_empty());
}

/// Every number that the schema has limits for.
#[test]
fn factors_out_of_range_are_told_of() {
    let told = |material: String| {
        let mesh = r#""meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}]"#;
        let text = triangle(&format!(r#"{mesh}, "materials": [{material}]"#));
        read([("a.gltf", text.as_bytes())]).expect("it is read").1
    };
    let one = |found: Vec<String>, place: &str, what: &str| {
        let expected = format!("a.gltf#/materials/0{place}: {what}");
        assert!(found.len() == 1 && found[0].starts_with(&expected), "{expected}: {found:?}");
    };
    for (group, key, values) in [
        ("pbrMetallicRoughness", "metallicFactor", &[2.0, -1.0][..]),
        ("pbrMetallicRoughness", "roughnessFactor", &[2.0, -1.0]),
        ("KHR_materials_specular", "specularFactor", &[2.0, -1.0]),
        ("KHR_materials_transmission", "transmissionFactor", &[2.0, -1.0]),
        ("KHR_materials_volume", "thicknessFactor", &[-1.0]),
        ("KHR_materials_volume", "attenuationDistance", &[0.0, -1.0]),
        ("KHR_materials_dispersion", "dispersion", &[-1.0]),
        ("KHR_materials_clearcoat", "clearcoatFactor", &[3.0, -1.0]),
        ("KHR_materials_clearcoat", "clearcoatRoughnessFactor", &[3.0, -1.0]),
        ("KHR_materials_sheen", "sheenRoughnessFactor", &[3.0, -1.0]),
        ("KHR_materials_iridescence", "iridescenceFactor", &[3.0, -1.0]),
        ("KHR_materials_iridescence", "iridescenceIor", &[0.5]),
        ("KHR_materials_iridescence", "iridescenceThicknessMaximum", &[-1.0]),
        ("KHR_materials_iridescence", "iridescenceThicknessMinimum", &[-1.0]),
        ("KHR_materials_anisotropy", "anisotropyStrength", &[3.0, -1.0]),
        ("KHR_materials_diffuse_transmission", "diffuseTransmissionFactor", &[3.0, -1.0]),
        ("KHR_materials_emissive_strength", "emissiveStrength", &[-1.0]),
        ("KHR_materials_pbrSpecularGlossiness", "glossinessFactor", &[3.0, -1.0]),
    ] {
        for value in values {
            let of = format!(r#""{group}": {{"{key}": {value}}}"#);
            let (text, place) = match group.starts_with("KHR") {
                true => (format!(r#"{{"extensions": {{{of}}}}}"#), format!("/extensions/{group}/{key}")),
                false => (format!("{{{of}}}"), format!("/{group}/{key}")),
            };
            one(told(text), &place, "the ");
        }
    }
    one(
        told(r#"{"emissiveFactor": [-1, 0, 0]}"#.to_owned()),
        "/emissiveFactor",
        "the value is -1; expected at least 0",
    );
    let cut = r#"{"alphaMode": "MASK", "alphaCutoff": -1}"#.to_owned();
    one(told(cut), "/alphaCutoff", "the value is -1");
    let opaque = r#"{"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 2]}}"#.to_owned();
    one(told(opaque), "/pbrMetallicRoughness/baseColorFactor", "the factor is 2; expected 0 to 1");
    let color = r#"{"extensions": {"KHR_materials_volume": {"attenuationColor": [0, 2, 0], "attenuationDistance": 1}}}"#;
    one(
        told(color.to_owned()),
        "/extensions/KHR_materials_volume/attenuationColor",
        "the factor is [0, 2, 0]",
    );
    // What has no upper limit.
    let strong = r#"{"emissiveFactor": [1, 1, 1], "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 500}}}"#;
    assert_eq!(told(strong.to_owned()), Vec::<String>::new());
}
