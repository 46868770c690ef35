//! Scattering in media: the step of path tracing at a vertex that is no surface.
//!
//! A light is sampled and the path goes on as at surfaces, with the phase function in the place of BSDF and cosine. Since that is
//! its own density, the throughput stays.

use glam::Vec3;
use lookfrom_bvh::{OriginPrimitive, Ray};

use super::dimension;
use super::{Departure, LightSampling, Path, PathTracer, PreviousVertex, SAFE_BOUNCES, SURVIVAL, StepOutput};
use crate::core::math::power_heuristic;
use crate::integrator::shadow::ray_to;
use crate::integrator::wavefront::Boundary;
use crate::integrator::{Event, PhaseSample, Probe, SampleStream};
use crate::light::{IncompletePdf, LightSample, LightSampleContext};
use crate::shading::bsdf::henyey_greenstein::HenyeyGreenstein;
use crate::world::World;

/// A path at a point of a medium that scatters it.
pub(super) struct MediumVertex {
    /// With the throughput there.
    pub(super) path: Path,
    /// In render space.
    pub(super) point: Vec3,
    pub(super) phase: HenyeyGreenstein,
}

impl MediumVertex {
    /// Against the direction in which the path has come.
    fn wo(&self) -> Vec3 {
        -Vec3::from_array(self.path.ray.direction).normalize()
    }

    fn departure(&self) -> Departure<'_> {
        let (path, origin_primitive) = (&self.path, OriginPrimitive::NONE);
        Departure { path, origin_primitive, boundary: Boundary::None }
    }
}

impl PathTracer {
    /// Scatters a path in a medium, unless it has bounced as often as it may.
    pub(super) fn scatter_in_medium<P: Probe>(
        &self,
        world: &World,
        stream: &SampleStream,
        vertex: &MediumVertex,
        output: &mut StepOutput<'_, P>,
    ) {
        let MediumVertex { ref path, point, phase } = *vertex;
        if path.depth >= self.depth || path.beta.is_black() {
            return;
        }
        if self.light_sampling != LightSampling::None {
            self.sample_light_in_medium(world, stream, vertex, output);
        }

        let wo = vertex.wo();
        let wi: Vec3 = phase.sample(wo.into(), stream.two_with_pixel(dimension::DIRECTION)).into();
        let pdf = phase.p(wo.into(), wi.into());
        let survival = self.survival_in_medium(path);
        let survives = survival >= 1.0 || stream.two(dimension::ROULETTE)[0] < survival;
        let (address, beta) = (path.address, path.beta);
        output.probe.notice(|| Event::ScatteredInMedium {
            address,
            sample: PhaseSample { wi, pdf, beta, survival, survives },
        });
        if !survives {
            return;
        }
        let light_path = output.scattered_in_medium(path);
        output.paths.push(Path {
            ray: Ray::new(point.to_array(), wi.to_array()),
            beta: beta / survival,
            depth: path.depth + 1,
            address: address + 1,
            origin_primitive: OriginPrimitive::NONE,
            blurred: true,
            light_path,
            state: PreviousVertex { pdf, point, n: Vec3::ZERO, is_catcher: false, ..path.state },
            ..*path
        });
    }

    /// The probability of surviving Russian roulette: that at surfaces.
    fn survival_in_medium(&self, path: &Path) -> f32 {
        if self.light_sampling != LightSampling::MultipleImportance || path.depth < SAFE_BOUNCES {
            return 1.0;
        }
        (path.beta.max_lane() * path.state.eta_scale * SURVIVAL).min(1.0)
    }

    /// Samples one light, and casts a shadow ray to it.
    fn sample_light_in_medium<P: Probe>(
        &self,
        world: &World,
        stream: &SampleStream,
        vertex: &MediumVertex,
        output: &mut StepOutput<'_, P>,
    ) {
        let MediumVertex { ref path, point, phase } = *vertex;
        let (address, mode) = (path.address, output.mode(path));
        let at = LightSampleContext { point: point.as_dvec3(), n: Vec3::ZERO };
        let [which, v] = stream.two_with_pixel(dimension::LIGHT);
        let Some(chosen) = world.light_choice.sample(&at, which) else { return };
        let (index, probability) = (chosen.light, chosen.probability);
        let light = &world.lights[index as usize];
        let sample = light.sample(&world.textures, &at, [chosen.rest, v], &mode, IncompletePdf::Allowed);
        let Some(sample @ LightSample { wi, li, pdf, .. }) = sample else {
            output.probe.notice(|| Event::LightSampleFailed {
                address,
                light: index,
                probability,
                sample: None,
            });
            return;
        };
        let p = phase.p(vertex.wo().into(), wi.into());
        let light_pdf = probability * pdf;
        let is_alone = light.is_delta() || self.light_sampling != LightSampling::MultipleImportance;
        let (phase_pdf, weight) = match is_alone {
            true => (0.0, 1.0),
            false => (p, power_heuristic(light_pdf, p)),
        };
        let f = mode.one() * p;
        output.probe.notice(|| Event::LightSampled {
            address,
            light: index,
            probability,
            sample,
            f,
            bsdf_pdf: phase_pdf,
            weight,
        });
        let contribution = path.beta * f * li * (weight / light_pdf);
        if contribution.is_black() {
            return;
        }
        let last_scattering = output.last_scattering_in_medium(path);
        let ray = ray_to(point.to_array(), &sample);
        let shadow = vertex.departure().shadow(ray, (index, contribution), path.interior, last_scattering);
        output.queues.shadows.push(shadow);
    }
}
