//! Shadow rays: does anything stand between a surface and a light?
//!
//! In a scene without transparent things the answer is yes or no. With them (and `transparent_shadows`) a shadow ray goes
//! straight on through what lets light pass, coloured by `k_t` and by absorption on the way; the bending is ignored, as in
//! most renderers of this kind since Whitted's.

use lookfrom_bvh::{Hit, Point, Ray};

use crate::integrator::{Event, Media, Next, Path, Probe, Term};
use crate::light::{LightSample, Target};
use crate::material::Coefficients;
use crate::spectrum::Spectrum;
use crate::surface::Surface;
use crate::world::World;

/// How many transparent surfaces a shadow ray may cross before it counts as blocked.
const MOST_CROSSINGS: u32 = 32;

/// A ray to a light, and the light that it brings if nothing stands in its way.
#[derive(Clone, Copy, Debug)]
pub struct Shadow {
    /// From the surface; `t = 1` is the light, unless that is infinitely far.
    pub ray: Ray,
    /// What is added to the sample if the light is reached.
    pub contribution: Spectrum,
    /// The path whose hit asked for it.
    pub path: Path,
    /// Which light.
    pub light: u32,
    /// What it travels in.
    pub media: Media,
}

impl Shadow {
    pub(super) fn new(
        path: &Path,
        surface: &Surface,
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
                // most 2⁻²⁴ of its length a component, here with a reserve of two.
                let length: f64 =
                    (0..3).map(|k| (point.position[k] - f64::from(origin[k])).abs()).fold(0.0, f64::max);
                let slack = length * f64::from(f32::EPSILON);
                let guarded =
                    Point { position: point.position, error: point.error.map(|error| error + slack) };
                let back = sample.wi.to_array().map(|x| -f64::from(x));
                toward(origin, guarded.origin(normal.to_array(), back).map(f64::from))
            }
        };
        Self { ray, contribution, path: *path, light, media: path.media }
    }
}

/// From `origin` to `target` at t = 1.
fn toward(origin: [f32; 3], target: [f64; 3]) -> Ray {
    let direction = std::array::from_fn(|k| (target[k] - f64::from(origin[k])) as f32);
    Ray { t_max: 1.0, ..Ray::new(origin, direction) }
}

/// Traces all shadow rays of a batch and adds what arrives, in their order. Gives the number of rays traced.
pub(crate) fn resolve<P: Probe>(world: &World, transparent: bool, next: &mut Next<'_, P>) -> u64 {
    let mut shadows = std::mem::take(&mut next.shadows);
    let traced = if transparent && world.transmissive {
        let_through(world, &mut shadows, next.probe)
    } else {
        block(world, &mut shadows, next.probe)
    };
    for shadow in shadows.drain(..) {
        next.add(&shadow.path, Term::Light(shadow.light), shadow.contribution);
    }
    next.shadows = shadows;
    traced
}

/// Whatever stands in the way takes all.
fn block<P: Probe>(world: &World, shadows: &mut [Shadow], probe: &mut P) -> u64 {
    let rays: Vec<Ray> = shadows.iter().map(|shadow| shadow.ray).collect();
    let mut blocked = vec![false; rays.len()];
    world.bvh.occluded_many(&rays, &mut blocked);
    for (shadow, blocked) in shadows.iter_mut().zip(blocked) {
        let passed = if blocked { Spectrum::BLACK } else { Spectrum::ONE };
        // That something is in the way is enough for the picture; who listens wants to know what.
        probe.notice(|| Event::Shadow { shadow: *shadow, hit: world.bvh.closest_hit(&shadow.ray), passed });
        shadow.contribution *= passed;
    }
    rays.len() as u64
}

/// What lets light through takes its part; the ray goes on behind it.
fn let_through<P: Probe>(world: &World, shadows: &mut [Shadow], probe: &mut P) -> u64 {
    let mut traced = 0;
    let mut active: Vec<usize> = (0..shadows.len()).collect();
    for crossings in 0.. {
        let rays: Vec<Ray> = active.iter().map(|&index| shadows[index].ray).collect();
        let mut hits = vec![Hit::MISS; rays.len()];
        world.bvh.closest_hits(&rays, &mut hits);
        traced += rays.len() as u64;
        let mut hits = hits.into_iter();
        active.retain(|&index| {
            let hit = hits.next().unwrap_or(Hit::MISS);
            let shadow = &mut shadows[index];
            let surface = hit.is_hit().then(|| world.surface(&shadow.ray, &hit));
            let passed = shadow.passed(world, &hit, surface.as_ref(), crossings);
            probe.notice(|| Event::Shadow { shadow: *shadow, hit, passed });
            shadow.contribution *= passed;
            match surface {
                Some(surface) if !shadow.contribution.is_black() => {
                    shadow.go_on_behind(&hit, &surface);
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
    /// The part of the light that comes through to where the ray met `surface` and through it.
    fn passed(&self, world: &World, hit: &Hit, surface: Option<&Surface>, crossings: u32) -> Spectrum {
        let length = glam::Vec3::from_array(self.ray.direction).length() * hit.t.min(self.ray.t_max);
        let Some(surface) = surface else {
            // Nothing but the medium; one that fills infinite space lets all through.
            return if length.is_finite() { self.media.transmittance(world, length) } else { Spectrum::ONE };
        };
        if crossings == MOST_CROSSINGS {
            return Spectrum::BLACK;
        }
        let material = &world.materials[surface.material as usize];
        let coefficients = Coefficients::at(material, &world.textures, &world.texture_point(surface));
        coefficients.transmission * self.media.transmittance(world, length)
    }

    /// Starts again behind a surface that lets light pass.
    fn go_on_behind(&mut self, hit: &Hit, surface: &Surface) {
        let direction = glam::Vec3::from_array(self.ray.direction);
        self.ray.origin = surface.origin(direction);
        self.ray.t_max -= hit.t;
        self.media = if surface.front { self.media.entered(surface.material) } else { self.media.left() };
    }
}
