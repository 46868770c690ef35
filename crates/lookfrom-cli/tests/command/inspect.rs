//! `lookfrom inspect`: the answer belongs to the picture that was rendered.

use lookfrom_scene::image;
use lookfrom_scene::{Disk, LoadContext};

use super::stage::Stage;

#[test]
fn what_is_inspected_is_what_is_rendered() {
    let stage = Stage::new("inspect");
    for light in ["", "--integrator path", "--integrator path --color spectral"] {
        let options = format!("--samples 1 --width 20 --seed 3 --lookfrom -1,1,5 {light}");
        stage.done(&format!("render scene.toml -q -o p.exr {options}"));
        let picture = image::read(&stage.path("p.exr"), &mut LoadContext::new(&Disk)).unwrap();
        for [x, y] in [[0, 0], [11, 6], [3, 14], [19, 9]] {
            let inspection = &stage.json_document(&format!("inspect scene.toml {x} {y} --json {options}"));
            assert_eq!(inspection["pixel"], serde_json::json!([x, y]));
            let film = inspection["film"].as_array().unwrap();
            let film: Vec<f32> = film.iter().map(|value| value.as_f64().unwrap() as f32).collect();
            assert_eq!(film, picture.texel(y * 20 + x), "pixel {x} {y}, {light}");
        }
    }
}

/// A triple of numbers as f32.
fn triple(value: &serde_json::Value) -> Vec<f32> {
    value.as_array().unwrap().iter().map(|value| value.as_f64().unwrap() as f32).collect()
}

#[test]
fn a_whole_pixel_is_that_of_the_picture() {
    let stage = Stage::new("inspect-pixel");
    for options in [
        "--samples 9 --width 20 --seed 3",
        "--samples 9 --width 20 --integrator path --exposure 1 --tonemap agx --background #204060",
        "--samples 9 --width 20 --integrator path --color spectral --background transparent",
        "--samples 5 --width 20 --integrator path --filter mitchell",
    ] {
        stage.done(&format!("render scene.toml -q -o p.exr {options}"));
        stage.done(&format!("render scene.toml -q -o p.png {options}"));
        let linear = image::read(&stage.path("p.exr"), &mut LoadContext::new(&Disk)).unwrap();
        let bytes = image::read(&stage.path("p.png"), &mut LoadContext::new(&Disk)).unwrap();
        for [x, y] in [[0, 0], [11, 6], [3, 14], [10, 9]] {
            let at = format!("pixel {x} {y}, {options}");
            let pixel =
                &stage.json_document(&format!("inspect scene.toml {x} {y} --sample all --json {options}"));
            if !options.contains('#') {
                assert_eq!(triple(&pixel["mean"]), linear.texel(y * 20 + x), "{at}");
            }
            let bytes = bytes.texel(y * 20 + x).map(|c| (255.0 * image::srgb_from_linear(c) + 0.5) as u8);
            assert_eq!(pixel["color8"], serde_json::json!(bytes), "{at}");

            let all = pixel["all"].as_array().unwrap();
            assert_eq!(pixel["samples"], all.len(), "{at}");
            let luminances: Vec<f64> = all.iter().map(|one| one["luminance"].as_f64().unwrap()).collect();
            assert!(luminances.is_sorted_by(|a, b| a >= b), "{at}: {luminances:?}");
            let n = all.len() as f64;
            for channel in 0..3 {
                // JSON has the shortest decimals that are the same f32.
                let of = |one: &serde_json::Value| f64::from(one["film"][channel].as_f64().unwrap() as f32);
                let mean = all.iter().map(of).sum::<f64>() / n;
                let squares = all.iter().map(|one| (of(one) - mean).powi(2)).sum::<f64>();
                let variance = pixel["variance"][channel].as_f64().unwrap();
                assert!((variance - squares / (n - 1.0)).abs() <= 1e-9 * variance, "{at}");
                let error = pixel["standard_error"][channel].as_f64().unwrap();
                assert!((error * error - variance / n).abs() <= 1e-9 * variance, "{at}");
            }
            // The first of the list is the worst, and what is told of it is what its own inspection tells.
            let worst =
                &stage.json_document(&format!("inspect scene.toml {x} {y} --sample worst --json {options}"));
            assert_eq!((&worst["sample"], &worst["film"]), (&all[0]["sample"], &all[0]["film"]), "{at}");
            if let Some(first) = worst["contributions"].get(0) {
                assert_eq!(first["expression"], all[0]["expression"], "{at}");
                assert!(first["expression"].as_str().unwrap().starts_with("camera → "), "{at}");
            }
        }
    }
    let some = &stage.json_document("inspect scene.toml 20 14 --sample 2..4 --json");
    let mut numbers: Vec<u64> =
        some["all"].as_array().unwrap().iter().map(|one| one["sample"].as_u64().unwrap()).collect();
    numbers.sort_unstable();
    assert_eq!((numbers, &some["samples"]), (vec![2, 3], &serde_json::json!(2)));
    let one = &stage.json_document("inspect scene.toml 20 14 --sample 2..3 --json");
    assert_eq!(one["variance"], serde_json::json!(null), "one sample has no variance");
    let text = String::from_utf8(stage.done("inspect scene.toml 20 14 --sample all").stdout).unwrap();
    assert!(text.contains("In short") && text.contains("variance") && text.contains("camera → "), "{text}");
    for (typed, problem) in [
        ("4..4", "above 4"),
        ("0..5", "there is no sample 4: the picture has 4 samples"),
        ("some", "worst, all, or a range"),
        ("-1", "unexpected argument '-1'"),
        ("all --svg rays.svg", "--svg shows the rays of one sample"),
        ("0..2 --only lights", "--only shows the rays of one sample"),
        ("0 --ray 9999", "there is no ray 9999: this sample has 1"),
    ] {
        stage.run(&format!("inspect scene.toml 20 14 --sample {typed}")).fails(2, &[problem]);
    }
}

