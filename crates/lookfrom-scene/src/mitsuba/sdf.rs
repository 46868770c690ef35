//! Surfaces of grids of signed distances, as meshes: the zeros of the trilinear interpolant, by marching tetrahedra (Doi & Koide 1991) in
//! cells that are divided.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use super::Reader;
use super::plugin::Plugin;
use super::volume::Lattice;
use crate::error::{Error, ErrorKind, Result};
use crate::shape::Mesh;

/// Parts along each side of a cell.
const PARTS: u32 = 4;

/// Largest number of divided cells: coordinates of their corners fit in 21 bits each.
const MOST: u32 = 1 << 20;

/// Bytes that a cell with a part of the surface takes while it is made: of 100 triangles or so.
const CELL: u64 = 8 << 10;

/// Tetrahedra of a cube around its diagonal, by corners, whose bits are x, y and z.
const TETRAHEDRA: [[u32; 4]; 6] =
    [[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]];

impl Reader<'_, '_> {
    /// The surface of an `sdfgrid`, in the unit cube.
    pub(super) fn sdf_surface(&mut self, plugin: &Plugin) -> Result<Mesh> {
        plugin.ignore(&["normals"]);
        let (path, at) = self.file(plugin)?;
        self.warn_once(&plugin.at, "an sdfgrid is a mesh, with four triangles or more along each cell");
        let lattice = self.volume_grid(&path, &at, f32::NEG_INFINITY)?.lattice;
        let too_large = |size: &u32| !(2..MOST / PARTS).contains(size);
        if lattice.channels != 1 || lattice.size.iter().any(too_large) {
            let message = format!("a grid of {:?} numbers with {} channels", lattice.size, lattice.channels);
            return Err(Error::invalid(&at, message)
                .hint("an sdfgrid has one channel, and two numbers at least along each axis"));
        }
        let cells = crossing_cells(&lattice).count() as u64;
        let _making = self.context.budget.reserve(cells * CELL, "the surface of the distances", &at)?;
        let surface = surface(&lattice);
        if surface.triangles.is_empty() {
            return Err(Error::new(
                ErrorKind::Invalid,
                &at,
                "the numbers of this grid have no zero: it has no surface",
            ));
        }
        self.context.keep(surface.bytes(), "a surface of distances", &at)?;
        Ok(surface)
    }
}

/// The cells with values of both signs at their corners, and those values.
fn crossing_cells(lattice: &Lattice) -> impl Iterator<Item = ([u32; 3], [f64; 8])> {
    let [x, y, z] = lattice.size.map(|points| points - 1);
    let cells = (0..z).flat_map(move |z| (0..y).flat_map(move |y| (0..x).map(move |x| [x, y, z])));
    let with_corners = cells.map(|cell| {
        let corners = std::array::from_fn(|corner| {
            let at = std::array::from_fn(|axis| i64::from(cell[axis] + (corner as u32 >> axis & 1)));
            f64::from(lattice.cell(at)[0])
        });
        (cell, corners)
    });
    with_corners.filter(|(_, corners)| {
        corners.iter().any(|value| *value < 0.0) && corners.iter().any(|value| *value >= 0.0)
    })
}

