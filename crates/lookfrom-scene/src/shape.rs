//! Shapes: quadrics, quads, patches, curves and triangle meshes, each with a transform, a material and perhaps emission.

mod pieces;

use std::sync::Arc;

use glam::{DMat4, DVec3, Vec2, Vec3, Vec4};

use crate::error::Location;
use crate::light::Power;
use crate::material::{Color, Scalar};
use crate::medium::Sides;
use crate::scene::{Bounds, MaterialId, MeshId};
use crate::solid::Solid;
pub use pieces::{Piece, Pieces};

/// A shape in the world (or in an object).
#[derive(Clone, Debug)]
pub struct Shape {
    /// Its name, if it has one.
    pub name: Option<String>,
    /// The pieces of its mesh that have names of their own.
    pub pieces: Pieces,
    /// The location in the file.
    pub at: Location,
    /// Its geometry, in its own space.
    pub geometry: Geometry,
    /// Its material.
    pub material: MaterialId,
    /// Its emission; `None` for shapes that emit no light.
    pub emission: Option<Emission>,
    /// Its alpha: the probability that a ray hits it. `None` for opaque shapes.
    pub alpha: Option<Scalar>,
    /// The media on both sides, if the surface is a medium interface; otherwise the surrounding medium continues.
    pub sides: Option<Sides>,
    /// Whether the orientation is reversed.
    pub reverse_orientation: bool,
    /// Whether camera rays pass through its back faces (back-face culling).
    pub single_sided: bool,
    /// From the shape's space to the world: any invertible affine matrix.
    pub world_from_object: DMat4,
}

impl Shape {
    /// Bytes of itself and of the arrays that only it has: its meshes are the scene's.
    pub fn bytes(&self) -> u64 {
        size_of::<Self>() as u64 + self.geometry.bytes() + self.pieces.bytes()
    }

    /// A geometry with a material, at the origin, opaque, without emission.
    pub fn new(at: Location, geometry: Geometry, material: MaterialId) -> Self {
        Self {
            name: None,
            pieces: Pieces::default(),
            at,
            geometry,
            material,
            emission: None,
            alpha: None,
            sides: None,
            reverse_orientation: false,
            single_sided: false,
            world_from_object: DMat4::IDENTITY,
        }
    }
}

/// The emission of a surface, the same in all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    /// Emitted radiance.
    pub radiance: Color,
    /// The power.
    pub power: Power,
    /// Whether both sides emit light; otherwise only the side that the normal points to.
    pub two_sided: bool,
}

impl Emission {
    /// Emission with the brightness of the colour, unscaled.
    pub fn new(radiance: Color, two_sided: bool) -> Self {
        Self { radiance, power: Power::AS_WRITTEN, two_sided }
    }
}

/// Geometry, in the shape's space.
#[derive(Clone, Debug)]
pub enum Geometry {
    /// A sphere; its poles lie on the y axis of its space. Radius positive and finite.
    Sphere(Sphere),
    /// Many spheres with one material, such as a sphereflake or a point cloud.
    Spheres(Arc<[Sphere]>),
    /// The parallelogram `corner + s·edge_u + t·edge_v`, `s, t ∈ [0, 1]`, uv = (s, t), normal along `edge_u × edge_v`.
    Quad {
        /// The corner s = t = 0.
        corner: DVec3,
        /// Along s.
        edge_u: DVec3,
        /// Along t.
        edge_v: DVec3,
    },
    /// A disk.
    Disk {
        /// The centre.
        center: DVec3,
        /// Normal, of any length but zero.
        normal: DVec3,
        /// Radius, positive.
        radius: f64,
    },
    /// A triangle mesh.
    Mesh(MeshId),
    /// A part of a sphere around the origin; poles on z, uv as in pbrt.
    PartialSphere {
        /// Radius, positive.
        radius: f64,
        /// Minimum and maximum z.
        z: [f64; 2],
        /// Sweep angle from +x toward +y, in degrees, in (0, 360].
        phi_max: f64,
    },
    /// A disk perpendicular to the z axis that faces +z, possibly with a hole; uv as in pbrt.
    PartialDisk {
        /// Its z.
        height: f64,
        /// Radius, positive.
        radius: f64,
        /// Radius of the hole: ≥ 0.
        inner_radius: f64,
        /// Sweep angle from +x toward +y, in degrees, in (0, 360].
        phi_max: f64,
    },
    /// An open cylinder around the z axis; uv as in pbrt.
    Cylinder {
        /// Radius, positive.
        radius: f64,
        /// Minimum and maximum z.
        z: [f64; 2],
        /// Sweep angle from +x toward +y, in degrees, in (0, 360].
        phi_max: f64,
    },
    /// The tube around a circle in the plane z = 0 with its centre at the origin, where the tube is not inside of itself. u goes around the
    /// z axis from +x toward +y, v around the tube from the outermost circle toward +z.
    Torus {
        /// Of the circle, positive.
        radius: f64,
        /// Radius of the tube, positive.
        tube: f64,
    },
    /// The part of a body's surface that is left in a solid, which other shapes complete. It faces outward and emits no light; uv as that of the
    /// body's shape by itself, of a cylinder with v from 0 to 1 on its side and on each of its ends.
    SolidSurface {
        /// The solid, in the shape's space.
        solid: Arc<Solid>,
        /// The number of the body.
        body: u32,
    },
    /// Bilinear patches.
    Bilinear(Arc<Patches>),
    /// Curves: hair, wires, ribbons.
    Curves(Arc<[Strand]>),
}

