//! Tests whether points are inside: by the parity of a ray's crossings where meshes are closed, and by the generalised winding number
//! (Jacobson, Kavan, Sorkine-Hornung 2013) where they are not.
//!
//! The winding number is what a ray crosses, with signs, and the solid angles of triangles between the boundary's edges and the
//! opposite direction: a cone that closes the mesh as the ray cannot see (Martens & Bessmeltsev 2025, "One-Shot Method for
//! Computing Generalized Winding Numbers"). So a point costs a ray and the boundary, not the mesh.

use std::f64::consts::PI;

use lookfrom_bvh::{Faces, Hit};

use super::chunk::{WorldRay, prepare};
use super::frame::{cross, dot, subtract, times};
use super::geometry::Geometry;
use super::refine::refine;
use super::tree::{Selection, Tree};

/// The boundary of all triangles of a tree.
#[derive(Debug)]
pub(super) enum Boundary {
    /// There is none: each edge belongs to an even number of triangles.
    Closed,
    /// There is one.
    Open(Vec<BoundaryEdge>),
    /// There is one in an instance, or beside spheres or instances, for which there is no rule.
    OpenBesideOthers,
}

/// An edge that triangles pass more often in one direction than in the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoundaryEdge {
    /// In the frame, as rounded for the kernel, so that the kernel's ray passes on the same side of it.
    ends: [[f64; 3]; 2],
    times: f64,
}

/// Directions of the rays: along no axis or diagonal. The later ones are for points from which an edge of the boundary lies in
/// the direction of the earlier.
const DIRECTIONS: [[f64; 3]; 4] = [
    [0.439_506_1, 0.117_598_6, 0.891_231_5],
    [-0.353_144_9, 0.871_302_7, 0.341_179_3],
    [0.913_377_1, -0.291_883_3, -0.283_790_9],
    [-0.197_121_9, -0.577_934_1, -0.791_910_3],
];

/// Sines of angles less than this may be 0: 2⁻⁴⁰.
const UNCLEAR: f64 = 9.094_947_017_729_282e-13;

const EVERYTHING: Selection = Selection { mask: None, faces: Faces::Both };

impl Tree {
    /// The tree's boundary, found at the first call.
    pub(super) fn boundary(&self) -> &Boundary {
        self.boundary.get_or_init(|| {
            let (mut vertices, mut faces, mut others) = (Vec::new(), Vec::new(), !self.instances.is_empty());
            for part in &self.parts {
                match &part.geometry {
                    Geometry::Triangles { vertices: more, faces: of_them } => {
                        let first = vertices.len() as u32;
                        vertices.extend(more.iter().map(|&p| self.frame.rounded(p)));
                        faces.extend(of_them.iter().map(|face| face.map(|index| first + index)));
                    }
                    Geometry::Spheres { .. } => others = true,
                }
            }
            let is_closed =
                |instance: &super::geometry::Instance| matches!(instance.tree.boundary(), Boundary::Closed);
            if !self.instances.iter().all(is_closed) {
                return Boundary::OpenBesideOthers;
            }
            let unmatched = unmatched_edges(&faces).and_then(|_| {
                weld(&vertices, &mut faces);
                unmatched_edges(&faces)
            });
            match unmatched {
                None => Boundary::Closed,
                Some(_) if others => Boundary::OpenBesideOthers,
                Some(edges) => {
                    let place = |index: u32| vertices[index as usize].map(f64::from);
                    let edge =
                        |([a, b], times): ([u32; 2], f64)| BoundaryEdge { ends: [place(a), place(b)], times };
                    Boundary::Open(edges.into_iter().map(edge).collect())
                }
            }
        })
    }

    /// True if a point is inside of the closed meshes and spheres of an odd number of which it is inside; `hits` is memory.
    pub(super) fn contains_by_parity(&self, point: [f64; 3], hits: &mut Vec<Hit>) -> bool {
        let is_near = self.bounds().is_some_and(|bounds| bounds.contain(point));
        is_near && self.crossings(point, DIRECTIONS[0], EVERYTHING, hits) % 2 == 1
    }

