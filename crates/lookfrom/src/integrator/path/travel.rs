//! The way of a path to what it has hit: a medium may absorb its light, add light of its own, or scatter it before.

use glam::Vec3;
use lookfrom_bvh::Hit;

use super::flight::Flight;
use super::lanes::MediumVertex;
use super::tracking::Tracking;
use super::{Path, PathTracer, StepOutput, dimension};
use crate::core::spectrum::Spectrum;
use crate::integrator::{Event, Probe, SampleStream, Term};
use crate::medium::{Medium, Way};
use crate::world::World;

/// The end of a path's way.
pub(super) enum Traveled {
    /// At the hit, or in the sky.
    Arrived(Path),
    /// A point of a medium before, which scatters it.
    Scattered(MediumVertex),
}

impl PathTracer {
    /// Brings a path to the end of its way: with the throughput there, and with the light that a medium emits on the whole of it.
    pub(super) fn travel<P: Probe>(
        &self,
        world: &World,
        stream: &SampleStream,
        (path, hit): (&Path, &Hit),
        output: &mut StepOutput<'_, P>,
    ) -> Traveled {
        // A body must end somewhere: where a ray in it hits nothing, it is in none.
        let is_in_medium = !path.interior.is_empty() && (hit.is_hit() || path.interior.space().is_some());
        let medium = match is_in_medium && !path.beta.is_black() {
            true => world.medium(path.interior),
            false => None,
        };
        match medium {
            Some(medium) if medium.varying.is_some() => {
                self.track(world, stream, (path, medium), &path.way_to(hit), output)
            }
            Some(medium) if medium.scattering.is_some() || medium.emission.is_some() => {
                self.fly(world, stream, (path, hit), (medium, &path.way_to(hit)), output)
            }
            _ => Traveled::Arrived(output.absorbed(world, path, hit)),
        }
    }

    /// Travels in a homogeneous medium that scatters or emits.
    fn fly<P: Probe>(
        &self,
        world: &World,
        stream: &SampleStream,
        (path, hit): (&Path, &Hit),
        (medium, way): (&Medium, &Way),
        output: &mut StepOutput<'_, P>,
    ) -> Traveled {
        let coefficients = medium.coefficients(&world.textures, &output.mode(path));
        if medium.emission.is_some() {
            self.add_emission_of_medium(path, path.beta * coefficients.emitted(way.length), output);
        }
        if medium.scattering.is_none() {
            return Traveled::Arrived(output.absorbed(world, path, hit));
        }
        let flight = Flight::sample(&coefficients, path.beta, way.length, stream.two(dimension::FLIGHT));
        let point = flight.is_scattered().then(|| way.origin + way.direction * flight.distance);
        output.probe.notice(|| Event::Flown { address: path.address, flight: Box::new(flight), point });
        let path = Path { beta: flight.after, ..*path };
        end(medium, path, stream, point)
    }

    /// Travels in a medium that varies.
    fn track<P: Probe>(
        &self,
        world: &World,
        stream: &SampleStream,
        (path, medium): (&Path, &Medium),
        way: &Way,
        output: &mut StepOutput<'_, P>,
    ) -> Traveled {
        let mode = output.mode(path);
        let tracking =
            Tracking::sample(medium, (&world.textures, &mode), (way, path.beta), stream, P::LISTENS);
        if medium.emission.is_some() {
            self.add_emission_of_medium(path, tracking.emitted, output);
        }
        let point = tracking.scattered_at.map(|distance| way.origin + way.direction * distance);
        let path = Path { beta: tracking.after, ..*path };
        output.probe.notice(|| Event::Tracked { address: path.address, tracking: Box::new(tracking), point });
        end(medium, path, stream, point)
    }

    /// Adds what a medium emits on the way of a path. Where no path goes on, that is left out, as in pbrt.
    fn add_emission_of_medium<P: Probe>(&self, path: &Path, light: Spectrum, output: &mut StepOutput<'_, P>) {
        if path.depth < self.depth {
            output.add(path, Term::Medium, light);
        }
    }
}

/// The end of a way: at the point where the medium scatters the path, if there is one.
fn end(medium: &Medium, path: Path, stream: &SampleStream, point: Option<Vec3>) -> Traveled {
    match (point, medium.phase()) {
        (Some(point), Some(phase)) => {
            Traveled::Scattered(MediumVertex { path, point, phase, stream: *stream })
        }
        _ => Traveled::Arrived(path),
    }
}
