//! `lookfrom render` when all goes well.

use std::path::Path;

use lookfrom_scene::image::{self, Image};
use lookfrom_scene::{Disk, LoadContext};

use super::stage::Stage;

fn colors(path: &Path) -> Vec<[f32; 3]> {
    picture(path).texels().collect()
}

fn picture(path: &Path) -> Image {
    image::read(path, &mut LoadContext::new(&Disk)).unwrap_or_else(|error| panic!("{error}"))
}

fn size(stage: &Stage, name: &str) -> (u32, u32) {
    let picture = picture(&stage.path(name));
    (picture.width, picture.height)
}

fn attribute(stage: &Stage, file: &str, name: &str) -> Option<String> {
    let found = image::read_exr(&stage.path(file), &mut LoadContext::new(&Disk)).unwrap();
    found.attributes.into_iter().find(|(found, _)| found == name).map(|(_, text)| text)
}

#[test]
fn a_picture_by_the_name_of_the_scene() {
    let stage = Stage::new("default");
    let run = stage.done("render scene.toml");
    assert!(run.stdout.is_empty());
    for word in ["scene.toml → scene.png", "40 × 30", "4 samples", "whitted", "Mrays/s", "shadow"] {
        assert!(run.stderr.contains(word), "{word:?} is not in: {}", run.stderr);
    }
    assert_eq!(size(&stage, "scene.png"), (40, 30));
    assert_eq!(stage.names(), ["model.obj", "scene.png", "scene.toml"], "nothing else is left behind");
}

#[test]
fn every_format_holds_the_same_light() {
    let stage = Stage::new("formats");
    for extension in ["exr", "pfm", "hdr", "png", "ppm", "webp"] {
        stage.done(&format!("render scene.toml -q -o p.{extension}"));
    }
    for extension in ["png", "exr"] {
        stage.done(&format!("render scene.toml -q --bits 16 -o p16.{extension}"));
    }
    let exact = colors(&stage.path("p.exr"));
    assert!(exact.iter().flatten().any(|&value| value > 0.1), "the picture is black");
    for (name, step) in [
        ("p.pfm", 0.0),
        ("p.hdr", 0.01),
        ("p.png", 0.01),
        ("p.ppm", 0.01),
        ("p.webp", 0.01),
        ("p16.png", 1e-4),
        ("p16.exr", 1.0 / 2048.0),
    ] {
        let other = colors(&stage.path(name));
        for (a, b) in exact.iter().flatten().zip(other.iter().flatten()) {
            // Pictures for screens are cut at 1.
            let is_linear = ["pfm", "hdr", "exr"].iter().any(|extension| name.ends_with(extension));
            let a = if is_linear { *a } else { a.clamp(0.0, 1.0) };
            assert!((a - b).abs() <= step * a.max(1.0), "{name}: {a} {b}");
        }
    }
}

#[test]
fn a_better_jpeg_is_larger_and_nearer() {
    let stage = Stage::new("jpeg");
    stage.done("render scene.toml -q --width 160 --height 120 -o p.png");
    let exact = colors(&stage.path("p.png"));
    let [(coarse, far), (fine, near)] = ["--quality 20", "--quality 95"].map(|option| {
        stage.done(&format!("render scene.toml -q --width 160 --height 120 {option} -o p.jpg"));
        let found = colors(&stage.path("p.jpg"));
        let squares =
            exact.iter().flatten().zip(found.iter().flatten()).map(|(a, b)| f64::from(a - b).powi(2));
        (stage.bytes("p.jpg").len(), (squares.sum::<f64>() / (3.0 * exact.len() as f64)).sqrt())
    });
    assert!(fine > coarse && near < far && near < 0.01, "{coarse} {far}, {fine} {near}");
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let stage = Stage::new("threads");
    for extension in ["png", "jpg", "webp", "exr"] {
        let [one, two] = [1, 2].map(|threads| {
            stage.done(&format!("render scene.toml -q --width 100 --threads {threads} -o p.{extension}"));
            stage.bytes(&format!("p.{extension}"))
        });
        assert!(one == two, "{extension} differs");
    }
}

#[test]
fn a_picture_through_a_pipe() {
    let stage = Stage::new("pipe");
    stage.done("render scene.toml -q -o p.png");
    let run = stage.done("render scene.toml -o -");
    assert!(run.stdout == stage.bytes("p.png"), "stdout is not the picture");
}

