//! `lookfrom compare` and `lookfrom bench`.

use super::stage::Stage;

#[test]
fn a_picture_and_its_reference() {
    let stage = Stage::new("compare");
    let options = "-q --layers geometry --sampler independent";
    stage.done(&format!("render scene.toml -o a.exr --samples 16 {options}"));
    stage.done(&format!("render scene.toml -o b.exr --samples 64 --seed 1 {options}"));
    stage.done(&format!("render scene.toml -o dark.exr --samples 64 --depth 0 {options}"));
    let same = &stage.json("compare a.exr b.exr --tolerance 0.02 --within 0.9 --json")[0];
    assert_eq!((&same["passed"], &same["not_finite"]), (&true.into(), &0.into()));
    assert!(same["noise"]["pixels_within"].as_f64().unwrap() > 0.9, "{same}");
    assert!(same["flip"].as_f64().unwrap() < 0.1 && same["flip"].as_f64().unwrap() > 0.0);

    // Another picture is no noise; the first failure of a pair is the answer, and all pairs are told of.
    let run = stage.run("compare dark.exr b.exr a.exr b.exr --tolerance 0.001 --html report.html");
    assert_eq!(run.code, Some(1), "{}", run.stderr);
    let text = String::from_utf8(run.stdout).unwrap();
    assert!(text.contains("dark.exr against b.exr: failed") && text.contains("FLIP"), "{text}");
    let report = String::from_utf8(stage.bytes("report.html")).unwrap();
    assert_eq!(report.matches("data:image/png;base64,").count(), 8);
    assert!(report.contains("failed") && !report.contains("http"), "the report leads elsewhere");
    assert!(
        text.contains("failed: the means differ in red by ") && text.contains("allowed are 0.1 %"),
        "{text}"
    );
    // Without a tolerance it only tells.
    let told = String::from_utf8(stage.done("compare dark.exr b.exr").stdout).unwrap();
    assert!(!told.contains("passed") && told.contains("not judged"), "{told}");
    let judged = |call: &str| serde_json::from_slice::<serde_json::Value>(&stage.run(call).stdout).unwrap();
    let answer = judged("compare dark.exr b.exr --json");
    assert_eq!((&answer["passed"], &answer["reasons"]), (&serde_json::Value::Null, &serde_json::json!([])));
    let answer = judged("compare dark.exr b.exr --within 0.999 --json");
    assert_eq!(answer["passed"], false);
    assert!(answer["reasons"][0].as_str().unwrap().contains("expected 99.9 %"), "{answer}");
}

#[test]
fn noise_of_cameras() {
    let stage = Stage::new("compare-sensor");
    let scene = String::from_utf8(stage.bytes("scene.toml")).unwrap();
    assert!(scene.contains("[image]\n"), "{scene}");
    let canon = scene.replace("[image]\n", "[image]\nsensor = \"canon_eos_m\"\n");
    std::fs::write(stage.path("canon.toml"), &canon).unwrap();
    let options = "-q --layers geometry --sampler independent --color spectral --samples 32";
    stage.done(&format!("render scene.toml -o plain.exr {options}"));
    stage.done(&format!("render canon.toml -o a.exr {options}"));
    stage.done(&format!("render canon.toml -o b.exr --seed 1 {options}"));
    let answer = |pair: &str| stage.json(&format!("compare {pair} --json"))[0].clone();
    let same = answer("a.exr b.exr");
    assert_eq!(same["noise"]["channels"], "sensor");
    assert!(same["noise"]["pixels_within"].as_f64().unwrap() > 0.9, "{same}");
    assert_eq!(answer("plain.exr plain.exr")["noise"]["channels"], "XYZ");
    // A picture says its sensor, and another one's noise is not that of the same channels.
    let run = stage.run("compare plain.exr a.exr");
    assert!(run.stderr.contains("different sensors") && run.code == Some(0), "{}", run.stderr);
    assert_eq!(answer("plain.exr a.exr")["noise"], serde_json::Value::Null);
    stage.run("compare a.exr b.exr --sensor canon_m").fails(2, &["canon_eos_m"]);
    stage.run("compare a.exr b.exr --sensor canon_eos_m,hot").fails(2, &["kelvin"]);
    stage.done("compare a.exr b.exr --sensor nikon_d850,5000");
}

