//! The way of a path to what it has hit: a medium may absorb its light, add light of its own, or scatter it before.

use glam::Vec3;
use lookfrom_bvh::Hit;

use super::flight::Flight;
use super::in_medium::MediumVertex;
use super::{Path, PathTracer, StepOutput, dimension};
use crate::integrator::{Event, Probe, SampleStream, Term};
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
        let limit = path.length_to(hit);
        // A body must end somewhere: where a ray in it hits nothing, it is in none.
        let is_in_medium = !path.interior.is_empty() && (hit.is_hit() || path.interior.space().is_some());
        let medium = match is_in_medium && !path.beta.is_black() {
            true => world.coefficients(path.interior, &output.mode(path)),
            false => None,
        };
        let Some(medium) = medium else { return Traveled::Arrived(output.absorbed(world, path, hit)) };

        // What a medium emits where no path goes on is left out, as in pbrt.
        if path.depth < self.depth {
            output.add(path, Term::Medium, path.beta * medium.emitted(limit));
        }
        let Some(phase) = medium.phase else { return Traveled::Arrived(output.absorbed(world, path, hit)) };
        let flight = Flight::sample(&medium, path.beta, limit, stream.two(dimension::FLIGHT));
        let way = Vec3::from_array(path.ray.direction).normalize() * flight.distance;
        let point = Vec3::from_array(path.ray.origin) + way;
        output.probe.notice(|| Event::Flown {
            address: path.address,
            interior: path.interior,
            flight: Box::new(flight),
            point,
        });
        let path = Path { beta: flight.after, ..*path };
        match flight.is_scattered() {
            true => Traveled::Scattered(MediumVertex { path, point, phase }),
            false => Traveled::Arrived(path),
        }
    }
}
