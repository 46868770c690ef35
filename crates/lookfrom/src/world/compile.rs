//! Compilation of a scene: names become indices, transforms are applied, lights prepared and BVHs built.

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

use glam::DMat4;
use lookfrom_bvh::{Builder, Bvh, Quality, Triangles};
use lookfrom_scene::material::{Color, Material as Written, MaterialKind as WrittenKind};
use lookfrom_scene::scene::Scene;
use lookfrom_scene::settings::RenderSettings;
use lookfrom_scene::{Error, ErrorKind, Location, Result, Warning};

use super::ignored;
use super::instancing::Instancing;
use super::lights::Lights;
use super::medium::EndOfSpace;
use super::place::{Compiler, Group, Labels};
use super::quality::quality;
use super::{Instance, Medium, Names, World, numbers, origin, reflectance};
use crate::light::{Light, LightChoice};
use crate::primitive::Primitives;
use crate::shading::interior_stack::InteriorStack;
use crate::shading::material::{self, Material, MaterialKind};
use crate::shading::texture::{SpectrumType, Textures};

/// Parts of a world that are kept when its scene is compiled again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kept {
    /// All trees: of a scene of the same shapes, objects and instances, which may have other materials, textures and lights.
    Trees,
    /// The trees of objects: of a scene of the same shapes and objects, whose instances may be elsewhere.
    ObjectTrees,
}

impl World {
    /// Compiles a scene. Problems that do not prevent this are added to `warnings`. The origin of render space is the
    /// position of the scene's camera (of the default camera where it has none).
    ///
    /// # Errors
    /// As [`Scene::validate`]; `Invalid` for a camera whose position is not finite or a transform that cannot be inverted;
    /// `Limit` for more than 2³² vertices or triangles in one shape, or 2³¹ materials and media.
    pub fn compile(scene: Scene, warnings: &mut Vec<Warning>) -> Result<Self> {
        scene.validate()?;
        Self::compile_valid(scene, warnings)
    }

    /// [`World::compile`] for a scene that was read or has been validated.
    pub(crate) fn compile_valid(scene: Scene, warnings: &mut Vec<Warning>) -> Result<Self> {
        Self::compile_on(None, scene, warnings)
    }

    /// Compiles a scene that differs from this world's: on its trees, as far as they are kept, and its origin.
    ///
    /// # Errors
    /// As [`World::compile`].
    pub(crate) fn compile_changed(
        &self,
        scene: Scene,
        kept: Kept,
        warnings: &mut Vec<Warning>,
    ) -> Result<Self> {
        Self::compile_on(Some((self, kept)), scene, warnings)
    }

    /// The trees of objects that have instances, by object.
    fn object_trees(&self) -> HashMap<u32, Arc<Bvh>> {
        let instances = self.instances.iter().zip(0..);
        instances.map(|(instance, id)| (instance.object, self.bvh.instance_tree(id).clone())).collect()
    }

