//! The scene of a file of volumes alone: white smoke of its densities, which the studio frames and lights as a model.
//!
//! Programs agree neither on the unit of length nor on that of densities. So the coefficients are such that light loses itself in the
//! smoke after the same part of its size, whatever the numbers are.

use glam::{DMat3, DVec3, IVec3, Vec3};

use crate::error::{Location, Result};
use crate::files::LoadContext;
use crate::material::{Color, Material, MaterialKind};
use crate::medium::{Density, Extinction, Medium, Sides, Variation};
use crate::remedy::Remedy;
use crate::scene::{MaterialId, MediumId, MeshId, Scene, SourceFormat};
use crate::shape::{Geometry, Shape};
use crate::source::Source;
use crate::vdb::VdbFile;
use crate::volume::{GridClass, Volume};
use crate::warning::Warning;
use crate::{composite, studio};

/// The optical thickness of a cube of the mean density with the volume of all that is not empty.
const THICKNESS: f64 = 30.0;
/// The part of the light that smoke scatters, of what does not pass it.
const ALBEDO: f32 = 0.95;

/// The scene of a file.
///
/// # Errors
/// As [`vdb::read`](crate::vdb::read).
pub(super) fn scene(source: &Source<'_>, context: &mut LoadContext<'_>) -> Result<Scene> {
    let at = Location::file(source.path);
    let file = VdbFile::new(&source.bytes, &at)?;
    let (name, volume) = shown(&file, context)?;
    let others: Vec<String> =
        file.names().iter().filter(|other| **other != name).map(|other| format!("{other:?}")).collect();
    if !others.is_empty() {
        let message = format!("shows the grid {name:?} as white smoke, and nothing of {}", others.join(", "));
        let remedy = "in a scene of its own, [media.NAME] says what is dense and what is hot";
        context.warnings.push(Warning::notice(&at, message).remedy(Remedy::Words(remedy.to_owned())));
    }
    Ok(of_volume(name, volume, &at))
}

/// The grid that is shown: the densities, or else the first that can be.
fn shown<'a>(file: &'a VdbFile<'_>, context: &mut LoadContext<'_>) -> Result<(&'a str, Volume)> {
    if let Some(volume) = file.volume(VdbFile::DENSITY, GridClass::Fog, context)? {
        return Ok((VdbFile::DENSITY, volume));
    }
    let mut first = None;
    for name in file.names() {
        match file.volume(name, GridClass::Fog, context) {
            Ok(Some(volume)) => return Ok((name, volume)),
            Ok(None) => {}
            Err(error) => first = first.or(Some(error)),
        }
    }
    Err(first.unwrap_or_else(|| file.without(VdbFile::DENSITY)))
}

fn of_volume(name: &str, volume: Volume, at: &Location) -> Scene {
    let (world_from_index, bounds) = (volume.world_from_index, volume.bounds.map(IVec3::as_vec3));
    let placed = volume.into_densities();
    // The number of cells that are not empty, and the sum of their densities.
    let (mut count, mut sum) = (0.0, 0.0);
    placed.grid.for_each_box(|[first, last], density| {
        let cells: f64 = (0..3).map(|axis| f64::from(last[axis] - first[axis] + 1)).product();
        count += if density > 0.0 { cells } else { 0.0 };
        sum += cells * f64::from(density);
    });
    let cell = DMat3::from_mat4(world_from_index).determinant().abs();
    let along = sum / count * (count * cell).cbrt();
    let scale = if sum > 0.0 { (THICKNESS / along) as f32 } else { 0.0 };
    let medium = Medium {
        extinction: Extinction::Parts {
            absorption: Color::gray(1.0 - ALBEDO),
            scattering: Color::gray(ALBEDO),
        },
        scale,
        variation: Some(Variation {
            world_from_medium: world_from_index,
            bounds: Some(bounds),
            density: Density::Grid(placed),
            emission_scale: None,
            temperature: None,
        }),
        ..Medium::clear(name, at.clone())
    };

    // A box around the active values, which is not seen.
    let [low, high] = bounds.map(Vec3::as_dvec3);
    let around = composite::cuboid(low, high.max(low + DVec3::ONE));
    let (image, render) = studio::settings_for_models();
    let mut scene = Scene { source_format: SourceFormat::Model, image, render, ..Scene::default() };
    scene.render.depth = studio::DEPTH_IN_MEDIA;
    scene.media.push(medium);
    scene.meshes.push(around);
    scene.materials.push(Material::new("air", at.clone(), MaterialKind::Interface));
    scene.shapes.push(Shape {
        name: Some(name.to_owned()),
        sides: Some(Sides { inside: Some(MediumId(0)), outside: None }),
        world_from_object: world_from_index,
        ..Shape::new(at.clone(), Geometry::Mesh(MeshId(0)), MaterialId(0))
    });
    scene
}
