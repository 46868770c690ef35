//! Are collisions distributed by the medium alone, whatever their majorants are?

use std::sync::Arc;

use glam::{DMat4, DVec3, Vec3};
use lookfrom_scene::grid::{Grid, Placed};
use lookfrom_scene::material::Color;
use lookfrom_scene::medium::{Density, Medium as Written, Variation};

use super::grid::Lookup;
use super::*;
use crate::core::hash;
use crate::core::lanes::LANES;
use crate::core::lanes::width::One;
use crate::shading::texture::SpectralMode;

/// A grid with much and nothing, majorants of which are multiplied by a factor.
fn medium(textures: &Textures, factor: f32) -> Medium {
    let values: Vec<f32> = (0..5 * 6 * 7).map(|k| ((k * 37 % 11) as f32 - 4.0).max(0.0) * 0.3).collect();
    let grid = Arc::new(Grid::from_values([5, 6, 7], &values).expect("a grid"));
    let bounds = [Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, 1.0, 3.0)];
    let written = Written {
        extinction: WrittenExtinction::Parts {
            absorption: Color::Value([0.2, 0.4, 0.1]),
            scattering: Color::Value([0.6, 0.3, 0.9]),
        },
        variation: Some(Variation {
            world_from_medium: DMat4::from_rotation_z(0.3),
            bounds: Some(bounds),
            density: Density::Grid(Placed { grid, bounds }),
            emission_scale: None,
            temperature: None,
        }),
        ..Written::clear("smoke", lookfrom_scene::Location::default())
    };
    let mut medium = Medium::compile(textures, &written, DVec3::ZERO, (DVec3::ZERO, 1.0));
    let varying = medium.varying.as_mut().and_then(Arc::get_mut).expect("it varies");
    varying.majorants.multiply(factor);
    medium
}

const WAY: Way = Way { origin: Vec3::new(0.1, -0.2, -1.0), direction: Vec3::new(0.0, 0.6, 0.8), length: 2.9 };

/// The transmittance by many small steps.
fn transmittance(medium: &Medium, textures: &Textures) -> Spectrum {
    const STEPS: u32 = 20_000;
    let even = medium.coefficients(textures, &SpectralMode::Rgb);
    let varying = medium.varying.as_ref().expect("it varies");
    let width = WAY.length / STEPS as f32;
    let mut depth = [0.0_f64; 4];
    for step in 0..STEPS {
        let point = varying.point(WAY.origin + WAY.direction * ((step as f32 + 0.5) * width));
        // Outside of its box there is nothing of it.
        if (-1.0..1.0).contains(&point.x) && (-1.0..1.0).contains(&point.y) && (0.0..3.0).contains(&point.z) {
            let here = varying.at(
                One,
                point.into(),
                Lookup::Interpolated,
                &even,
                0.0,
                (textures, &[&SpectralMode::Rgb; LANES]),
            );
            depth = std::array::from_fn(|k| depth[k] + f64::from(here.extinction().0[k] * width));
        }
    }
    Spectrum(depth.map(|depth| (-depth).exp() as f32))
}

/// Rays along the way, with a throughput.
fn rays(count: u64, throughput: Spectrum) -> Vec<TrackedRay<'static>> {
    let ray = |seed: u64| TrackedRay {
        way: WAY,
        throughput,
        u: (hash::mix(seed + 1) >> 40) as f32 / 16_777_216.0,
        seed: hash::mix(seed),
        mode: &SpectralMode::Rgb,
    };
    (0..count).map(ray).collect()
}