    /// The winding number of open meshes around a point.
    pub(super) fn winding_number(
        &self,
        point: [f64; 3],
        boundary: &[BoundaryEdge],
        hits: &mut Vec<Hit>,
    ) -> f64 {
        let mut winding = 0.0;
        for direction in DIRECTIONS {
            let (angle, is_clear) = self.solid_angle(point, direction, boundary);
            let mut count =
                |faces| self.crossings(point, direction, Selection { mask: None, faces }, hits) as f64;
            winding = count(Faces::Back) - count(Faces::Front) + angle / (4.0 * PI);
            if is_clear {
                break;
            }
        }
        winding
    }

    /// Number of surfaces that a ray crosses.
    fn crossings(
        &self,
        origin: [f64; 3],
        direction: [f64; 3],
        selection: Selection,
        hits: &mut Vec<Hit>,
    ) -> usize {
        let (kernels, relation) = prepare(self, origin, direction, [0.0, f64::INFINITY], false);
        selection.of(&self.bvh).crossings(&kernels, hits);
        let ray = WorldRay { origin, direction };
        let is_ahead =
            |hit: &&Hit| relation.is_surely_inside(hit.t) || refine(self, &ray, &relation, hit).t > 0.0;
        hits.iter().filter(is_ahead).count()
    }

    /// The solid angle, with signs, of the triangles between edges and the point at infinity opposite to a direction: van
    /// Oosterom, Strackee (1983), "The Solid Angle of a Plane Triangle". False if the direction may lead to an edge.
    fn solid_angle(&self, point: [f64; 3], direction: [f64; 3], boundary: &[BoundaryEdge]) -> (f64, bool) {
        let (kernels, relation) = prepare(self, point, direction, [0.0, f64::INFINITY], false);
        let [start, d] = [kernels.origin, kernels.direction].map(|v| v.map(f64::from));
        let [first, _] = relation.range();
        let from = [0, 1, 2].map(|axis| start[axis] + first * d[axis]);
        let back = times(d, -1.0 / dot(d, d).sqrt());
        let (mut sum, mut is_clear) = (0.0, true);
        for edge in boundary {
            let [a, b] = edge.ends.map(|p| subtract(p, from));
            let [length_a, length_b] = [a, b].map(|v| dot(v, v).sqrt());
            let y = dot(back, cross(a, b));
            let x = length_a * length_b + dot(back, a) * length_b + dot(back, b) * length_a + dot(a, b);
            is_clear &= x > 0.0 || y.abs() > UNCLEAR * length_a * length_b;
            sum += edge.times * 2.0 * y.atan2(x);
        }
        (sum, is_clear)
    }
}

/// The edges that triangles pass more often in one direction than in the other, with the difference; `None` if each edge belongs
/// to an even number of triangles.
fn unmatched_edges(faces: &[[u32; 3]]) -> Option<Vec<([u32; 2], f64)>> {
    let mut edges: Vec<([u32; 2], bool)> = Vec::with_capacity(3 * faces.len());
    for &[a, b, c] in faces {
        for [p, q] in [[a, b], [b, c], [c, a]] {
            if p != q {
                edges.push(([p.min(q), p.max(q)], p < q));
            }
        }
    }
    edges.sort_unstable();
    let groups = || edges.chunk_by(|a, b| a.0 == b.0);
    if groups().all(|group| group.len() % 2 == 0) {
        return None;
    }
    let times = |group: &[([u32; 2], bool)]| group.iter().map(|edge| if edge.1 { 1.0 } else { -1.0 }).sum();
    Some(groups().map(|group| (group[0].0, times(group))).filter(|edge| edge.1 != 0.0).collect())
}

/// Makes faces refer to the first of several vertices in one place.
fn weld(vertices: &[[f32; 3]], faces: &mut [[u32; 3]]) {
    // A zero is a zero, whatever its sign.
    let key = |index: &u32| vertices[*index as usize].map(|x| (x + 0.0).to_bits());
    let mut order: Vec<u32> = (0..vertices.len() as u32).collect();
    order.sort_unstable_by_key(|index| (key(index), *index));
    let mut first = vec![0; vertices.len()];
    for group in order.chunk_by(|a, b| key(a) == key(b)) {
        group.iter().for_each(|&index| first[index as usize] = group[0]);
    }
    faces.iter_mut().flatten().for_each(|index| *index = first[*index as usize]);
}
