//! Layers of light-path expressions: they add up to the picture, whose own bits stay the same.

use crate::support::{Compiled, own_scene, scene};
use lookfrom::film::Film;
use lookfrom_scene::settings::{ColorMode, FilterShape, LightPathLayer};
use lookfrom_scene::{Location, Scene};

/// Ways that have no light in common, and together all: seen at once, and by what the first surface did.
const ALL: [(&str, &str); 4] =
    [("seen", "C[LBOA]"), ("diffuse", "CD.*"), ("glossy", "CG.*"), ("specular", "CS.*")];

pub(crate) fn layer((name, expression): (&str, &str)) -> LightPathLayer {
    LightPathLayer { name: name.into(), expression: expression.into(), at: Location::default() }
}

fn film_of(mut scene: Scene, layers: &[(&str, &str)]) -> Film {
    scene.image.light_paths = layers.iter().copied().map(layer).collect();
    Compiled::new(scene).film()
}

fn pixels(film: &Film) -> impl Iterator<Item = (u32, u32)> {
    let (width, height) = (film.width(), film.height());
    (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
}

/// The sum of a layer over all pixels and channels.
fn total(film: &Film, layer: usize) -> f64 {
    let rgb = pixels(film).filter_map(|(x, y)| film.light_paths(x, y).nth(layer));
    rgb.flatten().map(f64::from).sum()
}

#[test]
fn layers_add_up_to_a_picture_whose_bits_they_do_not_change() {
    let spectral = |mut scene: Scene| {
        scene.render.color = ColorMode::Spectral;
        scene.image.filter = FilterShape::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 }.of_radius(2.0);
        scene
    };
    let limited = |mut scene: Scene| {
        scene.image.sensor.max_component = 0.5;
        scene
    };
    for (name, mut scene) in [
        ("cornell", own_scene("cornell.toml")),
        ("materials", own_scene("materials.toml")),
        ("spectral", spectral(own_scene("materials.toml"))),
        ("limited", limited(own_scene("cornell.toml"))),
        ("whitted", own_scene("whitted1980.toml")),
        ("raycast", own_scene("soft-shadows.toml")),
        ("cutouts", own_scene("cutouts.toml")),
        ("fisheye", own_scene("../docs/guide/scenes/camera-fisheye.toml")),
        ("lens system", own_scene("../docs/guide/scenes/camera-lens-system.toml")),
    ] {
        (scene.image.width, scene.image.height, scene.image.crop) = (40, 30, None);
        scene.render.samples = 4;
        let plain = film_of(scene.clone(), &[]);
        let film = film_of(scene, &ALL);
        let mut totals = [0.0_f64; 4];
        for (x, y) in pixels(&film) {
            let mean = film.mean(x, y);
            assert_eq!(mean.map(f32::to_bits), plain.mean(x, y).map(f32::to_bits), "{name}: {x} {y}");
            let layers: Vec<[f32; 3]> = film.light_paths(x, y).collect();
            for channel in 0..3 {
                let parts = layers.iter().map(|rgb| rgb[channel]);
                // Of each sum of floats the order differs; parts may cancel.
                let size: f32 = parts.clone().map(f32::abs).sum();
                let sum: f32 = parts.sum();
                assert!(
                    (sum - mean[channel]).abs() <= 2e-5 * (size + 1e-3),
                    "{name}: {x} {y} {layers:?} {mean:?}"
                );
            }
            totals.iter_mut().zip(&layers).for_each(|(total, rgb)| *total += f64::from(rgb[1]));
        }
        let lit = totals.iter().filter(|total| **total > 0.0).count();
        assert!(lit >= 2, "{name}: {totals:?}");
    }
}

/// A plate under a lamp.
fn plate(integrator: &str, material: &str) -> Scene {
    plate_and_lamp(integrator, material, 3.0)
}

