//! First hits of camera rays, recorded once for AOVs and denoiser.
//!
//! No probe is needed, so that rendering is not slowed down: first hits are recorded as they are traced, and evaluated
//! after the batch, unless a step had the surface at hand. Where a ray passes a surface as if it were not there, the hit
//! behind it counts; but where chance decides that, by an alpha between 0 and 1, all surfaces along the ray count by what
//! they cover, so that features have no noise that light does not have.

use glam::{DMat4, DVec3, Vec3};
use lookfrom_bvh::{Hit, Ray};

use super::{Batch, Renderer, SampleId};
use crate::film::{Aovs, FilmTile};
use crate::integrator::{FirstSurface, Path};

/// The first hit of a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct FirstHit {
    /// The hit of the camera's ray, which may have gone on behind it.
    outermost: RayHit,
    /// The hit that it has not passed.
    seen: RayHit,
}

#[derive(Clone, Copy, Debug)]
struct RayHit {
    ray: Ray,
    hit: Hit,
}

impl FirstHit {
    pub(super) const MISS: Self = Self { outermost: RayHit::MISS, seen: RayHit::MISS };
}

impl RayHit {
    const MISS: Self =
        Self { ray: Ray { origin: [0.0; 3], t_min: 0.0, direction: [0.0; 3], t_max: 0.0 }, hit: Hit::MISS };
}

/// Number of surfaces of fractional alpha that are looked through.
const MOST_LAYERS: usize = 16;

/// What is left of a pixel behind surfaces that cover nearly all of it is not looked at.
const LEAST_PART: f32 = 1.0 / 256.0;

/// Records the hits of the paths that come straight from the camera, by slot, if `first_hits` is not empty.
pub(super) fn note(first_hits: &mut [FirstHit], paths: &[Path], hits: &[Hit]) {
    if first_hits.is_empty() {
        return;
    }
    for (path, hit) in paths.iter().zip(hits) {
        if path.depth == 0 {
            let first = &mut first_hits[path.slot as usize];
            first.seen = RayHit { ray: path.ray, hit: *hit };
            if !first.outermost.hit.is_hit() {
                first.outermost = first.seen;
            }
        }
    }
}

impl Renderer {
    /// Adds the AOVs of samples to a tile, if first hits were recorded.
    pub(super) fn add_first_hits(&self, ids: &[SampleId], batch: &Batch, tile: &mut FilmTile) {
        if batch.first_hits.is_empty() {
            return;
        }
        let view_from_world = self.view.camera.world_from_view().inverse();
        let first_hits = batch.first_hits.iter().zip(&batch.queues.first_surfaces);
        for (id, (first, surface)) in ids.iter().zip(first_hits) {
            let [x, y] = id.pixel;
            let aovs = match surface {
                Some(surface) => Some(self.aovs(surface, &view_from_world)),
                None => self.aovs_of_hit(first, &view_from_world),
            };
            tile.add_first_hit(x, y, id.sample, aovs.as_ref());
        }
    }

    /// The AOVs of a first hit; `None` for a miss.
    fn aovs_of_hit(&self, first: &FirstHit, view_from_world: &DMat4) -> Option<Aovs> {
        let blended = match self.world.has_gaps {
            true => self.blended_aovs(first, view_from_world),
            false => None,
        };
        blended.or_else(|| {
            let RayHit { ray, hit } = first.seen;
            let surface = || FirstSurface::of(&self.world, &self.world.surface(&ray, &hit));
            hit.is_hit().then(|| self.aovs(&surface(), view_from_world))
        })
    }

    /// The mean albedo and shading normal of all surfaces along a camera ray by what each covers, and the place of the one
    /// that covers most; `None` where none has an alpha between 0 and 1. What nothing covers is white, as a miss is.
    fn blended_aovs(&self, first: &FirstHit, view_from_world: &DMat4) -> Option<Aovs> {
        let world = &self.world;
        let RayHit { mut ray, mut hit } = first.outermost;
        let (mut left, mut is_blended) = (1.0, false);
        let (mut albedo, mut ns) = (Vec3::ZERO, Vec3::ZERO);
        let mut most: Option<(f32, Aovs)> = None;
        for _ in 0..MOST_LAYERS {
            if !hit.is_hit() {
                break;
            }
            let surface = world.surface(&ray, &hit);
            let opacity = world.opacity(&surface);
            is_blended |= opacity > 0.0 && opacity < 1.0;
            if opacity > 0.0 {
                let aovs = self.aovs(&FirstSurface::of(world, &surface), view_from_world);
                let part = left * opacity;
                albedo += part * Vec3::from(aovs.albedo);
                ns += part * Vec3::from(aovs.ns);
                if most.is_none_or(|(greatest, _)| part > greatest) {
                    most = Some((part, aovs));
                }
            }
            left *= 1.0 - opacity;
            if left < LEAST_PART {
                break;
            }
            ray = Ray::new(surface.origin(Vec3::from(ray.direction)), ray.direction);
            hit = world.bvh.query().origin(surface.origin_primitive).closest_hit(&ray);
        }
        let (_, aovs) = most.filter(|_| is_blended)?;
        Some(Aovs { albedo: (albedo + left).to_array(), ns: ns.normalize_or_zero().to_array(), ..aovs })
    }

    fn aovs(&self, surface: &FirstSurface, view_from_world: &DMat4) -> Aovs {
        let FirstSurface { position, ng, ns, wo, uv, albedo } = *surface;
        // The view space of the notes (u, v, w) has x to the left, that of AOVs to the right.
        let mirrored = |v: DVec3| [-v.x as f32, v.y as f32, v.z as f32];
        let toward_viewer = |n: Vec3| {
            let n = if n.dot(wo) < 0.0 { -n } else { n };
            Vec3::from(mirrored(view_from_world.transform_vector3(n.as_dvec3())))
                .normalize_or_zero()
                .to_array()
        };
        Aovs {
            albedo,
            ng: toward_viewer(ng),
            ns: toward_viewer(ns),
            position: mirrored(view_from_world.transform_point3(self.world.origin + position)),
            uv: uv.to_array(),
        }
    }
}
