//! `lookfrom info`, `completions` and `--version`.

use serde_json::json;

use super::stage::Stage;

#[test]
fn a_scene_in_words() {
    let stage = Stage::new("info");
    let run = stage.done("info scene.toml");
    let text = String::from_utf8(run.stdout).unwrap();
    for word in ["1 quad, 1 sphere", "1 point", "lookfrom 0,1,5", "fov 40°", "40 × 30", "whitted", "nodes"]
    {
        assert!(text.contains(word), "{word:?} is not in: {text}");
    }
    assert!(run.stderr.is_empty());
}

#[test]
fn a_scene_as_json() {
    let stage = Stage::new("info-json");
    let scene = &stage.json("info scene.toml --json")[0];
    assert_eq!(scene["shapes"], json!({ "quad": 1, "sphere": 1 }));
    assert_eq!(scene["lights"], json!({ "point": 1 }));
    assert_eq!((&scene["triangles"], &scene["spheres"]), (&json!(2), &json!(1)));
    assert_eq!(scene["bounds"], json!({ "min": [-5.0, 0.0, -5.0], "max": [5.0, 1.0, 5.0] }));
    assert_eq!(scene["camera"]["lookfrom"], json!([0.0, 1.0, 5.0]));
    assert_eq!(scene["image"]["width"], 40);
    assert_eq!(scene["render"]["samples"], 4);
    assert!(scene["bvh"]["nodes"].as_u64().unwrap() > 0);
    assert_eq!(scene["added"], json!([]));
}

#[test]
fn a_model_says_what_was_added() {
    let stage = Stage::new("info-model");
    let objects = stage.json("info scene.toml model.obj --json");
    let model = &objects[1];
    assert_eq!(model["added"], json!(["camera", "lights"]));
    assert_eq!((&model["triangles"], &model["vertices"]), (&json!(1), &json!(3)));
    assert_eq!(model["bounds"]["max"], json!([1.0, 1.0, 0.0]));
}

#[test]
fn versions_and_completions() {
    let stage = Stage::new("version");
    let version = stage.done("--version").stdout;
    assert_eq!(String::from_utf8(version).unwrap(), format!("lookfrom {}\n", env!("CARGO_PKG_VERSION")));
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = String::from_utf8(stage.done(&format!("completions {shell}")).stdout).unwrap();
        assert!(script.contains("min-contribution"), "{shell}");
    }
}
