//! A session: the same picture by every way in, moved cameras, cancellation, integrators of one's own.

use std::path::{Path, PathBuf};
use std::sync::Mutex;

use lookfrom::core::spectrum::Spectrum;
use lookfrom::film::Film;
use lookfrom::glam::DVec3;
use lookfrom::inspect::MultipleScatteringReport;
use lookfrom::integrator::{Integrator, Path as LightPath, Probe, SampleStream, StepOutput, Term};
use lookfrom::render::{Label, Progress, StopCriteria, StopReason, TileDone};
use lookfrom::session::{Exposure, FilmParts, Format, Options, Session, check_parts};
use lookfrom::shading::bsdf::principled::LocalScattering;
use lookfrom::shading::bsdf::{PreparedBsdf, PreparedClass};
use lookfrom::world::World;
use lookfrom_bvh::Hit;
use lookfrom_scene::camera::{Camera, View};
use lookfrom_scene::light::LightKind;
use lookfrom_scene::material::{Color, MaterialKind};
use lookfrom_scene::scene::{Bounds, MaterialId, Scene};
use lookfrom_scene::settings::{Background, FilterShape, Integrator as IntegratorName, RenderSettings};
use lookfrom_scene::shape::{Geometry, Sphere};
use lookfrom_scene::studio::Viewpoint;
use lookfrom_scene::{Budget, Disk, ErrorKind, Files, LoadContext, Memory, load};

fn own(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(name)
}

fn small() -> Options {
    Options { width: Some(48), height: Some(32), samples: Some(2), ..Options::default() }
}

fn film(session: &Session) -> Film {
    session.render(&()).expect("a picture").rendered.film
}

#[test]
fn every_way_in_makes_the_same_picture() {
    let path = own("models/star.ply");
    let opened = Session::open(&path, &small()).expect("a model");
    let bytes = std::fs::read(&path).expect("a file");
    let from_bytes = Session::from_bytes("star.ply", bytes, &small()).expect("a model");
    let scene = load::scene(&path, &mut LoadContext::new(&Disk)).expect("a model");
    let of_scene = Session::of_scene(scene, &small()).expect("a model");
    let film = film(&opened);
    for other in [&from_bytes, &of_scene, &opened.clone()] {
        assert!(film == self::film(other));
    }
    assert!(opened.image().denoise && opened.info().added.contains(&"lights"));
}

#[test]
fn a_session_goes_to_another_thread() {
    fn is_send<T: Send + Sync + 'static>() {}
    is_send::<Session>();
    is_send::<lookfrom::render::Renderer>();
}

#[test]
fn a_moved_camera_builds_nothing_and_sees_what_a_new_session_sees() {
    let mut moved = Session::open(own("whitted1980.toml"), &small()).expect("a scene");
    let world = moved.world().clone();
    let View::Look { lookfrom, lookat, up } = moved.camera().view else { panic!("not a look") };
    let elsewhere = lookfrom + DVec3::new(0.5, 0.25, -0.5);
    let view = View::Look { lookfrom: elsewhere, lookat, up };
    moved.set_camera(Camera { view, ..moved.camera().clone() }).expect("a camera that sees");
    assert!(std::sync::Arc::ptr_eq(&world, moved.world()));

    let options = Options { lookfrom: Some(elsewhere), ..small() };
    let anew = Session::open(own("whitted1980.toml"), &options).expect("a scene");
    let (a, b) = (film(&moved).picture(), film(&anew).picture());
    // Positions are rounded relative to another origin: a few samples at edges fall to the other side.
    let differ = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).any(|c| (a[c] - b[c]).abs() > 0.01 * (0.1 + b[c]));
    let differing = a.pixels.iter().zip(&b.pixels).filter(|&pair| differ(pair)).count();
    assert!(differing < a.pixels.len() / 100, "{differing} pixels differ");

    let nowhere = Camera { view: View::Look { lookfrom, lookat: lookfrom, up }, ..moved.camera().clone() };
    assert_eq!(moved.set_camera(nowhere).expect_err("it looks nowhere").kind, ErrorKind::Invalid);
    assert_eq!(film(&moved).picture(), a, "a camera that is refused changes nothing");
}

/// Files on disk, and how many of them were read.
struct Counted(Mutex<usize>);

