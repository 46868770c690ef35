//! Errors and warnings.

use std::path::{Path, PathBuf};

use lookfrom_scene::{LoadContext, Memory, load};
use serde_json::{Value, json};

use super::{Model, one};

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