#[test]
fn overrides_take_effect() {
    let stage = Stage::new("overrides");
    let summary = &stage.json(
        "render scene.toml -o p.exr --json --width 20 --samples 3 --integrator raycast --depth 1 --seed 7 \
         --sampler independent --filter gaussian:2 --exposure -1.5 --lookfrom -1,2,-5 --up 0,0,1 --fov 55.5 \
         --min-contribution 0 --crop 0,0,10,15 --tonemap filmic",
    )[0];
    assert_eq!((&summary["width"], &summary["height"]), (&20.into(), &15.into()));
    assert_eq!(summary["samples"], 3);
    assert_eq!(summary["integrator"], "raycast");
    assert_eq!(summary["rays"]["camera"], 10 * 15 * 3);
    let expected = [
        ("size", "20 15"),
        ("samples", "3"),
        ("integrator", "raycast"),
        ("depth", "1"),
        ("seed", "7"),
        ("sampler", "independent"),
        ("filter", "gaussian:2 sigma 0.5"),
        ("exposure", "-1.5"),
        ("tonemap", "none"),
        ("crop", "0 0 10 15"),
        ("min_contribution", "0"),
        ("scene", "scene.toml"),
        ("camera.lookfrom", "-1 2 -5"),
        ("camera.lookat", "0 0.5 0"),
        ("camera.up", "0 0 1"),
        ("camera.fov", "55.5"),
    ];
    for (name, text) in expected {
        assert_eq!(attribute(&stage, "p.exr", name).as_deref(), Some(text), "{name}");
    }
    // This one is of the format's own vocabulary, and not among those that the reader hands on.
    let software = format!("lookfrom {}", env!("CARGO_PKG_VERSION"));
    assert!(stage.bytes("p.exr").windows(software.len()).any(|bytes| bytes == software.as_bytes()));
}

#[test]
fn settings_of_light_change_the_picture() {
    let stage = Stage::new("settings");
    stage.done("render scene.toml -q -o plain.ppm");
    let plain = stage.bytes("plain.ppm");
    for option in [
        "--exposure 1",
        "--tonemap reinhard",
        "--filter box:3",
        "--sampler independent",
        "--seed 1",
        "--samples 1",
        "--depth 0",
        "--integrator normals",
        "--lookfrom -1,1,5",
        "--lookat -1,0,0",
        "--up -1,1,0",
        "--fov 60",
        "--crop 0,0,20,30",
    ] {
        stage.done(&format!("render scene.toml -q -o other.ppm {option}"));
        assert!(stage.bytes("other.ppm") != plain, "{option} changes nothing");
    }
    stage.done("render scene.toml -q -o other.ppm --seed 0 --fov 40 --lookfrom 0,1,5");
    assert!(stage.bytes("other.ppm") == plain, "what the scene says is not what it says");
}

#[test]
fn an_exr_holds_only_the_crop() {
    let stage = Stage::new("crop");
    stage.done("render scene.toml -q -o whole.exr");
    stage.done("render scene.toml -q -o crop.exr --crop 8,4,30,20");
    // Developed from the picture, without the film, it stays so.
    stage.done("develop crop.exr -o again.exr");
    let [whole, crop, again] =
        ["whole", "crop", "again"].map(|name| colors(&stage.path(&format!("{name}.exr"))));
    let is_held = |i: usize| (8..30).contains(&(i % 40)) && (4..20).contains(&(i / 40));
    let expected = whole.iter().enumerate().map(|(i, &pixel)| if is_held(i) { pixel } else { [0.0; 3] });
    assert_eq!(crop, expected.collect::<Vec<_>>());
    assert_eq!(again, crop);
    let sizes = ["whole", "crop", "again"].map(|name| stage.bytes(&format!("{name}.exr")).len());
    assert!(2 * sizes[1] < sizes[0] && 2 * sizes[2] < sizes[0], "{sizes:?}");
}

#[test]
fn the_summary_has_its_keys() {
    let stage = Stage::new("summary");
    let objects = stage.json("render scene.toml --json");
    assert_eq!(objects.len(), 1);
    let mut keys: Vec<&str> = objects[0].as_object().unwrap().keys().map(String::as_str).collect();
    keys.sort_unstable();
    assert_eq!(
        keys,
        [
            "cancelled",
            "denoised",
            "dropped_samples",
            "ended_by",
            "fireflies",
            "hash",
            "height",
            "instances",
            "integrator",
            "mrays_per_s",
            "notices",
            "output",
            "peak_memory_bytes",
            "rays",
            "relative_error",
            "samples",
            "samples_taken",
            "scene",
            "seconds",
            "spheres",
            "triangles",
            "warnings",
            "width"
        ]
    );
    let summary = &objects[0];
    assert_eq!((&summary["scene"], &summary["output"]), (&"scene.toml".into(), &"scene.png".into()));
    assert_eq!(
        (&summary["triangles"], &summary["spheres"], &summary["instances"]),
        (&2.into(), &1.into(), &0.into())
    );
    assert_eq!((&summary["cancelled"], &summary["samples_taken"]), (&false.into(), &4.into()));
    assert_eq!(summary["dropped_samples"], serde_json::json!({ "count": 0, "first": null }));
    let rays = &summary["rays"];
    let number = |key: &str| rays[key].as_u64().unwrap();
    assert_eq!(number("camera"), 40 * 30 * 4);
    assert!(number("shadow") > 0 && number("secondary") > 0);
    assert_eq!(number("total"), number("camera") + number("secondary") + number("shadow"));
    for key in ["read", "build", "render", "write"] {
        assert!(summary["seconds"][key].as_f64().unwrap() >= 0.0);
    }
}

