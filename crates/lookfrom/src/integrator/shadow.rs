//! Shadow rays: visibility between a surface and a light.
//!
//! In a scene without transparent surfaces visibility is binary. With them (and `transparent_shadows`) a shadow ray
//! goes straight on through transparent surfaces, coloured by `k_t` and by absorption on the way; refraction is
//! ignored, as in most renderers of this kind since Whitted's.

use glam::Vec3;
use lookfrom_bvh::{Hit, NONE, OriginPrimitive, Point, Ray};

use crate::core::hash;
use crate::core::spectrum::Spectrum;
use crate::integrator::{Event, Path, Probe, Queues, StepOutput, Term};
use crate::light::{LightSample, Target};
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::interior_stack::InteriorStack;
use crate::shading::material::{Coefficients, Material, MaterialKind};
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// Maximum number of transparent surfaces that a shadow ray may cross before it counts as blocked.
const MOST_CROSSINGS: u32 = 32;

/// A shadow ray, and its contribution if it is unoccluded.
#[derive(Clone, Copy, Debug)]
pub struct Shadow {
    /// From the surface; `t = 1` is the light, unless that is infinitely far away.
    pub ray: Ray,
    /// The primitive that it leaves.
    pub origin_primitive: OriginPrimitive,
    /// The light that is added to the sample if the ray is unoccluded.
    pub contribution: Spectrum,
    /// Index of the sample in the batch.
    pub slot: u32,
    /// The address of the path whose hit sampled the light.
    pub address: u64,
    /// The reason why it is added.
    pub term: Term,
    /// The media that the ray is inside of.
    pub interior: InteriorStack,
    /// Index of its last scattering event in the queues; [`Shadow::NO_SCATTERING`] without light-path expressions.
    pub last_scattering: u32,
}

impl Shadow {
    /// No number of [`Shadow::last_scattering`].
    pub const NO_SCATTERING: u32 = u32::MAX;

    pub(super) fn new(
        world: &World,
        path: &Path,
        surface: &SurfaceInteraction,
        sample: &LightSample,
        light: u32,
        contribution: Spectrum,
    ) -> Self {
        let origin = surface.origin(sample.wi);
        let ray = match sample.target {
            Target::Infinity => Ray::new(origin, sample.wi.to_array()),
            Target::Point(position) => toward(origin, position.to_array()),
            Target::Surface(point, normal) => {
                // The ray must end before the light's own surface although its direction is rounded: an error of at
                // most 2⁻²⁴ of its length per component, here with a safety factor of two.
                let length: f64 =
                    (0..3).map(|k| (point.position[k] - f64::from(origin[k])).abs()).fold(0.0, f64::max);
                let slack = length * f64::from(f32::EPSILON);
                let guarded =
                    Point { position: point.position, error: point.error.map(|error| error + slack) };
                let back = sample.wi.to_array().map(|x| -f64::from(x));
                toward(origin, guarded.leave(normal.to_array(), back).map(f64::from))
            }
        };
        let Path { slot, address, interior, .. } = *path;
        // A ray through the surface continues in the medium behind it.
        let crosses = surface.crosses(sample.wi);
        let interior = interior.leaving(&world.materials, surface, sample.wi, crosses);
        let origin_primitive = surface.origin_primitive;
        Self {
            ray,
            origin_primitive,
            contribution,
            slot,
            address,
            term: Term::Light(light),
            interior,
            last_scattering: Self::NO_SCATTERING,
        }
    }
}

/// The ray from `origin` to `target`, which is at t = 1.
pub(super) fn toward(origin: [f32; 3], target: [f64; 3]) -> Ray {
    let direction = std::array::from_fn(|k| (target[k] - f64::from(origin[k])) as f32);
    Ray { t_max: 1.0, ..Ray::new(origin, direction) }
}

/// The surfaces that let shadow rays pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ShadowTransparency {
    /// Only surfaces that fail the alpha test, and interfaces of media.
    AlphaTested,
    /// Transparent materials as well, straight on, coloured by them (Whitted's model).
    Transparent,
}

