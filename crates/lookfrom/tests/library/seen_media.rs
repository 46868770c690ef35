//! Media in alpha, in layers and in the features of the denoiser.

use crate::support::{Compiled, scene};
use lookfrom::film::Film;
use lookfrom::inspect::inspect;
use lookfrom::render::SampleId;
use lookfrom_scene::material::MaterialKind;
use lookfrom_scene::settings::{Background, ColorMode, Integrator, LightPathLayer};
use lookfrom_scene::{Location, Scene};

/// A ball filled with a medium before the camera, through which its rays have a way of 2, under a sky of 1.
fn ball(medium: &str, more: &str) -> Scene {
    let mut scene = scene(&format!(
        r#"
        camera = {{ lookfrom = [0, 0, 0], lookat = [0, 0, 1], fov = 0.5 }}
        image = {{ width = 2, height = 2 }}
        render = {{ samples = 4096, depth = 64 }}
        light = [{{ type = "environment", color = 1 }}]
        [[sphere]]
        center = [0, 0, 3]
        medium = "m"
        [media.m]
        {medium}
        {more}
        "#
    ));
    for material in scene.materials.iter_mut().filter(|material| material.name == "floor") {
        material.kind = MaterialKind::ShadowCatcher { normal: glam::Vec3::NEG_Z };
    }
    scene
}

/// What a way of 2 lets pass.
fn passed(sigma: f64) -> f64 {
    (-2.0 * sigma).exp()
}

/// A floor far behind the ball, which does not shade it: a shadow catcher.
const CATCHER: &str = r#"
    [materials.floor]
    type = "diffuse"
    [[plane]]
    point = [0, 0, 900]
    normal = [0, 0, -1]
    material = "floor"
"#;

const VARYING: &str = r#"scattering = 3
    density = { formula = "0.5 * (z - 2)", min = [-1, -1, 2], max = [1, 1, 4], cells = 32 }"#;

/// The mean of a number of each pixel.
fn mean(of: impl Fn(u32, u32) -> f32) -> f64 {
    [(0, 0), (1, 0), (0, 1), (1, 1)].into_iter().map(|(x, y)| f64::from(of(x, y)) / 4.0).sum()
}

fn mean_alpha(film: &Film) -> f64 {
    film.picture().alpha.into_iter().map(f64::from).sum::<f64>() / 4.0
}

fn assert_near(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found - expected).abs() <= tolerance, "{what}: {found}, expected {expected}");
}

/// Alpha of the ball on a transparent background.
fn alpha(medium: &str, more: &str, color: ColorMode) -> f64 {
    let mut scene = ball(medium, more);
    scene.image.background = Background::Transparent;
    scene.render.color = color;
    let film = Compiled::new(scene).film();
    mean_alpha(&film)
}

#[test]
fn alpha_is_what_media_do_not_let_pass() {
    for (medium, sigma) in [
        ("absorption = [0.7, 0.2, 0]", [0.7, 0.2, 0.0]),
        ("scattering = [0.7, 0.2, 0]\nabsorption = 0.1", [0.8, 0.3, 0.1]),
    ] {
        let [r, g, b] = sigma.map(passed);
        assert_near(alpha(medium, "", ColorMode::Rgb), 1.0 - (r + g + b) / 3.0, 0.01, medium);
        // What is seen of a catcher is a luminance.
        let luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        assert_near(alpha(medium, CATCHER, ColorMode::Rgb), 1.0 - luminance, 0.01, medium);
    }
    for color in [ColorMode::Rgb, ColorMode::Spectral] {
        assert_near(alpha(VARYING, "", color), 1.0 - passed(1.5), 0.01, "varying");
        assert_near(alpha(VARYING, CATCHER, color), 1.0 - passed(1.5), 0.02, "varying, before a catcher");
    }
}

#[test]
fn light_of_media_stays_before_any_background() {
    let medium = "absorption = 0.3\nemission = 2";
    let expected = 2.0 * (1.0 - passed(0.3));
    for more in ["", CATCHER] {
        let mut scene = ball(medium, more);
        scene.image.background = Background::Transparent;
        let film = Compiled::new(scene).film();
        assert_near(mean(|x, y| film.mean(x, y)[1]), expected, 0.01, more);
        let alpha = mean_alpha(&film);
        assert_near(alpha, 1.0 - passed(0.3), 0.01, more);
    }
}

#[test]
fn layers_tell_what_media_let_pass_and_what_they_scatter() {
    let wall = r#"
        [materials.wall]
        type = "diffuse"
        reflectance = 0.5
        [[plane]]
        point = [0, 0, 9]
        normal = [0, 0, -1]
        material = "wall"
    "#;
    let colored = "scattering = [0.7, 0.2, 0]\nabsorption = 0.1";
    for (medium, more, expected) in [
        (colored, "", [0.8, 0.3, 0.1].map(passed)),
        (colored, wall, [0.8, 0.3, 0.1].map(passed)),
        ("absorption = [0.7, 0.2, 0]", wall, [0.7, 0.2, 0.0].map(passed)),
        (VARYING, wall, [passed(1.5); 3]),
    ] {
        let mut scene = ball(medium, more);
        let layers =
            [("T", "transmittance"), ("short", "volume"), ("long", "CV.*"), ("rest", "C[^V].*|C[LBO]")];
        scene.image.light_paths = layers
            .map(|(name, expression)| LightPathLayer {
                name: name.into(),
                expression: expression.into(),
                at: Location::default(),
            })
            .into();
        let film = Compiled::new(scene).film();
        for (k, expected) in expected.into_iter().enumerate() {
            let layer = |index: usize| mean(|x, y| film.light_paths(x, y).nth(index).expect("a layer")[k]);
            assert_near(layer(0), expected, 0.01, &format!("{medium}, {more}"));
            assert_eq!(layer(1), layer(2));
            assert_near(layer(1) + layer(3), mean(|x, y| film.mean(x, y)[k]), 1e-4, medium);
        }
        let volume = mean(|x, y| film.light_paths(x, y).nth(1).expect("a layer")[0]);
        assert_eq!(volume > 0.0, medium.contains("scattering"), "{medium}");
    }
}

