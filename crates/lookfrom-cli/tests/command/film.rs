//! Films: kept, killed, resumed, merged and developed by the command.

use std::process::{Command, Stdio};
use std::time::Duration;

use lookfrom_scene::{Disk, LoadContext, image};

use super::stage::{SCENE, Stage};

#[test]
#[cfg(unix)]
fn line_feeds_in_names_and_values_are_kept() {
    let stage = Stage::new("film-lines");
    stage.write("a\nb.toml", &format!("[variables]\nwords = \"\"\n{SCENE}"));
    let render = ["render", "a\nb.toml", "-o", "a.exr", "--film", "--samples", "2", "-D", "words=\n--seed=7"];
    assert!(stage.command("").args(render).status().unwrap().success());
    stage.done("resume a.exr --samples 3");
    let told = String::from_utf8(stage.done("info a.exr").stdout).unwrap();
    assert!(told.contains("a\nb.toml"), "{told}");
}

#[test]
fn parts_in_any_order_are_the_film_of_one_render() {
    let stage = Stage::new("film-parts");
    stage.done("render scene.toml -o whole.exr --film");
    for part in ["1/3", "2/3", "3/3"] {
        stage.done(&format!("render scene.toml -o part-{}.exr --film --part {part}", &part[..1]));
    }
    stage.done("merge part-3.exr part-1.exr part-2.exr -o merged.exr");
    assert!(stage.bytes("merged.exr") == stage.bytes("whole.exr"));
    stage.done("render scene.toml -o a.exr --film --samples 0..1");
    stage.done("render scene.toml -o b.exr --film --samples 1..4");
    stage.done("merge b.exr a.exr -o merged.exr");
    assert!(stage.bytes("merged.exr") == stage.bytes("whole.exr"));
    stage
        .run("merge a.exr a.exr -o x.exr")
        .fails(1, &["a.exr: samples 0..1 of pixel 0 0 would be there twice"]);
    stage.done("render scene.toml -o c.exr --film --seed 3 --samples 1..4");
    stage.run("merge a.exr c.exr -o x.exr").fails(1, &["c.exr", "seed is 3 there, 0 here"]);
    assert!(!stage.path("x.exr").exists());
}

/// All of an adaptive picture decides where its samples are.
#[test]
fn parts_of_adaptive_pictures_are_not_merged() {
    let stage = Stage::new("film-adaptive");
    for adaptive in ["--noise 0.5", "--allocation adaptive --samples 16"] {
        for (part, crop) in [("a", "0,0,40,8"), ("b", "0,8,40,30")] {
            stage.done(&format!("render scene.toml -o {part}.exr --film --crop {crop} {adaptive}"));
        }
        stage.run("merge a.exr b.exr -o x.exr").fails(1, &["b.exr: an adaptive picture has no parts"]);
        stage.done("merge a.exr -o x.exr");
    }
}

/// The film of a scene with a lens file is the same in any folder, and however the scene is named.
#[test]
fn lens_files_may_be_anywhere() {
    let stage = Stage::new("film-lens");
    for folder in ["a", "b"] {
        std::fs::create_dir_all(stage.path(&format!("{folder}/lenses"))).unwrap();
        stage.write(&format!("{folder}/lenses/single.dat"), "60 6 1.5 20\n0 2 0 10\n-60 50 1 20\n");
        let camera = "[camera]\nlens = \"lenses/single.dat\"\nfilm = 35";
        let scene = SCENE.replacen("[camera]", camera, 1).replacen("fov", "#fov", 1);
        stage.write(&format!("{folder}/s.toml"), &scene);
    }
    stage.done("render a/s.toml -o a/1.exr --film --part 1/2");
    let b = stage.path("b/s.toml").display().to_string();
    let two = ["render", &b, "-o", "b/2.exr", "--film", "--part", "2/2"];
    assert!(stage.command("").args(two).status().unwrap().success());
    stage.done("merge a/1.exr b/2.exr -o merged.exr");
    stage.done("render a/s.toml -o whole.exr --film");
    assert!(stage.bytes("merged.exr") == stage.bytes("whole.exr"));
}

