//! Recursive ray tracing (Whitted 1980): at each hit shadow rays, one reflected and one refracted ray, and so on. The
//! colour of a pixel is the sum over that tree of rays.
//!
//! *Adaptive depth control* (Hall & Greenberg 1983): a branch that can no longer change the pixel is not followed.

use glam::Vec3;
use lookfrom_bvh::{Hit, Ray};

use crate::core::spectrum::Spectrum;
use crate::integrator::direct::local_light;
use crate::integrator::{
    Branch, Cut, Event, Integrator, Path, Probe, SampleStream, ShadowTransparency, StepOutput,
};
use crate::shading::interaction::SurfaceInteraction;
use crate::world::World;

/// The depth of the deepest tree that [`Path::address`] can number.
const DEEPEST: u32 = 62;

/// Recursive ray tracing.
#[derive(Clone, Copy, Debug)]
pub struct Whitted {
    /// Maximum number of reflections and refractions along a ray; no ray goes on after 62 surfaces.
    pub depth: u32,
    /// Branches with a smaller throughput are not followed.
    pub min_contribution: f32,
    /// Whether shadow rays pass transparent materials, coloured by them.
    pub transparent_shadows: bool,
}

impl Integrator for Whitted {
    fn name(&self) -> &'static str {
        "whitted"
    }

    fn shadow_transparency(&self) -> ShadowTransparency {
        ShadowTransparency::of_whitted(self.transparent_shadows)
    }

    fn step<P: Probe>(
        &self,
        world: &World,
        stream: &SampleStream,
        path: &Path,
        hit: &Hit,
        output: &mut StepOutput<'_, P>,
    ) {
        // Absorb on the way.
        let path = &path.absorbed(world, hit, &output.lanes(path));

        // A ray that leaves the scene sees the sky.
        if !hit.is_hit() {
            output.add_surroundings(world, path);
            return;
        }
        let surface = world.surface(&path.ray, hit);

        // Pass surfaces that fail the alpha test: an only child, straight on.
        if path.goes_through(world, &surface, stream.presence(world, &surface)) {
            if path.address < 1 << DEEPEST {
                output.queues.paths.push(Path { address: path.address << 1 | 1, ..path.passed(&surface) });
            }
            return;
        }

        // Shade what is seen: I_a and every light.
        let coefficients = local_light(world, stream, path, &surface, output);

        // Grow the tree: k_r S and k_t T.
        let n = surface.ns_facing();
        let Some(branches) = coefficients.branches(n, surface.wo, surface.front) else { return };
        let mirrored = (Branch::Mirrored, branches.mirrored);
        let refracted = branches.refracted.map(|refracted| (Branch::Refracted, refracted));
        for (branch, (direction, weight)) in [Some(mirrored), refracted].into_iter().flatten() {
            let child = self.child(world, path, &surface, branch, direction, weight);
            output.probe.notice(|| Event::Grew {
                address: path.address,
                branch,
                weight,
                fresnel: branches.fresnel,
                total_reflection: branches.total_reflection,
                cut: child.err(),
            });
            if let Ok(child) = child {
                output.queues.paths.push(child);
            }
        }
    }
}

impl Whitted {
    /// The path that goes on from a surface, or the reason why there is none.
    fn child(
        &self,
        world: &World,
        path: &Path,
        surface: &SurfaceInteraction,
        branch: Branch,
        direction: Vec3,
        weight: Spectrum,
    ) -> Result<Path, Cut> {
        let beta = path.beta * weight;
        if beta.max_lane() < self.min_contribution || beta.is_black() {
            return Err(Cut::Contribution);
        }
        if path.depth >= self.depth || path.address >= 1 << DEEPEST {
            return Err(Cut::Depth);
        }
        let ng = surface.ng_facing();
        let (direction, last_bit) = match branch {
            Branch::Mirrored => (same_side(direction, ng, 1.0), 0),
            Branch::Refracted => (same_side(direction, ng, -1.0), 1),
        };
        let crosses = branch == Branch::Refracted;
        Ok(Path {
            ray: Ray::new(surface.origin(direction), direction.to_array()),
            beta,
            slot: path.slot,
            depth: path.depth + 1,
            address: path.address << 1 | last_bit,
            interior: path.interior.leaving(&world.materials, surface, direction, crosses),
            previous: path.previous,
        })
    }
}

/// The direction, reflected at the tangent plane if it points to the wrong side of it: an interpolated normal can send
/// a reflected ray into the surface or a refracted one out of it. `side` is 1 for the side of `ng`, −1 for the other.
fn same_side(direction: Vec3, ng: Vec3, side: f32) -> Vec3 {
    let cos = direction.dot(ng);
    if cos * side >= 0.0 { direction } else { direction - 2.0 * cos * ng }
}
