//! Media of pbrt's scenes: is each ray in the medium that the surface it left names for its side, or else in that of the ray
//! before, and what do integrators make of that?
//!
//! Each scene is seen twice, with a medium that absorbs and with one that does not; by Beer's law the ratio says how long the
//! light's way was in it.

use std::path::{Path, PathBuf};

use crate::support::{self, Compiled};
use lookfrom::inspect::inspect;
use lookfrom::render::SampleId;
use lookfrom_scene::settings::{ColorMode, Integrator};
use lookfrom_scene::{LoadContext, Memory, Scene, load};

/// What the medium takes away per unit of length.
const SIGMA: [f64; 3] = [0.4, 0.1, 0.0];

/// A lamp of both sides that stands across the z axis at `z`.
fn lamp(z: f32) -> String {
    format!(
        r#"AttributeBegin Translate 0 0 {z} Material "diffuse" "rgb reflectance" [ 0 0 0 ]
        AreaLightSource "diffuse" "rgb L" [ 3 2 1 ] "bool twosided" true Shape "disk" "float radius" 0.5 AttributeEnd
        "#
    )
}

/// A disk across the z axis at `z` whose outside is before it, toward the camera, or, reversed, behind it.
fn disk(before: &str, z: f32, reversed: bool) -> String {
    let turn = if reversed { "" } else { "ReverseOrientation" };
    format!(
        r#"AttributeBegin {before} Translate 0 0 {z} {turn} Shape "disk" "float radius" 0.5 AttributeEnd "#
    )
}

/// The camera looks along z from the origin, at nearly nothing but the axis.
fn text(integrator: &str, sigma: [f64; 3], before: &str, world: &str) -> String {
    let [r, g, b] = sigma;
    format!(
        r#"Integrator "{integrator}" "integer maxdepth" 4
        Film "rgb" "integer xresolution" 2 "integer yresolution" 2 Sampler "independent" "integer pixelsamples" 64
        MakeNamedMedium "ink" "string type" "homogeneous" "rgb sigma_a" [ {r} {g} {b} ] "rgb sigma_s" [ 0 0 0 ]
        {before} Camera "perspective" "float fov" 0.1
        WorldBegin {world}"#
    )
}

fn read(text: &str) -> (Scene, Vec<String>) {
    let name = PathBuf::from("a.pbrt");
    let files = Memory([(name.clone(), text.as_bytes().to_vec())].into());
    let mut context = LoadContext::new(&files);
    let mut scene = load::scene(Path::new(&name), &mut context).unwrap_or_else(|error| panic!("{error}"));
    scene.render.color = ColorMode::Rgb;
    (scene, context.warnings.iter().map(ToString::to_string).collect())
}

fn mean(scene: Scene) -> [f64; 3] {
    let film = Compiled::new(scene).film();
    assert_eq!(film.dropped(), 0);
    let pixels = film.picture().pixels;
    let sum = pixels.iter().fold([0.0; 3], |sum, pixel| [0, 1, 2].map(|k| sum[k] + f64::from(pixel[k])));
    sum.map(|sum| sum / pixels.len() as f64)
}

/// The part of light that a scene's medium lets through.
fn passed(integrator: &str, before: &str, world: &str) -> [f64; 3] {
    let [absorbing, clear] =
        [SIGMA, [0.0; 3]].map(|sigma| mean(read(&text(integrator, sigma, before, world)).0));
    assert!(clear.iter().all(|channel| *channel > 0.0), "{clear:?}");
    std::array::from_fn(|k| absorbing[k] / clear[k])
}

/// The light's way in the medium by what was let through.
fn assert_way(passed: [f64; 3], way: f64, what: &str) {
    for (passed, sigma) in passed.iter().zip(SIGMA) {
        let expected = (-sigma * way).exp();
        assert!((passed / expected - 1.0).abs() < 2e-3, "{what}: {passed}, expected {expected}");
    }
}

