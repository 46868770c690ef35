//! Tables of half vectors that are filled with a BRDF of a formula.

use std::f32::consts::PI;

use glam::Vec3;

use super::*;
use crate::shading::bsdf::lanes::LaneBsdf;
use crate::shading::bsdf::measured::{Measured, MeasuredTables};
use lookfrom_scene::measured as written;

/// Trowbridge and Reitz's distribution of normals without shadowing, for a colour: of half vector and light.
fn gloss(alpha: f64, cos_h: f64, cos_d: f64) -> f64 {
    let a = alpha * alpha;
    let bottom = cos_h * cos_h * (a - 1.0) + 1.0;
    let fresnel = 0.1 + 0.9 * (1.0 - cos_d).powi(5);
    a / (std::f64::consts::PI * bottom * bottom) * fresnel / 4.0
}

/// The cells of MERL, with the value of the formula in the middle of each.
fn filled(alpha: f64) -> written::Measured {
    let counts = [90, 90, 180];
    let quarter = std::f64::consts::FRAC_PI_2;
    let value = |cell: usize| {
        let (h, d) = ((cell / (90 * 180)) as f64 + 0.5, (cell / 180 % 90) as f64 + 0.5);
        let value = gloss(alpha, (quarter * (h / 90.0).powi(2)).cos(), (quarter * d / 90.0).cos()) as f32;
        [value, 0.5 * value, 0.25 * value]
    };
    let values = (0..counts.iter().product()).map(value).collect();
    let tables = written::Tables::HalfAngle(HalfAngle { counts, values });
    written::Measured { tables, digest: format!("gloss of {alpha}") }
}

fn number(seed: u64) -> f32 {
    (crate::core::hash::mix(seed) >> 40) as f32 / (1 << 24) as f32
}

fn above(seed: u64) -> Vec3 {
    let (sin_phi, cos_phi) = sin_cos_of_turns(number(seed));
    let z = 0.1 + 0.9 * number(seed + 1);
    let r = (1.0 - z * z).sqrt();
    Vec3::new(r * cos_phi, r * sin_phi, z)
}

#[test]
fn directions_have_the_values_of_the_formula() {
    let written = filled(0.3);
    let written::Tables::HalfAngle(tables) = &written.tables else { panic!("other tables") };
    let tables = HalfAngleValues::new(tables);
    for index in 0..20_000 {
        let (wo, wi) = (above(4 * index), above(4 * index + 2));
        let wm = (wo + wi).normalize();
        let expected = gloss(0.3, f64::from(wm.z), f64::from(wm.dot(wi))) as f32;
        let [r, g, b] = tables.between(place(wo.into(), wi.into()));
        // Half a degree beside 90 is the most that a line between two cells is off the curve.
        assert!((r - expected).abs() < 0.01 * expected + 1e-4, "{wo} {wi}: {r}, expected {expected}");
        assert!((g - 0.5 * r).abs() < 1e-6 * r && (b - 0.25 * r).abs() < 1e-6 * r);
    }
}

/// Sampling costs little noise where the density is made of the table: the weights of samples vary less than by a half.
#[test]
fn densities_follow_the_tables() {
    for alpha in [0.05, 0.2, 0.6] {
        let tables = MeasuredTables::kept(&filled(alpha), &[]);
        let bsdf = Measured::new(tables, None);
        for wo in [Vec3::Z, direction(0.7).into(), direction(1.2).into()] {
            let weights: Vec<f32> = (0..4000)
                .map(|index| {
                    let u = [number(7 + 2 * index), number(8 + 2 * index)];
                    let sample = bsdf.sample(&bsdf.prepare(wo.into()), 0.0, u);
                    if sample.is_valid { sample.f.0[0] * sample.wi.z / sample.pdf } else { 0.0 }
                })
                .collect();
            let mean = weights.iter().sum::<f32>() / weights.len() as f32;
            let variance =
                weights.iter().map(|weight| (weight - mean).powi(2)).sum::<f32>() / weights.len() as f32;
            assert!(variance.sqrt() < 0.5 * mean, "α {alpha}, {wo}: {mean} ± {}", variance.sqrt());
        }
    }
}

#[test]
fn tables_without_light_are_sampled_all_the_same() {
    let tables = written::Tables::HalfAngle(HalfAngle { counts: [3, 2, 1], values: vec![[0.0; 3]; 6] });
    let written = written::Measured { tables, digest: "black".into() };
    let bsdf = Measured::new(MeasuredTables::kept(&written, &[]), Some([400.0, 500.0, 600.0, 700.0]));
    let sample = bsdf.sample(&bsdf.prepare(Vec3::Z.into()), 0.0, [0.3, 0.4]);
    assert!(sample.is_valid);
    assert_eq!(sample.f.0, [0.0; 4]);
    assert!(sample.pdf > 0.0 && sample.pdf < 4.0 * PI);
}
