//! Reader for Wavefront OBJ files, to meshes and materials.
//!
//! `statement` parses the text, `build` makes one mesh per material, `color` reads colours of vertices, [`mtl`] parses material libraries (`map` their texture
//! maps), `subdivide` makes subdivision surfaces of polygons, `look` converts their materials, `physical` those that are physically based, and `maps` reads their images. The
//! format: Wavefront, "Object Files (.obj)", Advanced Visualizer manual, appendix B1.

mod build;
mod color;
mod look;
mod map;
mod maps;
pub mod mtl;
mod physical;
mod statement;
mod subdivide;

use std::path::Path;

use crate::error::{Error, Location, Result};
use crate::files::LoadContext;
use crate::material::{Color, Whitted};
use crate::model::surface::{push_material, unit_of_uv};
use crate::model::{lines, points, text};
use build::Elements;
use look::MeshTraits;

use crate::scene::{MeshId, Scene};
use crate::shape::{Geometry, Part};

/// Reads the content of an OBJ file and the material libraries and images that it names. There is one part per material; a file without
/// faces and lines is a point cloud; lines are thin wires. Objects are pieces of the parts that have their faces. Vertex colours are taken to be sRGB-encoded.
/// Messages and relative file names use `path`.
///
/// # Errors
/// `Io`, `Limit`, `Syntax` and `Invalid`, at line and column. After an error the scene may contain parts of the file.
pub fn from_bytes(
    bytes: &[u8],
    path: &Path,
    context: &mut LoadContext<'_>,
    scene: &mut Scene,
) -> Result<Vec<Part>> {
    read(bytes, path, true, context, scene)
}

/// As [`from_bytes`], without materials: no libraries and images are read.
pub(crate) fn geometry_from_bytes(
    bytes: &[u8],
    path: &Path,
    context: &mut LoadContext<'_>,
    scene: &mut Scene,
) -> Result<Vec<Part>> {
    read(bytes, path, false, context, scene)
}

fn read(
    bytes: &[u8],
    path: &Path,
    has_materials: bool,
    context: &mut LoadContext<'_>,
    scene: &mut Scene,
) -> Result<Vec<Part>> {
    let file = Location::file(path);
    let text = text::utf8(bytes);
    let mut statements = statement::parse(&text, &file, context)?;
    drop(text);
    if statements.positions.is_empty() {
        return Err(Error::syntax(&file, "no vertices: there is no line that starts with `v`")
            .hint("check that this is a Wavefront OBJ file and that it is whole"));
    }
    if statements.groups.iter().all(|group| group.faces.is_empty() && group.lines.is_empty()) {
        let mut parts = points::cloud(&statements.positions, &statements.colors, &file, context, scene);
        statements.place.put(&mut parts, &[], 0, &file, context);
        return Ok(parts);
    }
    if let levels @ 1.. = context.import.subdivision {
        subdivide::subdivide(&mut statements, levels, &file, context)?;
    }
    let (colored, place) = (!statements.colors.is_empty(), statements.place);
    let first = scene.meshes.len();
    let meshes = build::meshes(statements, &file, context)?;
    let named = if has_materials { &*meshes.libraries } else { &[] };
    let mut libraries = look::MaterialLibraries::read(named, path, context);
    let mut parts = Vec::new();
    for group in meshes.groups {
        let traits = match &group.elements {
            Elements::Mesh(mesh, _) => MeshTraits { is_colored: colored, unit_of_uv: unit_of_uv(mesh) },
            Elements::Lines(..) => MeshTraits { is_colored: false, unit_of_uv: None },
        };
        let material = group.material.as_deref().filter(|_| has_materials);
        let binding = libraries.binding(material, traits, &file, context, scene);
        let name = group
            .material
            .map(|name| String::from_utf8_lossy(&name).into_owned())
            .or_else(|| group.object.as_deref().map(str::to_owned));
        let part = |geometry, material| Part {
            material,
            emission: binding.emission,
            alpha: binding.alpha,
            ..Part::new(name.clone(), geometry)
        };
        match group.elements {
            Elements::Mesh(mesh, pieces) => {
                let id = MeshId(scene.meshes.len() as u32);
                scene.meshes.push(*mesh);
                parts.push(Part { pieces, ..part(Geometry::Mesh(id), binding.material) });
            }
            Elements::Lines(ends, colors) => {
                for (color, wires) in
                    lines::wires(&ends, if binding.material.is_some() { &[] } else { &colors })
                {
                    let material = color.map(|color| {
                        let whitted = Whitted { diffuse: Color::Value(color), ..Whitted::default() };
                        push_material(scene, "lines", &file, whitted)
                    });
                    parts.push(part(wires, binding.material.or(material)));
                }
            }
        }
    }
    libraries.warn(&file, context);
    place.put(&mut parts, &scene.meshes[first..], 0, &file, context);
    Ok(parts)
}
