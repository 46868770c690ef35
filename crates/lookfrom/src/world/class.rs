//! Classes of geometries, by the shading that their hits need; known when the world is compiled.

use super::World;
use crate::primitive::{Mesh, Primitives};
use crate::shading::material::{BumpMapping, MaterialKind};
use crate::shading::texture::SpectrumTexture;

/// The class of all hits on a geometry (outside of instances), by which integrator steps are sorted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Class {
    /// Flat triangles of a diffuse material of one colour, without emission, alpha, bump mapping or media of their own.
    FlatDiffuse,
    /// Anything else.
    General,
}

impl World {
    /// The class of each geometry, by its compiled material.
    pub(super) fn classify(
        primitives: &[Primitives],
        materials: &[crate::shading::material::Material],
    ) -> Vec<Class> {
        let class = |primitives: &Primitives| {
            let Primitives::Mesh(mesh) = primitives else { return Class::General };
            let binding = &mesh.binding;
            let is_flat = mesh.normals.is_empty() && !mesh.wants_derivatives;
            let is_plain = binding.light.is_none()
                && binding.alpha.is_none()
                && binding.medium_interface.is_none()
                && !binding.single_sided;
            let material = &materials[binding.material as usize];
            let is_even = match (&material.kind, &material.bump_mapping) {
                (MaterialKind::Diffuse { reflectance }, BumpMapping::None) => reflectance.is_constant(),
                _ => false,
            };
            if is_flat && is_plain && is_even { Class::FlatDiffuse } else { Class::General }
        };
        primitives.iter().map(class).collect()
    }

    /// The mesh and the reflectance of a geometry of the class [`Class::FlatDiffuse`]; `None` for others.
    #[inline]
    pub(crate) fn flat_diffuse(&self, geometry: u32) -> Option<(&Mesh, &SpectrumTexture)> {
        if self.classes[geometry as usize] != Class::FlatDiffuse {
            return None;
        }
        let Primitives::Mesh(mesh) = &self.primitives[geometry as usize] else { return None };
        match &self.materials[mesh.binding.material as usize].kind {
            MaterialKind::Diffuse { reflectance } => Some((mesh, reflectance)),
            _ => None,
        }
    }
}