/// Bilinear patches over shared vertices: `(1−u)(1−v) p0 + u(1−v) p1 + (1−u)v p2 + uv p3`, outside along `∂u × ∂v`.
#[derive(Clone, Debug, Default)]
pub struct Patches {
    /// Vertices: finite.
    pub positions: Vec<Vec3>,
    /// Four vertices per patch.
    pub patches: Vec<[u32; 4]>,
    /// Shading normals: none, or one per vertex.
    pub normals: Vec<Vec3>,
    /// Texture coordinates: none, or one per vertex.
    pub uvs: Vec<Vec2>,
}

/// A cubic Bézier curve with a width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strand {
    /// Control points.
    pub points: [Vec3; 4],
    /// Width at the beginning and at the end: > 0.
    pub width: [f32; 2],
    /// The cross-section.
    pub profile: Profile,
}

/// The Bézier points of a segment of a uniform cubic B-spline.
pub(crate) fn cubic_b_spline([a, b, c, d]: [Vec3; 4]) -> [Vec3; 4] {
    let near = |p: Vec3, q: Vec3| p + (q - p) * (1.0 / 3.0);
    let (bc, cb) = (near(b, c), near(c, b));
    [(near(b, a) + bc) * 0.5, bc, cb, (cb + near(c, d)) * 0.5]
}

/// The cross-section of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Profile {
    /// A flat band that always faces the ray.
    Flat,
    /// A flat band that always faces the ray, shaded as the outside of a cylinder.
    Cylinder,
    /// The same as pbrt-v4 shades it: with the normals of the far half of the cylinder, whose inside is what the ray sees. Hair does not
    /// show the difference.
    PbrtCylinder,
    /// A flat band perpendicular to these two unit normals, at its beginning and at its end.
    Ribbon([Vec3; 2]),
}

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// The centre.
    pub center: DVec3,
    /// Positive and finite.
    pub radius: f64,
}

/// Triangles over shared vertices. Front faces are counter-clockwise.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Its name or file.
    pub name: String,
    /// Vertices: finite.
    pub positions: Vec<Vec3>,
    /// Three vertices per triangle, each below `positions.len()`.
    pub triangles: Vec<[u32; 3]>,
    /// Shading normals: none, or one per vertex (not necessarily of unit length; zero if unknown).
    pub normals: Vec<Vec3>,
    /// Texture coordinates: none, or one per vertex.
    pub uvs: Vec<Vec2>,
    /// Further sets of texture coordinates: each with one per vertex; those beyond [`Mesh::MOST_UV_SETS`] are not used.
    pub more_uvs: Vec<Vec<Vec2>>,
    /// Linear colours: none, or one per vertex.
    pub colors: Vec<[f32; 3]>,
    /// Opacities: none, or one per vertex.
    pub opacities: Vec<f32>,
    /// Tangents along u, for bump mapping and anisotropy; w is the direction of v relative to normal × tangent (1 or −1):
    /// none, or one per vertex.
    pub tangents: Vec<Vec4>,
    /// Displacement of the vertices along their normals ([`Mesh::mean_normals`] where there are none), before any transform.
    pub displacement: Option<Scalar>,
    /// Whether it is the surface of a solid, or a part of it: what is left out opens the solid.
    pub is_of_solid: bool,
    /// Its vertices at further times, equally spaced until the shutter closes, linear in between: 2ᵏ of them, or none if it keeps
    /// its form. All meshes of a scene that have any have as many.
    pub later: Vec<MeshPose>,
}

/// The vertices of a mesh at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshPose {
    /// As many as those of the mesh.
    pub positions: Vec<Vec3>,
    /// As many as those of the mesh.
    pub normals: Vec<Vec3>,
}

impl MeshPose {
    /// Bytes of its arrays.
    pub fn bytes(&self) -> u64 {
        (size_of_val(&*self.positions) + size_of_val(&*self.normals)) as u64
    }
}

impl Mesh {
    /// The number of sets of texture coordinates that materials can use.
    pub const MOST_UV_SETS: usize = 4;

    /// Bytes of its arrays.
    pub fn bytes(&self) -> u64 {
        let vertices = size_of_val(&*self.positions)
            + size_of_val(&*self.normals)
            + size_of_val(&*self.uvs)
            + self.more_uvs.iter().map(|uvs| size_of_val(&**uvs)).sum::<usize>()
            + size_of_val(&*self.colors)
            + size_of_val(&*self.opacities)
            + size_of_val(&*self.tangents);
        (vertices + size_of_val(&*self.triangles)) as u64
            + self.later.iter().map(MeshPose::bytes).sum::<u64>()
    }
}

