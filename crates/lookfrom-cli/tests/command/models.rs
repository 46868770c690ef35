//! Pictures with nothing but a model: size, surroundings, background, floor, turntable, many files.

use std::path::Path;

use lookfrom_scene::image::{self, Image, encode_hdr};
use lookfrom_scene::{Disk, LoadContext};

use super::stage::Stage;

/// A plate that looks up, small against its bounds, which a far point makes large.
const PLATE: &str = "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 4 3 2 1\n";

fn picture(path: &Path) -> Image {
    image::read(path, &mut LoadContext::new(&Disk)).unwrap_or_else(|error| panic!("{error}"))
}

fn channel(stage: &Stage, file: &str, name: &str) -> Vec<f32> {
    let found = image::read_exr(&stage.path(file), &mut LoadContext::new(&Disk)).unwrap();
    found.channel(name).unwrap_or_else(|| panic!("{file} has no channel {name}")).to_vec()
}

/// A sky that is brighter above, and coloured, so that directions and channels cannot be mistaken.
fn write_sky(stage: &Stage) {
    let texels: Vec<[f32; 3]> = (0..64 * 32)
        .map(|index| {
            let (x, y) = ((index % 64) as f32, (index / 64) as f32);
            [1.5 - y / 32.0, 1.0 + x / 64.0, 0.5 + y / 16.0]
        })
        .collect();
    std::fs::write(stage.path("sky.hdr"), encode_hdr(64, 32, &texels).unwrap()).unwrap();
}

#[test]
fn a_broken_file_among_others_is_told_of_and_the_others_are_rendered() {
    let stage = Stage::new("some-broken");
    stage.write("broken.obj", "v 0 0\nf 1 2 3\n");
    stage.write("other.obj", PLATE);
    let run = stage
        .run("render model.obj broken.obj missing.ply other.obj -q -o out-{name}.png --size 24 --samples 1");
    run.fails(1, &["broken.obj", "missing.ply: no such file"]);
    for name in ["out-model.png", "out-other.png"] {
        let picture = picture(&stage.path(name));
        assert_eq!((picture.width, picture.height), (24, 24));
    }
    assert!(!stage.names().contains(&"out-broken.png".to_owned()));
}

#[test]
fn a_turntable_makes_numbered_pictures_that_can_be_made_alone() {
    let stage = Stage::new("turntable");
    stage.done("render model.obj -q -o t.png --size 16x12 --samples 1 --turntable 4");
    let names: Vec<String> = stage.names().into_iter().filter(|name| name.starts_with("t-")).collect();
    assert_eq!(names, ["t-000.png", "t-001.png", "t-002.png", "t-003.png"]);
    assert!(stage.bytes("t-000.png") != stage.bytes("t-001.png"), "nothing turns");
    stage.done("render model.obj -q -o alone.png --size 16x12 --samples 1 --turn 90");
    assert!(stage.bytes("t-001.png") == stage.bytes("alone.png"), "the second of four is not that of 90°");
    stage.done("render model.obj -q -o first.png --size 16x12 --samples 1 --turn 0");
    assert!(stage.bytes("t-000.png") == stage.bytes("first.png"), "the first is not where it begins");
    stage.run("render model.obj -o - --turntable 2 --format exr").fails(2, &["names of their own"]);
}

/// Whether nothing touches the edge of a transparent picture, and something is in it.
fn is_whole(stage: &Stage, file: &str) -> bool {
    let png = ::image::open(stage.path(file)).unwrap().into_rgba8();
    let (width, height) = png.dimensions();
    let is_edge = |x: u32, y: u32| x == 0 || y == 0 || x + 1 == width || y + 1 == height;
    let shown = || png.enumerate_pixels().filter(|(.., pixel)| pixel.0[3] > 0);
    shown().count() > 0 && !shown().any(|(x, y, _)| is_edge(x, y))
}

