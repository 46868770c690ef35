//! Direct lighting of Whitted's model: one shadow ray to each light.

mod arriving;
mod branches;
mod coefficients;
mod lanes;
mod plain;
mod surfaces;
mod waiting;

use glam::DVec3;
use lookfrom_bvh::Hit;

use crate::integrator::{Event, Integrator, Path, Probe, SampleStream, Shadow, StepOutput, Term};
use crate::light::{IncompletePdf, LightSampleContext};
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::material::Coefficients;
use crate::world::World;

pub(super) use branches::same_side;
pub(super) use lanes::PlainBranch;
use lanes::PlainSteps;
use waiting::Waiting;

/// Number of paths whose plain hits are shaded before their results are used: enough for groups of eight of one material,
/// few enough for the cache.
const TOGETHER: usize = 512;

/// [`Integrator::step`] for all paths of a batch, in their order; plain hits are shaded eight side by side, and `grow` is
/// called with the branches there. A probe that listens is told of each step by itself.
pub(super) fn step_all<I: Integrator, P: Probe>(
    integrator: &I,
    world: &World,
    stream: impl Fn(&Path) -> SampleStream,
    paths: &[Path],
    hits: &[Hit],
    output: &mut StepOutput<'_, P>,
    grow: impl Fn(&Path, &PlainBranch, &mut Vec<Path>),
) {
    let in_lanes = !P::LISTENS && output.light_paths.is_none() && PlainSteps::are_for(world);
    let (mut steps, mut waiting) = (PlainSteps::default(), Waiting::default());
    for (paths, hits) in paths.chunks(TOGETHER).zip(hits.chunks(TOGETHER)) {
        steps.clear(paths.len());
        if in_lanes {
            steps.compute(world, &stream, (paths, hits), &output.queues.lanes, &mut waiting);
        }
        for ((path, hit), plain) in paths.iter().zip(hits).zip(steps.of_each()) {
            let Some(plain) = plain else {
                output.probe.notice(|| Event::Hit { path: *path, hit: *hit });
                integrator.step(world, &stream(path), path, hit, output);
                continue;
            };
            plain.add_light(world, path, hit, output);
            plain.for_each_branch(|branch| grow(path, &branch, &mut output.queues.paths));
        }
    }
}

/// Adds the surface's emission and `k_a I_a`, and from every light `k_d (N·L) I_j + k_s (N·H)ⁿ I_j`.
pub(super) fn local_light<P: Probe>(
    world: &World,
    stream: &SampleStream,
    path: &Path,
    surface: &SurfaceInteraction,
    output: &mut StepOutput<'_, P>,
) -> Coefficients {
    let lanes = output.lanes(path);
    let material = &world.materials[surface.material as usize].whitted;
    let coefficients = Coefficients::at(material, &world.textures, &world.texture_point(surface), &lanes);
    output.probe.notice(|| Event::Surface {
        address: path.address,
        surface: Box::new(*surface),
        coefficients: Some(Box::new(coefficients)),
    });
    let emits = world.emitted(surface, &lanes) + world.unlit(surface, &lanes).unwrap_or_default();
    output.add(path, Term::Emission, path.beta * emits);
    output.add(path, Term::Ambient, path.beta * coefficients.ambient * world.ambient(&lanes));
    if !coefficients.is_lit() {
        return coefficients;
    }
    let n = surface.ns_facing();
    let ng = surface.ng_facing();
    for (index, light) in world.lights.iter().enumerate() {
        let index = index as u32;
        let at = LightSampleContext { point: DVec3::from_array(surface.point.position), n };
        let is_random = light.illuminates() && !light.is_delta();
        let u = if is_random { stream.two(index) } else { [0.0; 2] };
        let sample = light.sample(&world.textures, &at, u, &lanes, IncompletePdf::Forbidden);
        // Light from behind the surface does not reach its front, whatever the interpolated normal says.
        let sample = sample.filter(|sample| ng.dot(sample.wi) > 0.0);
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
