//! Primitives: from a hit (ids, t, u, v) to a point with normals, derivatives and texture coordinates.
//!
//! Each kind of primitive has a file of its own. Positions are in the space of the group that the primitive belongs to:
//! render space, or the space of an instanced object. `∂p/∂u` and `∂p/∂v` follow pbrt-v4 for each kind, since
//! anisotropic reflection and bump mapping depend on them; the outside is the side of `∂p/∂u × ∂p/∂v` after the shape's
//! transform, flipped by `reverse_orientation` and again by a transform that reflects, so that a reflection keeps the
//! outside outside.

mod capsule;
mod curve;
mod disk;
mod mesh;
mod patch;
mod quadric;
mod sphere;
mod triangle;

use std::sync::Arc;

use glam::{DVec3, Vec2};
use lookfrom_bvh::{Affine, Hit, Point};
use lookfrom_simd::{Float, Real, Simd, f32x8, prelude::*};

pub use curve::{Curves, SEGMENTS};
pub use disk::{Disk, Disks};
pub(crate) use mesh::lanes::points_on_meshes;
pub use mesh::{Mesh, Pose, VertexData};
pub use patch::Patches;
pub use quadric::{Clip, Quadric, QuadricKind, Quadrics, Torus};
pub(crate) use quadric::{QuadricFrames, gather_frames, points_on_quadrics};
pub(crate) use sphere::points_on_spheres;
pub use sphere::{SphereBinding, Spheres};

use crate::core::lanes::{LANES, by_lane, gather_f64};
use crate::core::points::{Placement, Points};
use crate::core::vector::Vector;

/// The material, light and other attributes of a primitive's surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MaterialBinding {
    /// Index into the world's materials.
    pub material: u32,
    /// Index into the world's lights, where the surface emits light.
    pub light: Option<u32>,
    /// Index of the scene's shape.
    pub shape: u32,
    /// Index into the world's alphas, where the surface is alpha-tested.
    pub alpha: Option<u32>,
    /// Index into the world's medium interfaces, where the surface has one.
    pub medium_interface: Option<u32>,
    /// Index into the world's meshes with further texture coordinates or opacities.
    pub vertex_data: Option<u32>,
    /// Whether rays from the camera pass its back faces.
    pub single_sided: bool,
}

impl MaterialBinding {
    /// The first material and nothing else: for primitives whose attributes do not matter.
    pub(crate) const NONE: Self = Self {
        material: 0,
        light: None,
        shape: 0,
        alpha: None,
        medium_interface: None,
        vertex_data: None,
        single_sided: false,
    };

    /// Whether its surfaces are nothing but their material: without emission, alpha or media of their own.
    #[inline]
    pub(crate) fn is_only_material(&self) -> bool {
        self.light.is_none() && self.alpha.is_none() && self.medium_interface.is_none()
    }

    /// Whether its surfaces are besides without vertex data of their own, and seen from both sides.
    #[inline]
    pub(crate) fn is_bare(&self) -> bool {
        self.is_only_material() && self.vertex_data.is_none() && !self.single_sided
    }
}

/// The primitives that share a geometry id of the kernel.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Primitives {
    /// Triangles of one shape.
    Mesh(Arc<Mesh>),
    /// Spheres of many shapes.
    Spheres(Spheres),
    /// Round disks of many shapes.
    Disks(Disks),
    /// Ellipsoids, cylinders and parts of them, of many shapes.
    Quadrics(Arc<Quadrics>),
    /// Bilinear patches of one shape.
    Patches(Arc<Patches>),
    /// Curves of one shape.
    Curves(Arc<Curves>),
}

/// A point of a primitive.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// Position, with its error bound.
    pub point: Point,
    /// Outward geometric normal, unit length.
    pub ng: DVec3,
    /// Shading normal, unit length, on the side of `ng`.
    pub ns: DVec3,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Derivative of the position by the first texture coordinate.
    pub dpdu: DVec3,
    /// Derivative of the position by the second one.
    pub dpdv: DVec3,
    /// Shading tangent, for bump mapping and anisotropy: perpendicular to `ns` where normals are interpolated,
    /// otherwise the same as `dpdu`.
    pub shading_dpdu: DVec3,
    /// Shading bitangent. Where the mesh has tangents or normals it is perpendicular to `ns` and `shading_dpdu`: along
    /// `ns × shading_dpdu`, or opposite to it where the mesh's tangents say so (mirrored texture coordinates).
    pub shading_dpdv: DVec3,
    /// The way to the smooth surface that a coarse mesh stands for, to the outside; zero for all else.
    pub lift: DVec3,
    /// The mesh's own linear colour; white where it has none.
    pub color: [f32; 3],
    /// Its attributes.
    pub binding: MaterialBinding,
}

impl SurfacePoint {
    /// A point without an interpolated normal and without a vertex colour.
    fn plain(point: Point, ng: DVec3, uv: Vec2, [dpdu, dpdv]: [DVec3; 2], binding: MaterialBinding) -> Self {
        Self {
            point,
            ng,
            ns: ng,
            uv,
            dpdu,
            dpdv,
            shading_dpdu: dpdu,
            shading_dpdv: dpdv,
            lift: DVec3::ZERO,
            color: [1.0; 3],
            binding,
        }
    }
}