/// A plate, and a lamp at a height over it.
fn plate_and_lamp(integrator: &str, material: &str, height: f64) -> Scene {
    scene(&format!(
        r#"
        [camera]
        lookfrom = [0, 2, 4]
        lookat = [0, 0, 0]
        [image]
        width = 16
        height = 12
        [render]
        integrator = "{integrator}"
        samples = 8
        depth = 3
        [materials.plate]
        {material}
        [[quad]]
        corner = [-2, 0, 2]
        edge_u = [4, 0, 0]
        edge_v = [0, 0, -4]
        material = "plate"
        [[light]]
        type = "point"
        position = [0.5, {height}, -2]
        intensity = 9
        "#
    ))
}

#[test]
fn highlights_are_glossy_and_what_is_below_them_diffuse() {
    const MATERIAL: &str = "type = \"whitted\"\nambient = 0\nshininess = 20\n";
    for integrator in ["whitted", "path"] {
        let of = |diffuse: f32, specular: f32| {
            let material = format!("{MATERIAL}diffuse = {diffuse}\nspecular = {specular}");
            film_of(plate(integrator, &material), &[("d", "CDL"), ("g", "CGL")])
        };
        let (both, diffuse, specular) = (of(0.6, 0.4), of(0.6, 0.0), of(0.0, 0.4));
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-5 * (a.abs() + b.abs());
        assert!(total(&diffuse, 0) > 1.0 && total(&specular, 1) > 1.0);
        assert!(near(total(&both, 0), total(&diffuse, 0)), "{integrator}");
        assert!(near(total(&both, 1), total(&specular, 1)), "{integrator}");
        assert_eq!((total(&diffuse, 1), total(&specular, 0)), (0.0, 0.0), "{integrator}");
    }
}

#[test]
fn lobes_of_layered_materials_are_told_apart() {
    let shares = |material: &str| {
        let film = film_of(plate("path", material), &[("d", "CDL"), ("g", "CGL"), ("all", "C.L")]);
        let all = total(&film, 2);
        assert!(all > 0.1, "{material}: {all}");
        [total(&film, 0) / all, total(&film, 1) / all]
    };
    let [diffuse, glossy] = shares("type = \"diffuse\"\nreflectance = 0.5");
    assert_eq!([diffuse, glossy], [1.0, 0.0]);
    let [diffuse, glossy] = shares("type = \"conductor\"\nmetal = \"gold\"\nroughness = 0.5");
    assert_eq!([diffuse, glossy], [0.0, 1.0]);
    let rough = "roughness = 0.5\nbase_color = 0.5";
    let [_, metal] = shares(&format!("type = \"principled\"\nmetallic = 1\n{rough}"));
    assert!(metal > 0.999, "{metal}");
    let [plain, _] = shares(&format!("type = \"principled\"\n{rough}"));
    let [coated, _] =
        shares(&format!("type = \"principled\"\nclearcoat = 1\nclearcoat_roughness = 0.4\n{rough}"));
    assert!(0.5 < coated && coated < plain && plain < 0.99, "{coated} {plain}");
    let [_, coat] = shares("type = \"coated_diffuse\"\nreflectance = 0.5\nroughness = 0.4");
    assert!(0.01 < coat && coat < 0.5, "{coat}");
}

/// The mean of values, and its standard error.
fn estimate(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (squares / (count - 1.0) / count).sqrt())
}

