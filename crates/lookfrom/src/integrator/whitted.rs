//! Recursive ray tracing (Whitted 1980): at each hit shadow rays, one reflected and one refracted ray, and so on. The
//! colour of a pixel is the sum over that tree of rays.
//!
//! *Adaptive depth control* (Hall & Greenberg 1983): a branch whose throughput is below a limit is not
//! followed.

use glam::Vec3;
use lookfrom_bvh::{Hit, Ray};

use crate::core::spectrum::Spectrum;
use crate::integrator::direct::{self, PlainBranch, local_light, same_side};
use crate::integrator::{
    BatchStreams, Branch, Cut, Event, Integrator, Path, Probe, SampleStream, ShadowTransparency, StepOutput,
};
use crate::shading::bsdf::lobes::Lobes;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::interior_stack::InteriorStack;
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

    fn step_all<P: Probe>(
        &self,
        world: &World,
        streams: &BatchStreams<'_>,
        paths: &[Path],
        hits: &[Hit],
        output: &mut StepOutput<'_, P>,
    ) {
        direct::step_all(self, world, streams, paths, hits, output, |path, branch, paths| {
            if self.cut(path, branch.beta).is_none() {
                paths.push(self.grown(world, path, branch));
            }
        });
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
        let path = &output.absorbed(world, path, hit);

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
                direction,
                weight,
                fresnel: branches.fresnel,
                total_reflection: branches.total_reflection,
                cut: child.err(),
            });
            if let Ok(child) = child {
                let lobe = Lobes::sampled(true, false, branch == Branch::Refracted);
                let light_path = output.scattered(path, lobe);
                output.queues.paths.push(Path { light_path, ..child });
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
        if let Some(cut) = self.cut(path, beta) {
            return Err(cut);
        }
        let crosses = branch == Branch::Refracted;
        let side = if crosses { -1.0 } else { 1.0 };
        let direction: Vec3 = same_side(direction.into(), surface.ng_facing().into(), side).into();
        let ray = Ray::new(surface.origin(direction), direction.to_array());
        let interior = path.interior.leaving(&world.materials, surface, direction, crosses);
        Ok(path.branched(branch, ray, beta, interior))
    }

    /// The path that goes on from a plain surface.
    #[inline(always)]
    fn grown(&self, world: &World, path: &Path, plain: &PlainBranch) -> Path {
        let PlainBranch { branch, beta, ray, material, front } = *plain;
        let crosses = branch == Branch::Refracted && world.materials[material as usize].is_body();
        let interior = match (crosses, front) {
            (true, true) => path.interior.entered(material),
            (true, false) => path.interior.left(material),
            (false, _) => path.interior,
        };
        path.branched(branch, ray, beta, interior)
    }

    /// The reason why a path does not go on with this throughput.
    #[inline]
    fn cut(&self, path: &Path, beta: Spectrum) -> Option<Cut> {
        if beta.max_lane() < self.min_contribution || beta.is_black() {
            Some(Cut::Contribution)
        } else if path.depth >= self.depth || path.address >= 1 << DEEPEST {
            Some(Cut::Depth)
        } else {
            None
        }
    }
}

impl Path {
    /// Its child in the tree of rays.
    #[inline(always)]
    fn branched(&self, branch: Branch, ray: Ray, beta: Spectrum, interior: InteriorStack) -> Self {
        let last_bit = u64::from(branch == Branch::Refracted);
        Self { ray, beta, depth: self.depth + 1, address: self.address << 1 | last_bit, interior, ..*self }
    }
}
