//! What goes wrong is said with a place and a remedy, leads to its exit code, and leaves no files behind.

use super::stage::{MODEL, SCENE, Stage};

/// A scene that would take hours: what is refused must be refused before it is rendered.
fn endless(stage: &Stage) {
    stage.write("endless.toml", &SCENE.replace("samples = 4", "samples = 10000000"));
}

#[test]
fn a_missing_scene() {
    let stage = Stage::new("missing");
    stage.run("render nowhere.toml").fails(1, &["error: nowhere.toml: no such file", "help:"]);
    stage.run("info nowhere.toml").fails(1, &["nowhere.toml: no such file"]);
    stage.run("inspect nowhere.toml 0 0").fails(1, &["nowhere.toml: no such file"]);
}

#[test]
fn a_bad_scene_is_told_by_line_and_column() {
    let stage = Stage::new("bad");
    stage.write("syntax.toml", "[camera]\nlookfrom = [0, 1\nfov = 40\n");
    stage.run("render syntax.toml").fails(1, &["error: ", "--> syntax.toml:3:1\n"]);
    stage.write("key.toml", &SCENE.replace("fov", "fow"));
    let shown = "error: unknown key `fow` in [camera]\n --> key.toml:5:1\n  |\n5 | fow = 40\n  | ^^^\n  = help: did you mean `fov`?\n";
    stage.run("render key.toml").fails(1, &[shown]);
    stage.write("scene.pbrt", "WorldBegin\nShape sphere");
    stage.run("render scene.pbrt").fails(1, &["--> scene.pbrt:2:7\n", "2 | Shape sphere\n  |       ^^^^^^"]);
    stage.write("model.obj", "v 0 0 0\r\nv 1 zwei 0\r\n");
    stage.run("render model.obj").fails(1, &["--> model.obj:2:5\n  |\n2 | v 1 zwei 0\n  |     ^^^^\n"]);
    assert!(stage.names().iter().all(|name| !name.ends_with("png")));
}

#[test]
fn all_errors_of_a_scene_are_told_in_one_run() {
    let stage = Stage::new("all");
    let wrong = SCENE
        .replace("fov", "fow")
        .replace("width = 40", "width = 0")
        .replace("samples", "spp")
        .replace("intensity", "strength");
    stage.write("wrong.toml", &wrong);
    let run = stage.run("render wrong.toml");
    run.fails(1, &["`fov`?", "`width` is 0", "`samples`?", "`intensity`?"]);
    assert_eq!(run.stderr.matches("error: ").count(), 4, "{}", run.stderr);
    let lights = "[[light]]\ntype = \"area\"\n".repeat(51);
    stage.write("many.toml", &lights);
    let run = stage.run("render many.toml");
    run.fails(1, &["\n\n… and 31 more\n"]);
    assert_eq!(run.stderr.matches("--> many.toml:").count(), 20, "{}", run.stderr);
}

#[test]
fn what_the_parser_says_and_what_we_say_look_alike() {
    let stage = Stage::new("alike");
    stage
        .run("rendr scene.toml")
        .fails(2, &["error: unrecognized subcommand 'rendr'\n\n  help: ", "'render'"]);
    let run = stage.run("render scene.toml --width abc");
    run.fails(
        2,
        &[
            "error: invalid value 'abc' for '--width",
            ": expected a whole number from 1 to",
            "For more information, try '--help'.\n",
        ],
    );
    // What only the scene can tell is said like what the parser can.
    let run = stage.run("render scene.toml --crop 0,0,41,30");
    run.fails(2, &["error: the crop 0,0,41,30 is not", "\n\nFor more information, try '--help'.\n"]);
    // Of what does not suit the scene, too.
    stage.run("render scene.toml --light-path a=D -o a.exr").fails(2, &["--light-path a", "column 1"]);
    stage.run("render scene.toml --light-path R=C.* -o a.exr").fails(2, &["another channel"]);
    stage.write("moving.gltf", super::series::MOVING);
    for (option, what) in
        [("variant", "variant"), ("camera", "camera"), ("animation", "animation"), ("scene", "scene")]
    {
        stage
            .run(&format!("render moving.gltf --{option} Foo -o a.png"))
            .fails(2, &["moving.gltf#/", &format!("there is no {what}"), "\"Foo\""]);
    }
    stage.run("view scene.toml --export h.html --pixel 40,2").fails(2, &["pixel 40 2 is outside"]);
    stage.run("view scene.toml --export h.html --sample 9").fails(2, &["there is no sample 9"]);
    stage.run("inspect scene.toml 20 15 --bounce 99").fails(2, &["there is no bounce 99"]);
    for arguments in ["render nowhere.toml", "rendr scene.toml", "render scene.toml --crop 0,0,41,30"] {
        let output = stage.command(arguments).env("CLICOLOR_FORCE", "1").output().unwrap();
        let colored = String::from_utf8(output.stderr).unwrap();
        assert!(colored.starts_with("\u{1b}[1m\u{1b}[31merror:\u{1b}[0m "), "{colored:?}");
        assert!(!stage.run(arguments).stderr.contains('\u{1b}'));
    }
    assert!(!stage.run("rendr").stderr.contains("tip:"));
    assert_eq!(stage.run("--help").code, Some(0));
    assert_eq!(stage.run("--version").code, Some(0));
}

