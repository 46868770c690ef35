//! Our own format: what is said is what is read, and what is wrong is named with its place and a remedy.

use std::path::Path;

use crate::support::shown;
use glam::{DMat4, DVec3};
use lookfrom_scene::camera::{Projection, View};
use lookfrom_scene::excerpt::Excerpts;
use lookfrom_scene::light::{LightKind, Sky};
use lookfrom_scene::material::{Color, MaterialKind, Whitted};
use lookfrom_scene::shape::Geometry;
use lookfrom_scene::texture::{Mapping, TextureKind};
use lookfrom_scene::{ErrorKind, LoadContext, Memory, Result, Scene, image, load};

fn files(texts: &[(&str, &str)]) -> Memory {
    let mut files = Memory::default();
    for (name, text) in texts {
        files.0.insert(name.into(), text.as_bytes().to_vec());
    }
    files.0.insert("wide.png".into(), image::encode_png(2, 1, &[128; 6]).expect("a picture"));
    files.0.insert("dot.png".into(), image::encode_png(1, 1, &[255, 0, 0]).expect("a picture"));
    files.0.insert("simple.dat".into(), b"50 5 1.5 20\n-50 0 1 20".to_vec());
    files
}

fn read_files(texts: &[(&str, &str)]) -> Result<Scene> {
    let files = files(texts);
    load::scene(Path::new(texts[0].0), &mut LoadContext::new(&files))
}

fn read(text: &str) -> Scene {
    read_files(&[("a.toml", text)]).unwrap_or_else(|error| panic!("{error}\nin\n{text}"))
}

fn look(scene: &Scene, index: usize) -> &Whitted {
    let MaterialKind::Whitted(whitted) = &scene.materials[index].kind else { panic!("not Whitted's") };
    whitted
}

/// `tests/library/toml/errors.txt` has bad scenes and what is said of them; `LOOKFROM_ACCEPT=1 cargo test` writes anew what is
/// said.
#[test]
fn errors_say_where_and_what_to_do() {
    let expected = include_str!("toml/errors.txt");
    let mut cases = expected.split("\n=====\n");
    let (mut found, mut count) = (String::new(), 0);
    for case in cases.by_ref() {
        let (text, _) = case.split_once("\n-----\n").unwrap_or((case, ""));
        let files = files(&[("a.toml", text)]);
        let error = match load::scene(Path::new("a.toml"), &mut LoadContext::new(&files)) {
            Ok(_) => "no error".to_owned(),
            Err(error) => shown(&error, &files),
        };
        if count > 0 {
            found.push_str("\n=====\n");
        }
        found.push_str(&format!("{text}\n-----\n{error}"));
        count += 1;
    }
    if std::env::var_os("LOOKFROM_ACCEPT").is_some() {
        std::fs::write("tests/library/toml/errors.txt", &found).expect("the expectations can be written");
        return;
    }
    assert!(count > 60);
    for (found, expected) in found.split("\n=====\n").zip(expected.split("\n=====\n")) {
        assert_eq!(found, expected);
    }
}