/// A part of a model file, before it is placed in a scene.
#[derive(Clone, Debug)]
pub struct Part {
    /// Its name in the file, if it has one.
    pub name: Option<String>,
    /// The pieces of its mesh that have names of their own.
    pub pieces: Pieces,
    /// Its geometry.
    pub geometry: Geometry,
    /// Its material, if the file gives one.
    pub material: Option<MaterialId>,
    /// Its emission, if the file gives any.
    pub emission: Option<Emission>,
    /// Its alpha, if the file gives any.
    pub alpha: Option<Scalar>,
    /// Whether camera rays pass through its back faces.
    pub single_sided: bool,
    /// The transform of the file: any invertible affine matrix.
    pub world_from_object: DMat4,
}

impl Part {
    /// A geometry at its place, without a material.
    pub fn new(name: Option<String>, geometry: Geometry) -> Self {
        Self {
            name,
            pieces: Pieces::default(),
            geometry,
            material: None,
            emission: None,
            alpha: None,
            single_sided: false,
            world_from_object: DMat4::IDENTITY,
        }
    }
}

impl Shape {
    /// The bounding box of the shape, in the space that `world_from_object` transforms to.
    pub fn bounds(&self, meshes: &[Mesh]) -> Bounds {
        self.geometry.bounds(meshes, &self.world_from_object)
    }
}

impl Geometry {
    /// Bytes of the arrays that only it has: meshes are the scene's.
    pub fn bytes(&self) -> u64 {
        let bytes = match self {
            Self::Spheres(spheres) => size_of_val(&**spheres),
            Self::Curves(strands) => size_of_val(&**strands),
            Self::Bilinear(patches) => {
                size_of_val(&*patches.positions)
                    + size_of_val(&*patches.patches)
                    + size_of_val(&*patches.normals)
                    + size_of_val(&*patches.uvs)
            }
            _ => 0,
        };
        bytes as u64
    }

    /// The bounding box of the geometry, transformed by `matrix`.
    pub fn bounds(&self, meshes: &[Mesh], matrix: &DMat4) -> Bounds {
        let sphere = |sphere: &Sphere| {
            // The extent of a transformed sphere along an axis is its radius times the length of the matrix's row.
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
            Self::PartialSphere { radius, .. } => sphere(&Sphere { center: DVec3::ZERO, radius: *radius }),
            Self::PartialDisk { height, radius, .. } => {
                let corner = DVec3::new(*radius, *radius, 0.0);
                let middle = DVec3::Z * *height;
                Bounds { min: middle - corner, max: middle + corner }.transformed(matrix)
            }
            Self::Cylinder { radius, z: [low, high], .. } => {
                let corner = |z: f64, sign: f64| DVec3::new(sign * *radius, sign * *radius, z);
                Bounds { min: corner(*low, -1.0), max: corner(*high, 1.0) }.transformed(matrix)
            }
            Self::Torus { radius, tube } => {
                let corner = DVec3::new(radius + tube, radius + tube, *tube);
                Bounds { min: -corner, max: corner }.transformed(matrix)
            }
            Self::SolidSurface { solid, body } => solid.bounds_of_surface(*body, matrix),
            Self::Bilinear(patches) => patches
                .positions
                .iter()
                .fold(Bounds::EMPTY, |bounds, point| bounds.with(matrix.transform_point3(point.as_dvec3()))),
            Self::Curves(strands) => strands.iter().fold(Bounds::EMPTY, |bounds, strand| {
                let half_width = DVec3::splat(0.5 * f64::from(strand.width[0].max(strand.width[1])));
                let hull =
                    strand.points.iter().fold(Bounds::EMPTY, |hull, point| hull.with(point.as_dvec3()));
                let hull = Bounds { min: hull.min - half_width, max: hull.max + half_width };
                bounds.union(hull.transformed(matrix))
            }),
            Self::Mesh(id) => {
                // Each vertex once: on average it is a corner of six triangles, but it may be one of none.
                let Some(Mesh { positions, triangles, later, .. }) = meshes.get(id.index()) else {
                    return Bounds::EMPTY;
                };
                let mut is_corner = vec![false; positions.len()];
                for &vertex in triangles.as_flattened() {
                    if let Some(is_corner) = is_corner.get_mut(vertex as usize) {
                        *is_corner = true;
                    }
                }
                let times = std::iter::once(positions).chain(later.iter().map(|pose| &pose.positions));
                let vertices = times.flat_map(|positions| positions.iter().zip(&is_corner));
                vertices.filter(|(_, is_corner)| **is_corner).fold(Bounds::EMPTY, |bounds, (position, _)| {
                    bounds.with(matrix.transform_point3(position.as_dvec3()))
                })
            }
        }
    }
}