impl Files for Counted {
    fn read(&self, path: &Path, limit: u64) -> lookfrom_scene::Result<Vec<u8>> {
        *self.0.lock().expect("a lock") += 1;
        Disk.read(path, limit)
    }
}

#[test]
fn a_turntable_reads_its_file_once_and_builds_one_tree() {
    let files = Counted(Mutex::new(0));
    let options = Options { turn: Some(0.0), floor: true, ..small() };
    let mut session = Session::read(&own("models/star.ply"), &files, &options).expect("a model");
    let (bvh, first) = (std::ptr::from_ref(session.world().bvh()), film(&session));
    for degrees in [90.0, 211.5] {
        session.set_turn(degrees).expect("a turntable");
        let options = Options { turn: Some(degrees), ..options.clone() };
        let alone = Session::open(own("models/star.ply"), &options).expect("a model");
        assert!(film(&session) == film(&alone), "at {degrees} degrees");
        assert!(film(&session) != first, "nothing turns");
    }
    assert!(std::ptr::eq(bvh, session.world().bvh()) && *files.0.lock().expect("a lock") == 1);
    session.set_turn(0.0).expect("a turntable");
    assert!(film(&session) == first);

    let mut plain = Session::open(own("models/star.ply"), &small()).expect("a model");
    assert_eq!(plain.set_turn(1.0).expect_err("no turntable").kind, ErrorKind::Request);
}

/// Two unit spheres, a million units apart, the camera before the first.
const FAR_APART: &str = r#"
    [camera]
    lookfrom = [0, 0, 3]
    lookat = [0, 0, 0]
    [[light]]
    type = "distant"
    from = [1, 1, 1]
    intensity = 1
    [materials.wall]
    diffuse = { type = "checker", space = "world", size = 0.2 }
    [[sphere]]
    material = "wall"
    center = [0, 0, 0]
    radius = 1
    [[sphere]]
    material = "wall"
    center = [1000000.03125, 0, 0]
    radius = 1
"#;

#[test]
fn a_camera_far_from_the_origin_gets_a_world_of_its_own() {
    let bytes = || FAR_APART.as_bytes().to_vec();
    let mut session = Session::from_bytes("far.toml", bytes(), &small()).expect("a scene");
    let world = session.world().clone();
    let center = DVec3::new(1_000_000.031_25, 0.0, 0.0);
    let (lookfrom, lookat) = (center + DVec3::new(0.0, 0.0, 3.0), center);
    let camera = |lookfrom| {
        let view = View::Look { lookfrom, lookat, up: DVec3::Y };
        Camera { view, ..Camera::default() }
    };
    // From afar nothing needs to be exact; from near it does.
    session.set_camera(camera(center + DVec3::new(0.0, 0.0, 5e4))).expect("a camera");
    assert!(std::sync::Arc::ptr_eq(&world, session.world()));
    session.set_camera(camera(lookfrom)).expect("a camera");
    assert!(session.world().is_precise_from(lookfrom) && !world.is_precise_from(lookfrom));
    let options = Options { lookfrom: Some(lookfrom), lookat: Some(lookat), ..small() };
    let anew = Session::from_bytes("far.toml", bytes(), &options).expect("a scene");
    assert!(film(&session) == film(&anew));

    // What cannot be read again says so, and stays as it is.
    let scene = Memory([("far.toml".into(), bytes())].into());
    let mut of_files = Session::read(Path::new("far.toml"), &scene, &small()).expect("a scene");
    let before = film(&of_files);
    let error = of_files.set_camera(camera(lookfrom)).expect_err("it is too far");
    assert_eq!(error.kind, ErrorKind::Request);
    assert!(film(&of_files) == before);
}

/// Two spheres of one material or two single-sided quads, a million units apart, the camera before the first.
fn far_apart(geometry: impl Fn(DVec3) -> Geometry) -> Scene {
    let mut scene = Scene::new();
    let blue = scene.material("blue", MaterialKind::Diffuse { reflectance: Color::Value([0.1, 0.1, 0.8]) });
    for center in [DVec3::ZERO, FAR] {
        scene.shape(geometry(center), blue).single_sided = true;
    }
    scene
        .light(LightKind::Distant { direction: [-1.0, -1.0, -1.0].into(), intensity: Color::gray(1.0) })
        .look([0.0, 0.0, 3.0], [0.0; 3], 40.0)
        .integrator(IntegratorName::Path, 2);
    scene
}

