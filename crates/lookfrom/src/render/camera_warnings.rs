//! Warnings about the camera: it sees nothing of the scene, or is inside a body.
//!
//! Tested by rays. The camera is inside a body if rays in nearly all directions cross its surface an odd number of
//! times and hit its back first, and if its back is nearly all that the picture shows. Rooms do not count: their
//! surfaces face inward, other objects are in them, or a light inside lights them.

use glam::{DVec3, Vec3};
use lookfrom_bvh::{Hit, Ray};
use lookfrom_scene::scene::{Bounds, SourceFormat};
use lookfrom_scene::{Location, Scene, Warning};

use super::Renderer;
use crate::core::warp;
use crate::light::{IncompletePdf, Light, LightSampleContext, Target};
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::material::MaterialKind;
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// Number of camera rays along each side of the picture: at first, and if those hit nothing. The second is odd, so that
/// a ray goes through the centre, where small and distant objects mostly are.
const COARSE: u32 = 16;
const FINE: u32 = 129;
/// The square root of the number of rays in all directions.
const AROUND: u32 = 8;
/// Number of parts of the scene at whose middles is looked, if those rays hit nothing: lamps may be smaller than a pixel.
const MIDDLES: usize = 4096;
/// The fraction of rays that has to agree.
const NEARLY_ALL: f64 = 0.9;

/// The scene that a camera should see.
#[derive(Clone, Debug)]
pub(crate) struct Subject {
    /// The bounding box of the scene, in the world.
    bounds: Bounds,
    /// The middles of the bounding boxes of its parts, in the world: of the first [`MIDDLES`] of them.
    middles: Vec<DVec3>,
    /// The location of the camera in the scene's file.
    at: Location,
    /// Whether all parts of the scene are one body.
    is_model: bool,
}

impl Subject {
    /// The contents of `bounds`, such as a scene without what was added to it.
    pub(crate) fn of_scene(scene: &Scene, bounds: Bounds) -> Self {
        let at = scene.camera.as_ref().map(|camera| camera.at.clone()).unwrap_or_default();
        let parts = scene.bounds_of_parts().filter(|part| !part.is_empty());
        let middles = parts.map(Bounds::center).take(MIDDLES).collect();
        Self { bounds, middles, at, is_model: scene.source_format != SourceFormat::Scene }
    }
}

/// Warns where the picture would be the background alone, or the inside of something.
pub(super) fn check(renderer: &Renderer, subject: &Subject, warnings: &mut Vec<Warning>) {
    let &Subject { bounds, ref middles, ref at, is_model } = subject;
    if bounds.is_empty() || renderer.surface.is_some() {
        return;
    }
    let world = renderer.world();
    let seen = seen(renderer, COARSE);
    let message = if seen.iter().all(Option::is_none) {
        if self::seen(renderer, FINE).iter().any(Option::is_some) || sees_one_of(renderer, middles) {
            return;
        }
        // It looks at the medium that it is in.
        if !world.space_of(renderer.view.medium).is_empty() {
            return;
        }
        // It looks at a medium, perhaps one that is not rendered, of which its reader warns.
        let is_interface = |surface: &SurfaceInteraction| world.is_interface(surface);
        if first_hits(renderer, FINE, |_| false).iter().flatten().any(is_interface) {
            return;
        }
        let [min, max] = [bounds.min.as_vec3(), bounds.max.as_vec3()];
        format!(
            "the camera sees nothing of the scene, which lies between {min} and {max}: the picture shows only the background; \
             change the camera's position (lookfrom) or direction (lookat)"
        )
    } else {
        let Some(shape) = body_around_the_eye(renderer, &seen, is_model) else { return };
        if is_lit_from_within(renderer) {
            return;
        }
        let body = match world.names.shapes.get(shape as usize) {
            Some(name) if !is_model => format!("`{name}`"),
            _ => "the model".to_owned(),
        };
        format!(
            "the camera stands inside {body}: the picture shows only its inner side; move the camera (lookfrom) out of it"
        )
    };
    warnings.push(Warning::new(at, message));
}