#[test]
fn a_small_scene_is_what_it_says() {
    let scene = read(
        r##"
[camera]
lookfrom = [0, 1, -4]
lookat = [0, 1, 0]
fov = 60
aperture = 0.1
focus = [5, 1, -1]
[image]
width = 320
height = 200
crop = [10, 20, 30, 40]
filter = { type = "mitchell", radius = [3, 2] }
[render]
integrator = "raycast"
samples = 4
seed = 18
[materials.red]
diffuse = "#ff0000"
specular = 0.5
mirror = "check"
emission = [1, 2, 3]
[textures.check]
type = "checker"
even = { type = "noise" }
scale = [2, 3]
[[sphere]]
radius = 2
material = "red"
name = "ball"
[[quad]]
corner = [0, 0, 0]
edge_u = [1, 0, 0]
edge_v = [0, 1, 0]
[[light]]
type = "point"
position = [1, 2, 3]
intensity = 5
"##,
    );
    assert_eq!(scene.image.filter.radius, [3.0, 2.0]);
    let camera = scene.camera.as_ref().expect("a camera");
    assert_eq!(camera.projection, Projection::Perspective { fov: 60.0 });
    assert_eq!(camera.lens.expect("a lens").focus_distance, 3.0);
    let View::Look { up, .. } = camera.view else { panic!("looks") };
    assert_eq!(up, DVec3::Y);
    assert_eq!((scene.image.width, scene.image.crop.expect("a crop").y1), (320, 40));
    assert_eq!((scene.render.samples, scene.render.seed, scene.render.depth), (4, 18, 8));
    let red = look(&scene, 0);
    assert_eq!((red.diffuse, red.specular), (Color::Value([1.0, 0.0, 0.0]), Color::gray(0.5)));
    let Color::Texture(id) = red.mirror else { panic!("a texture") };
    let TextureKind::Checker { even: Color::Texture(noise), mapping, .. } = scene.textures[id.index()].kind
    else {
        panic!("a checker of noise")
    };
    assert_eq!(mapping, Mapping::Uv { scale: [2.0, 3.0], offset: [0.0; 2] });
    assert!(matches!(scene.textures[noise.index()].kind, TextureKind::Noise { octaves: 4, .. }));
    assert_eq!((scene.shapes[0].name.as_deref(), scene.shapes[0].at.line), (Some("ball"), 26));
    assert!(scene.shapes[0].emission.is_some() && scene.shapes[1].emission.is_none());
    assert_eq!(scene.materials[scene.shapes[1].material.index()].name, "default");
    assert!(matches!(
        scene.lights[0].kind,
        LightKind::Point { intensity: Color::Value([5.0, 5.0, 5.0]), .. }
    ));
}

#[test]
fn steps_are_applied_in_their_order() {
    let at = |text: &str, point: [f64; 3]| {
        let scene = read(&format!("[[sphere]]\n{text}"));
        scene.shapes[0].world_from_object.transform_point3(DVec3::from_array(point)).to_array()
    };
    assert_eq!(
        at("scale = 2\nrotate = [0, 90, 0]\ntranslate = [10, 0, 0]", [1.0, 0.0, 0.0]),
        [10.0, 0.0, -2.0]
    );
    assert_eq!(
        at("transform = [{ translate = [10, 0, 0] }, { scale = [2, 1, 1] }]", [1.0, 0.0, 0.0]),
        [22.0, 0.0, 0.0]
    );
    // About x, then y, then z.
    assert_eq!(at("rotate = [90, 90, 0]", [0.0, 1.0, 0.0]), [1.0, 0.0, 0.0]);
    assert_eq!(at("rotate = { axis = [0, 0, 2], angle = -90 }", [1.0, 0.0, 0.0]), [0.0, -1.0, 0.0]);
    let rows = "transform = [{ matrix = [1,0,0,5, 0,1,0,6, 0,0,1,7, 0,0,0,1] }]";
    assert_eq!(at(rows, [0.0; 3]), [5.0, 6.0, 7.0]);
    // Any angle: the length stays, and the opposite turn undoes it.
    for exponent in -20..12 {
        let angle = 1.37 * f64::powi(3.0, exponent);
        let text = format!(
            "transform = [{{ rotate = [0, {angle}, 0] }}, {{ rotate = {{ axis = [0, 1, 0], angle = -{angle} }} }}]"
        );
        assert!((DVec3::from_array(at(&text, [1.0, 2.0, 3.0])) - DVec3::new(1.0, 2.0, 3.0)).length() < 1e-12);
    }
}

#[test]
fn lamps_are_shapes_that_shine_the_right_way() {
    let scene = read(
        r#"
[[light]]
type = "rectangle"
center = [0, 4, 0]
target = [0, 0, 0]
width = 2
height = 1
radiance = 10
[[light]]
type = "disk"
center = [0, 4, 0]
target = [0, 0, 0]
radius = 1
radiance = 10
[[light]]
type = "sphere"
center = [0, 4, 0]
radius = 0.5
radiance = [1, 2, 3]
"#,
    );
    assert!(scene.lights.is_empty());
    let Geometry::Quad { corner, edge_u, edge_v } = scene.shapes[0].geometry else { panic!("a quad") };
    assert_eq!(corner + 0.5 * (edge_u + edge_v), DVec3::new(0.0, 4.0, 0.0));
    assert_eq!(edge_u.cross(edge_v), DVec3::new(0.0, -2.0, 0.0));
    let Geometry::Disk { normal, .. } = scene.shapes[1].geometry else { panic!("a disk") };
    assert!(normal.y < 0.0);
    assert_eq!(scene.shapes[2].emission.expect("it shines").radiance, Color::Value([1.0, 2.0, 3.0]));
    assert_eq!(scene.materials.len(), 1);
    assert_eq!(look(&scene, 0).diffuse, Color::BLACK);
}

