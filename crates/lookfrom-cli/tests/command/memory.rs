//! One limit for all that files make the command allocate: `--memory`.

use super::stage::Stage;

#[test]
fn a_film_that_does_not_fit_is_refused_before_it_is_allocated() {
    let stage = Stage::new("memory-film");
    let run = stage.run("render scene.toml -q -o a.png --size 4000 --samples 1 --memory 200MB");
    run.fails(
        1,
        &[
            "the film of 4000 × 4000 pixels takes",
            "of the limit of 190.7 MiB",
            "--memory SIZE",
            "--crop",
            "merge",
        ],
    );
    assert!(!run.stderr.contains("damaged"), "{}", run.stderr);
    let run = stage.run("render scene.toml -q -o a.png --size 40000 --samples 1");
    run.fails(2, &["at most 1073741824 pixels", "window"]);
    stage.done("render scene.toml -q -o a.png --size 400 --samples 1 --memory 200MB");
}

#[test]
fn everything_that_is_read_counts() {
    let stage = Stage::new("memory-all");
    stage.done("render scene.toml -q -o a.exr --film --size 200 --samples 1");
    stage.done("render scene.toml -q -o a.png --size 200 --samples 1");
    for command in [
        "render model.obj -q -o b.png --size 8",
        "inspect scene.toml 1 1",
        "info model.obj",
        "info a.exr",
        "bench model.obj",
        "files model.obj",
        "resume a.exr -q --samples 2",
        "merge a.exr -q -o b.exr",
        "develop a.exr -o b.png",
        "develop a.png -o b.jpg",
        "compare a.png a.png",
    ] {
        stage
            .run(&format!("{command} --memory 0.05kb"))
            .fails(1, &["of memory, but of the limit of 50 bytes"]);
        stage.done(&format!("{command} --memory 1GiB"));
    }
    stage.run("info model.obj --memory 12").fails(2, &["expected a size with its unit"]);
}