/// A mirror 2 before the camera, and a lamp 3 behind it.
fn mirror(interface: &str, reversed: bool) -> String {
    let mirror = r#"Material "conductor" "rgb reflectance" [ 0.9 0.9 0.9 ]"#;
    disk(&format!("{interface} {mirror}"), 2.0, reversed) + &lamp(-3.0)
}

const OUTSIDE: &str = r#"MediumInterface "" "ink""#;
const INSIDE: &str = r#"MediumInterface "ink" """#;
const BOTH: &str = r#"MediumInterface "ink" "ink""#;

#[test]
fn a_mirrored_ray_is_in_what_is_on_its_side() {
    for integrator in ["volpath", "simplevolpath", "bdpt"] {
        let way = |interface, reversed, way: f64| {
            let what = format!("{integrator} {interface} {reversed}");
            assert_way(passed(integrator, "", &mirror(interface, reversed)), way, &what);
        };
        way(OUTSIDE, false, 5.0);
        way(OUTSIDE, true, 0.0);
        way(INSIDE, false, 0.0);
        way(INSIDE, true, 5.0);
        // No border: the ray stays in what it came in.
        way(BOTH, false, 0.0);
    }
}

#[test]
fn glass_with_the_medium_outside_is_no_brighter_than_its_way_through_it() {
    let ball = |interface: &str, material: &str, reversed: bool| {
        let turn = if reversed { "ReverseOrientation" } else { "" };
        format!(
            r#"AttributeBegin Translate 0 0 3 {interface} {turn} Material {material} Shape "sphere" AttributeEnd "#
        ) + &lamp(9.0)
    };
    // From the camera to 2 is a vacuum; then there are 2 within, and 5 behind.
    for material in [r#""interface""#, r#""dielectric" "float eta" 1"#] {
        for (interface, reversed, expected) in
            [(OUTSIDE, false, 5.0), (OUTSIDE, true, 2.0), (INSIDE, false, 2.0), (INSIDE, true, 5.0)]
        {
            let what = format!("{interface} {material} {reversed}");
            assert_way(passed("volpath", "", &ball(interface, material, reversed)), expected, &what);
        }
    }
    // What glass mirrors is outside of it.
    let glass = |reversed| {
        let glass = r#"MediumInterface "" "ink" Material "dielectric" "float eta" 1.5"#;
        disk(glass, 2.0, reversed) + &lamp(-3.0)
    };
    assert_way(passed("volpath", "", &glass(false)), 5.0, "mirrored by glass");
    assert_way(passed("volpath", "", &glass(true)), 0.0, "mirrored by glass, inside");
}

