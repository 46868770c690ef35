//! The BSDF that CONTRIBUTING.md adds: its file, and its row in a table.

use glam::Vec3;

use super::clay::Clay;
use super::uniform_direction;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::shading::bsdf::lanes::{ClassTraits, LaneBsdf};
use crate::shading::bsdf::one::{PreparedBsdf, scattering_functions};
use crate::shading::bsdf::{DirectionSample, ScatteringFunction, is_grazing};

scattering_functions! {
    /// A table with one row.
    Extended
    lanes {}
    wholes {}
    one_by_one {
        /// Rough matte surfaces.
        Clay(Clay),
    }
}

fn clay(sigma: f32) -> Extended {
    Extended::Clay(Clay { reflectance: Spectrum([0.8; 4]), sigma })
}

fn value(bsdf: &Extended, wo: Vec3, wi: Vec3) -> f32 {
    bsdf.f(&bsdf.prepare(wo.into()), wi.into()).0[0]
}

/// The midpoints of a grid of numbers in [0, 1)².
fn grid() -> impl Iterator<Item = [f32; 2]> {
    let at = |k: usize| (k as f32 + 0.5) / 64.0;
    (0..64).flat_map(move |i| (0..64).map(move |j| [at(i), at(j)]))
}

#[test]
fn a_row_makes_it_a_bsdf() {
    let mut bsdf = clay(0.5);
    bsdf.class_mut().regularize();
    assert_eq!(bsdf.class().description().kind, "clay");
    let [a, b] = [[0.1, 0.7], [0.4, 0.2]].map(|u| uniform_direction(u).with_z(0.3).normalize());
    let f = |wo, wi| value(&bsdf, wo, wi);
    assert!((f(a, b) - f(b, a)).abs() < 1e-6);
    // Without roughness it is Lambert's.
    assert!((value(&clay(0.0), a, b) - 0.8 / std::f32::consts::PI).abs() < 1e-6);
}

#[test]
fn its_samples_add_up_to_its_albedo() {
    for (sigma, wo) in [(0.2, Vec3::Z), (0.6, Vec3::new(0.8, 0.0, 0.6)), (1.0, Vec3::new(0.0, -0.6, -0.8))] {
        let bsdf = clay(sigma);
        let sampled: f32 = grid()
            .map(|u| bsdf.sample(&bsdf.prepare(wo.into()), 0.0, u))
            .filter(|sample| sample.is_valid)
            .map(|sample| sample.f.0[0] * sample.wi.z.abs() / sample.pdf)
            .sum();
        let integral: f32 = grid()
            .map(|u| (uniform_direction(u), 4.0 * std::f32::consts::PI))
            .map(|(wi, area)| value(&bsdf, wo, wi) * wi.z.abs() * area)
            .sum();
        let [sampled, integral] = [sampled, integral].map(|sum| sum / 4096.0);
        assert!((sampled - integral).abs() < 2e-3, "{sigma}: {sampled} {integral}");
        assert!(0.5 < sampled && sampled < 0.81, "{sigma}: {sampled}");
    }
}

#[test]
fn contributing_shows_this_file() {
    let text = include_str!("../../../../../../CONTRIBUTING.md");
    assert!(text.contains(include_str!("clay.rs")), "the block of CONTRIBUTING.md is not tests/clay.rs");
}