#[test]
fn a_turntable_cuts_nothing() {
    let stage = Stage::new("turntable-whole");
    // A long plate that stands aside.
    stage.write("long.obj", "v 100 0 0\nv 110 0 0\nv 110 1 0.5\nv 100 1 0.5\nf 1 2 3 4\n");
    let common =
        "render long.obj -q --size 40x24 --samples 1 --denoise off --filter box --background transparent";
    stage.done(&format!("{common} -o t.png --turntable 8"));
    for number in 0..8 {
        assert!(is_whole(&stage, &format!("t-00{number}.png")), "{number}");
    }
    stage.done(&format!("{common} -o z.png --turn 77 --up 0,0,1"));
    assert!(is_whole(&stage, "z.png"));
}

#[test]
fn a_scene_turns_around_what_it_looks_at_and_a_model_around_what_is_asked_for() {
    let stage = Stage::new("turn-scene");
    let lamp = "[[light]]\ntype = \"sphere\"\ncenter = [700, 400, 0]\nradius = 5\nradiance = 900\n";
    stage.write("lamp.toml", &format!("{}{lamp}", super::stage::SCENE));
    let middle = |options: &str| {
        stage.done(&format!("render {options} -q --integrator id --filter box --samples 1 -o p.pfm"));
        let picture = picture(&stage.path("p.pfm"));
        let at = picture.height / 2 * picture.width + picture.width / 2;
        picture.texels().nth(at as usize).unwrap()
    };
    let ball = middle("lamp.toml");
    for turn in [0, 90, 180, 300] {
        assert_eq!(middle(&format!("lamp.toml --turn {turn}")), ball, "{turn}");
    }
    let plain = middle("model.obj --size 99 --lookat 0.2,0.2,0 --turn 0");
    assert_eq!(middle("model.obj --size 99 --lookat 0.2,0.2,0 --turn 40"), plain);
}

#[test]
fn transparency_needs_a_format_with_alpha() {
    let stage = Stage::new("no-alpha");
    let transparent = "-q --size 8 --samples 1 --background transparent";
    for format in ["jpg", "ppm", "hdr", "pfm"] {
        let says = ["alpha", ".png", ".webp", ".exr", "--background"];
        let file = format!("p.{format}");
        for call in [
            format!("render model.obj {transparent} -o {file}"),
            format!("render model.obj {transparent} --format {format} -o -"),
            format!("render scene.toml {transparent} -o {file}"),
        ] {
            stage.run(&call).fails(2, &says);
        }
        assert!(!stage.path(&file).exists());
    }
    stage.run(&format!("render model.obj {transparent} --views all --sheet 4 -o s.jpg")).fails(2, &["alpha"]);
    stage.done(&format!("render model.obj {transparent} --denoise off -o p.exr"));
    stage.run("develop p.exr -o p.jpg").fails(2, &["JPEG", "--background"]);
    stage.done("develop p.exr -o p.jpg --background white");
    for format in ["png", "webp", "exr", "gif", "apng"] {
        stage.done(&format!("render model.obj {transparent} -o q.{format}"));
    }
}

#[test]
fn transparent_pictures_hide_only_what_the_model_hides() {
    let stage = Stage::new("transparent");
    let common = "render model.obj -q --size 32 --samples 8 --denoise off --filter box --background";
    stage.done(&format!("{common} transparent -o p.png"));
    let png = ::image::open(stage.path("p.png")).unwrap().into_rgba8();
    let at = |x, y| png.get_pixel(x, y).0;
    assert_eq!(at(0, 0), [0; 4], "the corner hides something");
    let opaque: Vec<_> = png.pixels().filter(|pixel| pixel.0[3] == 255).collect();
    assert!(opaque.len() > 100 && opaque.iter().all(|pixel| pixel.0[0] > 60), "the model hides nothing");
    assert!(png.pixels().any(|pixel| (1..255).contains(&pixel.0[3])), "no edge is smooth");

    // The EXR's colours are multiplied by its alpha, and no layer else is changed by it.
    stage.done(&format!("{common} transparent -o p.exr"));
    let (alpha, green) = (channel(&stage, "p.exr", "A"), channel(&stage, "p.exr", "G"));
    assert_eq!((alpha[0], green[0]), (0.0, 0.0));
    stage.done(&format!("{common} environment -o e.exr"));
    let whole = channel(&stage, "e.exr", "G");
    for ((alpha, green), whole) in alpha.iter().zip(&green).zip(&whole) {
        assert!(*alpha > 0.0 || *green == 0.0);
        assert!(*alpha < 1.0 || green == whole, "the light on the model changes with the background");
    }

    // A colour is shown as it is.
    stage.done(&format!("{common} #2080c0 -o c.png"));
    let png = ::image::open(stage.path("c.png")).unwrap().into_rgb8();
    assert_eq!(png.get_pixel(0, 0).0, [0x20, 0x80, 0xc0]);
    stage.run("render model.obj --background red").fails(2, &["#rrggbb"]);
}

