//! Compilation of a scene: names become indices, transforms are applied, lights prepared and BVHs built.

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

use glam::DMat4;
use lookfrom_bvh::{Affine, Builder, Bvh, Quality, Triangles};
use lookfrom_scene::light::LightKind;
use lookfrom_scene::material::{Color, Material as Written, MaterialKind as WrittenKind};
use lookfrom_scene::motion::Motion;
use lookfrom_scene::scene::{Instance as WrittenInstance, MaterialId, Scene};
use lookfrom_scene::settings::{Integrator as Kind, RenderSettings};
use lookfrom_scene::shape::{Geometry, Shape};
use lookfrom_scene::{Error, ErrorKind, Location, Result, Warning};

use super::lights::Lights;
use super::place::{self, Compiler, Group, Labels};
use super::quality::quality;
use super::{Instance, Medium, Names, World, origin, reflectance};
use crate::core::math;
use crate::light::{Light, LightChoice, LightMotion};
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
    /// `Invalid` for a camera whose position is not finite or a transform that cannot be inverted; `Limit` for more
    /// than 2³² vertices or triangles in one shape, or 2³¹ materials and media.
    pub fn compile(scene: Scene, warnings: &mut Vec<Warning>) -> Result<Self> {
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
        let render_from_world = DMat4::from_translation(-origin);
        let RenderSettings { media: has_media, open_fronts, hide_lights: hides_lights, .. } = scene.render;
        if scene.materials.len().saturating_add(scene.media.len()) > InteriorStack::MOST {
            let message = format!("more than {} materials and media", InteriorStack::MOST);
            return Err(Error::new(ErrorKind::Limit, &Location::default(), message));
        }
        let kinds: Vec<_> =
            std::mem::take(&mut scene.textures).into_iter().map(|texture| texture.kind).collect();
        let textures = Textures::new(
            &kinds,
            std::mem::take(&mut scene.images),
            std::mem::take(&mut scene.curves),
            scene.render.color,
        );
        let need_footprints = need_footprints(&scene.materials, &textures);
        let in_use = materials_in_use(&scene);
        let mut compiler = Compiler {
            scene: &scene,
            warnings,
            lights: Lights::new(&textures),
            shapes: Vec::new(),
            grains: grains(&scene.materials, &need_footprints),
            has_instance_grain: false,
            is_in_object: false,
            light_motion: None,
            alphas: Vec::new(),
            medium_interfaces: Vec::new(),
            vertex_data: Vec::new(),
        };

        // Shapes that are not instanced.
        let mut in_world = Group::default();
        let labels = Labels::new(&scene);
        for shape in scene.shapes.iter().zip(&labels.shapes) {
            compiler.place(shape, &render_from_world, None, &mut in_world)?;
        }
        // Objects, each with a BVH of its own. Shapes in them that emit light are left to the instances.
        let mut in_objects = Vec::new();
        let labelled = |object: usize| scene.objects[object].shapes.iter().zip(&labels.objects[object]);
        for index in 0..scene.objects.len() {
            let mut group = Group::default();
            compiler.is_in_object = true;
            compiler.has_instance_grain = scene.instances.iter().any(|instance| {
                let is_grained = |id: MaterialId| compiler.grains.get(id.index()).is_some_and(|grain| *grain);
                instance.object.index() == index && instance.material.is_some_and(is_grained)
            });
            for shape in labelled(index).filter(|(shape, _)| shape.emission.is_none()) {
                compiler.place(shape, &DMat4::IDENTITY, None, &mut group)?;
            }
            in_objects.push(group);
        }
        (compiler.has_instance_grain, compiler.is_in_object) = (false, false);
        let mut objects: Vec<Vec<Primitives>> = in_objects.into_iter().map(Group::into_primitives).collect();
        let quality = quality(&scene);
        let whole = before.filter(|(_, kept)| *kept == Kept::Trees).map(|(world, _)| world.bvh.clone());
        let mut known = match before {
            Some((world, Kept::ObjectTrees)) => world.object_trees(),
            _ => HashMap::new(),
        };
        let built = if whole.is_none() { &*objects } else { &[] };
        let trees = (0..)
            .zip(built)
            .map(|(object, primitives)| match known.remove(&object) {
                Some(tree) => Ok(tree),
                None => tree(primitives, Builder::new(), quality).map(Arc::new),
            })
            .collect::<Result<Vec<_>>>()?;
        // There may be millions of instances: until the tree is built, only the kernel has their maps.
        let mut builder = Builder::new();
        let mut instanced = Vec::with_capacity(scene.instances.len());
        let mut emitters = Vec::new();
        let motions = scene.instances.iter().filter_map(|instance| instance.motion.as_deref());
        let parts = motions.map(Motion::parts).max().unwrap_or(1);
        for written in &scene.instances {
            let material = written.material.map(|id| id.0);
            let matrix = render_from_world * written.world_from_object;
            place::inverse(&written.at, &matrix)?;
            // Each instance of a shape that emits light is a light of its own.
            let mut moving = Group::default();
            let mut moves = false;
            for shape in labelled(written.object.index()).filter(|(shape, _)| shape.emission.is_some()) {
                compiler.light_motion = light_motion(&scene, written, shape.0, &render_from_world);
                match compiler.light_motion {
                    None => compiler.place(shape, &matrix, material, &mut in_world)?,
                    Some(_) => compiler.place(shape, &matrix, material, &mut moving)?,
                }
                moves |= compiler.light_motion.is_some();
            }
            if moves {
                emitters.push((moving.into_primitives(), written.motion.clone(), matrix));
            }
            compiler.light_motion = None;
            if let Some(tree) = trees.get(written.object.index()) {
                match &written.motion {
                    None => builder.instance(tree.clone(), math::affine(&matrix)),
                    Some(motion) => {
                        let maps = motion
                            .in_parts(parts)
                            .into_iter()
                            .map(|map| math::affine(&(render_from_world * map)));
                        builder.moving_instance(tree.clone(), &maps.collect::<Vec<_>>())
                    }
                };
            }
            instanced.push((written.object.0, material));
        }
        // Shapes that emit light and move are in objects of their own, where they are when the shutter opens.
        for (primitives, motion, at_opening) in emitters {
            if whole.is_none() {
                let tree = Arc::new(tree(&primitives, Builder::new(), quality)?);
                let back = at_opening.inverse();
                let to_render = |map: DMat4| math::affine(&(render_from_world * map * back));
                match motion {
                    None => builder.instance(tree, Affine::IDENTITY),
                    Some(motion) => {
                        let maps: Vec<Affine> = motion.in_parts(parts).into_iter().map(to_render).collect();
                        builder.moving_instance(tree, &maps)
                    }
                };
            }
            instanced.push((objects.len() as u32, None));
            objects.push(primitives);
        }
        for light in &scene.lights {
            compiler.lights.add(light, origin);
        }
        let Compiler { lights, shapes, alphas, medium_interfaces, vertex_data, .. } = compiler;
        let bounds = scene.bounds();
        let (radius, around) = (bounds.radius() as f32, (bounds.center(), 2.0 * bounds.radius()));
        let Lights { lights, names: light_names, brightness, ambient, .. } = lights;
        let light_choice = LightChoice::new(scene.render.light_sampler, &lights, brightness, radius);
        if let Some(light) = scene.lights.iter().find(|light| matches!(light.kind, LightKind::Ambient { .. }))
            && matches!(scene.render.integrator, Kind::Path | Kind::SimplePath | Kind::RandomWalk)
        {
            let message = "ambient light belongs to Whitted's model: path tracing ignores it";
            warnings.push(Warning::new(&light.at, message));
        }
        if scene.render.integrator == Kind::RandomWalk
            && let Some(light) = scene.lights.iter().find(|light| !light.kind.has_size())
        {
            let message =
                "\"random_walk\" finds no light without a size, since no path meets it: use \"path\"";
            warnings.push(Warning::new(&light.at, message));
        }
        if camera.projection.is_measurement()
            && let Some(light) = scene.lights.iter().find(|light| !light.kind.has_size())
        {
            let message = "a light without a size adds nothing to the irradiance that is measured, but by reflection, since no ray meets it";
            warnings.push(Warning::new(&light.at, message));
        }
        if scene.render.media
            && matches!(scene.render.integrator, Kind::Whitted | Kind::Raycast)
            && let Some(medium) = scene.media.iter().find(|medium| medium.scatters() || medium.emits())
        {
            let integrator = scene.render.integrator.word();
            let message =
                format!("media neither scatter light nor emit it with {integrator:?}: use \"path\"");
            warnings.push(Warning::new(&medium.at, message));
        }

        // Build the BVH of the world, over those of the objects. What is compiled makes room for it.
        let written_materials = std::mem::take(&mut scene.materials);
        let written_media = std::mem::take(&mut scene.media);
        let vertex_normals = scene.vertex_normals;
        drop((scene, labels));
        let primitives = in_world.into_primitives();
        let bvh = match whole {
            None => Arc::new(tree(&primitives, builder, quality)?),
            Some(bvh) => bvh,
        };
        let placed = instanced.into_iter().zip(0..);
        let instances: Arc<[Instance]> = placed
            .map(|((object, material), id)| {
                let moves = bvh.instance_map_at(id, 0.0).is_some();
                Instance::new(object, material, bvh.instance_map(id), moves)
            })
            .collect();

        let mut names = Names { shapes, lights: light_names, ..Names::default() };
        let mut materials: Vec<Material> = Vec::new();
        let mut media: Vec<Medium> =
            written_media.iter().map(|written| Medium::compile(&textures, written, origin, around)).collect();
        let mut compiler = material::Compiler::new(&textures, vertex_normals);
        for (written, needs_footprint) in written_materials.into_iter().zip(need_footprints) {
            let (mut material, absorption) = compiler.compile(&written);
            material.needs_footprint = needs_footprint;
            // An absorbing body is filled with a medium of its own.
            material.medium = written.medium.map(|id| id.0);
            if absorption != [0.0; 3] && material.medium.is_none() {
                material.medium = Some(media.len() as u32);
                media.push(Medium::absorbing(&textures, absorption));
            }
            materials.push(material);
            names.materials.push(written.name);
        }
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
            has_gaps: !alphas.is_empty()
                || has_media
                    && materials.iter().any(|material| matches!(material.kind, MaterialKind::Interface))
                || hides_lights,
            hides_lights,
            has_open_fronts: false,
            has_media,
            radius,
            catcher_irradiance: None,
            materials: materials.into(),
            alphas,
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
        world.has_gaps |= world.has_open_fronts;
        world.classify();
        Ok(world)
    }
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

/// What is so of materials, and of mixtures if it is so of any of their parts.
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
fn tree(primitives: &[Primitives], mut builder: Builder, quality: Quality) -> Result<Bvh> {
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
