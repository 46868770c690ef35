//! Direct lighting of Whitted's model: one shadow ray to each light.

use glam::DVec3;

use crate::integrator::{Event, Path, Probe, SampleStream, Shadow, StepOutput, Term};
use crate::light::{IncompletePdf, LightSampleContext};
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::material::Coefficients;
use crate::world::World;

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
        let u = stream.two(index);
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
            output.queues.shadows.push(Shadow::new(world, path, surface, &sample, index, contribution));
        }
    }
    coefficients
}
