//! The subject of a model's picture: what stands on a ground plane, if there is one that is much larger.
//!
//! The ground is what lies in the lowest plane, and large triangles just above it: those of a thin slab.

use glam::DVec3;

use super::{corners, visit_instance};
use crate::scene::{Bounds, Scene};
use crate::shape::Geometry;
use crate::studio::bounds_of_objects;

/// The least size of a ground that is left out of the framing, in sizes of the subject.
const LARGER: f64 = 3.0;
/// The height of a plane, of a slab, and the length of an edge of a large triangle, in radii of the whole.
const PLANE: f64 = 1e-5;
const SLAB: f64 = 0.05;
const LONG: f64 = 0.5;

/// The box of what stands on a large ground, `up` being of unit length; `None` if there is no such ground.
pub(super) fn on_ground(scene: &Scene, whole: Bounds, up: DVec3) -> Option<Bounds> {
    let lowest = corners(whole).map(|corner| corner.dot(up)).into_iter().fold(f64::INFINITY, f64::min);
    let radius = whole.radius();
    // The axes are those of the world; the lowest corner of a box is that of its content only along an axis.
    if up.abs().max_element() < 1.0 - 1e-9 {
        return None;
    }
    let is_ground = |triangle: &[DVec3; 3]| {
        let highest = triangle.iter().map(|corner| corner.dot(up)).fold(f64::NEG_INFINITY, f64::max);
        let [a, b, c] = *triangle;
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        highest <= lowest + PLANE * radius || (highest <= lowest + SLAB * radius && longest > LONG * radius)
    };
    let mut subject = Bounds::EMPTY;
    for shape in &scene.shapes {
        let Geometry::Mesh(id) = &shape.geometry else {
            subject = subject.union(shape.bounds(&scene.meshes));
            continue;
        };
        let mesh = &scene.meshes[id.index()];
        for triangle in &mesh.triangles {
            let world = |vertex: u32| {
                shape.world_from_object.transform_point3(mesh.positions[vertex as usize].as_dvec3())
            };
            let triangle = triangle.map(world);
            if !is_ground(&triangle) {
                subject = triangle.into_iter().fold(subject, Bounds::with);
            }
        }
    }
    let objects = bounds_of_objects(scene);
    for instance in &scene.instances {
        let object = objects[instance.object.index()];
        visit_instance(instance, object, &mut |corner| subject = subject.with(corner));
    }
    let stands = || {
        let feet = corners(subject).map(|corner| corner.dot(up)).into_iter().fold(f64::INFINITY, f64::min);
        feet <= lowest + SLAB * radius
    };
    (!subject.is_empty() && LARGER * subject.radius() < radius && stands()).then_some(subject)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::error::Location;
    use crate::scene::{MaterialId, MeshId};
    use crate::shape::{Mesh, Shape};

    /// A box on a ground of this half width, of so many squares along each side, and of this thickness.
    fn scene(half: f32, squares: u32, thickness: f32) -> (Scene, Bounds) {
        let mut mesh = Mesh::default();
        let mut quad = |corners: [[f32; 3]; 4]| {
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(corners.map(Vec3::from));
            mesh.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|triangle| triangle.map(|k| first + k)));
        };
        let mut solid = |[x0, y0, z0]: [f32; 3], [x1, y1, z1]: [f32; 3]| {
            quad([[x0, y0, z0], [x1, y0, z0], [x1, y0, z1], [x0, y0, z1]]);
            quad([[x0, y1, z0], [x1, y1, z0], [x1, y1, z1], [x0, y1, z1]]);
            quad([[x0, y0, z0], [x1, y0, z0], [x1, y1, z0], [x0, y1, z0]]);
            quad([[x0, y0, z1], [x1, y0, z1], [x1, y1, z1], [x0, y1, z1]]);
        };
        solid([-1.0, 0.0, -1.0], [1.0, 2.0, 1.0]);
        let step = 2.0 * half / squares as f32;
        for i in 0..squares {
            for j in 0..squares {
                let (x, z) = (-half + step * i as f32, -half + step * j as f32);
                solid([x, -thickness, z], [x + step, 0.0, z + step]);
            }
        }
        let shape = Shape::new(Location::default(), Geometry::Mesh(MeshId(0)), MaterialId(0));
        let scene = Scene { meshes: vec![mesh], shapes: vec![shape], ..Scene::default() };
        let bounds = scene.bounds();
        (scene, bounds)
    }

    #[test]
    fn what_stands_on_a_ground_is_the_subject() {
        let of = |half, squares, thickness| {
            let (scene, bounds) = scene(half, squares, thickness);
            on_ground(&scene, bounds, DVec3::Y)
        };
        let subject = Bounds { min: DVec3::new(-1.0, 0.0, -1.0), max: DVec3::new(1.0, 2.0, 1.0) };
        assert_eq!(of(100.0, 1, 0.0), Some(subject));
        assert_eq!(of(10.0, 1, 0.0), Some(subject));
        assert_eq!(of(100.0, 20, 0.0), Some(subject));
        assert_eq!(of(100.0, 1, 1.0), Some(subject));
        // The ground is a part of the model.
        assert_eq!(of(3.0, 1, 0.1), None);
        assert_eq!(of(100.0, 20, 3.0), None);
    }
}
