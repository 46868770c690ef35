//! An estimate of the memory that compiling a scene takes, with its trees and lights: what was measured at the peak, by kinds
//! of things (docs/benchmarks/memory.md), besides the scene itself.

use lookfrom_scene::scene::{Instance, Scene};
use lookfrom_scene::shape::{Geometry, Shape};
use lookfrom_scene::texture::TextureKind;

use super::World;

/// Bytes of a triangle: the primitive, its part of the tree, and what building the tree takes.
const TRIANGLE: u64 = 165;
/// Bytes of a sphere of many, or of a bilinear patch.
const PRIMITIVE: u64 = 160;
/// Bytes of the surface of a body in a solid, which may have six sides and other bodies.
const SOLID_SURFACE: u64 = 8192;
/// Bytes of a curve: its pieces' part of the tree, and what building the tree takes.
const CURVE: u64 = 700;
/// Bytes of a shape, apart from its primitives, with its name and its binding to a material.
const SHAPE: u64 = 600;
/// Bytes of an instance, and what building the tree over it takes; as written it is freed before.
const INSTANCE: u64 = 400;
/// Bytes of a triangle, and of an instance, for each further time of its motion.
const MOVING_TRIANGLE: u64 = 120;
const MOVING_INSTANCE: u64 = 200;
/// Bytes of a primitive that emits light: the light, and its part of the light tree.
const LIGHT: u64 = 160;

impl World {
    /// The bytes that [`World::compile`] takes for a scene at its peak, besides [`Scene::bytes`]. An estimate: at most a
    /// quarter less than it is.
    pub fn memory(scene: &Scene) -> u64 {
        let of = |shapes: &mut dyn Iterator<Item = &Shape>| -> u64 {
            shapes.map(|shape| of_shape(shape, scene)).fold(0, u64::saturating_add)
        };
        // Shapes in objects that emit light are placed once for each instance, the others once.
        let is_lit = |shape: &&Shape| shape.emission.is_some();
        let dark = |shape: &&Shape| !is_lit(shape);
        let objects: u64 =
            scene.objects.iter().map(|object| of(&mut object.shapes.iter().filter(dark))).sum();
        let lit: Vec<u64> =
            (scene.objects.iter()).map(|object| of(&mut object.shapes.iter().filter(is_lit))).collect();
        let of_instance = |instance: &Instance| {
            let lit = lit.get(instance.object.index()).copied().unwrap_or(0);
            let times = instance.motion.as_ref().map_or(0, |motion| motion.maps().len() as u64);
            INSTANCE + times * MOVING_INSTANCE + lit
        };
        let instances = scene.instances.iter().map(of_instance).fold(0, u64::saturating_add);
        (of(&mut scene.shapes.iter()) + objects + of_mip_maps(scene)).saturating_add(instances)
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
            let times = mesh.map_or(0, |mesh| mesh.later.len() as u64);
            (mesh.map_or(0, |mesh| mesh.triangles.len()), TRIANGLE + times * MOVING_TRIANGLE)
        }
        Geometry::Spheres(spheres) => (spheres.len(), PRIMITIVE),
        Geometry::Bilinear(patches) => (patches.patches.len(), PRIMITIVE),
        Geometry::Curves(strands) => (strands.len(), CURVE),
        Geometry::SolidSurface { .. } => (1, SOLID_SURFACE),
        _ => (1, PRIMITIVE),
    };
    let light = if shape.emission.is_some() { LIGHT } else { 0 };
    SHAPE + primitives as u64 * (bytes + light)
}

#[cfg(test)]
mod tests {
    use glam::{DMat4, DVec3};
    use lookfrom_scene::Location;
    use lookfrom_scene::material::Color;
    use lookfrom_scene::scene::{MaterialId, Object, ObjectId};
    use lookfrom_scene::shape::{Emission, Sphere};

    use super::*;

    #[test]
    fn each_instance_of_a_light_is_counted() {
        let lamp = Geometry::Sphere(Sphere { center: DVec3::ZERO, radius: 1.0 });
        let dark = Shape::new(Location::default(), lamp, MaterialId(0));
        let lit = Shape { emission: Some(Emission::new(Color::gray(1.0), false)), ..dark.clone() };
        let memory = |shape: &Shape, count: usize| {
            let object = Object { name: String::new(), at: Location::default(), shapes: vec![shape.clone()] };
            let (at, world_from_object) = (Location::default(), DMat4::IDENTITY);
            let instance = Instance::new(at, ObjectId(0), world_from_object);
            let instances = vec![instance; count];
            World::memory(&Scene { objects: vec![object], instances, ..Scene::default() })
        };
        assert_eq!(memory(&dark, 1000) - memory(&dark, 0), 1000 * INSTANCE);
        assert_eq!(memory(&lit, 1000) - memory(&lit, 0), 1000 * (INSTANCE + SHAPE + PRIMITIVE + LIGHT));
    }

    #[test]
    fn a_million_instances_take_600_megabytes() {
        let at = Location::default();
        let object = Object { name: String::new(), at: at.clone(), shapes: Vec::new() };
        let instance = Instance::new(at, ObjectId(0), DMat4::IDENTITY);
        let scene = Scene { objects: vec![object], instances: vec![instance; 1000], ..Scene::default() };
        assert_eq!(scene.bytes() + World::memory(&scene), 600 * 1000);
        // Of them after compilation, with the kernel's 176 and its tree's 100:
        assert_eq!(size_of::<crate::world::Instance>(), 184);
    }
}
