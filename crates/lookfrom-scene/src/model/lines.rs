//! Lines as thin wires.

use glam::Vec3;

use super::points;
use crate::scene::Bounds;
use crate::shape::{Geometry, Profile, Strand};

/// The radius of lines, relative to that of the sphere around them.
const THINNESS: f64 = 0.004;

/// Wires along lines, a group for each colour where there is one for each line.
pub(crate) fn wires(lines: &[[Vec3; 2]], colors: &[[f32; 3]]) -> Vec<(Option<[f32; 3]>, Geometry)> {
    let width = width(lines.iter().copied());
    if colors.len() != lines.len() {
        return vec![(None, Geometry::Curves(lines.iter().map(|&line| strand(line, width)).collect()))];
    }
    let groups = points::by_color(colors).into_iter();
    let wires = |members: Vec<usize>| members.iter().map(|&line| strand(lines[line], width)).collect();
    groups.map(|(color, members)| (Some(color), Geometry::Curves(wires(members)))).collect()
}

/// The width of wires for these lines.
fn width(lines: impl Iterator<Item = [Vec3; 2]>) -> f32 {
    let ends = lines.flatten().map(Vec3::as_dvec3);
    let bounds = ends.fold(Bounds::EMPTY, Bounds::with);
    let size = if bounds.radius() > 0.0 { bounds.radius() } else { bounds.center().abs().max_element() };
    let radius = THINNESS * size;
    let is_usable = radius.is_normal() && (radius as f32).is_normal();
    (2.0 * if is_usable { radius } else { THINNESS }) as f32
}

/// A wire along a line.
fn strand([a, b]: [Vec3; 2], width: f32) -> Strand {
    Strand {
        points: [a, a.lerp(b, 1.0 / 3.0), a.lerp(b, 2.0 / 3.0), b],
        width: [width; 2],
        profile: Profile::Cylinder,
    }
}
