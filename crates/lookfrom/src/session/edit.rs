//! Changes of a scene that a session keeps: other materials, lights and poses, on the same trees.

use std::mem::swap;
use std::sync::Arc;

use glam::DMat4;
use lookfrom_scene::light::Light;
use lookfrom_scene::material::Material;
use lookfrom_scene::scene::MaterialId;
use lookfrom_scene::{Location, Result, Scene};

use super::{Options, Session, options, seeing_backs};
use crate::world::{Kept, World};

impl Session {
    /// A session of a scene, which is kept beside its world: so that its materials and lights can be changed.
    ///
    /// ```
    /// use lookfrom::prelude::*;
    ///
    /// let mut scene = Scene::new();
    /// let paint = scene.material("paint", MaterialKind::Diffuse { reflectance: Color::gray(0.8) });
    /// scene.sphere([0.0; 3], 1.0, paint).size(4, 4);
    /// let mut session = Session::keeping(scene, &Options::default())?;
    ///
    /// let mut red = session.scene().ok_or("no scene")?.materials[paint.index()].clone();
    /// red.kind = MaterialKind::Diffuse { reflectance: Color::Value([0.8, 0.1, 0.1]) };
    /// session.set_material(paint, red)?;
    /// session.render(&())?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`Session::of_scene`].
    pub fn keeping(scene: Scene, options: &Options) -> Result<Self> {
        Self::of_scene(scene, &Options { keep_scene: true, ..options.clone() })
    }

    /// The scene as it was compiled, with what was added to it and its materials and lights of now, if it is kept
    /// ([`Options::keep_scene`]). What can be changed otherwise is not in it: [`Session::camera`], [`Session::image`],
    /// [`Session::settings`].
    pub fn scene(&self) -> Option<&Scene> {
        self.kept.as_ref().map(|(scene, _)| &**scene)
    }

    /// The scene as a file could have it that gives this session's picture without options: with what was added, the camera and all
    /// settings. `None` where the scene is not kept. A turned turntable is not in it.
    pub fn into_scene(self) -> Option<Scene> {
        let (image, render) = (self.image().clone(), self.settings().clone());
        let (scene, _) = self.kept?;
        let scene = Arc::unwrap_or_clone(scene);
        Some(Scene { camera: Some(self.camera), image, render, ..scene })
    }

    /// Changes a material. All is compiled again but the trees, which stay; the picture has the bits of a scene with that
    /// material.
    ///
    /// # Errors
    /// `Request` where the scene is not kept ([`Options::keep_scene`]); as [`Scene::validate`]; `Limit`
    /// where there is no memory for a second world ([`Options::budget`]), until the first is gone. Then nothing has changed.
    pub fn set_material(&mut self, id: MaterialId, mut material: Material) -> Result<()> {
        let count = self.scene().map_or(usize::MAX, |scene| scene.materials.len());
        if id.index() >= count {
            let message = format!("there is no material {}; the scene has {count}, from 0", id.index());
            return Err(options::unsuitable(message));
        }
        self.exchange(Kept::Trees, |scene| swap(&mut scene.materials[id.index()], &mut material))
    }

    /// Replaces all lights that are no shapes, those that were added to the scene included, as [`Session::set_material`] does a
    /// material. A turned turntable turns the new ones, too.
    ///
    /// # Errors
    /// As [`Session::set_material`].
    pub fn set_lights(&mut self, mut lights: Vec<Light>) -> Result<()> {
        self.exchange(Kept::Trees, |scene| swap(&mut scene.lights, &mut lights))
    }

    /// Moves instances: each by its index in [`Scene::instances`], with its map from the object's space to the world, where it
    /// stands still then. The trees of objects stay; the one over the instances is built again.
    ///
    /// # Errors
    /// As [`Session::set_material`]; `Invalid` for a map without an inverse.
    pub fn set_poses(&mut self, poses: Vec<(usize, DMat4)>) -> Result<()> {
        let count = self.scene().map_or(usize::MAX, |scene| scene.instances.len());
        if let Some((index, _)) = poses.iter().find(|(index, _)| *index >= count) {
            let message = format!("there is no instance {index}; the scene has {count}, from 0");
            return Err(options::unsuitable(message));
        }
        let mut poses: Vec<_> = poses.into_iter().map(|(index, pose)| (index, pose, None)).collect();
        self.exchange(Kept::ObjectTrees, |scene| {
            // An instance that is given twice is undone in the opposite order.
            for (index, pose, motion) in &mut poses {
                swap(&mut scene.instances[*index].world_from_object, pose);
                swap(&mut scene.instances[*index].motion, motion);
            }
            poses.reverse();
        })
    }

    /// Changes the scene by exchanging a part of it; where that fails, it is exchanged again.
    fn exchange(&mut self, keeps: Kept, mut exchange: impl FnMut(&mut Scene)) -> Result<()> {
        let Some((mut kept, memory)) = self.kept.take() else {
            let message = "this session does not keep its scene: enable it by the option `keep_scene`";
            return Err(options::unsuitable(message.to_owned()));
        };
        exchange(Arc::make_mut(&mut kept));
        let changed = self.show(&kept, keeps);
        if changed.is_err() {
            exchange(Arc::make_mut(&mut kept));
        }
        self.kept = Some((kept, memory));
        changed
    }

    /// Compiles a changed scene on trees of the world.
    fn show(&mut self, scene: &Scene, keeps: Kept) -> Result<()> {
        scene.validate()?;
        // Until the former world is gone.
        let again = scene.bytes() + World::memory(scene);
        let _room = self.budget.reserve(again, "the scene compiled again", &Location::default())?;
        let world = Arc::new(self.world().compile_changed(scene.clone(), keeps, &mut Vec::new())?);
        let renderer = self.renderer.with_world(world, self.renderer.view().clone())?;
        let (mut renderer, _) = seeing_backs(renderer)?;
        if let Some(turning) = &mut self.turntable {
            turning.world = renderer.world().clone();
            let turned: World = turning.world.with_surroundings_turned(&turning.rotation());
            renderer = renderer.with_world(Arc::new(turned), renderer.view().clone())?;
        }
        self.identity = self.identity.as_ref().map(|identity| identity.with_scene(scene));
        self.renderer = renderer;
        Ok(())
    }
}