/// A film that has all its samples knows its environment map by name alone.
#[test]
fn resume_is_told_where_the_environment_is() {
    let stage = Stage::new("film-environment");
    std::fs::create_dir_all(stage.path("maps")).unwrap();
    stage.done("render scene.toml -q --size 32x16 -o maps/sky.exr");
    stage.done("render model.obj -o m.exr --film --size 16 --samples 2 --environment maps/sky.exr");
    stage.run("resume m.exr --samples 3").fails(1, &["sky.exr: no such file"]);
    stage.done("resume m.exr --samples 3 --environment maps/sky.exr");
}

#[test]
fn a_damaged_part_is_named_and_rendered_again() {
    let stage = Stage::new("film-damaged");
    stage.done("render scene.toml -o whole.exr --film");
    for part in [1, 2] {
        stage.done(&format!("render scene.toml -o part-{part}.exr --film --part {part}/2"));
    }
    let mut bytes = stage.bytes("part-2.exr");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 4;
    std::fs::write(stage.path("part-2.exr"), bytes).unwrap();
    stage.run("merge part-1.exr part-2.exr -o merged.exr").fails(1, &["part-2.exr: this file is damaged"]);
    stage.run("merge part-1.exr part-2.exr --check -o whole.exr").fails(2, &["--check"]);
    let check = stage.run("merge part-1.exr part-2.exr part-3.exr --check");
    assert_eq!(String::from_utf8_lossy(&check.stdout), "part-2.exr\npart-3.exr\n");
    assert_eq!(check.code, Some(1));
    let again = stage.done("render scene.toml -o part-2.exr --film --part 2/2 --continue");
    assert!(again.stderr.contains("damaged"), "{}", again.stderr);
    stage.done("merge part-1.exr part-2.exr -o merged.exr");
    assert!(stage.bytes("merged.exr") == stage.bytes("whole.exr"));
    // A part that is complete is not rendered again.
    let before = stage.bytes("part-1.exr");
    let again = stage.json("render scene.toml -o part-1.exr --film --part 1/2 --continue --json");
    assert_eq!(again[0]["rays"]["total"], 0);
    assert!(stage.bytes("part-1.exr") == before);
    // Another part is not added to it.
    stage
        .run("render scene.toml -o part-1.exr --film --part 2/2 --continue")
        .fails(2, &["samples 0..2", "2..4"]);
}

#[test]
#[cfg(unix)]
fn killed_fifty_times_it_is_the_same_film() {
    let stage = Stage::new("film-killed");
    let scene = SCENE.replace("samples = 4", "samples = 4000");
    stage.write("scene.toml", &scene);
    stage.done("render scene.toml -o whole.exr --film");
    let mut kills = 0;
    let go_on = "render scene.toml -o a.exr --film --checkpoint 1ms --continue -q";
    for run in 0..400_u64 {
        let mut child = stage.command(go_on).stdout(Stdio::null()).spawn().unwrap();
        // Moments all over a render, its checkpoints and its end.
        std::thread::sleep(Duration::from_millis(20 + run * 37 % 90));
        if child.try_wait().unwrap().is_none() {
            child.kill().unwrap();
            kills += 1;
        }
        child.wait().unwrap();
        let is_whole = stage.path("a.exr").exists() && stage.bytes("a.exr") == stage.bytes("whole.exr");
        if is_whole && kills >= 50 {
            break;
        }
        if is_whole {
            std::fs::remove_file(stage.path("a.exr")).unwrap();
        }
    }
    assert!(kills >= 50, "{kills} kills");
    stage.done(go_on);
    assert!(stage.bytes("a.exr") == stage.bytes("whole.exr"));
}

