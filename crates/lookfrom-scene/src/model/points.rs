//! Point clouds as spheres.
//!
//! The radius follows from the distances between points. Spheres of one part share a material, so coloured clouds are
//! split by colour: into at most [`MOST_COLORS`] boxes of colours (median cut, Heckbert 1982), each with its mean.

use glam::{DVec3, Vec3};

use super::surface::push_material;
use super::tally::Tally;
use crate::error::Location;
use crate::files::LoadContext;
use crate::material::{Color, Whitted};
use crate::scene::Scene;
use crate::shape::{Geometry, Part, Sphere};

/// Number of different colours.
const MOST_COLORS: usize = 512;

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
    let centers: Vec<DVec3> = finite.iter().map(|&(point, _)| point).collect();
    let color_of = |&(_, index): &(DVec3, usize)| colors.get(index).copied().unwrap_or([1.0; 3]);
    let colors: Vec<[f32; 3]> =
        if colors.is_empty() { Vec::new() } else { finite.iter().map(color_of).collect() };
    let part = |(color, geometry): (Option<[f32; 3]>, Geometry)| {
        let material = color.map(|color| {
            let whitted = Whitted { diffuse: Color::Value(color), ..Whitted::default() };
            push_material(scene, "points", file, whitted)
        });
        Part { material, ..Part::new(None, geometry) }
    };
    spheres(&centers, &colors).into_iter().map(part).collect()
}

/// Spheres around finite points, at least one; a group for each colour where there is one for each point.
pub(crate) fn spheres(centers: &[DVec3], colors: &[[f32; 3]]) -> Vec<(Option<[f32; 3]>, Geometry)> {
    let radius = radius(centers.to_vec());
    if colors.len() != centers.len() {
        let spheres = centers.iter().map(|&center| Sphere { center, radius }).collect();
        return vec![(None, Geometry::Spheres(spheres))];
    }
    let spheres =
        |members: Vec<usize>| members.iter().map(|&i| Sphere { center: centers[i], radius }).collect();
    let groups = by_color(colors).into_iter();
    groups.map(|(color, members)| (Some(color), Geometry::Spheres(spheres(members)))).collect()
}

/// Groups of points or lines of similar colours: the mean colour of each, and its members in their order.
pub(super) fn by_color(colors: &[[f32; 3]]) -> Vec<([f32; 3], Vec<usize>)> {
    let grouped = boxes((0..colors.len()).collect(), &|i| colors[i]).into_iter().map(|mut members| {
        members.sort_unstable();
        let sum = members.iter().fold(Vec3::ZERO, |sum, &i| sum + Vec3::from(colors[i]));
        ((sum / members.len() as f32).to_array(), members)
    });
    grouped.collect()
}

/// Splits points by colour. The box that is widest, as the eye sees it, is split at its middle colour again and again.
fn boxes(points: Vec<usize>, color_of: &impl Fn(usize) -> [f32; 3]) -> Vec<Vec<usize>> {
    // Steps are finer in the dark, where the eye distinguishes more of them.
    let seen = |point: usize, channel: usize| color_of(point)[channel].max(0.0).sqrt();
    let widest = |points: &[usize]| {
        let width = |channel: usize| {
            let range = points.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &point| {
                (low.min(seen(point, channel)), high.max(seen(point, channel)))
            });
            range.1 - range.0
        };
        let widths = [width(0), width(1), width(2)];
        let channel = (0..3).fold(0, |best, other| if widths[other] > widths[best] { other } else { best });
        (widths[channel], channel)
    };
    let measured = |points: Vec<usize>| (widest(&points), points);
    let mut boxes = vec![measured(points)];
    while boxes.len() < MOST_COLORS {
        let widths = boxes.iter().map(|((width, _), points)| width * (points.len() as f32).cbrt());
        let Some((index, _)) = widths.enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b)) else { break };
        let ((width, channel), points) = &mut boxes[index];
        if *width == 0.0 {
            break;
        }
        let channel = *channel;
        points.sort_by(|&a, &b| seen(a, channel).total_cmp(&seen(b, channel)));
        // Equal colours stay together: the first of them that leaves two boxes with points.
        let middle = seen(points[points.len() / 2], channel);
        let below = points.partition_point(|&point| seen(point, channel) < middle);
        let split =
            if below > 0 { below } else { points.partition_point(|&point| seen(point, channel) <= middle) };
        let upper = points.split_off(split);
        let lower = std::mem::take(points);
        boxes[index] = measured(lower);
        boxes.push(measured(upper));
    }
    boxes.into_iter().map(|(_, points)| points).collect()
}

/// A radius for spheres around finite points: a multiple of the median distance to the nearest neighbour.
pub(crate) fn radius(mut points: Vec<DVec3>) -> f64 {
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
    fn few_colours_stay_as_they_are_and_many_are_close() {
        let few: Vec<[f32; 3]> =
            (0..1000).map(|i| [(i % 7) as f32 / 6.0, 0.5, (i % 3) as f32 / 2.0]).collect();
        let split = boxes((0..few.len()).collect(), &|i| few[i]);
        assert_eq!(split.len(), 21);
        assert!(split.iter().all(|points| points.iter().all(|&i| few[i] == few[points[0]])));

        let many: Vec<[f32; 3]> = (0..20_000_u32)
            .map(|i| [i % 31, i % 29, i % 23].map(|step| (step as f32 / 31.0).powi(2)))
            .collect();
        let split = boxes((0..many.len()).collect(), &|i| many[i]);
        assert_eq!(split.len(), MOST_COLORS);
        assert_eq!(split.iter().map(Vec::len).sum::<usize>(), many.len());
        for points in split {
            let mean = points.iter().map(|&i| Vec3::from(many[i])).sum::<Vec3>() / points.len() as f32;
            for i in points {
                let step = mean.to_array().map(f32::sqrt);
                assert!((0..3).all(|c| (many[i][c].sqrt() - step[c]).abs() < 0.16), "{:?} {mean}", many[i]);
            }
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
