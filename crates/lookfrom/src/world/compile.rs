//! From a scene to a world: names become indices, transforms are applied, lights are prepared and the trees are built.

use std::sync::Arc;

use glam::DMat4;
use lookfrom_bvh::{Builder, Bvh, Triangles};
use lookfrom_scene::light::{LightKind, Sky};
use lookfrom_scene::material::{Color, MaterialKind};
use lookfrom_scene::medium::Medium;
use lookfrom_scene::scene::Scene;
use lookfrom_scene::settings::{ColorMode, Integrator as Kind};
use lookfrom_scene::{Error, ErrorKind, Location, Result, Warning};

use super::catcher;
use super::lights::Lights;
use super::place::{Compiler, Group};
use super::{Instance, Names, World, reflectance};
use crate::light::{Light, LightChoice};
use crate::material::{self, InteriorStack, Material};
use crate::math;
use crate::shape::Form;
use crate::texture::Textures;

impl World {
    /// Compiles a scene. What can be survived is added to `warnings`. The origin of render space is the eye of the scene's
    /// camera (of the default camera where it has none).
    ///
    /// # Errors
    /// `Invalid` for a camera whose place is not finite or a transform that cannot be inverted; `Limit` for more than 2³²
    /// vertices or triangles in one shape, or 2³¹ materials and media.
    pub fn compile(mut scene: Scene, warnings: &mut Vec<Warning>) -> Result<Self> {
        let camera = scene.camera.clone().unwrap_or_default();
        let origin = camera.view.lookfrom();
        if !origin.is_finite() {
            return Err(Error::invalid(&camera.at, format!("lookfrom is {origin}; expected finite numbers")));
        }
        reflectance::check(&scene, warnings);
        let render_from_world = DMat4::from_translation(-origin);
        let has_media = scene.render.media;
        if scene.materials.len().saturating_add(scene.media.len()) > InteriorStack::MOST {
            let message = format!("more than {} materials and media", InteriorStack::MOST);
            return Err(Error::new(ErrorKind::Limit, &Location::default(), message));
        }
        let mut textures = Textures::new(
            std::mem::take(&mut scene.textures).into_iter().map(|texture| texture.kind).collect(),
            std::mem::take(&mut scene.images),
            std::mem::take(&mut scene.curves),
        );
        if scene.render.color == ColorMode::Spectral {
            textures.expect(&constants(&scene));
        }
        let mut compiler = Compiler {
            scene: &scene,
            warnings,
            lights: Lights::new(&textures),
            shapes: Vec::new(),
            wants_derivatives: scene.materials.iter().any(lookfrom_scene::material::Material::has_grain),
            alphas: Vec::new(),
            sides: Vec::new(),
            vertex_data: Vec::new(),
        };

        // What stands in the world once.
        let mut in_world = Group::default();
        for shape in &scene.shapes {
            compiler.place(shape, &render_from_world, None, &mut in_world)?;
        }
        // Objects, each with a tree of its own. What shines in them is left to the instances.
        let mut in_objects = Vec::new();
        for object in &scene.objects {
            let mut group = Group::default();
            for shape in object.shapes.iter().filter(|shape| shape.emission.is_none()) {
                compiler.place(shape, &DMat4::IDENTITY, None, &mut group)?;
            }
            in_objects.push(group);
        }
        for written in &scene.instances {
            let object = &scene.objects[written.object.index()];
            let material = written.material.map(|id| id.0);
            let matrix = render_from_world * written.world_from_object;
            let instance = Instance::new(&written.at, written.object.0, matrix, material)?;
            // Each repetition of something that shines is a light of its own.
            for shape in object.shapes.iter().filter(|shape| shape.emission.is_some()) {
                compiler.place(shape, &matrix, material, &mut in_world)?;
            }
            in_world.instances.push(instance);
        }
        for light in &scene.lights {
            compiler.lights.add(light, origin);
        }
        let Compiler { lights, shapes, alphas, sides, vertex_data, .. } = compiler;
        let radius = scene.bounds().radius() as f32;
        let light_choice =
            LightChoice::new(scene.render.light_sampler, &lights.lights, &lights.brightness, radius);
        let Lights { lights, names: light_names, ambient, .. } = lights;
        if let Some(light) = scene.lights.iter().find(|light| matches!(light.kind, LightKind::Ambient { .. }))
            && matches!(scene.render.integrator, Kind::Path | Kind::SimplePath | Kind::RandomWalk)
        {
            let message = "ambient light belongs to Whitted's model: path tracing leaves it out";
            warnings.push(Warning::new(&light.at, message));
        }

        // Build the trees: of the objects, and of the world over them.
        let objects: Vec<Vec<Form>> = in_objects.into_iter().map(Group::into_forms).collect();
        let trees =
            objects.iter().map(|forms| tree(forms, &[], &[]).map(Arc::new)).collect::<Result<Vec<_>>>()?;
        let instances = std::mem::take(&mut in_world.instances);
        let forms = in_world.into_forms();
        let bvh = tree(&forms, &instances, &trees)?;

        let mut names = Names { shapes, lights: light_names, ..Names::default() };
        let mut materials: Vec<Material> = Vec::new();
        let mut media = scene.media;
        for material in scene.materials {
            let whitted = material::in_whitteds_model(&material.kind, &materials, &textures);
            // A body that absorbs is filled with a medium of its own.
            let medium = (whitted.absorption != [0.0; 3]).then(|| {
                let (name, absorption) = (material.name.clone(), Color::Value(whitted.absorption));
                media.push(Medium { name, at: material.at, absorption, scale: 1.0 });
                media.len() as u32 - 1
            });
            materials.push(Material { kind: material.kind, relief: material.relief, medium, whitted });
            names.materials.push(material.name);
        }
        let catcher = materials.iter().find_map(|material| match material.kind {
            MaterialKind::ShadowCatcher { normal } => Some(normal),
            _ => None,
        });
        let is_environment = |index: &u32| matches!(lights[*index as usize], Light::Environment(_));
        Ok(Self {
            origin,
            bvh,
            forms,
            objects,
            instances,
            transmissive: materials.iter().any(|material| material.whitted.transmission != Color::BLACK),
            has_gaps: !alphas.is_empty()
                || has_media && materials.iter().any(|material| material.kind == MaterialKind::Interface),
            has_media,
            radius,
            catcher_irradiance: catcher.map(|n| catcher::irradiance(&lights, &textures, n)),
            materials,
            alphas,
            media,
            sides,
            vertex_data,
            textures,
            environments: (0..lights.len() as u32).filter(is_environment).collect(),
            lights,
            light_choice,
            ambient,
            names,
        })
    }
}

