//! The source of a session's scene, and its world built again around another camera.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use lookfrom_scene::budget::Reservation;
use lookfrom_scene::camera::Camera;
use lookfrom_scene::files::SharedFiles;
use lookfrom_scene::{Location, Result, Scene, load};

use super::{Options, Session, memory, options, prepare};
use crate::world::World;

/// The source of a scene, with the options that it was prepared with.
#[derive(Clone)]
pub(super) enum Source {
    /// A file that can be read again.
    Files(PathBuf, SharedFiles, Arc<Options>),
    /// A source that only the caller knows.
    Elsewhere,
}

impl fmt::Debug for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Files(path, _, options) => f.debug_tuple("Files").field(path).field(options).finish(),
            Self::Elsewhere => f.write_str("Elsewhere"),
        }
    }
}

impl Source {
    /// The scene, read and prepared again, and its memory.
    ///
    /// # Errors
    /// As [`Session::open`]; `Request` where the scene cannot be read again.
    fn scene(&self) -> Result<(Scene, Vec<Reservation>)> {
        let Self::Files(path, files, options) = self else {
            return Err(options::unsuitable(
                "the camera is too far from where the session began, and too near to something, for this world to be \
                 exact there, and its scene cannot be read again: make a new session with this camera, or keep the scene \
                 by the option `keep_scene`"
                    .to_owned(),
            ));
        };
        let mut context = options.context(&**files);
        let mut scene = load::scene(path, &mut context)?;
        // Its warnings were given when the session was opened.
        prepare::prepare(&mut scene, path, options, &mut Vec::new())?;
        Ok((scene, context.kept))
    }
}

impl Session {
    /// The world of the scene with another camera at the origin of render space, and its memory. A scene that is kept has what was
    /// changed in it; one that is read again has no changes.
    ///
    /// # Errors
    /// As [`Session::open`]; `Request` where the scene is not kept and cannot be read again.
    pub(super) fn world_around(&self, camera: &Camera) -> Result<(World, Vec<Reservation>)> {
        let (mut scene, of_scene) = match &self.kept {
            None => self.source.scene()?,
            Some((kept, _)) => {
                let bytes = kept.bytes();
                let memory = self.budget.reserve(bytes, "the scene compiled again", &Location::default())?;
                (Scene::clone(kept), vec![memory])
            }
        };
        scene.camera = Some(camera.clone());
        scene.render = self.settings().clone();
        memory::compile(scene, of_scene, &self.budget, Path::new(&self.name), &mut Vec::new())
    }
}