#[test]
fn a_plane_has_uv_in_units_of_length() {
    let scene = read("[[plane]]\npoint = [1, 2, 3]\nnormal = [1, 2, -2]\nsize = 10");
    let mesh = &scene.meshes[0];
    for (p, uv) in mesh.positions.iter().zip(&mesh.uvs) {
        for (q, other) in mesh.positions.iter().zip(&mesh.uvs) {
            assert!((p.distance(*q) - uv.distance(*other)).abs() < 1e-4);
        }
        assert!((p.as_dvec3() - DVec3::new(1.0, 2.0, 3.0)).dot(DVec3::new(1.0, 2.0, -2.0)).abs() < 1e-4);
    }
    let [a, b, c] = mesh.triangles[0].map(|i| mesh.positions[i as usize].as_dvec3());
    assert!((b - a).cross(c - a).dot(DVec3::new(1.0, 2.0, -2.0)) > 0.0);
}

#[test]
fn objects_are_repeated_by_instances() {
    let scene = read(
        r#"
[materials.blue]
diffuse = [0, 0, 1]
[[objects.pair.sphere]]
[[objects.pair.box]]
min = [0, 0, 0]
max = [1, 2, 3]
[[instance]]
object = "pair"
translate = [1, 0, 0]
[[instance]]
object = "pair"
material = "blue"
scale = [-1, 1, 1]
"#,
    );
    assert_eq!((scene.objects[0].shapes.len(), scene.shapes.len(), scene.instances.len()), (2, 0, 2));
    assert_eq!(scene.instances[0].world_from_object, DMat4::from_translation(DVec3::X));
    assert_eq!(scene.instances[1].material.map(|id| scene.materials[id.index()].name.as_str()), Some("blue"));
}

#[test]
fn skies() {
    let scene = read(
        r##"
[[light]]
type = "environment"
zenith = [0, 0, 1]
horizon = 1
[[light]]
type = "environment"
image = "dot.png"
rotate = 90
illuminates = false
"##,
    );
    let LightKind::Environment { sky: Sky::Gradient { nadir, .. }, illuminates: true, .. } =
        scene.lights[0].kind
    else {
        panic!("a gradient")
    };
    assert_eq!(nadir, [1.0; 3]);
    let LightKind::Environment {
        sky: Sky::Image { image, world_from_light, .. }, illuminates: false, ..
    } = scene.lights[1].kind
    else {
        panic!("a picture")
    };
    assert_eq!(scene.images[image.index()].texels().collect::<Vec<_>>(), [[1.0, 0.0, 0.0]]);
    assert_eq!(world_from_light.transform_vector3(DVec3::Z), DVec3::X);
}

#[test]
fn imports_join_and_the_importing_file_decides() {
    let scene = read_files(&[
        (
            "scenes/a.toml",
            "import = [\"looks/b.toml\", \"looks/../c.toml\"]\n[image]\nwidth = 10\n[[sphere]]\nmaterial = \"red\"",
        ),
        (
            "scenes/looks/b.toml",
            "import = \"d.toml\"\n[camera]\nlookfrom = [0, 0, 1]\nlookat = [0, 0, 0]\n[render]\nsamples = 3\n[image]\nwidth = 20",
        ),
        (
            "scenes/looks/../c.toml",
            "import = \"looks/d.toml\"\n[camera]\nlookfrom = [0, 0, 2]\nlookat = [0, 0, 0]\n[render]\nsamples = 4\n[[sphere]]",
        ),
        ("scenes/looks/d.toml", "[materials.red]\ndiffuse = [1, 0, 0]\n[materials.default]\ndiffuse = 0.3"),
    ]);
    // `looks/../looks/d.toml` is another way to say it; it joins once.
    let scene = scene.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((scene.image.width, scene.render.samples), (10, 3));
    let View::Look { lookfrom, .. } = scene.camera.as_ref().expect("a camera").view else { panic!() };
    assert_eq!(lookfrom.z, 1.0);
    assert_eq!(scene.materials.len(), 2);
    assert_eq!(scene.shapes.len(), 2);
    assert_eq!(look(&scene, scene.shapes[0].material.index()).diffuse, Color::gray(0.3));
}

