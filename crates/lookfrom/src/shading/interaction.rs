//! Surface interactions: the point that a ray hit, with its normals, derivatives and material.
//!
//! Everything is in render space (see `world`).

use glam::{DVec3, Vec2, Vec3};
use lookfrom_bvh::{OriginPrimitive, Point};

use crate::core::points::{Lift, Points};
use crate::shading::interior_stack::MediumInterface;
use crate::shading::texture::FloatTexture;

/// A point on a surface, seen from a direction.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceInteraction {
    /// Position in f64, with its error bound.
    pub point: Point,
    /// Geometric normal to the outside, unit length.
    pub ng: DVec3,
    /// Shading normal, unit length, on the side of `ng`.
    pub ns: Vec3,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Derivative ∂p/∂u of the position, for texture footprints.
    pub dpdu: Vec3,
    /// Derivative ∂p/∂v of the position.
    pub dpdv: Vec3,
    /// ∂p/∂u of the smoothed surface, for bump mapping and anisotropic metals: perpendicular to `ns` where normals
    /// are smoothed, and along the mesh's tangents where it has some.
    pub shading_dpdu: Vec3,
    /// ∂p/∂v of the smoothed surface. Where the mesh has tangents, it forms with `shading_dpdu` and `ns` the
    /// tangent frame of normal maps: along `ns × shading_dpdu`, or opposite to it where the tangents mark the
    /// texture coordinates as mirrored.
    pub shading_dpdv: Vec3,
    /// The way to the smooth surface that a coarse mesh stands for, to the outside; zero for all else. Rays that leave to
    /// the outside of that surface start there.
    pub lift: Vec3,
    /// The mesh's vertex colour (linear) at this point; white where it has none.
    pub color: [f32; 3],
    /// Direction back to the origin of the ray, unit length.
    pub wo: Vec3,
    /// True if `wo` is on the side of `ng`: the ray hit the outside.
    pub front: bool,
    /// Index into the world's materials.
    pub material: u32,
    /// Index into the world's area lights, where the surface emits light.
    pub light: Option<u32>,
    /// True if rays from the camera pass through its back faces.
    pub single_sided: bool,
    /// Index into the world's meshes with further texture coordinates or vertex opacities, where this is one.
    pub vertex_data: Option<u32>,
    /// Opacity (alpha); `None` is opaque everywhere.
    pub alpha: Option<FloatTexture>,
    /// The media on both sides, where the surface declares them.
    pub medium_interface: Option<MediumInterface>,
    /// Index of the shape, counted over the whole world.
    pub shape: u32,
    /// Index of the primitive within its shape: of a mesh, the triangle.
    pub primitive: u32,
    /// The origin primitive for rays that leave this surface (self-intersection exclusion).
    pub origin_primitive: OriginPrimitive,
    /// The kernel's u and v coordinates on the primitive.
    pub on_primitive: Vec2,
}

/// The directions at a surface that its shading frame depends on, of unit length but for the derivatives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShadingGeometry {
    /// [`SurfaceInteraction::ng`].
    pub(crate) ng: Vec3,
    /// [`SurfaceInteraction::ns`].
    pub(crate) ns: Vec3,
    /// [`SurfaceInteraction::shading_dpdu`].
    pub(crate) dpdu: Vec3,
    /// [`SurfaceInteraction::shading_dpdv`].
    pub(crate) dpdv: Vec3,
    /// [`SurfaceInteraction::dpdu`] and [`SurfaceInteraction::dpdv`].
    pub(crate) derivatives: [Vec3; 2],
    /// [`SurfaceInteraction::wo`].
    pub(crate) wo: Vec3,
    /// [`SurfaceInteraction::front`].
    pub(crate) front: bool,
}

impl ShadingGeometry {
    /// The geometric normal on the side of `wo`.
    pub(crate) fn ng_facing(&self) -> Vec3 {
        if self.front { self.ng } else { -self.ng }
    }
}

impl SurfaceInteraction {
    /// The directions that the shading frame depends on.
    pub(crate) fn shading_geometry(&self) -> ShadingGeometry {
        let Self { ns, wo, front, shading_dpdu: dpdu, shading_dpdv: dpdv, .. } = *self;
        ShadingGeometry {
            ng: self.ng.as_vec3(),
            ns,
            dpdu,
            dpdv,
            derivatives: [self.dpdu, self.dpdv],
            wo,
            front,
        }
    }

    /// The geometric normal on the side of `wo`.
    pub fn ng_facing(&self) -> Vec3 {
        self.shading_geometry().ng_facing()
    }

    /// The shading normal on the side of `wo`; where smoothing turned it away from `wo`, the geometric one.
    pub fn ns_facing(&self) -> Vec3 {
        let n = if self.front { self.ns } else { -self.ns };
        if n.dot(self.wo) > 0.0 { n } else { self.ng_facing() }
    }

    /// True if light toward `wi` leaves on the other side of the surface than `wo`.
    pub(crate) fn crosses(&self, wi: Vec3) -> bool {
        self.is_outside(wi) != self.front
    }

    /// True if light toward `wi` leaves to the outside: of the smooth surface, where a mesh stands for one.
    pub(crate) fn is_outside(&self, wi: Vec3) -> bool {
        self.ng.dot(wi.as_dvec3()) > 0.0 || self.lift().is_some_and(|lift| lift.is_above(wi.into()))
    }

    /// The smooth surface that its mesh stands for, if it is above and seen from there.
    pub(crate) fn lift(&self) -> Option<Lift<f32>> {
        (self.front && self.lift != Vec3::ZERO).then(|| Lift { way: self.lift.into(), ns: self.ns.into() })
    }

    /// The way from the point to [`Self::origin`], before it is rounded: the lift, if the ray starts there, and the step along
    /// `ng` out of the error bound.
    pub(crate) fn way_out(&self, direction: Vec3) -> (Option<Vec3>, f64) {
        let lift = self.lift().filter(|lift| lift.is_above(direction.into()));
        let is_behind = lift.is_none() && self.ng.dot(direction.as_dvec3()) < 0.0;
        let Point { position, error } = self.point;
        let points = Points::<f32> { position: position.into(), error: error.into() };
        let step = points.clearance(self.ng.into());
        (lift.map(|lift| lift.way.into()), if is_behind { -step } else { step })
    }

    /// Origin of a ray into `direction`: beyond the error bound, on the side to which the ray leaves.
    pub fn origin(&self, direction: Vec3) -> [f32; 3] {
        let Point { position, error } = self.point;
        let points = Points::<f32> { position: position.into(), error: error.into() };
        points.exits(self.ng.into()).lifted(self.lift().as_ref()).toward(direction.into()).into()
    }
}
