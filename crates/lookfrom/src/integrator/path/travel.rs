//! The way of a path to what it has hit: a medium may absorb its light, add light of its own, or scatter it before.

use glam::Vec3;
use lookfrom_bvh::Hit;

use super::flight::{Flight, Flying};
use super::lanes::MediumVertex;
use super::{HitBatch, Path, PathTracer, StepOutput, dimension};
use crate::core::hash;
use crate::core::spectrum::Spectrum;
use crate::integrator::{Event, Probe, SampleStream, Term};
use crate::medium::{Estimate, Medium, TrackedRay, Tracking, Way};
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// The end of a path's way.
pub(super) enum Traveled {
    /// At the hit, or in the sky.
    Arrived(Path),
    /// A point of a medium before, which scatters it.
    Scattered(MediumVertex),
}

/// The medium that acts on a path on its way to what it has hit, and its number in the world; `None` where none does more than absorb.
pub(super) fn medium_on_way<'a>(world: &'a World, path: &Path, hit: &Hit) -> Option<(u32, &'a Medium)> {
    // A body must end somewhere: where a ray in it hits nothing, it is in none.
    let is_in_medium = !path.interior.is_empty() && (hit.is_hit() || path.interior.space().is_some());
    if !is_in_medium || path.beta.is_black() {
        return None;
    }
    let number = path.interior.medium(&world.materials)?;
    let medium = world.media.get(number as usize)?;
    let acts = medium.phase.is_some() || medium.emission.is_some() || medium.varying.is_some();
    acts.then_some((number, medium))
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
        let Some((_, medium)) = medium_on_way(world, path, hit) else {
            return Traveled::Arrived(output.absorbed(world, path, hit));
        };
        let mode = output.mode(path);
        let ray = tracked_ray(world, stream, (path, hit), &mode);
        match medium.track(&world.textures, Estimate::Flight, &[ray], P::LISTENS) {
            Some(mut tracked) => {
                let tracking = tracked.pop().unwrap_or_default();
                self.tracked(world, stream, path, (medium, &ray.way), tracking, output)
            }
            None => {
                let flying = flying(world, stream, path, (medium, &ray.way), &mode);
                let flight = medium.phase.map(|_| flying.fly());
                self.flown(world, (path, hit), (medium, &ray.way), (&flying, flight), output)
            }
        }
    }

    /// Brings paths, by their indices in a batch, to the ends of their ways in one medium.
    pub(super) fn travel_together<P: Probe>(
        &self,
        batch: &HitBatch<'_>,
        (medium, indices): (&Medium, &[u32]),
        output: &mut StepOutput<'_, P>,
        mut go_on: impl FnMut(usize, Traveled, &mut StepOutput<'_, P>),
    ) {
        let HitBatch { world, paths, hits, streams } = *batch;
        let path_and_hit = |index: u32| (&paths[index as usize], &hits[index as usize]);
        if medium.varying.is_some() {
            let modes = &output.queues.modes;
            let ray = |&index: &u32| {
                let (path, hit) = path_and_hit(index);
                tracked_ray(world, &streams.of(path), (path, hit), &modes[path.slot as usize])
            };
            let rays: Vec<TrackedRay<'_>> = indices.iter().map(ray).collect();
            let tracked = medium.track(&world.textures, Estimate::Flight, &rays, P::LISTENS);
            for (&index, tracking) in indices.iter().zip(tracked.into_iter().flatten()) {
                let (path, hit) = path_and_hit(index);
                let way = path.way_to(world, hit);
                let traveled = self.tracked(world, &streams.of(path), path, (medium, &way), tracking, output);
                go_on(index as usize, traveled, output);
            }
            return;
        }
        let flying = |&index: &u32| {
            let (path, hit) = path_and_hit(index);
            let mode = &output.queues.modes[path.slot as usize];
            flying(world, &streams.of(path), path, (medium, &path.way_to(world, hit)), mode)
        };
        let flying: Vec<Flying> = indices.iter().map(flying).collect();
        let flights = medium.phase.map(|_| Flying::fly_all(&flying));
        for (place, (&index, flying)) in indices.iter().zip(&flying).enumerate() {
            let (path, hit) = path_and_hit(index);
            let flight = flights.as_ref().map(|flights| flights[place]);
            let way = path.way_to(world, hit);
            let traveled = self.flown(world, (path, hit), (medium, &way), (flying, flight), output);
            go_on(index as usize, traveled, output);
        }
    }

    /// The end of a way in a homogeneous medium that emits, or scatters: then there is a flight.
    fn flown<P: Probe>(
        &self,
        world: &World,
        (path, hit): (&Path, &Hit),
        (medium, way): (&Medium, &Way),
        (flying, flight): (&Flying, Option<Flight>),
        output: &mut StepOutput<'_, P>,
    ) -> Traveled {
        if medium.emission.is_some() {
            let emitted = path.beta * flying.coefficients.emitted(way.length);
            self.add_emission_of_medium(path, emitted, output);
        }
        let Some(flight) = flight else { return Traveled::Arrived(output.absorbed(world, path, hit)) };
        let point = flight.is_scattered().then(|| way.origin + way.direction * flight.distance);
        output.probe.notice(|| Event::Flown { address: path.address, flight: Box::new(flight), point });
        let path = Path { beta: flight.after, ..*path };
        end(world, (medium, path), &flying.stream, point, output)
    }

    /// The end of a way in a medium that varies.
    fn tracked<P: Probe>(
        &self,
        world: &World,
        stream: &SampleStream,
        path: &Path,
        (medium, way): (&Medium, &Way),
        tracking: Tracking,
        output: &mut StepOutput<'_, P>,
    ) -> Traveled {
        if medium.emission.is_some() {
            self.add_emission_of_medium(path, tracking.emitted, output);
        }
        let point = tracking.scattered_at.map(|distance| way.origin + way.direction * distance);
        let path = Path { beta: tracking.after, ..*path };
        output.probe.notice(|| Event::Tracked { address: path.address, tracking: Box::new(tracking), point });
        end(world, (medium, path), stream, point, output)
    }

    /// Adds what a medium emits on the way of a path. Where no path goes on, that is left out, as in pbrt.
    fn add_emission_of_medium<P: Probe>(&self, path: &Path, light: Spectrum, output: &mut StepOutput<'_, P>) {
        if path.depth < self.depth {
            output.add(path, Term::Medium, light);
        }
    }
}

