//! Classes of geometries: what their hits need, known when the world is compiled.

use super::World;
use crate::material::{MaterialKind, Relief};
use crate::shape::{Form, Mesh};
use crate::texture::SpectrumTexture;

/// What all hits on a geometry (outside of instances) have in common, which steps are sorted by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Class {
    /// Flat triangles of a diffuse material of one colour, without emission, alpha, relief or media of their own.
    FlatDiffuse,
    /// Anything else.
    General,
}

impl World {
    /// The class of each geometry, of which the materials are compiled.
    pub(super) fn classify(forms: &[Form], materials: &[crate::material::Material]) -> Vec<Class> {
        let class = |form: &Form| {
            let Form::Mesh(mesh) = form else { return Class::General };
            let look = &mesh.look;
            let is_flat = mesh.normals.is_empty() && !mesh.wants_derivatives;
            let is_plain = look.light.is_none()
                && look.alpha.is_none()
                && look.medium_interface.is_none()
                && !look.single_sided;
            let material = &materials[look.material as usize];
            let is_even = match (&material.kind, &material.relief) {
                (MaterialKind::Diffuse { reflectance }, Relief::None) => reflectance.is_constant(),
                _ => false,
            };
            if is_flat && is_plain && is_even { Class::FlatDiffuse } else { Class::General }
        };
        forms.iter().map(class).collect()
    }

    /// The mesh and the reflectance of a geometry of the class [`Class::FlatDiffuse`]; `None` for others.
    #[inline]
    pub(crate) fn flat_diffuse(&self, geometry: u32) -> Option<(&Mesh, &SpectrumTexture)> {
        if self.classes[geometry as usize] != Class::FlatDiffuse {
            return None;
        }
        let Form::Mesh(mesh) = &self.forms[geometry as usize] else { return None };
        match &self.materials[mesh.look.material as usize].kind {
            MaterialKind::Diffuse { reflectance } => Some((mesh, reflectance)),
            _ => None,
        }
    }
}
