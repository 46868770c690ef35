//! Images and materials of models, added to a scene.

use std::path::{Path, PathBuf};

use crate::error::{Location, Result};
use crate::files::LoadContext;
use crate::image::{self, Encoding, Image};
use crate::material::{Color, Material, MaterialKind, VERTEX_COLORS, Whitted};
use crate::scene::{ImageId, MaterialId, Scene, TextureId};
use crate::shape::Mesh;
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
pub(crate) fn read_image(
    path: &Path,
    name: &str,
    encoding: Encoding<'_>,
    context: &mut LoadContext<'_>,
) -> Result<Image> {
    let mut read = |name: &str| image::read_encoded(&beside(path, name), context, encoding);
    read(name).or_else(|error| read(base_name(name)).map_err(|_| error))
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
pub(crate) fn add_texture(scene: &mut Scene, name: &str, at: &Location, kind: TextureKind) -> TextureId {
    scene.textures.push(Texture { name: name.to_owned(), at: at.clone(), kind });
    TextureId(scene.textures.len() as u32 - 1)
}

/// Adds a texture that is a colour.
pub(crate) fn push_texture(scene: &mut Scene, name: &str, at: &Location, kind: TextureKind) -> Color {
    Color::Texture(add_texture(scene, name, at, kind))
}

/// Adds a material.
pub(crate) fn push_material(scene: &mut Scene, name: &str, at: &Location, whitted: Whitted) -> MaterialId {
    scene.materials.push(Material::new(name, at.clone(), MaterialKind::Whitted(whitted)));
    MaterialId(scene.materials.len() as u32 - 1)
}

/// The length that a unit of texture coordinates has on a mesh, on average over its area; `None` if it has no texture
/// coordinates, or they span no area.
pub(crate) fn unit_of_uv(mesh: &Mesh) -> Option<f32> {
    let (mut area, mut area_of_uv) = (0.0, 0.0);
    for triangle in mesh.triangles.iter().filter(|_| !mesh.uvs.is_empty()) {
        let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize].as_dvec3());
        area += (b - a).cross(c - a).length();
        let [a, b, c] = triangle.map(|vertex| mesh.uvs[vertex as usize].as_dvec2());
        area_of_uv += (b - a).perp_dot(c - a).abs();
    }
    let length = (area / area_of_uv).sqrt() as f32;
    length.is_normal().then_some(length)
}

/// Adds a diffuse material with the colours of the mesh's vertices.
pub(crate) fn push_vertex_colors(scene: &mut Scene, at: &Location) -> MaterialId {
    let diffuse = push_texture(scene, VERTEX_COLORS, at, TextureKind::VertexColor { tint: [1.0; 3] });
    push_material(scene, VERTEX_COLORS, at, Whitted { diffuse, ..Whitted::default() })
}
