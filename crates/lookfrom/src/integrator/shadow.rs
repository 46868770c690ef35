//! Shadow rays: visibility between a surface and a light.
//!
//! In a scene without transparent surfaces visibility is binary. With them (and `transparent_shadows`) a shadow ray
//! goes straight on through transparent surfaces, coloured by `k_t` and by absorption on the way; refraction is
//! ignored, as in most renderers of this kind since Whitted's.

mod lanes;
mod media;
mod panes;
mod passing;
mod queue;

use lookfrom_bvh::{Hit, NONE, OriginPrimitive, Point, Ray};

use crate::core::points::Points;
use crate::core::spectrum::Spectrum;
use crate::core::times::Times;
use crate::integrator::{Event, Path, PathState, Probe, Queues, StepOutput, Term};
use crate::light::{LightSample, Target};
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::interior_stack::InteriorStack;
use crate::shading::material::MaterialKind;
use crate::world::World;

use media::Transmittances;
use passing::let_through;
pub(super) use queue::ShadowLight;
pub use queue::Shadows;

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
    /// The number of panes that it may pass, by [`ShadowTransparency::Panes`].
    pub panes: u32,
}

impl Shadow {
    /// No number of [`Shadow::last_scattering`].
    pub const NO_SCATTERING: u32 = u32::MAX;
}

impl<P: Probe, S: PathState> StepOutput<'_, P, S> {
    /// Casts a shadow ray from a surface that `path` has met toward the sample of a light: unless it is blocked, `contribution`
    /// is added to the path's sample, attenuated by the medium and by what the ray passes
    /// ([`Integrator::shadow_transparency`](crate::integrator::Integrator::shadow_transparency)). For light-path expressions
    /// the surface counts as diffuse.
    pub fn cast_shadow(
        &mut self,
        world: &World,
        path: &Path<S>,
        surface: &SurfaceInteraction,
        (light, sample): (u32, &LightSample),
        contribution: Spectrum,
    ) {
        let wi = sample.wi;
        let origin = surface.origin(wi);
        let ray = match sample.target {
            Target::Infinity => Ray::new(origin, wi.to_array()),
            Target::Point(position) => toward(origin, position.to_array()),
            Target::Surface(Point { position, error }, normal) => {
                let points = Points::<f32> { position: position.into(), error: error.into() };
                let way = points.just_before(normal.into(), wi.into(), origin.into());
                Ray { t_max: 1.0, ..Ray::new(origin, way.into()) }
            }
        };
        let crosses = surface.crosses(wi);
        let all = self.mode(path).one();
        let last_scattering = self.last_scattering(path, crosses, || all);
        self.queues.shadows.push(Shadow {
            ray,
            origin_primitive: surface.origin_primitive,
            contribution,
            slot: path.slot,
            address: path.address,
            term: Term::Light(light),
            interior: path.interior.leaving(&world.materials, surface, wi, crosses),
            last_scattering,
            panes: 0,
        });
    }
}

/// The ray from `origin` to `target`, which is at t = 1.
pub(super) fn toward(origin: [f32; 3], target: [f64; 3]) -> Ray {
    let direction = std::array::from_fn(|k| (target[k] - f64::from(origin[k])) as f32);
    Ray { t_max: 1.0, ..Ray::new(origin, direction) }
}

/// The length of a shadow ray behind a surface at `t`, where it was `t_max` from its origin before. It is a little less than the
/// difference: that and the new origin are rounded, and a light must not block its own ray. (In Whitted's model it is the difference.)
#[inline(always)]
fn rest(t_max: f32, t: f32) -> f32 {
    const PART: f32 = 1.0 / 65536.0;
    const OF_WHOLE: f32 = 1.0 / 2_097_152.0;
    ((t_max - t) * (1.0 - PART) - t * OF_WHOLE).max(0.0)
}

/// The surfaces that let shadow rays pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ShadowTransparency {
    /// Only surfaces that fail the alpha test, and interfaces of media.
    AlphaTested,
    /// Thin dielectrics as well, straight on (path tracing).
    Panes,
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
        let binding = world.primitives[hit.geometry as usize].binding(hit.primitive as usize);
        let material = &world.materials[binding.material as usize];
        let stops_light = match self {
            Self::AlphaTested => true,
            Self::Panes => !material.is_pane(),
            Self::Transparent => material.whitted.transmission.is_gray(0.0),
        };
        binding.alpha.is_none()
            && !(world.has_open_fronts && binding.single_sided)
            && !matches!(material.kind, MaterialKind::Interface)
            && stops_light
    }

    /// Whether any surface of a world may let shadow rays pass.
    fn lets_any_pass(self, world: &World) -> bool {
        world.has_gaps()
            || match self {
                Self::AlphaTested => false,
                Self::Panes => world.has_panes,
                Self::Transparent => world.transmissive,
            }
    }
}

/// Traces all shadow rays of a batch and adds their contributions, in their order. Returns the number of rays traced.
pub(crate) fn resolve<P: Probe, S: PathState>(
    world: &World,
    shadow_transparency: ShadowTransparency,
    output: &mut StepOutput<'_, P, S>,
) -> u64 {
    let mut queues = std::mem::take(&mut output.queues);
    let traced = if shadow_transparency.lets_any_pass(world) {
        let_through(world, (shadow_transparency, output.light_paths), &mut queues, output.probe)
    } else {
        block(world, &mut queues, output.probe)
    };
    output.queues = queues;
    let mut shadows = std::mem::take(&mut output.queues.shadows);
    for light in &shadows.lights {
        output.add_unoccluded(light);
    }
    shadows.clear();
    output.queues.last_scatterings.clear();
    output.queues.shadows = shadows;
    traced
}

/// Traces shadow rays that any hit blocks completely.
fn block<P: Probe>(world: &World, queues: &mut Queues, probe: &mut P) -> u64 {
    let Queues { shadows, modes, times, blocked, .. } = queues;
    let Shadows { rays, origin_primitives, lights } = shadows;
    // All are replaced.
    blocked.resize(rays.len(), false);
    let mut at = Times::default();
    at.gather(times, lights.iter().map(|light| light.slot));
    world.bvh.query().origins(origin_primitives).times(at.as_slice()).occluded_many(rays, blocked);
    let through_media = Transmittances::estimate(world, modes, rays.len(), |index| {
        (!blocked[index]).then(|| (&rays[index], &lights[index], rays[index].t_max))
    });
    for (index, (light, blocked)) in lights.iter_mut().zip(&*blocked).enumerate() {
        let mode = &modes[light.slot as usize];
        let passed = match (*blocked, through_media.at(index)) {
            (true, _) => Spectrum::BLACK,
            (false, Some(transmittance)) => transmittance,
            (false, None) => light.transmittance(world, &rays[index], rays[index].t_max, mode),
        };
        // The picture needs only occlusion, a probe the closest hit.
        probe.notice(|| {
            let shadow = light.of(rays[index], origin_primitives[index]);
            let query = world.bvh.query().origin(shadow.origin_primitive).time(at.of(index));
            let hit = query.closest_hit(&shadow.ray);
            Event::Shadow { shadow, hit, passed }
        });
        light.contribution *= passed;
    }
    rays.len() as u64
}
