//! Variables, expressions and keyframes: what they are worth wherever a value stands, at any time.

use std::path::Path;

use lookfrom_scene::camera::{Projection, View};
use lookfrom_scene::material::{Color, MaterialKind};
use lookfrom_scene::shape::{Geometry, Sphere};
use lookfrom_scene::{Error, ErrorKind, LoadContext, Memory, Scene, Variables, image, load};
use proptest::prelude::*;

/// Files, with the time in seconds and values from outside.
fn read_files(texts: &[(&str, &str)], at: f64, given: &[(&str, &str)]) -> Result<Scene, Error> {
    let mut files = Memory::default();
    for (name, text) in texts {
        files.0.insert(name.into(), text.as_bytes().to_vec());
    }
    files.0.insert("tile-0007.png".into(), image::encode_png(1, 1, &[255, 0, 0]).expect("a picture"));
    let mut context = LoadContext::new(&files);
    context.import.at = Some(at);
    let values = given.iter().map(|&(name, value)| (name.to_owned(), value.to_owned())).collect();
    context.variables = Variables { values, fps: 24.0 };
    let scene = load::scene(Path::new("a.toml"), &mut context)?;
    assert_eq!(context.warnings, []);
    Ok(scene)
}

fn read(text: &str, at: f64, given: &[(&str, &str)]) -> Scene {
    read_files(&[("a.toml", text)], at, given).unwrap_or_else(|error| panic!("{error}\nin\n{text}"))
}

fn wrong(text: &str, given: &[(&str, &str)]) -> String {
    match read_files(&[("a.toml", text)], 0.0, given) {
        Ok(_) => panic!("no error in\n{text}"),
        Err(error) => error.to_string(),
    }
}

/// The value of an expression.
fn value_at(expression: &str, at: f64) -> f64 {
    let scene = read(
        &format!("[camera]\nlookfrom = [\"= {expression}\", 1e9, 0]\nlookat = [0, 0, 0]\nup = [0, 0, 1]"),
        at,
        &[],
    );
    let View::Look { lookfrom, .. } = scene.camera.expect("a camera").view else { panic!("it looks") };
    lookfrom.x
}

fn value(expression: &str) -> f64 {
    value_at(expression, 0.0)
}

fn radius(scene: &Scene) -> f64 {
    match scene.shapes[0].geometry {
        Geometry::Sphere(Sphere { radius, .. }) => radius,
        _ => panic!("not a sphere"),
    }
}

#[test]
fn expressions_have_their_values() {
    let cases = [
        ("1 + 2 * 3", 7.0),
        ("(1 + 2) * 3", 9.0),
        ("8 - 2 - 1", 5.0),
        ("-2 ^ 2", -4.0),
        ("2 ^ 3 ^ 2", 512.0),
        ("2 ^ -1", 0.5),
        ("7 / 2", 3.5),
        ("7 % 3", 1.0),
        ("-1 % 360", 359.0),
        ("1e3 + .5", 1000.5),
        ("sin(90) + sin(180) + cos(180) + cos(90)", 0.0),
        ("sin(-90)", -1.0),
        ("tan(0)", 0.0),
        ("atan2(1, 0)", 90.0),
        ("sqrt(16)", 4.0),
        ("min(3, 1, 2)", 1.0),
        ("max(3, 1, 2)", 3.0),
        ("clamp(5, 0, 2)", 2.0),
        ("mix(10, 20, 0.25)", 12.5),
        ("smoothstep(0, 2, 1)", 0.5),
        ("round(2.5) + floor(-0.5) + ceil(0.5) + abs(-2) + sign(-3)", 4.0),
        ("1 < 2 && !(2 <= 1) ? 5 : 6", 5.0),
        ("1 == 2 || 1 != 1 ? 5 : 6", 6.0),
        ("1 > 0 ? 2 : 1 / 0", 2.0),
        ("true || 1 / 0 > 1 ? 1 : 2", 1.0),
        ("[1, 2, 3,][2]", 3.0),
        ("([1, 2] * [3, 4] + 1)[1]", 9.0),
        ("sqrt([4, 9])[1]", 3.0),
        ("digits(7, 3) + 'x' == '007x' ? 1 : 0", 1.0),
        ("'a' + 2 + 0.5 == 'a20.5' ? 1 : 0", 1.0),
    ];
    for (expression, expected) in cases {
        assert_eq!(value(expression), expected, "{expression}");
    }
    assert!((value("exp(log(5))") - 5.0).abs() < 1e-14);
    assert!((value("asin(0.5)") - 30.0).abs() < 1e-13 && (value("acos(0.5)") - 60.0).abs() < 1e-13);
    assert!((value("atan(1)") - 45.0).abs() < 1e-13 && (value("pi") - std::f64::consts::PI).abs() == 0.0);
    let random: Vec<f64> = (0..1000).map(|n| value(&format!("random({n})"))).collect();
    let mean = random.iter().sum::<f64>() / 1000.0;
    assert!(random.iter().all(|x| (0.0..1.0).contains(x)) && (mean - 0.5).abs() < 0.03, "{mean}");
}

