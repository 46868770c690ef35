//! Images and materials of models, added to a scene.

use std::path::{Path, PathBuf};

use crate::error::{Location, Result};
use crate::files::LoadContext;
use crate::image::{self, Image};
use crate::material::{Color, Material, MaterialKind, Whitted};
use crate::scene::{ImageId, MaterialId, Scene, TextureId};
use crate::texture::{Channel, Mapping, TexelFilter, Texture, TextureKind, Wrap};

/// The path of a file with this name, with `/` between folders, in the file at `path`.
pub(crate) fn beside(path: &Path, name: &str) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).join(name.trim_start_matches("./"))
}

/// The part of a name after the last `/`.
pub(crate) fn base_name(name: &str) -> &str {
    name.rsplit('/').next().unwrap_or(name)
}

/// The image with this name in the file at `path`; if it does not exist, the one of that name beside the file: exporters
/// often write the folders of their own machine.
///
/// # Errors
/// The error of the first name.
pub(crate) fn read_image(path: &Path, name: &str, context: &mut LoadContext<'_>) -> Result<Image> {
    image::read(&beside(path, name), context)
        .or_else(|error| image::read(&beside(path, base_name(name)), context).map_err(|_| error))
}

/// An image texture over uv, with bilinear filtering.
pub(crate) fn picture(image: ImageId, scale: [f32; 2], offset: [f32; 2], wrap: Wrap) -> TextureKind {
    let mapping = Mapping::Uv { scale, offset };
    TextureKind::Image {
        image,
        mapping,
        wrap: [wrap; 2],
        filter: TexelFilter::Bilinear,
        channel: Channel::Rgb,
        scale: 1.0,
        invert: false,
    }
}

/// Adds an image.
pub(crate) fn push_image(scene: &mut Scene, image: Image) -> ImageId {
    scene.images.push(image);
    ImageId(scene.images.len() as u32 - 1)
}

/// Adds a texture.
pub(crate) fn push_texture(scene: &mut Scene, name: &str, at: &Location, kind: TextureKind) -> Color {
    scene.textures.push(Texture { name: name.to_owned(), at: at.clone(), kind });
    Color::Texture(TextureId(scene.textures.len() as u32 - 1))
}

/// Adds a material.
pub(crate) fn push_material(scene: &mut Scene, name: &str, at: &Location, whitted: Whitted) -> MaterialId {
    scene.materials.push(Material::new(name, at.clone(), MaterialKind::Whitted(whitted)));
    MaterialId(scene.materials.len() as u32 - 1)
}

/// Adds a diffuse material with the colours of the mesh's vertices.
pub(crate) fn push_vertex_colors(scene: &mut Scene, at: &Location) -> MaterialId {
    let name = "vertex colours";
    let diffuse = push_texture(scene, name, at, TextureKind::VertexColor { tint: [1.0; 3] });
    push_material(scene, name, at, Whitted { diffuse, ..Whitted::default() })
}
