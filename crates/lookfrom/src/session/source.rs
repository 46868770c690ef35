//! The source of a session's scene, for rebuilding its world around another camera.

use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

use lookfrom_scene::budget::Reservation;
use lookfrom_scene::camera::Camera;
use lookfrom_scene::files::SharedFiles;
use lookfrom_scene::settings::RenderSettings;
use lookfrom_scene::{Result, load};

use super::{Options, memory, options, prepare};
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
    /// The world of the scene with another camera at the origin of render space, and its memory.
    ///
    /// # Errors
    /// As [`Session::open`](super::Session::open); `Request` where the scene cannot be read again.
    pub(super) fn world_around(
        &self,
        camera: &Camera,
        settings: &RenderSettings,
    ) -> Result<(World, Vec<Reservation>)> {
        let Self::Files(path, files, options) = self else {
            return Err(options::unsuitable(
                "the camera is too far from where the session began, and too near to something, for this world to be \
                 exact there, and its scene cannot be read again: make a new session with this camera"
                    .to_owned(),
            ));
        };
        let mut context = options.context(&**files);
        let mut scene = load::scene(path, &mut context)?;
        // Its warnings were given when the session was opened.
        prepare::prepare(&mut scene, path, options, &mut Vec::new())?;
        scene.camera = Some(camera.clone());
        scene.render = settings.clone();
        memory::compile(scene, context.kept, &options.budget, path, &mut Vec::new())
    }
}