#[test]
fn variables_stand_wherever_a_value_does() {
    let text = r#"
import = "= 'part' + '.toml'"
[variables]
r = 2
d = "= 2 * r"
place = [1, "= r", 3]
warm = { kelvin = 2700 }
paint = "clay"
size = [320, 200]
stem = "tile"
[camera]
lookfrom = "= place * 10"
lookat = "= place"
fov = "= d * 10"
[image]
width = "= size[0]"
height = "= size[1]"
denoise = "= r > 1"
[materials.clay]
type = "diffuse"
reflectance = { type = "image", file = "= stem + '-' + digits(frame, 4) + '.png'" }
[[sphere]]
center = "= place"
radius = "= d"
material = "= paint"
[[light]]
type = "point"
position = [0, 5, 0]
intensity = "= warm"
"#;
    let part = "[[light]]\ntype = \"point\"\nposition = [0, 9, 0]\nintensity = 1\n";
    let read =
        |given: &[(&str, &str)]| read_files(&[("a.toml", text), ("part.toml", part)], 7.0 / 24.0, given);
    let scene = read(&[]).unwrap_or_else(|error| panic!("{error}"));
    let camera = scene.camera.as_ref().expect("a camera");
    assert_eq!(camera.projection, Projection::Perspective { fov: 40.0 });
    assert_eq!((scene.image.width, scene.image.height, scene.image.denoise), (320, 200, true));
    assert_eq!((radius(&scene), scene.lights.len()), (4.0, 2));
    let material = &scene.materials[scene.shapes[0].material.index()];
    assert_eq!(material.name, "clay");
    let MaterialKind::Diffuse { reflectance: Color::Texture(_), .. } = material.kind else {
        panic!("an image")
    };
    let variables = |name: &str| {
        let found = scene.contents.variables.iter().find(|variable| variable.0 == name);
        found.map(|variable| variable.1.as_str())
    };
    assert_eq!((variables("d"), variables("place")), (Some("4"), Some("[1, 2, 3]")));
    // Values from outside are TOML or texts, and what depends on them follows.
    let scene = read(&[("r", "0.5"), ("size", "[8, 4]")]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((radius(&scene), scene.image.width, scene.image.denoise), (1.0, 8, false));
    let scene =
        read(&[("r", "= d / 8"), ("d", "8"), ("stem", "tile")]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(radius(&scene), 8.0);
}

#[test]
fn values_of_the_importing_file_come_first() {
    let part = "[variables]\nr = 1\nown = \"= r + 1\"\n[[sphere]]\nradius = \"= r + own * 10\"\n";
    let read = |main: &str, given: &[(&str, &str)]| {
        let scene = read_files(&[("a.toml", main), ("b.toml", part)], 0.0, given);
        radius(&scene.unwrap_or_else(|error| panic!("{error}")))
    };
    assert_eq!(read("import = \"b.toml\"", &[]), 21.0);
    assert_eq!(read("import = \"b.toml\"\n[variables]\nr = 3", &[]), 43.0);
    assert_eq!(read("import = \"b.toml\"\n[variables]\nr = 3", &[("r", "4"), ("own", "0")]), 4.0);
    let error = read_files(
        &[("a.toml", "import = \"b.toml\"\n[[sphere]]\nradius = \"= own\""), ("b.toml", part)],
        0.0,
        &[],
    );
    assert!(error.unwrap_err().to_string().contains("a.toml:3:13: there is no variable `own`"));
}

#[test]
fn the_clock_counts_seconds_and_frames() {
    for frame in 0..500 {
        let at = f64::from(frame) / 24.0;
        assert_eq!(value_at("frame", at), f64::from(frame));
        assert_eq!(value_at("t", at), at);
    }
}

#[test]
fn how_long_a_scene_changes_is_known() {
    let duration = |text: &str| read(text, 0.5, &[]).contents.duration;
    assert_eq!(duration("[variables]\na = 2\n[[sphere]]\nradius = \"= a\""), None);
    assert_eq!(duration("[variables]\na = \"= 1 + t\"\n[[sphere]]\nradius = \"= a\""), Some(0.0));
    assert_eq!(duration("[[sphere]]\nradius = \"= 1 + frame\""), Some(0.0));
    let two = "[[sphere]]\nradius = { keyframes = [[0, 1], [3, 2]] }\n[[sphere]]\nradius = { keyframes = [[1, 1], [2, 2]] }";
    assert_eq!(duration(two), Some(3.0));
}

/// The value of keyframes at a time.
fn keyframes(rest: &str, at: f64) -> f64 {
    radius(&read(&format!("[[sphere]]\nradius = {{ keyframes = {rest} }}"), at, &[]))
}

#[test]
fn keyframes_that_repeat_and_those_of_lists_and_texts() {
    let wave = "[[1, 1], [2, 3], [3, 1]], repeat = true, interpolation = \"cubic\"";
    assert_eq!(keyframes(wave, 1.25).to_bits(), keyframes(wave, 5.25).to_bits());
    assert_eq!((keyframes(wave, 2.0), keyframes(wave, 0.0)), (3.0, 3.0));
    // A circle's worth of degrees at constant speed has no seam.
    let turn = "[[0, 1], [1, 91], [2, 181], [3, 271], [4, 361]], repeat = true, interpolation = \"cubic\"";
    for eighth in 0..32 {
        let at = f64::from(eighth) / 8.0;
        assert!((keyframes(turn, at) - 1.0 - 90.0 * at).abs() < 1e-9, "{at}");
    }
    // Steps of frames, of ten frames per second: frame 7 is just before the second keyframe of its round by rounding alone.
    let steps = "[[0, 1], [0.1, 2], [0.2, 3], [0.3, 1]], repeat = true, interpolation = \"step\"";
    for frame in 0..100_u32 {
        let expected = f64::from(1 + frame % 3);
        assert_eq!(keyframes(steps, f64::from(frame) / 10.0), expected, "frame {frame}");
    }
    assert_eq!(keyframes("[[0, 1], [1, 2], [3, 9]], interpolation = \"step\"", 2.9), 2.0);
    assert_eq!(keyframes("[[0, 1], [1, 3]], interpolation = \"smooth\"", 0.5), 2.0);
    assert_eq!(keyframes("[[0, \"= 2 * t\"]]", 4.0), 8.0);
    let text = "[variables]\npaint = { keyframes = [[0, \"red\"], [1, \"blue\"]], interpolation = \"step\" }\n\
                at = { keyframes = [[0, [0, 0, 0]], [2, [2, 4, 8]]] }\n\
                [materials.red]\n[materials.blue]\n\
                [[sphere]]\nradius = 1\nmaterial = \"= paint\"\ncenter = \"= at\"\n";
    let scene = read(text, 1.0, &[]);
    assert_eq!(scene.materials[scene.shapes[0].material.index()].name, "blue");
    let Geometry::Sphere(Sphere { center, .. }) = scene.shapes[0].geometry else { panic!("a sphere") };
    assert_eq!(center.to_array(), [1.0, 2.0, 4.0]);
}

#[test]
fn values_from_outside_that_nothing_takes_are_errors() {
    let text = "[variables]\nradius = 1\nheight = 2\n[[sphere]]\nradius = \"= radius\"";
    let far = wrong(text, &[("radus", "3")]);
    assert!(far.contains("the scene has no variable `radus`") && far.contains("did you mean `radius`?"));
    assert!(wrong(text, &[("x", "3")]).contains("it has: height, radius"));
    assert!(wrong("[[sphere]]", &[("x", "3")]).contains("[variables]"));
    assert!(wrong(text, &[("radius", "= 1 / 0")]).contains("define radius:1:5: 1 / 0: division by zero"));
    assert!(
        wrong(text, &[("radius", "big")]).contains("a.toml:5:10: `radius` is \"big\"; expected a number")
    );
    let model = Memory([("a.stl".into(), b"solid\nendsolid\n".to_vec())].into());
    let mut context = LoadContext::new(&model);
    context.variables.values.insert("x".into(), "1".into());
    let error = load::scene(Path::new("a.stl"), &mut context).unwrap_err();
    assert!(!error.message.is_empty());
    assert!(read_files(&[("a.toml", "import = \"b.stl\"")], 0.0, &[]).is_err());
    let error = read_files(&[("a.toml", text)], 0.0, &[("x", "1")]).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Request);
}

#[test]
fn a_few_lines_cannot_ask_for_endless_work() {
    let doubled: String = (1..60).map(|n| format!("v{n} = \"= [v{}, v{}]\"\n", n - 1, n - 1)).collect();
    assert!(wrong(&format!("[variables]\nv0 = 1\n{doubled}"), &[]).contains("inside each other"));
    let text: String = (1..60).map(|n| format!("v{n} = \"= v{} + v{}\"\n", n - 1, n - 1)).collect();
    assert!(wrong(&format!("[variables]\nv0 = \"ab\"\n{text}"), &[]).contains("more than"));
    // When all is spent, nothing more is copied.
    let tree: String = (1..14).map(|n| format!("v{n} = [\"= v{}\", \"= v{}\"]\n", n - 1, n - 1)).collect();
    let uses = "[[sphere]]\nradius = \"= v13[0]\"\n".repeat(5000);
    let start = std::time::Instant::now();
    assert!(
        wrong(&format!("[variables]\nv0 = \"{}\"\n{tree}{uses}", "x".repeat(100)), &[]).contains("more than")
    );
    assert!(start.elapsed().as_secs() < 5, "{:?}", start.elapsed());
    let chain: String = (1..5000).rev().map(|n| format!("v{n} = \"= v{} + 1\"\n", n - 1)).collect();
    assert!(
        wrong(&format!("[variables]\nv0 = 1\n{chain}[[sphere]]\nradius = \"= v4999\""), &[])
            .contains("nested deeper")
    );
    let deep = format!("[[sphere]]\nradius = \"= {}1\"", "(".repeat(100_000));
    assert!(wrong(&deep, &[]).contains("nested deeper than"));
    let long = format!("{}1", "1 + ".repeat(20_000));
    assert_eq!(value(&long), 20_001.0);
}

proptest! {
    #[test]
    fn keyframes_are_hit_and_lines_between_them_are_straight(
        times in prop::collection::vec(-100.0f64..100.0, 1..8),
        values in prop::collection::vec(0.001f64..1e6, 8),
        kind in prop::sample::select(vec!["linear", "smooth", "cubic", "step"]),
        u in 0.0f64..1.0,
    ) {
        let mut times = times;
        times.sort_by(f64::total_cmp);
        times.dedup();
        let pairs: Vec<String> = times.iter().zip(&values).map(|(t, v)| format!("[{t:?}, {v:?}]")).collect();
        let text = format!("[{}], interpolation = \"{kind}\"", pairs.join(", "));
        for (time, value) in times.iter().zip(&values) {
            prop_assert_eq!(keyframes(&text, *time), *value);
        }
        prop_assert_eq!(keyframes(&text, times[0] - 1.0), values[0]);
        prop_assert_eq!(keyframes(&text, times[times.len() - 1] + 1.0), values[times.len() - 1]);
        if kind == "linear" && times.len() > 1 {
            let now = times[0] + (times[1] - times[0]) * u;
            let share = (now - times[0]) / (times[1] - times[0]);
            let expected = values[0] + (values[1] - values[0]) * share;
            prop_assert!((keyframes(&text, now) - expected).abs() <= 1e-9 * expected);
        }
    }

    #[test]
    fn any_text_after_the_sign_is_a_value_or_an_error(text in "[-+*/%^()\\[\\]?:!<>=&|,.' a-e0-9]{0,24}") {
        let _ = read_files(&[("a.toml", &format!("[variables]\na = 1\n[[sphere]]\nradius = \"\"\"={text}\"\"\""))], 0.5, &[]);
    }
}
