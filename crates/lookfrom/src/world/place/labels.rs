//! Labels of shapes for reports: unlike names, every shape has one, and it tells the shape from others.
//!
//! A shape without a name is called by its material's, if no other such shape has that material; else by material, kind
//! and number, such as `Diffuse trianglemesh 3`, in the order of the file. The place in the file follows in
//! parentheses.

use std::collections::HashMap;

use lookfrom_scene::Scene;
use lookfrom_scene::material::VERTEX_COLORS;
use lookfrom_scene::shape::{Geometry, Shape};

use crate::world::ShapeLabel;

/// Names of materials that nobody chose.
const UNCHOSEN: [&str; 3] = ["", "default", VERTEX_COLORS];

/// The labels of a scene's shapes.
pub(in crate::world) struct Labels {
    /// The labels of shapes that are in no object.
    pub(in crate::world) shapes: Vec<ShapeLabel>,
    /// The labels of the shapes of each object.
    pub(in crate::world) objects: Vec<Vec<ShapeLabel>>,
}

impl Labels {
    pub(in crate::world) fn new(scene: &Scene) -> Self {
        let in_objects = scene.objects.iter().flat_map(|object| &object.shapes);
        let mut by_material: HashMap<&str, usize> = HashMap::new();
        let mut by_words: HashMap<String, usize> = HashMap::new();
        for shape in scene.shapes.iter().chain(in_objects).filter(|shape| shape.name.is_none()) {
            *by_material.entry(material(scene, shape).unwrap_or_default()).or_default() += 1;
            *by_words.entry(words(scene, shape)).or_default() += 1;
        }
        let mut numbers: HashMap<String, usize> = HashMap::new();
        let mut label = |shape: &Shape| {
            if let Some(name) = &shape.name {
                return ShapeLabel { name: name.clone(), at: None, pieces: shape.pieces.clone() };
            }
            let words = words(scene, shape);
            let name = match material(scene, shape) {
                Some(material) if by_material[material] == 1 => material.to_owned(),
                _ if by_words[&words] == 1 => words,
                _ => {
                    let number = numbers.entry(words.clone()).or_default();
                    *number += 1;
                    format!("{words} {number}")
                }
            };
            ShapeLabel { name, at: Some(shape.at.clone()), pieces: shape.pieces.clone() }
        };
        Self {
            shapes: scene.shapes.iter().map(&mut label).collect(),
            objects: scene
                .objects
                .iter()
                .map(|object| object.shapes.iter().map(&mut label).collect())
                .collect(),
        }
    }
}

/// The name of a shape's material, if it has one of its own.
fn material<'a>(scene: &'a Scene, shape: &Shape) -> Option<&'a str> {
    let name = scene.materials.get(shape.material.index())?.name.as_str();
    (!UNCHOSEN.contains(&name)).then_some(name)
}

/// Material and kind.
fn words(scene: &Scene, shape: &Shape) -> String {
    let kind = kind(scene, shape);
    match material(scene, shape) {
        Some(material) => format!("{material} {kind}"),
        None => kind.to_owned(),
    }
}

fn kind<'a>(scene: &'a Scene, shape: &Shape) -> &'a str {
    match &shape.geometry {
        Geometry::Sphere(_) => "sphere",
        Geometry::Spheres(_) => "spheres",
        Geometry::Quad { .. } => "quad",
        Geometry::Disk { .. } => "disk",
        Geometry::PartialSphere { .. } => "partial sphere",
        Geometry::PartialDisk { .. } => "partial disk",
        Geometry::Cylinder { .. } => "cylinder",
        Geometry::Torus { .. } => "torus",
        Geometry::SolidSurface { .. } => "solid",
        Geometry::Bilinear(_) => "bilinear patches",
        Geometry::Curves(_) => "curves",
        Geometry::Mesh(id) => match file_stem(&scene.meshes[id.index()].name) {
            "" => "mesh",
            name => name,
        },
    }
}

/// The name of a mesh, which may be that of its file, without folders and extensions.
fn file_stem(name: &str) -> &str {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    let plain = file.strip_suffix(".gz").unwrap_or(file);
    [".ply", ".obj", ".stl", ".hair"]
        .into_iter()
        .find_map(|ending| plain.strip_suffix(ending))
        .unwrap_or(file)
}

#[cfg(test)]
mod tests {
    use lookfrom_scene::Location;
    use lookfrom_scene::material::{Color, Material, MaterialKind};
    use lookfrom_scene::scene::{MaterialId, MeshId};
    use lookfrom_scene::shape::Mesh;

    use super::*;

    #[test]
    fn labels_tell_shapes_apart() {
        let mut scene = Scene::default();
        let grey = || MaterialKind::Diffuse { reflectance: Color::gray(0.5) };
        for name in ["default", "wall", "lamp"] {
            scene.materials.push(Material::new(name, Location::default(), grey()));
        }
        for name in ["models/Bust.ply.gz", "", ""] {
            scene.meshes.push(Mesh { name: name.into(), ..Mesh::default() });
        }
        let mut add = |mesh: u32, material: u32, name: Option<&str>| {
            let mut shape =
                Shape::new(Location::default(), Geometry::Mesh(MeshId(mesh)), MaterialId(material));
            shape.name = name.map(str::to_owned);
            scene.shapes.push(shape);
        };
        add(0, 1, None);
        add(1, 1, None);
        add(2, 1, None);
        add(1, 2, None);
        add(1, 0, None);
        add(1, 1, Some("door"));
        let labels = Labels::new(&scene).shapes;
        assert_eq!(labels[3].to_string(), format!("lamp ({})", Location::default()));
        assert_eq!(labels[5].to_string(), "door");
        let names: Vec<&str> = labels.iter().map(|label| &*label.name).collect();
        assert_eq!(names, ["wall Bust", "wall mesh 1", "wall mesh 2", "lamp", "mesh", "door"]);
    }
}
