//! Variables and animations of scenes: -D, --frames, --at, in films, jobs and `info`.

use super::stage::Stage;

/// A ball whose place is a matter of time, in front of a triangle that moves by itself.
const MOVING: &str = r#"
import = "moving.gltf"
[variables]
radius = 0.5
x = { keyframes = [[0, -1], [1, 1]], interpolation = "smooth" }
[camera]
lookfrom = ["= mix(0, 1, t)", 1, 6]
lookat = [1, 0.5, 0]
[image]
width = 24
height = 16
[render]
samples = 2
integrator = "whitted"
[materials.default]
diffuse = ["= frame / 8", 0.5, 0.5]
[[sphere]]
center = ["= x", "= radius", 1]
radius = "= radius"
[[light]]
type = "point"
position = [2, 4, 5]
intensity = 60
"#;

fn stage(name: &str) -> Stage {
    let stage = Stage::new(name);
    stage.write("moving.gltf", super::series::MOVING);
    stage.write("moving.toml", MOVING);
    stage
}

#[test]
fn a_frame_alone_is_that_of_the_series() {
    let stage = stage("frames-toml");
    stage.done("render moving.toml -q --strict --frames 0..4 --fps 8 -o all-#.png");
    let all: Vec<Vec<u8>> = (0..4).map(|k| stage.bytes(&format!("all-{k}.png"))).collect();
    for (index, frame) in all.iter().enumerate() {
        assert!(all[..index].iter().all(|other| other != frame), "frame {index} is one before it");
        let next = index + 1;
        stage.done(&format!("render moving.toml -q --frames {index}..{next} --fps 8 -o one-#.png"));
        assert!(stage.bytes(&format!("one-{index}.png")) == *frame, "frame {index} alone");
        let at = index as f64 / 8.0;
        stage.done(&format!("render moving.toml -q --at {at} --fps 8 -o at.png"));
        assert!(stage.bytes("at.png") == *frame, "the moment of frame {index}");
    }
}

#[test]
fn variables_from_the_command_line_change_the_picture() {
    let stage = stage("define");
    let seen = |options: &str| {
        stage.done(&format!("render moving.toml -q --strict {options} -o p.ppm"));
        stage.bytes("p.ppm")
    };
    let plain = seen("");
    assert!(seen("-D radius=0.5") == plain && seen("--define radius=1") != plain);
    assert!(seen("-D radius=1 -D x=-1") == seen("-D radius=1"));
    stage.run("render moving.toml -D radus=1").fails(2, &["no variable `radus`", "did you mean `radius`?"]);
    stage.run("render moving.toml -D radius").fails(2, &["NAME=VALUE"]);
    stage.run("render moving.toml -D radius=-1").fails(1, &["moving.toml", "greater than 0"]);
    stage.run("render model.obj -D radius=1").fails(2, &["no variables", ".toml"]);
    let info = &stage.json("info moving.toml -D radius=0.25 --at 1 --json")[0];
    assert_eq!(info["variables"], serde_json::json!({ "radius": "0.25", "x": "1" }));
    assert_eq!(info["duration"], 1.0);
    let said = String::from_utf8(stage.done("info moving.toml").stdout).unwrap();
    assert!(said.contains("with time: keyframes until 1 s"), "{said}");
    assert!(info["bounds"]["max"][0] == 1.25 || info["bounds"]["max"][0].as_f64() > Some(1.25));
}

#[test]
fn films_know_the_variables_that_they_are_of() {
    let stage = stage("define-films");
    let part = |part: &str, options: &str| {
        stage.done(&format!("render moving.toml -q --film --part {part}/2 {options} -o {part}.exr"));
    };
    part("1", "-D radius=0.7");
    part("2", "-D radius=0.7");
    stage.done("merge 1.exr 2.exr -q -o whole.exr");
    stage.done("render moving.toml -q --film -D radius=0.7 -o one.exr");
    assert!(stage.bytes("whole.exr") == stage.bytes("one.exr"));
    part("2", "");
    stage.run("merge 1.exr 2.exr -o none.exr").fails(1, &[]);
    // Going on with a film takes the same values.
    stage.done("resume 1.exr -q --samples 2 -o resumed.exr");
    assert!(stage.bytes("resumed.exr") == stage.bytes("one.exr"));
}

#[test]
fn jobs_have_the_time_of_each_frame() {
    let stage = stage("define-farm");
    stage.done("farm slurm moving.toml --frames 0..2 --fps 8 --parts 1 -D radius=0.7 -o job");
    let frames = String::from_utf8(stage.bytes("job/frames.txt")).unwrap();
    assert!(frames.contains("--at=0.125"), "{frames}");
    let script = String::from_utf8(stage.bytes("job/job.sh")).unwrap();
    assert!(script.contains("--define=radius=0.7") && script.contains("--fps=8"), "{script}");
}
