//! Several pictures of a scene: views, frames, sheets, animations.

use std::io::Cursor;

use ::image::codecs::gif::GifDecoder;
use ::image::{AnimationDecoder, RgbaImage};

use super::stage::Stage;

/// A plate of 4 × 2 × 1 with a corner at the origin: its sides have different sizes.
const BOX: &str = "v 0 0 0\nv 4 0 0\nv 4 2 0\nv 0 2 0\nv 0 0 1\nv 4 0 1\nv 4 2 1\nv 0 2 1\n\
                   f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 4 1 5 8\n";

/// A triangle that moves by 4 to the right in a second.
pub(super) const MOVING: &str = r#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
"nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
"animations": [{"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}], "samplers": [{"input": 1, "output": 2}]}],
"accessors": [
{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
{"bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1]},
{"bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3"}],
"bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 8}, {"buffer": 0, "byteOffset": 44, "byteLength": 24}],
"buffers": [{"byteLength": 68, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIBAAAAAAAAAAAA="}]}"#;

/// Pictures that show only where the model is.
const SHAPES: &str = "-q --samples 4 --denoise off --filter box --background transparent";

fn png(stage: &Stage, file: &str) -> RgbaImage {
    ::image::load_from_memory(&stage.bytes(file))
        .unwrap_or_else(|error| panic!("{file}: {error}"))
        .into_rgba8()
}

/// The columns and rows where something is shown: from, before.
fn extent(picture: &RgbaImage) -> [[u32; 2]; 2] {
    let shown = || picture.enumerate_pixels().filter(|(.., pixel)| pixel.0[3] > 127);
    let of = |side: fn((u32, u32)) -> u32| {
        let places = || shown().map(|(x, y, _)| side((x, y)));
        [places().min().unwrap(), places().max().unwrap() + 1]
    };
    [of(|(x, _)| x), of(|(_, y)| y)]
}

fn size(picture: &RgbaImage) -> [u32; 2] {
    extent(picture).map(|[from, before]| before - from)
}

#[test]
fn views_show_their_sides_whole() {
    let stage = Stage::new("views");
    stage.write("box.obj", BOX);
    stage.done(&format!("render box.obj {SHAPES} --size 200 --views all -o v.png"));
    // Width and height of the model as each side shows it, up to scale.
    let sides = [
        ("front", [4, 2]),
        ("back", [4, 2]),
        ("left", [1, 2]),
        ("right", [1, 2]),
        ("top", [4, 1]),
        ("bottom", [4, 1]),
    ];
    for (view, [width, height]) in sides {
        let picture = png(&stage, &format!("v-{view}.png"));
        let found = size(&picture);
        let scale = 176.0 / f64::from(width.max(height));
        for (found, expected) in found.into_iter().zip([width, height]) {
            let expected = f64::from(expected) * scale;
            assert!((f64::from(found) - expected).abs() <= 2.0, "{view}: {found}, not {expected}");
        }
    }
    for view in ["iso", "persp"] {
        let [[left, right], [top, bottom]] = extent(&png(&stage, &format!("v-{view}.png")));
        assert!(left > 5 && top > 5 && right < 195 && bottom < 195, "{view}");
    }
    stage.done(&format!("render box.obj {SHAPES} --size 200 -o plain.png"));
    assert!(stage.bytes("plain.png") == stage.bytes("v-persp.png"), "persp is not the view of models");
    stage.done(&format!("render box.obj {SHAPES} --size 200 --view top -o top.png"));
    assert!(stage.bytes("top.png") == stage.bytes("v-top.png"), "--view and --views differ");
    stage.done(&format!(
        "render box.obj {SHAPES} --size 200 --view front --azimuth 0 --elevation 90 -o angle.png"
    ));
    assert_eq!(size(&png(&stage, "angle.png")), size(&png(&stage, "v-top.png")));
}

#[test]
fn views_fit_every_lens_and_shape_of_picture() {
    let stage = Stage::new("views-lens");
    stage.write("box.obj", BOX);
    for options in [
        "--size 300x40 --view right",
        "--size 40x300 --view front",
        "--size 90x60 --view front --fov 100",
        "--size 90x60 --azimuth 200 --elevation -40 --fov 5",
        "--size 60x90 --fov 140",
        "--size 60x90 --view top --up 0,0,1 --turn 40",
    ] {
        stage.done(&format!("render box.obj {SHAPES} {options} -o p.png"));
        let picture = png(&stage, "p.png");
        let [[left, right], [top, bottom]] = extent(&picture);
        let is_whole = left > 0 && top > 0 && right < picture.width() && bottom < picture.height();
        assert!(is_whole, "{options}: {:?}", extent(&picture));
        let fills = f64::from(right - left) / f64::from(picture.width());
        let fills = fills.max(f64::from(bottom - top) / f64::from(picture.height()));
        assert!(fills > 0.6, "{options}: {fills}");
    }
}

#[test]
fn a_view_replaces_the_camera_of_a_scene() {
    let stage = Stage::new("views-scene");
    let seen = |options: &str| {
        stage.done(&format!("render scene.toml -q --integrator id --samples 1 {options} -o p.ppm"));
        stage.bytes("p.ppm")
    };
    let top = seen("--view top");
    assert!(top != seen("") && top != seen("--view bottom"));
    for wrong in
        ["--view top --lookfrom 1,2,3", "--azimuth 4 --camera none", "--view above", "--elevation 91"]
    {
        stage.run(&format!("render scene.toml {wrong}")).fails(2, &[]);
    }
    stage.run("render scene.toml --views front,front").fails(2, &["twice"]);
    stage.run("render scene.toml --views front,side").fails(2, &["front, right, back"]);
}

#[test]
fn a_sheet_holds_all_pictures_of_a_call() {
    let stage = Stage::new("sheet");
    stage.write("box.obj", BOX);
    stage.done(&format!("render box.obj {SHAPES} --size 20x10 --views front,right,top -o v.png"));
    let run = stage.done(&format!(
        "render box.obj {SHAPES} --size 20x10 --views front,right,top --sheet 2x2 -o s.png --json"
    ));
    assert_eq!(run.json().len(), 3);
    let sheet = png(&stage, "s.png");
    assert_eq!(sheet.dimensions(), (40, 20));
    for (view, [x, y]) in [("front", [0, 0]), ("right", [20, 0]), ("top", [0, 10])] {
        let cell = ::image::imageops::crop_imm(&sheet, x, y, 20, 10).to_image();
        assert!(cell == png(&stage, &format!("v-{view}.png")), "{view}");
    }
    assert!(
        ::image::imageops::crop_imm(&sheet, 20, 10, 20, 10).to_image().pixels().all(|pixel| pixel.0[3] == 0)
    );
    // Several models, of which one is broken: its cell stays empty.
    stage.write("broken.obj", "v 0 0\nf 1 2 3\n");
    let run = stage.run("render model.obj broken.obj box.obj -q --samples 1 --size 8 --sheet 3 -o m.png");
    run.fails(1, &["broken.obj"]);
    let sheet = png(&stage, "m.png");
    assert_eq!(sheet.dimensions(), (24, 8));
    let is_white =
        |x| ::image::imageops::crop_imm(&sheet, x, 0, 8, 8).to_image().pixels().all(|p| p.0 == [255; 4]);
    assert_eq!([0, 8, 16].map(is_white), [false, true, false]);
    stage.run("render model.obj box.obj --views all --sheet 3x2").fails(2, &["16 pictures", "6 cells"]);
    stage.run("render model.obj --sheet 1 -o s.exr").fails(2, &["linear light"]);
}

#[test]
fn frames_of_an_animation_are_framed_as_one() {
    let stage = Stage::new("frames");
    stage.write("moving.gltf", MOVING);
    let frames = format!("render moving.gltf {SHAPES} --size 100x50 --view front --fps 4");
    stage.done(&format!("{frames} --frames 0..5 -o f.png"));
    let lefts: Vec<u32> = (0..5)
        .map(|frame| {
            let picture = png(&stage, &format!("f-000{frame}.png"));
            let [[left, right], [top, bottom]] = extent(&picture);
            assert!(left > 0 && right < 100 && top > 0 && bottom < 50, "frame {frame} is cut");
            left
        })
        .collect();
    // It moves at its speed through a picture that stands still.
    for pair in lefts.windows(2) {
        assert!((16..=19).contains(&(pair[1] - pair[0])), "{lefts:?}");
    }
    stage.done(&format!("{frames} --frames 3..5 -o later/#####.png"));
    assert!(stage.path("later/00003.png").exists() && stage.path("later/00004.png").exists());
    stage.run("render moving.gltf --frames 0..2 --at 1").fails(2, &["--at"]);
    stage.run("render moving.gltf --frames 2..2").fails(2, &["the one after the last"]);
    // What begins with a minus sign is a value, too.
    stage.run("render moving.gltf --frames -2..2").fails(2, &["the one after the last, counted from 0"]);
    stage.run("render moving.gltf --at -1").fails(2, &["a time of at least 0"]);
    stage.run("render moving.gltf --at 1 --shutter -0.5").fails(2, &["a number from 0 to 1000"]);
    stage.run("render moving.gltf --frames 0..2 -o - --format pfm").fails(2, &["names of their own"]);
}

#[test]
fn pictures_that_exist_can_be_skipped() {
    let stage = Stage::new("skip");
    stage.write("t-001.png", "not to be touched");
    let run =
        stage.done("render model.obj --size 8 --samples 1 --turntable 3 -o t.png --skip-existing --json");
    assert_eq!(stage.bytes("t-001.png"), b"not to be touched");
    let answers = run.json();
    assert_eq!((answers.len(), &answers[1]["skipped"]), (3, &true.into()));
    assert!(
        run.stderr.contains("t-001.png exists") && run.stderr.contains("3 of 3: model.obj"),
        "{}",
        run.stderr
    );
    stage.done("render model.obj --size 8 --samples 1 --turn 240 -q -o alone.png");
    assert!(stage.bytes("t-002.png") == stage.bytes("alone.png"));
}

#[test]
fn several_pictures_can_move() {
    let stage = Stage::new("moving");
    stage.write("moving.gltf", MOVING);
    let frames = format!("render moving.gltf {SHAPES} --size 40x20 --view front --fps 4 --frames 0..5");
    for name in ["a.gif", "a.apng", "a.webp"] {
        stage.done(&format!("{frames} -o {name}"));
    }
    assert!(stage.names().iter().filter(|name| name.starts_with("a")).count() == 3, "{:?}", stage.names());
    let gif =
        GifDecoder::new(Cursor::new(stage.bytes("a.gif"))).unwrap().into_frames().collect_frames().unwrap();
    assert_eq!(gif.len(), 5);
    let lefts: Vec<u32> = gif.iter().map(|frame| extent(frame.buffer())[0][0]).collect();
    assert!(lefts.windows(2).all(|pair| pair[0] < pair[1]), "{lefts:?}");
    stage.done(&format!("{frames} -o still-#.webp"));
    assert!(stage.path("still-4.webp").exists());
    // One picture is no animation, and a GIF all the same.
    stage.done("render model.obj -q --size 8 --samples 1 -o one.gif");
    assert_eq!(png(&stage, "one.gif").dimensions(), (8, 8));
}

#[test]
fn several_pictures_go_to_stdout_as_one_animation_or_one_after_the_other() {
    let stage = Stage::new("series-stdout");
    stage.write("moving.gltf", MOVING);
    let of = "render moving.gltf -q --samples 1 --size 12x8 --frames 0..3 --fps 4";
    for format in ["gif", "apng", "webp"] {
        stage.done(&format!("{of} -o walk.{format}"));
        let run = stage.done(&format!("{of} --format {format} -o -"));
        assert!(run.stdout == stage.bytes(&format!("walk.{format}")), "{format}");
    }
    for format in ["ppm", "png", "jpg"] {
        stage.done(&format!("{of} --format {format} -o ./"));
        let one_by_one: Vec<u8> =
            (0..3).flat_map(|frame| stage.bytes(&format!("moving-000{frame}.{format}"))).collect();
        let run = stage.done(&format!("{of} --format {format} -o -"));
        assert!(run.stdout == one_by_one, "{format}");
    }
    stage.run(&format!("{of} --format exr -o -")).fails(2, &["linear light", "ppm"]);
}
