//! The JSON Schema of `lookfrom inspect --json`: it accepts every report, and nothing else.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use jsonschema::Validator;
use serde_json::{Value, json};

use super::stage::Stage;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

fn schema() -> Value {
    let bytes = std::fs::read(root().join("docs/guide/inspect.schema.json")).unwrap();
    serde_json::from_slice(&bytes).unwrap()
}

/// A camera all around, lights that project pictures, a sensor, media: what no scene of the repository has.
const ODD: &str = r#"
Camera "spherical" "string mapping" "equalarea"
Film "rgb" "integer xresolution" 16 "integer yresolution" 16 "string filename" "odd.exr"
    "string sensor" "canon_eos_5d" "float iso" 200 "float whitebalance" 5000 "float maxcomponentvalue" 0.5
Integrator "path"
WorldBegin
LightSource "projection" "string filename" "t.png" "float scale" 9
LightSource "goniometric" "string filename" "square.png" "rgb I" [ 3 3 3 ]
LightSource "spot" "point3 from" [ 0 3 0 ] "point3 to" [ 0 0 0 ]
LightSource "distant" "rgb L" [ 1 1 1 ]
AttributeBegin
    AreaLightSource "diffuse" "rgb L" [ 5 5 5 ]
    Translate 0 4 0
    Shape "disk" "float radius" 1
AttributeEnd
AttributeBegin
    Material "dielectric" "float roughness" 0.3
    Shape "sphere" "float radius" 0.5
AttributeEnd
AttributeBegin
    Material "conductor" "float roughness" 0.3
    Shape "bilinearmesh" "point3 P" [ -4 -1 -4  4 -1 -4  -4 -1 4  4 -0.5 4 ]
    Shape "cylinder" "float radius" 2 "float zmin" -1 "float zmax" 1
    Shape "curve" "point3 P" [ 1 0 -2  1 1 -2  1 2 -2  1 3 -2 ] "float width" 0.5
AttributeEnd
"#;

/// A medium that scatters and shines, all around.
const FOG: &str = r#"
Integrator "volpath" "integer maxdepth" 8
Film "rgb" "integer xresolution" 16 "integer yresolution" 16
MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_a" [ 0.2 0.2 0.2 ] "rgb sigma_s" [ 0.5 0.4 0.3 ] "rgb Le" [ 1 2 3 ]
MediumInterface "" "fog"
LookAt 0 0 -3  0 0 0  0 1 0
Camera "perspective"
WorldBegin
LightSource "point" "point3 from" [ 1 1 -1 ] "rgb I" [ 2 2 2 ]
Shape "sphere"
"#;

/// A coarse mesh that stands for a smooth surface, as itself and as an instance.
const SMOOTH: &str = r#"
[camera]
lookfrom = [0, 1.5, -6]
lookat = [0, 0.5, 0]
fov = 40
[image]
width = 16
height = 10
[[light]]
type = "point"
position = [0, 5, -3]
intensity = 1
[[mesh]]
file = "roof.obj"
translate = [1.3, 0, 0]
[[instance]]
object = "one"
transform = [{ rotate = [0, 30, 0] }, { translate = [-1.3, 0, 0] }]
[[objects.one.mesh]]
file = "roof.obj"
"#;

