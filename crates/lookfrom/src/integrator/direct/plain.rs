//! Plain hits: those on surfaces of the commonest kinds, which are shaded for eight paths side by side.

use lookfrom_bvh::{Hit, NONE, Sphere};

use crate::core::spectrum::Spectrum;
use crate::integrator::Path;
use crate::primitive::{MaterialBinding, Mesh, Primitives, SphereBinding};
use crate::shading::material::MaterialKind;
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// A hit on a triangle or sphere outside of instances that emits no light and has no alpha or media of its own.
#[derive(Clone, Copy)]
pub(super) struct PlainHit<'a> {
    pub(super) path: &'a Path,
    pub(super) hit: &'a Hit,
    pub(super) shape: PlainShape<'a>,
    /// Index into the world's materials.
    pub(super) material: u32,
    /// Index of the path among those that are stepped together.
    pub(super) index: u32,
}

/// The primitive that was hit.
#[derive(Clone, Copy)]
pub(super) enum PlainShape<'a> {
    Triangle(&'a Mesh),
    Sphere(&'a Sphere, &'a SphereBinding),
}

impl<'a> PlainHit<'a> {
    /// The hit, if it is plain.
    #[inline(always)]
    pub(super) fn of(world: &'a World, index: usize, path: &'a Path, hit: &'a Hit) -> Option<Self> {
        if !hit.is_hit() || hit.instance != NONE {
            return None;
        }
        let primitive = hit.primitive as usize;
        let (shape, binding) = match &world.primitives[hit.geometry as usize] {
            Primitives::Mesh(mesh) => (PlainShape::Triangle(mesh), &mesh.binding),
            Primitives::Spheres(spheres) => {
                let of_sphere = &spheres.bindings[spheres.binding_of[primitive] as usize];
                (PlainShape::Sphere(&spheres.spheres[primitive], of_sphere), &of_sphere.binding)
            }
            _ => return None,
        };
        let material = binding.material;
        is_plain(world, binding).then_some(Self { path, hit, shape, material, index: index as u32 })
    }

    /// The path's throughput, attenuated by the medium on the way.
    #[inline(always)]
    pub(super) fn throughput(&self, world: &World, mode: &SpectralMode) -> Spectrum {
        let Path { beta, interior, .. } = *self.path;
        match interior.is_empty() {
            true => beta,
            false => beta * world.transmittance(interior, self.path.length_to(self.hit), mode),
        }
    }

    /// Whether it is on a sphere.
    #[inline(always)]
    pub(super) fn is_on_sphere(&self) -> bool {
        matches!(self.shape, PlainShape::Sphere(..))
    }
}

#[inline(always)]
fn is_plain(world: &World, binding: &MaterialBinding) -> bool {
    binding.is_plain()
        && !matches!(world.materials[binding.material as usize].kind, MaterialKind::Unlit { .. })
}
