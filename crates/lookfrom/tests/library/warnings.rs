//! Warnings about scenes whose picture is hardly what was meant: an eye inside of something or toward nothing, surfaces that give
//! off more light than arrives, absorption that nothing is absorbed by.

use std::path::{Path, PathBuf};

use glam::DVec3;
use lookfrom::render::Renderer;
use lookfrom_scene::camera::{Camera, View};
use lookfrom_scene::shape::{Geometry, Shape, Sphere};
use lookfrom_scene::{LoadContext, Location, Memory, image, load};

use crate::support::own_scene;

/// The warnings of reading and compiling the first of some files.
fn warnings_of(files: &[(&str, String)]) -> Vec<String> {
    let name = files[0].0;
    let files = files.iter().map(|(name, text)| (PathBuf::from(name), text.as_bytes().to_vec()));
    let mut memory = Memory(files.collect());
    memory.0.insert("white.png".into(), image::encode_png(1, 1, &[255; 3]).expect("a picture"));
    let mut context = LoadContext::new(&memory);
    let scene = load::scene(Path::new(name), &mut context).unwrap_or_else(|error| panic!("{error}"));
    let mut warnings = context.warnings;
    Renderer::of_scene(scene, &mut warnings).unwrap_or_else(|error| panic!("{error}"));
    warnings.iter().map(ToString::to_string).collect()
}

/// The warnings of a scene seen from a place, along −z, in the light from all around.
fn seen_from(lookfrom: [f64; 3], things: &str) -> Vec<String> {
    let [x, y, z] = lookfrom;
    let camera = format!("[camera]\nlookfrom = {lookfrom:?}\nlookat = [{x}, {y}, {}]\n", z - 1.0);
    let light = "[[light]]\ntype = \"environment\"\ncolor = 1\n";
    warnings_of(&[("a.toml", format!("{camera}{things}\n{light}"))])
}

#[track_caller]
fn one(warnings: &[String], words: &[&str]) {
    assert_eq!(warnings.len(), 1, "{warnings:#?}");
    for word in words {
        assert!(warnings[0].contains(word), "{word:?} is missing: {}", warnings[0]);
    }
}

#[track_caller]
fn none(warnings: &[String]) {
    assert!(warnings.is_empty(), "{warnings:#?}");
}

const BOX: &str = "[[box]]\nname = \"crate\"\nmin = [-1, -1, -1]\nmax = [1, 1, 1]\n";

#[test]
fn an_eye_inside_a_body_is_told_of() {
    for (what, text) in [
        ("box", BOX.to_owned()),
        ("box of metal", format!("[materials.m]\ntype = \"conductor\"\nmetal = \"gold\"\n{BOX}material = \"m\"")),
        ("turned box", format!("{BOX}rotate = [20, 40, 0]\nscale = [1, 2, 1.5]")),
        ("mirrored box", format!("{BOX}scale = [-1, 1, 1]")),
        ("sphere", "[[sphere]]\nname = \"crate\"\nradius = 1\ncenter = [0, 0.1, 0]".to_owned()),
        ("ellipsoid", "[[sphere]]\nname = \"crate\"\nscale = [1, 2, 3]".to_owned()),
        ("instance", "[[objects.o.sphere]]\nname = \"crate\"\n[[instance]]\nobject = \"o\"\n[[instance]]\nobject = \"o\"\ntranslate = [9, 0, 0]".to_owned()),
        ("box in the open", format!("{BOX}[[plane]]\npoint = [0, -1.5, 0]\n[[sphere]]\ncenter = [0, 0, -7]")),
    ] {
        println!("{what}");
        one(&seen_from([0.1, 0.2, 0.3], &text), &["a.toml:1:", "the camera stands inside `crate`"]);
    }
}

