//! Shadow rays that surfaces may attenuate.

use glam::Vec3;
use lookfrom_bvh::{Hit, OriginPrimitive, Ray};

use super::lanes::Crossings;
use super::media::Transmittances;
use super::{ShadowLight, ShadowTransparency, Shadows, rest};
use crate::core::hash;
use crate::core::spectrum::Spectrum;
use crate::core::times::Times;
use crate::integrator::wavefront::{Behind, InterfaceKind, Interfaces};
use crate::integrator::{Event, LightPaths, Probe, Queues};
use crate::shading::bsdf::whitted::WhittedCoefficients;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// Maximum number of transparent surfaces that a shadow ray may cross before it counts as blocked.
const MOST_CROSSINGS: u32 = 32;

/// Traces shadow rays that surfaces may attenuate; each ray goes on behind the surface. Returns the number of rays
/// traced.
pub(super) fn let_through<P: Probe>(
    world: &World,
    (shadow_transparency, light_paths): (ShadowTransparency, Option<&LightPaths>),
    queues: &mut Queues,
    probe: &mut P,
) -> u64 {
    let Queues { shadows, modes, times, hits, last_scatterings, .. } = queues;
    let Shadows { rays, origin_primitives, lights } = shadows;
    let mut traced = 0;
    let mut at = Times::default();
    // The lights of the rays that are left.
    let mut left: Vec<u32> = (0..lights.len() as u32).collect();
    let mut crossings = Crossings::new(P::LISTENS);
    let mut interfaces = Interfaces::default();
    // Rays that cross surfaces side by side, for a probe: as they arrive.
    let mut crossing = Vec::new();
    for round in 0.. {
        hits.clear();
        hits.resize(rays.len(), Hit::MISS);
        at.gather(times, left.iter().map(|&light| lights[light as usize].slot));
        world.bvh.query().origins(origin_primitives).times(at.as_slice()).closest_hits(rays, hits);
        traced += rays.len() as u64;

        let is_blocked = |hit: &Hit| {
            hit.is_hit() && (round >= MOST_CROSSINGS || shadow_transparency.is_blocked(world, hit))
        };
        let through_media = Transmittances::estimate(world, modes, rays.len(), |place| {
            let (ray, hit) = (&rays[place], &hits[place]);
            let t = if hit.is_hit() { hit.t } else { ray.t_max };
            (!is_blocked(hit)).then(|| (ray, &lights[left[place] as usize], t))
        });

        // Those that go on keep their order.
        let mut count = 0;
        for place in 0..rays.len() {
            let (mut ray, mut origin_primitive, hit) = (rays[place], origin_primitives[place], hits[place]);
            let light = &mut lights[left[place] as usize];
            let is_blocked = is_blocked(&hit);
            let is_bare = !is_blocked && shadow_transparency == ShadowTransparency::Transparent;
            if is_bare && crossings.take(world, count as u32, &hit) {
                if P::LISTENS {
                    crossing.push((count, light.of(ray, origin_primitive)));
                }
                origin_primitive = OriginPrimitive::of(&hit);
            } else {
                let arrival = Arrival {
                    ray,
                    origin_primitive,
                    hit,
                    is_blocked,
                    mode: &modes[light.slot as usize],
                    time: at.of(place),
                    through_medium: through_media.at(place),
                };
                let Some(onward) = light.pass(world, shadow_transparency, &arrival, probe) else { continue };
                if onward.is_behind_pane {
                    light.leave_pane(light_paths, last_scatterings);
                }
                // Behind interfaces rays go on side by side.
                onward.interface.into_iter().for_each(|kind| interfaces.push(kind, count));
                (ray, origin_primitive) = (onward.ray, onward.origin_primitive);
            }
            (rays[count], origin_primitives[count], hits[count]) = (ray, origin_primitive, hit);
            left[count] = left[place];
            count += 1;
        }
        let behind = interfaces.cross(world, |place| {
            let place = place as usize;
            (&rays[place], &hits[place], lights[left[place] as usize].interior)
        });
        for Behind { place, origin, interior } in behind {
            rays[place as usize].origin = origin;
            lights[left[place as usize] as usize].interior = interior;
        }
        let are_all_lit = crossings.go_on(world, modes, (rays, hits), lights, &left);
        for (place, shadow) in crossing.drain(..) {
            let passed = crossings.passed.as_ref().map_or(Spectrum::BLACK, |passed| passed[place]);
            probe.notice(|| Event::Shadow { shadow, hit: hits[place], passed });
        }
        if !are_all_lit {
            let end = count;
            count = 0;
            for place in 0..end {
                if !lights[left[place] as usize].contribution.is_black() {
                    (rays[count], origin_primitives[count]) = (rays[place], origin_primitives[place]);
                    left[count] = left[place];
                    count += 1;
                }
            }
        }
        rays.truncate(count);
        origin_primitives.truncate(count);
        left.truncate(count);
        if rays.is_empty() {
            break;
        }
    }
    traced
}

/// A shadow ray that passes surfaces alone, at the next of them or at its end.
struct Arrival<'a> {
    ray: Ray,
    origin_primitive: OriginPrimitive,
    hit: Hit,
    /// Whether no light passes the hit.
    is_blocked: bool,
    mode: &'a SpectralMode,
    time: f32,
    /// The transmittance of the medium on the way, if it is known already.
    through_medium: Option<Spectrum>,
}

