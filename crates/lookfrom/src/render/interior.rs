//! The bodies that a point is in, found by rays: a camera may stand in water or in a drink.

use glam::{DVec3, Vec3};
use lookfrom_bvh::{Hit, Ray};

use crate::core::warp;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::interior_stack::InteriorStack;
use crate::shading::material::{Material, MaterialKind};
use crate::world::{MeasuredSurface, World};

/// Number of rays, of which more than half have to agree: models may have holes, and rays may graze edges.
const RAYS: u32 = 7;

/// The interior stack of rays from a point in render space, where `space` is outside of all bodies.
///
/// On the way of a ray from far away to the point each body is entered where its outside is met, and left at its inside.
pub(super) fn interior_at(world: &World, point: DVec3, space: InteriorStack) -> InteriorStack {
    if !world.materials.iter().any(is_transparent_body) {
        return space;
    }
    let mut hits: Vec<Hit> = Vec::new();
    let stacks: Vec<InteriorStack> = (0..RAYS)
        .map(|index| {
            // Not along the axes or diagonals of symmetric shapes.
            let u = [index as f32 / RAYS as f32 + 0.037, (index * 3 % RAYS) as f32 / RAYS as f32 + 0.059];
            let direction: Vec3 = warp::uniform_sphere(u);
            let ray = Ray::new(point.as_vec3().to_array(), direction.to_array());
            world.bvh.query().all_hits(&ray, &mut hits);
            hits.iter().rev().map(|hit| world.surface(&ray, hit)).fold(space, |stack, surface| {
                match (is_boundary(world, &surface), surface.front) {
                    (false, _) => stack,
                    (true, true) => stack.left(surface.material),
                    (true, false) => stack.entered(surface.material),
                }
            })
        })
        .collect();
    let votes = |stack: &InteriorStack| stacks.iter().filter(|other| *other == stack).count();
    stacks.iter().copied().find(|stack| 2 * votes(stack) > stacks.len()).unwrap_or(space)
}

/// The interior stack of rays that leave the outside of a surface that is measured, where `space` is outside of all bodies: that at one of
/// its points.
pub(super) fn interior_around(
    world: &World,
    surface: &MeasuredSurface,
    space: InteriorStack,
) -> InteriorStack {
    let point = surface.sample(world, [0.5; 2]);
    world.outside_of(&point.surface.binding).unwrap_or_else(|| {
        let (origin, _) = point.leave([0.5; 2]);
        interior_at(world, Vec3::from_array(origin).as_dvec3(), space)
    })
}

/// Whether a surface is that of a body that light enters, and says nothing else about the media on its sides.
fn is_boundary(world: &World, surface: &SurfaceInteraction) -> bool {
    surface.medium_interface.is_none() && is_transparent_body(&world.materials[surface.material as usize])
}

fn is_transparent_body(material: &Material) -> bool {
    let is_transparent = match &material.kind {
        MaterialKind::Whitted(whitted) => !whitted.transmission.is_gray(0.0),
        MaterialKind::Principled(look) => look.is_solid,
        MaterialKind::OpenPbr(look) => look.is_solid,
        _ => false,
    };
    is_transparent || material.medium.is_some()
}
