//! Ctrl-C and SIGTERM.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use super::stage::{Run, SCENE, Stage};

/// Starts a render that would take hours, and sends it a signal after `pause`.
fn interrupted(stage: &Stage, signal: &str, output: &str, pause: Duration) -> Run {
    let mut command = stage.command(&format!("render endless.toml --threads 1 --json -o {output}"));
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(pause);
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let sent = Instant::now();
    let run = Run::from(child.wait_with_output().unwrap());
    assert!(sent.elapsed() < Duration::from_secs(20), "it took {:?} to stop", sent.elapsed());
    run
}

#[test]
fn the_picture_so_far_is_kept() {
    for (signal, output) in [("-INT", "p.png"), ("-TERM", "p.exr")] {
        let stage = Stage::new(&format!("interrupt{signal}"));
        stage.write("endless.toml", &SCENE.replace("samples = 4", "samples = 10000000"));
        // On a busy machine it may take a while until the first samples of so small a picture are there.
        let pauses = [300, 1000, 4000, 16000].map(Duration::from_millis);
        let mut runs = pauses.iter().map(|&pause| interrupted(&stage, signal, output, pause));
        let run = runs.find(|run| run.stderr.contains("picture so far") && !run.stderr.contains(": 0 of"));
        let run = run.expect("no run came to a picture");
        assert_eq!(run.code, Some(130), "{}", run.stderr);
        assert!(run.stderr.contains(&format!("{output} holds the picture so far")), "{}", run.stderr);
        let summary = &run.json()[0];
        assert_eq!(summary["cancelled"], true);
        assert!(summary["samples_taken"].as_u64().unwrap() > 0);
        assert!(stage.bytes(output).len() > 100);
        assert_eq!(stage.names(), ["endless.toml", "model.obj", output, "scene.toml"]);
    }
}

/// Interrupted renders with `--skip-existing`: the next call would skip their files.
#[test]
fn what_the_next_call_would_skip_is_not_written_half_done() {
    let stage = Stage::new("interrupt-skip");
    stage.write("endless.toml", &SCENE.replace("samples = 4", "samples = 10000000"));
    for output in ["p.png --skip-existing", "p.gif --turntable 2 --skip-existing"] {
        let run = interrupted(&stage, "-INT", output, Duration::from_millis(1500));
        assert_eq!(run.code, Some(130), "{}", run.stderr);
        assert_eq!(stage.names(), ["endless.toml", "model.obj", "scene.toml"], "{output}");
    }
    stage.run("render scene.toml -o p.exr --skip-existing --film").fails(2, &["--skip-existing", "--film"]);
}
