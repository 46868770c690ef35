//! Bodies in bodies: does each surface bend light by the indices on its two sides, however the bodies are modelled, and does
//! nothing change where they are not nested?

use crate::support::{self, Compiled, SMALL, scene};
use glam::DVec3;
use lookfrom::inspect::{Inspection, RayReport, inspect};
use lookfrom::render::SampleId;
use lookfrom_scene::Scene;
use lookfrom_scene::settings::Integrator;

const GLASS: f64 = 1.5;
const WATER: f64 = 1.33;

/// Balls around the origin by material and radius, before a sky that is brighter above. Those of a negative radius have their
/// outside inside.
fn balls(radii: &[(&str, f64)], more: &str) -> Scene {
    let mut toml = format!(
        r#"
        [camera]
        lookfrom = [0, 0.4, 5]
        lookat = [0, 0.1, 0]
        fov = 22
        {SMALL}
        samples = 1024
        depth = 40
        [materials]
        glass = {{ type = "principled", base_color = 1, roughness = 0, transmission = 1, solid = true, ior = {GLASS} }}
        more_glass = {{ type = "principled", base_color = 1, roughness = 0.5, transmission = 1, solid = true, ior = {GLASS} }}
        water = {{ type = "principled", base_color = 1, roughness = 0, transmission = 1, solid = true, ior = {WATER} }}
        plastic = {{ type = "principled", base_color = 0.5, roughness = 0.3, ior = {GLASS} }}
        pbrts = {{ type = "dielectric", ior = {GLASS} }}
        [[light]]
        type = "environment"
        zenith = [2, 1.5, 1]
        horizon = [0.2, 0.5, 0.3]
        nadir = 0
        {more}
    "#
    );
    for (material, radius) in radii {
        toml += &format!("\n[[sphere]]\nradius = {}\nmaterial = \"{material}\"\n", radius.abs());
    }
    let mut scene = scene(&toml);
    for (shape, (_, radius)) in scene.shapes.iter_mut().zip(radii) {
        shape.reverse_orientation = *radius < 0.0;
    }
    scene
}

fn inspections(compiled: &Compiled) -> Vec<Inspection> {
    let renderer = compiled.renderer();
    let pixels = (0..8).flat_map(|x| (0..8).map(move |y| [x, y]));
    let ids = pixels.flat_map(|pixel| (0..4).map(move |sample| SampleId { pixel, sample }));
    ids.map(|id| inspect(&renderer, id)).collect()
}

fn eta(ray: &RayReport) -> Option<f32> {
    let (_, eta) = ray.scattering.as_ref()?.numbers.iter().find(|(name, _)| *name == "eta")?;
    Some(eta[0])
}

/// How far from the origin a ray passes, and how far its middle is, up to what it met (or far away).
fn distances(ray: &RayReport) -> (f64, f64) {
    let a = DVec3::from_array(ray.a);
    let direction = glam::Vec3::from_array(ray.direction).as_dvec3();
    let end = ray.met.as_ref().map_or(a + 9.0 * direction.normalize(), |met| DVec3::from_array(met.point));
    (a.cross(direction.normalize()).length(), (0.5 * (a + end)).length())
}

/// The mean by channel.
fn mean(scene: Scene) -> [f64; 3] {
    let film = Compiled::new(scene).film();
    assert_eq!(film.dropped(), 0);
    let pixels = film.picture().pixels;
    let sum = pixels.iter().fold([0.0; 3], |sum, pixel| [0, 1, 2].map(|k| sum[k] + f64::from(pixel[k])));
    sum.map(|sum| sum / pixels.len() as f64)
}

fn assert_same(found: [f64; 3], expected: [f64; 3], within: f64, what: &str) {
    for k in 0..3 {
        assert!((found[k] / expected[k] - 1.0).abs() < within, "{what}: {found:?}, expected {expected:?}");
    }
}