    /// Compiles a scene: on the trees of another world, if that is given.
    fn compile_on(
        before: Option<(&Self, Kept)>,
        mut scene: Scene,
        warnings: &mut Vec<Warning>,
    ) -> Result<Self> {
        let camera = scene.camera.clone().unwrap_or_default();
        let origin =
            before.map_or_else(|| origin::of_render_space(&camera, &scene), |(world, _)| world.origin);
        if !origin.is_finite() {
            return Err(Error::invalid(&camera.at, format!("lookfrom is {origin}; expected finite numbers")));
        }
        reflectance::check(&scene, warnings);
        numbers::check(&scene, warnings);
        let render_from_world = DMat4::from_translation(-origin);
        let RenderSettings { media: has_media, open_fronts, hide_lights: hides_lights, .. } = scene.render;
        if scene.materials.len().saturating_add(scene.media.len()) > InteriorStack::MOST {
            let message = format!("more than {} materials and media", InteriorStack::MOST);
            return Err(Error::new(ErrorKind::Limit, &Location::default(), message));
        }
        let textures = take_textures(&mut scene);
        let need_footprints = need_footprints(&scene.materials, &textures);
        let in_use = materials_in_use(&scene);
        let grains = grains(&scene.materials, &need_footprints);
        let mut compiler = Compiler::new(&scene, warnings, Lights::new(&textures, origin), grains);

        // Shapes that are not instanced.
        let mut in_world = Group::default();
        let labels = Labels::new(&scene);
        for shape in scene.shapes.iter().zip(&labels.shapes) {
            compiler.place(shape, &render_from_world, None, &mut in_world)?;
        }
        // Objects, each with a tree of its own, and instances.
        let mut instancing = Instancing::new(&mut compiler, &labels)?;
        let quality = quality(&scene);
        let (kept, known) = match before {
            Some((world, Kept::Trees)) => (Some(world.bvh.clone()), HashMap::new()),
            Some((world, Kept::ObjectTrees)) => (None, world.object_trees()),
            None => (None, HashMap::new()),
        };
        let trees = if kept.is_none() { Some(instancing.trees(known, quality)?) } else { None };
        let builder = instancing.place(
            &mut compiler,
            &render_from_world,
            &mut in_world,
            trees.as_deref().map(|trees| (trees, quality)),
        )?;
        let Instancing { objects, placed, .. } = instancing;
        for light in &scene.lights {
            compiler.lights.add(light);
        }
        let Compiler { lights, shapes, alphas, medium_interfaces, vertex_data, .. } = compiler;
        let bounds = scene.bounds();
        let center = if bounds.is_empty() { origin } else { bounds.center() };
        let (radius, around) = (bounds.radius() as f32, (center, 2.0 * bounds.radius()));
        let end_of_space = (!scene.render.endless_media)
            .then(|| EndOfSpace { center: (center - origin).as_vec3(), reach: 2.0 * radius });
        let Lights { lights, names: light_names, brightness, ambient, .. } = lights;
        let light_choice = LightChoice::new(scene.render.light_sampler, &lights, brightness, radius);
        ignored::warn(&scene, &camera, warnings);

        // Build the BVH of the world, over those of the objects. What is compiled makes room for it.
        let written_materials = std::mem::take(&mut scene.materials);
        let written_media = std::mem::take(&mut scene.media);
        let names_of_objects = scene.objects.iter().map(|object| object.name.clone()).collect();
        let names_of_instances = match scene.instances.iter().any(|instance| instance.name.is_some()) {
            true => scene.instances.iter().map(|instance| instance.name.clone()).collect(),
            false => Vec::new(),
        };
        let vertex_normals = scene.vertex_normals;
        drop((scene, labels));
        let primitives = in_world.into_primitives();
        let bvh = match kept {
            None => Arc::new(tree(&primitives, builder, quality)?),
            Some(bvh) => bvh,
        };
        let instances: Arc<[Instance]> = placed
            .into_iter()
            .zip(0..)
            .map(|((object, material), id)| {
                let moves = bvh.instance_map_at(id, 0.0).is_some();
                Instance::new(object, material, bvh.instance_map(id), moves)
            })
            .collect();

        let mut media: Vec<Medium> =
            written_media.iter().map(|written| Medium::compile(&textures, written, origin, around)).collect();
        let compiler = material::Compiler::new(&textures, vertex_normals);
        let (materials, names_of_materials) =
            compiled(compiler, written_materials.into_iter().zip(need_footprints), &textures, &mut media);
        let names = Names {
            shapes,
            lights: light_names,
            materials: names_of_materials,
            objects: names_of_objects,
            instances: names_of_instances,
        };
        let is_any_in_use = |is_so: fn(&Material) -> bool| {
            in_use.iter().filter_map(|&index| materials.get(index as usize)).any(is_so)
        };
        let is_environment = |index: &u32| matches!(lights[*index as usize], Light::Environment(_));
        let mut world = Self {
            origin,
            bvh,
            classes: Arc::default(),
            object_classes: Arc::default(),
            primitives: primitives.into(),
            objects: objects.into(),
            instances,
            transmissive: is_any_in_use(|material| !material.whitted.transmission.is_gray(0.0)),
            has_panes: is_any_in_use(Material::is_pane),
            has_holes: !alphas.is_empty()
                || has_media
                    && materials.iter().any(|material| matches!(material.kind, MaterialKind::Interface))
                || hides_lights,
            hides_lights,
            has_open_fronts: false,
            has_media,
            radius,
            end_of_space,
            catcher_irradiance: None,
            materials: materials.into(),
            alphas: alphas.into_iter().map(|alpha| textures.pictured(alpha)).collect(),
            media,
            medium_interfaces,
            vertex_data,
            environments: (0..lights.len() as u32).filter(is_environment).collect(),
            lights,
            light_choice: Arc::new(light_choice),
            ambient: textures.spectrum_texture(Color::Value(ambient), SpectrumType::Illuminant),
            textures: Arc::new(textures),
            names: Arc::new(names),
            footprint: None,
        };
        world.catcher_irradiance = world.unoccluded_irradiance();
        world.has_open_fronts = open_fronts && world.faces_inward();
        world.classify();
        Ok(world)
    }
}

