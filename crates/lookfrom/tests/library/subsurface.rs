//! Subsurface scattering against what can be computed by hand.

use crate::support::{Compiled, SMALL, scene};
use lookfrom::inspect::inspect;
use lookfrom::render::SampleId;
use lookfrom_scene::Scene;
use lookfrom_scene::settings::Integrator;

/// What the camera sees of a material from above: a surface without end, below a white sky.
fn seen(material: &str, samples: u32) -> [f64; 3] {
    let film = Compiled::new(scene(&format!(
        r#"{SMALL}
        samples = {samples}
        [camera]
        lookfrom = [0, 0, 9]
        lookat = [0, 0, 0]
        up = [0, 1, 0]
        fov = 1
        [materials.a]
        type = "subsurface"
        {material}
        [[quad]]
        corner = [-1000, -1000, 0]
        edge_u = [2000, 0, 0]
        edge_v = [0, 2000, 0]
        material = "a"
        [[light]]
        type = "environment"
        color = 1
        "#
    )))
    .film();
    assert_eq!(film.dropped(), 0);
    let pixels = film.picture().pixels;
    let sum = pixels.iter().fold([0.0; 3], |sum, pixel| [0, 1, 2].map(|k| sum[k] + f64::from(pixel[k])));
    sum.map(|sum| sum / pixels.len() as f64)
}

/// Below a white sky a flat surface reflects F, and of the rest the effective albedo leaves.
#[test]
fn a_flat_surface_has_its_effective_albedo() {
    let reflectance = [0.3, 0.6, 0.9];
    for (ior, mean_free_path) in [(1.33, "0.5"), (1.5, "[1, 0.3, 0.1]")] {
        let material =
            format!("reflectance = [0.3, 0.6, 0.9]\nmean_free_path = {mean_free_path}\nior = {ior}");
        let found = seen(&material, 4096);
        let fresnel = ((ior - 1.0) / (ior + 1.0_f64)).powi(2);
        for (found, albedo) in found.into_iter().zip(reflectance) {
            let expected = fresnel + (1.0 - fresnel) * albedo;
            assert!((found / expected - 1.0).abs() < 0.01, "{material}: {found}, not {expected}");
        }
    }
}

/// The scale changes distances, not how much light leaves a flat surface.
#[test]
fn the_scale_is_of_no_account_on_a_flat_surface() {
    let [fine, coarse] = [10.0, 1.0].map(|scale| seen(&format!("preset = \"Skin2\"\nscale = {scale}"), 4096));
    for (fine, coarse) in fine.into_iter().zip(coarse) {
        assert!((fine / coarse - 1.0).abs() < 0.015, "{fine} {coarse}");
    }
}

/// Three bodies, smooth and rough, and a lamp.
fn bodies() -> Scene {
    scene(
        r#"
        [image]
        width = 24
        height = 24
        [render]
        integrator = "path"
        samples = 16
        color = "spectral"
        [camera]
        lookfrom = [0, 1, 6]
        lookat = [0, 0, 0]
        fov = 30
        [materials.skin]
        type = "subsurface"
        preset = "Skin1"
        scale = 8
        [materials.jade]
        type = "subsurface"
        reflectance = { type = "checker", even = [0.1, 0.4, 0.3], odd = [0.6, 0.8, 0.7], space = "world", size = 0.3 }
        mean_free_path = 0.1
        roughness = 0.5
        [materials.both]
        type = "mix"
        materials = ["skin", "jade"]
        [[sphere]]
        center = [-1, 0, 0]
        material = "skin"
        [[box]]
        min = [0.2, -1, -0.5]
        max = [1.2, 0, 0.5]
        material = "jade"
        [[disk]]
        center = [0, -1.2, 0]
        normal = [0, 1, 0]
        radius = 3
        material = "both"
        [[light]]
        type = "rectangle"
        center = [-3, 4, 3]
        target = [0, 0, 0]
        width = 1
        height = 1
        radiance = 20
        "#,
    )
}

#[test]
fn pictures_have_the_same_bits_for_any_number_of_threads() {
    let compiled = Compiled::new(bodies());
    let [one, two] = [1, 2].map(|threads| compiled.render(threads).film);
    assert_eq!(one.dropped(), 0);
    assert_eq!(one.picture().pixels, two.picture().pixels);
    assert!(one.picture().pixels.iter().any(|pixel| pixel[0] > 0.0));
}

#[test]
fn other_integrators_see_plastic() {
    for integrator in [Integrator::Whitted, Integrator::Raycast, Integrator::RandomWalk] {
        let mut scene = bodies();
        scene.render.integrator = integrator;
        assert_eq!(Compiled::new(scene).film().dropped(), 0);
    }
}

#[test]
fn what_is_told_of_probes_adds_up() {
    let renderer = Compiled::new(bodies()).renderer();
    let (mut found, mut lost) = (0, 0);
    for place in 0..144 {
        let pixel = [place % 12 * 2, place / 12 * 2];
        let inspection = inspect(&renderer, SampleId { pixel, sample: 3 });
        assert!(inspection.adds_up);
        for ray in &inspection.rays {
            let Some(probe) = &ray.probe else { continue };
            let bounce = ray.bounce.as_ref().expect("a transmission");
            assert!(bounce.lobe.ends_with("transmission") && bounce.survives);
            assert!((probe.choice.iter().sum::<f32>() - 1.0).abs() < 1e-5);
            let next = inspection.ray(ray.address + 1);
            let Some(exit) = &probe.exit else {
                lost += 1;
                assert!(next.is_none() && ray.ends == Some("no point is found where it would leave"));
                continue;
            };
            found += 1;
            assert!(probe.count > 0 && probe.segment.is_some());
            for (k, throughput) in exit.throughput.iter().enumerate() {
                let expected = probe.throughput_before[k] * exit.sp[k] / (exit.pdf * exit.probability);
                assert!((throughput - expected).abs() <= 1e-5 * expected, "{probe:?}");
            }
            // The line is the next ray, and its hit the point; both are one bounce.
            let next = next.expect("a ray");
            assert_eq!(
                (next.depth, next.end(), &next.throughput),
                (ray.depth, Some(exit.point), &exit.throughput)
            );
            assert_eq!(next.scattering.as_ref().expect("a BSDF").kind, "normalized Fresnel");
            assert_eq!(next.met.as_ref().map(|met| &met.material), ray.met.as_ref().map(|met| &met.material));
        }
        let text = inspection.to_string();
        let told = text.matches("diffuses below the surface; where does it leave?").count();
        assert_eq!(told, inspection.rays.iter().filter(|ray| ray.probe.is_some()).count());
    }
    assert!(found > 20 && lost > 5, "{found} {lost}");
}
