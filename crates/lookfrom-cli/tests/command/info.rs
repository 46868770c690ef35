//! `lookfrom info`, `completions` and `--version`.

use serde_json::json;

use super::stage::Stage;

#[test]
fn a_scene_in_words() {
    let stage = Stage::new("info");
    let run = stage.done("info scene.toml");
    let text = String::from_utf8(run.stdout).unwrap();
    for word in ["1 quad, 1 sphere", "1 point", "lookfrom 0,1,5", "fov 40°", "40 × 30", "whitted", "1 node"]
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
fn a_mesh_is_closed_or_not() {
    let stage = Stage::new("info-watertight");
    let corners = "v 0 0 0\nv 3 0 0\nv 0 4 0\nv 0 0 5\n";
    let closed = format!("{corners}f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
    for (name, text, expected) in [
        ("closed", closed.clone(), "yes, volume 10"),
        (
            "inwards",
            closed
                .replace("1 3 2", "1 2 3")
                .replace("1 2 4", "1 4 2")
                .replace("2 3 4", "2 4 3")
                .replace("1 4 3", "1 3 4"),
            "yes, but faces look inwards: volume -10",
        ),
        ("open", closed.replace("f 1 4 3\n", ""), "no: 3 edges open"),
        ("turned", closed.replace("1 4 3", "1 3 4"), "no: 3 edges between faces that look to opposite sides"),
    ] {
        stage.write(&format!("{name}.obj"), &text);
        let told = String::from_utf8(stage.done(&format!("info {name}.obj")).stdout).unwrap();
        assert!(told.contains(&format!("  watertight {expected}\n")), "{told}");
    }
    let found = &stage.json("info open.obj --json")[0]["watertight"];
    assert_eq!(
        (&found["is_closed"], &found["open_edges"], &found["turned_edges"]),
        (&json!(false), &json!(3), &json!(0))
    );
    assert_eq!(stage.json("info scene.toml --json")[0]["watertight"], json!(null));
}

#[test]
fn a_file_of_another_program_is_refused_with_a_way() {
    let stage = Stage::new("info-foreign");
    for (name, way) in [
        ("part.3MF", "slicer"),
        ("part.step", "FreeCAD"),
        ("part.scad", "openscad -o"),
        ("part.fbx", "Blender"),
    ] {
        stage.write(name, "?");
        stage.run(&format!("render {name}")).fails(1, &["there is no reader for", way, "what can be read"]);
    }
}

#[test]
fn objects_have_their_names() {
    let stage = Stage::new("info-names");
    let names: Vec<String> = (1..=9).map(|number| format!("Part {number}")).collect();
    let object = |(x, name): (usize, &String)| {
        format!("v {x} 0 0\nv {x} 1 0\nv {x} 1 1\no {name}\nusemtl red\nf -3 -2 -1\n")
    };
    stage.write("parts.obj", &names.iter().enumerate().map(object).collect::<String>());
    assert_eq!(stage.json("info parts.obj --json")[0]["names"], json!(names));
    let text = String::from_utf8(stage.done("info parts.obj").stdout).unwrap();
    let listed = format!("  names      9: {}, …\n", names[..8].join(", "));
    assert!(text.contains(&listed), "{text}");
}

/// Two of everything that a person can choose from.
const CHOICES: &str = r#"{"asset":{"version":"2.0"},"scene":1,"scenes":[{"nodes":[]},{"name":"Hall","nodes":[0,1,2]}],
"nodes":[{"mesh":0},{"name":"Front","camera":0,"translation":[0,0,3]},{"camera":1,"translation":[0,0,3]}],
"cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":1}},{"name":"Plan","type":"orthographic","orthographic":{"xmag":2,"ymag":1.5,"znear":1,"zfar":2}}],
"animations":[{"name":"Walk","samplers":[{"input":1,"output":1}],"channels":[]},{"channels":[],"samplers":[]}],
"extensionsUsed":["KHR_materials_variants"],"extensions":{"KHR_materials_variants":{"variants":[{"name":"Oak"},{"name":"Steel"}]}},
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},{"bufferView":0,"byteOffset":8,"componentType":5126,"count":2,"type":"SCALAR"}]}"#;

#[test]
fn what_can_be_chosen_is_listed() {
    let stage = Stage::new("info-choices");
    stage.write("hall.gltf", CHOICES);
    let text = String::from_utf8(stage.done("info hall.gltf").stdout).unwrap();
    for line in [
        "  scenes     0, 1 \"Hall\" (this one)",
        "  animations 0 \"Walk\" 1 s, 1 without keys",
        "  variants   0 \"Oak\", 1 \"Steel\"",
        "  cameras    0 \"Front\" (perspective, fov 57.2958°), 1 \"Plan\" (orthographic, height 3)",
    ] {
        assert!(text.lines().any(|found| found == line), "{line:?} is not in: {text}");
    }
    let object = &stage.json("info hall.gltf --json")[0];
    let scenes = json!([{ "name": null, "shown": false }, { "name": "Hall", "shown": true }]);
    assert_eq!(object["scenes"], scenes);
    assert_eq!(
        object["animations"],
        json!([{ "name": "Walk", "seconds": 1.0 }, { "name": null, "seconds": null }])
    );
    assert_eq!(object["variants"], json!(["Oak", "Steel"]));
    assert_eq!(object["cameras"][1], json!({ "name": "Plan", "projection": "orthographic", "height": 3.0 }));
    assert_eq!(object["cameras"][0]["projection"], "perspective");
    assert_eq!(object["camera"]["projection"], "perspective");
    // A file of another format has none of this.
    let model = &stage.json("info model.obj --json")[0];
    assert_eq!((&model["animations"], &model["cameras"]), (&json!([]), &json!([])));
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
