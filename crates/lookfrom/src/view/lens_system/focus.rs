//! Focusing by the thick-lens approximation: cardinal points by rays near the axis (Gauss 1841), and the distance from the film that
//! makes the plane of focus sharp. Pharr, Jakob, Humphreys (2023), 5.4.3 and 5.4.4, whose film is in air; here it may be in any medium, as
//! the retina is.

use lookfrom_scene::lens::{LensSurface, LensSystem as Written};
use lookfrom_scene::{Error, Location, Result};

/// A lens system near its axis, focused; lengths in units of the world, from the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ThickLens {
    /// Effective focal length, in air: > 0.
    pub(super) focal_length: f64,
    /// Index of refraction of the medium that the film is in.
    pub(super) film_index: f64,
    /// Distance of the rear vertex.
    pub(super) rear: f64,
    /// Film's size over that of its image in the plane of focus, times the distance of that plane.
    pub(super) pinhole_distance: f64,
}

/// The lens system with its film moved to where the plane of focus is sharp.
///
/// # Errors
/// `Invalid` for a system that does not make an image, a distance too near, and a film that would be inside the lens.
pub(super) fn focused(written: &Written, at: &Location) -> Result<ThickLens> {
    let surfaces = &written.surfaces;
    let length: f64 = surfaces.iter().rev().skip(1).map(|surface| surface.thickness).sum();
    // From the rear vertex, and from the front vertex: to focal point and principal plane.
    let film_index = surfaces.last().map_or(1.0, |rear| rear.index);
    let [to_rear_focus, to_rear_principal] = cardinal_points(surfaces.iter().copied(), 1.0);
    let [to_front_focus, to_front_principal] = cardinal_points(reversed(surfaces).into_iter(), film_index);
    let rear_focal_length = to_rear_focus - to_rear_principal;
    let focal_length = rear_focal_length / film_index;
    let described = || format!("the lens system {:?}", written.name);
    if !(focal_length > 0.0 && focal_length.is_finite() && to_front_focus.is_finite()) {
        let message = format!("{} makes no image: its focal length is {focal_length} mm", described());
        return Err(Error::invalid(at, message).hint("its surfaces are listed from the front to the film"));
    }
    // Film and plane of focus are as far from the principal planes as their sum, which is known, and the lens equation say:
    // n/image + 1/object = 1/f, of which the film, in a medium of the index n, is the nearer one.
    let between_principals = length + to_rear_principal + to_front_principal;
    let distance = written.focus_distance / written.millimetre;
    let both = distance - between_principals;
    let [shortest, unreal] =
        [film_index.sqrt() + 1.0, film_index.sqrt() - 1.0].map(|factor| factor * factor * focal_length);
    let root = ((both - unreal) * (both - shortest)).sqrt();
    if !(both > shortest && root.is_finite()) {
        let nearest = ((shortest + between_principals) * written.millimetre) as f32;
        let message = format!(
            "{} cannot be focused at {}, but only farther away than {nearest}",
            described(),
            written.focus_distance
        );
        return Err(Error::invalid(at, message).hint("focus farther away"));
    }
    let image = 2.0 * rear_focal_length * both / (both + (film_index - 1.0) * focal_length + root);
    let object = both - image;
    let rear = image + to_rear_principal;
    if !(rear > 0.0 && rear.is_finite()) {
        let message = format!("{} has its image {} mm inside of itself", described(), -rear);
        return Err(Error::invalid(at, message));
    }
    let unit = written.millimetre;
    Ok(ThickLens {
        focal_length: focal_length * unit,
        film_index,
        rear: rear * unit,
        pinhole_distance: distance * unit * image / (film_index * object),
    })
}

/// Distances from the last vertex to the focal point and to the principal plane, along light that comes parallel to the axis from a medium
/// of the index `before`.
fn cardinal_points(surfaces: impl Iterator<Item = LensSurface>, mut before: f64) -> [f64; 2] {
    let (mut height, mut slope, mut way) = (1.0, 0.0, 0.0);
    for surface in surfaces {
        height += slope * way;
        let behind = surface.index;
        if !surface.is_stop() {
            slope = (before * slope - height * (behind - before) / surface.curvature_radius) / behind;
        }
        before = behind;
        way = surface.thickness;
    }
    [-height / slope, (1.0 - height) / slope]
}

/// The system for light from the film.
fn reversed(surfaces: &[LensSurface]) -> Vec<LensSurface> {
    let turned = |place: usize| {
        let surface = surfaces[place];
        let (index, thickness) = match place.checked_sub(1) {
            Some(front) => (surfaces[front].index, surfaces[front].thickness),
            None => (1.0, 0.0),
        };
        LensSurface { curvature_radius: -surface.curvature_radius, index, thickness, ..surface }
    };
    (0..surfaces.len()).rev().map(turned).collect()
}