/// The colours of a scene's materials, lights and media that are the same everywhere.
fn constants(scene: &Scene) -> Vec<[f32; 3]> {
    let in_objects = scene.objects.iter().flat_map(|object| &object.shapes);
    let emissions = scene.shapes.iter().chain(in_objects).filter_map(|shape| shape.emission);
    let of_lights = scene.lights.iter().flat_map(|light| match &light.kind {
        LightKind::Point { intensity, .. }
        | LightKind::Distant { intensity, .. }
        | LightKind::Spot { intensity, .. }
        | LightKind::Goniometric { intensity, .. }
        | LightKind::Environment { sky: Sky::Constant(intensity), .. } => vec![*intensity],
        LightKind::Environment { sky: Sky::Gradient { zenith, horizon, nadir }, .. } => {
            [zenith, horizon, nadir].map(|rgb| Color::Value(*rgb)).to_vec()
        }
        _ => Vec::new(),
    });
    let colors = scene.materials.iter().flat_map(|material| material.kind.colors());
    let colors = colors
        .chain(emissions.map(|emission| emission.radiance))
        .chain(of_lights)
        .chain(scene.media.iter().map(|medium| medium.absorption));
    let values = colors.filter_map(|color| match color {
        Color::Value(rgb) => Some(rgb),
        _ => None,
    });
    let mut values: Vec<[f32; 3]> = values.collect();
    values.sort_by_key(|rgb| rgb.map(f32::to_bits));
    values.dedup();
    values
}

/// The tree over forms in their order, then instances.
fn tree(forms: &[Form], instances: &[Instance], objects: &[Arc<Bvh>]) -> Result<Bvh> {
    let mut builder = Builder::new();
    for form in forms {
        match form {
            Form::Mesh(mesh) => {
                builder.triangles(Triangles { positions: &mesh.positions, indices: &mesh.triangles });
            }
            Form::Spheres(spheres) => {
                builder.spheres(&spheres.spheres);
            }
            Form::Disks(disks) => {
                builder.procedural(Arc::new(disks.clone()));
            }
            Form::Quadrics(quadrics) => {
                builder.procedural(quadrics.clone());
            }
            Form::Patches(patches) => {
                builder.procedural(patches.clone());
            }
            Form::Curves(curves) => {
                builder.procedural(curves.clone());
            }
        }
    }
    for instance in instances {
        builder
            .instance(objects[instance.object as usize].clone(), math::affine(&instance.render_from_object));
    }
    builder.build().map_err(|error| Error::new(ErrorKind::Invalid, &Location::default(), error.to_string()))
}