const FAR: DVec3 = DVec3::new(1e6, 0.0, 0.0);

/// The camera before the second.
fn far_camera() -> Camera {
    let view = View::Look { lookfrom: FAR + DVec3::new(0.0, 0.0, 3.0), lookat: FAR, up: DVec3::Y };
    Camera { view, ..Camera::default() }
}

#[test]
fn a_camera_far_away_sees_what_was_changed_in_the_scene_that_is_kept() {
    let scene = far_apart(|center| Geometry::Sphere(Sphere { center, radius: 1.0 }));
    let budget = Budget::new(1 << 30);
    let options = Options { keep_scene: true, budget: budget.clone(), ..small() };
    let mut session = Session::of_scene(scene, &options).expect("a scene");
    let mut red = session.scene().expect("it is kept").materials[0].clone();
    red.kind = MaterialKind::Diffuse { reflectance: Color::Value([0.8, 0.1, 0.1]) };
    session.set_material(MaterialId(0), red).expect("a material");
    let mut lights = session.scene().expect("it is kept").lights.clone();
    lights[0].power.scale = 0.5;
    session.set_lights(lights).expect("a light");

    let (before, left) = (session.clone(), budget.left());
    session.set_camera(far_camera()).expect("a camera");
    assert!(session.world().is_precise_from(FAR) && !before.world().is_precise_from(FAR));
    // What both share is the scene that is kept.
    drop(before);
    assert_eq!(budget.left(), left, "the memory of what is kept is another");
    let picture = film(&session).picture();
    let sum = |channel: usize| picture.pixels.iter().map(|rgb| rgb[channel]).sum::<f32>();
    assert!(sum(0) > 4.0 * sum(2), "{} {}", sum(0), sum(2));
    let scene = session.into_scene().expect("it is kept");
    assert!(picture == film(&Session::of_scene(scene, &Options::default()).expect("a scene")).picture());
}

#[test]
fn backs_are_seen_wherever_the_camera_goes() {
    let corner = DVec3::new(-1.0, -1.0, 0.0);
    let behind = far_apart(|center| Geometry::Quad {
        corner: center + corner,
        edge_u: DVec3::Y * 2.0,
        edge_v: DVec3::X * 2.0,
    });
    let mut session = Session::keeping(behind, &small()).expect("a scene");
    let seen = |session: &Session| session.renderer().labels().iter().any(|label| label.shape != Label::NONE);
    let lit = |session: &Session| film(session).picture().pixels.iter().any(|rgb| rgb[2] > 0.0);
    assert!(seen(&session) && lit(&session));
    session.set_camera(far_camera()).expect("a camera");
    assert!(seen(&session) && lit(&session));
}

