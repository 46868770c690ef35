//! A view of a world: the camera, and the picture that it takes.

pub mod camera;

use lookfrom_scene::camera::Camera as Written;
use lookfrom_scene::scene::MediumId;
use lookfrom_scene::settings::ImageSettings;
use lookfrom_scene::{Result, Scene};

use crate::view::camera::Camera;

/// What looks at a [`World`](crate::world::World): a camera made for the size of a picture, and what is asked of the picture. A
/// world can have any number of views.
#[derive(Clone, Debug)]
pub struct View {
    /// The camera, in the world's coordinates.
    pub(crate) camera: Camera,
    /// What the camera is inside of; `None` is a vacuum.
    pub(crate) medium: Option<MediumId>,
    /// Size, crop, filter, background and development of the picture.
    pub(crate) image: ImageSettings,
}

impl View {
    /// A view by a camera as it is written.
    ///
    /// # Errors
    /// `Invalid` for a camera that cannot see, see [`Camera::new`].
    pub fn new(camera: &Written, image: ImageSettings) -> Result<Self> {
        Ok(Self { camera: Camera::new(camera, image.width, image.height)?, medium: camera.medium, image })
    }

    /// The view by a scene's own camera (the default one where it has none) with the scene's settings.
    ///
    /// # Errors
    /// As [`View::new`].
    pub fn of_scene(scene: &Scene) -> Result<Self> {
        Self::new(&scene.camera.clone().unwrap_or_default(), scene.image.clone())
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// What is asked of the picture.
    pub fn image(&self) -> &ImageSettings {
        &self.image
    }
}
