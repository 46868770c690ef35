//! The guide is kept true: every option and every key is explained in it.

use std::path::Path;

use super::stage::Stage;

const COMMANDS: [&str; 13] = [
    "render",
    "resume",
    "merge",
    "develop",
    "files",
    "farm",
    "inspect",
    "view",
    "info",
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
fn the_lesson_shows_what_is_printed_and_what_is_written() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let read = |path: &str| std::fs::read_to_string(root.join(path)).unwrap();
    let lesson = read("docs/guide/lesson.md");
    let stage = Stage::new("guide-lesson");
    let scene = root.join("scenes/notes-exercise.toml");
    let printed: String = ["120 240", "330 240"]
        .map(|pixel| {
            let run = stage.done(&format!("inspect {} {pixel}", scene.display()));
            String::from_utf8(run.stdout).unwrap()
        })
        .concat();
    let written: String = [
        "crates/lookfrom/src/view/camera.rs",
        "crates/lookfrom-bvh/src/reference.rs",
        "crates/lookfrom/src/shading/material/whitted.rs",
    ]
    .map(read)
    .concat();
    let mut shown = [0, 0];
    let mut place: Option<usize> = None;
    for line in lesson.lines() {
        match (line, place) {
            ("```text", None) => place = Some(0),
            ("```rust", None) => place = Some(1),
            ("```", _) => place = None,
            (line, Some(place)) => {
                shown[place] += 1;
                assert!([&printed, &written][place].contains(line), "not there any more: {line}");
            }
            _ => {}
        }
    }
    assert!(shown.iter().all(|lines| *lines > 15), "{shown:?}");
}