impl ShadowTransparency {
    /// The transparency in Whitted's model, where `transparent_shadows` is a setting.
    pub(super) fn of_whitted(transparent_shadows: bool) -> Self {
        if transparent_shadows { Self::Transparent } else { Self::AlphaTested }
    }

    /// Whether it is plain, without the surface interaction, that a hit lets no light pass.
    #[inline]
    fn is_blocked(self, world: &World, hit: &Hit) -> bool {
        if !hit.is_hit() || hit.instance != NONE {
            return false;
        }
        let Some(binding) = world.primitives[hit.geometry as usize].binding(hit.primitive as usize) else {
            return false;
        };
        let Material { kind, whitted, .. } = &world.materials[binding.material as usize];
        binding.alpha.is_none()
            && !(world.has_open_fronts && binding.single_sided)
            && !matches!(kind, MaterialKind::Interface)
            && (self == Self::AlphaTested || whitted.transmission.is_gray(0.0))
    }
}

/// Traces all shadow rays of a batch and adds their contributions, in their order. Returns the number of rays traced.
pub(crate) fn resolve<P: Probe>(
    world: &World,
    shadow_transparency: ShadowTransparency,
    output: &mut StepOutput<'_, P>,
) -> u64 {
    let mut queues = std::mem::take(&mut output.queues);
    let anything_passes =
        world.has_gaps || shadow_transparency == ShadowTransparency::Transparent && world.transmissive;
    let traced = if anything_passes {
        let_through(world, shadow_transparency, &mut queues, output.probe)
    } else {
        block(world, &mut queues, output.probe)
    };
    output.queues = queues;
    let mut shadows = std::mem::take(&mut output.queues.shadows);
    for shadow in shadows.drain(..) {
        output.add_unoccluded(&shadow);
    }
    output.queues.last_scatterings.clear();
    output.queues.shadows = shadows;
    traced
}

/// Traces shadow rays that any hit blocks completely.
fn block<P: Probe>(world: &World, queues: &mut Queues, probe: &mut P) -> u64 {
    let Queues { shadows, lanes, rays, origin_primitives, blocked, .. } = queues;
    rays.clear();
    rays.extend(shadows.iter().map(|shadow| shadow.ray));
    origin_primitives.clear();
    origin_primitives.extend(shadows.iter().map(|shadow| shadow.origin_primitive));
    blocked.clear();
    blocked.resize(rays.len(), false);
    world.bvh.query().origins(origin_primitives).occluded_many(rays, blocked);
    for (shadow, blocked) in shadows.iter_mut().zip(&*blocked) {
        let lanes = &lanes[shadow.slot as usize];
        let passed = if *blocked { Spectrum::BLACK } else { shadow.reached(world, lanes) };
        // The picture needs only occlusion, a probe the closest hit.
        probe.notice(|| Event::Shadow { shadow: *shadow, hit: world.bvh.closest_hit(&shadow.ray), passed });
        shadow.contribution *= passed;
    }
    rays.len() as u64
}