#[test]
fn a_default_may_be_written_after_it_is_needed() {
    let scene = read_files(&[
        ("a.toml", "import = \"b.toml\"\n[materials.default]\ndiffuse = 0.25"),
        ("b.toml", "[[sphere]]"),
    ])
    .expect("reads");
    assert_eq!(look(&scene, scene.shapes[0].material.index()).diffuse, Color::gray(0.25));
}

#[test]
fn imports_that_never_end_are_errors_that_show_the_chain() {
    let error =
        read_files(&[("a.toml", "import = \"x/b.toml\""), ("x/b.toml", "\nimport = [\"../a.toml\"]")])
            .unwrap_err();
    assert_eq!(
        error.to_string(),
        "x/b.toml:2:11: this file imports itself: a.toml → x/b.toml → x/../a.toml\n  help: take one of these imports out"
    );
    let chain: Vec<(String, String)> =
        (0..40).map(|i| (format!("{i}.toml"), format!("import = \"{}.toml\"", i + 1))).collect();
    let chain: Vec<(&str, &str)> = chain.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
    let error = read_files(&chain).unwrap_err();
    assert_eq!((error.kind, error.at.to_string().as_str()), (ErrorKind::Limit, "16.toml:1:10"));
    let error =
        read_files(&[("a.toml", "import = \"b.toml\""), ("b.toml", "\n\nimport = \"c.toml\"")]).unwrap_err();
    assert_eq!(error.to_string(), "b.toml:3:10: c.toml: no such file");
}

#[test]
fn limits_hold() {
    let mut sources_files = files(&[("a.toml", "[[sphereflake]]\ndepth = 3")]);
    let mut context = LoadContext::new(&sources_files);
    context.limits.elements = 819;
    let error = load::scene(Path::new("a.toml"), &mut context).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Limit);
    context.limits.elements = 820;
    assert!(load::scene(Path::new("a.toml"), &mut context).is_ok());
    sources_files.0.insert("a.toml".into(), "[[sphereflake]]\ndepth = 3\n".repeat(2).into_bytes());
    let mut context = LoadContext::new(&sources_files);
    context.limits.elements = 820;
    let error = load::scene(Path::new("a.toml"), &mut context).unwrap_err();
    assert_eq!((error.kind, error.at.line), (ErrorKind::Limit, 3));

    let chain: String =
        (0..20).map(|i| format!("[textures.t{i}]\ntype = \"checker\"\neven = \"t{}\"\n", i + 1)).collect();
    sources_files
        .0
        .insert("a.toml".into(), format!("{chain}[textures.t20]\ntype = \"vertex_color\"").into_bytes());
    let error = load::scene(Path::new("a.toml"), &mut LoadContext::new(&sources_files)).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Limit, "{error}");

    let nested = format!("[[sphere]]\nemission = {}1{}", "[".repeat(100_000), "]".repeat(100_000));
    sources_files.0.insert("a.toml".into(), nested.into_bytes());
    assert!(load::scene(Path::new("a.toml"), &mut LoadContext::new(&sources_files)).is_err());
}

#[test]
fn many_spheres_are_read_in_about_a_second() {
    let text: String = (0..100_000)
        .map(|i| format!("[[sphere]]\ncenter = [{i}, 1.5, -2e0]\nradius = 0.1\nmaterial = \"red\"\n"))
        .collect();
    let start = std::time::Instant::now();
    let scene = read(&format!("{text}[materials.red]\ndiffuse = [0.8, 0.1, 0.1]"));
    assert_eq!(scene.shapes.len(), 100_000);
    assert!(start.elapsed().as_secs() < 10, "{:?}", start.elapsed());
}