/// Between spheres about one centre, the index times the distance from the centre at which a ray passes is always the same
/// (Bouguer 1729): by whatever ways it comes there.
#[test]
fn each_surface_bends_by_what_is_on_its_sides() {
    let ways: &[(&str, &[(&str, f64)])] = &[
        ("one in the other", &[("glass", 1.0), ("water", 0.7)]),
        ("side by side", &[("glass", 1.0), ("glass", -0.7), ("water", 0.72)]),
        ("with air between", &[("glass", 1.0), ("glass", -0.72), ("water", 0.68)]),
        ("a drop in a bubble in glass", &[("glass", 1.0), ("glass", -0.8), ("water", 0.7)]),
        ("heavier within", &[("water", 1.0), ("glass", 0.7)]),
    ];
    for (name, radii) in ways {
        let (mut went_through, mut inside) = (0, 0);
        for inspection in inspections(&Compiled::new(balls(radii, ""))) {
            let (passes, _) = distances(&inspection.rays[0]);
            for ray in &inspection.rays {
                let (distance, middle) = distances(ray);
                let walls: Vec<f64> = radii.iter().map(|(_, radius)| radius.abs()).collect();
                if walls.iter().any(|wall| (middle - wall).abs() < 0.03) {
                    continue;
                }
                // What is there: the innermost body, unless it is hollow there.
                let around = |(_, radius): &&(&str, f64)| middle < radius.abs();
                let bodies = radii.iter().filter(around).filter(|(_, radius)| *radius > 0.0);
                let body = bodies.min_by(|a, b| a.1.total_cmp(&b.1)).map_or("air", |(material, _)| material);
                let is_hollow = radii.iter().filter(around).any(|(of, radius)| *of == body && *radius < 0.0);
                let index = match body {
                    "glass" if !is_hollow => GLASS,
                    "water" => WATER,
                    _ => 1.0,
                };
                assert!(
                    (index * distance - passes).abs() < 2e-5,
                    "{name}: at {middle} in {body}: {distance} of {passes}"
                );
                went_through += usize::from(ray.address > 3 && middle > 1.0);
                inside += usize::from(middle < 0.6);
            }
        }
        assert!(went_through > 50 && inside > 50, "{name}: {went_through} {inside}");
    }
}

#[test]
fn what_has_the_index_of_its_surroundings_is_not_there() {
    let alone = mean(balls(&[("glass", 1.0)], ""));
    for within in ["glass", "more_glass"] {
        let radii = [("glass", 1.0), (within, 0.7)];
        assert_same(mean(balls(&radii, "")), alone, 0.01, within);
        let mut met = 0;
        for inspection in inspections(&Compiled::new(balls(&radii, ""))) {
            for ray in &inspection.rays {
                let Some(there) = ray.met.as_ref().filter(|met| DVec3::from_array(met.point).length() < 0.9)
                else {
                    continue;
                };
                met += 1;
                let bounce = ray.bounce.as_ref().expect("a way on");
                assert_eq!((eta(ray), bounce.lobe.as_str()), (Some(1.0), "specular transmission"));
                let before = glam::Vec3::from_array(ray.direction).normalize();
                assert!((glam::Vec3::from_array(bounce.wi) - before).length() < 1e-5, "{there:?}");
                let kept = bounce.throughput_before.iter().zip(&bounce.throughput_after);
                assert!(kept.clone().all(|(before, after)| (before - after).abs() < 1e-5), "{bounce:?}");
            }
        }
        assert!(met > 50, "{met}");
    }
}

#[test]
fn a_drink_may_reach_into_its_glass() {
    let nested = mean(balls(&[("glass", 1.0), ("water", 0.7)], ""));
    let reaching = mean(balls(&[("glass", 1.0), ("glass", -0.699), ("water", 0.701)], ""));
    assert_same(reaching, nested, 0.01, "overlapping");
    let with_air = mean(balls(&[("glass", 1.0), ("glass", -0.701), ("water", 0.699)], ""));
    assert!((with_air[0] / nested[0] - 1.0).abs() > 0.02, "{with_air:?} {nested:?}");
}

