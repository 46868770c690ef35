//! Classes of geometries, by the shading that their hits need; known when the world is compiled.

use lookfrom_bvh::{Hit, NONE};

use super::World;
use crate::core::points::StoredPlacement;
use crate::primitive::{Mesh, Primitives};
use crate::shading::bsdf::lanes::BsdfClass;
use crate::shading::material::Material;

/// The class of all hits on a geometry, by which integrator steps are sorted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Class {
    /// Triangles without emission, alpha or media of their own, whose material has BSDFs of a class.
    Mesh(BsdfClass),
    /// Anything else.
    General,
}

impl World {
    /// The class of each geometry, by its compiled material.
    pub(super) fn classify(&mut self) {
        let class = |primitives: &Primitives| {
            let Primitives::Mesh(mesh) = primitives else { return Class::General };
            let is_whole =
                mesh.binding.is_only_material() && !(self.has_open_fronts && mesh.binding.single_sided);
            let class = self.materials[mesh.binding.material as usize].class();
            class.filter(|_| is_whole).map_or(Class::General, Class::Mesh)
        };
        let classes = self.primitives.iter().map(class).collect();
        let object_classes = self.objects.iter().map(|object| object.iter().map(class).collect()).collect();
        (self.classes, self.object_classes) = (classes, object_classes);
    }

    /// The class of a hit on a [`Class::Mesh`]; `None` for others, and for instances with a material of their own.
    #[inline]
    pub(crate) fn mesh_class(&self, hit: &Hit) -> Option<BsdfClass> {
        let class = match hit.instance {
            NONE => self.classes[hit.geometry as usize],
            instance => {
                let instance = &self.instances[instance as usize];
                let class = self.object_classes[instance.object as usize][hit.geometry as usize];
                if instance.material.is_none() { class } else { Class::General }
            }
        };
        match class {
            Class::Mesh(class) => Some(class),
            Class::General => None,
        }
    }

    /// The mesh of a hit, its material, and the placement of the instance that it is in; `None` for other geometries.
    #[inline]
    pub(crate) fn mesh(&self, hit: &Hit) -> Option<(&Mesh, &Material, Option<StoredPlacement<'_>>)> {
        let (primitives, instance) = self.primitives(hit);
        let Primitives::Mesh(mesh) = primitives else { return None };
        let material = &self.materials[mesh.binding.material as usize];
        Some((mesh, material, instance.map(|placed| placed.placement)))
    }
}
