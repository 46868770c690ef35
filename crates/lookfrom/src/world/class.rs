//! Classes of geometries, by the shading that their hits need; known when the world is compiled.

use std::sync::Arc;

use lookfrom_bvh::{Hit, NONE};

use super::World;
use crate::core::points::StoredPlacement;
use crate::primitive::{MaterialBinding, Mesh, Primitives};
use crate::shading::bsdf::BsdfClass;
use crate::shading::material::{Material, MaterialKind};

/// The class of all hits on a geometry, by which integrator steps are sorted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Class {
    /// Triangles without emission, alpha or media of their own, whose material has BSDFs of a class.
    Mesh(BsdfClass),
    /// Anything else.
    General,
}

/// The surface of a plain hit: one on a triangle or sphere outside of instances that emits no light and has no alpha or
/// media of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Plain {
    /// Index into the world's materials.
    pub(crate) material: u32,
    /// Whether it is a sphere.
    pub(crate) is_sphere: bool,
}

/// The materials of the plain surfaces of a geometry; [`NOT_PLAIN`] for others.
#[derive(Clone, Debug)]
pub(crate) enum PlainMaterials {
    /// That of a mesh.
    Mesh(u32),
    /// The materials of spheres.
    Spheres(Vec<u32>),
    /// There are none.
    None,
}

/// No material of a plain surface.
const NOT_PLAIN: u32 = u32::MAX;

impl World {
    /// The materials of the plain surfaces of each geometry.
    fn plain_materials(&self) -> Arc<[PlainMaterials]> {
        let material = |binding: &MaterialBinding| {
            let is_unlit =
                matches!(self.materials[binding.material as usize].kind, MaterialKind::Unlit { .. });
            if binding.is_plain() && !is_unlit { binding.material } else { NOT_PLAIN }
        };
        let of = |primitives: &Primitives| match primitives {
            Primitives::Mesh(mesh) => PlainMaterials::Mesh(material(&mesh.binding)),
            Primitives::Spheres(spheres) => {
                let of = |binding: &u32| material(&spheres.bindings[*binding as usize].binding);
                PlainMaterials::Spheres(spheres.binding_of.iter().map(of).collect())
            }
            _ => PlainMaterials::None,
        };
        self.primitives.iter().map(of).collect()
    }

    /// The surface of a hit, if it is plain.
    #[inline(always)]
    pub(crate) fn plain(&self, hit: &Hit) -> Option<Plain> {
        if !hit.is_hit() || hit.instance != NONE {
            return None;
        }
        let (material, is_sphere) = match &self.plain_materials[hit.geometry as usize] {
            PlainMaterials::Mesh(material) => (*material, false),
            PlainMaterials::Spheres(materials) => (materials[hit.primitive as usize], true),
            PlainMaterials::None => return None,
        };
        (material != NOT_PLAIN).then_some(Plain { material, is_sphere })
    }

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
        self.plain_materials = self.plain_materials();
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