#[test]
fn an_inspection_of_an_adaptive_picture() {
    let stage = Stage::new("inspect-adaptive");
    let adaptive = "inspect scene.toml 20 14 --samples 8 --allocation adaptive";
    let text = String::from_utf8(stage.done(&format!("{adaptive} --sample all")).stdout).unwrap();
    assert!(text.contains("the picture takes 4 to 64 samples of a pixel\n--sample N"), "{text}");
    assert_eq!(stage.json_document(&format!("{adaptive} --sample 63 --json"))["sample"], 63);
    let at_most = "there is no sample 64: the picture has at most 64 samples per pixel";
    stage.run(&format!("{adaptive} --sample 64")).fails(2, &[at_most]);
    let uniform = String::from_utf8(stage.done("inspect scene.toml 20 14 --sample all").stdout).unwrap();
    assert!(!uniform.contains("takes"), "{uniform}");
}

#[test]
fn an_inspection_of_a_camera_that_moves() {
    let stage = Stage::new("inspect-moving");
    stage.write(
        "moving.toml",
        "camera = { lookfrom = [\"= t\", 0, 3], lookat = [0, 0, 0], shutter = 0.5 }\nsphere = [{}]",
    );
    let text = String::from_utf8(stage.done("inspect moving.toml 5 5 --only camera").stdout).unwrap();
    for line in [
        "P_world = M · T4 · R3 · S2 · T1 · P_k",
        "M_vw = T4 · R3, from view to world, when the shutter opened",
    ] {
        assert!(text.contains(line), "{line}: {text}");
    }
}

#[test]
fn parts_of_an_inspection() {
    let stage = Stage::new("inspect-parts");
    let said = |options: &str| {
        let run = stage.done(&format!("inspect scene.toml 20 14 {options}"));
        String::from_utf8(run.stdout).unwrap()
    };
    // What belongs to each part, and to no other.
    let words = [
        ("camera", "P_world = "),
        ("tests", " of the BVH, culls "),
        ("lights", "samples one light"),
        ("sums", "bit for bit"),
    ];
    for (part, _) in words {
        let text = said(&format!("--integrator path --only {part}"));
        for (of, word) in words {
            assert_eq!(text.contains(word), of == part, "{word:?} in --only {part}: {text}");
        }
    }
    let whole = said("--integrator path");
    assert!(words.iter().all(|(_, word)| whole.contains(word)), "{whole}");
    assert!(whole.find("In short") < whole.find("P_k"), "what matters comes first: {whole}");
    let second = said("--integrator path --bounce 1");
    assert!(second.contains("ray 2 (") && !second.contains("ray 1 (") && !second.contains("P_k"), "{second}");
    let first = said("--integrator path --ray 1");
    assert!(first.contains("ray 1 (") && !first.contains("ray 2 ("), "{first}");
    for text in [
        whole,
        said("--integrator whitted --depth 12"),
        said("--integrator path --color spectral"),
        said("--integrator path --sample all"),
    ] {
        let longest = text.lines().max_by_key(|line| line.chars().count()).unwrap();
        assert!(longest.chars().count() <= 120, "{longest}");
    }
}

#[test]
fn an_inspection_as_data_says_what_it_is_of() {
    let stage = Stage::new("inspect-data");
    for sample in ["1", "worst", "all", "1..3"] {
        let report = &stage
            .json_document(&format!("inspect scene.toml 20 14 --json --sample {sample} --exposure 1.5"));
        assert_eq!(report["version"], env!("CARGO_PKG_VERSION"));
        assert_eq!(report["scene"], "scene.toml");
        assert_eq!(report["options"], serde_json::json!(["--exposure=1.5"]));
        assert_eq!(report["picture"], serde_json::json!({"width": 40, "height": 30, "samples": 4}));
        assert_eq!(report["lights"][0]["kind"], "point");
        assert_eq!(report["lights"][0]["position"], serde_json::json!([3.0, 4.0, 5.0]));
        assert_eq!(report["pixel"], serde_json::json!([20, 14]));
    }
}

