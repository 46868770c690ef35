//! What stands in a scene: spheres, quads, disks and triangle meshes, each with a place, a material and perhaps a glow.

use std::sync::Arc;

use glam::{DMat4, DVec3, Vec2, Vec3};

use crate::error::Location;
use crate::material::Color;
use crate::scene::{Bounds, MaterialId, MeshId};

/// One thing in the world (or in an object).
#[derive(Clone, Debug)]
pub struct Shape {
    /// Its name, where one was given.
    pub name: Option<String>,
    /// Where it was written.
    pub at: Location,
    /// Its form, in its own space.
    pub geometry: Geometry,
    /// Its look.
    pub material: MaterialId,
    /// The light it gives off.
    pub emission: Option<Emission>,
    /// From the shape's space to the world: any invertible affine matrix.
    pub world_from_object: DMat4,
}

/// The light that a surface gives off, the same in all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    /// Emitted radiance.
    pub radiance: Color,
    /// Whether both sides shine; otherwise the side that the normal points to.
    pub two_sided: bool,
}

/// Form, in the shape's space.
#[derive(Clone, Debug)]
pub enum Geometry {
    /// A sphere; its poles lie on the y axis of its space. Radius positive and finite.
    Sphere(Sphere),
    /// Many spheres with one look: a sphereflake, a cloud of points.
    Spheres(Arc<[Sphere]>),
    /// The parallelogram `corner + s·edge_u + t·edge_v`, `s, t ∈ [0, 1]`, uv = (s, t), normal along `edge_u × edge_v`.
    Quad {
        /// Where s = t = 0.
        corner: DVec3,
        /// Along s.
        edge_u: DVec3,
        /// Along t.
        edge_v: DVec3,
    },
    /// A round plate.
    Disk {
        /// Middle.
        center: DVec3,
        /// Normal, of any length but zero.
        normal: DVec3,
        /// Radius, positive.
        radius: f64,
    },
    /// Triangles.
    Mesh(MeshId),
}

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Middle.
    pub center: DVec3,
    /// Positive and finite.
    pub radius: f64,
}

/// Triangles over shared vertices. Front faces run counter-clockwise.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Its name or file.
    pub name: String,
    /// Vertices: finite.
    pub positions: Vec<Vec3>,
    /// Three vertices a triangle, each below `positions.len()`.
    pub triangles: Vec<[u32; 3]>,
    /// Shading normals: none, or one a vertex (not necessarily of unit length; zero where unknown).
    pub normals: Vec<Vec3>,
    /// Texture coordinates: none, or one a vertex.
    pub uvs: Vec<Vec2>,
    /// Linear colours: none, or one a vertex.
    pub colors: Vec<[f32; 3]>,
}

/// One piece of a model file: what a reader makes of it before a scene gives it a place.
#[derive(Clone, Debug)]
pub struct Part {
    /// Its name in the file, where there is one.
    pub name: Option<String>,
    /// Its form.
    pub geometry: Geometry,
    /// Its look, where the file gives one.
    pub material: Option<MaterialId>,
    /// Its light, where the file gives one.
    pub emission: Option<Emission>,
}

impl Shape {
    /// The box around the shape, in the space that `world_from_object` leads to.
    pub fn bounds(&self, meshes: &[Mesh]) -> Bounds {
        self.geometry.bounds(meshes, &self.world_from_object)
    }
}

impl Geometry {
    /// The box around the form after `matrix`.
    pub fn bounds(&self, meshes: &[Mesh], matrix: &DMat4) -> Bounds {
        let sphere = |sphere: &Sphere| {
            // The extent of a transformed sphere along an axis is the length of the matrix's row there (times the radius).
            let rows = matrix.transpose();
            let extent = sphere.radius
                * DVec3::new(
                    rows.x_axis.truncate().length(),
                    rows.y_axis.truncate().length(),
                    rows.z_axis.truncate().length(),
                );
            let center = matrix.transform_point3(sphere.center);
            Bounds { min: center - extent, max: center + extent }
        };
        match self {
            Self::Sphere(one) => sphere(one),
            Self::Spheres(many) => many.iter().fold(Bounds::EMPTY, |bounds, one| bounds.union(sphere(one))),
            Self::Quad { corner, edge_u, edge_v } => {
                [*corner, *corner + *edge_u, *corner + *edge_v, *corner + *edge_u + *edge_v]
                    .into_iter()
                    .fold(Bounds::EMPTY, |bounds, point| bounds.with(matrix.transform_point3(point)))
            }
            Self::Disk { center, normal, radius } => {
                let n = normal.normalize_or_zero();
                let extent = *radius * (DVec3::ONE - n * n).max(DVec3::ZERO).map(f64::sqrt);
                Bounds { min: *center - extent, max: *center + extent }.transformed(matrix)
            }
            Self::Mesh(id) => {
                let mesh = &meshes[id.index()];
                mesh.triangles.iter().flatten().fold(Bounds::EMPTY, |bounds, &vertex| {
                    bounds.with(matrix.transform_point3(mesh.positions[vertex as usize].as_dvec3()))
                })
            }
        }
    }
}
