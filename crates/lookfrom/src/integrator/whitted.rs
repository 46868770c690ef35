//! Recursive ray tracing (Whitted 1980): at each hit shadow rays, one reflected and one refracted ray, and so on. The
//! colour of a pixel is the sum over that tree of rays.
//!
//! *Adaptive depth control* (Hall & Greenberg 1983): a branch whose throughput is below a limit is not
//! followed.

mod arriving;
mod bins;
mod coefficients;
mod first_surfaces;
mod groups;
mod plain;
mod step;
mod steps;
mod surfaces;
mod told;

use lookfrom_bvh::Hit;

use crate::core::lanes::are_shaded_together;
use crate::core::spectrum::Spectrum;
use crate::integrator::{
    BatchStreams, Cut, Event, Integrator, Path, Probe, SampleStream, ShadowTransparency, StepOutput,
};
use crate::shading::material::{Coefficients, albedo_of_coefficients};
use crate::shading::texture::SpectralMode;
use crate::world::World;
pub(super) use plain::PlainHits;
use step::Wanted;
pub(super) use steps::Steps;
use steps::Vertex;
pub(super) use surfaces::Surfaces;

/// Number of paths whose plain hits are shaded before their results are used: enough for groups of eight of one material,
/// few enough for the cache.
const TOGETHER: usize = 512;

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
        step_all(Some(self), world, streams, paths, hits, output);
    }

    fn step<P: Probe>(
        &self,
        world: &World,
        stream: &SampleStream,
        path: &Path,
        hit: &Hit,
        output: &mut StepOutput<'_, P>,
    ) {
        step(Some(self), world, stream, path, hit, &mut Steps::default(), output);
    }
}

impl Whitted {
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

/// [`Integrator::step_all`] of Whitted ray tracing, or without a `tree` of ray casting.
pub(super) fn step_all<P: Probe>(
    tree: Option<&Whitted>,
    world: &World,
    streams: &BatchStreams<'_>,
    paths: &[Path],
    hits: &[Hit],
    output: &mut StepOutput<'_, P>,
) {
    let wanted = wanted(tree, output);
    let in_lanes = are_shaded_together();
    let mut steps = output.queues.scratch.take::<Steps>();
    // Of samples with several paths, light is added in the order of the paths. Others need no results but those at hand.
    let in_any_order = in_lanes && !P::LISTENS && steps.are_of_different_samples(paths);
    let use_step = |steps: &Steps, path: &Path, hit: &Hit, index: usize, output: &mut StepOutput<'_, P>| {
        output.probe.notice(|| Event::Hit { path: *path, hit: *hit });
        let Some(shaded) = steps.of(index) else { return };
        let absorbed;
        let path = match P::LISTENS {
            true => {
                absorbed = output.absorbed(world, path, hit);
                &absorbed
            }
            false => path,
        };
        shaded.finish(world, &Vertex { path, hit, surface: None }, tree, output);
    };
    let even_sky = output.queues.modes.of_all().and_then(|mode| world.even_sky(mode));
    let together = if in_any_order { paths.len() } else { TOGETHER };
    for (paths, hits) in paths.chunks(together).zip(hits.chunks(together)) {
        steps.clear(paths.len());
        if in_lanes {
            steps.compute(world, streams, (paths, hits), wanted, output, |steps, indices, output| {
                if in_any_order {
                    for index in indices.iter().map(|&index| index as usize) {
                        use_step(steps, &paths[index], &hits[index], index, output);
                    }
                    steps.remove_groups();
                }
            });
        }
        for (index, (path, hit)) in paths.iter().zip(hits).enumerate() {
            if steps.is_plain(index) {
                if !in_any_order {
                    use_step(&steps, path, hit, index, output);
                }
                continue;
            }
            output.probe.notice(|| Event::Hit { path: *path, hit: *hit });
            match hit.is_hit() {
                true => step(tree, world, &streams.of(path), path, hit, &mut steps, output),
                false => output.add_surroundings_behind_medium(world, path, even_sky),
            }
        }
    }
    output.queues.scratch.put(steps);
}

/// The step of one path, whatever it has hit.
pub(super) fn step<P: Probe>(
    tree: Option<&Whitted>,
    world: &World,
    stream: &SampleStream,
    path: &Path,
    hit: &Hit,
    steps: &mut Steps,
    output: &mut StepOutput<'_, P>,
) {
    // A ray that leaves the scene sees the sky.
    if !hit.is_hit() {
        return output.add_surroundings_behind_medium(world, path, None);
    }

    // Absorb on the way.
    let path = &output.absorbed(world, path, hit);
    let surface = &world.surface(&path.ray, hit);

    // Pass surfaces that fail the alpha test: in a tree an only child, straight on.
    if path.goes_through(world, surface, stream.presence(world, surface)) {
        let passed = path.passed(surface);
        match tree {
            None => output.queues.paths.push(passed),
            Some(_) if path.address < 1 << DEEPEST => {
                output.queues.paths.push(Path { address: path.address << 1 | 1, ..passed });
            }
            Some(_) => {}
        }
        return;
    }

    // Shade what is seen: I_a and every light, and the branches of the tree.
    let (mode, material) = (output.mode(path), &world.materials[surface.material as usize]);
    let coefficients =
        Coefficients::at(&material.whitted, &world.textures, &world.texture_point(surface), &mode);
    output.leave_first_surface(world, path, surface, || {
        let Coefficients { diffuse, mirror, transmission, .. } = coefficients;
        let is_known = matches!(mode, SpectralMode::Rgb) && material.has_albedo_of_coefficients();
        is_known.then(|| albedo_of_coefficients([diffuse, mirror, transmission]))
    });
    let wanted = wanted(tree, output);
    steps.shade_one(world, (path, stream, &mode), surface, &coefficients, wanted, |shaded| {
        shaded.finish(world, &Vertex { path, hit, surface: Some(surface) }, tree, output);
    });
}

fn wanted<'a, P: Probe>(tree: Option<&'a Whitted>, output: &StepOutput<'_, P>) -> Wanted<'a> {
    Wanted { tree, shares: output.light_paths.is_some(), is_watched: P::LISTENS }
}