#[test]
fn an_inspection_in_words_and_as_a_drawing() {
    let stage = Stage::new("inspect-svg");
    let run = stage.done("inspect scene.toml 20 14 --sample 2 --svg rays.svg");
    let text = String::from_utf8(run.stdout).unwrap();
    for word in ["pixel 20 14", "sample 2", "T1", "S2", "R3", "T4"] {
        assert!(text.contains(word), "{word:?} is not in: {text}");
    }
    assert!(String::from_utf8(stage.bytes("rays.svg")).unwrap().contains("<svg"));
    stage
        .run("inspect scene.toml 20 14 --svg model.obj/rays.svg")
        .fails(3, &["cannot write model.obj/rays.svg"]);
}

/// The corners of the rectangles behind labels, in the drawing's own panels, by the text on them.
fn labels(drawing: &str) -> Vec<([f64; 4], String)> {
    let attribute = |element: &str, name: &str| -> f64 {
        let (_, rest) = element.split_once(&format!(" {name}=\"")).unwrap();
        rest.split('"').next().unwrap().parse().unwrap()
    };
    let rows = drawing.lines().filter(|line| line.contains("fill-opacity=\"0.8\""));
    rows.map(|row| {
        let [x, y, width, height] = ["x", "y", "width", "height"].map(|name| attribute(row, name));
        let text = row.split_once("<text").unwrap().1.split_once('>').unwrap().1.split('<').next().unwrap();
        ([x, y, x + width, y + height], text.to_owned())
    })
    .collect()
}

#[test]
fn a_drawing_has_views_and_labels_that_keep_apart() {
    let stage = Stage::new("inspect-svg-views");
    let draw = |options: &str| {
        stage.done(&format!("inspect scene.toml 20 14 --integrator path --svg rays.svg {options}"));
        String::from_utf8(stage.bytes("rays.svg")).unwrap()
    };
    let sheet = draw("");
    for view in ["side", "top", "front", "camera"] {
        let alone = draw(&format!("--svg-view {view}"));
        let title = format!("<clipPath id=\"{view}\">");
        assert!(sheet.contains(&title) && alone.contains(&title), "{view}");
        assert_eq!(alone.matches("<clipPath").count(), 1, "{view}");
        let labels = labels(&alone);
        assert!(labels.len() > 1, "{view}: {labels:?}");
        for (index, (one, text)) in labels.iter().enumerate() {
            for (other, beside) in &labels[..index] {
                let apart =
                    one[0] >= other[2] || other[0] >= one[2] || one[1] >= other[3] || other[1] >= one[3];
                assert!(apart, "{view}: {text} is on {beside}");
            }
        }
        let has = |word: &str| labels.iter().any(|(_, text)| text == word);
        assert!(has("1") || view == "camera", "{view}: the camera ray's number is not in {labels:?}");
        assert!(has(if view == "camera" { "the pixel" } else { "image plane, t = 1" }), "{view}: {labels:?}");
        assert!(
            view == "camera" || ["u", "v", "w"].iter().filter(|axis| has(axis)).count() == 2,
            "{labels:?}"
        );
    }
    stage.write(
        "around.toml",
        "camera = { projection = \"octahedral\", lookfrom = [0, 0, 0], lookat = [0, 0, 3] }",
    );
    let of_all_around = "inspect around.toml 5 5 --svg rays.svg";
    stage.done(of_all_around);
    stage.run(&format!("{of_all_around} --svg-view camera")).fails(2, &["has no image plane"]);
    stage.run("inspect scene.toml 5 5 --svg-view top").fails(2, &["--svg <FILE>"]);
    // Nor has a measurement, whose ray starts on the floor.
    stage.write(
        "measured.toml",
        "camera = { projection = \"irradiance\", surface = \"floor\" }\nimage = { width = 2, height = 2 }\n\
         quad = [{ name = \"floor\", corner = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [0, 0, -1] }]\n\
         light = [{ type = \"environment\", color = 0.5 }]",
    );
    let told = String::from_utf8(stage.done("inspect measured.toml 1 1 --svg rays.svg").stdout).unwrap();
    for words in
        ["a direction, irradiance", "weight = 3.141593", "the surface's weight", "the same, bit for bit"]
    {
        assert!(told.contains(words), "{words:?} is not in {told}");
    }
    stage.run("inspect measured.toml 1 1 --svg rays.svg --svg-view camera").fails(2, &["has no image plane"]);
}
