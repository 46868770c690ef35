//! Media that scatter and shine, against what can be computed by hand.

use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use crate::support::{self, Compiled};
use lookfrom::inspect::inspect;
use lookfrom::render::SampleId;
use lookfrom_scene::settings::{ColorMode, Integrator};
use lookfrom_scene::{LoadContext, Memory, Scene, load};

/// A scene whose camera looks along z from the origin, through 2 × 2 pixels, with a homogeneous medium.
fn scene(depth: u32, samples: u32, medium: &str, before: &str, world: &str) -> Scene {
    scene_of(depth, samples, &format!(r#""homogeneous" {medium}"#), before, world)
}

/// The same with a medium of any type.
pub(super) fn scene_of(depth: u32, samples: u32, medium: &str, before: &str, world: &str) -> Scene {
    let text = format!(
        r#"Integrator "volpath" "integer maxdepth" {depth}
        Film "rgb" "integer xresolution" 2 "integer yresolution" 2 PixelFilter "box"
        Sampler "independent" "integer pixelsamples" {samples}
        MakeNamedMedium "fog" "string type" {medium}
        {before} Camera "perspective" "float fov" 0.1
        WorldBegin {world}"#
    );
    let name = PathBuf::from("a.pbrt");
    let files = Memory([(name.clone(), text.into_bytes())].into());
    let mut context = LoadContext::new(&files);
    let mut scene = load::scene(Path::new(&name), &mut context).unwrap_or_else(|error| panic!("{error}"));
    assert!(context.warnings.is_empty(), "{:?}", context.warnings);
    scene.render.color = ColorMode::Rgb;
    scene
}

pub(super) fn mean(scene: Scene) -> [f64; 3] {
    let film = Compiled::new(scene).film();
    assert_eq!(film.dropped(), 0);
    let pixels = film.picture().pixels;
    let sum = pixels.iter().fold([0.0; 3], |sum, pixel| [0, 1, 2].map(|k| sum[k] + f64::from(pixel[k])));
    sum.map(|sum| sum / pixels.len() as f64)
}

pub(super) fn assert_near(found: [f64; 3], expected: [f64; 3], tolerance: f64, what: &str) {
    for (found, expected) in found.into_iter().zip(expected) {
        assert!((found / expected - 1.0).abs() < tolerance, "{what}: {found}, expected {expected}");
    }
}

/// The whole space is filled.
pub(super) const AROUND: &str = r#"MediumInterface "" "fog""#;

/// A small black ball out of sight, by which the world has a size.
pub(super) const SPECK: &str = r#"AttributeBegin Translate 0 -9 0 Material "diffuse" "rgb reflectance" [ 0 0 0 ]
    Shape "sphere" "float radius" 0.01 AttributeEnd "#;

/// In a furnace a medium that absorbs nothing is invisible: light that is scattered away comes from elsewhere as well.
#[test]
fn what_absorbs_nothing_is_unseen_in_a_furnace() {
    for [r, g, b] in [[0.4, 0.4, 0.4], [5.0, 5.0, 5.0], [0.5, 2.0, 8.0]] {
        for asymmetry in [-0.6, 0.0, 0.8] {
            let medium =
                format!(r#""rgb sigma_a" [ 0 0 0 ] "rgb sigma_s" [ {r} {g} {b} ] "float g" {asymmetry}"#);
            let sky = r#"LightSource "infinite" "rgb L" [ 1 1 1 ]"#;
            let ball = |z: f32| {
                format!(
                    r#"{sky} AttributeBegin MediumInterface "fog" "" Translate 0.1 0.2 {z}
                    Material "interface" Shape "sphere" "float radius" 1 AttributeEnd"#
                )
            };
            let what = format!("{r} {g} {b}, g {asymmetry}");
            // From outside, and from within.
            for (before, z) in [("", 3.0), (AROUND, 0.0)] {
                let samples = if r == b { 256 } else { 1 << 14 };
                let seen = mean(scene(100_000, samples, &medium, before, &ball(z)));
                let sum: f64 = seen.iter().sum();
                assert!((sum / 3.0 - 1.0).abs() < 1e-4, "{what}: {seen:?}");
                // Lanes of one extinction share all flights; where it differs they have noise.
                assert_near(seen, [1.0; 3], if r == b { 1e-4 } else { 0.03 }, &what);
            }
        }
    }
}

/// Light that is not scattered is what both coefficients leave of it.
#[test]
fn what_is_scattered_is_lost_to_the_straight_way() {
    let medium = r#""rgb sigma_a" [ 0.2 0.1 0 ] "rgb sigma_s" [ 0.1 0.3 0.05 ] "float scale" 2"#;
    let lamp = r#"Translate 0 0 4 Material "diffuse" "rgb reflectance" [ 0 0 0 ]
        AreaLightSource "diffuse" "rgb L" [ 3 2 1 ] "bool twosided" true Shape "disk" "float radius" 1"#;
    let expected = [3.0 * (-2.4_f64).exp(), 2.0 * (-3.2_f64).exp(), (-0.4_f64).exp()];
    // The path tracer samples flights; ray casting has Beer's law.
    assert_near(mean(scene(0, 1 << 14, medium, AROUND, lamp)), expected, 0.03, "flights");
    let mut cast = scene(0, 1, medium, AROUND, lamp);
    cast.render.integrator = Integrator::Raycast;
    let cast = mean(cast);
    let clear = scene(0, 1, r#""rgb sigma_a" [ 0 0 0 ] "rgb sigma_s" [ 0 0 0 ]"#, AROUND, lamp);
    let mut clear = clear;
    clear.render.integrator = Integrator::Raycast;
    let clear = mean(clear);
    let passed = [0, 1, 2].map(|k| cast[k] / clear[k]);
    assert_near(passed, [(-2.4_f64).exp(), (-3.2_f64).exp(), (-0.4_f64).exp()], 1e-3, "Beer");
}

/// The light of a lamp that a medium scatters once on the axis, by quadrature.
fn scattered_once([absorption, scattering]: [f64; 2], g: f64, [x, z]: [f64; 2]) -> f64 {
    let extinction = absorption + scattering;
    let (steps, end) = (400_000, 40.0);
    let width = end / f64::from(steps);
    let sum: f64 = (0..steps)
        .map(|step| {
            let t = (f64::from(step) + 0.5) * width;
            let r2 = x * x + (z - t) * (z - t);
            // From the lamp it travels along (0, t) − (x, z), and after that back to the eye.
            let cos = (z - t) / r2.sqrt();
            let p = (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cos).powf(1.5));
            scattering * p * (-extinction * (t + r2.sqrt())).exp() / r2
        })
        .sum();
    sum * width
}

#[test]
fn a_lamp_in_fog_is_what_quadrature_says() {
    let [absorption, scattering] = [[0.1, 0.05, 0.3], [0.4, 0.8, 0.2]];
    for g in [-0.5, 0.0, 0.6] {
        let text = |of: [f64; 3]| of.map(|sigma| sigma.to_string()).join(" ");
        let medium = format!(
            r#""rgb sigma_a" [ {} ] "rgb sigma_s" [ {} ] "float g" {g}"#,
            text(absorption),
            text(scattering)
        );
        let world = format!(r#"{SPECK} LightSource "point" "point3 from" [ 0.7 0 1.5 ] "rgb I" [ 1 1 1 ]"#);
        let expected = [0, 1, 2].map(|k| scattered_once([absorption[k], scattering[k]], g, [0.7, 1.5]));
        assert_near(mean(scene(1, 1 << 16, &medium, AROUND, &world)), expected, 0.015, &format!("g {g}"));
    }
}

/// Behind an interface a shadow ray is continued from there: rounding must not let it reach into its light.
#[test]
fn a_light_behind_an_interface_does_not_block_its_own_light() {
    let lit = |between: &str| {
        let world = format!(
            r#"AttributeBegin Translate 0 0 2 Material "diffuse" Shape "disk" "float radius" 1 AttributeEnd
            AttributeBegin Translate 1 0 0.5 Material "diffuse" "rgb reflectance" [ 0 0 0 ]
            AreaLightSource "diffuse" "rgb L" [ 9 9 9 ] "bool twosided" true Shape "disk" "float radius" 0.25 AttributeEnd
            {between}"#
        );
        mean(scene(1, 1 << 12, "", "", &world))
    };
    let interface = |z: f32| {
        format!(
            r#"AttributeBegin Translate 1 0 {z} Material "interface" Shape "disk" "float radius" 0.8 AttributeEnd"#
        )
    };
    let expected = lit("");
    for z in [0.501, 0.58, 1.0, 1.9] {
        assert_near(lit(&interface(z)), expected, 1e-4, &format!("interface at {z}"));
    }
}

#[test]
fn a_medium_shines_by_what_it_absorbs() {
    // Along 4 to a black wall; in a medium without end; and where it scatters as well, in a furnace of its own radiance.
    let wall =
        r#"Translate 0 0 4 Material "diffuse" "rgb reflectance" [ 0 0 0 ] Shape "disk" "float radius" 1"#;
    let shines = |scattering: f64| {
        format!(
            r#""rgb sigma_a" [ 0.1 0.5 2 ] "rgb sigma_s" [ {scattering} {scattering} {scattering} ] "rgb Le" [ 3 2 1 ]
            "float Lescale" 2"#
        )
    };
    let along = mean(scene(1, 16, &shines(0.0), AROUND, wall));
    assert_near(along, [6.0 * (1.0 - (-0.4_f64).exp()), 4.0 * (1.0 - (-2.0_f64).exp()), 2.0], 1e-3, "wall");
    assert_near(mean(scene(1, 16, &shines(0.0), AROUND, SPECK)), [6.0, 4.0, 2.0], 1e-4, "without end");
    let scattered = mean(scene(1000, 1 << 14, &shines(0.5), AROUND, SPECK));
    assert_near(scattered, [6.0, 4.0, 2.0], 0.03, "scattered");
}

/// A box of fog before a wall, with a lamp, a sun and a sky.
fn fog() -> Scene {
    scene(
        8,
        1 << 13,
        r#""rgb sigma_a" [ 0.1 0.05 0.2 ] "rgb sigma_s" [ 0.6 0.9 0.4 ] "float g" 0.4"#,
        "",
        r#"LightSource "infinite" "rgb L" [ 0.2 0.3 0.5 ]
        AttributeBegin Translate 0 0 5 Material "diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ] Shape "disk" "float radius" 2 AttributeEnd
        AttributeBegin Translate 0 1.4 2.5 Material "diffuse" "rgb reflectance" [ 0 0 0 ]
        AreaLightSource "diffuse" "rgb L" [ 6 5 4 ] "bool twosided" true Shape "sphere" "float radius" 0.4 AttributeEnd
        AttributeBegin Translate 0 0 2.5 Material "interface" MediumInterface "fog" "" Shape "sphere" "float radius" 1 AttributeEnd"#,
    )
}

#[test]
fn any_strategy_finds_the_same_light_in_fog() {
    let by = |integrator| {
        let mut scene = fog();
        scene.render.integrator = integrator;
        mean(scene)
    };
    let expected = by(Integrator::Path);
    for integrator in [Integrator::SimplePath, Integrator::RandomWalk] {
        assert_near(by(integrator), expected, 0.06, integrator.word());
    }
}

#[test]
fn what_is_told_of_fog_adds_up() {
    let renderer = Compiled::new(fog()).renderer();
    let (mut scattered, mut arrived) = (0, 0);
    for sample in 0..64 {
        let inspection = inspect(&renderer, SampleId { pixel: [1, 0], sample });
        assert!(inspection.adds_up);
        for ray in &inspection.rays {
            let Some(flight) = &ray.flight else { continue };
            assert_eq!(flight.scattered_at.is_some(), flight.distance < flight.limit);
            let is_scattered = flight.scattered_at.is_some();
            *if is_scattered { &mut scattered } else { &mut arrived } += 1;
            // Nothing is told of a hit that was not reached.
            assert!(!is_scattered || ray.met.is_none() && ray.found.is_empty() && ray.bounce.is_none());
            // And what is told is what the throughput follows from.
            for k in 0..3 {
                let kept = if is_scattered { flight.scattering[k] } else { 1.0 };
                let expected = ray.throughput[k] * kept * flight.transmittance[k] / flight.density;
                assert!((flight.throughput[k] - expected).abs() <= 1e-5 * expected, "{flight:?}");
            }
        }
        let text = inspection.to_string();
        let told = text.matches("a medium scatters it before it meets anything").count();
        assert_eq!(told, inspection.rays.iter().filter(|ray| ray.scattered_at().is_some()).count());
    }
    assert!(scattered > 20 && arrived > 20, "{scattered} {arrived}");
}

#[test]
fn whitteds_model_says_that_it_does_not_scatter() {
    let mut scene = fog();
    scene.render.integrator = Integrator::Whitted;
    let mut warnings = Vec::new();
    lookfrom::world::World::compile(scene, &mut warnings).expect("a world");
    let expected = "media neither scatter light nor emit it with \"whitted\": use \"path\"";
    assert!(warnings.iter().any(|warning| warning.to_string().contains(expected)), "{warnings:?}");
}

#[test]
fn pictures_of_fog_have_the_same_bits_for_any_number_of_threads() {
    let mut scene = fog();
    (scene.image.width, scene.image.height, scene.render.samples) = (24, 24, 16);
    let compiled = Compiled::new(scene);
    let [one, two] = [1, 2].map(|threads| compiled.render(threads).film.picture().pixels);
    assert_eq!(one, two);
    assert!(one.iter().any(|pixel| pixel[0] > 0.0));
}

/// Fog that fills all space under a sky of radiance 1, over a black ball out of sight or without any shape.
fn under_a_sky(medium: &str, shape: &str, integrator: Integrator) -> Scene {
    let mut scene = support::scene(&format!(
        r#"
        camera = {{ lookfrom = [0, 0, 6], lookat = [0, 0, 0], fov = 1, medium = "fog" }}
        light = [{{ type = "environment", color = 1 }}]
        {shape}
        [image]
        width = 2
        height = 2
        filter = "box"
        [render]
        depth = 10000
        samples = 16384
        sampler = "independent"
        [materials.black]
        type = "diffuse"
        reflectance = 0
        [media.fog]
        {medium}
        "#
    ));
    scene.render.integrator = integrator;
    scene
}

/// A sky is seen through fog that fills space, which ends after the distance from the middle of the scene and twice its radius; of fog that
/// scatters all light nothing is seen.
#[test]
fn a_sky_is_seen_through_fog_that_fills_space() {
    let ball = r#"sphere = [{ center = [0, -9, 0], radius = 1, material = "black" }]"#;
    let length = (36.0_f64 + 81.0).sqrt() + 2.0 * 3_f64.sqrt();
    let absorbing = "absorption = [0.1, 0.05, 0.2]";
    let attenuated = [0.1, 0.05, 0.2].map(|sigma: f64| (-sigma * length).exp());
    for integrator in [Integrator::Path, Integrator::SimplePath, Integrator::RandomWalk, Integrator::Whitted]
    {
        let seen = mean(under_a_sky(absorbing, ball, integrator));
        assert_near(seen, attenuated, 1e-4, &format!("{integrator:?}"));
    }
    let mut endless = under_a_sky(absorbing, ball, Integrator::Path);
    endless.render.endless_media = true;
    assert_eq!(mean(endless), [0.0; 3]);
    for integrator in [Integrator::Path, Integrator::SimplePath, Integrator::RandomWalk] {
        let seen = mean(under_a_sky("scattering = 0.05\ng = 0.5", "", integrator));
        assert_near(seen, [1.0; 3], 0.01, &format!("{integrator:?}"));
    }
}

/// Haze absorbs once where a path passes the back of a single-sided surface in it.
#[test]
fn backs_are_passed_in_haze_as_if_they_were_not_there() {
    for shape in [
        r#"type = "quad", corner = [-1, -1, 0], edge_u = [0, 2, 0], edge_v = [2, 0, 0]"#,
        r#"type = "disk", center = [0, 0, 0], normal = [0, 0, -1], radius = 1"#,
        r#"type = "sphere", center = [0, 0, 6], radius = 1"#,
    ] {
        let [passed, absent] =
            [r#"single_sided = true, material = "black""#, r#"material = "none""#].map(|look| {
                let shape = format!("shape = [{{ {shape}, {look} }}]\nmaterials.none.type = \"interface\"");
                mean(under_a_sky("absorption = [0.1, 0.05, 0.2]", &shape, Integrator::Path))
            });
        assert!(absent[2] > 0.01, "{shape}");
        assert_near(passed, absent, 1e-5, shape);
    }
}