#[test]
fn shadow_rays_are_in_what_is_on_their_side() {
    let lit = |interface: &str, reversed| {
        let wall = format!(r#"{interface} Material "diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ]"#);
        disk(&wall, 2.0, reversed) + r#"LightSource "point" "point3 from" [ 0 0 -1 ] "rgb I" [ 3 3 3 ]"#
    };
    for integrator in ["volpath", "simplevolpath"] {
        assert_way(passed(integrator, "", &lit(OUTSIDE, false)), 3.0, integrator);
        assert_way(passed(integrator, "", &lit(OUTSIDE, true)), 0.0, integrator);
        assert_way(passed(integrator, "", &lit(INSIDE, true)), 3.0, integrator);
        assert_way(passed(integrator, "", &lit(BOTH, false)), 0.0, integrator);
    }
    // Through a ball of it, half way.
    let ball = r#"AttributeBegin MediumInterface "ink" "" Material "interface" Translate 0 0 0.5 Shape "sphere" "float radius" 0.25
        AttributeEnd "#;
    // The camera sees the wall through it, too.
    assert_way(passed("volpath", "", &(lit("", false) + ball)), 1.0, "through a ball");
    // Media of materials that let light through in Whitted's model.
    let through = |integrator| {
        let [absorbing, clear] = [SIGMA, [0.0; 3]].map(|sigma| {
            let (mut scene, _) = read(&text("volpath", sigma, OUTSIDE, &lit(OUTSIDE, false)));
            scene.render.integrator = integrator;
            mean(scene)
        });
        std::array::from_fn(|k| absorbing[k] / clear[k])
    };
    for integrator in [Integrator::Whitted, Integrator::Raycast] {
        assert_way(through(integrator), 5.0, integrator.word());
    }
}

#[test]
fn the_camera_stands_in_a_medium() {
    for integrator in ["volpath", "simplevolpath", "mlt"] {
        let way = |before, expected| {
            assert_way(passed(integrator, before, &lamp(6.0)), expected, &format!("{integrator} {before}"));
        };
        way(OUTSIDE, 6.0);
        way(BOTH, 6.0);
        way(INSIDE, 0.0);
        way("", 0.0);
        way(r#"MediumInterface "ink" MediumInterface """#, 0.0);
    }
    // What a mirror does not say is as it was.
    let ways = [("", 7.0), (BOTH, 7.0), (r#"MediumInterface "" """#, 7.0)];
    for (interface, expected) in ways {
        let world = format!(r#"MediumInterface "" {}"#, mirror(interface, false));
        assert_way(passed("volpath", OUTSIDE, &world), expected, &format!("mirror {interface}"));
    }
    // Out of a ball of it, to a sky.
    let ball = r#"MediumInterface "ink" "" Material "interface" Shape "sphere" "float radius" 4
        LightSource "infinite" "rgb L" [ 2 1 3 ]"#;
    assert_way(passed("volpath", BOTH, ball), 4.0, "out of a ball");
}

#[test]
fn media_without_end_take_all_from_the_sky_as_in_pbrt() {
    let sky = r#"LightSource "infinite" "rgb L" [ 2 1 3 ]"#;
    let [r, g, b] = passed("volpath", BOTH, sky);
    assert_eq!((r, g), (0.0, 0.0));
    assert!((b - 1.0).abs() < 1e-6, "{b}");
    // The sun stands twice the scene's radius away, here that of a disk.
    let wall = disk(r#"MediumInterface "" Material "diffuse""#, 2.0, false);
    let sun = r#"LightSource "distant" "point3 from" [ 0 0 0 ] "point3 to" [ 0 0 1 ]"#;
    assert_way(passed("volpath", BOTH, &(wall + sun)), 2.0 + 2.0 * 0.5_f64.sqrt(), "sun");
}

#[test]
fn only_integrators_for_media_know_them() {
    let behind = disk(&format!(r#"{INSIDE} Material "interface""#), 1.0, false) + &lamp(6.0);
    let wall = disk(r#"Material "diffuse""#, 2.0, false);
    let lit = r#"LightSource "point" "point3 from" [ 0 0 -1 ] "rgb I" [ 3 3 3 ]"#;
    for integrator in ["path", "simplepath"] {
        assert_way(passed(integrator, OUTSIDE, &lamp(6.0)), 0.0, integrator);
        assert_way(passed(integrator, "", &mirror(OUTSIDE, false)), 0.0, integrator);
        // Paths go through interfaces, shadow rays do not, as in pbrt.
        assert_way(passed(integrator, "", &behind), 0.0, integrator);
        let between = r#"AttributeBegin Translate 0 0 -0.5 Material "interface" Shape "disk" AttributeEnd "#;
        let world = format!("{wall} {lit} {between}");
        assert_eq!(mean(read(&text(integrator, SIGMA, "", &world)).0), [0.0; 3], "{integrator}");
        let free = mean(read(&text(integrator, SIGMA, "", &format!("{wall} {lit}"))).0);
        assert_eq!(mean(read(&text("volpath", SIGMA, "", &world)).0), free, "{integrator}");
    }
    assert_way(passed("randomwalk", OUTSIDE, &lamp(6.0)), 0.0, "randomwalk");
    assert_way(passed("ambientocclusion", OUTSIDE, &wall), 0.0, "ambientocclusion");
    // It is told of once, and what is not rendered of them is not.
    let fog = r#"MakeNamedMedium "fog" "string type" "homogeneous" "#;
    let (_, warnings) = read(&text(
        "path",
        SIGMA,
        &format!("{fog} {OUTSIDE}"),
        &mirror(r#"MediumInterface "fog" """#, false),
    ));
    let expected = "a.pbrt:1:1: the integrator \"path\" does not support media, as in pbrt: they are treated as a vacuum; \
                    \"volpath\" supports them";
    assert_eq!(warnings, [expected]);
    assert!(read(&text("path", SIGMA, fog, &lamp(6.0))).1.is_empty());
}

#[test]
fn what_is_told_of_media_adds_up() {
    let world = mirror(OUTSIDE, false) + r#"LightSource "infinite" "rgb L" [ 2 1 3 ]"#;
    for before in ["", BOTH] {
        let compiled = Compiled::new(read(&text("volpath", SIGMA, before, &world)).0);
        let renderer = compiled.renderer();
        let film = compiled.film();
        let mut sum = [0.0; 3];
        for sample in 0..64 {
            let inspection = inspect(&renderer, SampleId { pixel: [1, 0], sample });
            assert!(inspection.adds_up);
            for ray in &inspection.rays {
                let share = ray.throughput_there.as_ref().unwrap_or(&ray.throughput);
                for found in &ray.found {
                    let expected = |k: usize| share[k] * found.radiance.lanes[k] * found.weight;
                    assert!(
                        (0..3).all(|k| (found.added.lanes[k] - expected(k)).abs() <= 1e-6 * expected(k)),
                        "{ray:?}"
                    );
                }
            }
            sum = std::array::from_fn(|k| sum[k] + f64::from(inspection.film[k]) / 64.0);
        }
        let mean = film.mean(1, 0);
        assert!((0..3).all(|k| (f64::from(mean[k]) - sum[k]).abs() <= 1e-5 * sum[k]), "{mean:?} {sum:?}");
    }
}

/// A camera in a body of our own scenes starts in it: water absorbs on the way to its surface, wherever the eye stands, and
/// bodies beside it do not.
#[test]
fn an_eye_in_water_sees_through_water() {
    let scene = |integrator: &str, eye: f32, sigma: [f64; 3]| {
        let [r, g, b] = sigma;
        support::scene(&format!(
            r#"
            [camera]
            lookfrom = [0, {eye}, 0]
            lookat = [0.0, 5.0, 0.001]
            up = [0, 0, 1]
            fov = 0.2
            [image]
            width = 4
            height = 4
            filter = "box"
            [render]
            integrator = "{integrator}"
            samples = 64
            [[light]]
            type = "environment"
            color = 1
            [materials.water]
            type = "principled"
            roughness = 0
            transmission = 1
            solid = true
            ior = 1.333
            absorption = [{r}, {g}, {b}]
            [materials.ink]
            type = "principled"
            roughness = 0
            transmission = 1
            solid = true
            absorption = [3, 3, 3]
            [[box]]
            min = [-40, -30, -40]
            max = [40, 0, 40]
            material = "water"
            [materials.black]
            type = "diffuse"
            reflectance = 0
            [[quad]]
            corner = [-39, -20, 39]
            edge_u = [78, 0, 0]
            edge_v = [0, 0, -78]
            material = "black"
            [[sphere]]
            center = [5, -4, 1]
            radius = 2
            material = "ink"
            "#
        ))
    };
    for integrator in ["path", "whitted"] {
        for eye in [-5.0, -1.0, 2.0] {
            let [absorbing, clear] = [SIGMA, [0.0; 3]].map(|sigma| mean(scene(integrator, eye, sigma)));
            let passed = std::array::from_fn(|k| absorbing[k] / clear[k]);
            assert_way(passed, f64::from(-eye).max(0.0), &format!("{integrator}, {eye}"));
        }
    }
}
