//! Numbers that JSON does not have.

use serde_json::json;

use super::stage::{SCENE, Stage};

#[test]
fn a_comparison_with_nothing() {
    let stage = Stage::new("json-compare");
    stage.write("black.ppm", "P3\n1 1\n255\n0 0 0\n");
    stage.write("red.ppm", "P3\n1 1\n255\n255 0 0\n");
    let answer = &stage.json("compare red.ppm black.ppm --json")[0];
    assert_eq!(answer["relative"], json!(["Infinity", 0.0, 0.0]));
    assert_eq!(answer["noise"], json!(null), "null is for what is not there");
}

#[test]
fn an_inspection_of_too_much_light() {
    let stage = Stage::new("json-inspect");
    stage.write(
        "bright.toml",
        &SCENE.replace("intensity = 20", "intensity = 3e38").replace("[3, 4, 5]", "[0, 0.1, 3]"),
    );
    let answers: Vec<String> = (0..30)
        .map(|y| {
            let found = stage.json_document(&format!("inspect bright.toml 20 {y} --json"));
            found["film"].to_string() + &found["radiance"]["rgb"].to_string()
        })
        .collect();
    assert!(answers.iter().any(|answer| answer.contains("\"Infinity\"")), "{answers:?}");
    assert!(answers.iter().all(|answer| !answer.contains("null")), "{answers:?}");
}
