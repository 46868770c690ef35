//! Motion while the shutter is open: a blurred picture is the mean of pictures of instants.

use std::path::PathBuf;

use lookfrom::film::{Film, FilmTile};
use lookfrom::inspect::inspect;
use lookfrom::render::SampleId;
use lookfrom_scene::settings::{ColorMode, Integrator, PixelBounds};
use lookfrom_scene::{LoadContext, Memory, Scene, load};

use crate::support::Compiled;

const SIZE: [u32; 2] = [16, 12];

/// What moves in every way: the camera, a ball, a box that turns, one that grows, a lamp, a lamp that grows.
const MOVING: &str = r#"
    [camera]
    lookfrom = ["= 0.5 * t", 1.5, 5]
    lookat = [0, 0.7, 0]
    fov = 45
    [image]
    width = 16
    height = 12
    filter = "box"
    [render]
    integrator = "path"
    depth = 3
    [materials]
    white = { type = "diffuse", reflectance = 0.6 }
    red = { type = "diffuse", reflectance = [0.7, 0.2, 0.1] }
    [[plane]]
    point = [0, 0, 0]
    normal = [0, 1, 0]
    material = "white"
    [[sphere]]
    center = ["= -1.5 + 1.5 * t", 0.5, 0]
    radius = 0.5
    material = "red"
    [[box]]
    min = [-0.6, -0.1, -0.1]
    max = [0.6, 0.1, 0.1]
    transform = [{ rotate = { axis = [0, 1, 0], angle = "= 90 * t" } }, { translate = [0.9, 0.4, 0] }]
    material = "white"
    [[box]]
    min = [-0.5, 0, -2]
    max = [0.2, "= 0.3 + t", -1.5]
    material = "red"
    [[sphere]]
    center = ["= 1 - 2 * t", 2, 1]
    radius = 0.3
    emission = [20, 18, 12]
    material = "white"
    [[sphere]]
    center = [-2, 0.3, 1]
    radius = "= 0.1 + 0.2 * t"
    emission = 2
    material = "white"
"#;

/// The scene from a time on, while the shutter is open for a number of frames, which are seconds.
fn scene(at: f64, shutter: f64) -> Scene {
    let name = PathBuf::from("moving.toml");
    let files = Memory([(name.clone(), MOVING.as_bytes().to_vec())].into());
    let mut context = LoadContext::new(&files);
    (context.import.at, context.import.shutter, context.variables.fps) = (Some(at), Some(shutter), 1.0);
    let scene = load::scene(&name, &mut context).unwrap_or_else(|error| panic!("{error}"));
    assert!(context.warnings.is_empty(), "{:?}", context.warnings);
    scene
}

/// The picture of a scene by an integrator.
fn picture(mut scene: Scene, integrator: Integrator, samples: u32) -> Vec<[f64; 3]> {
    (scene.render.integrator, scene.render.samples) = (integrator, samples);
    let film = Compiled::new(scene).film();
    let pixels = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| [x, y]));
    pixels.map(|[x, y]| film.mean(x, y).map(f64::from)).collect()
}

/// Whether the blurred picture is the mean of instants: that of all its pixels within a part, and that of each within another.
fn is_the_mean_of_instants(integrator: Integrator, [of_all, of_each]: [f64; 2]) {
    const INSTANTS: u32 = 48;
    const SAMPLES: u32 = 256;
    let blurred = picture(scene(0.0, 1.0), integrator, INSTANTS * SAMPLES);
    let mut mean = vec![[0.0; 3]; blurred.len()];
    for instant in 0..INSTANTS {
        let at = (f64::from(instant) + 0.5) / f64::from(INSTANTS);
        let still = scene(at, 0.0);
        assert!(still.instances.is_empty() && still.camera.as_ref().is_some_and(|it| it.motion.is_none()));
        for (sum, pixel) in mean.iter_mut().zip(picture(still, integrator, SAMPLES)) {
            (0..3).for_each(|c| sum[c] += pixel[c] / f64::from(INSTANTS));
        }
    }
    let total = |picture: &[[f64; 3]]| picture.iter().flatten().sum::<f64>();
    let off = total(&blurred) / total(&mean) - 1.0;
    let level = total(&mean) / mean.len() as f64 / 3.0;
    let each = blurred.iter().flatten().zip(mean.iter().flatten());
    let worst = each.map(|(a, b)| (a - b).abs() / (b + level)).fold(0.0, f64::max);
    println!("{integrator:?}: all {off:+.5}, worst {worst:.4}");
    assert!(off.abs() < of_all && worst < of_each, "{integrator:?}: {off:+.5}, {worst:.4}");
    // It is none of the instants.
    let still = picture(scene(0.5, 0.0), integrator, SAMPLES);
    let differs = still.iter().flatten().zip(blurred.iter().flatten());
    assert!(differs.map(|(a, b)| (a - b).abs() / (b + level)).fold(0.0, f64::max) > 3.0 * of_each);
}

#[test]
fn paths_see_the_mean_of_instants() {
    is_the_mean_of_instants(Integrator::Path, [0.008, 0.08]);
}

#[test]
fn direct_views_see_the_mean_of_instants() {
    is_the_mean_of_instants(Integrator::Normals, [0.004, 0.06]);
}

