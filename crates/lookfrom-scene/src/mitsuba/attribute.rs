//! Attributes of meshes, which textures show: the first of a surface is the mesh's colours, others are in its further sets of texture
//! coordinates.

use std::path::Path;
use std::rc::Rc;

use glam::Vec2;

use super::Reader;
use super::plugin::Plugin;
use super::xml::blame;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::material::{Color, Scalar};
use crate::ply;
use crate::scene::Scene;
use crate::shape::Mesh;
use crate::texture::{Mapping, TextureKind};

/// An attribute of meshes.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Attribute {
    /// `vertex` or `face`.
    element: &'static str,
    /// Its name without the element.
    name: String,
}

/// Slot of a mesh for an attribute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Slot {
    /// In its colours.
    Colors,
    /// A number, as u and v of a set of texture coordinates.
    Number(u32),
    /// A colour: red and green as u and v of a set of texture coordinates, blue in the next one.
    Color(u32),
}

/// Attributes of a mesh with their slots.
pub(super) type Slots = Vec<(Attribute, Slot)>;

impl Attribute {
    /// That of a texture.
    fn of(plugin: &Plugin) -> Result<Self> {
        let name = plugin.string("name")?.unwrap_or_default();
        let of = |element: &'static str| {
            let name = name.strip_prefix(element)?.strip_prefix('_').filter(|name| !name.is_empty())?;
            Some(Self { element, name: name.to_owned() })
        };
        of("vertex")
            .or_else(|| of("face"))
            .ok_or_else(|| plugin.refuse("name", "that of an attribute: \"vertex_…\" or \"face_…\""))
    }
}

impl Reader<'_, '_> {
    /// The attributes of meshes that textures in plugins are of, those of the last plugin first.
    pub(super) fn attributes(&self, mut rest: Vec<Rc<Plugin>>) -> Result<Vec<Attribute>> {
        let (mut found, mut seen) = (Vec::new(), Vec::new());
        while let Some(plugin) = rest.pop() {
            if seen.contains(&Rc::as_ptr(&plugin)) {
                continue;
            }
            seen.push(Rc::as_ptr(&plugin));
            if plugin.kind == "mesh_attribute" {
                let attribute = Attribute::of(&plugin)?;
                if !found.contains(&attribute) {
                    found.push(attribute);
                }
            }
            for property in &plugin.properties {
                rest.extend(property.plugin(&self.ids)?);
            }
        }
        Ok(found)
    }

    /// Gives a mesh the attributes of its file.
    pub(super) fn add_attributes(
        &mut self,
        mesh: &mut Mesh,
        (path, at): (&Path, &Location),
        attributes: &[Attribute],
    ) -> Result<Slots> {
        let mut slots = Vec::new();
        for attribute in attributes {
            let Attribute { element, name } = attribute;
            let mut alone = Scene::default();
            let parts = ply::read_with_attribute(path, (element, name), self.context, &mut alone)
                .map_err(|error| blame(error, at))?;
            let (Some(_), [read]) = (parts, &alone.meshes[..]) else {
                let message = format!("the mesh has no attribute `{element}_{name}` of one or three numbers");
                return Err(Error::invalid(at, message));
            };
            let values = at_vertices(mesh, read);
            slots.push((attribute.clone(), put(mesh, values, slots.is_empty(), at)?));
        }
        Ok(slots)
    }

    /// The texture of an attribute.
    pub(super) fn attribute_texture(&mut self, plugin: &Plugin) -> Result<TextureKind> {
        let attribute = Attribute::of(plugin)?;
        let scale = plugin.float_where("scale", 1.0, "a number of at least 0", |scale| scale >= 0.0)? as f32;
        let slot = self.slots.iter().find(|(of, _)| *of == attribute).map(|(_, slot)| *slot);
        Ok(match slot.unwrap_or(Slot::Colors) {
            Slot::Colors => TextureKind::VertexColor { tint: [scale; 3] },
            Slot::Number(set) => plane(set, [[scale; 3], [0.0; 3]]),
            Slot::Color(set) => {
                // The mean of twice each.
                let twice = 2.0 * scale;
                let low = plane(set, [[twice, 0.0, 0.0], [0.0, twice, 0.0]]);
                let high = plane(set + 1, [[0.0, 0.0, twice], [0.0; 3]]);
                let [low, high] = [low, high].map(|kind| Color::Texture(self.push_texture(plugin, kind)));
                TextureKind::Mix { low, high, amount: Scalar::Value(0.5) }
            }
        })
    }
}

/// The sum of u and v of a set of texture coordinates, each times a colour.
fn plane(set: u32, [u, v]: [[f32; 3]; 2]) -> TextureKind {
    let both = std::array::from_fn(|c| u[c] + v[c]);
    TextureKind::Bilinear {
        corners: [[0.0; 3], v, u, both].map(Color::Value),
        mapping: Mapping::Affine { set, matrix: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] },
    }
}

/// The colours of another reading of a mesh at its vertices, which are split where that has split them.
fn at_vertices(mesh: &mut Mesh, read: &Mesh) -> Vec<[f32; 3]> {
    if mesh.triangles == read.triangles {
        return read.colors.clone();
    }
    let corners: Vec<usize> = mesh.triangles.iter().flatten().map(|&vertex| vertex as usize).collect();
    fn split<T: Copy>(corners: &[usize], values: &mut Vec<T>) {
        if !values.is_empty() {
            *values = corners.iter().map(|&vertex| values[vertex]).collect();
        }
    }
    split(&corners, &mut mesh.positions);
    split(&corners, &mut mesh.normals);
    split(&corners, &mut mesh.colors);
    for uvs in std::iter::once(&mut mesh.uvs).chain(&mut mesh.more_uvs) {
        split(&corners, uvs);
    }
    for (first, triangle) in (0..).step_by(3).zip(&mut mesh.triangles) {
        *triangle = [first, first + 1, first + 2];
    }
    read.triangles.iter().flatten().map(|&vertex| read.colors[vertex as usize]).collect()
}

/// Puts an attribute where a mesh has room for it.
fn put(mesh: &mut Mesh, values: Vec<[f32; 3]>, is_first: bool, at: &Location) -> Result<Slot> {
    if is_first {
        mesh.colors = values;
        return Ok(Slot::Colors);
    }
    let set = mesh.more_uvs.len() as u32 + 1;
    let is_number = values.iter().all(|[r, g, b]| r == g && g == b);
    let of = |u: usize, v: usize| values.iter().map(|rgb| Vec2::new(rgb[u], rgb[v])).collect();
    mesh.more_uvs.push(of(0, 1));
    if !is_number {
        mesh.more_uvs.push(of(2, 2));
    }
    if mesh.more_uvs.len() >= Mesh::MOST_UV_SETS {
        let message = "too many attributes of a mesh in one surface";
        let error = Error::new(ErrorKind::Unsupported, at, message);
        return Err(
            error.hint("there is room for one colour and three numbers, or two colours and one number")
        );
    }
    Ok(if is_number { Slot::Number(set) } else { Slot::Color(set) })
}