/// Traces shadow rays that surfaces may attenuate; each ray goes on behind the surface.
fn let_through<P: Probe>(
    world: &World,
    shadow_transparency: ShadowTransparency,
    queues: &mut Queues,
    probe: &mut P,
) -> u64 {
    let Queues { shadows, lanes, rays, origin_primitives, hits, .. } = queues;
    let mut traced = 0;
    let mut active: Vec<usize> = (0..shadows.len()).collect();
    for crossings in 0.. {
        rays.clear();
        rays.extend(active.iter().map(|&index| shadows[index].ray));
        origin_primitives.clear();
        origin_primitives.extend(active.iter().map(|&index| shadows[index].origin_primitive));
        hits.clear();
        hits.resize(rays.len(), Hit::MISS);
        world.bvh.query().origins(origin_primitives).closest_hits(rays, hits);
        traced += rays.len() as u64;
        let mut hits = hits.iter();
        active.retain(|&index| {
            let hit = hits.next().copied().unwrap_or(Hit::MISS);
            let shadow = &mut shadows[index];
            let is_blocked = crossings >= MOST_CROSSINGS || shadow_transparency.is_blocked(world, &hit);
            let surface = (hit.is_hit() && !is_blocked).then(|| world.surface(&shadow.ray, &hit));
            let lanes = &lanes[shadow.slot as usize];
            let passed = match surface.as_ref() {
                Some(surface) => shadow.passed(world, shadow_transparency, &hit, surface, lanes),
                None if hit.is_hit() => Spectrum::BLACK,
                None => shadow.reached(world, lanes),
            };
            probe.notice(|| Event::Shadow { shadow: *shadow, hit, passed });
            shadow.contribution *= passed;
            match surface {
                Some(surface) if !shadow.contribution.is_black() => {
                    shadow.go_on_behind(world, &hit, &surface);
                    true
                }
                _ => false,
            }
        });
        if active.is_empty() {
            break;
        }
    }
    traced
}

impl Shadow {
    /// Transmittance of the medium on the rest of the way.
    fn reached(&self, world: &World, lanes: &SpectralMode) -> Spectrum {
        if self.interior.is_empty() {
            return lanes.one();
        }
        let length = Vec3::from_array(self.ray.direction).length() * self.ray.t_max;
        // Lights infinitely far emit light from twice the scene's radius away, as far as media are concerned, as in
        // pbrt.
        let is_far = length.is_infinite() && self.interior.space().is_some();
        world.transmittance(self.interior, if is_far { 2.0 * world.radius } else { length }, lanes)
    }

    /// Transmittance of the medium up to `surface` and of the surface.
    fn passed(
        &self,
        world: &World,
        shadow_transparency: ShadowTransparency,
        hit: &Hit,
        surface: &SurfaceInteraction,
        lanes: &SpectralMode,
    ) -> Spectrum {
        let length = Vec3::from_array(self.ray.direction).length() * hit.t;
        let through_medium = world.transmittance(self.interior, length, lanes);
        if !self.meets(world, hit, surface) || world.has_media && world.is_interface(surface) {
            return through_medium;
        }
        if world.is_open_front(surface) {
            return through_medium * (1.0 - World::COVERAGE_OF_OPEN_FRONTS);
        }
        if shadow_transparency == ShadowTransparency::AlphaTested {
            return Spectrum::BLACK;
        }
        let material = &world.materials[surface.material as usize].whitted;
        let point = world.texture_point(surface);
        Coefficients::at(material, &world.textures, &point, lanes).transmission * through_medium
    }

    /// Whether the surface exists where the ray hit it: the alpha test.
    fn meets(&self, world: &World, hit: &Hit, surface: &SurfaceInteraction) -> bool {
        surface.alpha.is_none() || world.passes_alpha_test(surface, self.number(hit))
    }

    /// A pseudorandom number in [0, 1): a hash of the ray and its hit.
    fn number(&self, hit: &Hit) -> f32 {
        let [x, y, z] = self.ray.direction.map(f32::to_bits);
        let of_ray = hash::pair(u64::from(x) << 32 | u64::from(y), u64::from(z));
        let of_hit = u64::from(hit.primitive) << 32 | u64::from(hit.t.to_bits());
        (hash::pair(of_ray, of_hit) >> 40) as f32 * (1.0 / 16_777_216.0)
    }

    /// Continues the ray behind a surface that lets light pass.
    fn go_on_behind(&mut self, world: &World, hit: &Hit, surface: &SurfaceInteraction) {
        let direction = Vec3::from_array(self.ray.direction);
        self.ray.origin = surface.origin(direction);
        self.origin_primitive = surface.origin_primitive;
        self.ray.t_max -= hit.t;
        if !world.is_open_front(surface) && self.meets(world, hit, surface) {
            self.interior = self.interior.leaving(&world.materials, surface, direction, true);
        }
    }
}
