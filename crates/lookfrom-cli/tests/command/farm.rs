//! Job files: the script that all schedulers run, and what each of them is given.

use std::process::Command;

use super::series::MOVING;
use super::stage::{SCENE, Stage};

/// Runs the script of a job, as a scheduler would.
fn job(stage: &Stage, folder: &str, arguments: &[&str]) -> String {
    let mut command = Command::new("sh");
    command
        .arg(stage.path(&format!("{folder}/job.sh")))
        .args(arguments)
        .env("LOOKFROM", env!("CARGO_BIN_EXE_lookfrom"));
    let output = command.output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
#[cfg(unix)]
fn tasks_and_their_merge_are_one_render() {
    let stage = Stage::new("farm");
    let farm = "farm slurm scene.toml --parts 3 --exposure=0.5 --samples 5 --memory 2GiB -o";
    let output = stage.command(farm).arg("a job").output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let script = String::from_utf8(stage.bytes("a job/job.sh")).unwrap();
    assert!(script.contains(" '--exposure=0.5' '--memory=2GiB' '--samples=0..5'"), "{script}");
    job(&stage, "a job", &["part", "2-3"]);
    job(&stage, "a job", &["part", "3"]);
    // One part is damaged, one is missing: the merge renders both.
    let film = stage.path("a job/parts/00001-000003.exr");
    let mut bytes = std::fs::read(&film).unwrap();
    bytes.truncate(bytes.len() / 2);
    std::fs::write(&film, bytes).unwrap();
    assert!(job(&stage, "a job", &["merge"]).ends_with("a job/scene.exr\n"));
    let one = ["render", "scene.toml", "--exposure=0.5", "--samples", "5", "--film", "-o", "a job/one.exr"];
    assert!(stage.command("").args(one).status().unwrap().success());
    assert!(stage.bytes("a job/one.exr") == stage.bytes("a job/scene.exr"));
}

#[test]
#[cfg(unix)]
fn names_of_scenes_are_only_names() {
    let stage = Stage::new("farm-names");
    let name = "a'b$(touch x)`touch x`\n\"; touch x; {{Param.Scene}}";
    stage.write(&format!("{name}.toml"), SCENE);
    let scene = format!("{name}.toml");
    for (scheduler, folder) in [("slurm", "job $(touch x)"), ("openjd", "open")] {
        let farm = ["farm", scheduler, &scene, "--parts", "1", "-o", folder];
        assert!(stage.command("").args(farm).status().unwrap().success());
    }
    job(&stage, "job $(touch x)", &["part", "1"]);
    assert!(job(&stage, "job $(touch x)", &["merge"]).ends_with(&format!("{name}.exr\n")));
    assert!(!stage.path("x").exists());
    let template: serde_json::Value = serde_json::from_slice(&stage.bytes("open/template.json")).unwrap();
    let called = template["name"].as_str().unwrap();
    assert!(!called.contains("{{") && !called.contains(char::is_control), "{called:?}");
    // What is no task is an error, not a task that is done.
    for wrong in ["0", "2", "1-2", "x", "-1", "1;touch x"] {
        let mut command = Command::new("sh");
        command.arg(stage.path("job $(touch x)/job.sh")).args(["part", wrong]);
        assert_eq!(command.env("LOOKFROM", "false").output().unwrap().status.code(), Some(2), "{wrong}");
    }
}

#[test]
#[cfg(unix)]
fn frames_are_those_of_a_turntable() {
    let stage = Stage::new("farm-frames");
    let farm = [
        "farm",
        "dask",
        "model.obj",
        "--parts",
        "1",
        "--turntable",
        "2",
        "--size=24",
        "--floor",
        "-o",
        "a job",
    ];
    assert!(stage.command("").args(farm).status().unwrap().success());
    job(&stage, "a job", &["part", "1-2"]);
    job(&stage, "a job", &["merge"]);
    let one =
        ["render", "model.obj", "--turntable", "2", "--size=24", "--floor", "--film", "-o", "a job/one.exr"];
    assert!(stage.command("").args(one).status().unwrap().success());
    for frame in [0, 1] {
        let [one, merged] = [format!("a job/one-00{frame}.exr"), format!("a job/model-00{frame}.exr")];
        assert!(stage.bytes(&one) == stage.bytes(&merged), "frame {frame}");
    }
}

/// Framed once, and exposed as the first, of a model with a lamp of its own that it moves away from.
#[test]
#[cfg(unix)]
fn frames_of_a_model_are_those_of_render() {
    let stage = Stage::new("farm-animation");
    let lamp =
        r#"{"mesh": 0}, {"translation": [0, 2, 2], "extensions": {"KHR_lights_punctual": {"light": 0}}}"#;
    let lamps = r#""extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 9000}]}}, "nodes": ["#;
    let lit = MOVING.replacen(r#""nodes": [0]"#, r#""nodes": [0, 1]"#, 1);
    let lit = lit.replacen(r#"{"mesh": 0}"#, lamp, 1).replacen(r#""nodes": [{"#, &format!("{lamps}{{"), 1);
    stage.write("moving.gltf", &lit);
    let options = "--fps 4 --frames 1..4 --size 24x12 --samples 2 --denoise off";
    stage.done(&format!("farm slurm moving.gltf {options} --parts 1 -o job"));
    let frames = String::from_utf8(stage.bytes("job/frames.txt")).unwrap();
    assert_eq!(frames, "--at=0.25\n--at=0.5\n--at=0.75\n");
    let script = String::from_utf8(stage.bytes("job/job.sh")).unwrap();
    assert!(script.contains("--bounds=") && script.contains("--exposure=-"), "{script}");
    job(&stage, "job", &["part", "1-3"]);
    job(&stage, "job", &["merge"]);
    stage.done(&format!("render moving.gltf {options} --film -o job/one.exr"));
    for frame in 1..4 {
        let [one, merged] = [format!("job/one-000{frame}.exr"), format!("job/moving-000{frame}.exr")];
        assert!(stage.bytes(&one) == stage.bytes(&merged), "frame {frame}");
    }
    stage.done("resume job/one-0002.exr --samples 3");
    stage.run("farm slurm moving.gltf --turntable 3 --bounds 0,0,0,1,1,1 -o job").fails(2, &["--bounds"]);
}

#[test]
fn every_scheduler_gets_its_files() {
    let stage = Stage::new("farm-files");
    let files = |scheduler: &str| {
        stage.done(&format!("farm {scheduler} scene.toml --parts 4 -o {scheduler}"));
        let entries = std::fs::read_dir(stage.path(scheduler)).unwrap();
        let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names.join(" ")
    };
    assert_eq!(files("slurm"), "frames.txt job.sh submit.sh");
    assert_eq!(files("dask"), "frames.txt job.sh submit.py");
    assert_eq!(files("hyperqueue"), "frames.txt job.sh submit.py");
    assert_eq!(
        files("openjd"),
        "asset_references.json frames.txt job.sh parameter_values.json parameters.json template.json"
    );
    let template: serde_json::Value = serde_json::from_slice(&stage.bytes("openjd/template.json")).unwrap();
    let task = &template["steps"][0]["parameterSpace"]["taskParameterDefinitions"][0];
    assert_eq!((task["type"].as_str(), task["range"].as_str()), (Some("CHUNK[INT]"), Some("1-4")));
    assert_eq!(template["steps"][1]["dependencies"][0]["dependsOn"], "Render");
    let inputs: serde_json::Value =
        serde_json::from_slice(&stage.bytes("openjd/asset_references.json")).unwrap();
    assert_eq!(inputs["assetReferences"]["inputs"]["filenames"].as_array().unwrap().len(), 1);
    stage.run("farm slurm scene.toml --parts 4 --samples 3 -o x").fails(2, &["part 1 of 4", "no sample"]);
    stage.write("few.toml", &SCENE.replace("samples = 4", "samples = 3"));
    stage.run("farm slurm few.toml --parts 4 -o x").fails(2, &["part 1 of 4", "no sample"]);
    stage.run("farm slurm few.toml --parts 3 --allocation adaptive -o x").fails(2, &["adaptive"]);
    // Of models, whose number of samples depends on the size of the picture.
    stage.run("farm slurm model.obj --parts 17 --size 400 -o x").fails(2, &["part 1 of 17", "0..11"]);
    stage.done("farm slurm model.obj --parts 11 --size 400 -o y");
    assert!(!stage.path("x").exists());
    stage.run("farm slurm missing.toml -o x").fails(1, &["missing.toml: no such file"]);
}
