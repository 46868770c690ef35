//! The comparison of scenes up to their numbers, names and locations: in words that tell what is referred to.

use std::sync::Arc;

use lookfrom_scene::Scene;
use lookfrom_scene::camera::{Camera, Projection};
use lookfrom_scene::grid::Placed;
use lookfrom_scene::lens::{ApertureShape, LensSystem};
use lookfrom_scene::light::Light;
use lookfrom_scene::material::Material;
use lookfrom_scene::medium::{Density, Medium, Variation};
use lookfrom_scene::scene::Instance;
use lookfrom_scene::settings::{ImageSettings, LightPathLayer};
use lookfrom_scene::shape::{Mesh, Shape};

use super::all::here;

/// Compares scenes by all that has an effect on their pictures.
///
/// # Errors
/// The first difference of two scenes.
pub(super) fn same(before: &Scene, after: &Scene) -> Result<(), String> {
    let (before, after) = (told(before), told(after));
    match before.iter().zip(&after).find(|(before, after)| before != after) {
        Some((before, after)) => Err(format!("{before}\nhas become\n{after}")),
        None if before.len() != after.len() => {
            Err(format!("{} parts, and not {}", after.len(), before.len()))
        }
        None => Ok(()),
    }
}

/// The parts of a scene, in words that tell what is referred to instead of its number.
fn told(scene: &Scene) -> Vec<String> {
    let Scene { vertex_normals, camera, image, render, shapes, instances, lights, .. } = scene;
    let mut told = vec![format!("{vertex_normals:?} {render:?}")];
    let paths = image.light_paths.iter().map(|layer| LightPathLayer { at: here(), ..layer.clone() });
    told.push(format!("{:?}", ImageSettings { light_paths: paths.collect(), ..image.clone() }));
    let shape = |shape: &Shape| format!("{:?}", Shape { at: here(), ..shape.clone() });
    told.push(camera.as_ref().map_or(String::new(), camera_in_words));
    told.extend(shapes.iter().map(shape));
    for instance in instances {
        told.push(format!("{:?}", Instance { at: here(), ..instance.clone() }));
        told.extend(scene.objects[instance.object.index()].shapes.iter().map(shape));
    }
    told.extend(lights.iter().map(|light| format!("{:?}", Light { at: here(), ..light.clone() })));
    told.iter().map(|part| resolved(scene, part)).collect()
}

fn camera_in_words(camera: &Camera) -> String {
    let mut camera = Camera { at: here(), ..camera.clone() };
    if let Projection::LensSystem(system) = &camera.projection {
        let mut system = LensSystem { name: String::new(), ..(**system).clone() };
        if let ApertureShape::Image(image) = &system.shape {
            let mut image = (**image).clone();
            image.name.clear();
            system.shape = ApertureShape::Image(Arc::new(image));
        }
        camera.projection = Projection::LensSystem(Arc::new(system));
    }
    format!("{camera:?}")
}

/// A text with what numbers refer to in their place.
fn resolved(scene: &Scene, text: &str) -> String {
    const KINDS: [&str; 7] =
        ["TextureId(", "CurveId(", "MaterialId(", "MediumId(", "ImageId(", "MeshId(", "ObjectId("];
    let first = KINDS.iter().filter_map(|kind| text.find(kind).map(|at| (at, *kind))).min();
    let Some((at, kind)) = first else { return text.to_owned() };
    let (number, rest) = text[at + kind.len()..].split_once(')').expect("a number in brackets");
    let index: usize = number.parse().expect("a number");
    let of = match kind {
        "TextureId(" => format!("{:?}", scene.textures[index].kind),
        "CurveId(" => format!("{:?}", scene.curves[index]),
        "MaterialId(" => {
            let Material { kind, bump_mapping, bump_guard, medium, back_face, .. } = &scene.materials[index];
            format!("{kind:?} {bump_mapping:?} {bump_guard:?} {medium:?} {back_face:?}")
        }
        "MediumId(" => {
            let medium = &scene.media[index];
            let plain = Medium { name: String::new(), at: here(), variation: None, ..medium.clone() };
            format!("{plain:?} {}", medium.variation.as_ref().map_or(String::new(), variation_in_words))
        }
        "ImageId(" => {
            let image = &scene.images[index];
            let texels: Vec<[f32; 4]> = (0..image.len()).map(|texel| image.rgba(texel)).collect();
            format!("{}×{} {texels:?}", image.width, image.height)
        }
        "MeshId(" => format!("{:?}", Mesh { name: String::new(), ..scene.meshes[index].clone() }),
        _ => "an object".to_owned(),
    };
    format!("{}{}{}", &text[..at], resolved(scene, &of), resolved(scene, rest))
}

/// A variation with the values of its grids, however they are stored.
fn variation_in_words(variation: &Variation) -> String {
    fn values<T: Copy + Default + PartialEq + std::fmt::Debug>(placed: &Placed<T>) -> String {
        let [x, y, z] = placed.grid.size().map(|cells| cells as i32);
        let cells = (0..x * y * z).map(|index| [index % x, index / x % y, index / x / y]);
        let values: Vec<T> = cells.map(|cell| placed.grid.value(cell)).collect();
        format!("{:?} {values:?}", placed.bounds)
    }
    let Variation { world_from_medium, bounds, density, emission_scale, temperature } = variation;
    let density = match density {
        Density::Grid(placed) => values(placed),
        Density::Colors { absorption, scattering, emission } => {
            [absorption, scattering, emission].map(|of| of.as_ref().map_or(String::new(), values)).join(" ")
        }
        other => format!("{other:?}"),
    };
    let emission = emission_scale.as_ref().map_or(String::new(), values);
    let hot = temperature
        .as_ref()
        .map_or(String::new(), |hot| format!("{} {} {}", values(&hot.grid), hot.offset, hot.scale));
    format!("{world_from_medium:?} {bounds:?} {density} {emission} {hot}")
}