/// What is inspected: a scene (of the repository where it has a folder), and options.
const INSPECTED: [&str; 33] = [
    "docs/guide/scenes/texture-far-ewa.toml 20 15 --width 40 --samples 1",
    "scenes/hero.toml 20 15 --width 40",
    "scenes/hero.toml 22 20 --width 40 --integrator path --samples 8 --sample worst",
    "scenes/hero.toml 22 20 --width 40 --integrator path --samples 8 --sample all",
    "scenes/hero.toml 20 15 --width 40 --samples 8 --sample 3..4",
    "scenes/hero.toml 330 300 --integrator path --sample 4",
    "scenes/hero.toml 22 20 --width 40 --integrator simple_path --ray 1",
    "scenes/hero.toml 22 20 --width 40 --integrator random_walk --bounce 1",
    "scenes/hero.toml 22 20 --width 40 --integrator ambient_occlusion --only lights",
    "scenes/hero.toml 22 20 --width 40 --integrator raycast",
    "scenes/hero.toml 22 20 --width 40 --integrator normals",
    "scenes/hero.toml 22 20 --width 40 --integrator depth",
    "scenes/hero.toml 22 20 --width 40 --integrator uv",
    "scenes/hero.toml 22 20 --width 40 --integrator id",
    "scenes/dispersion.toml 25 18 --width 50 --color spectral --samples 8 --sample worst",
    "docs/guide/scenes/material-gltf-dispersion-rgb.toml 10 9 --width 50 --samples 4 --sample 1",
    "scenes/instances.toml 20 15 --width 40",
    "scenes/cutouts.toml 20 20 --width 40 --integrator path --samples 4 --sample 3",
    "scenes/orthographic.toml 20 15 --width 40",
    "scenes/materials.toml 20 20 --width 40 --samples 2 --sample 1",
    "scenes/environment.toml 20 20 --width 40 --samples 2",
    "docs/guide/scenes/shape-disk.toml 8 11 --width 40",
    "docs/guide/scenes/camera-lens-system.toml 20 15 --width 40",
    "docs/guide/scenes/motion-blur.toml 20 10 --width 40",
    "docs/guide/scenes/material-gltf-volume.toml 20 15 --width 40 --integrator path",
    "docs/guide/scenes/material-subsurface.toml 20 14 --width 40 --samples 8 --sample 0",
    "scenes/star.pbrt 20 20 --width 40 --height 30 --samples 4 --sample 2",
    "model.obj 5 5 --size 10",
    "smooth.toml 5 5",
    "smooth.toml 10 5",
    "around.toml 5 5",
    "moving.toml 5 5",
    "metal.toml 8 8 --samples 4",
];

/// Every name of a property that a schema knows.
fn known(schema: &Value, names: &mut BTreeSet<String>) {
    if let Some(properties) = schema.get("properties").and_then(Value::as_object) {
        names.extend(properties.keys().cloned());
    }
    children(schema).into_iter().for_each(|child| known(child, names));
}

/// Every name of a property that has a value other than null.
fn used(document: &Value, names: &mut BTreeSet<String>) {
    if let Some(object) = document.as_object() {
        names.extend(object.iter().filter(|(_, value)| !value.is_null()).map(|(name, _)| name.clone()));
    }
    children(document).into_iter().for_each(|child| used(child, names));
}

fn children(value: &Value) -> Vec<&Value> {
    match value {
        Value::Object(object) => object.values().collect(),
        Value::Array(array) => array.iter().collect(),
        _ => Vec::new(),
    }
}

#[track_caller]
fn accepts(validator: &Validator, document: &Value, what: &str) {
    let errors: Vec<String> =
        validator.iter_errors(document).map(|error| format!("{}: {error}", error.instance_path())).collect();
    assert!(errors.is_empty(), "{what}: {errors:#?}");
}

