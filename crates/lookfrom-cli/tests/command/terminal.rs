//! Pictures in the terminal, and what `-v` tells.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::stage::Stage;

/// The PNG in a text of kitty's graphics protocol.
fn of_kitty(text: &str) -> image::RgbImage {
    let pieces = text.split("\x1b\\").filter_map(|piece| piece.split_once("\x1b_G")?.1.split_once(';'));
    let payload: String = pieces.map(|(_, data)| data).collect();
    image::load_from_memory(&STANDARD.decode(payload).unwrap()).unwrap().into_rgb8()
}

#[test]
fn the_picture_in_the_terminal_is_that_of_the_file() {
    let stage = Stage::new("show");
    let of = "render scene.toml -q --width 40 --samples 1 -o p.png";
    let run = stage.done(&format!("{of} --show kitty"));
    let picture = image::load_from_memory(&stage.bytes("p.png")).unwrap().into_rgb8();
    assert!(of_kitty(&run.stderr) == picture);
    // Larger ones are reduced to the 80 columns that there are without a terminal.
    let run =
        stage.done("render scene.toml -q --width 1600 --height 400 --samples 1 -o large.png --show kitty");
    assert_eq!(of_kitty(&run.stderr).dimensions(), (800, 200));
    let run = stage.done(&format!("{of} --show blocks"));
    let lines = run.stderr.lines().filter(|line| line.contains('▀'));
    assert_eq!(lines.count() as u32, picture.height().div_ceil(2));
    assert!(stage.done(&format!("{of} --show=sixel")).stderr.starts_with("\x1bP0;1;0q\"1;1;40;"));
    // A sheet is drawn once, as a whole.
    let run = stage
        .done("render model.obj -q --views front,top --size 10 --samples 1 --sheet 2 -o s.png --show kitty");
    assert_eq!(of_kitty(&run.stderr).dimensions(), (20, 10));
}

#[test]
fn nothing_is_drawn_where_there_is_no_terminal_or_stdout_is_the_picture() {
    let stage = Stage::new("show-nothing");
    let run = stage.done("render scene.toml -q --width 8 --samples 1 -o p.png --show");
    assert_eq!(run.stderr, "");
    stage.run("render scene.toml --show kitty -o -").fails(2, &["--show"]);
    stage.run("render scene.toml --show ascii -o p.png").fails(2, &["kitty", "sixel", "blocks"]);
}

#[test]
fn verbose_tells_of_contents_settings_and_times() {
    let stage = Stage::new("verbose");
    let of = "render model.obj --size 8 --samples 3 -o p.png";
    let plain = stage.done(of).stderr;
    assert!(!plain.contains("steps of"), "{plain}");
    let told = stage.done(&format!("{of} -v")).stderr;
    for word in
        ["triangles", "camera", "path, 3 samples", "steps of model.obj", "develop", "denoised", "memory"]
    {
        assert!(told.contains(word), "{word:?} is not in: {told}");
    }
    assert!(!told.contains("  file  "), "{told}");
    let more = stage.done(&format!("{of} -vv")).stderr;
    assert!(more.contains("file       model.obj, "), "{more}");
    stage.run(&format!("{of} -v -q")).fails(2, &["--quiet", "--verbose"]);
}
