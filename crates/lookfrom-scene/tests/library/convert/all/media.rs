//! Scenes with each medium.

use std::sync::Arc;

use glam::Vec3;
use lookfrom_scene::Scene;
use lookfrom_scene::grid::{Grid, Placed};
use lookfrom_scene::material::{Color, Scalar};
use lookfrom_scene::medium::{Density, DraineLobe, Extinction, Medium, Sides, Temperature, Variation};
use lookfrom_scene::scene::{CurveId, MediumId};

use super::{TABLE, TEXTURE, base, each, shear};

pub(super) fn media() -> Vec<(String, Scene)> {
    let numbers = |seed: u32| {
        let values: Vec<f32> = (0..5 * 3 * 9).map(|k| ((k + seed) % 7) as f32 / 3.0).collect();
        let grid = Grid::from_values([5, 3, 9], &values).expect("a grid");
        Placed { grid: Arc::new(grid), bounds: [Vec3::splat(-0.5), Vec3::new(1.0, 2.0, 3.3)] }
    };
    let colors = |seed: u32| {
        let values: Vec<[f32; 3]> = (0..5 * 3 * 9).map(|k| [0.5, ((k + seed) % 7) as f32, 0.0]).collect();
        let grid = Grid::from_values([5, 3, 9], &values).expect("a grid");
        Placed { grid: Arc::new(grid), bounds: [Vec3::NEG_ONE, Vec3::ONE] }
    };
    let variation = |density| Variation {
        world_from_medium: shear(),
        bounds: Some([Vec3::splat(-0.1), Vec3::splat(1.7)]),
        density,
        emission_scale: None,
        temperature: None,
    };
    let hot = Some(Temperature { grid: numbers(2), offset: 10.0, scale: 300.0 });
    let even = Density::Texture { of: Scalar::Value(1.0), most: 1.0 };
    let mut variants = vec![
        variation(Density::Grid(numbers(0))),
        variation(Density::Colors {
            absorption: Some(colors(1)),
            scattering: Some(colors(2)),
            emission: Some(colors(3)),
        }),
        variation(Density::Colors { absorption: None, scattering: Some(colors(2)), emission: None }),
        variation(Density::Cloud { density: 2.0, wispiness: 0.5, frequency: 4.0 }),
        variation(Density::Texture { of: TEXTURE, most: 2.0 }),
        Variation { temperature: hot.clone(), ..variation(Density::Grid(numbers(0))) },
        Variation { temperature: hot, bounds: None, emission_scale: Some(numbers(4)), ..variation(even) },
    ];
    variants.push(Variation { emission_scale: Some(numbers(1)), bounds: None, ..variants[0].clone() });
    let index = |variation: &Variation| match &variation.density {
        Density::Grid(_) => 0,
        Density::Colors { .. } => 1,
        Density::Cloud { .. } => 2,
        Density::Texture { .. } => 3,
        other => panic!("a density of a new kind has no words: {other:?}"),
    };
    let mut scenes = each("medium", variants, index, |scene, variation| {
        let is_hot = variation.temperature.is_some();
        scene.media[0] = Medium {
            extinction: match index(&variation) {
                0 => Extinction::Sum { sum: Color::Curve(TABLE), albedo: Color::gray(0.25) },
                _ => Extinction::Parts { absorption: Color::Curve(TABLE), scattering: Color::gray(0.5) },
            },
            scale: 3.0,
            emission: if is_hot { Color::BLACK } else { Color::Curve(CurveId(2)) },
            emission_scale: 5.0,
            variation: Some(variation),
            ..scene.media[0].clone()
        };
        let sides = Sides { inside: Some(MediumId(0)), outside: None };
        scene.shapes[0].sides = Some(sides);
    });
    let mut homogeneous = base();
    homogeneous.media[0] =
        Medium { droplets: Some(12.5), g: 0.0, scale: 2.0, ..homogeneous.media[0].clone() };
    homogeneous.shapes[0].sides = Some(Sides { inside: Some(MediumId(1)), outside: Some(MediumId(0)) });
    let mut two_lobes = homogeneous.clone();
    let draine = Some(DraineLobe { g: -0.5, alpha: 2.0, share: 0.25 });
    two_lobes.media[0] = Medium { droplets: None, g: 0.75, draine, ..two_lobes.media[0].clone() };
    scenes.push(("medium of droplets".to_owned(), homogeneous));
    scenes.push(("medium of two lobes".to_owned(), two_lobes));
    let mut vacuum = base();
    vacuum.shapes[0].sides = Some(Sides { inside: None, outside: None });
    scenes.push(("vacuum".to_owned(), vacuum));
    scenes
}