/// Whether the picture would be the background alone only because the camera sees the backs of single-sided surfaces.
pub(super) fn sees_only_backs(renderer: &Renderer) -> bool {
    let sees_nothing = |side| seen(renderer, side).iter().all(Option::is_none);
    let sees_backs = || {
        let passes_nothing = |_: &SurfaceInteraction| false;
        first_hits(renderer, FINE, passes_nothing).iter().flatten().any(|surface| surface.single_sided)
    };
    renderer.surface.is_none()
        && renderer.world().has_single_sides()
        && sees_nothing(COARSE)
        && sees_nothing(FINE)
        && sees_backs()
}

/// First hits of rays through a grid over the picture, behind surfaces that camera rays pass.
fn seen(renderer: &Renderer, side: u32) -> Vec<Option<SurfaceInteraction>> {
    first_hits(renderer, side, |surface| is_passed_by_camera_rays(renderer.world(), surface))
}

/// Whether a ray through one of the places, which are in the world, hits something that camera rays do not pass.
fn sees_one_of(renderer: &Renderer, places: &[DVec3]) -> bool {
    let camera = renderer.view().camera();
    let view_from_world = camera.world_from_view().inverse();
    let is_in_picture =
        |image: &[f64; 2]| (0..2).all(|axis| (0.0..f64::from(camera.size[axis])).contains(&image[axis]));
    let mut hits = Vec::new();
    let images =
        places.iter().filter_map(|place| image_of(renderer, view_from_world.transform_point3(*place)));
    images.filter(is_in_picture).any(|image| {
        first_hit(renderer, image, &mut hits, |surface| is_passed_by_camera_rays(renderer.world(), surface))
            .is_some()
    })
}

/// The point of the image at which a point of view space is seen, also through a lens system that distorts.
fn image_of(renderer: &Renderer, point: DVec3) -> Option<[f64; 2]> {
    /// Distortion is far smaller than the picture: each step leaves a part of the way.
    const STEPS: u32 = 8;
    let camera = renderer.view().camera();
    let through_pinhole = camera.image_of(point)?;
    if camera.lens_system.is_none() {
        return Some(through_pinhole);
    }
    let mut image = through_pinhole;
    let view_from_world = camera.world_from_view().inverse();
    for _ in 0..STEPS {
        // Where the ray is at the depth of the point.
        let ray = camera.ray(image, [0.5; 2]);
        let start = renderer.ray_start + ray.a_from_eye + renderer.world.origin();
        let (start, way) =
            (view_from_world.transform_point3(start), view_from_world.transform_vector3(ray.direction));
        let [x, y] = camera.image_of(start + way * ((point.z - start.z) / way.z))?;
        image = [image[0] + through_pinhole[0] - x, image[1] + through_pinhole[1] - y];
    }
    Some(image)
}

fn is_passed_by_camera_rays(world: &World, surface: &SurfaceInteraction) -> bool {
    surface.single_sided && !surface.front || world.is_interface(surface)
}

/// First hits of rays through a grid over the picture, behind surfaces that they pass.
fn first_hits(
    renderer: &Renderer,
    side: u32,
    is_passed: impl Fn(&SurfaceInteraction) -> bool,
) -> Vec<Option<SurfaceInteraction>> {
    let [width, height] = renderer.view().camera().size.map(f64::from);
    let middle = |cell: u32| (f64::from(cell) + 0.5) / f64::from(side);
    let mut hits = Vec::new();
    let place = |cell: u32| [width * middle(cell % side), height * middle(cell / side)];
    (0..side * side).map(|cell| first_hit(renderer, place(cell), &mut hits, &is_passed)).collect()
}

/// The first hit of the ray through a place of the image, in pixels, `y` up, behind surfaces that it passes.
fn first_hit(
    renderer: &Renderer,
    place: [f64; 2],
    hits: &mut Vec<Hit>,
    is_passed: impl Fn(&SurfaceInteraction) -> bool,
) -> Option<SurfaceInteraction> {
    let world = renderer.world();
    let ray = renderer.kernel_ray(&renderer.view().camera().ray(place, [0.5; 2]));
    world.bvh.query().all_hits(&ray, hits);
    hits.iter().map(|hit| world.surface(&ray, hit)).find(|surface| !is_passed(surface))
}

