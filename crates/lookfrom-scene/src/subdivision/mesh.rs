//! Cages of triangles: those of readers that know no polygons.
//!
//! Programs write a quadrilateral as two triangles, one after the other: such pairs become one face again.

use glam::{DVec3, Vec2, Vec3};

use super::{Cage, Refined};
use crate::model::weld::Weld;
use crate::shape::Mesh;

/// Cosine of the greatest angle between the two triangles of a quadrilateral: 60°.
const LEAST_COSINE: f64 = 0.5;

/// Replaces a mesh by the limit surface of its cage after some levels, with its normals. Tangents are left out.
pub(super) fn replace(mesh: &mut Mesh, cage: &Cage, levels: u32) {
    let refined = cage.subdivided(levels);

    // Corners with the same vertex and the same values are one vertex of the mesh.
    let mut ids = refined.corners.clone();
    for k in 0..cage.width {
        let mut weld = Weld::new();
        for (corner, id) in ids.iter_mut().enumerate() {
            *id = weld.id([*id, refined.values[corner * cage.width + k].to_bits()]);
        }
    }
    let mut weld = Weld::new();
    let mut corner_of: Vec<usize> = Vec::new();
    for (corner, id) in ids.iter_mut().enumerate() {
        *id = weld.id([*id]);
        if *id as usize == corner_of.len() {
            corner_of.push(corner);
        }
    }
    let mut columns = Columns { refined: &refined, width: cage.width, corner_of: &corner_of, next: 0 };
    columns.replace(&mut mesh.uvs, |[u, v]| Vec2::new(u, v));
    mesh.more_uvs.iter_mut().for_each(|uvs| columns.replace(uvs, |[u, v]| Vec2::new(u, v)));
    columns.replace(&mut mesh.colors, |color: [f32; 3]| color);
    columns.replace(&mut mesh.opacities, |[opacity]| opacity);
    let vertices = || corner_of.iter().map(|&corner| refined.corners[corner] as usize);
    mesh.positions = vertices().map(|vertex| refined.positions[vertex]).collect();
    mesh.normals = vertices().map(|vertex| refined.normals[vertex]).collect();
    mesh.tangents = Vec::new();
    let quads = ids.chunks_exact(4);
    mesh.triangles =
        quads.flat_map(|quad| [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]).collect();
}

/// The values of corners as those of a mesh's vertices, in the order in which `cage` puts them together.
struct Columns<'a> {
    refined: &'a Refined,
    width: usize,
    /// A corner of each vertex.
    corner_of: &'a [usize],
    next: usize,
}

impl Columns<'_> {
    /// Replaces the values of a kind, if there are any.
    fn replace<T, const N: usize>(&mut self, values: &mut Vec<T>, of: impl Fn([f32; N]) -> T) {
        if values.is_empty() {
            return;
        }
        let at = |corner: &usize| {
            let first = corner * self.width + self.next;
            of(std::array::from_fn(|k| self.refined.values[first + k]))
        };
        *values = self.corner_of.iter().map(at).collect();
        self.next += N;
    }
}

/// The cage of a mesh, in which vertices at the same place are one.
pub(super) fn cage(mesh: &Mesh) -> Cage {
    let mut weld = Weld::new();
    let vertices: Vec<u32> =
        mesh.positions.iter().map(|at| weld.id((*at + 0.0).to_array().map(f32::to_bits))).collect();
    let position = |key: &[u32; 3]| Vec3::from(key.map(f32::from_bits)).as_dvec3();
    let mut cage = Cage { positions: weld.keys().iter().map(position).collect(), ..Cage::default() };
    let of_vertex = |vertex: u32| {
        let vertex = vertex as usize;
        let uvs = [&mesh.uvs].into_iter().chain(&mesh.more_uvs).filter_map(move |uvs| uvs.get(vertex));
        let uvs = uvs.flat_map(Vec2::to_array);
        uvs.chain(mesh.colors.get(vertex).into_iter().flatten().copied())
            .chain(mesh.opacities.get(vertex).copied())
    };
    cage.width = of_vertex(0).count();
    let mut left = &mesh.triangles[..];
    while let [triangle, rest @ ..] = left {
        let quad = rest.first().and_then(|next| quad(mesh, &vertices, triangle, next));
        let face = quad.as_ref().map_or(&triangle[..], |quad| &quad[..]);
        left = if quad.is_some() { &rest[1..] } else { rest };
        let at = |i: usize| vertices[face[i % face.len()] as usize];
        if (0..face.len()).any(|i| at(i) == at(i + 1)) {
            continue;
        }
        for &vertex in face {
            cage.corners.push(vertices[vertex as usize]);
            cage.values.extend(of_vertex(vertex));
        }
        cage.end_face(0);
    }
    cage
}

/// The quadrilateral that two triangles make: they share a side, its corners are four, it is convex, and nearly flat.
fn quad(mesh: &Mesh, vertices: &[u32], a: &[u32; 3], b: &[u32; 3]) -> Option<[u32; 4]> {
    let id = |vertex: u32| vertices[vertex as usize];
    let at = |vertex: u32| mesh.positions[vertex as usize].as_dvec3();
    let side = |t: &[u32; 3], k: usize| [t[k % 3], t[(k + 1) % 3]];
    let (i, j) = (0..9).map(|k| (k / 3, k % 3)).find(|&(i, j)| {
        side(a, i) == {
            let [x, y] = side(b, j);
            [y, x]
        }
    })?;
    // From the corner of the first that the second lacks: it, the side's first end, the other corner, the second end.
    let quad = [a[(i + 2) % 3], a[i], b[(j + 2) % 3], a[(i + 1) % 3]];
    if id(quad[0]) == id(quad[2]) {
        return None;
    }
    let normal = |t: &[u32; 3]| (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).normalize_or_zero();
    let (of_a, of_b): (DVec3, DVec3) = (normal(a), normal(b));
    let turn = |k: usize| {
        let [p, q, r] = [k, k + 1, k + 2].map(|k| at(quad[k % 4]));
        (q - p).cross(r - q).dot(of_a + of_b)
    };
    (of_a.dot(of_b) >= LEAST_COSINE && (0..4).all(|k| turn(k) > 0.0)).then_some(quad)
}
