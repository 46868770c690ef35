//! The guide is kept true: every option and every key is explained in it.

use std::path::Path;

use super::stage::Stage;

const COMMANDS: [&str; 14] = [
    "render",
    "resume",
    "merge",
    "develop",
    "files",
    "farm",
    "inspect",
    "view",
    "info",
    "convert",
    "compare",
    "bench",
    "man",
    "completions",
];

fn guide() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/guide/command.md");
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn every_option_is_in_the_guide() {
    let stage = Stage::new("guide");
    let guide = guide();
    let mut options = 0;
    for command in COMMANDS {
        assert!(guide.contains(&format!("## lookfrom {command}")), "{command}");
        let help = String::from_utf8(stage.done(&format!("{command} --help")).stdout).unwrap();
        // An option's own line in the help begins with it; others only mention it.
        for line in help.lines().map(str::trim_start).filter(|line| line.starts_with('-')) {
            let Some(long) = line.split_whitespace().find(|word| word.starts_with("--")) else { continue };
            // Dots are behind those that may be repeated, commas in lists.
            let long = long.trim_end_matches("...").trim_end_matches(',');
            assert!(guide.contains(&format!("`{long}")), "{long} is not in the guide");
            options += 1;
        }
    }
    assert!(options > 40, "only {options} options were found in the help");
}

#[test]
fn every_option_of_the_guide_is_there() {
    let stage = Stage::new("guide-back");
    let help: String = COMMANDS
        .map(|command| String::from_utf8(stage.done(&format!("{command} --help")).stdout).unwrap())
        .concat();
    for word in guide().split(|c: char| !(c.is_ascii_alphanumeric() || c == '-')) {
        let is_option = word.len() > 2 && word.starts_with("--") && !word.starts_with("---");
        assert!(!is_option || help.contains(word) || word == "--version", "{word} is not in the help");
    }
}

#[test]
fn every_key_of_the_answers_is_in_the_guide() {
    let stage = Stage::new("guide-keys");
    let guide = guide();
    let answers = [
        stage.json("render scene.toml --json"),
        stage.json("info scene.toml --json"),
        stage.done("render scene.toml -o a.exr --film").json(),
        stage.json("info a.exr --json"),
        stage.json("compare scene.png scene.png --json"),
        stage.json("bench scene.toml --json --samples 1 --reference-samples 1"),
    ]
    .concat();
    for answer in answers {
        for key in answer.as_object().unwrap().keys() {
            assert!(guide.contains(&format!("`{key}`")), "{key} is not in the guide");
        }
    }
}

#[test]
fn the_lesson_shows_what_is_written() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let read = |path: &str| std::fs::read_to_string(root.join(path)).unwrap();
    let lesson = read("docs/guide/lesson.md");
    let written: String = [
        "crates/lookfrom/src/view/camera.rs",
        "crates/lookfrom-bvh/src/reference.rs",
        "crates/lookfrom/src/shading/bsdf/whitted.rs",
        "crates/lookfrom/src/world/medium.rs",
    ]
    .map(read)
    .concat();
    let (mut shown, mut is_code) = (0, false);
    for line in lesson.lines() {
        match line {
            "```rust" => is_code = true,
            "```" => is_code = false,
            line if is_code => {
                shown += 1;
                assert!(written.contains(line), "not there any more: {line}");
            }
            _ => {}
        }
    }
    assert!(shown > 15, "{shown}");
}

/// The tutorial's blocks, each after all before it, as it is told to be typed.
#[test]
fn the_tutorial_says_what_the_program_says() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let tutorial = std::fs::read_to_string(root.join("docs/guide/tutorial.md")).unwrap();
    let stage = Stage::new("guide-tutorial");
    let mut scene = String::new();
    let mut said = Vec::new();
    let blocks = tutorial.split("```toml\n").skip(1);
    for block in blocks {
        scene += block.split("```").next().unwrap();
        stage.write("still-life.toml", &scene);
        let run = stage.done("render still-life.toml --width 24 --samples 1 --denoise off");
        assert!(!run.stderr.contains("<scene>"), "{}", run.stderr);
        said.push(run.stderr);
    }
    let warnings = |step: usize| said[step].lines().filter(|line| line.starts_with("warning: ")).count();
    assert_eq!(warnings(0), 1, "{}", said[0]);
    assert!(said[0].contains("no geometry"), "{}", said[0]);
    assert!((1..said.len()).all(|step| warnings(step) == 0), "{said:?}");
    assert!(said[1].contains("note: still-life.toml: there is no light: one is added"), "{}", said[1]);
    assert!(!said.last().unwrap().contains("note:"), "{said:?}");
}