#[test]
fn a_picture_of_the_surroundings_takes_the_place_of_the_studio_and_turns() {
    let stage = Stage::new("environment");
    write_sky(&stage);
    let common = "render model.obj -q --size 24 --samples 4 --environment sky.hdr";
    let render = |more: &str| {
        stage.done(&format!("{common} {more} -o p.pfm"));
        picture(&stage.path("p.pfm")).texels().collect::<Vec<_>>()
    };
    let plain = render("");
    // The camera looks down, where the sky is blue.
    let [r, _, b] = plain[0];
    assert!(b > r, "the studio is still there: {r} {b}");
    let turned = render("--rotate-environment 90");
    assert!((turned[0][1] - plain[0][1]).abs() > 0.1, "{:?} {:?}", turned[0], plain[0]);
    stage.run("render model.obj --environment none.hdr").fails(1, &["none.hdr", "no such file"]);
}

/// An environment, seen by a camera that sees all around, is its own picture again.
#[test]
fn the_picture_of_the_surroundings_is_that_of_the_camera_all_around() {
    let stage = Stage::new("around");
    let texel = |x: u32, y: u32| {
        let [x, y] = [x, y].map(|at| at as f32 / 64.0);
        [0.2 + x, 0.3 + 0.5 * y + (x - 0.3).abs(), 1.2 - y]
    };
    for (layout, projection, width, height) in
        [("latitude_longitude", "equirectangular", 64, 32), ("octahedral", "octahedral", 32, 32)]
    {
        let texels: Vec<[f32; 3]> =
            (0..width * height).map(|index| texel(index % width, index / width)).collect();
        std::fs::write(stage.path("sky.hdr"), encode_hdr(width, height, &texels).unwrap()).unwrap();
        stage.write("wide.toml", &format!(
            "[camera]\nlookfrom = [3, 1, 2]\nlookat = [3, 1, 0]\nprojection = \"{projection}\"\n\
             [image]\nwidth = {width}\nheight = {height}\nfilter = \"box\"\n[render]\nintegrator = \"path\"\nsamples = 16\n\
             [[light]]\ntype = \"environment\"\nimage = \"sky.hdr\"\nlayout = \"{layout}\"\n"
        ));
        stage.done("render wide.toml -q -o p.pfm");
        let [written, seen] = ["sky.hdr", "p.pfm"].map(|name| picture(&stage.path(name)));
        let mut worst = 0.0_f32;
        for (index, (written, seen)) in (0..).zip(written.texels().zip(seen.texels())) {
            // Where the first column meets the last the picture jumps.
            if (1..width - 1).contains(&(index % width)) {
                worst = (0..3).fold(worst, |worst, c| worst.max((written[c] - seen[c]).abs()));
            }
        }
        assert!(worst < 0.02, "{projection}: {worst}");
    }
}