/// The textures of a scene, which has them no longer.
fn take_textures(scene: &mut Scene) -> Textures {
    let (images, curves) = (std::mem::take(&mut scene.images), std::mem::take(&mut scene.curves));
    let kinds: Vec<_> = std::mem::take(&mut scene.textures).into_iter().map(|texture| texture.kind).collect();
    Textures::new(&kinds, images, curves, scene.render.color)
}

/// By material: whether its textures depend on the footprint of pixels.
fn need_footprints(materials: &[Written], textures: &Textures) -> Vec<bool> {
    let is_filtered = |material: &Written| material.textures().iter().any(|id| textures.needs_footprint(*id));
    of_mixtures(materials, materials.iter().map(is_filtered).collect())
}

/// By material: whether it needs derivatives by texture coordinates.
fn grains(materials: &[Written], need_footprints: &[bool]) -> Vec<bool> {
    let grains =
        materials.iter().zip(need_footprints).map(|(material, filtered)| material.has_grain() || *filtered);
    of_mixtures(materials, grains.collect())
}

/// The indices of the materials that shapes or instances have.
fn materials_in_use(scene: &Scene) -> BTreeSet<u32> {
    let of_objects = scene.objects.iter().flat_map(|object| &object.shapes);
    let of_shapes = scene.shapes.iter().chain(of_objects).map(|shape| shape.material);
    of_shapes.chain(scene.instances.iter().filter_map(|instance| instance.material)).map(|id| id.0).collect()
}

/// Compiled materials and their names. A body that absorbs light is filled with a medium of its own, which is added to others.
fn compiled(
    mut compiler: material::Compiler<'_>,
    written: impl Iterator<Item = (Written, bool)>,
    textures: &Textures,
    media: &mut Vec<Medium>,
) -> (Vec<Material>, Vec<String>) {
    let materials = written.map(|(written, needs_footprint)| {
        let (mut material, absorption) = compiler.compile(&written);
        material.needs_footprint = needs_footprint;
        material.medium = written.medium.map(|id| id.0);
        if absorption != [0.0; 3] && material.medium.is_none() {
            material.medium = Some(media.len() as u32);
            media.push(Medium::absorbing(textures, absorption));
        }
        (material, written.name)
    });
    materials.unzip()
}

/// A property of materials, which mixtures have if any of their parts has it.
fn of_mixtures(materials: &[Written], mut are_so: Vec<bool>) -> Vec<bool> {
    let mut has_changed = true;
    while has_changed {
        has_changed = false;
        for (index, material) in materials.iter().enumerate() {
            if let WrittenKind::Mix { materials: parts, .. } = &material.kind
                && !are_so[index]
                && parts.iter().any(|part| are_so[part.index()])
            {
                (are_so[index], has_changed) = (true, true);
            }
        }
    }
    are_so
}

/// The BVH over primitives in their order, and what else the builder has.
pub(super) fn tree(primitives: &[Primitives], mut builder: Builder, quality: Quality) -> Result<Bvh> {
    builder.quality(quality);
    for primitives in primitives {
        match primitives {
            Primitives::Mesh(mesh) if !mesh.later.is_empty() => {
                let later = mesh.later.iter().map(|pose| &*pose.positions);
                let times: Vec<&[[f32; 3]]> = std::iter::once(&*mesh.positions).chain(later).collect();
                builder.moving_triangles(&times, &mesh.triangles);
            }
            Primitives::Mesh(mesh) => {
                builder.triangles(Triangles { positions: &mesh.positions, indices: &mesh.triangles });
            }
            Primitives::Spheres(spheres) => {
                builder.spheres(&spheres.spheres);
            }
            Primitives::Disks(disks) => {
                builder.procedural(Arc::new(disks.clone()));
            }
            Primitives::Quadrics(quadrics) => {
                builder.procedural(quadrics.clone());
            }
            Primitives::Patches(patches) => {
                builder.procedural(patches.clone());
            }
            Primitives::Curves(curves) => {
                builder.procedural(curves.clone());
            }
        }
    }
    builder.build().map_err(|error| Error::new(ErrorKind::Invalid, &Location::default(), error.to_string()))
}
