//! Whether the surfaces of meshes are closed, as printers, glass and solids need them.

use std::collections::HashMap;

use glam::DVec3;
use serde::Serialize;

use crate::scene::Scene;
use crate::shape::{Geometry, Mesh, Shape};

/// The meshes of a scene together. What shapes of one transform have in common is found by equal positions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Watertightness {
    /// Edges at which a surface ends.
    pub open_edges: u64,
    /// Edges between faces that look to opposite sides.
    pub turned_edges: u64,
    /// The volume inside, in cubes of the scene's unit, each object once; negative where faces look inwards, and without meaning where
    /// there are open or turned edges.
    pub volume: f64,
}

/// An edge by the bits of its ends, the lesser first.
type Edge = [[u32; 3]; 2];

impl Watertightness {
    /// Of the meshes of a scene; `None` if it has none.
    pub fn of(scene: &Scene) -> Option<Self> {
        let mut sum = None;
        let of_objects = scene.objects.iter().map(|object| &object.shapes);
        for shapes in std::iter::once(&scene.shapes).chain(of_objects) {
            let mut by_transform: HashMap<[u64; 16], Vec<(&Shape, &Mesh)>> = HashMap::new();
            for shape in shapes {
                if let Geometry::Mesh(id) = shape.geometry {
                    let key = shape.world_from_object.to_cols_array().map(f64::to_bits);
                    by_transform.entry(key).or_default().push((shape, &scene.meshes[id.index()]));
                }
            }
            for surface in by_transform.values() {
                sum.get_or_insert_with(Self::default).add(surface);
            }
        }
        sum
    }

    /// Whether all surfaces are closed, and all faces of each look to the same side of it.
    pub fn is_closed(&self) -> bool {
        self.open_edges == 0 && self.turned_edges == 0
    }

    /// Adds meshes of one space.
    fn add(&mut self, surface: &[(&Shape, &Mesh)]) {
        let Some(origin) = surface.iter().find_map(|(_, mesh)| mesh.positions.first()) else { return };
        let origin = origin.as_dvec3();
        // How much more often faces pass an edge in one direction than in the other.
        let mut excess: HashMap<Edge, i64> = HashMap::new();
        let mut volume = 0.0;
        for (shape, mesh) in surface {
            let side = if shape.reverse_orientation { -1 } else { 1 };
            for triangle in &mesh.triangles {
                let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
                // A zero is a zero, whatever its sign.
                let bits = [a, b, c].map(|p| p.to_array().map(|x| (x + 0.0).to_bits()));
                for [from, to] in [[bits[0], bits[1]], [bits[1], bits[2]], [bits[2], bits[0]]] {
                    if from == to {
                        continue;
                    }
                    let (edge, step) = if from < to { ([from, to], side) } else { ([to, from], -side) };
                    let times = excess.entry(edge).or_default();
                    *times += step;
                    if *times == 0 {
                        excess.remove(&edge);
                    }
                }
                let [a, b, c]: [DVec3; 3] = [a, b, c].map(|p| p.as_dvec3() - origin);
                volume += side as f64 * a.dot(b.cross(c)) / 6.0;
            }
        }
        let turned = excess.values().filter(|times| **times % 2 == 0).count() as u64;
        self.turned_edges += turned;
        self.open_edges += excess.len() as u64 - turned;
        let scale = surface.first().map_or(1.0, |(shape, _)| shape.world_from_object.determinant().abs());
        self.volume += scale * volume;
    }
}

#[cfg(test)]
mod tests {
    use glam::{DMat4, Vec3};

    use super::*;
    use crate::error::Location;
    use crate::scene::{MaterialId, MeshId};

    /// The corners of a box of the size 1 × 2 × 3, two triangles for each side.
    fn cuboid() -> Mesh {
        let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32 * 2.0, (i >> 2) as f32 * 3.0);
        let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        Mesh { positions: (0..8).map(corner).collect(), triangles, ..Mesh::default() }
    }

    fn of(meshes: Vec<Mesh>, world_from_object: DMat4, is_reversed: bool) -> Watertightness {
        let mut scene = Scene::default();
        for (index, mesh) in meshes.into_iter().enumerate() {
            let geometry = Geometry::Mesh(MeshId(index as u32));
            let mut shape = Shape::new(Location::default(), geometry, MaterialId(0));
            shape.world_from_object = world_from_object;
            shape.reverse_orientation = is_reversed;
            scene.shapes.push(shape);
            scene.meshes.push(mesh);
        }
        Watertightness::of(&scene).expect("meshes")
    }

    #[test]
    fn a_box_is_closed_until_a_face_is_missing_or_turned() {
        let whole = of(vec![cuboid()], DMat4::from_scale(DVec3::splat(2.0)), false);
        assert!(whole.is_closed() && (whole.volume - 48.0).abs() < 1e-9, "{whole:?}");
        let reversed = of(vec![cuboid()], DMat4::from_translation(DVec3::splat(1e6)), true);
        assert!(reversed.is_closed() && (reversed.volume + 6.0).abs() < 1e-9, "{reversed:?}");

        let mut open = cuboid();
        open.triangles.pop();
        let found = of(vec![open], DMat4::IDENTITY, false);
        assert_eq!((found.open_edges, found.turned_edges), (3, 0));
        let mut turned = cuboid();
        turned.triangles[0].reverse();
        let found = of(vec![turned], DMat4::IDENTITY, false);
        assert_eq!((found.open_edges, found.turned_edges), (0, 3));

        // Parts of one surface, with vertices of their own, and faces without area.
        let (mut one, mut other) = (cuboid(), cuboid());
        one.triangles.truncate(5);
        one.triangles.push([0, 0, 1]);
        other.triangles.drain(..5);
        let parts = of(vec![one, other], DMat4::IDENTITY, false);
        assert!(parts.is_closed() && (parts.volume - 6.0).abs() < 1e-9, "{parts:?}");
        assert_eq!(Watertightness::of(&Scene::default()), None);
    }
}