#[test]
fn a_floor_without_shadows_is_the_background() {
    let stage = Stage::new("floor");
    write_sky(&stage);
    // A plate so small that it hides and shadows nothing in most of the picture; the far point only widens the view.
    stage.write(
        "small.obj",
        "v 0 0 0\nv 0.01 0 0\nv 0 0 0.01\nf 3 2 1\nv 10 0 0\nv 10.01 0 0\nv 10 0 0.01\nf 6 5 4\n",
    );
    for light in ["", "--environment sky.hdr"] {
        let common = format!("render small.obj -q --size 40 --samples 16 --filter box {light}");
        stage.done(&format!("{common} -o without.pfm"));
        stage.done(&format!("{common} --floor -o with.pfm"));
        let [without, with] =
            ["without.pfm", "with.pfm"].map(|name| picture(&stage.path(name)).texels().collect::<Vec<_>>());
        let same = without
            .iter()
            .zip(&with)
            .filter(|(a, b)| a.iter().zip(*b).all(|(a, b)| (a - b).abs() <= 2e-4 * a.max(1.0)));
        let (same, all) = (same.count(), with.len());
        assert!(same * 10 > all * 9, "{light}: {same} of {all} pixels look like the background");
    }
    // The other integrators know no such trick, but by noise they see the same.
    let common = "render small.obj -q --size 16 --samples 256 --environment sky.hdr";
    stage.done(&format!("{common} -o without.pfm"));
    stage.done(&format!("{common} --floor --integrator simple_path -o with.pfm"));
    let [without, with] = ["without.pfm", "with.pfm"].map(|name| {
        let texels = picture(&stage.path(name)).texels().collect::<Vec<_>>();
        let sum = texels.iter().fold([0.0; 3], |sum: [f32; 3], texel| [0, 1, 2].map(|c| sum[c] + texel[c]));
        sum.map(|sum| sum / texels.len() as f32)
    });
    for (a, b) in without.iter().zip(&with) {
        assert!((a / b - 1.0).abs() < 0.01, "{without:?} {with:?}");
    }
}

#[test]
fn shadows_lie_on_the_floor_alone() {
    let stage = Stage::new("shadows");
    stage.write(
        "lifted.obj",
        "v 0 0 0\nv 0.001 0 0\nv 0 0 0.001\nf 3 2 1\nv 0 1 0\nv 2 1 0\nv 2 1 2\nv 0 1 2\nf 7 6 5 4\n",
    );
    stage.done("render lifted.obj -q --size 48 --samples 16 --floor --background transparent -o p.exr");
    let (alpha, red) = (channel(&stage, "p.exr", "A"), channel(&stage, "p.exr", "R"));
    let shadows = alpha.iter().zip(&red).filter(|(alpha, red)| **red == 0.0 && **alpha > 0.2).count();
    let free = alpha.iter().filter(|alpha| **alpha < 0.02).count();
    assert!(shadows > 50 && free > 50, "{shadows} {free}");
    assert!(alpha.iter().all(|alpha| (0.0..=1.0).contains(alpha)));
}

#[test]
fn the_same_bytes_for_any_number_of_threads_with_alpha() {
    let stage = Stage::new("alpha-threads");
    let [one, two] = [1, 2].map(|threads| {
        stage.done(&format!(
            "render model.obj -q --size 70 --samples 3 --floor --background transparent --threads {threads} -o p.exr"
        ));
        stage.bytes("p.exr")
    });
    assert!(one == two);
}

#[test]
fn sizes_and_choices() {
    let stage = Stage::new("sizes");
    stage.done("render scene.toml -q -o p.png --size 17x9 --samples 1");
    let found = picture(&stage.path("p.png"));
    assert_eq!((found.width, found.height), (17, 9));
    stage.run("render scene.toml --size 17 --width 9").fails(2, &["--size", "--width"]);
    let run = stage.done("render model.obj -o p.png --size 8 --samples 1 --animation Walk --at 1.5s");
    assert!(run.stderr.contains("`animation`") && run.stderr.contains("glTF"), "{}", run.stderr);
}

#[test]
fn what_a_model_is_its_content_says() {
    let stage = Stage::new("content");
    stage.write(
        "triangle",
        r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}]}"#,
    );
    // Nothing is warned of: what is chosen is of a glTF file, whatever its name.
    stage.done("render triangle -q -o t.png --size 8 --samples 1 --scene 0 --strict");
}

