//! Views of a world: camera and settings of the picture.

pub mod camera;
pub mod lens_system;

use lookfrom_scene::camera::Camera as Written;
use lookfrom_scene::scene::MediumId;
use lookfrom_scene::settings::ImageSettings;
use lookfrom_scene::{Location, Result, Scene};

use crate::view::camera::Camera;

/// A view of a [`World`](crate::world::World): a camera made for the size of a picture, and the settings of the
/// picture. A world can have any number of views.
#[derive(Clone, Debug)]
pub struct View {
    /// The location of the camera in its file.
    pub(crate) at: Location,
    /// The camera, in the world's coordinates.
    pub(crate) camera: Camera,
    /// The medium around the camera; `None` is a vacuum.
    pub(crate) medium: Option<MediumId>,
    /// Size, crop, filter, background and development of the picture.
    pub(crate) image: ImageSettings,
}

impl View {
    /// A view by a scene's camera.
    ///
    /// # Errors
    /// `Invalid` for a degenerate camera, see [`Camera::new`].
    pub fn new(camera: &Written, image: ImageSettings) -> Result<Self> {
        let at = camera.at.clone();
        Ok(Self { at, camera: Camera::new(camera, image.width, image.height)?, medium: camera.medium, image })
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

    /// Whether its samples start with the same rays, in the same medium, as those of another view.
    pub(crate) fn starts_rays_as(&self, other: &Self) -> bool {
        (&self.camera, self.medium, self.image.filter) == (&other.camera, other.medium, other.image.filter)
    }

    /// Size, crop, filter, background and development of the picture.
    pub fn image(&self) -> &ImageSettings {
        &self.image
    }
}
