//! `--denoise`: who gets it, and whether pictures say so.

use lookfrom_scene::image::{self, Channels};
use lookfrom_scene::{Disk, LoadContext};

use super::stage::Stage;

fn exr(stage: &Stage, file: &str) -> Channels {
    image::read_exr(&stage.path(file), &mut LoadContext::new(&Disk)).unwrap()
}

#[test]
fn models_are_denoised_until_somebody_says_otherwise() {
    let stage = Stage::new("denoise-models");
    let summary = |options: &str| {
        let summary = &stage.json(&format!("render model.obj --json -o p.png {options}"))[0];
        (summary["denoised"].as_bool().unwrap(), summary["samples"].as_u64().unwrap())
    };
    assert_eq!(summary("--size 24"), (true, 16));
    assert_eq!(summary("--size 164"), (true, 16));
    assert_eq!(summary("--width 103 --height 1000"), (true, 11));
    assert_eq!(summary("--size 24 --samples 3"), (true, 3));
    assert_eq!(summary("--size 24 --samples 3 --denoise"), (true, 3));
    assert_eq!(summary("--size 24 --samples 3 --denoise off"), (false, 3));
    assert_eq!(summary("--size 24 --denoise off"), (false, 8));
    assert_eq!(summary("--size 24 --layers geometry"), (true, 16));
    for limit in ["--noise 0.5", "--time 200ms", "--time 200ms --write-every 100ms"] {
        assert!(summary(&format!("--size 24 {limit}")).0, "{limit}");
        assert!(!summary(&format!("--size 24 {limit} --denoise off")).0, "{limit}");
    }
    // There is something to adapt.
    assert!(!summary("--size 24 --integrator normals").0);
    let scene = &stage.json("render scene.toml --json -o p.png")[0];
    assert_eq!(scene["denoised"], false);
    let run = stage.done("render model.obj -o p.png --size 24");
    assert!(run.stderr.contains("16 samples per pixel, path, denoised"), "{}", run.stderr);
}

#[test]
fn an_exr_keeps_the_light_as_it_was_computed_and_says_what_was_done() {
    let stage = Stage::new("denoise-exr");
    let options = "--width 32 --integrator path --samples 4 -q";
    stage.done(&format!("render scene.toml -o raw.exr {options}"));
    stage.done(&format!("render scene.toml -o clean.exr {options} --denoise --layers geometry"));
    let (raw, clean) = (exr(&stage, "raw.exr"), exr(&stage, "clean.exr"));
    for name in ["R", "G", "B"] {
        assert_eq!(clean.channel(&format!("noisy.{name}")), raw.channel(name));
        assert_ne!(clean.channel(name), raw.channel(name));
    }
    let says = |file: &Channels| file.attributes.iter().any(|(name, _)| name == "denoised");
    assert!(says(&clean) && !says(&raw));
    assert!(clean.channel("Albedo.R").is_some());
}

#[test]
fn an_exr_of_a_model_keeps_the_light_and_the_layers_besides() {
    let stage = Stage::new("denoise-layers");
    let options = "--size 24 --samples 4 -q --layers geometry";
    stage.done(&format!("render model.obj -o raw.exr {options} --denoise off"));
    stage.done(&format!("render model.obj -o clean.exr {options}"));
    let (raw, clean) = (exr(&stage, "raw.exr"), exr(&stage, "clean.exr"));
    assert_eq!(clean.channel("noisy.G"), raw.channel("G"));
    assert_ne!(clean.channel("G"), raw.channel("G"));
    for layer in ["Albedo.R", "Nsx", "dzdx", "Variance.G"] {
        assert_eq!(clean.channel(layer).is_some(), raw.channel(layer).is_some(), "{layer}");
        assert_eq!(clean.channel(layer), raw.channel(layer), "{layer}");
    }
}

#[test]
fn a_scene_can_ask_for_it() {
    let stage = Stage::new("denoise-scene");
    let text = String::from_utf8(stage.bytes("scene.toml")).unwrap();
    stage.write("asks.toml", &text.replace("[image]", "[image]\ndenoise = true"));
    assert_eq!(stage.json("render asks.toml --json -o p.exr")[0]["denoised"], true);
    assert_eq!(stage.json("render asks.toml --json -o p.exr --denoise off")[0]["denoised"], false);
}

#[test]
fn an_edge_of_alpha_and_a_crop_go_with_it() {
    let stage = Stage::new("denoise-alpha");
    let common = "render model.obj -q --size 32 --samples 4 --denoise --floor --background";
    stage.done(&format!("{common} transparent -o t.exr --crop 4,4,28,28"));
    let picture = exr(&stage, "t.exr");
    let alpha = picture.channel("A").unwrap();
    assert!(alpha.iter().all(|alpha| (0.0..=1.0).contains(alpha)));
    assert!(alpha.contains(&1.0) && alpha.contains(&0.0));
    stage.done(&format!("{common} #ff8000 -o c.png"));
}