#[test]
fn transmittance_and_distances_do_not_depend_on_majorants() {
    const COUNT: u64 = 200_000;
    let textures = Textures::default();
    for factor in [1.0, 1.7, 6.0] {
        let medium = medium(&textures, factor);
        let expected = transmittance(&medium, &textures);
        // Ratio tracking, of all lanes.
        let track = |estimate, rays: &[TrackedRay<'_>]| {
            medium.track(&textures, estimate, rays, true).expect("it varies")
        };
        let mut sum = [0.0_f64; 4];
        for tracking in track(Estimate::Transmittance, &rays(COUNT, Spectrum::ONE)) {
            sum = std::array::from_fn(|k| sum[k] + f64::from(tracking.after.0[k]));
            for collision in &tracking.collisions {
                assert!((0.0..WAY.length).contains(&collision.t) && !collision.is_real);
                assert!(collision.coefficients.extinction().max_lane() <= collision.majorant);
            }
        }
        for (sum, expected) in sum.into_iter().zip(expected.0).take(3) {
            let mean = sum / COUNT as f64;
            assert!(
                (mean - f64::from(expected)).abs() < 0.004,
                "factor {factor}: {mean}, expected {expected}"
            );
        }
        // Delta tracking, of the first one. Four standard errors of a share.
        let tracked = track(Estimate::Flight, &rays(COUNT, Spectrum([1.0, 0.0, 0.0, 0.0])));
        let passed = tracked.iter().filter(|tracking| tracking.scattered_at.is_none()).count();
        let share = passed as f64 / COUNT as f64;
        let expected = f64::from(expected.0[0]);
        let error = (expected * (1.0 - expected) / COUNT as f64).sqrt();
        assert!((share - expected).abs() < 4.0 * error, "factor {factor}: {share}, expected {expected}");
    }
}

#[test]
fn what_becomes_of_a_ray_does_not_depend_on_those_beside_it() {
    let textures = Textures::default();
    let medium = medium(&textures, 1.0);
    let rays: Vec<TrackedRay<'_>> = (0..)
        .zip(rays(500, Spectrum([0.9, 0.5, 0.2, 0.0])))
        .map(|(k, ray)| {
            let direction = Vec3::new(0.1 * (k % 7) as f32 - 0.3, 0.6, 0.8).normalize();
            TrackedRay { way: Way { direction, ..WAY }, ..ray }
        })
        .collect();
    for estimate in [Estimate::Flight, Estimate::Transmittance] {
        let track =
            |rays: &[TrackedRay<'_>]| medium.track(&textures, estimate, rays, true).expect("it varies");
        let alone: Vec<Tracking> = rays.iter().flat_map(|ray| track(&[*ray])).collect();
        assert_eq!(format!("{:?}", track(&rays)), format!("{alone:?}"));
    }
}

#[test]
fn a_ray_walks_through_all_cells_between_its_ends() {
    let textures = Textures::default();
    let medium = medium(&textures, 1.0);
    let majorants = &medium.varying.as_ref().expect("it varies").majorants;
    let mut seed = 7_u64;
    for _ in 0..2000 {
        let mut number = |scale: f32| {
            seed = hash::mix(seed.wrapping_add(hash::GOLDEN));
            ((seed >> 40) as f32 / 8_388_608.0 - 1.0) * scale
        };
        let origin = Vec3::new(number(3.0), number(3.0), number(5.0));
        let direction =
            Vec3::new(number(1.0), number(1.0), if number(1.0) > 0.0 { 0.0 } else { number(1.0) });
        let Some((start, mut walk)) = majorants.walk(origin, direction, 4.0) else { continue };
        let mut at = start;
        while at < walk.last {
            walk.advance(majorants, direction.into(), true);
            assert!(walk.end >= at, "{origin} {direction}");
            at = walk.end;
        }
        // Its ends are those of the clipped ray: within the box between them, and not beyond.
        let is_inside = |t: f32| {
            let point = origin + direction * t;
            point.cmpge(Vec3::new(-1.0, -1.0, 0.0)).all() && point.cmple(Vec3::new(1.0, 1.0, 3.0)).all()
        };
        let width = (at - start).max(1e-3);
        assert!(is_inside(start + width * 0.01) && is_inside(at - width * 0.01), "{origin} {direction}");
        assert!(at >= 4.0 - 1e-4 || !is_inside(at + 1e-2), "{origin} {direction}");
    }
}
