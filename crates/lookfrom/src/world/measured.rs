//! Surfaces whose irradiance is measured: points uniform by area over all shapes of a name.
//!
//! Meshes are sampled by triangle, spheres and disks evenly; quadrics and patches by parameters that a weight corrects.

use std::f64::consts::PI;

use glam::{DVec3, Vec2, Vec3};
use lookfrom_scene::{Error, Location, Result};

use super::World;
use crate::core::distribution::Discrete;
use crate::core::warp;
use crate::primitive::{MaterialBinding, Primitives, SurfacePoint};
use crate::shading::interior_stack::InteriorStack;

/// A surface made of all shapes of a name.
#[derive(Clone, Debug)]
pub(crate) struct MeasuredSurface {
    parts: Vec<Part>,
    /// The choice of a part by its area.
    choice: Discrete,
}

/// A triangle, sphere, disk, quadric or patch.
#[derive(Clone, Copy, Debug)]
struct Part {
    /// Index into the world's primitives.
    geometry: u32,
    /// Its number among those.
    primitive: u32,
    area: f64,
}

/// A point of a surface, in render space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MeasuredPoint {
    pub(crate) surface: SurfacePoint,
    /// The even density over the area, divided by that of the point: 1 in the mean.
    pub(crate) weight: f32,
}

impl MeasuredPoint {
    /// The ray that leaves the outside of the surface in a direction chosen by `u ∈ [0, 1)²`, in proportion to the cosine to the geometric
    /// normal: its origin, beyond all rounding errors, and the direction.
    pub(crate) fn leave(&self, u: [f32; 2]) -> ([f32; 3], Vec3) {
        let SurfacePoint { point, ng, .. } = self.surface;
        let direction = warp::cosine_hemisphere(u, ng.as_vec3());
        (point.leave(ng.to_array(), direction.to_array()), direction)
    }
}

impl MeasuredSurface {
    /// A point for `u ∈ [0, 1)²`.
    pub(crate) fn sample(&self, world: &World, [u0, u1]: [f32; 2]) -> MeasuredPoint {
        let (index, _, u0) = self.choice.sample(u0);
        let Part { geometry, primitive, area } = self.parts[index];
        let (surface, weight) = match &world.primitives[geometry as usize] {
            Primitives::Mesh(mesh) => {
                let [_, beta, gamma] = warp::uniform_triangle([u0, u1]);
                (mesh.point(primitive as usize, beta, gamma), 1.0)
            }
            Primitives::Spheres(spheres) => {
                let sphere = spheres.spheres[primitive as usize];
                let outward = warp::uniform_sphere([u0, u1]).as_dvec3() * f64::from(sphere.radius);
                let near = Vec3::from_array(sphere.center).as_dvec3() + outward;
                (spheres.point(primitive as usize, near), 1.0)
            }
            Primitives::Disks(disks) => {
                let on_disk = Vec2::from_array(warp::concentric_disk([u0, u1]));
                let near = DVec3::from_array(disks.disks[primitive as usize].at(on_disk).position);
                (disks.point(primitive as usize, near), 1.0)
            }
            Primitives::Quadrics(quadrics) => {
                let quadric = &quadrics.quadrics[primitive as usize];
                let in_object = quadric.sample_in_object([u0, u1]);
                let is_left = quadrics.keeps(primitive as usize, in_object);
                let whole = if is_left { quadric.object_area() } else { 0.0 };
                let weight = whole * quadric.area_scale(in_object) / area;
                (quadric.point(in_object, quadrics.bindings[primitive as usize]), weight)
            }
            Primitives::Patches(patches) => {
                let stretch = patches.area_vector(primitive as usize, u0.into(), u1.into()).length() / area;
                (patches.point(primitive as usize, u0, u1), stretch)
            }
            // There are no such parts.
            Primitives::Curves(curves) => {
                (curves.point(primitive as usize, [0.0; 2], DVec3::ZERO, DVec3::Z), 0.0)
            }
        };
        MeasuredPoint { surface, weight: weight as f32 }
    }
}

impl World {
    /// The surface of all shapes of a name, for a camera at a place in a file.
    ///
    /// # Errors
    /// `Invalid` where there is no such surface, or none that is sampled: in an object, of curves, moving, without area.
    pub(crate) fn measured_surface(&self, name: &str, at: &Location) -> Result<MeasuredSurface> {
        let invalid = |message: String| Err(Error::invalid(at, message));
        let is_named = |binding: &MaterialBinding| {
            let label = &self.names.shapes[binding.shape as usize];
            label.at.is_none() && label.name == name
        };
        let mut parts = Vec::new();
        for (geometry, primitives) in (0..).zip(&*self.primitives) {
            let mut add = |primitive: usize, area: f64| {
                if area > 0.0 && area.is_finite() {
                    parts.push(Part { geometry, primitive: primitive as u32, area });
                }
            };
            match primitives {
                Primitives::Mesh(mesh) if is_named(&mesh.binding) => {
                    if !mesh.later.is_empty() {
                        return invalid(format!(
                            "the shape {name:?} changes its form while the shutter is open: its irradiance cannot be measured"
                        ));
                    }
                    (0..mesh.triangles.len()).for_each(|index| add(index, mesh.area(index)));
                }
                Primitives::Patches(patches) if is_named(&patches.binding) => {
                    (0..patches.patches.len()).for_each(|index| add(index, patches.area(index)));
                }
                Primitives::Curves(curves) if is_named(&curves.binding) => {
                    return invalid(format!(
                        "the shape {name:?} has curves, whose irradiance cannot be measured"
                    ));
                }
                Primitives::Spheres(spheres) => {
                    for (index, sphere) in spheres.spheres.iter().enumerate() {
                        if is_named(&spheres.bindings[spheres.binding_of[index] as usize].binding) {
                            add(index, 4.0 * PI * f64::from(sphere.radius) * f64::from(sphere.radius));
                        }
                    }
                }
                Primitives::Disks(disks) => {
                    for (index, disk) in disks.disks.iter().enumerate() {
                        if is_named(&disks.bindings[index]) {
                            add(index, PI * disk.normal().length());
                        }
                    }
                }
                Primitives::Quadrics(quadrics) => {
                    for (index, binding) in quadrics.bindings.iter().enumerate() {
                        if is_named(binding) {
                            add(index, quadrics.area(index));
                        }
                    }
                }
                Primitives::Mesh(_) | Primitives::Patches(_) | Primitives::Curves(_) => {}
            }
        }
        let whole: f64 = parts.iter().map(|part| part.area).sum();
        if !(whole > 0.0 && whole.is_finite()) {
            return invalid(format!(
                "there is no shape {name:?} with an area, in no object and at rest, to measure the irradiance of"
            ));
        }
        let areas: Vec<f32> = parts.iter().map(|part| (part.area / whole) as f32).collect();
        Ok(MeasuredSurface { choice: Discrete::new(&areas), parts })
    }

    /// The media that a surface says to be on its outside, if it separates media.
    pub(crate) fn outside_of(&self, binding: &MaterialBinding) -> Option<InteriorStack> {
        binding.medium_interface.map(|index| self.medium_interfaces[index as usize].outside)
    }
}
