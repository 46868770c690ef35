//! The surfaces of camera rays' hits on meshes, eight side by side, where no step has left them.

use glam::DVec3;
use lookfrom_bvh::{Hit, NONE, Ray};
use lookfrom_simd::{Kernel, Simd, dispatch, level};

use super::FirstSurfaceColumns;
use crate::core::lanes::{LANES, by_lane, gather, row, set_row, store, store_f64};
use crate::core::points::StoredPlacement;
use crate::core::vector::Vector;
use crate::primitive::{Mesh, VertexData, points_on_meshes};
use crate::shading::material::{self, Material, MaterialKind};
use crate::shading::texture::TexturePoint;
use crate::world::World;

/// A hit on a mesh whose material leaves normals as they are.
#[derive(Clone, Copy)]
pub(crate) struct FirstMeshHit<'a> {
    ray: &'a Ray,
    hit: &'a Hit,
    mesh: &'a Mesh,
    material: &'a Material,
    /// The placement of the instance that the mesh is in.
    placement: Option<StoredPlacement<'a>>,
    slot: u32,
}

impl<'a> FirstMeshHit<'a> {
    /// A hit of the camera ray of a slot, if it is such a one.
    pub(crate) fn of(world: &'a World, slot: u32, ray: &'a Ray, hit: &'a Hit) -> Option<Self> {
        if !hit.is_hit() || hit.instance != NONE && world.instance(hit.instance).instance.material.is_some() {
            return None;
        }
        let (mesh, material, placement) = world.mesh(hit)?;
        let bends = material.has_bumps() || matches!(material.kind, MaterialKind::Mix { .. });
        (!bends).then_some(Self { ray, hit, mesh, material, placement, slot })
    }

    /// Whether no part of the surface lets light pass as if it were not there.
    pub(crate) fn is_whole(&self) -> bool {
        let binding = &self.mesh.binding;
        binding.alpha.is_none()
            && !binding.single_sided
            && !matches!(self.material.kind, MaterialKind::Interface)
    }

    /// The surfaces of one to eight hits.
    pub(crate) fn surfaces(world: &World, hits: &[Self], eight: &mut FirstSurfaceColumns) {
        let Some(last) = hits.last() else { return };
        eight.lanes = (1 << hits.len()) - 1;
        // Unused lanes repeat the last hit.
        let eight_hits = by_lane!(lane => *hits.get(lane).unwrap_or(last));
        set_surfaces(SurfaceKernel { hits: &eight_hits, eight });
        for (lane, &FirstMeshHit { hit, mesh, material, slot, .. }) in hits.iter().enumerate() {
            eight.slots[lane] = slot;
            let albedo = material.even_albedo().unwrap_or_else(|| {
                let (position, ng) = (row(&eight.position, lane), row(&eight.ng, lane));
                let point = texture_point(world, mesh, hit, [position, ng], row(&eight.uv, lane));
                material::albedo(&world.materials, &world.textures, material, &point)
            });
            set_row(&mut eight.albedo, lane, albedo);
        }
    }
}

/// The inputs of texture evaluation at a hit on a mesh, by position and geometric normal, and texture coordinates.
#[inline]
pub(super) fn texture_point<'a>(
    world: &World,
    mesh: &'a Mesh,
    hit: &Hit,
    [position, ng]: [[f64; 3]; 2],
    uv: [f32; 2],
) -> TexturePoint<'a> {
    let Hit { primitive, u: b1, v: b2, .. } = *hit;
    let point = TexturePoint {
        uv: uv.into(),
        world: world.origin + DVec3::from_array(position),
        color: mesh.color(primitive as usize, b1, b2),
        n: DVec3::from_array(ng).as_vec3(),
        ..TexturePoint::NOWHERE
    };
    if !mesh.has_vertex_data() {
        return point;
    }
    let VertexData { more_uvs, opacity } = mesh.vertex_data(primitive as usize, b1, b2);
    TexturePoint { more_uvs, opacity, ..point }
}

#[inline(never)]
fn set_surfaces(kernel: SurfaceKernel<'_>) {
    dispatch(level(), kernel);
}

struct SurfaceKernel<'a> {
    hits: &'a [FirstMeshHit<'a>; LANES],
    eight: &'a mut FirstSurfaceColumns,
}

impl Kernel for SurfaceKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { hits, eight } = self;
        let at = points_on_meshes(
            simd,
            &by_lane!(lane => hits[lane].mesh),
            &by_lane!(lane => hits[lane].hit),
            &by_lane!(lane => hits[lane].placement),
            true,
        );
        let direction = gather(simd, &by_lane!(lane => hits[lane].ray.direction));
        eight.position = store_f64(at.points.position);
        eight.ng = store_f64(at.ng);
        eight.ns = store(Vector::narrow(at.ns));
        eight.wo = store(Vector::narrow(-direction.widen().normalize()));
        eight.uv = [at.uv[0].into(), at.uv[1].into()];
    }
}
