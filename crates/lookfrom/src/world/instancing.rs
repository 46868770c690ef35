//! Objects and their instances, on the way to the tree of a world.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use glam::DMat4;
use lookfrom_bvh::{Affine, Builder, Bvh, Quality};
use lookfrom_scene::Result;
use lookfrom_scene::motion::Motion;
use lookfrom_scene::scene::{Instance as WrittenInstance, MaterialId, Scene};
use lookfrom_scene::shape::{Geometry, Shape};

use super::ShapeLabel;
use super::compile::tree;
use super::place::{self, Compiler, Group, Labels};
use crate::core::math;
use crate::light::LightMotion;
use crate::primitive::Primitives;

/// The objects of a scene, and what has been placed of them.
pub(super) struct Instancing<'a> {
    scene: &'a Scene,
    labels: &'a Labels,
    /// The primitives of each object of the scene, and then of each group of shapes that emit light and move.
    pub(super) objects: Vec<Vec<Primitives>>,
    /// The object and the material of each instance.
    pub(super) placed: Vec<(u32, Option<u32>)>,
}

impl<'a> Instancing<'a> {
    /// Objects, each in its own space, without the shapes that emit light: these are left to the instances.
    pub(super) fn new(compiler: &mut Compiler<'a>, labels: &'a Labels) -> Result<Self> {
        let scene = compiler.scene;
        let placed = Vec::with_capacity(scene.instances.len());
        let mut objects = Self { scene, labels, objects: Vec::new(), placed };
        let mut groups = Vec::new();
        let is_grained = |id: MaterialId| compiler.grains.get(id.index()).is_some_and(|grain| *grain);
        let grained = scene.instances.iter().filter(|instance| instance.material.is_some_and(is_grained));
        let grained: HashSet<usize> = grained.map(|instance| instance.object.index()).collect();
        for index in 0..scene.objects.len() {
            compiler.is_in_object = true;
            compiler.has_instance_grain = grained.contains(&index);
            let mut group = Group::default();
            for shape in objects.shapes(index).filter(|(shape, _)| shape.emission.is_none()) {
                compiler.place(shape, &DMat4::IDENTITY, None, &mut group)?;
            }
            groups.push(group);
        }
        (compiler.has_instance_grain, compiler.is_in_object) = (false, false);
        objects.objects = groups.into_iter().map(Group::into_primitives).collect();
        Ok(objects)
    }

    /// The shapes of an object with their labels.
    fn shapes(&self, object: usize) -> impl Iterator<Item = (&'a Shape, &'a ShapeLabel)> + use<'a> {
        self.scene.objects[object].shapes.iter().zip(&self.labels.objects[object])
    }

    /// The trees of the objects: those that are known, by the object, and others.
    pub(super) fn trees(&self, mut known: HashMap<u32, Arc<Bvh>>, quality: Quality) -> Result<Vec<Arc<Bvh>>> {
        let trees = (0..).zip(&self.objects).map(|(object, primitives)| match known.remove(&object) {
            Some(tree) => Ok(tree),
            None => tree(primitives, Builder::new(), quality).map(Arc::new),
        });
        trees.collect()
    }

    /// Places instances, and the shapes in them that emit light: in the world, or if they move in objects of their own. Returns the
    /// builder of the world's tree, to which they are added if there are trees of the objects.
    pub(super) fn place(
        &mut self,
        compiler: &mut Compiler<'_>,
        render_from_world: &DMat4,
        in_world: &mut Group,
        trees: Option<(&[Arc<Bvh>], Quality)>,
    ) -> Result<Builder> {
        // There may be millions of instances: until the tree is built, only the kernel has their maps.
        let mut builder = Builder::new();
        let mut moving_lights = Vec::new();
        for written in &self.scene.instances {
            let matrix = *render_from_world * written.world_from_object;
            place::inverse(&written.at, &matrix)?;
            if let Some(lights) =
                self.place_lights(compiler, (written, &matrix), render_from_world, in_world)?
            {
                moving_lights.push((lights.into_primitives(), written, matrix));
            }
            if let Some((trees, _)) = trees {
                let tree = trees[written.object.index()].clone();
                let (motion, place) = (written.motion.as_deref(), math::affine(&matrix));
                add(&mut builder, tree, place, motion, |map| *render_from_world * map);
            }
            self.placed.push((written.object.0, written.material.map(|id| id.0)));
        }

        // Their objects are where they are when the shutter opens.
        for (primitives, written, at_opening) in moving_lights {
            if let Some((_, quality)) = trees {
                let tree = Arc::new(tree(&primitives, Builder::new(), quality)?);
                let (motion, back) = (written.motion.as_deref(), at_opening.inverse());
                add(&mut builder, tree, Affine::IDENTITY, motion, |map| *render_from_world * map * back);
            }
            self.placed.push((self.objects.len() as u32, None));
            self.objects.push(primitives);
        }
        Ok(builder)
    }

    /// Places the shapes of an instance that emit light, each a light of its own, by the instance's matrix to render space: in the world
    /// those that stand still. Returns those that move, if there are any.
    fn place_lights(
        &self,
        compiler: &mut Compiler<'_>,
        (written, matrix): (&WrittenInstance, &DMat4),
        render_from_world: &DMat4,
        in_world: &mut Group,
    ) -> Result<Option<Group>> {
        let material = written.material.map(|id| id.0);
        let mut moving = None;
        for shape in self.shapes(written.object.index()).filter(|(shape, _)| shape.emission.is_some()) {
            compiler.light_motion = light_motion(self.scene, written, shape.0, render_from_world);
            let group = match compiler.light_motion {
                None => &mut *in_world,
                Some(_) => moving.get_or_insert_with(Group::default),
            };
            compiler.place(shape, matrix, material, group)?;
        }
        compiler.light_motion = None;
        Ok(moving)
    }
}

/// Adds an instance in its place, or with its motion, to whose maps `to_render` is applied.
fn add(
    builder: &mut Builder,
    tree: Arc<Bvh>,
    place: Affine,
    motion: Option<&Motion>,
    to_render: impl Fn(DMat4) -> DMat4,
) {
    match motion {
        None => builder.instance(tree, place),
        Some(motion) => {
            let maps = motion.maps().iter().map(|map| math::affine(&to_render(*map)));
            builder.moving_instance(tree, &maps.collect::<Vec<_>>())
        }
    };
}

/// The motion of the light of an instance's shape in render space, if it moves.
fn light_motion(
    scene: &Scene,
    instance: &WrittenInstance,
    shape: &Shape,
    render_from_world: &DMat4,
) -> Option<LightMotion> {
    let deforms = match shape.geometry {
        Geometry::Mesh(id) => !scene.meshes[id.index()].later.is_empty(),
        _ => false,
    };
    if deforms {
        return Some(LightMotion::deforming());
    }
    let motion = instance.motion.as_deref()?;
    let back = (*render_from_world * motion.at_opening()).inverse();
    let maps: Vec<Affine> =
        motion.maps().iter().map(|map| math::affine(&(*render_from_world * *map * back))).collect();
    Some(LightMotion::new(&maps))
}
