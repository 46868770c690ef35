//! Scenes from stdin, pictures to stdout, folders of scenes, manual pages.

use std::io::Write;
use std::process::Stdio;

use super::stage::{MODEL, Run, SCENE, Stage};

/// Runs the command with a text on stdin.
fn piped(stage: &Stage, arguments: &str, text: &str) -> Run {
    let mut command = stage.command(arguments);
    let command = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    // Who does not read it closes the pipe.
    let _ = child.stdin.take().unwrap().write_all(text.as_bytes());
    child.wait_with_output().unwrap().into()
}

#[test]
fn scenes_come_from_stdin() {
    let stage = Stage::new("stdin");
    for (file, text) in [("scene.toml", SCENE), ("model.obj", MODEL)] {
        stage.done(&format!("render {file} -q --size 16 --samples 1 -o file.ppm"));
        let run = piped(&stage, "render - -q --size 16 --samples 1 -o piped.ppm", text);
        assert_eq!(run.code, Some(0), "{}", run.stderr);
        assert!(stage.bytes("file.ppm") == stage.bytes("piped.ppm"), "{file}");
    }
    // A shell puts a file in the place of a pipe.
    #[cfg(unix)]
    {
        let mut command = stage.command("render /dev/stdin -q --size 16 --samples 1 -o redirected.ppm");
        let model = std::fs::File::open(stage.path("model.obj")).unwrap();
        assert!(command.stdin(model).status().unwrap().success());
        assert!(stage.bytes("redirected.ppm") == stage.bytes("piped.ppm"));
    }
    // Names in it are relative to the current folder.
    let imports = format!("{SCENE}\n[[mesh]]\nfile = \"model.obj\"\n");
    let run = piped(&stage, "render - -q --width 8 --samples 1", &imports);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    assert!(stage.path("stdin.png").exists());
    piped(&stage, "render - -o p.png", "[camera]\nlokfrom = 1\n")
        .fails(1, &["-:2:1", "lokfrom = 1", "lookfrom"]);
    piped(&stage, "render - -o p.png", "").fails(1, &["-"]);
    piped(&stage, "render - -o p.exr --film", SCENE).fails(2, &["--film"]);
}

/// A named pipe as output: EXR is written back and forth, so not straight into it.
#[cfg(unix)]
#[test]
fn a_named_pipe_gets_the_picture_and_stays() {
    use std::os::unix::fs::FileTypeExt;
    let stage = Stage::new("fifo");
    for format in ["exr", "png"] {
        let (pipe, file) = (format!("pipe.{format}"), format!("file.{format}"));
        assert!(std::process::Command::new("mkfifo").arg(stage.path(&pipe)).status().unwrap().success());
        let path = stage.path(&pipe);
        let reader = std::thread::spawn(move || std::fs::read(path).unwrap());
        for output in [&file, &pipe] {
            stage.done(&format!("render scene.toml -q --width 8 --samples 1 -o {output}"));
        }
        assert!(reader.join().unwrap() == stage.bytes(&file), "{format}");
        assert!(std::fs::metadata(stage.path(&pipe)).unwrap().file_type().is_fifo());
    }
}

#[test]
fn pictures_go_to_stdout_in_every_format() {
    let stage = Stage::new("stdout");
    for (format, begin) in [("png", "\u{89}PNG"), ("ppm", "P6"), ("pfm", "PF"), ("gif", "GIF89a")] {
        let run = stage.done(&format!("render scene.toml --width 8 --samples 1 -o - --format {format}"));
        let begin: Vec<u8> = begin.chars().map(|c| c as u8).collect();
        assert!(run.stdout.starts_with(&begin), "{format}");
        assert!(run.stderr.contains("scene.toml → -"), "{}", run.stderr);
    }
    stage.done("render scene.toml model.obj -q --size 8 --samples 1 --format webp -o out/");
    assert!(stage.path("out/scene.webp").exists() && stage.path("out/model.webp").exists());
    stage.run("render scene.toml -o p.png --format jpg").fails(2, &["p.png is not of --format jpg"]);
}

#[test]
fn a_folder_is_all_scenes_in_it() {
    let stage = Stage::new("folder");
    std::fs::create_dir_all(stage.path("shop/more")).unwrap();
    for name in ["shop/b.obj", "shop/a.obj", "shop/more/deeper.obj"] {
        stage.write(name, MODEL);
    }
    stage.write("shop/readme.txt", "no scene");
    stage.write("shop/broken.stl", "solid");
    let run = stage.run("render shop --size 8 --samples 1 -o out/ --json");
    assert_eq!(run.code, Some(1), "{}", run.stderr);
    let scenes: Vec<String> =
        run.json().iter().map(|answer| answer["scene"].as_str().unwrap().to_owned()).collect();
    assert_eq!(scenes, ["shop/a.obj", "shop/b.obj", "shop/broken.stl"]);
    assert!(run.stderr.contains("1 of 3 scenes failed: shop/broken.stl"), "{}", run.stderr);
    assert_eq!(stage.json("info shop/more --json").len(), 1);
    std::fs::create_dir(stage.path("empty")).unwrap();
    stage.run("render empty").fails(2, &["empty: a folder without scenes"]);
}

#[test]
fn manual_pages_are_printed() {
    let stage = Stage::new("man");
    let page = |arguments: &str| String::from_utf8(stage.done(arguments).stdout).unwrap();
    assert!(page("man").contains(".TH lookfrom 1") && page("man").contains("inspect"));
    assert!(page("man render").contains(".TH lookfrom-render 1") && page("man render").contains("turntable"));
    stage.run("man rendr").fails(2, &["did you mean render?"]);
}
