//! Panes: light behind thin dielectrics is found by sampling lights, and counted once.

use crate::support::{Compiled, scene};
use lookfrom::film::Film;
use lookfrom_scene::settings::LightPathLayer;
use lookfrom_scene::{Location, Scene};

const ETA: f64 = 1.5;

/// A scene without light, whose camera looks at a white floor from above, with a wide pane over both.
fn under_a_pane(depth: u32, passages_count: bool, light: &str) -> Scene {
    scene(&format!(
        r#"
        [image]
        width = 8
        height = 8
        [render]
        integrator = "path"
        samples = 256
        depth = {depth}
        thin_passages_count = {passages_count}
        [camera]
        lookfrom = [0, 0.5, 0]
        lookat = [0, 0, 0]
        up = [0, 0, 1]
        fov = 20
        [materials.white]
        type = "diffuse"
        reflectance = 1
        [materials.glass]
        type = "thin_dielectric"
        ior = {ETA}
        [materials.black]
        type = "diffuse"
        reflectance = 0
        [[quad]]
        corner = [-1, 0, 1]
        edge_u = [2, 0, 0]
        edge_v = [0, 0, -2]
        material = "white"
        [[quad]]
        corner = [-9, 1, 9]
        edge_u = [18, 0, 0]
        edge_v = [0, 0, -18]
        material = "glass"
        {light}
        "#
    ))
}

const LAMP: &str = r#"
    [[sphere]]
    center = [0.5, 2, 0.3]
    radius = 0.05
    material = "black"
    emission = 100
"#;
const POINT: &str = r#"
    [[light]]
    type = "point"
    position = [0, 3, 0]
    intensity = 9
"#;

fn mean(film: &Film) -> f64 {
    let pixels = film.picture().pixels;
    pixels.iter().map(|rgb| f64::from(rgb[1])).sum::<f64>() / pixels.len() as f64
}

/// The mean of the picture.
fn measured(scene: Scene) -> f64 {
    mean(&Compiled::new(scene).film())
}

#[test]
fn white_bodies_under_glass_vanish_in_even_light() {
    // A pane reflects what it does not transmit: everything is as bright as the sky.
    for passages_count in [true, false] {
        let text = format!(
            r#"
            [image]
            width = 12
            height = 12
            [render]
            integrator = "path"
            samples = 256
            depth = 60
            thin_passages_count = {passages_count}
            [camera]
            lookfrom = [0, 0, 5]
            lookat = [0, 0, 0]
            fov = 30
            [materials.white]
            type = "diffuse"
            reflectance = 1
            [materials.glass]
            type = "thin_dielectric"
            ior = 1.8
            [[sphere]]
            radius = 0.5
            material = "white"
            [[sphere]]
            radius = 1
            material = "glass"
            [[box]]
            min = [-1.5, -1.5, -1.5]
            max = [1.5, 1.5, 1.5]
            material = "glass"
            [[light]]
            type = "environment"
            color = 1
            "#
        );
        let found = measured(scene(&text));
        assert!((found - 1.0).abs() < 0.004, "{passages_count}: {found}");
    }
}

#[test]
fn panes_count_as_surfaces_or_not() {
    // Where they count, a lamp behind one is lit by the second bounce, as it is by the first where they do not.
    let at_once = measured(under_a_pane(1, false, LAMP));
    let after_one = measured(under_a_pane(2, true, LAMP));
    assert!(at_once > 0.01 && (after_one / at_once - 1.0).abs() < 0.01, "{after_one} {at_once}");
    assert_eq!(measured(under_a_pane(1, true, LAMP)), 0.0);
}

#[test]
fn panes_pass_what_fresnels_equations_leave() {
    // The irradiance of the lamp at the middle of the floor, as that of a point.
    let (lamp, radius) = ([0.5, 2.0, 0.3_f64], 0.05_f64);
    let squared: f64 = lamp.iter().map(|x| x * x).sum();
    let cos = lamp[1] / squared.sqrt();
    let flux = 100.0 * std::f64::consts::PI * radius * radius;
    let expected = transmittance(cos) * flux * cos / squared / std::f64::consts::PI;
    let found = measured(under_a_pane(1, false, LAMP));
    assert!((found / expected - 1.0).abs() < 0.01, "{found}, not {expected}");
}

/// Unpolarised light through both faces of a sheet, with all reflections in it, by Fresnel's equations.
fn transmittance(cos: f64) -> f64 {
    let sin_t = (1.0 - cos * cos).sqrt() / ETA;
    let cos_t = (1.0 - sin_t * sin_t).sqrt();
    let [s, p] = [(cos - ETA * cos_t) / (cos + ETA * cos_t), (ETA * cos - cos_t) / (ETA * cos + cos_t)];
    let once = 0.5 * (s * s + p * p);
    (1.0 - once) / (1.0 + once)
}

#[test]
fn lights_without_size_shine_through_panes_that_are_no_surfaces() {
    // Paths cannot find them: in pbrt they are dark behind glass.
    assert_eq!(measured(under_a_pane(5, true, POINT)), 0.0);
    let found = measured(under_a_pane(1, false, POINT));
    // Intensities are Whitted's: of the reflectance without 1/π.
    let expected = transmittance(1.0);
    assert!((found / expected - 1.0).abs() < 0.01, "{found}, not {expected}");
}

#[test]
fn layers_of_light_paths_know_of_panes() {
    let layer = |(name, expression): (&str, &str)| LightPathLayer {
        name: name.into(),
        expression: expression.into(),
        at: Location::default(),
    };
    let mut scene = under_a_pane(1, false, LAMP);
    scene.image.light_paths = [("behind", "CD<TS>L"), ("before", "CDL")].map(layer).to_vec();
    let film = Compiled::new(scene).film();
    let total = |index: usize| -> f64 {
        let all = (0..8).flat_map(|y| (0..8).map(move |x| (x, y)));
        all.map(|(x, y)| f64::from(film.light_paths(x, y).nth(index).unwrap()[1])).sum()
    };
    assert!((total(0) / 64.0 / mean(&film) - 1.0).abs() < 1e-3, "{} {}", total(0), mean(&film));
    assert_eq!(total(1), 0.0);
}

#[test]
fn panes_have_their_colour_in_whitteds_model() {
    // A white wall that shines, seen straight on through a pane: 1 − 2R / (1 + R) of its light, by R = ((η − 1) / (η + 1))².
    let text = format!(
        r#"
        [image]
        width = 4
        height = 4
        [render]
        integrator = "whitted"
        samples = 4
        [camera]
        lookfrom = [0, 0, 5]
        lookat = [0, 0, 0]
        fov = 1
        [materials.glass]
        type = "thin_dielectric"
        ior = {ETA}
        specular_transmittance = [0.5, 1, 0.25]
        [materials.wall]
        diffuse = 0
        emission = 1
        [[quad]]
        corner = [-1, -1, 0]
        edge_u = [2, 0, 0]
        edge_v = [0, 2, 0]
        material = "wall"
        [[quad]]
        corner = [-9, -9, 1]
        edge_u = [18, 0, 0]
        edge_v = [0, 18, 0]
        material = "glass"
        "#
    );
    let once = ((ETA - 1.0) / (ETA + 1.0)).powi(2);
    let through = 1.0 - 2.0 * once / (1.0 + once);
    let picture = Compiled::new(scene(&text)).film().picture();
    let [r, g, b] = picture.pixels[5].map(f64::from);
    for (found, expected) in [(r, 0.5), (g, 1.0), (b, 0.25)] {
        assert!((found - expected * through).abs() < 1e-3, "{found} {}", expected * through);
    }
}