#[test]
fn an_output_that_cannot_be_is_refused_before_rendering() {
    let stage = Stage::new("refused");
    endless(&stage);
    stage
        .run("render endless.toml -o p.bmp")
        .fails(2, &["p.bmp", ".bmp", ".png, .jpg, .jpeg, .webp, .exr, .hdr, .pfm, .ppm, .gif, .apng"]);
    stage.run("render endless.toml -o p.png --quality 80").fails(2, &["--quality", "JPEG", "p.png"]);
    for (name, bits) in [("p.webp", 16), ("p.hdr", 16), ("p.exr", 8), ("p.png", 32)] {
        let run = stage.run(&format!("render endless.toml -o {name} --bits {bits}"));
        run.fails(2, &[&format!("{name} cannot have --bits {bits}"), "of PNGs have 8 or 16"]);
    }
    stage.run("render endless.toml -o p.png --bits 12").fails(2, &["--bits", "8, 16, 32"]);
    stage.run("render endless.toml -o p.exr --film --bits 16").fails(2, &["--film", ".exr of 32 bits"]);
    stage.run("render endless.toml -o p.jpg --quality 0").fails(2, &["from 1 to 100"]);
    stage.run("render endless.toml -o picture").fails(2, &["no extension"]);
    stage.run("render endless.toml -o scene.toml/p.png").fails(3, &["scene.toml is not a folder"]);
    stage.run("render endless.toml -o scene.toml/new/").fails(3, &["scene.toml is not a folder"]);
    std::fs::create_dir(stage.path("folder.png")).unwrap();
    stage
        .run("render endless.toml scene.toml -o {name}.toml/p.png")
        .fails(3, &["endless.toml is not a folder"]);
    stage.run("render endless.toml scene.toml -o p.png").fails(2, &["one file p.png", "{name}"]);
    stage.run("render endless.toml scene.toml -o -").fails(2, &["one scene"]);
    stage.run("render endless.toml endless.toml").fails(2, &["both be endless.png"]);
    stage.run("render endless.toml --json -o -").fails(2, &["--json"]);
    assert_eq!(stage.names(), ["endless.toml", "folder.png", "model.obj", "scene.toml"]);
}

#[test]
#[cfg(target_os = "linux")]
fn a_folder_that_cannot_be_written_to() {
    let stage = Stage::new("unwritable");
    endless(&stage);
    // Not even root makes files there.
    stage.run("render endless.toml -o /proc/p.png").fails(3, &["cannot write into the folder /proc"]);
}

#[test]
fn options_that_make_no_sense() {
    let stage = Stage::new("options");
    endless(&stage);
    for (option, says) in [
        ("--crop 0,0,41,30", "40 × 30"),
        ("--crop 5,5,5,9", "X0 < X1"),
        ("--crop 1,2,3", "X0,Y0,X1,Y1"),
        ("--width 0", "--width"),
        ("--width 4000000000", "at most"),
        ("--samples 0", "--samples"),
        ("--integrator magic", "raycast"),
        ("--filter cone", "blackman_harris"),
        ("--lookfrom 1,2", "X,Y,Z"),
        ("--fov 180", "0 and 180"),
        ("--exposure NaN", "-64 to 64"),
        ("--min-contribution -1", "0 to 1"),
        ("--threads 0", "--threads"),
        ("--no-such-option", "--no-such-option"),
    ] {
        stage.run(&format!("render endless.toml {option}")).fails(2, &["error: ", says]);
    }
    stage.run("").fails(2, &["Usage"]);
    stage.run("render").fails(2, &["SCENE"]);
    stage.run("inspect scene.toml 40 0").fails(2, &["40 × 30"]);
    stage.run("inspect scene.toml 0 0 --sample 4").fails(2, &["4 samples"]);
}

