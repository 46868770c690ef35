//! Materials and lights from texts in our scene format, to replace those of a session.

use std::path::Path;

use lookfrom::scene::light::Light;
use lookfrom::scene::material::Material;
use lookfrom::scene::{Error, LoadContext, Location, Memory, Result, Scene, load};

/// The name of the text in messages.
const NAME: &str = "scene.toml";

/// The one material of a text.
///
/// # Errors
/// Errors of the reader; `Invalid` where it needs textures, which the scene of a session cannot be given.
pub(super) fn material(text: &str) -> Result<Material> {
    let mut scene = parsed(text)?;
    scene.materials.pop().ok_or_else(|| Error::invalid(&Location::default(), "no material is given"))
}

/// The lights of a text.
///
/// # Errors
/// As [`material`].
pub(super) fn lights(text: &str) -> Result<Vec<Light>> {
    Ok(parsed(text)?.lights)
}

/// The text as a file, to show lines of.
pub(super) fn files(text: &str) -> Memory {
    Memory([(NAME.into(), text.as_bytes().to_vec())].into())
}

fn parsed(text: &str) -> Result<Scene> {
    let files = files(text);
    let scene = load::scene(Path::new(NAME), &mut LoadContext::new(&files))?;
    if !scene.textures.is_empty() || !scene.images.is_empty() || !scene.curves.is_empty() {
        let message = "textures, images and spectra cannot be given to a session that exists";
        return Err(
            Error::invalid(&Location::default(), message).hint("make a new Session of a scene with them")
        );
    }
    Ok(scene)
}
