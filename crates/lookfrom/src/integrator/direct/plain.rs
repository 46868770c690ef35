//! Plain hits: those on surfaces of the commonest kinds, which are shaded for eight paths side by side.

use lookfrom_bvh::{Hit, NONE, Sphere};

use crate::core::spectrum::Spectrum;
use crate::integrator::Path;
use crate::primitive::{MaterialBinding, Mesh, Primitives, SphereBinding};
use crate::shading::material::{Coefficients, MaterialKind, Whitted};
use crate::shading::texture::{SpectralMode, SpectrumTexture, TexturePoint, sphere_uv};
use crate::world::World;

/// A hit on a triangle or sphere outside of instances that emits no light and has no alpha or media of its own.
#[derive(Clone, Copy)]
pub(super) struct PlainHit<'a> {
    pub(super) path: &'a Path,
    pub(super) hit: &'a Hit,
    pub(super) shape: PlainShape<'a>,
    /// Index into the world's materials.
    pub(super) material: u32,
    /// The path's throughput, attenuated by the medium on the way.
    pub(super) beta: Spectrum,
}

/// The primitive that was hit.
#[derive(Clone, Copy)]
pub(super) enum PlainShape<'a> {
    Triangle(&'a Mesh),
    Sphere(Sphere, &'a SphereBinding),
}

impl<'a> PlainHit<'a> {
    /// The hit, if it is plain.
    #[inline]
    pub(super) fn of(world: &'a World, path: &'a Path, hit: &'a Hit, lanes: &SpectralMode) -> Option<Self> {
        if !hit.is_hit() || hit.instance != NONE {
            return None;
        }
        let index = hit.primitive as usize;
        let (shape, binding) = match &world.primitives[hit.geometry as usize] {
            Primitives::Mesh(mesh) => (PlainShape::Triangle(mesh), &mesh.binding),
            Primitives::Spheres(spheres) => {
                let of_sphere = &spheres.bindings[spheres.binding_of[index] as usize];
                (PlainShape::Sphere(spheres.spheres[index], of_sphere), &of_sphere.binding)
            }
            _ => return None,
        };
        is_plain(world, binding).then(|| {
            let beta = path.absorbed(world, hit, lanes).beta;
            Self { path, hit, shape, material: binding.material, beta }
        })
    }

    /// The texture coordinates and the vertex colour. `outward` is the normal of a sphere.
    fn uv_and_color(&self, outward: [f32; 3]) -> ([f32; 2], [f32; 3]) {
        match self.shape {
            PlainShape::Triangle(mesh) => {
                let Hit { u, v, primitive, .. } = *self.hit;
                let [uv0, uv1, uv2] = mesh.corner_uvs(primitive as usize);
                let uv = (1.0 - u - v) * uv0 + u * uv1 + v * uv2;
                (uv.to_array(), mesh.color(primitive as usize, u, v))
            }
            PlainShape::Sphere(_, binding) => {
                (sphere_uv(binding.object_from_sphere * glam::Vec3::from(outward)).to_array(), [1.0; 3])
            }
        }
    }

    /// Whether all are of one material whose coefficients are the same everywhere.
    #[inline]
    pub(super) fn are_even(world: &World, eight: &[Self]) -> bool {
        let material = eight[0].material;
        eight.iter().all(|plain| plain.material == material)
            && !varies(&world.materials[material as usize].whitted)
    }

    /// Whitted's coefficients at a position in render space, where the geometric normal is `ng`.
    #[inline]
    pub(super) fn coefficients(
        &self,
        world: &World,
        position: [f64; 3],
        ng: [f32; 3],
        lanes: &SpectralMode,
    ) -> Coefficients {
        let material = &world.materials[self.material as usize].whitted;
        let point = match varies(material) {
            true => self.texture_point(world, position, ng),
            false => TexturePoint::NOWHERE,
        };
        Coefficients::at(material, &world.textures, &point, lanes)
    }

    #[inline(never)]
    fn texture_point(&self, world: &World, position: [f64; 3], ng: [f32; 3]) -> TexturePoint<'_> {
        let is_flipped = matches!(self.shape, PlainShape::Sphere(_, binding) if binding.flip);
        let outward = if is_flipped { ng.map(|x| -x) } else { ng };
        let (uv, color) = self.uv_and_color(outward);
        TexturePoint {
            uv: uv.into(),
            world: world.origin + glam::DVec3::from_array(position),
            color,
            n: ng.into(),
            ..TexturePoint::NOWHERE
        }
    }
}

fn is_plain(world: &World, binding: &MaterialBinding) -> bool {
    binding.is_plain()
        && !matches!(world.materials[binding.material as usize].kind, MaterialKind::Unlit { .. })
}

/// Whether any of the coefficients varies over a surface.
#[inline]
fn varies(material: &Whitted) -> bool {
    let Whitted { ambient, diffuse, specular, mirror, transmission, .. } = material;
    [diffuse, specular, mirror, transmission].into_iter().chain(ambient).any(SpectrumTexture::varies)
}
