//! An estimate of the memory that compiling a scene takes, with its trees and lights: what was measured at the peak, by kinds
//! of things (docs/benchmarks/memory.md), besides the scene itself.

use lookfrom_scene::scene::Scene;
use lookfrom_scene::shape::{Geometry, Shape};
use lookfrom_scene::texture::TextureKind;

use super::World;

/// Bytes of a triangle: the primitive, its part of the tree, and what building the tree takes.
const TRIANGLE: u64 = 165;
/// Bytes of a sphere of many, a bilinear patch or a piece of a curve.
const PRIMITIVE: u64 = 160;
/// Bytes of a shape, apart from its primitives, with its name and its binding to a material.
const SHAPE: u64 = 600;
/// Bytes of an instance, and what building the tree over it takes; as written it is freed before.
const INSTANCE: u64 = 400;
/// Bytes of a primitive that emits light: the light, and its part of the light tree.
const LIGHT: u64 = 160;

impl World {
    /// The bytes that [`World::compile`] takes for a scene at its peak, besides [`Scene::bytes`]. An estimate: at most a
    /// quarter less than it is.
    pub fn memory(scene: &Scene) -> u64 {
        let of = |shapes: &[Shape]| shapes.iter().map(|shape| of_shape(shape, scene)).sum::<u64>();
        let objects: u64 = scene.objects.iter().map(|object| of(&object.shapes)).sum();
        of(&scene.shapes) + objects + scene.instances.len() as u64 * INSTANCE + of_mip_maps(scene)
    }
}

/// Bytes of the levels of MIP maps besides the images themselves.
fn of_mip_maps(scene: &Scene) -> u64 {
    let mut filtered = vec![false; scene.images.len()];
    for texture in &scene.textures {
        if let TextureKind::Image { image, filter, .. } = &texture.kind
            && let Some(is_filtered) = filtered.get_mut(image.index())
        {
            *is_filtered |= filter.takes_levels();
        }
    }
    let levels = scene.images.iter().zip(filtered).filter(|(_, is_filtered)| *is_filtered);
    levels.map(|(image, _)| image.bytes_of_levels()).sum()
}

fn of_shape(shape: &Shape, scene: &Scene) -> u64 {
    let (primitives, bytes) = match &shape.geometry {
        Geometry::Mesh(id) => {
            let mesh = scene.meshes.get(id.index());
            (mesh.map_or(0, |mesh| mesh.triangles.len()), TRIANGLE)
        }
        Geometry::Spheres(spheres) => (spheres.len(), PRIMITIVE),
        Geometry::Bilinear(patches) => (patches.patches.len(), PRIMITIVE),
        Geometry::Curves(strands) => (strands.len(), PRIMITIVE),
        _ => (1, PRIMITIVE),
    };
    let light = if shape.emission.is_some() { LIGHT } else { 0 };
    SHAPE + primitives as u64 * (bytes + light)
}

#[cfg(test)]
mod tests {
    use glam::DMat4;
    use lookfrom_scene::Location;
    use lookfrom_scene::scene::{Instance, Object, ObjectId};

    use super::*;

    #[test]
    fn a_million_instances_take_less_than_600_megabytes() {
        let at = Location::default();
        let object = Object { name: String::new(), at: at.clone(), shapes: Vec::new() };
        let instance =
            Instance { at, object: ObjectId(0), world_from_object: DMat4::IDENTITY, material: None };
        let scene = Scene { objects: vec![object], instances: vec![instance; 1000], ..Scene::default() };
        assert_eq!(scene.bytes() + World::memory(&scene), 584 * 1000);
        // Of them after compilation, with the kernel's 176 and its tree's 100:
        assert_eq!(size_of::<crate::world::Instance>(), 184);
    }
}