#[test]
fn rooms_and_glass_are_no_bodies() {
    let lamp = "[[light]]\ntype = \"point\"\nposition = [0, 0.9, 0.9]\nintensity = 1\n";
    let panel = "[[light]]\ntype = \"disk\"\ncenter = [0, 0.99, 0.9]\nnormal = [0, -1, 0]\nradius = 0.1\nradiance = 1\n";
    let glass = "[materials.g]\ntype = \"dielectric\"\n";
    for (what, text) in [
        ("a lamp within", format!("{BOX}{lamp}")),
        ("a panel within", format!("{BOX}{panel}")),
        ("turned outside in", format!("{BOX}reverse_orientation = true")),
        ("something within", format!("{BOX}[[sphere]]\ncenter = [0.1, 0.2, -0.5]\nradius = 0.4")),
        ("glass", format!("{glass}{BOX}material = \"g\"")),
        ("sky on a dome", format!("[materials.u]\ntype = \"unlit\"\n{BOX}material = \"u\"")),
        ("a shining dome", format!("{BOX}emission = 1\ntwo_sided = true")),
        ("a tube", "[[cylinder]]\nfrom = [0, -1, 0]\nto = [0, 1, 0]\nradius = 2".to_owned()),
        ("outside", "[[sphere]]\ncenter = [0, 0, -5]".to_owned()),
        (
            "before a wall",
            "[[quad]]\ncorner = [-9, -9, -1]\nedge_u = [0, 18, 0]\nedge_v = [18, 0, 0]".to_owned(),
        ),
    ] {
        println!("{what}");
        none(&seen_from([0.1, 0.2, 0.3], &text));
    }
}

