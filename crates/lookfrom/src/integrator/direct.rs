//! Direct lighting of Whitted's model: one shadow ray to each light.

mod arriving;
mod branches;
mod coefficients;
mod first_surfaces;
mod groups;
mod lanes;
mod plain;
mod steps;
mod surfaces;
mod waiting;

use glam::DVec3;
use lookfrom_bvh::Hit;

use crate::core::lanes::are_shaded_together;
use crate::integrator::{
    BatchStreams, Event, Integrator, Path, Probe, SampleStream, Shadow, StepOutput, Term,
};
use crate::light::{IncompletePdf, LightSampleContext};
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::material::{Coefficients, albedo_of_coefficients};
use crate::shading::texture::SpectralMode;
use crate::world::World;

pub(super) use branches::same_side;
pub(super) use plain::PlainHits;
pub(super) use steps::{PlainBranch, PlainSteps};
pub(super) use surfaces::SurfacePoints;

/// Number of paths whose plain hits are shaded before their results are used: enough for groups of eight of one material,
/// few enough for the cache.
const TOGETHER: usize = 512;

/// [`Integrator::step`] for all paths of a batch. Plain hits are shaded eight side by side, and `grow` is called with the
/// branches there.
pub(super) fn step_all<I: Integrator, P: Probe>(
    integrator: &I,
    world: &World,
    streams: &BatchStreams<'_>,
    paths: &[Path],
    hits: &[Hit],
    output: &mut StepOutput<'_, P>,
    grow: impl Fn(&Path, &PlainBranch, &mut Vec<Path>),
) {
    let in_lanes =
        !P::LISTENS && output.light_paths.is_none() && PlainSteps::are_for(world) && are_shaded_together();
    let mut steps = std::mem::take(&mut output.queues.plain_steps);
    // Of samples with several paths, light is added in the order of the paths. Others need no results but those at hand.
    let in_any_order = in_lanes && steps.are_of_different_samples(paths);
    let use_step =
        |steps: &PlainSteps, path: &Path, hit: &Hit, index: usize, output: &mut StepOutput<'_, P>| {
            let Some(plain) = steps.of(index) else { return };
            plain.add_light(world, path, hit, output);
            plain.for_each_branch(|branch| grow(path, &branch, &mut output.queues.paths));
        };
    let even_sky = output.queues.modes.of_all().and_then(|mode| world.even_sky(mode));
    let together = if in_any_order { paths.len() } else { TOGETHER };
    for (paths, hits) in paths.chunks(together).zip(hits.chunks(together)) {
        steps.clear(paths.len());
        if in_lanes {
            steps.compute(world, streams, (paths, hits), output, |steps, indices, output| {
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
            } else if in_lanes && !hit.is_hit() {
                output.add_surroundings_behind_medium(world, path, even_sky);
            } else {
                output.probe.notice(|| Event::Hit { path: *path, hit: *hit });
                integrator.step(world, &streams.of(path), path, hit, output);
            }
        }
    }
    output.queues.plain_steps = steps;
}

/// Adds the surface's emission and `k_a I_a`, and from every light `k_d (N·L) I_j + k_s (N·H)ⁿ I_j`.
pub(super) fn local_light<P: Probe>(
    world: &World,
    stream: &SampleStream,
    path: &Path,
    surface: &SurfaceInteraction,
    output: &mut StepOutput<'_, P>,
) -> Coefficients {
    let mode = output.mode(path);
    let material = &world.materials[surface.material as usize].whitted;
    let coefficients = Coefficients::at(material, &world.textures, &world.texture_point(surface), &mode);
    output.probe.notice(|| Event::Surface {
        address: path.address,
        surface: Box::new(*surface),
        coefficients: Some(Box::new(coefficients)),
    });
    output.leave_first_surface(world, path, surface, || {
        let Coefficients { diffuse, mirror, transmission, .. } = coefficients;
        let is_known = matches!(mode, SpectralMode::Rgb)
            && world.materials[surface.material as usize].has_albedo_of_coefficients();
        is_known.then(|| albedo_of_coefficients([diffuse, mirror, transmission]))
    });
    let emits = world.emitted(surface, &mode) + world.unlit(surface, &mode).unwrap_or_default();
    output.add(path, Term::Emission, path.beta * emits);
    output.add(path, Term::Ambient, path.beta * coefficients.ambient * world.ambient(&mode));
    if !coefficients.is_lit() {
        return coefficients;
    }
    let n = surface.ns_facing();
    for (index, light) in world.lights.iter().enumerate() {
        let index = index as u32;
        let at = LightSampleContext { point: DVec3::from_array(surface.point.position), n };
        let is_random = light.illuminates() && !light.is_delta();
        let u = if is_random { stream.two_with_pixel(index) } else { [0.0; 2] };
        let sample = light.sample(&world.textures, &at, u, &mode, IncompletePdf::Forbidden);
        // Light from behind the surface does not reach its front, whatever the interpolated normal says.
        let sample = sample.filter(|sample| !surface.crosses(sample.wi));
        let (diffuse, specular) =
            sample.map(|sample| coefficients.lit(n, surface.wo, sample.wi)).unwrap_or_default();
        output.probe.notice(|| Event::LocalLight {
            address: path.address,
            light: index,
            sample,
            diffuse,
            specular,
        });
        let Some(sample) = sample else { continue };
        // I_j of the notes is radiance over π: see `light`.
        let arriving = sample.li / (std::f32::consts::PI * sample.pdf);
        let contribution = path.beta * (diffuse + specular) * arriving;
        if !contribution.is_black() {
            let last_scattering =
                output.last_scattering(path, false, || diffuse.share_of(diffuse + specular));
            let shadow = Shadow::new(world, path, surface, &sample, index, contribution);
            output.queues.shadows.push(Shadow { last_scattering, ..shadow });
        }
    }
    coefficients
}
