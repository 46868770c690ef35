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
