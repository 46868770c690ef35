//! Subsurface scattering in path tracing: a path that enters a medium in which light diffuses leaves it at another point.
//!
//! That point is a random one of those where a probing line meets the same material, chosen by the light that leaves there; what happens
//! between is the BSSRDF's profile over the density of the point. There the path is scattered by another BSDF; both together are one
//! bounce, as in pbrt-v4.

use glam::{DVec3, Vec3};
use lookfrom_bvh::{Hit, OriginPrimitive, Ray};

use super::{Path, PreviousVertex, StepOutput, Vertex, dimension};
use crate::core::spectrum::Spectrum;
use crate::integrator::{Event, Probe, SampleStream};
use crate::shading::bsdf::Bsdf;
use crate::shading::bsdf::subsurface::Subsurface;
use crate::shading::bssrdf::probe::{ProbeSegment, Prober};
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::material::{MaterialKind, Shading};
use crate::world::World;

/// A search for the point where light leaves that has entered a medium below a surface.
#[derive(Clone, Copy, Debug)]
pub struct SubsurfaceProbe {
    /// The throughput of the path that has entered.
    pub before: Spectrum,
    /// P: the probability of each lane.
    pub choice: Spectrum,
    /// The line that was searched; `None` where no light leaves as near as points are looked for.
    pub segment: Option<ProbeSegment>,
    /// Number of its intersections with the material.
    pub count: u32,
    /// One of these points; `None` where no light leaves at any of them.
    pub exit: Option<SubsurfaceExit>,
}

/// A point where light leaves a medium below a surface.
#[derive(Clone, Copy, Debug)]
pub struct SubsurfaceExit {
    /// In render space.
    pub point: DVec3,
    /// S_p: the part of the light that leaves there, per area.
    pub sp: Spectrum,
    /// The density q of the point, per area, without the choice among several.
    pub pdf: f32,
    /// The probability Q of that choice.
    pub probability: f32,
    /// The throughput there: β S_p / (q Q).
    pub after: Spectrum,
}

/// A point where a probing line meets the material, and light leaves.
struct Crossing {
    /// The part of the line since the point before.
    ray: Ray,
    origin_primitive: OriginPrimitive,
    hit: Hit,
    surface: SurfaceInteraction,
    sp: Spectrum,
    pdf: f32,
    /// The sum of the lanes of the throughput there: its weight in the choice among several points.
    weight: f32,
}

/// The points where a line meets the material.
#[derive(Default)]
struct Crossings {
    count: u32,
    /// The sum of their weights.
    weight: f32,
    /// One of them, by weight.
    chosen: Option<Crossing>,
}

/// The vertex where a path leaves that has entered at another one, through the boundary of a medium; `None` if none is found.
pub(super) fn exit_below<P: Probe>(
    world: &World,
    (vertex, boundary): (&Vertex, &Subsurface),
    entered: &Path,
    output: &mut StepOutput<'_, P>,
) -> Option<Vertex> {
    let MaterialKind::Subsurface(below) = &world.materials[boundary.material as usize].kind else {
        return None;
    };
    let place = (DVec3::from_array(vertex.surface.point.position), vertex.shading.axes().map(Vec3::from));
    let prober = Prober::new(&below.profiles, &boundary.medium, place, entered.beta)?;
    let stream = &vertex.stream;
    let segment = prober.segment(stream.two(dimension::PROBE_AXIS), stream.two_with_pixel(dimension::PROBE));
    let crossings = segment.as_ref().map_or_else(Crossings::default, |segment| {
        let at = (vertex.surface.material, output.time(entered));
        Crossings::find(world, at, (&prober, segment), entered.beta, stream.two(dimension::EXIT))
    });
    let exit = crossings.chosen.as_ref().map(|&Crossing { ref surface, sp, pdf, weight, .. }| {
        let probability = weight / crossings.weight;
        let after = entered.beta * sp / (pdf * probability);
        SubsurfaceExit { point: surface.point.position.into(), sp, pdf, probability, after }
    });
    output.probe.notice(|| Event::Probed {
        address: vertex.path.address,
        probe: Box::new(SubsurfaceProbe {
            before: entered.beta,
            choice: prober.choice,
            segment,
            count: crossings.count,
            exit,
        }),
    });

    // The path as if it had come along the line, with the media around it that it had before it entered.
    let Crossing { ray, origin_primitive, hit, surface, .. } = crossings.chosen?;
    let path = Path {
        ray,
        beta: exit?.after,
        address: entered.address,
        origin_primitive,
        blurred: true,
        state: PreviousVertex { pdf: f32::INFINITY, is_catcher: false, ..vertex.path.state },
        ..vertex.path
    };
    output.probe.notice(|| Event::Hit { path, hit });
    let surface = SurfaceInteraction { wo: surface.ns, front: true, ..surface };
    let shading = Shading::plain(&surface, Bsdf::NormalizedFresnel(boundary.exit));
    output.probe.notice(|| Event::Shaded {
        address: path.address,
        surface: Box::new(surface),
        shading: Box::new(shading),
        beta: path.beta,
    });
    let stream = SampleStream { address: path.address, ..*stream };
    Some(Vertex { path, surface, shading, stream, is_catcher: false })
}

impl Crossings {
    /// Follows a line through a material at a time, for a throughput; by two numbers in [0, 1): for the choice, and for alpha tests.
    fn find(
        world: &World,
        (material, time): (u32, f32),
        (prober, segment): (&Prober<'_>, &ProbeSegment),
        beta: Spectrum,
        [mut which, presence]: [f32; 2],
    ) -> Self {
        let direction = segment.direction;
        let mut ray = Ray::new(segment.start.to_array(), direction.to_array()).with_t_max(segment.length);
        let mut origin_primitive = OriginPrimitive::NONE;
        let mut crossings = Self::default();
        loop {
            let hit = world.bvh.query().origin(origin_primitive).time(time).closest_hit(&ray);
            if !hit.is_hit() {
                return crossings;
            }
            let surface = world.surface_at(&ray, &hit, time);
            if surface.material == material && world.passes_alpha_test(&surface, presence) {
                let point = surface.point.position.into();
                let (sp, pdf) = (prober.sp(point), prober.pdf(point, surface.ng.as_vec3()));
                let weight = if pdf > 0.0 { (beta * sp / pdf).0.iter().sum() } else { 0.0 };
                let crossing = Crossing { ray, origin_primitive, hit, surface, sp, pdf, weight };
                crossings.add(crossing, &mut which);
            }
            ray = Ray::new(surface.origin(direction), direction.to_array()).with_t_max(ray.t_max - hit.t);
            origin_primitive = surface.origin_primitive;
        }
    }

    /// Adds a point, which is kept with a probability by its weight (weighted reservoir sampling), by a number in [0, 1) that
    /// serves again.
    fn add(&mut self, crossing: Crossing, which: &mut f32) {
        self.count += 1;
        if !(crossing.weight > 0.0) {
            return;
        }
        self.weight += crossing.weight;
        let probability = crossing.weight / self.weight;
        if *which < probability {
            *which /= probability;
            self.chosen = Some(crossing);
        } else {
            *which = (*which - probability) / (1.0 - probability);
        }
    }
}
