//! Memory of a session, from its budget: of its world, and of a picture while it is rendered and developed.

use std::path::Path;

use lookfrom_scene::budget::Reservation;
use lookfrom_scene::image::Image;
use lookfrom_scene::{Budget, Location, Remedy, Result, Scene, Warning};

use super::{Session, in_file};
use crate::film::Film;
use crate::world::World;

/// Compiles a valid scene, whose own memory is `of_scene`; returns the world's with it.
///
/// # Errors
/// As [`World::compile`], and `Limit` if the budget is exceeded.
pub(super) fn compile(
    scene: Scene,
    mut of_scene: Vec<Reservation>,
    budget: &Budget,
    path: &Path,
    warnings: &mut Vec<Warning>,
) -> Result<(World, Vec<Reservation>)> {
    let memory = budget.reserve(World::memory(&scene), "the compiled scene", &Location::file(path))?;
    // The world takes the pictures over, and nothing else.
    let mut images = scene.images.iter().map(Image::bytes).sum::<u64>();
    let world = World::compile_valid(scene, warnings).map_err(in_file(path))?;
    for reservation in &mut of_scene {
        reservation.shrink(images);
        images -= reservation.bytes();
    }
    of_scene.push(memory);
    Ok((world, of_scene))
}

impl Session {
    /// Memory for the film of this session's picture, and for developing it, as [`Session::render`] reserves it: for those
    /// who render by [`Session::renderer`].
    ///
    /// # Errors
    /// `Limit` if the budget is exceeded.
    pub fn room_for_picture(&self) -> Result<Reservation> {
        let image = self.image();
        let what = format!("the film of {} × {} pixels", image.width, image.height);
        let at = Location { file: self.name.as_str().into(), ..Location::default() };
        self.budget
            .reserve(Film::memory(image), &what, &at)
            .map_err(|error| error.hint(Remedy::SmallerPicture))
    }
}