#[test]
fn all_parts_of_a_model_are_one_body() {
    // A tetrahedron, of two groups with a material each.
    let model =
        "usemtl a\nv -4 -1 4\nv 4 -1 4\nv 0 -1 -4\nv 0 5 0\nf 1 3 2\nf 1 2 4\nusemtl b\nf 2 3 4\nf 3 1 4\n";
    let memory = Memory([(PathBuf::from("a.obj"), model.as_bytes().to_vec())].into());
    let mut context = LoadContext::new(&memory);
    let scene = load::scene(Path::new("a.obj"), &mut context).unwrap();
    let warnings = |lookfrom: [f64; 3]| {
        let mut scene = scene.clone();
        let view = View::Look { lookfrom: lookfrom.into(), lookat: DVec3::new(0.0, 0.1, -3.0), up: DVec3::Y };
        scene.camera = Some(Camera { view, ..Default::default() });
        // The lamp that the studio hangs up at the eye is none of a room.
        lookfrom_scene::studio::add_studio_and_camera(&mut scene, None);
        let mut warnings = Vec::new();
        Renderer::of_scene(scene, &mut warnings).unwrap();
        warnings.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    one(&warnings([0.0, 0.2, 0.3]), &["the camera stands inside the model"]);
    none(&warnings([0.0, 0.2, 30.0]));
}

#[test]
fn an_eye_that_sees_nothing_is_told_of() {
    let ball = "[[sphere]]\ncenter = [0, 0, 5]";
    one(&seen_from([0.0; 3], ball), &["a.toml:1:", "sees nothing", "[-1, -1, 4] and [1, 1, 6]"]);
    none(&seen_from([0.0, 0.0, 9.0], ball));
    // Small or thin things are something, and so is the light around without a thing.
    none(&seen_from([0.0, 0.0, 9.0], "[[sphere]]\ncenter = [0.3, 0.2, 0]\nradius = 0.1"));
    none(&seen_from([0.0; 3], ""));
    // Far smaller than a pixel, somewhere in the picture; but not beside it.
    none(&seen_from([0.0, 0.0, 9.0], "[[sphere]]\ncenter = [0.317, 0.211, 0]\nradius = 1e-5"));
    one(
        &seen_from([0.0, 0.0, 9.0], "[[sphere]]\ncenter = [31.7, 0.211, 0]\nradius = 1e-5"),
        &["sees nothing"],
    );
    // Bounds of a medium are there to be looked at; but not if they are elsewhere.
    let cloud = "[materials.m]\ntype = \"interface\"\n[[sphere]]\nmaterial = \"m\"\ncenter = ";
    none(&seen_from([0.0, 0.0, 9.0], &format!("{cloud}[0, 0, 0]")));
    one(&seen_from([0.0; 3], &format!("{cloud}[0, 0, 5]")), &["sees nothing"]);
    // In fog there is always something before the eye.
    let fog = "medium = \"fog\"\n[media.fog]\nabsorption = 0.1\nscattering = 0.1";
    none(&seen_from([0.0; 3], &format!("{fog}\n{ball}")));
    // What is behind is seen by an eye that sees all around.
    let around = "projection = \"equirectangular\"\n[image]\nwidth = 64\nheight = 32";
    none(&seen_from([0.0; 3], &format!("{around}\n{ball}")));
}

#[test]
fn reflectances_above_one_are_told_of() {
    let material =
        |text: &str| seen_from([0.0, 0.0, 5.0], &format!("[materials.red]\n{text}\n{BOX}material = \"red\""));
    one(
        &material("type = \"diffuse\"\nreflectance = [255, 128, 0]"),
        &["a.toml:4:", "reflectance", "`red`", "[255, 128, 0]", "divide by 255", "taken as 1"],
    );
    let slight = material("type = \"principled\"\nbase_color = [0.5, 1.25, 0]");
    one(&slight, &["base_color", "1.25", "taken as 1"]);
    assert!(!slight[0].contains("255"), "{slight:?}");
    one(&material("diffuse = [0.2, 1.5, 0.1]"), &["diffuse", "gives off more light than arrives"]);
    one(&material("mirror = 2"), &["mirror", "[2, 2, 2]"]);
    one(&material("type = \"conductor\"\nreflectance = 2"), &["reflectance"]);
    let texture = "reflectance = { type = \"checker\", even = [200, 10, 10], odd = 0.5 }";
    one(&material(&format!("type = \"diffuse\"\n{texture}")), &["a.toml:6:", "[200, 10, 10]"]);
    let curve = "reflectance = { curve = [[400, 0.5], [700, 50]] }";
    one(&material(&format!("type = \"diffuse\"\n{curve}")), &["reflectance"]);
    // Light, optical constants and tints of highlights go above it.
    for fine in [
        "type = \"diffuse\"\nreflectance = [1, 1, 1]\nemission = [255, 128, 0]",
        "type = \"unlit\"\ncolor = 7",
        "type = \"conductor\"\neta = [0.2, 0.4, 1.2]\nk = [3, 2.5, 2]",
        "type = \"principled\"\nspecular_color = 2",
    ] {
        none(&material(fine));
    }

    // In other formats.
    let obj = |mtl: &str| {
        let model = "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";
        warnings_of(&[("a.obj", model.to_owned()), ("a.mtl", format!("newmtl m\n{mtl}\n"))])
    };
    let is_about = |warnings: &[String], words: &[&str]| {
        let count = warnings.iter().filter(|warning| words.iter().all(|word| warning.contains(word))).count();
        assert_eq!(count, 1, "{warnings:#?}");
    };
    is_about(&obj("Kd 255 128 0"), &["a.mtl:1", "diffuse", "`m`", "[255, 128, 0]", "divide by 255"]);
    is_about(&obj("Kd 255 128 0\nmap_Kd white.png"), &["a.mtl:1", "white.png", "[255, 128, 0]"]);
    assert!(!obj("Kd 1 0.5 0\nKe 20 20 20").iter().any(|warning| warning.contains("go from 0 to 1")));
}

/// Readers of other formats take numbers as they are written; of those out of range the nearest counts.
#[test]
fn numbers_out_of_range_are_told_of() {
    let mitsuba = |bsdf: &str| {
        let sensor = r#"<sensor type="perspective"><transform name="to_world"><translate z="-5"/></transform></sensor>"#;
        let rest = format!(r#"<emitter type="constant"/><shape type="sphere">{bsdf}</shape>"#);
        warnings_of(&[("a.xml", format!(r#"<scene version="3.0.0">{sensor}{rest}</scene>"#))])
    };
    let float = |name: &str, value: f32| format!(r#"<float name="{name}" value="{value}"/>"#);
    let bsdf = |kind: &str, inside: &str| format!(r#"<bsdf type="{kind}">{inside}</bsdf>"#);
    let rough = mitsuba(&bsdf("roughconductor", &float("alpha", -1.0)));
    one(&rough, &["a.xml:1:", "the roughness of material", "is -1; expected at least 0: it counts as 0"]);
    one(
        &mitsuba(&bsdf("principled", &float("metallic", 2.0))),
        &["metallic", "expected 0 to 1: it counts as 1"],
    );
    let thin = bsdf("principledthin", &float("diff_trans", 3.0));
    one(&mitsuba(&thin), &["diff_trans", "expected 0 to 2: it counts as 2"]);
    let both = mitsuba(&bsdf("principled", &(float("metallic", 2.0) + &float("sheen_tint", -1.0))));
    assert_eq!(both.len(), 2, "{both:?}");
    none(&mitsuba(&bsdf("roughconductor", &float("alpha", 2.0))));
    none(&mitsuba(&bsdf("principled", &float("sheen", 3.0))));

    let pbrt = |material: &str| {
        let text = format!(
            "Camera \"perspective\"\nWorldBegin\nLightSource \"infinite\"\nMaterial {material}\nTranslate 0 0 5\nShape \"sphere\"\n"
        );
        warnings_of(&[("a.pbrt", text)])
    };
    one(&pbrt(r#""coateddiffuse" "float g" 2"#), &["a.pbrt:4:1", "the g of", "expected -1 to 1"]);
    one(&pbrt(r#""hair" "float beta_m" 5"#), &["roughness", "5", "counts as 1"]);
    one(&pbrt(r#""hair" "float eumelanin" -3"#), &["eumelanin", "counts as 0"]);
    none(&pbrt(r#""conductor" "float roughness" 3"#));
}

#[test]
fn absorption_without_an_inside_is_told_of() {
    let material =
        |text: &str| seen_from([0.0, 0.0, 5.0], &format!("[materials.m]\n{text}\n{BOX}material = \"m\""));
    let thin = "type = \"principled\"\ntransmission = 1\nabsorption = [0.1, 0.2, 0.3]\n";
    one(&material(thin), &["a.toml:7:", "`absorption` has no effect", "`solid = true`"]);
    none(&material(&format!("{thin}solid = true")));
    one(&material("absorption = 2"), &["`absorption` has no effect", "`transmission`"]);
    none(&material("absorption = 2\ntransmission = 0.5\ndiffuse = 0"));
}

#[test]
fn small_things_are_seen_through_a_lens_that_distorts() {
    let told = |x: f64| {
        let mut scene = own_scene("../docs/guide/scenes/camera-lens-system.toml");
        let view = View::Look { lookfrom: DVec3::ZERO, lookat: DVec3::NEG_Z, up: DVec3::Y };
        scene.camera = scene.camera.map(|camera| Camera { view, ..camera });
        let ball = Geometry::Sphere(Sphere { center: DVec3::new(x, 0.2, -30.0), radius: 1e-2 });
        scene.shapes = vec![Shape::new(Location::default(), ball, scene.shapes[0].material)];
        (scene.instances, scene.objects) = (Vec::new(), Vec::new());
        (scene.image.width, scene.image.height) = (201, 201);
        let mut warnings = Vec::new();
        Renderer::of_scene(scene, &mut warnings).unwrap();
        warnings.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    // At the middle of the picture, near its edge, and beyond.
    none(&told(0.01));
    none(&told(7.6));
    none(&told(-7.6));
    one(&told(12.0), &["sees nothing"]);
}
