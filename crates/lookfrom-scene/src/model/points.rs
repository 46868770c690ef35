//! Point clouds as spheres.
//!
//! The radius follows from the distances between points. Spheres of one part share a material, so coloured clouds are
//! split by colour.

use std::collections::BTreeMap;

use glam::{DVec3, Vec3};

use super::surface::push_material;
use super::tally::Tally;
use crate::error::Location;
use crate::files::LoadContext;
use crate::material::{Color, Whitted};
use crate::scene::Scene;
use crate::shape::{Geometry, Part, Sphere};

/// Number of steps per primary by which coloured points are split.
const COLOR_STEPS: f32 = 8.0;

/// Number of points whose nearest neighbour is searched.
const SAMPLES: usize = 256;

/// Radius of the spheres relative to the distance of nearest neighbours: they overlap a little, so surfaces look closed.
const RADIUS: f64 = 0.7;

/// Spheres for points. `colors` are linear; there may be none, or too few: missing ones are white.
pub(crate) fn cloud(
    positions: &[Vec3],
    colors: &[[f32; 3]],
    file: &Location,
    context: &mut LoadContext<'_>,
    scene: &mut Scene,
) -> Vec<Part> {
    let mut dropped = Tally::default();
    dropped.add_many(positions.iter().filter(|point| !point.is_finite()).count() as u64, 0);
    dropped.warn("point", "left out: a coordinate is infinite or not a number", file, context);
    let finite = positions.iter().zip(0..).filter(|(point, _)| point.is_finite());
    let finite: Vec<(DVec3, usize)> = finite.map(|(point, index)| (point.as_dvec3(), index)).collect();
    if finite.is_empty() {
        return Vec::new();
    }
    let radius = radius(finite.iter().map(|&(point, _)| point).collect());
    let part = |points: &mut dyn Iterator<Item = DVec3>, material| Part {
        material,
        ..Part::new(None, Geometry::Spheres(points.map(|center| Sphere { center, radius }).collect()))
    };
    if colors.is_empty() {
        return vec![part(&mut finite.iter().map(|&(point, _)| point), None)];
    }
    // Split by colour; steps are finer in the dark, where the eye distinguishes more of them.
    let mut by_color: BTreeMap<[u8; 3], Vec<usize>> = BTreeMap::new();
    let color_of = |index: usize| colors.get(index).copied().unwrap_or([1.0; 3]);
    for (order, &(_, index)) in finite.iter().enumerate() {
        let step = color_of(index).map(|c| (c.clamp(0.0, 1.0).sqrt() * (COLOR_STEPS - 1.0) + 0.5) as u8);
        by_color.entry(step).or_default().push(order);
    }
    let parts = by_color.into_values().map(|members| {
        let sum = members.iter().fold(Vec3::ZERO, |sum, &i| sum + Vec3::from(color_of(finite[i].1)));
        let mean = sum / members.len() as f32;
        let whitted = Whitted { diffuse: Color::Value(mean.to_array()), ..Whitted::default() };
        let material = push_material(scene, "points", file, whitted);
        part(&mut members.iter().map(|&i| finite[i].0), Some(material))
    });
    parts.collect()
}

/// A radius for spheres around these points: a multiple of the median distance to the nearest neighbour.
fn radius(mut points: Vec<DVec3>) -> f64 {
    let (min, max) = points
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), &point| (min.min(point), max.max(point)));
    let axis = (max - min).max_position();
    points.sort_by(|a, b| a[axis].total_cmp(&b[axis]));
    points.dedup();
    // Sorted along the longest axis; points whose distance along it exceeds the best distance are not nearer.
    let nearest = |i: usize| {
        let mut best = f64::INFINITY;
        for &other in &points[i + 1..] {
            if other[axis] - points[i][axis] >= best {
                break;
            }
            best = best.min(closer(points[i], other));
        }
        for &other in points[..i].iter().rev() {
            if points[i][axis] - other[axis] >= best {
                break;
            }
            best = best.min(closer(points[i], other));
        }
        best
    };
    let step = points.len().div_ceil(SAMPLES);
    let mut distances: Vec<f64> =
        (0..points.len()).step_by(step).map(nearest).filter(|distance| distance.is_finite()).collect();
    distances.sort_by(f64::total_cmp);
    match distances.get(distances.len() / 2) {
        Some(median) => RADIUS * median,
        // All points coincide.
        None => Some(0.01 * max.abs().max_element()).filter(|&radius| radius > 0.0).unwrap_or(1.0),
    }
}

/// The distance between two points; infinite for coincident points, which do not count as neighbours.
fn closer(a: DVec3, b: DVec3) -> f64 {
    if a == b { f64::INFINITY } else { a.distance(b) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_grid_has_its_spacing() {
        for scale in [1e-6, 1.0, 1e9] {
            let grid = (0..1000)
                .map(|i| scale * DVec3::new((i % 10) as f64, (i / 10 % 10) as f64, (i / 100) as f64));
            assert!((radius(grid.collect()) / (RADIUS * scale) - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn a_single_place_has_a_radius() {
        assert_eq!(radius(vec![DVec3::ZERO; 3]), 1.0);
        assert_eq!(radius(vec![DVec3::splat(-200.0); 3]), 2.0);
    }

    proptest! {
        #[test]
        fn agrees_with_all_pairs(points in prop::collection::vec((-9..9, -9..9, -9..9), 2..60), scale in -20..20) {
            let scale = 2_f64.powi(scale);
            let points: Vec<DVec3> = points.iter().map(|&(x, y, z)| scale * DVec3::new(x as f64, y as f64, z as f64)).collect();
            let mut unique = points.clone();
            unique.sort_by(|a, b| a.to_array().partial_cmp(&b.to_array()).unwrap());
            unique.dedup();
            prop_assume!(unique.len() > 1 && unique.len() == points.len());
            let mut all: Vec<f64> = unique.iter().map(|&a| {
                unique.iter().map(|&b| closer(a, b)).fold(f64::INFINITY, f64::min)
            }).collect();
            all.sort_by(f64::total_cmp);
            prop_assert_eq!(radius(points), RADIUS * all[all.len() / 2]);
        }
    }
}