/// Errors by the thousand are found, counted and shown in about a second, also where the text is one long line.
#[test]
fn thousands_of_errors_are_no_burden() {
    let table = |i: usize| {
        format!("[[sphere]]\nradus = 1\nmaterial = \"x\"\n[materials.m{i}]\ncolor = [1, 2]\nior = 0\n")
    };
    let many = (0..20_000).map(table).collect::<String>();
    let long = format!("sphere = [{}]", "{ raduis = 1, material = \"x\", center = 1 }, ".repeat(20_000));
    let broken = "[[sphere]]\nradius = = 1\n".repeat(20_000);
    for (text, most) in [(many, 1000), (long, 1000), (broken, 20_000)] {
        let started = std::time::Instant::now();
        let files = files(&[("a.toml", &text)]);
        let error = load::scene(Path::new("a.toml"), &mut LoadContext::new(&files)).expect_err("errors");
        assert_eq!(error.each().count(), most);
        let mut excerpts = Excerpts::new(&files);
        assert!(error.first_few().0.all(|error| excerpts.of(&error.at).is_some()));
        assert!(started.elapsed().as_secs() < 20, "{:?}", started.elapsed());
    }
}

#[test]
fn a_light_that_is_not_blurred_is_told() {
    let files = files(&[(
        "a.toml",
        "[camera]\nlookfrom = [0, 1, 5]\nlookat = [0, 0, 0]\nshutter = 0.5\n\n\
         [[light]]\ntype = \"point\"\nposition = [\"= t\", 3, 0]\nintensity = 1\n\n\
         [[light]]\ntype = \"sphere\"\ncenter = [\"= t\", 3, 0]\nradius = 1\nradiance = 1\n",
    )]);
    let mut context = LoadContext::new(&files);
    let scene = load::scene(Path::new("a.toml"), &mut context).expect("a scene");
    assert_eq!(scene.instances.iter().filter(|instance| instance.motion.is_some()).count(), 1);
    let said: Vec<String> = context.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(said[0].starts_with("a.toml:6:1: not blurred: a light"), "{said:?}");
}

/// A camera and an instance with motions of their own, beside a sphere that moves by an expression.
#[test]
fn what_stands_still_by_expressions_keeps_its_own_motion() {
    let moved = "motion = [[1, 0, 0, 0,  0, 1, 0, 0,  0, 0, 1, 0,  0, 0, 0, 1], [1, 0, 0, 1,  0, 1, 0, 0,  0, 0, 1, 0,  0, 0, 0, 1]]";
    let scene = read(&format!(
        "[camera]\nlookfrom = [0, 1, 5]\nlookat = [0, 0, 0]\nshutter = 0.5\n{moved}\n\
         [[objects.ball.sphere]]\ncenter = [0, 0, 0]\nradius = 1\n\
         [[instance]]\nobject = \"ball\"\n{moved}\n\
         [[sphere]]\ncenter = {{ keyframes = [[0, [0, 3, 0]], [1, [1, 3, 0]]] }}\nradius = 1\n"
    ));
    assert!(scene.camera.expect("a camera").motion.is_some());
    assert_eq!(scene.instances.iter().filter(|instance| instance.motion.is_some()).count(), 2);
}

#[test]
fn stops_are_at_most_as_wide_as_in_the_lens_file() {
    let of = |keys: &str| {
        let text = format!("[camera]\nlookfrom = [0, 0, 5]\nlookat = [0, 0, 0]\nlens = \"lens.dat\"\n{keys}");
        let files = files(&[("a.toml", &text), ("lens.dat", "50 2 1.5 20\n0 3 0 17.1\n-50 0 1 20")]);
        let mut context = LoadContext::new(&files);
        let scene = load::scene(Path::new("a.toml"), &mut context).expect("a good scene");
        let camera = scene.camera.expect("a camera");
        let Projection::LensSystem(system) = &camera.projection else { panic!("no lens system") };
        (system.stop_diameter, context.warnings.iter().map(ToString::to_string).collect::<Vec<_>>())
    };
    assert_eq!(of(""), (None, vec![]));
    assert_eq!(of("stop = 4"), (Some(4.0), vec![]));
    assert_eq!(of("aperture = 0.00855"), (Some(17.1), vec![]));
    let (diameter, warnings) = of("aperture = 0.01");
    assert_eq!((diameter, warnings.len()), (Some(17.1), 1));
    assert!(
        warnings[0].contains("a.toml:5:12: the aperture stop of the lens file is 17.1 mm wide"),
        "{warnings:?}"
    );
}