#[test]
fn several_scenes_go_into_a_folder_or_a_pattern() {
    let stage = Stage::new("several");
    std::fs::create_dir(stage.path("out")).unwrap();
    stage.done("render scene.toml model.obj -q -o out --width 16 --samples 1");
    assert_eq!((size(&stage, "out/scene.png"), size(&stage, "out/model.png")), ((16, 12), (16, 12)));
    let objects =
        stage.json("render scene.toml model.obj --json -o out/{name}-small.exr --width 8 --samples 1");
    assert_eq!(objects[0]["output"], "out/scene-small.exr");
    assert_eq!(objects[1]["output"], "out/model-small.exr");
    assert_eq!(size(&stage, "out/model-small.exr"), (8, 6));
}

#[test]
fn a_model_is_framed_and_lit() {
    let stage = Stage::new("model");
    stage.done("render model.obj -q --width 64 --samples 4 -o p.exr");
    let texels = colors(&stage.path("p.exr"));
    let mean = texels.iter().flatten().sum::<f32>() / (texels.len() * 3) as f32;
    assert!((0.1..1.0).contains(&mean), "the mean is {mean}");
    stage.done("render model.obj -q --width 64 --samples 4 -o normals.exr --integrator normals");
    let texels = colors(&stage.path("normals.exr"));
    let facing = texels.iter().filter(|texel| texel[2] > 0.9).count();
    assert!(facing > texels.len() / 20, "{facing} pixels show the triangle");
}

#[test]
fn quiet_is_quiet() {
    let stage = Stage::new("quiet");
    let run = stage.done("render scene.toml --quiet");
    assert!(run.stdout.is_empty() && run.stderr.is_empty(), "{}", run.stderr);
}

/// A small lamp that paths find by chance alone makes fireflies.
const LAMP: &str = r#"
[camera]
lookfrom = [0, 1, 4]
lookat = [0, 0.5, 0]

[image]
width = 40
height = 30

[render]
integrator = "random_walk"
samples = 8

[[quad]]
corner = [-5, 0, 5]
edge_u = [10, 0, 0]
edge_v = [0, 0, -10]

[[sphere]]
center = [0, 3, 0]
radius = 0.3
material = "lamp"

[materials.lamp]
emission = [50, 50, 50]
"#;

#[test]
fn fireflies_are_listed_with_the_sample_that_made_them() {
    let stage = Stage::new("fireflies");
    stage.write("lamp.toml", LAMP);
    let summary = &stage.json("render lamp.toml --denoise off --json")[0];
    let listed = &summary["fireflies"];
    assert!(listed["count"].as_u64().unwrap() >= 3, "{listed}");
    assert_eq!(listed["brightest"].as_array().unwrap().len(), 3);
    let worst = &listed["brightest"][0];
    let inspect = format!("inspect lamp.toml {} {} --sample all --json", worst["x"], worst["y"]);
    let pixel = &stage.json_document(&inspect);
    assert_eq!(
        (&worst["sample"], &worst["expression"]),
        (&pixel["all"][0]["sample"], &pixel["all"][0]["expression"])
    );
    // The pixel is nearly all of its brightest sample.
    let sum = |value: &serde_json::Value| {
        value.as_array().unwrap().iter().map(|c| c.as_f64().unwrap()).sum::<f64>()
    };
    assert!(sum(&pixel["all"][0]["film"]) / 8.0 > 0.5 * sum(&pixel["mean"]), "{pixel}");
    let told = stage.done("render lamp.toml --denoise off").stderr;
    assert!(
        told.contains(&format!(
            "lookfrom inspect lamp.toml {} {} --sample {}",
            worst["x"], worst["y"], worst["sample"]
        )),
        "{told}"
    );
}