/// The ray of a path, as far as its hit or the end of the medium, to be tracked.
fn tracked_ray<'a>(
    world: &World,
    stream: &SampleStream,
    (path, hit): (&Path, &Hit),
    mode: &'a SpectralMode,
) -> TrackedRay<'a> {
    let [u, seed] = stream.two(dimension::FLIGHT);
    let seed = hash::pair(u64::from(u.to_bits()), u64::from(seed.to_bits()));
    TrackedRay { way: path.way_to(world, hit), throughput: path.beta, u, seed, mode }
}

/// A path that is to fly through a homogeneous medium.
fn flying(
    world: &World,
    stream: &SampleStream,
    path: &Path,
    (medium, way): (&Medium, &Way),
    mode: &SpectralMode,
) -> Flying {
    let coefficients = medium.coefficients(&world.textures, mode);
    Flying { stream: *stream, coefficients, throughput: path.beta, limit: way.length }
}

/// The end of a way: at the point where the medium scatters the path, if there is one.
fn end<P: Probe>(
    world: &World,
    (medium, path): (&Medium, Path),
    stream: &SampleStream,
    point: Option<Vec3>,
    output: &mut StepOutput<'_, P>,
) -> Traveled {
    match (point, medium.phase) {
        (Some(point), Some(phase)) => {
            output.set_transmittance(world, &path, Spectrum::BLACK);
            Traveled::Scattered(MediumVertex { path, point, phase, stream: *stream })
        }
        _ => {
            output.set_transmittance(world, &path, path.beta);
            Traveled::Arrived(path)
        }
    }
}