#[test]
fn a_camera_that_cannot_see() {
    let stage = Stage::new("blind");
    stage.run("render scene.toml --lookfrom 0,0.5,0").fails(2, &["the command line: ", "same point"]);
}

#[test]
fn warnings_and_strict() {
    let stage = Stage::new("warnings");
    stage.write("model.obj", "mtllib none.mtl\nusemtl nothing\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let small = "render model.obj --width 8 --samples 1";
    let run = stage.done(&format!("{small} --json"));
    assert!(run.stderr.contains("warning: ") && run.stderr.contains("none.mtl"), "{}", run.stderr);
    assert!(!run.json()[0]["warnings"].as_array().unwrap().is_empty());
    std::fs::remove_file(stage.path("model.png")).unwrap();
    stage.run(&format!("{small} --strict")).fails(1, &["--strict", "none.mtl"]);
    assert!(!stage.path("model.png").exists());
}

#[test]
fn harmless_warnings_are_notes_of_one_line_that_strict_allows() {
    let stage = Stage::new("notes");
    let flat = format!("{MODEL}f 1 1 2\nf 3 3 3\n");
    let names = ["a", "b", "c", "d", "e"].map(|name| format!("{name}.obj"));
    names.iter().for_each(|name| stage.write(name, &flat));
    let models: String = names.iter().map(|name| format!("[[mesh]]\nfile = \"{name}\"\n\n")).collect();
    let head = "[camera]\nlookfrom = [0, 0, 5]\nlookat = [0, 0, 0]\n\n[[light]]\ntype = \"ambient\"\ncolor = 0.1\n\n";
    stage.write("all.toml", &format!("{head}{models}"));
    let run = stage.done("render all.toml --width 8 --samples 1 --strict --json");
    let note = "10 triangles left out: without area (also at b.obj:5, c.obj:5 and 2 more places)";
    assert!(run.stderr.contains(&format!("note: a.obj:5: {note}\n")), "{}", run.stderr);
    assert_eq!((run.stderr.matches("note: ").count(), run.stderr.matches("warning: ").count()), (1, 0));
    let summary = &run.json()[0];
    assert_eq!(summary["notices"].as_array().map(Vec::len), Some(1), "{summary}");
    assert_eq!(summary["warnings"], serde_json::json!([]));
    // One that matters comes before them, and is what --strict tells of.
    stage.write("e.obj", &format!("mtllib none.mtl\n{flat}"));
    let run = stage.done("render all.toml --width 8 --samples 1");
    let [warning, note] = ["warning: e.obj:1", "note: a.obj:5"].map(|line| run.stderr.find(line));
    assert!(warning.is_some() && warning < note, "{}", run.stderr);
    let run = stage.run("info all.toml --strict");
    assert!(!run.stderr.contains("without area"), "{}", run.stderr);
    run.fails(1, &["--strict", "none.mtl"]);
}

#[test]
fn many_warnings_are_counted() {
    let stage = Stage::new("many");
    let libraries: String = (0..30).map(|i| format!("mtllib none{i}.mtl\n")).collect();
    stage.write("many.obj", &format!("{libraries}{MODEL}"));
    let run = stage.done("render many.obj --width 8 --samples 1");
    assert_eq!(run.stderr.matches("warning: ").count(), 21, "{}", run.stderr);
    assert!(run.stderr.contains("… and 10 more"), "{}", run.stderr);
}

#[test]
fn the_next_scene_is_rendered_after_an_error() {
    let stage = Stage::new("next");
    let run = stage.run("render nowhere.toml scene.toml --json -o {name}.png");
    assert_eq!(run.code, Some(1));
    let objects = run.json();
    assert!(objects[0]["error"].as_str().unwrap().contains("no such file"));
    assert_eq!(objects[1]["output"], "scene.png");
    assert!(stage.path("scene.png").exists());
}

#[test]
fn a_picture_is_replaced_as_a_whole() {
    let stage = Stage::new("replaced");
    stage.write("p.png", "what was there before");
    stage.run("render nowhere.toml -o p.png").fails(1, &[]);
    assert_eq!(stage.bytes("p.png"), b"what was there before");
    stage.done("render scene.toml -q -o p.png");
    assert!(stage.bytes("p.png").starts_with(b"\x89PNG"));
    assert_eq!(stage.names(), ["model.obj", "p.png", "scene.toml"]);
}
