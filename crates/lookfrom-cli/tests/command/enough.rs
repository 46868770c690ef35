//! Renders that end by the clock or when the picture is clean, and pictures that are written meanwhile.

use std::process::Stdio;
use std::time::{Duration, Instant};

use lookfrom_scene::{Disk, LoadContext, image};

use super::stage::{SCENE, Stage};

/// Soft shadows: something that is noisy.
fn noisy(stage: &Stage) {
    let light = SCENE.find("[[light]]").unwrap();
    let lamp =
        "[[light]]\ntype = \"disk\"\ncenter = [3, 4, 5]\nnormal = [-3, -4, -5]\nradius = 2\nradiance = 3\n";
    stage.write("noisy.toml", &format!("{}{lamp}", &SCENE[..light]));
}

#[test]
fn a_time_is_kept_and_the_picture_is_that_of_its_samples() {
    let stage = Stage::new("time");
    let started = Instant::now();
    let summary = &stage.json("render scene.toml --json -o a.exr --time 300ms")[0];
    assert!(started.elapsed() < Duration::from_secs(30));
    assert_eq!((&summary["ended_by"], &summary["cancelled"]), (&"time".into(), &false.into()));
    let samples = summary["samples"].as_u64().unwrap();
    assert!(samples >= 1 && summary["samples_taken"].as_u64() == Some(samples));
    stage.done(&format!("render scene.toml -q -o b.exr --samples {samples}"));
    assert!(stage.bytes("a.exr") == stage.bytes("b.exr"));
    // The number of samples still counts where it is given.
    let summary = &stage.json("render scene.toml --json -o a.exr --time 1h --samples 3")[0];
    assert_eq!((&summary["ended_by"], &summary["samples"]), (&"samples".into(), &3.into()));
}

#[test]
fn a_clean_picture_ends() {
    let stage = Stage::new("noise");
    noisy(&stage);
    let run = stage.done("render noisy.toml --json -o a.exr --noise 0.05 --time 10m --width 80");
    let summary = &run.json()[0];
    assert_eq!(summary["ended_by"], "noise");
    assert!(summary["relative_error"].as_f64().unwrap() <= 0.05);
    let (most, mean) = (summary["samples"].as_u64().unwrap(), summary["samples_taken"].as_u64().unwrap());
    assert!(mean >= 16 && mean <= most, "{mean} {most}");
    assert!(run.stderr.contains("stopped by noise"), "{}", run.stderr);
    stage.done("render noisy.toml -q -o b.exr --noise 0.05 --width 80 --threads 1");
    assert!(stage.bytes("a.exr") == stage.bytes("b.exr"), "threads matter");
    // With a limit it is never more.
    let summary = &stage.json("render noisy.toml --json -o c.exr --noise 0.02 --samples 20")[0];
    assert!(summary["samples"].as_u64().unwrap() <= 20);
}

#[test]
fn a_number_of_samples_is_spent_where_noise_is() {
    let stage = Stage::new("allocation");
    noisy(&stage);
    let run = stage.done("render noisy.toml --json -o a.exr --allocation adaptive --samples 20 --width 60");
    let summary = &run.json()[0];
    let (most, mean) = (summary["samples"].as_u64().unwrap(), summary["samples_taken"].as_u64().unwrap());
    assert!([40, 80, 160].contains(&most) && (18..=20).contains(&mean), "{mean} {most}");
    assert_eq!(summary["ended_by"], "samples");
    let words = format!("{mean} samples per pixel in the mean, at most {most}");
    assert!(run.stderr.contains(&words), "{}", run.stderr);
    stage.done("render noisy.toml -q -o b.exr --allocation adaptive --samples 20 --width 60 --threads 1");
    assert!(stage.bytes("a.exr") == stage.bytes("b.exr"), "threads matter");
    // A limit of noise has no number to spend, a part does not know the others, and few samples know nothing.
    stage.run("render noisy.toml -o c.exr --allocation adaptive --noise 0.1").fails(2, &["limit of noise"]);
    stage
        .run("render noisy.toml -o c.exr --film --allocation adaptive --samples 16 --part 1/2")
        .fails(2, &["cannot be adaptive"]);
    let few = stage.done("render noisy.toml -o c.exr --allocation adaptive --samples 4 --width 60");
    assert!(few.stderr.contains("at least 8 samples"), "{}", few.stderr);
}

#[test]
fn the_picture_is_there_before_the_end() {
    let stage = Stage::new("preview");
    let mut command = stage.command("render scene.toml -q -o p.png --time 10m --write-every 100ms");
    let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
    let started = Instant::now();
    let mut pictures = Vec::new();
    while pictures.len() < 2 && started.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(20));
        if let Ok(written) = std::fs::metadata(stage.path("p.png")).and_then(|file| file.modified())
            && pictures.last() != Some(&written)
        {
            assert!(stage.bytes("p.png").ends_with(b"IEND\xaeB`\x82"), "not whole");
            pictures.push(written);
        }
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(pictures.len(), 2, "the picture was not written again");
    stage.run("render scene.toml -o - --write-every 1s").fails(2, &["--write-every"]);
    // A film in a file is kept by its checkpoints, which a preview would replace.
    stage.run("render scene.toml -o f.exr --film --write-every 1s").fails(2, &["--checkpoint"]);
    stage.run("render scene.toml -o - --format exr --film --time 10m").fails(2, &["a film needs a file"]);
}

#[test]
fn fireflies_are_spread_only_on_demand() {
    let stage = Stage::new("fireflies");
    noisy(&stage);
    stage.done("render noisy.toml -q -o off.pfm");
    stage.done("render noisy.toml -q -o off2.pfm --fireflies off");
    stage.done("render noisy.toml -q -o median.pfm --fireflies median");
    assert!(stage.bytes("off.pfm") == stage.bytes("off2.pfm"));
    let [off, median] = ["off.pfm", "median.pfm"].map(|file| {
        let picture = image::read(&stage.path(file), &mut LoadContext::new(&Disk)).unwrap();
        picture.texels().flatten().map(f64::from).sum::<f64>()
    });
    assert!((off - median).abs() < 1e-4 * off, "{off} {median}");
}

#[test]
fn times_that_are_none() {
    let stage = Stage::new("times");
    for wrong in ["--time 5", "--time 0s", "--write-every x", "--noise 0", "--noise NaN", "--fireflies kill"]
    {
        stage.run(&format!("render scene.toml {wrong}")).fails(2, &["error: "]);
    }
}