#[test]
fn lights_are_told_apart_by_their_names() {
    let scene = |lamps: &[&str], seed: u32| {
        let mut text = format!(
            "[camera]\nlookfrom = [0, 2, 4]\nlookat = [0, 0, 0]\n[image]\nwidth = 8\nheight = 6\n\
             [render]\nintegrator = \"path\"\nsamples = 16\nseed = {seed}\n\
             [[plane]]\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\n",
        );
        for (lamp, x, power) in [("left", -1, 1), ("right", 1, 2)] {
            if lamps.contains(&lamp) {
                text += &format!(
                    "[[light]]\ntype = \"point\"\nname = \"{lamp}\"\nposition = [{x}, 3, 0]\nintensity = {power}\n"
                );
            }
        }
        scene(&text)
    };
    let layers = [("left", "C.*<L.'left'>"), ("right", "C.*<L.'right'>")];
    let (mut alone, mut left, mut right) = (Vec::new(), Vec::new(), Vec::new());
    for seed in 0..16 {
        let both = film_of(scene(&["left", "right"], seed), &layers);
        let sum: f64 = pixels(&both).flat_map(|(x, y)| both.mean(x, y)).map(f64::from).sum();
        left.push(total(&both, 0));
        right.push(total(&both, 1));
        assert!((left[seed as usize] + right[seed as usize] - sum).abs() < 1e-5 * sum);
        alone.push(total(&film_of(scene(&["left"], seed), &layers[..1]), 0));
    }
    // Two lamps are sampled in turn: the same light, with other noise. The picture of one is the other's mirrored.
    for (values, expected) in [(&left, 1.0), (&right, 2.0)] {
        let ratios: Vec<f64> = values.iter().zip(&alone).map(|(value, alone)| value / alone).collect();
        let (mean, error) = estimate(&ratios);
        assert!((mean - expected).abs() < 3.0 * error && error < 0.01 * expected, "{mean} ± {error}");
    }
}

/// What a medium scatters last before the camera is apart from all that surfaces do.
#[test]
fn media_have_a_letter() {
    let fog = || {
        scene(
            r#"
            camera = { lookfrom = [0, 0.5, 4], lookat = [0, 0.5, 0], medium = "fog" }
            image = { width = 16, height = 12 }
            render = { samples = 16, depth = 5 }
            sphere = [{ center = [0, 0.5, 0], radius = 0.5, material = "clay" }]
            light = [{ type = "sphere", center = [1, 2, 1], radius = 0.2, radiance = 20 }]
            [media.fog]
            scattering = 0.2
            [materials.clay]
            type = "diffuse"
            "#,
        )
    };
    let film = film_of(
        fog(),
        &[("all", "C.*"), ("fog", "CV.*"), ("clay", "CD.*"), ("seen", "CL"), ("later", "CD+V.*")],
    );
    let [all, fog_light, clay, seen, later] = [0, 1, 2, 3, 4].map(|layer| total(&film, layer));
    assert!(fog_light > 0.0 && clay > 0.0 && later > 0.0 && later < clay, "{fog_light} {clay} {later}");
    assert!((fog_light + clay + seen - all).abs() < 1e-4 * all, "{fog_light} {clay} {seen} {all}");
    let mut clear = fog();
    clear.camera.as_mut().expect("a camera").medium = None;
    assert_eq!(total(&film_of(clear, &[("fog", "C.*V.*")]), 0), 0.0);
}

/// Light from a lamp before or behind a sheet that lets light through, at a hit that is shaded with others.
#[test]
fn lamps_behind_a_surface_are_seen_by_transmission() {
    const LEAF: &str = "type = \"diffuse_transmission\"\nreflectance = 0.3\ntransmittance = 0.4";
    for (material, lobe) in [
        (LEAF, 'D'),
        ("type = \"dielectric\"\nroughness = 0.5", 'G'),
        ("type = \"dielectric\"\nroughness = 0.3", 'G'),
    ] {
        for (height, transmitted) in [(-3.0, true), (3.0, false)] {
            let scene = plate_and_lamp("path", material, height);
            let ways = [format!("C<T{lobe}>L"), format!("C<R{lobe}>L")];
            let film = film_of(scene, &[("behind", &ways[0]), ("before", &ways[1])]);
            let [behind, before] = [0, 1].map(|layer| total(&film, layer));
            let (there, not_there) = if transmitted { (behind, before) } else { (before, behind) };
            assert!(there > 1.0 && not_there == 0.0, "{material}, {height}: {behind} {before}");
        }
    }
}
