//! Ambient occlusion (Zhukov, Iones & Kronin 1998): the part of the sky that a white surface sees, as in pbrt-v4.

use glam::Vec3;
use lookfrom_bvh::{Hit, Ray};

use crate::core::warp;
use crate::integrator::{Integrator, Path, Probe, SampleStream, Shadow, StepOutput, Term};
use crate::shading::interior_stack::InteriorStack;
use crate::world::World;

/// Ambient occlusion.
#[derive(Clone, Copy, Debug)]
pub struct AmbientOcclusion {
    /// Whether directions are sampled by the cosine, not uniformly.
    pub cosine: bool,
    /// Surfaces farther than this do not occlude, in the scene's unit.
    pub distance: f32,
}

impl Integrator for AmbientOcclusion {
    type State = ();

    fn name(&self) -> &'static str {
        "ambient_occlusion"
    }

    fn step<P: Probe>(
        &self,
        world: &World,
        stream: &SampleStream,
        path: &Path,
        hit: &Hit,
        output: &mut StepOutput<'_, P>,
    ) {
        if !hit.is_hit() {
            output.shows_background(path);
            return;
        }
        let surface = world.surface_at(&path.ray, hit, output.time(path));
        let [presence, _] = stream.two(0);
        if path.goes_through(world, &surface, presence) || world.is_interface(&surface) {
            output.paths.push(path.passed(&surface));
            return;
        }
        output.leave_first_surface(world, path, &surface, || None);
        let n = surface.ng_facing();
        let u = stream.two_with_pixel(1);
        // The visible part of a uniform sky: the mean of visibility, weighted by the cosine over π.
        let (wi, weight) = if self.cosine {
            (warp::cosine_hemisphere(u, n), 1.0)
        } else {
            let wi = warp::uniform_sphere(u);
            let wi = if wi.dot(n) < 0.0 { -wi } else { wi };
            (wi, 2.0 * n.dot(wi))
        };
        let wi = Vec3::normalize(wi);
        let ray = Ray { t_max: self.distance, ..Ray::new(surface.origin(wi), wi.to_array()) };
        let white = world.light_of([1.0; 3], &output.mode(path));
        let contribution = path.beta * white * weight;
        output.queues.shadows.push(Shadow {
            ray,
            origin_primitive: surface.origin_primitive,
            contribution,
            slot: path.slot,
            address: path.address,
            term: Term::Unoccluded,
            // Visibility does not depend on the medium.
            interior: InteriorStack::default(),
            last_scattering: Shadow::NO_SCATTERING,
            panes: 0,
        });
    }
}