#[test]
fn what_stands_in_water_mirrors_less() {
    let radii = [("water", 1.0), ("plastic", 0.5), ("pbrts", 0.2)];
    let (mut plastic, mut alone) = (0, 0);
    for (k, radii) in [&radii[..2], &radii[1..2]].into_iter().enumerate() {
        for inspection in inspections(&Compiled::new(balls(radii, ""))) {
            for ray in &inspection.rays {
                let is_plastic =
                    ray.met.as_ref().is_some_and(|met| DVec3::from_array(met.point).length() < 0.6);
                let expected = if k == 0 { GLASS / WATER } else { GLASS };
                if is_plastic && ray.scattering.is_some() {
                    let eta = eta(ray).expect("an index");
                    assert!((f64::from(eta) - expected).abs() < 1e-6, "{eta}");
                    *[&mut plastic, &mut alone][k] += 1;
                }
            }
        }
    }
    assert!(plastic > 30 && alone > 30);
    // pbrt's materials are as in air.
    let mut pbrts = 0;
    for inspection in inspections(&Compiled::new(balls(&[radii[0], radii[2]], ""))) {
        for ray in inspection
            .rays
            .iter()
            .filter(|ray| ray.scattering.as_ref().is_some_and(|scattering| scattering.kind == "dielectric"))
        {
            assert_eq!(eta(ray), Some(GLASS as f32));
            pbrts += 1;
        }
    }
    assert!(pbrts > 5, "{pbrts}");
}

/// What a material is numbered does not matter.
#[test]
fn bodies_are_told_apart_among_any_number_of_materials() {
    let radii = [("ink", 1.0), ("water", 0.7)];
    let ink = r#"
        [materials.ink]
        type = "principled"
        base_color = 1
        roughness = 0
        transmission = 1
        solid = true
        ior = 1.6
        absorption = [1, 0.5, 0.1]
    "#;
    let picture = |before: u32| {
        let mut scene = balls(&radii, ink);
        scene.render.samples = 16;
        for material in 0..before {
            let color = lookfrom_scene::material::Color::gray(0.5);
            let kind = lookfrom_scene::material::MaterialKind::Diffuse { reflectance: color };
            let name = format!("another {material}");
            let material =
                lookfrom_scene::material::Material::new(name, lookfrom_scene::Location::default(), kind);
            scene.materials.push(material);
        }
        let count = scene.materials.len() as u32;
        scene.materials.rotate_right(before as usize);
        for shape in &mut scene.shapes {
            shape.material.0 = (shape.material.0 + before) % count;
        }
        Compiled::new(scene).film().picture().pixels
    };
    assert_eq!(picture(70_000), picture(0));
}

/// Colourless glass in front of light that is the same all around cannot be seen, whatever it holds.
#[test]
fn nothing_is_lost_between_bodies() {
    for radii in [
        &[("glass", 1.0), ("water", 0.7)][..],
        &[("glass", 1.0), ("glass", -0.699), ("water", 0.701)],
        &[("more_glass", 1.0), ("water", 0.7)],
        &[("water", 1.0), ("more_glass", 0.8)],
    ] {
        let mut scene = balls(radii, "");
        scene.lights.clear();
        let even = support::scene("[[light]]\ntype = \"environment\"\ncolor = 1\n");
        scene.lights = even.lights;
        // Total reflection keeps some light in for long.
        scene.render.depth = 300;
        let [found, ..] = mean(scene);
        assert!((found - 1.0).abs() < 5e-4, "{radii:?}: {found}");
    }
}

/// Light that is asked for through the surface of a body that absorbs is as bright as light that is found.
#[test]
fn light_beyond_a_surface_is_not_absorbed_on_its_far_side() {
    let lit = |integrator| {
        let mut scene = scene(
            r#"
            [camera]
            lookfrom = [0, 0.2, 3]
            lookat = [0, 0, 0]
            fov = 30
            [image]
            width = 8
            height = 8
            [render]
            samples = 4096
            depth = 6
            [materials.ink]
            type = "principled"
            base_color = 1
            roughness = 0.8
            transmission = 1
            solid = true
            absorption = [2, 1, 0.5]
            [[sphere]]
            radius = 0.4
            material = "ink"
            [[light]]
            type = "sphere"
            center = [0, 2, -2]
            radius = 1
            radiance = 5
        "#,
        );
        scene.render.integrator = integrator;
        mean(scene)
    };
    assert_same(lit(Integrator::SimplePath), lit(Integrator::Path), 0.02, "asked only");
}