#[test]
fn numbers_without_a_meaning_are_refused_by_name() {
    let path = own("whitted1980.toml");
    let nan = f64::NAN;
    let view = Viewpoint { elevation: nan, ..Viewpoint::THREE_QUARTER };
    let upside_down = Bounds { min: DVec3::ONE, max: DVec3::NEG_ONE };
    let stop = |noise| StopCriteria { noise: Some(noise), time: None };
    let of = Options::default;
    let options = [
        ("radius", Options { filter: Some(FilterShape::Box.of_radius(f32::NAN)), ..of() }),
        ("radius", Options { filter: Some(FilterShape::Box.of_radius(0.0)), ..of() }),
        ("radius", Options { filter: Some(FilterShape::Triangle.of_radius(-2.0)), ..of() }),
        ("radius", Options { filter: Some(FilterShape::Box.of_radius(1e6)), ..of() }),
        ("sigma", Options { filter: Some(FilterShape::Gaussian { sigma: f32::NAN }.of_radius(1.0)), ..of() }),
        ("exposure", Options { exposure: Some(Exposure::Stops(f32::NAN)), ..of() }),
        ("background", Options { background: Some(Background::Color([0.0, f32::NAN, 0.0])), ..of() }),
        ("min_contribution", Options { min_contribution: Some(-1.0), ..of() }),
        ("noise", Options { stop: stop(nan), ..of() }),
        ("noise", Options { stop: stop(-0.1), ..of() }),
        ("up", Options { up: Some(DVec3::ZERO), ..of() }),
        ("up", Options { up: Some(DVec3::NAN), ..of() }),
        ("lookfrom", Options { lookfrom: Some(DVec3::INFINITY), ..of() }),
        ("fov", Options { fov: Some(180.0), ..of() }),
        ("0 × ", Options { width: Some(0), ..of() }),
        // The rest need the scene read again.
        ("rotate_environment", Options { rotate_environment: Some(nan), ..of() }),
        ("rotate_environment", Options { rotate_environment: Some(f64::INFINITY), ..of() }),
        ("elevation", Options { elevation: Some(500.0), ..of() }),
        ("elevation", Options { view: Some(view), ..of() }),
        ("azimuth", Options { azimuth: Some(nan), ..of() }),
        ("turn", Options { turn: Some(nan), ..of() }),
        ("bounds", Options { bounds: Some(Bounds { min: DVec3::NAN, max: DVec3::ONE }), ..of() }),
        ("bounds", Options { bounds: Some(upside_down), ..of() }),
    ];
    let mut session = Session::open(&path, &small()).expect("a scene");
    for (name, options) in options {
        let error = Session::open(&path, &options).expect_err(name);
        assert!(matches!(error.kind, ErrorKind::Request | ErrorKind::Invalid), "{error}");
        assert!(error.message.contains(name), "{name}: {error}");
        if options.of_scene().is_none() {
            let error = session.change(&options).expect_err(name);
            assert!(error.message.contains(name), "{name}: {error}");
        }
    }
    // What a scene without shapes has.
    let empty = Options { bounds: Some(Bounds::EMPTY), ..small() };
    Session::open(&path, &empty).expect("bounds of nothing");

    let mut image = session.image().clone();
    image.sensor.white_balance = Some(f32::NAN);
    let error = session.set_image(image).expect_err("a white balance");
    assert!(error.kind == ErrorKind::Invalid && error.message.contains("white_balance"), "{error}");
    let settings = RenderSettings { occlusion_distance: f32::NAN, ..session.settings().clone() };
    let error = session.set_settings(settings).expect_err("a distance");
    assert!(error.kind == ErrorKind::Invalid && error.message.contains("occlusion_distance"), "{error}");
    let error = session.renderer().render_until(&stop(nan), None, &()).expect_err("a limit");
    assert_eq!(error.kind, ErrorKind::Request);
}

#[test]
fn too_many_threads_make_the_same_picture() {
    let of = |threads| Options { threads: Some(threads), ..small() };
    let [one, many] = [1, 70_000]
        .map(|threads| film(&Session::open(own("whitted1980.toml"), &of(threads)).expect("a scene")));
    assert!(one == many);
}

#[test]
fn a_picture_without_pixels_is_refused() {
    let mut scene = far_apart(|center| Geometry::Sphere(Sphere { center, radius: 1.0 }));
    scene.size(0, 10);
    let options = Options { width: Some(5), ..Options::default() };
    let error = Session::of_scene(scene.clone(), &options).expect_err("no pixels");
    assert!(error.kind == ErrorKind::Invalid && error.message.contains("0 × 10"), "{error}");
    check_parts(scene, &options, 2).expect_err("no pixels");
}

#[test]
fn a_format_without_alpha_keeps_its_background() {
    let options = Options { format: Some(Format::Jpeg(90)), ..small() };
    let mut session = Session::open(own("whitted1980.toml"), &options).expect("a scene");
    let see_through = Options { background: Some(Background::Transparent), ..Options::default() };
    let error = session.change(&see_through).expect_err("no alpha");
    assert!(error.kind == ErrorKind::Request && error.message.contains("JPEG"), "{error}");
    let png = Options { format: Some(Format::Png), ..see_through };
    session.change(&png).expect("a format with alpha");
}

#[test]
fn types_that_are_handed_out_have_names_and_are_shown() {
    fn is_shown<T: std::fmt::Debug>() {}
    is_shown::<FilmParts<'_>>();
    is_shown::<PreparedBsdf<PreparedClass>>();
    is_shown::<LocalScattering>();
    is_shown::<MultipleScatteringReport>();
}

