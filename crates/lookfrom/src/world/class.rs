//! Classes of geometries, by the shading that their hits need; known when the world is compiled.

use lookfrom_bvh::{Hit, NONE, Sphere};

use super::World;
use crate::core::points::StoredPlacement;
use crate::primitive::{MaterialBinding, Mesh, Primitives, SphereBinding};
use crate::shading::bsdf::BsdfClass;
use crate::shading::material::{Material, MaterialKind};

/// The class of all hits on a geometry.
#[derive(Clone, Debug)]
pub(crate) enum Class {
    /// A mesh.
    Mesh {
        /// That of hits which are shaded in lanes: where its material has a class of BSDFs, and it has no emission.
        hits: Option<HitClass>,
        /// Its material, where it is bare.
        bare: Option<u32>,
        /// Whether it is an interface of media and nothing else.
        is_interface: bool,
    },
    /// Spheres.
    Spheres {
        /// The material of each one that is bare.
        bare: Vec<Option<u32>>,
        /// The class of hits on each one, as for meshes.
        hits: Vec<Option<HitClass>>,
        /// Whether each is an interface of media and nothing else.
        are_interfaces: Vec<bool>,
    },
    /// Anything else.
    General,
}

/// A bare surface: a triangle or sphere outside of instances that is nothing but its material. It emits no light, has no alpha,
/// media or vertex data of its own, and is seen from both sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BareSurface {
    /// Index into the world's materials.
    pub(crate) material: u32,
    /// Whether it is a sphere.
    pub(crate) is_sphere: bool,
}

/// The class of a hit that is shaded in lanes from the hit on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct HitClass {
    /// That of the BSDFs; `None` of materials that are mixed of several with classes.
    pub(crate) bsdf: Option<BsdfClass>,
    /// Index of the material.
    pub(crate) material: u32,
    /// Whether it is on a sphere, and not on a mesh.
    pub(crate) is_sphere: bool,
    /// Index into the world's alphas, where the surface has one.
    pub(crate) alpha: Option<u32>,
}

impl World {
    /// Finds the class of each geometry.
    pub(super) fn classify(&mut self) {
        self.classes = self.primitives.iter().map(|primitives| self.class(primitives)).collect();
        let objects = self.objects.iter();
        self.object_classes =
            objects.map(|object| object.iter().map(|primitives| self.class(primitives)).collect()).collect();
    }

    fn class(&self, primitives: &Primitives) -> Class {
        let bare = |binding: &MaterialBinding| {
            let kind = &self.materials[binding.material as usize].kind;
            let is_bare = binding.is_bare() && !matches!(kind, MaterialKind::Unlit { .. });
            is_bare.then_some(binding.material)
        };
        let is_interface = |binding: &MaterialBinding| {
            let is_alone = MaterialBinding { medium_interface: None, ..*binding }.is_bare();
            is_alone && matches!(self.materials[binding.material as usize].kind, MaterialKind::Interface)
        };
        let hits_on = |binding: &MaterialBinding, is_sphere: bool| {
            let is_whole = binding.light.is_none() && !(self.has_open_fronts && binding.single_sided);
            let &MaterialBinding { material, alpha, .. } = binding;
            let bsdf = self.materials[material as usize].class();
            let has_class = is_whole && Material::has_class(&self.materials, material);
            has_class.then_some(HitClass { bsdf, material, is_sphere, alpha })
        };
        match primitives {
            Primitives::Mesh(mesh) => Class::Mesh {
                hits: hits_on(&mesh.binding, false),
                bare: bare(&mesh.binding),
                is_interface: is_interface(&mesh.binding),
            },
            Primitives::Spheres(spheres) => {
                let bindings = || spheres.binding_of.iter().map(|&of| &spheres.bindings[of as usize].binding);
                Class::Spheres {
                    bare: bindings().map(bare).collect(),
                    hits: bindings().map(|binding| hits_on(binding, true)).collect(),
                    are_interfaces: bindings().map(is_interface).collect(),
                }
            }
            _ => Class::General,
        }
    }

    /// The surface of a hit, if it is bare.
    #[inline(always)]
    pub(crate) fn bare_surface(&self, hit: &Hit) -> Option<BareSurface> {
        if !hit.is_hit() || hit.instance != NONE {
            return None;
        }
        let (material, is_sphere) = match &self.classes[hit.geometry as usize] {
            Class::Mesh { bare, .. } => (*bare, false),
            Class::Spheres { bare, .. } => (bare[hit.primitive as usize], true),
            Class::General => return None,
        };
        material.map(|material| BareSurface { material, is_sphere })
    }

    /// Whether a hit is on a triangle or sphere outside of instances that is an interface of media, without alpha or vertex data; then
    /// also whether it is a sphere.
    #[inline(always)]
    pub(crate) fn interface(&self, hit: &Hit) -> Option<bool> {
        if !self.has_media || !hit.is_hit() || hit.instance != NONE {
            return None;
        }
        match &self.classes[hit.geometry as usize] {
            Class::Mesh { is_interface, .. } => is_interface.then_some(false),
            Class::Spheres { are_interfaces, .. } => are_interfaces[hit.primitive as usize].then_some(true),
            Class::General => None,
        }
    }

    /// The class of a hit on a mesh, or a sphere outside of instances, that has one; `None` for instances with a material of their own,
    /// or that move.
    #[inline]
    pub(crate) fn hit_class(&self, hit: &Hit) -> Option<HitClass> {
        let class = match hit.instance {
            NONE => &self.classes[hit.geometry as usize],
            instance => {
                let instance = &self.instances[instance as usize];
                if instance.material.is_some() || instance.moves {
                    return None;
                }
                &self.object_classes[instance.object as usize][hit.geometry as usize]
            }
        };
        match class {
            Class::Mesh { hits, .. } => *hits,
            Class::Spheres { hits, .. } if hit.instance == NONE => hits[hit.primitive as usize],
            Class::Spheres { .. } | Class::General => None,
        }
    }

    /// The mesh of a hit on what stands still, and the placement of the instance that it is in; `None` for other geometries.
    #[inline(always)]
    pub(crate) fn mesh(&self, hit: &Hit) -> Option<(&Mesh, Option<StoredPlacement<'_>>)> {
        let (primitives, placement) = match hit.instance {
            NONE => (&self.primitives[hit.geometry as usize], None),
            id => {
                let object = self.instances[id as usize].object as usize;
                (&self.objects[object][hit.geometry as usize], Some(self.standing_placement(id)))
            }
        };
        if let Primitives::Mesh(mesh) = primitives { Some((mesh, placement)) } else { None }
    }

    /// The sphere of a hit outside of instances; `None` for other geometries.
    #[inline(always)]
    pub(crate) fn sphere(&self, hit: &Hit) -> Option<(&Sphere, &SphereBinding)> {
        if hit.instance != NONE {
            return None;
        }
        let Primitives::Spheres(spheres) = &self.primitives[hit.geometry as usize] else { return None };
        Some(spheres.get(hit.primitive as usize))
    }
}
