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
    assert!(text.contains("dark.exr against b.exr: too far away") && text.contains("FLIP"), "{text}");
    let report = String::from_utf8(stage.bytes("report.html")).unwrap();
    assert_eq!(report.matches("data:image/png;base64,").count(), 8);
    assert!(report.contains("too far away") && !report.contains("http"), "the report leads elsewhere");
    // Without a tolerance it only tells.
    stage.done("compare dark.exr b.exr");
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
    stage.run("bench nowhere.toml").fails(1, &["no such file"]);
}