#[test]
#[cfg(unix)]
fn interrupted_renders_are_resumed() {
    let stage = Stage::new("film-interrupted");
    stage.write("scene.toml", &SCENE.replace("samples = 4", "samples = 3000"));
    stage.done("render scene.toml -o whole.exr --film --width 80 --exposure 1");
    let mut command = stage.command("render scene.toml -o a.exr --film --width 80 --exposure 1 --threads 1");
    let child = command.stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(400));
    assert!(Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap().success());
    let code = child.wait_with_output().unwrap().status.code();
    assert!(matches!(code, Some(0 | 130)), "{code:?}");
    if code == Some(130) && stage.path("a.exr").exists() {
        stage.done("resume a.exr");
        assert!(stage.bytes("a.exr") == stage.bytes("whole.exr"));
    }
    // A film that is complete takes more samples, and says so if it is asked for no more.
    stage.run("resume whole.exr").fails(2, &["has all its samples", "--samples"]);
    stage.done("render scene.toml -o few.exr --film --samples 3 --width 80 --exposure 1");
    stage.done("resume few.exr --samples 3000 -o more.exr");
    assert!(stage.bytes("more.exr") == stage.bytes("whole.exr"));
    stage.run("resume whole.exr --samples 5 -o x.exr").fails(2, &["the film has samples 0..3000", "0..5"]);
    // The scene is another one now.
    stage.write("scene.toml", &SCENE.replace("radius = 0.5", "radius = 0.6"));
    stage.run("resume few.exr --samples 5").fails(1, &["scene.toml has another content"]);
}

#[test]
fn films_are_developed_without_rendering() {
    let stage = Stage::new("film-developed");
    stage.done("render scene.toml -o a.exr --film --denoise on");
    stage.done("render scene.toml -o a.png --denoise on --exposure 1 --tonemap agx");
    stage.done("develop a.exr -o b.png --exposure 1 --tonemap agx");
    assert!(stage.bytes("a.png") == stage.bytes("b.png"));
    stage.done("render scene.toml -o plain.exr");
    stage.done("develop a.exr -o noisy.exr --denoise off");
    assert!(stage.bytes("noisy.exr") == stage.bytes("plain.exr"));
    // Layers beside the picture are nothing to a format without layers.
    let mut command = stage.command("render scene.toml -o paths.exr --film --denoise on --light-path");
    assert!(command.arg("direct=CD[LB]").output().unwrap().status.success());
    stage.done("develop paths.exr -o paths.png --exposure 1 --tonemap agx");
    assert!(stage.bytes("a.png") == stage.bytes("paths.png"));
    // The exposure by what a picture shows, of films and others, is one that can be repeated.
    for dark in ["a.exr", "plain.exr"] {
        let run = stage.done(&format!("develop {dark} -o auto.png --exposure auto"));
        let stops = run.stderr.split("the exposure is ").nth(1).and_then(|rest| rest.split(',').next());
        stage.done(&format!("develop {dark} -o again.png --exposure={}", stops.expect(&run.stderr)));
        assert!(stage.bytes("auto.png") == stage.bytes("again.png"));
        stage.done(&format!("develop {dark} -o zero.png --exposure 0"));
        assert!(stage.bytes("auto.png") != stage.bytes("zero.png"));
    }
    // A layer can be developed for itself, and compared.
    stage.done("develop paths.exr -o direct.exr --layer direct");
    let read = |file: &str| image::read_exr(&stage.path(file), &mut LoadContext::new(&Disk)).unwrap();
    let (of_film, alone) = (read("paths.exr"), read("direct.exr"));
    for channel in ["R", "G", "B"] {
        assert_eq!(of_film.channel(&format!("direct.{channel}")), alone.channel(channel));
    }
    let same = &stage.json("compare paths.exr paths.exr --layer direct --json")[0];
    assert_eq!((&same["rmse"], &same["noise"]), (&0.0.into(), &serde_json::Value::Null));
    stage
        .run("develop paths.exr -o x.png --layer indirect")
        .fails(1, &["no layer \"indirect\"", "\"direct\""]);
    stage.run("develop a.png -o x.png --layer direct").fails(1, &["only OpenEXR pictures have layers"]);
    // Any EXR can be developed, but not denoised.
    stage.done("develop plain.exr -o plain.png");
    stage.done("render scene.toml -o same.png");
    assert!(stage.bytes("plain.png") == stage.bytes("same.png"));
    stage.run("develop plain.exr -o x.png --denoise").fails(2, &["plain.exr is no film"]);
    stage.run("develop a.exr -o x.png --background white").fails(2, &["no alpha"]);
    // A picture of the call is not overwritten before it is read, nor after.
    std::fs::copy(stage.path("a.exr"), stage.path("1.exr")).unwrap();
    let before = stage.bytes("1.exr");
    stage.run("develop a.exr 1.exr -o {n}.exr").fails(3, &["1.exr", "it is the scene itself"]);
    assert!(stage.bytes("1.exr") == before && !stage.names().contains(&"2.exr".to_owned()));
}