/// The index of a shape that is closed around the camera and fills the picture.
fn body_around_the_eye(
    renderer: &Renderer,
    seen: &[Option<SurfaceInteraction>],
    is_model: bool,
) -> Option<u32> {
    let (world, eye) = (renderer.world(), renderer.eye.as_vec3().to_array());
    let backs = || seen.iter().flatten().filter(|surface| !surface.front && is_opaque(world, surface));
    let shape = backs().next()?.shape;
    let is_part = |surface: &SurfaceInteraction| is_model || surface.shape == shape;
    if !is_nearly_all(backs().filter(|surface| is_part(surface)).count(), seen.len()) {
        return None;
    }

    let mut hits: Vec<Hit> = Vec::new();
    let mut is_enclosed = |cell: u32| {
        // Not through the centre of symmetric shapes.
        let place = |cell: u32| (cell as f32 + 0.37) / AROUND as f32;
        let direction = warp::octahedral_direction([place(cell % AROUND), place(cell / AROUND)]);
        let ray = Ray::new(eye, direction.to_array());
        world.bvh.query().all_hits(&ray, &mut hits);
        let surfaces = hits.iter().map(|hit| world.surface(&ray, hit));
        let crossed: Vec<SurfaceInteraction> =
            surfaces.filter(|surface| is_part(surface) && is_opaque(world, surface)).collect();
        crossed.len() % 2 == 1 && !crossed[0].front
    };
    let count = (0..AROUND * AROUND).filter(|&cell| is_enclosed(cell)).count();
    is_nearly_all(count, (AROUND * AROUND) as usize).then_some(shape)
}

fn is_nearly_all(count: usize, of: usize) -> bool {
    count as f64 >= NEARLY_ALL * of as f64
}

/// Whether a surface is opaque and does not emit light.
fn is_opaque(world: &World, surface: &SurfaceInteraction) -> bool {
    surface.alpha.is_none()
        && surface.light.is_none()
        && !surface.single_sided
        && match &world.materials[surface.material as usize].kind {
            MaterialKind::Whitted(whitted) => whitted.transmission.is_gray(0.0),
            MaterialKind::Principled(look) => look.transmission.is(0.0) && look.diffuse_transmission.is(0.0),
            MaterialKind::OpenPbr(look) => look.transmission_weight.is(0.0) && look.subsurface_weight.is(0.0),
            MaterialKind::Disney(look) => look.is_opaque,
            MaterialKind::Diffuse { .. }
            | MaterialKind::Conductor { .. }
            | MaterialKind::CoatedDiffuse { .. }
            | MaterialKind::CoatedConductor { .. }
            | MaterialKind::Plastic(_)
            | MaterialKind::Measured(_)
            | MaterialKind::Subsurface(_) => true,
            // A sky on a dome is unlit.
            MaterialKind::Unlit { .. }
            | MaterialKind::Hair(_)
            | MaterialKind::DiffuseTransmission { .. }
            | MaterialKind::Dielectric { .. }
            | MaterialKind::TintedDielectric { .. }
            | MaterialKind::ThinDielectric { .. }
            | MaterialKind::Mix { .. }
            | MaterialKind::ShadowCatcher { .. }
            | MaterialKind::Interface => false,
        }
}

/// Whether a light is visible from the camera and not at its position.
fn is_lit_from_within(renderer: &Renderer) -> bool {
    let (world, origin) = (renderer.world(), renderer.eye);
    let eye = LightSampleContext { point: origin, n: Vec3::Z, time: 0.0 };
    (0..).zip(&world.lights).any(|(index, light)| {
        if matches!(light, Light::Distant { .. } | Light::Environment(_)) {
            return false;
        }
        let sample =
            light.sample(&world.textures, &eye, [0.5; 2], &SpectralMode::Rgb, IncompletePdf::Forbidden);
        let Some(sample) = sample else { return false };
        match sample.target {
            Target::Point(place) => {
                let way = (place - origin).as_vec3().to_array();
                place != origin
                    && !world.bvh.occluded(&Ray::new(origin.as_vec3().to_array(), way).with_t_max(1.0))
            }
            Target::Surface(..) => {
                let ray = Ray::new(origin.as_vec3().to_array(), sample.wi.to_array());
                let hit = world.bvh.closest_hit(&ray);
                hit.is_hit() && world.surface(&ray, &hit).light == Some(index)
            }
            Target::Infinity => false,
        }
    })
}
