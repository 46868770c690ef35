//! The help: short first, by what people want, and without repetitions.

use super::stage::Stage;

fn help(stage: &Stage, call: &str) -> String {
    String::from_utf8(stage.done(call).stdout).unwrap()
}

#[test]
fn the_short_help_is_short_and_names_the_long_one() {
    let stage = Stage::new("help-short");
    let (short, long) = (help(&stage, "render -h"), help(&stage, "render --help"));
    assert!(short.lines().count() < 90, "{short}");
    assert!(short.contains("--lookfrom") && !short.contains("--min-contribution"), "{short}");
    assert!(short.contains("render --help") && long.contains("--min-contribution"), "{short}");
}

#[test]
fn options_stand_under_what_they_are_about() {
    let stage = Stage::new("help-groups");
    let long = help(&stage, "render --help");
    let heading_of = |option: &str| {
        let is_own_line = |line: &&str| {
            line.starts_with("  ")
                && line.trim_start().starts_with('-')
                && line.split_whitespace().any(|w| w == option)
        };
        let own = long.lines().find(is_own_line).unwrap_or_else(|| panic!("{option}"));
        let before = &long[..long.find(own).unwrap()];
        before.lines().rev().find(|line| !line.starts_with(' ') && line.ends_with(':')).unwrap().to_owned()
    };
    for (option, heading) in [
        ("--watch", "The call:"),
        ("--threads", "The call:"),
        ("--strict", "The call:"),
        ("--checkpoint", "Films and parts of pictures:"),
        ("--size", "Size:"),
        ("--camera", "Camera:"),
        ("--background", "Light, background, colours:"),
        ("--time", "Samples, time, noise:"),
    ] {
        assert_eq!(heading_of(option), heading, "{option}");
    }
}

#[test]
fn braces_are_shown_as_they_are_typed() {
    let stage = Stage::new("help-braces");
    for call in ["render --help", "man render"] {
        let text = help(&stage, call);
        for word in ["{name}", "{dir}", "{parent}", "{n}"] {
            assert!(text.contains(word), "{call}: {word}");
        }
        assert!(!text.contains('\u{1b}'), "{call}");
    }
}

#[test]
fn options_of_a_picture_are_explained_once() {
    let stage = Stage::new("help-once");
    for command in ["inspect", "view", "bench", "farm", "convert"] {
        let text = help(&stage, &format!("{command} --help"));
        assert!(text.lines().count() < 110, "{command}: {}", text.lines().count());
        assert!(text.contains("render --help") && text.contains("--min-contribution"), "{command}");
        // The explanation is one of `render` alone, but is in every manual page.
        assert!(!text.contains("branch of the ray tree"), "{command}");
        assert!(help(&stage, &format!("man {command}")).contains("branch of the ray tree"), "{command}");
    }
    assert!(!help(&stage, "bench --help").contains("--tonemap"));
    assert!(!help(&stage, "inspect --help").contains("--layers"));
    stage.done("inspect scene.toml 3 4 --tonemap aces --exposure 1");
}