#[test]
fn what_cannot_be_a_film_is_told_before_rendering() {
    let stage = Stage::new("film-usage");
    stage.run("render scene.toml -o a.png --film").fails(2, &["--film needs an .exr", "develop"]);
    stage.run("render scene.toml -o a.exr --checkpoint 1s").fails(2, &["--film"]);
    stage.run("render scene.toml -o a.exr --film --part 2/9").fails(2, &["part 2 of 9 of the samples 0..4"]);
    stage.run("render scene.toml -o a.exr --film --part 1/2 --noise 0.1").fails(2, &["cannot be adaptive"]);
    stage.run("merge scene.toml -o a.png").fails(2, &["a.png is no .exr"]);
    stage.run("resume missing.exr").fails(1, &["missing.exr: no such file"]);
    stage.done("render scene.toml -o plain.exr");
    stage.run("resume plain.exr").fails(1, &["plain.exr", "has no film", "--film"]);
    stage.run("render scene.toml -o plain.exr --film --continue").fails(1, &["has no film"]);
    assert_eq!(stage.names().len(), 3);
}

#[test]
fn a_part_is_not_replaced_by_its_sum() {
    let stage = Stage::new("film-own-part");
    stage.done("render scene.toml -o p1.exr --film --part 1/2");
    stage.done("render scene.toml -o p2.exr --film --part 2/2");
    let before = stage.bytes("p1.exr");
    for output in ["p1.exr", "./p1.exr"] {
        stage.run(&format!("merge p1.exr p2.exr -o {output}")).fails(3, &["p1.exr: it is", "another name"]);
    }
    assert!(stage.bytes("p1.exr") == before);
}

#[test]
fn films_that_differ_in_layers_say_so() {
    let stage = Stage::new("film-layers");
    stage.done("render scene.toml -o a.exr --film --samples 0..1");
    stage.done("render scene.toml -o b.exr --film --samples 1..2 --layers geometry");
    stage.run("merge a.exr b.exr -o x.exr").fails(1, &["b.exr", "layers is geometry there, none here"]);
    stage.run("merge b.exr a.exr -o x.exr").fails(1, &["a.exr", "layers is none there, geometry here"]);
    let mut command = stage.command("render scene.toml -o c.exr --film --samples 1..2 --light-path");
    assert!(command.arg("direct=C<RD>L").output().unwrap().status.success());
    stage.run("merge a.exr c.exr -o x.exr").fails(1, &["light-path direct is C<RD>L there, not set here"]);
}

#[test]
fn films_of_other_moments_say_so() {
    let stage = Stage::new("film-moments");
    let text = "[camera]\nlookfrom = [0, 1, 5]\nlookat = [\"= t\", 0, 0]\n[image]\nwidth = 8\nheight = 8\n[[sphere]]\nradius = 1\n";
    stage.write("moving.toml", text);
    stage.done("render moving.toml -o a.exr --film --samples 0..1 --at 500ms --shutter 0.25");
    let header = image::read_exr(&stage.path("a.exr"), &mut LoadContext::new(&Disk)).unwrap().attributes;
    for (name, text) in [("time", "0.5"), ("fps", "24"), ("shutter", "0.25")] {
        assert!(header.contains(&(name.to_owned(), text.to_owned())), "{name}: {header:?}");
    }
    stage.done("render moving.toml -o b.exr --film --samples 1..2 --at 0.5 --shutter 0.5");
    stage.run("merge a.exr b.exr -o x.exr").fails(1, &["b.exr", "shutter is 0.5 there, 0.25 here"]);
    stage.done("render moving.toml -o c.exr --film --samples 1..2 --at 0.5 --shutter 0.25 --fps 24000/1001");
    stage.run("merge a.exr c.exr -o x.exr").fails(1, &["c.exr", "fps is 23.976", "24 here"]);
}