#[test]
fn pictures_without_noise() {
    let stage = Stage::new("compare-png");
    stage.done("render scene.toml -q -o a.png");
    stage.done("render scene.toml -q -o b.pfm");
    let answer = &stage.json("compare a.png a.png --json --tolerance 0")[0];
    assert_eq!(
        (&answer["flip"], &answer["rmse"], &answer["noise"]),
        (&0.0.into(), &0.0.into(), &serde_json::Value::Null)
    );
    // What was not measured is not within.
    let run = stage.run("compare a.png b.pfm --within 0.5");
    assert_eq!(run.code, Some(1));
    assert!(String::from_utf8(run.stdout).unwrap().contains("failed: the noise is unknown"));
}

#[test]
fn values_that_are_not_finite() {
    let stage = Stage::new("compare-not-finite");
    let pixels = [f32::NAN, 1.0, f32::INFINITY, 0.5, 0.5, 0.5];
    let bytes = |values: &[f32]| {
        [b"PF\n2 1\n-1\n".to_vec(), values.iter().flat_map(|x| x.to_le_bytes()).collect()].concat()
    };
    std::fs::write(stage.path("a.pfm"), bytes(&pixels)).unwrap();
    std::fs::write(stage.path("b.pfm"), bytes(&[0.5; 6])).unwrap();
    let run = stage.run("compare a.pfm b.pfm --json");
    assert_eq!(run.code, Some(1));
    assert!(String::from_utf8(run.stdout).unwrap().contains("\"not_finite\":2"));
    assert!(!run.stderr.contains("not finite"), "{}", run.stderr);
    // Those of a reference are no fault of the picture.
    let run = stage.run("compare b.pfm a.pfm");
    assert_eq!(run.code, Some(0));
    assert!(run.stderr.contains("a.pfm: 2 values are not finite"), "{}", run.stderr);
}

#[test]
fn what_cannot_be_compared() {
    let stage = Stage::new("compare-not");
    stage.done("render scene.toml -q -o a.exr");
    stage.done("render scene.toml -q -o small.exr --width 20");
    stage.run("compare a.exr small.exr").fails(1, &["40 × 30", "20 × 15"]);
    stage.run("compare a.exr nowhere.exr").fails(1, &["nowhere.exr: no such file"]);
    stage.run("compare a.exr").fails(2, &["PICTURE REFERENCE"]);
    stage.run("compare a.exr a.exr a.exr").fails(2, &["pairs"]);
    stage.run("compare a.exr a.exr --samples 5").fails(2, &["two numbers"]);
    let run = stage.run("compare a.exr a.exr --html a.exr/r.html");
    assert!(run.code == Some(3) && run.stderr.contains("a.exr/r.html"), "{}", run.stderr);
}

#[test]
fn speed_and_error() {
    let stage = Stage::new("bench");
    let objects =
        stage.json("bench scene.toml model.obj --json --width 40 --samples 2 --reference-samples 8");
    assert_eq!((&objects[0]["scene"], &objects[1]["samples"]), (&"scene.toml".into(), &2.into()));
    for key in ["samples_per_s", "rays_per_s", "relative_mse", "error_time", "render_seconds"] {
        assert!(objects[0][key].as_f64().unwrap() > 0.0, "{key}");
    }
    stage.done("render scene.toml -q -o reference.exr --samples 2");
    let run = stage.json("bench scene.toml --json --samples 2 --reference reference.exr");
    assert_eq!(
        (&run[0]["relative_mse"], &run[0]["bias"]),
        (&0.0.into(), &serde_json::json!([0.0, 0.0, 0.0]))
    );
    let table =
        String::from_utf8(stage.done("bench scene.toml --time 50ms --reference-samples 4").stdout).unwrap();
    assert!(table.starts_with("scene ") && table.contains("\nscene.toml "), "{table}");
    stage.run("bench scene.toml model.obj --reference reference.exr").fails(2, &["one scene"]);
    let allocated = "bench scene.toml --json --samples 8 --allocation adaptive --reference-samples 4";
    assert_eq!(stage.json(allocated)[0]["samples"], 8);
    stage.run("bench nowhere.toml").fails(1, &["no such file"]);
}
