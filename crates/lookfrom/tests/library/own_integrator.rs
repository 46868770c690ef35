//! The integrator of the example, beside the built-in one that computes the same light.

#[allow(dead_code)]
#[path = "../../examples/integrator.rs"]
mod example;

use lookfrom::film::Picture;
use lookfrom::scene::settings::{Background, Layers};
use lookfrom::session::{Options, Session};

use crate::support;

/// A sphere with holes on a floor, lit by a lamp whose light passes the holes.
const SCENE: &str = r##"
    [camera]
    lookfrom = [0, 2, 6]
    lookat = [0, 0.8, 0]
    fov = 40
    [image]
    width = 24
    height = 16
    [render]
    integrator = "simple_path"
    depth = 1
    samples = 4
    [textures.holes]
    type = "checker"
    even = 0
    odd = 1
    scale = 8
    [materials.red]
    type = "diffuse"
    reflectance = [0.7, 0.3, 0.2]
    [materials.gray]
    type = "diffuse"
    reflectance = 0.5
    [[sphere]]
    center = [0, 1, 0]
    radius = 1
    material = "red"
    alpha = "holes"
    [[quad]]
    corner = [-4, 0, 4]
    edge_u = [8, 0, 0]
    edge_v = [0, 0, -8]
    material = "gray"
    [[light]]
    type = "point"
    position = [2, 4, 3]
    intensity = 20
"##;

fn session(integrator: bool) -> Session {
    let mut scene = support::scene(SCENE);
    scene.image.layers = Layers::Geometry;
    scene.image.background = Background::Transparent;
    let mut session = Session::of_scene(scene, &Options::default()).expect("a scene");
    if integrator {
        session.set_integrator(example::DirectLighting);
    }
    session
}

#[test]
fn the_integrator_of_the_example_computes_what_paths_of_one_bounce_do() {
    let [own, built_in] = [true, false].map(|own| session(own).render(&()).expect("a picture"));
    let Picture { pixels, alpha, .. } = &own.picture;
    let most = |rgb: &[f32; 3]| rgb.iter().fold(0.0_f32, |most, c| most.max(*c));
    assert!(pixels.iter().any(|rgb| most(rgb) > 0.1), "it is dark");
    for (a, b) in pixels.iter().zip(&built_in.picture.pixels) {
        assert!(support::close(*a, *b, 1e-5 * (1.0 + most(b))), "{a:?} {b:?}");
    }
    assert_eq!(alpha, &built_in.picture.alpha);
    let [own, built_in] = [&own, &built_in].map(|finished| &finished.rendered.film);
    for (x, y) in (0..16).flat_map(|y| (0..24).map(move |x| (x, y))) {
        assert_eq!(own.aovs(x, y), built_in.aovs(x, y), "AOVs of {x},{y}");
    }
}
