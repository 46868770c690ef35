//! Recursive ray tracing (Whitted 1980): at each hit shadow rays, one reflected and one refracted ray, and so on. The
//! colour of a pixel is the sum over that tree of rays. Without the tree it is ray casting (Appel 1968): the nearest surface, local
//! shading, a shadow ray to each light, no recursion.
//!
//! *Adaptive depth control* (Hall & Greenberg 1983): a branch whose throughput is below a limit is not
//! followed.

mod coefficients;
mod emit;
mod first_surfaces;
mod shaded;
mod step;
mod told;

use lookfrom_bvh::{Hit, OriginPrimitive};

use crate::core::lanes::are_shaded_together;
use crate::core::spectrum::Spectrum;
use crate::integrator::wavefront::{Bins, Boundary, Departure, Eight, HitBatch, Rounds};
use crate::integrator::{
    BatchStreams, Cut, Integrator, Path, Probe, Queues, SampleStream, ShadowTransparency, StepOutput,
};
use crate::shading::bsdf::whitted::WhittedCoefficients;
use crate::shading::material::albedo_of_coefficients;
use crate::shading::texture::SpectralMode;
use crate::world::{ShapeClass, World};
use emit::PathHit;
use shaded::Shaded;
use step::{BareEight, BareKernel, Wanted, shade_one};

/// The depth of the deepest tree that [`Path::address`] can number.
const DEEPEST: u32 = 62;

/// Recursive ray tracing, or ray casting.
#[derive(Clone, Copy, Debug)]
pub struct Whitted {
    /// The tree of rays; `None` for ray casting.
    pub tree: Option<RayTree>,
    /// Whether shadow rays pass transparent materials, coloured by them.
    pub transparent_shadows: bool,
}

/// The limits of the tree of rays: the depth, and the least throughput (adaptive depth control).
#[derive(Clone, Copy, Debug)]
pub struct RayTree {
    /// Maximum number of reflections and refractions along a ray; no ray goes on after 62 surfaces.
    pub depth: u32,
    /// Branches with a smaller throughput are not followed.
    pub min_contribution: f32,
}

impl RayTree {
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

impl Integrator for Whitted {
    type State = ();

    fn name(&self) -> &'static str {
        match self.tree {
            Some(_) => "whitted",
            None => "raycast",
        }
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
        step_all(self.tree.as_ref(), &HitBatch { world, streams, paths, hits }, output);
    }

    fn step<P: Probe>(
        &self,
        world: &World,
        stream: &SampleStream,
        path: &Path,
        hit: &Hit,
        output: &mut StepOutput<'_, P>,
    ) {
        step(self.tree.as_ref(), world, stream, (path, hit), &mut Shaded::default(), output);
    }
}

/// Memory that is reused from batch to batch.
#[derive(Debug, Default)]
struct Memory {
    rounds: Rounds,
    bins: Bins,
    shaded: Shaded,
}

/// [`Integrator::step_all`] of Whitted ray tracing, or without a tree of ray casting.
fn step_all<P: Probe>(tree: Option<&RayTree>, batch: &HitBatch<'_>, output: &mut StepOutput<'_, P>) {
    let HitBatch { world, streams, paths, hits } = *batch;
    let in_lanes = are_shaded_together();
    let even_sky = output.queues.modes.of_all().and_then(|mode| world.even_sky(mode));
    let mut memory = output.queues.scratch.take::<Memory>();
    let Memory { rounds, bins, shaded } = &mut *memory;
    rounds.divide(paths, output.queues.radiance.len());
    for round in 0..rounds.count() {
        for &index in rounds.paths(round) {
            let (path, hit) = (&paths[index as usize], &hits[index as usize]);
            output.notice_hit(path, hit);
            if !hit.is_hit() {
                output.add_surroundings_behind_medium(world, path, even_sky);
            } else if let Some(bare) = world.bare_surface(hit).filter(|_| in_lanes) {
                let kind = ShapeClass::ALL.len() * bare.material as usize + bare.shape as usize;
                bins.push(kind, index, bare.material, |eight| {
                    shade_bare_hits(tree, batch, (eight, bare.shape), shaded, output);
                });
            } else {
                step(tree, world, &streams.of(path), (path, hit), shaded, output);
            }
        }
        for shape in ShapeClass::ALL {
            bins.flush(Bins::EACH_THIRD << shape as usize, |eight| {
                shade_bare_hits(tree, batch, (eight, shape), shaded, output);
            });
        }
    }
    output.queues.scratch.put(memory);
}