/// A shadow ray behind a hit.
struct Onward {
    /// From its old origin where it has hit an interface.
    ray: Ray,
    origin_primitive: OriginPrimitive,
    /// The interface behind which it is still to be brought.
    interface: Option<InterfaceKind>,
    is_behind_pane: bool,
}

impl ShadowLight {
    /// Attenuates the light by the medium and by the surface that the ray has hit, if any. `None` where the ray ends: where it is
    /// blocked, and at the light.
    #[inline]
    fn pass<P: Probe>(
        &mut self,
        world: &World,
        shadow_transparency: ShadowTransparency,
        arrival: &Arrival<'_>,
        probe: &mut P,
    ) -> Option<Onward> {
        let &Arrival { mut ray, origin_primitive, hit, is_blocked, mode, time, through_medium } = arrival;
        let interface = Interfaces::kind(world, &hit).filter(|_| !is_blocked);
        let surface =
            (hit.is_hit() && !is_blocked && interface.is_none()).then(|| world.surface_at(&ray, &hit, time));
        let through_surface = match &surface {
            Some(surface) => self.passed(world, shadow_transparency, (&ray, &hit), surface, mode),
            None if is_blocked => Spectrum::BLACK,
            None => mode.one(),
        };
        let passed = match through_surface.is_black() {
            true => Spectrum::BLACK,
            false => {
                let t = if hit.is_hit() { hit.t } else { ray.t_max };
                through_surface * through_medium.unwrap_or_else(|| self.transmittance(world, &ray, t, mode))
            }
        };
        probe.notice(|| Event::Shadow { shadow: self.of(ray, origin_primitive), hit, passed });
        self.contribution *= passed;
        if !hit.is_hit() || self.contribution.is_black() {
            return None;
        }
        let (origin_primitive, is_behind_pane) = match &surface {
            Some(surface) => {
                let crosses = self.go_on_behind(world, &mut ray, &hit, surface);
                let is_pane = || world.materials[surface.material as usize].is_pane();
                let are_passed = shadow_transparency == ShadowTransparency::Panes;
                (surface.origin_primitive, crosses && are_passed && is_pane())
            }
            None => (OriginPrimitive::of(&hit), false),
        };
        ray.t_max = match shadow_transparency {
            ShadowTransparency::AlphaTested | ShadowTransparency::Panes => rest(ray.t_max, hit.t),
            ShadowTransparency::Transparent => ray.t_max - hit.t,
        };
        (surface.is_some() || interface.is_some()).then_some(Onward {
            ray,
            origin_primitive,
            interface,
            is_behind_pane,
        })
    }

    /// Transmittance of a surface.
    fn passed(
        &self,
        world: &World,
        shadow_transparency: ShadowTransparency,
        (ray, hit): (&Ray, &Hit),
        surface: &SurfaceInteraction,
        mode: &SpectralMode,
    ) -> Spectrum {
        if !meets(world, ray, hit, surface) || world.has_media && world.is_interface(surface) {
            return mode.one();
        }
        if world.is_open_front(surface) {
            return mode.one() * (1.0 - World::COVERAGE_OF_OPEN_FRONTS);
        }
        let material = &world.materials[surface.material as usize];
        match shadow_transparency {
            ShadowTransparency::Panes if material.is_pane() => self.passed_pane(world, surface, mode),
            ShadowTransparency::AlphaTested | ShadowTransparency::Panes => Spectrum::BLACK,
            ShadowTransparency::Transparent => {
                let point = world.texture_point(surface);
                WhittedCoefficients::at(&material.whitted, &world.textures, &point, mode).transmission
            }
        }
    }

    /// Continues the ray behind a surface that lets light pass. Returns whether it crosses the surface, which is not so where that fails
    /// the alpha test or is an open front.
    fn go_on_behind(
        &mut self,
        world: &World,
        ray: &mut Ray,
        hit: &Hit,
        surface: &SurfaceInteraction,
    ) -> bool {
        let direction = Vec3::from_array(ray.direction);
        ray.origin = surface.origin(direction);
        let crosses = !world.is_open_front(surface) && meets(world, ray, hit, surface);
        if crosses {
            self.interior = self.interior.leaving(&world.materials, surface, direction, true);
        }
        crosses
    }
}

/// Whether the surface exists where a ray hit it: the alpha test.
fn meets(world: &World, ray: &Ray, hit: &Hit, surface: &SurfaceInteraction) -> bool {
    surface.alpha.is_none() || world.passes_alpha_test(surface, number(ray, hit))
}

/// A pseudorandom number in [0, 1): a hash of a ray's direction and its hit.
fn number(ray: &Ray, hit: &Hit) -> f32 {
    let [x, y, z] = ray.direction.map(f32::to_bits);
    let of_ray = hash::pair(u64::from(x) << 32 | u64::from(y), u64::from(z));
    let of_hit = u64::from(hit.primitive) << 32 | u64::from(hit.t.to_bits());
    (hash::pair(of_ray, of_hit) >> 40) as f32 * (1.0 / 16_777_216.0)
}
