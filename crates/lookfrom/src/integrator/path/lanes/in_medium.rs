//! Scattering in media: the step of path tracing at a vertex that is no surface.
//!
//! Vertices wait for others, as those of surfaces do, and are scattered side by side; `lanes::medium` computes the numbers.

use glam::Vec3;
use lookfrom_bvh::{OriginPrimitive, Ray};

use super::kernel::Scattered;
use crate::core::lanes::row;
use crate::core::spectrum::Spectrum;
use crate::integrator::path::{Departure, Path, PathTracer, PreviousVertex, StepOutput};
use crate::integrator::wavefront::Boundary;
use crate::integrator::{Event, PhaseSample, Probe, SampleStream, Shadow};
use crate::shading::bsdf::phase::Phase;

/// A path at a point of a medium that scatters it.
pub(in crate::integrator::path) struct MediumVertex {
    /// With the throughput there.
    pub(in crate::integrator::path) path: Path,
    /// In render space.
    pub(in crate::integrator::path) point: Vec3,
    pub(in crate::integrator::path) phase: Phase,
    pub(in crate::integrator::path) stream: SampleStream,
}

impl PathTracer {
    /// Whether a path is scattered at a point of a medium: unless it has bounced as often as it may.
    pub(in crate::integrator::path) fn is_scattered_in_medium(&self, vertex: &MediumVertex) -> bool {
        vertex.path.depth < self.depth && !vertex.path.beta.is_black()
    }

    /// The shadow ray and the further path of a lane.
    pub(super) fn leave_medium_vertex<P: Probe>(
        &self,
        vertex: &MediumVertex,
        lane: usize,
        scattered: &Scattered,
        output: &mut StepOutput<'_, P>,
    ) {
        let path = &vertex.path;
        if scattered.has_density & 1 << lane != 0
            && let Some((light, ray, contribution)) = self.connection(path.address, lane, scattered, output)
        {
            let last_scattering = output.last_scattering_in_medium(path);
            let (origin_primitive, boundary) = (OriginPrimitive::NONE, Boundary::None);
            let departure = Departure { path, origin_primitive, boundary };
            let shadow = departure.shadow(ray, (light, contribution), path.interior, last_scattering);
            let panes = self.panes_before_light(path, &scattered.lights, lane);
            output.queues.shadows.push(Shadow { panes, ..shadow });
        }

        let wi = Vec3::from_array(row(&scattered.wi, lane));
        let (pdf, survival) = (scattered.pdf[lane], scattered.survival[lane]);
        let survives = scattered.survives & 1 << lane != 0;
        output.probe.notice(|| Event::ScatteredInMedium {
            address: path.address,
            sample: PhaseSample {
                phase: vertex.phase,
                is_draine: scattered.is_draine & 1 << lane != 0,
                wi,
                pdf,
                beta: path.beta,
                survival,
                survives,
            },
        });
        if !survives {
            return;
        }
        let light_path = output.scattered_in_medium(path);
        output.paths.push(Path {
            ray: Ray::new(vertex.point.to_array(), wi.to_array()),
            beta: Spectrum(row(&scattered.next_beta, lane)),
            depth: path.depth + 1,
            address: path.address + 1,
            origin_primitive: OriginPrimitive::NONE,
            blurred: true,
            light_path,
            state: PreviousVertex {
                pdf,
                point: vertex.point,
                n: Vec3::ZERO,
                is_catcher: false,
                ..path.state
            },
            ..*path
        });
    }
}
