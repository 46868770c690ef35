//! Surface interactions: the point that a ray hit, with its normals, derivatives and material.
//!
//! Everything is in render space (see `world`).

use glam::{DVec3, Vec2, Vec3};
use lookfrom_bvh::{OriginPrimitive, Point};

use crate::shading::interior_stack::MediumInterface;
use crate::shading::texture::FloatTexture;

/// A point of a surface, seen from a direction.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceInteraction {
    /// Where, in f64, with its error bound.
    pub point: Point,
    /// Geometric normal to the outside, unit length.
    pub ng: DVec3,
    /// Shading normal, unit length, on the side of `ng`.
    pub ns: Vec3,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Derivative of the position by the first texture coordinate: for footprints of textures.
    pub dpdu: Vec3,
    /// By the second one.
    pub dpdv: Vec3,
    /// Those of the smoothed surface, for bump mapping and brushed metal: where there is smoothing, across `ns` and with
    /// the mesh's tangents in place of `dpdu` where it has some.
    pub shading_dpdu: Vec3,
    /// By the second one. Where the mesh has tangents, with it and `ns` this is the tangent frame that normal maps mean:
    /// along `ns × shading_dpdu`, or against it where the tangents say that texture coordinates are mirrored.
    pub shading_dpdv: Vec3,
    /// The mesh's own linear colour here; white where it has none.
    pub color: [f32; 3],
    /// Back to where the ray came from, unit length.
    pub wo: Vec3,
    /// Whether `wo` is on the side of `ng`: the ray met the outside.
    pub front: bool,
    /// Index into the world's materials.
    pub material: u32,
    /// Index into the world's area lights, where the surface emits light.
    pub light: Option<u32>,
    /// Whether rays from the camera pass its back faces.
    pub single_sided: bool,
    /// Index into the world's meshes with further texture coordinates or opacities, where this is one.
    pub vertex_data: Option<u32>,
    /// The part of the surface that is there; `None` is all of it.
    pub alpha: Option<FloatTexture>,
    /// What fills space on both sides, where the surface says so.
    pub medium_interface: Option<MediumInterface>,
    /// Which shape of the scene, counted over the whole world.
    pub shape: u32,
    /// Which primitive of its form: of a mesh, the triangle.
    pub primitive: u32,
    /// The triangle, as the kernel is told that rays leave it.
    pub origin_primitive: OriginPrimitive,
    /// The kernel's u and v: where on the primitive.
    pub on_primitive: Vec2,
}

impl SurfaceInteraction {
    /// The geometric normal on the side of `wo`.
    pub fn ng_facing(&self) -> Vec3 {
        let n = self.ng.as_vec3();
        if self.front { n } else { -n }
    }

    /// The shading normal on the side of `wo`; where smoothing turned it away from `wo`, the geometric one.
    pub fn ns_facing(&self) -> Vec3 {
        let n = if self.front { self.ns } else { -self.ns };
        if n.dot(self.wo) > 0.0 { n } else { self.ng_facing() }
    }

    /// Where a ray into `direction` starts: beyond the error bound, on the side that it leaves to.
    pub fn origin(&self, direction: Vec3) -> [f32; 3] {
        self.point.leave(self.ng.to_array(), direction.to_array())
    }
}
