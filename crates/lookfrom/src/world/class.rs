//! Classes of geometries, by the shading that their hits need; known when the world is compiled.

use lookfrom_bvh::{Hit, NONE, Sphere};

use super::World;
use crate::core::points::StoredPlacement;
use crate::primitive::{MaterialBinding, Mesh, Primitives, Quadric, SphereBinding};
use crate::shading::bsdf::BsdfClass;
use crate::shading::material::{Material, MaterialKind};

/// The classes of the surfaces of a geometry.
#[derive(Clone, Debug)]
pub(crate) enum Class {
    /// All are of one shape.
    One(SurfaceClass),
    /// By primitive.
    Each(Vec<SurfaceClass>),
}

/// The ways in which a surface can be shaded in lanes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfaceClass {
    /// The class of its hits; `None` of materials without a class of BSDFs, and of emission.
    hits: Option<HitClass>,
    /// The surface, if it is bare.
    bare: Option<BareSurface>,
    /// The kind of shape, where the surface is an interface of media and nothing else.
    interface: Option<ShapeClass>,
}

/// A bare surface: one outside of instances that is nothing but its material. It emits no light, has no alpha,
/// media or vertex data of its own, and is seen from both sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BareSurface {
    /// Index into the world's materials.
    pub(crate) material: u32,
    /// The kind of shape that it is of.
    pub(crate) shape: ShapeClass,
}

/// The class of a hit that is shaded in lanes from the hit on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct HitClass {
    /// That of the BSDFs; `None` of materials that are mixed of several with classes.
    pub(crate) bsdf: Option<BsdfClass>,
    /// Index of the material.
    pub(crate) material: u32,
    /// The kind of shape that was hit.
    pub(crate) shape: ShapeClass,
    /// Index into the world's alphas, where the surface has one.
    pub(crate) alpha: Option<u32>,
}

/// The kinds of shapes, by the way in which the points of hits on them are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ShapeClass {
    /// Triangles that stand still, in instances or not: in lanes.
    Mesh,
    /// Spheres outside of instances: in lanes.
    Sphere,
    /// All others: one by one.
    Other,
}

impl ShapeClass {
    /// All of them.
    pub(crate) const ALL: [Self; 3] = [Self::Mesh, Self::Sphere, Self::Other];
}

impl Class {
    #[inline(always)]
    fn of(&self, primitive: u32) -> &SurfaceClass {
        match self {
            Self::One(surface) => surface,
            Self::Each(surfaces) => &surfaces[primitive as usize],
        }
    }
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
        let shape = match primitives {
            Primitives::Mesh(_) => ShapeClass::Mesh,
            Primitives::Spheres(_) => ShapeClass::Sphere,
            _ => ShapeClass::Other,
        };
        let surface = |binding: &MaterialBinding| self.surface_class(binding, shape);
        match primitives {
            Primitives::Mesh(_) | Primitives::Patches(_) | Primitives::Curves(_) => {
                Class::One(surface(primitives.binding(0)))
            }
            Primitives::Spheres(spheres) => {
                let bindings = spheres.binding_of.iter().map(|&of| &spheres.bindings[of as usize].binding);
                Class::Each(bindings.map(surface).collect())
            }
            Primitives::Disks(disks) => Class::Each(disks.bindings.iter().map(surface).collect()),
            Primitives::Quadrics(quadrics) => Class::Each(quadrics.bindings.iter().map(surface).collect()),
        }
    }

    fn surface_class(&self, binding: &MaterialBinding, shape: ShapeClass) -> SurfaceClass {
        let &MaterialBinding { material, alpha, light, single_sided, .. } = binding;
        let Material { kind, .. } = &self.materials[material as usize];
        let is_whole = light.is_none() && !(self.has_open_fronts && single_sided);
        let bsdf = self.materials[material as usize].class();
        let has_class = is_whole && Material::has_class(&self.materials, material);
        let is_bare = binding.is_bare() && !matches!(kind, MaterialKind::Unlit { .. });
        let is_alone = MaterialBinding { medium_interface: None, ..*binding }.is_bare();
        let is_interface = is_alone && matches!(kind, MaterialKind::Interface);
        SurfaceClass {
            hits: has_class.then_some(HitClass { bsdf, material, shape, alpha }),
            bare: is_bare.then_some(BareSurface { material, shape }),
            interface: is_interface.then_some(shape),
        }
    }

    /// The surface of a hit, if it is bare.
    #[inline(always)]
    pub(crate) fn bare_surface(&self, hit: &Hit) -> Option<BareSurface> {
        if !hit.is_hit() || hit.instance != NONE {
            return None;
        }
        self.classes[hit.geometry as usize].of(hit.primitive).bare
    }

    /// The kind of shape of a hit outside of instances, if it is on an interface of media without alpha or vertex data.
    #[inline(always)]
    pub(crate) fn interface(&self, hit: &Hit) -> Option<ShapeClass> {
        if !self.has_media || !hit.is_hit() || hit.instance != NONE {
            return None;
        }
        self.classes[hit.geometry as usize].of(hit.primitive).interface
    }

    /// The class of a hit, if it has one; `None` in instances with a material of their own.
    #[inline]
    pub(crate) fn hit_class(&self, hit: &Hit) -> Option<HitClass> {
        if hit.instance == NONE {
            return self.classes[hit.geometry as usize].of(hit.primitive).hits;
        }
        let instance = &self.instances[hit.instance as usize];
        if instance.material.is_some() {
            return None;
        }
        let class =
            self.object_classes[instance.object as usize][hit.geometry as usize].of(hit.primitive).hits?;
        let is_on_mesh = class.shape == ShapeClass::Mesh && !instance.moves;
        Some(if is_on_mesh { class } else { HitClass { shape: ShapeClass::Other, ..class } })
    }

    /// The mesh of a hit on what stands still, and the placement of the instance that it is in; `None` for other geometries.
    #[inline(always)]
    pub(crate) fn mesh(&self, hit: &Hit) -> Option<(&Mesh, Option<StoredPlacement<'_>>)> {
        let placement = (hit.instance != NONE).then(|| self.standing_placement(hit.instance));
        if let Primitives::Mesh(mesh) = self.primitives_of(hit) { Some((mesh, placement)) } else { None }
    }

    /// The quadric of a hit outside of instances; `None` for other geometries.
    #[inline(always)]
    pub(crate) fn quadric(&self, hit: &Hit) -> Option<&Quadric> {
        match &self.primitives[hit.geometry as usize] {
            Primitives::Quadrics(quadrics) if hit.instance == NONE => {
                Some(&quadrics.quadrics[hit.primitive as usize])
            }
            _ => None,
        }
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