/// The step of up to eight paths that met bare surfaces of one kind of shape.
#[inline(never)]
fn shade_bare_hits<P: Probe>(
    tree: Option<&RayTree>,
    batch: &HitBatch<'_>,
    (eight, shape): (&Eight<'_>, ShapeClass),
    shaded: &mut Shaded,
    output: &mut StepOutput<'_, P>,
) {
    let (world, count) = (batch.world, eight.paths.len());
    let eight = &BareEight::of(batch, eight, shape);
    let wanted = wanted(tree, output);
    let Queues { modes, times, first_surfaces, .. } = &mut output.queues;
    let mut target = eight.aov_target(world, count, first_surfaces);
    let first = target.as_deref_mut();
    BareKernel { world, eight, streams: batch.streams, modes, times, wanted, shaded, first }.shade();
    if let Some(target) = target {
        eight.set_other_albedos(world, modes, target);
        first_surfaces.leave_block();
    }
    let departure = |lane: usize| {
        let front = shaded.front & 1 << lane != 0;
        let boundary = Boundary::Bare { material: eight.materials[lane], interface: None, front };
        let origin_primitive = OriginPrimitive::of(eight.bare.hits[lane]);
        Departure { path: eight.paths[lane], origin_primitive, boundary }
    };
    for lane in 0..count {
        let (path, hit) = (eight.paths[lane], eight.bare.hits[lane]);
        let absorbed;
        let path = match P::LISTENS {
            true => {
                absorbed = output.absorbed(world, path, hit);
                &absorbed
            }
            false => path,
        };
        let departure = Departure { path, ..departure(lane) };
        shaded.add_own_light(world, (&PathHit { departure, hit }, lane), output);
    }
    shaded.go_on(world, ((1 << count) - 1, departure), tree, output);
}

/// The step of one path, whatever it has hit.
fn step<P: Probe>(
    tree: Option<&RayTree>,
    world: &World,
    stream: &SampleStream,
    (path, hit): (&Path, &Hit),
    shaded: &mut Shaded,
    output: &mut StepOutput<'_, P>,
) {
    // A ray that leaves the scene sees the sky.
    if !hit.is_hit() {
        return output.add_surroundings_behind_medium(world, path, None);
    }

    // Absorb on the way.
    let path = &output.absorbed(world, path, hit);
    let surface = &world.surface_at(&path.ray, hit, output.time(path));

    // Pass surfaces that fail the alpha test: in a tree an only child, straight on.
    if path.goes_through(world, surface, stream.presence(world, surface)) {
        let passed = path.passed(surface);
        match tree {
            None => output.paths.push(passed),
            Some(_) if path.address < 1 << DEEPEST => {
                output.paths.push(Path { address: path.address << 1 | 1, ..passed });
            }
            Some(_) => {}
        }
        return;
    }

    // Shade what is seen: I_a and every light, and the branches of the tree.
    let (mode, material) = (output.mode(path), &world.materials[surface.material as usize]);
    let coefficients =
        WhittedCoefficients::at(&material.whitted, &world.textures, &world.shading_point(surface), &mode);
    output.leave_first_surface(world, path, surface, || {
        let WhittedCoefficients { diffuse, mirror, transmission, .. } = coefficients;
        let is_known = matches!(mode, SpectralMode::Rgb) && material.has_albedo_of_coefficients();
        is_known.then(|| albedo_of_coefficients([diffuse, mirror, transmission]))
    });
    let wanted = wanted(tree, output);
    shade_one(world, (path, stream), (&mode, output.time(path)), surface, &coefficients, wanted, shaded);
    let (origin_primitive, boundary) = (OriginPrimitive::of(hit), Boundary::Surface(surface));
    let departure = Departure { path, origin_primitive, boundary };
    shaded.add_own_light(world, (&PathHit { departure, hit }, 0), output);
    shaded.go_on(world, (1, |_| departure), tree, output);
}

fn wanted<'a, P: Probe>(tree: Option<&'a RayTree>, output: &StepOutput<'_, P>) -> Wanted<'a> {
    Wanted { tree, shares: output.light_paths.is_some(), is_watched: P::LISTENS }
}