/// The zeros of a lattice whose values are at the corners of cells; values below 0 are inside.
fn surface(lattice: &Lattice) -> Mesh {
    let cells = lattice.size.map(|points| points - 1);
    let scale = DVec3::from_array(cells.map(|count| 1.0 / f64::from(count * PARTS)));
    let mut vertices: HashMap<[u64; 2], u32> = HashMap::new();
    let mut mesh = Mesh { name: "sdfgrid".into(), ..Mesh::default() };
    for (cell, corners) in crossing_cells(lattice) {
        let value = |point: [u32; 3]| {
            let [x, y, z] =
                std::array::from_fn(|axis| f64::from(point[axis] - PARTS * cell[axis]) / f64::from(PARTS));
            let along = |first: usize| corners[first] + (corners[first + 1] - corners[first]) * x;
            let [a, b, c, d] = [along(0), along(2), along(4), along(6)];
            let (near, far) = (a + (b - a) * y, c + (d - c) * y);
            near + (far - near) * z
        };
        for part in 0..PARTS.pow(3) {
            let step = [part % PARTS, part / PARTS % PARTS, part / PARTS / PARTS];
            let first: [u32; 3] = std::array::from_fn(|axis| PARTS * cell[axis] + step[axis]);
            let points: [[u32; 3]; 8] = std::array::from_fn(|corner| {
                std::array::from_fn(|axis| first[axis] + (corner as u32 >> axis & 1))
            });
            let values = points.map(value);
            for tetrahedron in TETRAHEDRA {
                let of = tetrahedron.map(|corner| (points[corner as usize], values[corner as usize]));
                let (inside, outside): (Vec<_>, Vec<_>) = of.into_iter().partition(|(_, value)| *value < 0.0);
                let mut crossing = |i: usize, o: usize| {
                    let ((a, value_a), (b, value_b)) = (inside[i], outside[o]);
                    *vertices.entry([place(a), place(b)]).or_insert_with(|| {
                        let [a, b] = [a, b].map(|point| DVec3::from_array(point.map(f64::from)));
                        let position = (a + (b - a) * (value_a / (value_a - value_b))) * scale;
                        mesh.positions.push(position.as_vec3());
                        mesh.positions.len() as u32 - 1
                    })
                };
                let polygon: Vec<u32> = match (inside.len(), outside.len()) {
                    (1, 3) => vec![crossing(0, 0), crossing(0, 1), crossing(0, 2)],
                    (3, 1) => vec![crossing(0, 0), crossing(1, 0), crossing(2, 0)],
                    (2, 2) => vec![crossing(0, 0), crossing(0, 1), crossing(1, 1), crossing(1, 0)],
                    _ => continue,
                };
                let middle = |of: &[([u32; 3], f64)]| {
                    let sum: DVec3 =
                        of.iter().map(|(point, _)| DVec3::from_array(point.map(f64::from))).sum();
                    sum / of.len() as f64
                };
                let outward = ((middle(&outside) - middle(&inside)) * scale).as_vec3();
                for corner in 2..polygon.len() {
                    let triangle = [polygon[0], polygon[corner - 1], polygon[corner]];
                    push(&mut mesh, triangle, outward);
                }
            }
        }
    }
    mesh
}

/// A point of the divided lattice as one number.
fn place(point: [u32; 3]) -> u64 {
    point.iter().fold(0, |sum, &coordinate| sum << 21 | u64::from(coordinate))
}

/// Adds a triangle that faces a direction, if it has an area.
fn push(mesh: &mut Mesh, triangle: [u32; 3], outward: Vec3) {
    let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
    let normal = (b - a).cross(c - a);
    if normal.length_squared() > 0.0 {
        mesh.triangles.push(if normal.dot(outward) < 0.0 {
            [triangle[0], triangle[2], triangle[1]]
        } else {
            triangle
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sphere_of_distances_is_closed_and_round() {
        let side = 12;
        let values = (0..side * side * side).map(|index| {
            let at = [index % side, index / side % side, index / side / side];
            let point = Vec3::from_array(at.map(|i| i as f32 / (side - 1) as f32)) - 0.5;
            point.length() - 0.3
        });
        let mesh = surface(&Lattice::new([side; 3], 1, values.collect()));
        let mut edges: HashMap<[u32; 2], i32> = HashMap::new();
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize] - 0.5);
            assert!((b - a).cross(c - a).dot(a) > 0.0, "{a} {b} {c}");
            for k in 0..3 {
                let (from, to) = (triangle[k], triangle[(k + 1) % 3]);
                *edges.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { -1 };
            }
        }
        assert!(edges.values().all(|count| *count == 0));
        assert!(mesh.positions.iter().all(|p| ((*p - 0.5).length() - 0.3).abs() < 0.01));
        assert!(mesh.triangles.len() > 5000, "{}", mesh.triangles.len());
    }
}