#[test]
fn what_moves_is_in_objects() {
    let scene = scene(0.0, 1.0);
    scene.validate().expect("a valid scene");
    assert_eq!((scene.shapes.len(), scene.instances.len()), (1, 5));
    let deforming = scene.meshes.iter().filter(|mesh| !mesh.later.is_empty()).count();
    let moving = scene.instances.iter().filter(|instance| instance.motion.is_some()).count();
    assert_eq!((deforming, moving), (1, 4));
    let bounds = scene.bounds();
    assert!(bounds.max.x >= 1.4 && bounds.max.y >= 2.3, "{bounds:?}");
}

#[test]
fn samples_do_not_depend_on_others_and_are_told_as_they_are() {
    for (integrator, color) in [Integrator::Path, Integrator::Whitted]
        .into_iter()
        .flat_map(|it| [(it, ColorMode::Rgb), (it, ColorMode::Spectral)])
    {
        let mut scene = scene(0.0, 1.0);
        (scene.render.integrator, scene.render.color) = (integrator, color);
        let renderer = Compiled::new(scene).renderer();
        let [width, height] = SIZE;
        let mut tile = FilmTile::new(PixelBounds { x0: 0, y0: 0, x1: width, y1: height }).expect("a tile");
        renderer.render_tile(5..6, &mut tile).expect("an empty tile");
        let mut film = Film::new(width, height, None).expect("a film");
        film.add_tile(&tile).expect("of this film");
        for [x, y] in (0..height).flat_map(|y| (0..width).map(move |x| [x, y])) {
            let inspection = inspect(&renderer, SampleId { pixel: [x, y], sample: 5 });
            assert_eq!(film.mean(x, y), inspection.film, "{integrator:?} {color:?} at {x} {y}");
            assert!(inspection.adds_up, "{integrator:?} {color:?} at {x} {y}");
        }
    }
}

/// The mean motion of what is seen in a pixel of a picture of 16 × 16 pixels, 4 units high, around the origin; what is `moving` is red.
fn motion_seen(moving: &str, camera: &str, [x, y]: [u32; 2]) -> [f32; 2] {
    let text = format!(
        "[camera]\n{camera}\nprojection = \"orthographic\"\nheight = 4\n\
         [image]\nwidth = 16\nheight = 16\nlayers = \"motion\"\n[render]\nsamples = 16\n\
         [materials.red]\ndiffuse = [1, 0, 0]\n{moving}\n"
    );
    let name = PathBuf::from("moving.toml");
    let files = Memory([(name.clone(), text.into_bytes())].into());
    let mut context = LoadContext::new(&files);
    (context.import.at, context.import.shutter, context.variables.fps) = (Some(0.0), Some(0.5), 1.0);
    let scene = load::scene(&name, &mut context).unwrap_or_else(|error| panic!("{error}"));
    let film = Compiled::new(scene).film();
    assert!(film.has_motion() && film.has_layers());
    film.motion(x, y).expect("motion vectors")
}

#[test]
fn motion_vectors_tell_pixels_from_the_opening_to_the_closing() {
    let still = "lookfrom = [0, 0, 5]\nlookat = [0, 0, 0]";
    let near = |found: [f32; 2], expected: [f32; 2]| {
        let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off < 0.01, "{found:?}, expected {expected:?}");
    };
    // A ball that rises by two units in a second, for half of one: four of sixteen pixels.
    let ball = "[[sphere]]\ncenter = [0, \"= 2 * t - 0.5\", 0]\nradius = 1\nmaterial = \"red\"";
    near(motion_seen(ball, still, [8, 7]), [0.0, 4.0]);
    // A quad that grows from two to three units: a point at a part of its width moves by as many units. In pixel 8 that is 1.125 / (2 + t).
    let quad = "[[quad]]\ncorner = [-1, -1, 0]\nedge_u = [\"= 2 + 2 * t\", 0, 0]\nedge_v = [0, 2, 0]\nmaterial = \"red\"";
    let [x, y] = motion_seen(quad, still, [8, 8]);
    assert!((x - 4.5 * 1.5_f32.ln()).abs() < 0.1 && y.abs() < 1e-5, "{x} {y}");
    // A camera that goes to the left by one unit in a second: all is two pixels further to the right.
    let wall = "[[quad]]\ncorner = [-4, -4, 0]\nedge_u = [8, 0, 0]\nedge_v = [0, 8, 0]\nmaterial = \"red\"";
    let camera = "lookfrom = [\"= -t\", 0, 5]\nlookat = [\"= -t\", 0, 0]";
    near(motion_seen(wall, camera, [3, 12]), [2.0, 0.0]);
    // What the camera follows stands still.
    let followed = "[[sphere]]\ncenter = [\"= -t\", 0, 0]\nradius = 1\nmaterial = \"red\"";
    near(motion_seen(followed, camera, [8, 8]), [0.0, 0.0]);
    // Nothing is seen.
    near(motion_seen(ball, still, [0, 15]), [0.0, 0.0]);
    // A quad that turns by a quarter: chords of √2 times the distance 1.132 from the middle, in directions of 45° to both sides of the
    // tangent there, which is 6.3° off the vertical.
    let turning = "[[quad]]\ncorner = [-2, -2, 0]\nedge_u = [4, 0, 0]\nedge_v = [0, 4, 0]\nmaterial = \"red\"\n\
                   transform = [{ rotate = { axis = [0, 0, 1], angle = \"= 180 * t\" } }]";
    let [x, y] = motion_seen(turning, still, [12, 7]);
    assert!((x + 0.63).abs() < 0.3 && (y - 5.73).abs() < 0.3, "{x} {y}");
}