#[test]
fn a_film_is_the_same_in_every_folder_and_finds_its_scene() {
    let stage = Stage::new("film-folders");
    let sky: Vec<[f32; 3]> = vec![[1.0, 0.5, 0.25]; 8];
    let sky = image::encode_hdr(4, 2, &sky).unwrap();
    std::fs::create_dir_all(stage.path("maps")).unwrap();
    std::fs::write(stage.path("maps/sky.hdr"), sky).unwrap();
    let call = "render scene.toml --film --samples 2 --environment maps/sky.hdr -o";
    stage.done(&format!("{call} a.exr"));
    stage.done(&format!("{call} deep/er/a.exr"));
    assert!(stage.bytes("a.exr") == stage.bytes("deep/er/a.exr"));
    std::fs::write(stage.path("sky.hdr"), stage.bytes("maps/sky.hdr")).unwrap();
    stage.done("resume deep/er/a.exr --samples 4 -o b.exr");
    stage.done("render scene.toml --film --samples 4 --environment maps/sky.hdr -o c.exr");
    assert!(stage.bytes("b.exr") == stage.bytes("c.exr"));
    // Another name for the same scene, and a film that does not find its own.
    std::fs::rename(stage.path("scene.toml"), stage.path("renamed.toml")).unwrap();
    stage.run("resume a.exr --samples 4 -o d.exr").fails(2, &["scene.toml", "--scene-file"]);
    stage.done("resume a.exr --samples 4 -o d.exr --scene-file renamed.toml");
    stage.write("other.toml", &SCENE.replace("radius = 0.5", "radius = 0.6"));
    stage.run("resume a.exr --samples 4 -o e.exr --scene-file other.toml").fails(1, &["another content"]);
}

#[test]
#[cfg(unix)]
fn a_finished_picture_outlives_a_failed_write() {
    let stage = Stage::new("film-rescued");
    let kept = |stderr: &str| {
        let (_, path) =
            stderr.split_once("the finished picture is kept in ").unwrap_or_else(|| panic!("{stderr}"));
        path.lines().next().unwrap().to_owned()
    };
    // Too long a name for any file system, which the temporary name is not.
    let name = "n".repeat(300);
    stage.done("render scene.toml -q -o good.png");
    let run = stage.run(&format!("render scene.toml -q -o {name}.png"));
    assert_eq!(run.code, Some(3), "{}", run.stderr);
    assert!(stage.bytes(&kept(&run.stderr)) == stage.bytes("good.png"));
    stage.done("render scene.toml -q --film -o good.exr");
    let run = stage.run(&format!("render scene.toml -q --film -o {name}.exr"));
    assert!(stage.bytes(&kept(&run.stderr)) == stage.bytes("good.exr"));
    // Who reads no further does not want it.
    let before = stage.names();
    let script = format!(
        "'{}' render scene.toml -q -o - --format ppm --size 400 | head -c 1",
        env!("CARGO_BIN_EXE_lookfrom")
    );
    let piped = Command::new("sh").current_dir(stage.path("")).args(["-c", &script]).output().unwrap();
    assert!(!String::from_utf8_lossy(&piped.stderr).contains("is kept"), "{piped:?}");
    assert_eq!(stage.names(), before);
    #[cfg(target_os = "linux")]
    {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let run = stage.command("render scene.toml -q -o -").stdout(full).output().unwrap();
        let stderr = String::from_utf8_lossy(&run.stderr).into_owned();
        assert!(stage.bytes(&kept(&stderr)) == stage.bytes("good.png"));
    }
}

#[test]
fn a_level_that_is_none_is_told() {
    let stage = Stage::new("film-level");
    let run = |word: &str| {
        let run = stage.command("info scene.toml").env("LOOKFROM_SIMD", word).output().unwrap();
        String::from_utf8(run.stderr).unwrap()
    };
    assert!(run("bogus").contains("LOOKFROM_SIMD=bogus"));
    assert_eq!(run(""), "");
}

#[test]
fn the_files_of_a_scene_are_listed() {
    let stage = Stage::new("film-files");
    stage.write("scene.toml", &format!("{SCENE}\n[[mesh]]\nfile = \"model.obj\"\n"));
    let run = stage.done("files scene.toml");
    assert_eq!(String::from_utf8_lossy(&run.stdout), "model.obj\nscene.toml\n");
    let objects = stage.json("files scene.toml --json");
    assert_eq!((objects.len(), objects[0]["sha256"].as_str().unwrap().len()), (2, 64));
    assert_eq!(stage.done("files scene.toml -0").stdout, b"model.obj\0scene.toml\0");
}