#[test]
fn features_have_no_noise_of_flights() {
    let wall = r#"
        [materials.wall]
        type = "diffuse"
        reflectance = [0.5, 0.2, 0.1]
        [[plane]]
        point = [0, 0, 9]
        normal = [0, 0, -1]
        material = "wall"
    "#;
    let fog = "scattering = 0.3\nabsorption = 0.1";
    let covered = 1.0 - passed(0.4);
    for (medium, more, albedo, depth) in [
        (fog, "", covered * 0.75 + passed(0.4), None),
        (fog, wall, covered * 0.75 + passed(0.4) * 0.5, None),
        ("scattering = 3", wall, 1.0 - passed(3.0) * 0.5, Some(2.0 + 2.0_f64.ln() / 3.0)),
        (VARYING, wall, 1.0 - passed(1.5) * 0.5, None),
        ("scattering = 0.05", wall, 1.0 - passed(0.05) * 0.5, Some(9.0)),
    ] {
        let mut scene = ball(medium, more);
        (scene.render.samples, scene.image.denoise) = (16, true);
        let film = Compiled::new(scene).film();
        for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let features = film.denoiser_features(x, y).expect("features");
            assert_near(f64::from(features.aovs.albedo[0]), albedo, 0.02, &format!("{medium}, {more}"));
            assert_eq!(features.coverage, 1.0);
            if let Some(depth) = depth {
                assert_near(f64::from(features.aovs.position[2]), depth, 0.02, medium);
            }
        }
    }
}

#[test]
fn fog_without_an_end_is_a_feature_before_nothing() {
    let mut scene = scene(
        r#"
        camera = { lookfrom = [0, 0, 0], lookat = [0, 0, 1], fov = 0.5, medium = "m" }
        image = { width = 2, height = 2, denoise = true }
        render = { samples = 16 }
        light = [{ type = "environment", color = 1 }]
        [[sphere]]
        center = [0, 50, 3]
        [media.m]
        scattering = [0.3, 0.1, 0.2]
        absorption = [0.1, 0.1, 0]
        "#,
    );
    let features =
        |scene: &Scene| Compiled::new(scene.clone()).film().denoiser_features(0, 0).expect("features");
    let found = features(&scene);
    assert_eq!(found.coverage, 1.0);
    assert_near(found.aovs.ns[2].into(), -1.0, 1e-3, "it faces the camera");
    for (albedo, expected) in found.aovs.albedo.into_iter().zip([0.75, 0.5, 1.0]) {
        assert_near(albedo.into(), expected, 1e-3, "albedo");
    }
    // The mean extinction is 0.8 / 3.
    assert_near(found.aovs.position[2].into(), 3.0 * 2.0_f64.ln() / 0.8, 1e-3, "depth");
    // Without flights there is nothing to be seen.
    scene.render.integrator = Integrator::Normals;
    assert_eq!(features(&scene).coverage, 0.0);
}

#[test]
fn droplets_that_absorb_nothing_are_unseen_in_a_furnace() {
    for diameter in ["0.3", "2", "20"] {
        for density in ["0.5", "4"] {
            let mut scene = ball(&format!("scattering = {density}\ndroplets = {diameter}"), "");
            (scene.render.samples, scene.render.depth) = (256, 10_000);
            let film = Compiled::new(scene).film();
            let light = mean(|x, y| film.mean(x, y).into_iter().sum::<f32>() / 3.0);
            assert_near(light, 1.0, 1e-3, &format!("{diameter}, {density}"));
        }
    }
}

#[test]
fn lobes_of_droplets_are_told() {
    let mut scene = ball("scattering = 4\ndroplets = 12", "");
    scene.render.samples = 64;
    let renderer = Compiled::new(scene).renderer();
    let (mut ahead, mut back) = (0, 0);
    for sample in 0..64 {
        let inspection = inspect(&renderer, SampleId { pixel: [0, 0], sample });
        assert!(inspection.adds_up);
        for (ray, phase) in inspection.rays.iter().filter_map(|ray| Some((ray, ray.phase.as_ref()?))) {
            let mixed: f32 = phase.lobes.iter().map(|lobe| lobe.weight * lobe.value).sum();
            assert!((mixed / phase.pdf - 1.0).abs() < 1e-4, "{phase:?}");
            let cos = glam::Vec3::from(ray.direction).normalize().dot(phase.wi.into());
            assert!((cos - phase.cos).abs() < 1e-6);
            assert_eq!(phase.lobes.iter().filter(|lobe| lobe.is_sampled).count(), 1);
            *if phase.lobes[0].is_sampled { &mut ahead } else { &mut back } += 1;
        }
    }
    assert!(ahead > 20 && back > 20, "{ahead} {back}");
}
