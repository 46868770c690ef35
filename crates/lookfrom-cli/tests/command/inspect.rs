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