/// Points on surfaces, one or several side by side: as [`SurfacePoint`].
pub(crate) struct SurfacePoints<R: Real> {
    pub(crate) points: Points<R>,
    pub(crate) ng: Vector<R::Double>,
    pub(crate) ns: Vector<R::Double>,
    pub(crate) uv: [R; 2],
    pub(crate) dpdu: Vector<R::Double>,
    pub(crate) dpdv: Vector<R::Double>,
    pub(crate) shading_dpdu: Vector<R::Double>,
    pub(crate) shading_dpdv: Vector<R::Double>,
    pub(crate) lift: Vector<R::Double>,
}

impl<S: Simd> SurfacePoints<f32x8<S>> {
    /// A point in each lane.
    #[inline(always)]
    pub(crate) fn gather(simd: S, points: &[&SurfacePoint; LANES]) -> Self {
        Self {
            points: Points {
                position: gather_f64(simd, &by_lane!(lane => points[lane].point.position)),
                error: gather_f64(simd, &by_lane!(lane => points[lane].point.error)),
            },
            ng: gather_f64(simd, &by_lane!(lane => points[lane].ng.to_array())),
            ns: gather_f64(simd, &by_lane!(lane => points[lane].ns.to_array())),
            uv: [
                f32x8::load_array(simd, by_lane!(lane => points[lane].uv.x)),
                f32x8::load_array(simd, by_lane!(lane => points[lane].uv.y)),
            ],
            dpdu: gather_f64(simd, &by_lane!(lane => points[lane].dpdu.to_array())),
            dpdv: gather_f64(simd, &by_lane!(lane => points[lane].dpdv.to_array())),
            shading_dpdu: gather_f64(simd, &by_lane!(lane => points[lane].shading_dpdu.to_array())),
            shading_dpdv: gather_f64(simd, &by_lane!(lane => points[lane].shading_dpdv.to_array())),
            lift: gather_f64(simd, &by_lane!(lane => points[lane].lift.to_array())),
        }
    }
}

impl<R: Real> SurfacePoints<R> {
    /// These points in instances, where the mask is set.
    #[inline(always)]
    pub(crate) fn placed(self, mask: <R::Double as Float>::Mask, placement: &Placement<R>) -> Self {
        let points = self.points.placed(placement);
        Self {
            points: Points {
                position: Vector::select(mask, points.position, self.points.position),
                error: Vector::select(mask, points.error, self.points.error),
            },
            ng: Vector::select(mask, placement.normal(self.ng).normalize(), self.ng),
            ns: Vector::select(mask, placement.normal(self.ns).normalize(), self.ns),
            uv: self.uv,
            dpdu: Vector::select(mask, placement.vector(self.dpdu), self.dpdu),
            dpdv: Vector::select(mask, placement.vector(self.dpdv), self.dpdv),
            shading_dpdu: Vector::select(mask, placement.vector(self.shading_dpdu), self.shading_dpdu),
            shading_dpdv: Vector::select(mask, placement.vector(self.shading_dpdv), self.shading_dpdv),
            lift: Vector::select(mask, placement.vector(self.lift), self.lift),
        }
    }
}

impl Primitives {
    /// The numbers of their shapes, which may repeat.
    pub(crate) fn shapes(&self) -> Vec<u32> {
        let of_all = |bindings: &[MaterialBinding]| bindings.iter().map(|binding| binding.shape).collect();
        match self {
            Self::Mesh(mesh) => vec![mesh.binding.shape],
            Self::Spheres(spheres) => spheres.bindings.iter().map(|sphere| sphere.binding.shape).collect(),
            Self::Disks(disks) => of_all(&disks.bindings),
            Self::Quadrics(quadrics) => of_all(&quadrics.bindings),
            Self::Patches(patches) => vec![patches.binding.shape],
            Self::Curves(curves) => vec![curves.binding.shape],
        }
    }

    /// The attributes of a primitive.
    #[inline]
    pub(crate) fn binding(&self, index: usize) -> &MaterialBinding {
        match self {
            Self::Mesh(mesh) => &mesh.binding,
            Self::Spheres(spheres) => &spheres.get(index).1.binding,
            Self::Disks(disks) => &disks.bindings[index],
            Self::Quadrics(quadrics) => &quadrics.bindings[index],
            Self::Patches(patches) => &patches.binding,
            Self::Curves(curves) => &curves.binding,
        }
    }

    /// The point of `hit` on a ray from `origin` in `direction` (the one that was traced, in this primitive's space) at a time of
    /// the shutter (0 … 1). Texture coordinates may be 0 where they are not wanted.
    pub(crate) fn point(
        &self,
        hit: &Hit,
        [origin, direction]: [DVec3; 2],
        time: f32,
        wants_uv: bool,
    ) -> SurfacePoint {
        let index = hit.primitive as usize;
        let near = origin + f64::from(hit.t) * direction;
        match self {
            Self::Mesh(mesh) => mesh.point_at(index, [hit.u, hit.v], time),
            Self::Spheres(spheres) => spheres.point(index, near),
            Self::Disks(disks) => disks.point(index, near),
            Self::Quadrics(quadrics) => quadrics.point(index, near, wants_uv),
            Self::Patches(patches) => patches.point(index, hit.u, hit.v),
            Self::Curves(curves) => curves.point(index, [hit.u, hit.v], near, direction),
        }
    }
}

/// The rows of the linear part of a transform.
fn rows(transform: &Affine) -> [[f64; 3]; 3] {
    let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| transform.vector(axis));
    std::array::from_fn(|k| [x[k], y[k], z[k]])
}