#[test]
fn options_that_do_not_suit_the_scene_are_refused() {
    let options = Options { fov: Some(30.0), ..small() };
    let error = Session::open(own("orthographic.toml"), &options).expect_err("parallel rays");
    assert_eq!(error.kind, ErrorKind::Request);
    let missing = Session::open(own("nothing.toml"), &small()).expect_err("no such file");
    assert_eq!(missing.kind, ErrorKind::Io);
}

struct Count(std::sync::Arc<Mutex<u64>>);

impl Progress for Count {
    fn tile(&self, done: TileDone) {
        *self.0.lock().expect("a lock") = done.done;
    }
}

#[test]
fn a_render_in_the_background_can_be_cancelled() {
    let options = Options { samples: Some(1 << 20), threads: Some(1), ..small() };
    let session = Session::open(own("whitted1980.toml"), &options).expect("a scene");
    let done = std::sync::Arc::new(Mutex::new(0));
    let running = session.start(Count(done.clone())).expect("a thread");
    while *done.lock().expect("a lock") == 0 {
        std::thread::yield_now();
    }
    running.cancel();
    let finished = running.finish().expect("a picture");
    assert_eq!(finished.rendered.reason, StopReason::Cancelled);
    assert!(finished.rendered.samples_taken > 0);
    assert!(finished.encode(Format::Png).expect("a PNG").starts_with(b"\x89PNG"));
}

/// White where anything is hit.
#[derive(Debug)]
struct Silhouette;

impl Integrator for Silhouette {
    type State = ();

    fn name(&self) -> &'static str {
        "silhouette"
    }

    fn step<P: Probe>(
        &self,
        _: &World,
        _: &SampleStream,
        path: &LightPath,
        hit: &Hit,
        output: &mut StepOutput<'_, P>,
    ) {
        if hit.is_hit() {
            output.add(path, Term::View, Spectrum::from_rgb([1.0; 3]));
        }
    }
}

#[test]
fn an_integrator_of_ones_own() {
    let options = Options { denoise: Some(false), ..small() };
    let mut session = Session::open(own("models/star.ply"), &options).expect("a model");
    session.set_integrator(Silhouette);
    let finished = session.render(&()).expect("a picture");
    assert!(finished.header.contains(&("integrator".to_owned(), "silhouette".to_owned())));
    let values: Vec<f32> = finished.picture.pixels.iter().map(|rgb| rgb[0]).collect();
    assert!(values.contains(&0.0) && values.contains(&1.0));
    assert!(values.iter().all(|v| (0.0..=1.0).contains(v)));
    // It stays when the camera or an option moves, and the settings' own comes back with them.
    session.set_camera(session.camera().clone()).expect("the same camera");
    assert_eq!(session.renderer().integrator(), "silhouette");
    for exposure in [Exposure::Stops(1.0), Exposure::Auto] {
        let options = Options { samples: Some(3), depth: Some(4), exposure: Some(exposure), ..small() };
        session.change(&options).expect("it suits");
        assert_eq!(session.renderer().integrator(), "silhouette");
    }
    let mut named = session.clone();
    named
        .change(&Options { integrator: Some(IntegratorName::Normals), ..Options::default() })
        .expect("it suits");
    assert_ne!(named.renderer().integrator(), "silhouette");
    session.set_settings(session.settings().clone()).expect("the same settings");
    assert_eq!(session.renderer().integrator(), "path");
}

#[test]
fn only_a_scene_without_shapes_and_fog_shows_nothing_but_its_background() {
    let told = |fog: &str| {
        let lamp = "[[light]]\ntype = \"point\"\nposition = [1, 0, -3]\nintensity = 1";
        let camera = "[camera]\nlookfrom = [0, 0, 0]\nlookat = [0, 0, -1]";
        let scene = format!("{camera}\n{fog}\n{lamp}");
        let session = Session::from_bytes("a.toml", scene.into_bytes(), &small()).expect("a scene");
        session.warnings().iter().any(|warning| warning.message.contains("no geometry"))
    };
    assert!(told(""));
    assert!(!told("medium = \"fog\"\n[media.fog]\nscattering = 0.1"));
    assert!(told("medium = \"fog\"\n[media.fog]\nscattering = 0.1\n[render]\nmedia = false"));
}
