//! Scenes and models as scenes in our own format.

use std::path::Path;

use super::stage::Stage;

#[test]
fn what_is_written_has_the_same_picture() {
    let stage = Stage::new("convert-same");
    for (scene, options) in
        [("scene.toml", "--samples 3"), ("model.obj", "--size 24 --samples 2 --denoise off --floor")]
    {
        let run = stage.done(&format!("convert {scene} -o out/new.toml --force {options}"));
        assert!(run.stdout.is_empty() && run.stderr.contains("new.toml: "), "{}", run.stderr);
        stage.done(&format!("render {scene} -q -o before.pfm {options}"));
        stage.done("render out/new.toml -q -o after.pfm");
        assert_eq!(stage.bytes("before.pfm"), stage.bytes("after.pfm"), "{scene}");
    }
}

#[test]
fn a_scene_that_is_given_in_variables_has_their_values() {
    let stage = Stage::new("convert-variables");
    let scene = "[variables]\nr = 1\n[camera]\nlookfrom = [0, 1, 5]\nlookat = [0, 0, 0]\n[[sphere]]\nradius = \"= r / 3\"\n";
    stage.write("ball.toml", scene);
    stage.done("convert ball.toml -q -D r=2 -o two.toml");
    let text = String::from_utf8(stage.bytes("two.toml")).unwrap();
    assert!(text.contains("radius = 0.6666666666666666\n") && !text.contains("variables"), "{text}");
    assert!(!stage.names().contains(&"two".to_owned()), "no folder without files");
}

#[test]
fn nothing_is_overwritten_that_is_not_to_be() {
    let stage = Stage::new("convert-force");
    stage.write("other.toml", "mine");
    stage.run("convert scene.toml -o other.toml").fails(2, &["other.toml exists already", "--force"]);
    stage.run("convert scene.toml -o new.toml --samples 4..8").fails(2, &["--samples BEFORE"]);
    std::fs::create_dir(stage.path("taken")).unwrap();
    stage.run("convert scene.toml -o taken.toml").fails(2, &["taken exists already"]);
    stage.run("convert scene.toml -o scene.toml --force").fails(3, &["it is the scene itself"]);
    assert_eq!(stage.bytes("other.toml"), b"mine");
    stage.write("taken/mine.txt", "mine");
    stage.done("convert model.obj -q -o taken.toml --force");
    assert_eq!(stage.bytes("taken/mine.txt"), b"mine");
    // A file that the scene is read from is in the folder of the output.
    stage.write("taken/star.obj", &star());
    stage.done("convert taken/star.obj -q -o mesh.toml");
    let file = stage.bytes("mesh/star.ply");
    std::fs::write(stage.path("taken/star.ply"), &file).unwrap();
    stage.run("convert taken/star.ply -q -o taken.toml --force").fails(3, &["star.ply", "the scene itself"]);
    assert_eq!(stage.bytes("taken/star.ply"), file);
}

/// A model that is too large for the text.
fn star() -> String {
    let vertices = (0..20).map(|k| format!("v {} {} {}\n", k % 5, k / 5, (k * k) % 7));
    let faces = (1..18).map(|k| format!("f {} {} {}\n", k, k + 1, k + 2));
    vertices.chain(faces).collect()
}

#[test]
fn what_cannot_be_is_refused() {
    let stage = Stage::new("convert-refused");
    stage
        .run("convert scene.toml -o scene.png")
        .fails(2, &["scene.png is no name of a scene", "-o NAME.toml"]);
    stage.run("convert scene.toml -o new.toml --turn 20").fails(2, &["--turn turns a picture"]);
    stage.run("convert missing.pbrt -o new.toml").fails(1, &["missing.pbrt: no such file"]);
    assert!(!stage.names().contains(&"new.toml".to_owned()));
}

#[test]
fn files_stay_in_the_folder_of_the_output() {
    let stage = Stage::new("convert-escape");
    let gltf = r#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"name": "../../escape", "primitives": [{"attributes": {"POSITION": 0}, "mode": 4}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 15, "type": "VEC3", "min": [0, 0, 0], "max": [9, 9, 9]}],
        "bufferViews": [{"buffer": 0, "byteLength": 180}], "buffers": [{"byteLength": 180, "uri": "mesh.bin"}]}"#;
    stage.write("model.gltf", gltf);
    let numbers = (0..45_u32).flat_map(|k| ((k * k % 10) as f32).to_le_bytes());
    std::fs::write(stage.path("mesh.bin"), numbers.collect::<Vec<u8>>()).unwrap();
    stage.done("convert model.gltf -q -o new.toml --size 16 --samples 1");
    let mut names = std::fs::read_dir(stage.path("new")).unwrap().map(|entry| entry.unwrap().file_name());
    assert!(names.any(|name| name.to_string_lossy().ends_with(".ply")));
    let mut before = stage.names();
    before.retain(|name| {
        !["mesh.bin", "model.gltf", "model.obj", "new", "new.toml", "scene.toml"].contains(&&**name)
    });
    assert!(before.is_empty(), "{before:?}");
}

/// The document that the guide shows is the one that is written for the scene that it shows; `LOOKFROM_ACCEPT=1` puts it there.
#[test]
fn the_example_of_the_guide_is_what_is_written() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/guide/command.md");
    let guide = std::fs::read_to_string(&path).unwrap();
    let (before, rest) = guide.split_once("`ball.xml`,\n\n```xml\n").expect("the scene");
    let (scene, rest) = rest.split_once("```\n\nbecomes `ball.toml`:\n\n```toml\n").expect("its document");
    let (shown, after) = rest.split_once("```\n").expect("its end");
    let stage = Stage::new("convert-guide");
    stage.write("ball.xml", scene);
    stage.done("convert ball.xml -q -o ball.toml");
    let document = String::from_utf8(stage.bytes("ball.toml")).unwrap();
    if std::env::var_os("LOOKFROM_ACCEPT").is_some() {
        let parts = [
            before,
            "`ball.xml`,\n\n```xml\n",
            scene,
            "```\n\nbecomes `ball.toml`:\n\n```toml\n",
            &document,
            "```\n",
            after,
        ];
        std::fs::write(path, parts.concat()).unwrap();
        return;
    }
    assert_eq!(shown, document);
}