#[test]
fn every_report_is_of_the_schema() {
    let schema = schema();
    jsonschema::meta::validate(&schema).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    let stage = Stage::new("schema");
    stage.write(
        "around.toml",
        "camera = { projection = \"equirectangular\", lookfrom = [0, 0, 0], lookat = [0, 0, 3] }\nsphere = [{ center = [0, 0, 3] }]",
    );
    stage.write(
        "metal.toml",
        "image = { width = 16, height = 16 }\ncamera = { lookfrom = [0, 0, 3], lookat = [0, 0, 0] }\nsphere = [{ material = \"gold\" }]\n[materials.gold]\ntype = \"conductor\"\nmetal = \"gold\"\nroughness = 0.8",
    );
    stage.write(
        "moving.toml",
        "camera = { lookfrom = [\"= t\", 0, 3], lookat = [0, 0, 0], shutter = 0.5 }\nsphere = [{}]",
    );
    stage.write("smooth.toml", SMOOTH);
    stage.write(
        "roof.obj",
        "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvn -0.3 -0.3 -1\nvn 0.3 -0.3 -1\nvn 0.3 0.3 -1\nvn -0.3 0.3 -1\n\
         f 1//1 4//4 3//3 2//2\n",
    );
    stage.write("odd.pbrt", ODD);
    stage.write("fog.pbrt", FOG);
    stage.write(
        "smoke.pbrt",
        &FOG.replace(
            "\"homogeneous\"",
            "\"uniformgrid\" \"float density\" 1 \"point3 p0\" [ -9 -9 -9 ] \"point3 p1\" [ 9 9 9 ]",
        ),
    );
    for (name, width) in [("t.png", 2), ("square.png", 1)] {
        let picture = lookfrom_scene::image::encode_png(width, 1, &[200; 6][..3 * width as usize]).unwrap();
        std::fs::write(stage.path(name), picture).unwrap();
    }
    let mut told = BTreeSet::new();
    let odd = [[2, 0], [10, 2], [5, 5], [12, 7], [8, 9], [3, 12]];
    let odd = odd.map(|[x, y]| format!("odd.pbrt {x} {y} --samples 4 --sample 1"));
    let fog = [0, 1, 2, 3].map(|sample| format!("fog.pbrt 7 7 --samples 4 --sample {sample}"));
    let smoke = [0, 1].map(|sample| format!("smoke.pbrt 7 7 --samples 4 --sample {sample}"));
    for inspected in INSPECTED.map(str::to_owned).into_iter().chain(odd).chain(fog).chain(smoke) {
        let path = if inspected.contains("/") { root().join(&inspected) } else { inspected.clone().into() };
        let document = stage.json_document(&format!("inspect {} --json", path.display()));
        accepts(&validator, &document, &inspected);
        used(&document, &mut told);
    }
    let mut names = BTreeSet::new();
    known(&schema, &mut names);
    let untold: Vec<_> = names.difference(&told).collect();
    assert!(untold.is_empty(), "no report has {untold:?}: {told:?}");
}

/// A document with one value in it replaced: `change` gets each value in turn.
fn changed(document: &Value, change: &dyn Fn(&Value) -> Vec<Value>) -> Vec<(String, Value)> {
    let mut all: Vec<(String, Value)> =
        change(document).into_iter().map(|value| (String::new(), value)).collect();
    let inside = |key: String, child: &Value, put: &dyn Fn(&mut Value, Value)| {
        let mut found = changed(child, change);
        for (path, value) in &mut found {
            let mut whole = document.clone();
            put(&mut whole, value.take());
            (*path, *value) = (format!("/{key}{path}"), whole);
        }
        found
    };
    match document {
        Value::Object(object) => {
            for (key, child) in object {
                all.extend(inside(key.clone(), child, &|whole, value| whole[key] = value));
            }
        }
        // Items of an array are alike.
        Value::Array(array) => {
            if let Some(child) = array.first() {
                all.extend(inside("0".into(), child, &|whole, value| whole[0] = value));
            }
        }
        _ => {}
    }
    all
}

#[test]
fn no_other_document_is_of_the_schema() {
    let validator = jsonschema::validator_for(&schema()).unwrap();
    let stage = Stage::new("schema-wrong");
    let wrong = |value: &Value| match value {
        Value::Object(object) => {
            let more = |key: &str| {
                let mut object = object.clone();
                object.insert(key.into(), json!(0));
                Value::Object(object)
            };
            let less = object.keys().map(|key| {
                let mut object = object.clone();
                object.remove(key);
                Value::Object(object)
            });
            less.chain([more("unknown"), json!([])]).collect()
        }
        Value::Array(_) => vec![json!({}), json!("")],
        Value::Bool(_) => vec![json!(0), json!("true")],
        Value::Number(_) | Value::String(_) | Value::Null => vec![json!(true), json!({})],
    };
    let mut documents = 0;
    for options in ["--integrator path", "--integrator whitted", "--sample all"] {
        let document = stage.json_document(&format!("inspect scene.toml 20 14 --json {options}"));
        accepts(&validator, &document, options);
        for (path, document) in changed(&document, &wrong) {
            assert!(!validator.is_valid(&document), "{options}: accepted, though {path} is wrong");
            documents += 1;
        }
    }
    assert!(documents > 500, "{documents}");
}