#[test]
fn any_files_camera_can_be_left_aside() {
    let stage = Stage::new("camera-none");
    let options = "-q --size 24x18 --samples 1 --strict";
    let scene = super::stage::SCENE;
    stage.write("bare.toml", &scene[scene.find("[image]").unwrap()..]);
    stage.done(&format!("render scene.toml {options} --camera none -o none.ppm"));
    stage.done(&format!("render scene.toml {options} -o own.ppm"));
    stage.done(&format!("render bare.toml {options} -o bare.ppm"));
    assert!(stage.bytes("none.ppm") == stage.bytes("bare.ppm"), "it is not framed");
    assert!(stage.bytes("none.ppm") != stage.bytes("own.ppm"), "it is seen by its own camera");
    // From afar a sphere is small, framed it is large.
    let pbrt = "LookAt 0 0 90  0 0 0  0 1 0\nCamera \"perspective\"\nWorldBegin\nShape \"sphere\"\n";
    stage.write("s.pbrt", pbrt);
    let [own, none] = ["", "--camera none"].map(|camera| {
        stage.done(&format!("render s.pbrt {options} --integrator normals {camera} -o n.pfm"));
        picture(&stage.path("n.pfm")).texels().filter(|texel| *texel != [0.0; 3]).count()
    });
    assert!(own <= 4 && none > 40, "{own} {none}");
}

#[test]
fn stl_files_stand_on_the_plane_of_x_and_y() {
    let stage = Stage::new("stl-up");
    let stl = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 3 0 0\nvertex 0 2 1\nendloop\nendfacet\nendsolid\n";
    stage.write("a.stl", stl);
    let seen = |options: &str| {
        let run = stage.done(&format!("render a.stl --size 24 --samples 1 {options} -o p.ppm"));
        (stage.bytes("p.ppm"), run.stderr.contains("z is up"))
    };
    let (custom, is_told) = seen("");
    let (z, is_told_of_z) = seen("--up z");
    let (y, _) = seen("--up y");
    assert!(custom == z && custom != y);
    assert_eq!((is_told, is_told_of_z), (true, false));
    assert!(y == seen("--up 0,1,0").0);
}

#[test]
fn lights_of_a_file_are_exposed() {
    let stage = Stage::new("exposed");
    let lit = |name: &str, intensity: &str| {
        let gltf = format!(
            r#"{{"asset": {{"version": "2.0"}}, "extensionsUsed": ["KHR_lights_punctual"], "scene": 0,
            "extensions": {{"KHR_lights_punctual": {{"lights": [{{"type": "directional", "intensity": {intensity}}}]}}}},
            "scenes": [{{"nodes": [0, 1]}}],
            "nodes": [{{"mesh": 0}}, {{"extensions": {{"KHR_lights_punctual": {{"light": 0}}}}}}],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
            "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}}],
            "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
            "buffers": [{{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}}]}}"#
        );
        stage.write(name, &gltf);
    };
    lit("dim.gltf", "0.001");
    lit("bright.gltf", "128000");
    let brightest = |file: &str, options: &str| {
        let run = stage.done(&format!(
            "render {file} --size 32 --samples 4 --denoise off --tonemap clamp {options} -o p.ppm"
        ));
        (stage.bytes("p.ppm")[13..].iter().copied().max().unwrap(), run.stderr)
    };
    for (file, plain) in [("dim.gltf", 0..12), ("bright.gltf", 255..256)] {
        let (shown, told) = brightest(file, "");
        assert!((180..255).contains(&shown), "{file}: {shown}");
        assert!(plain.contains(&u16::from(brightest(file, "--exposure 0").0)), "{file}");
        // What is told repeats it.
        let stops = told.split("--exposure ").nth(1).and_then(|rest| rest.split(' ').next()).expect(&told);
        assert_eq!(brightest(file, &format!("--exposure {stops}")).0, shown, "{file} {stops}");
    }
    // The studio and other surroundings are as bright as they are.
    assert!(!brightest("model.obj", "").1.contains("the exposure is"));
    assert!(brightest("model.obj", "--exposure auto").1.contains("the exposure is"));
}

#[test]
fn what_suits_any_model_is_no_matter_of_gltf() {
    let stage = Stage::new("models-subdivided");
    stage.done("render model.obj --subdivide 1 --strict --size 8 --samples 1 -q -o a.png");
    stage
        .run("render model.obj --up 0,0,0 --size 8 -o b.png")
        .fails(2, &["up is [0, 0, 0]; expected a direction"]);
}
