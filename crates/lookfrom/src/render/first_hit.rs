//! First hits of camera rays, recorded once for AOVs and denoiser.
//!
//! No probe is needed, so that rendering is not slowed down: first hits are recorded as they are traced, and evaluated
//! after the batch. Where a ray passes a surface as if it were not there, the hit behind it counts.

use glam::{DMat4, DVec3, Vec3};
use lookfrom_bvh::{Hit, Ray};

use super::{Renderer, SampleId};
use crate::film::{Aovs, FilmTile};
use crate::integrator::Path;
use crate::shading::material;

/// The first hit of a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct FirstHit {
    ray: Ray,
    hit: Hit,
}

impl FirstHit {
    pub(super) const MISS: Self =
        Self { ray: Ray { origin: [0.0; 3], t_min: 0.0, direction: [0.0; 3], t_max: 0.0 }, hit: Hit::MISS };
}

/// Records the hits of the paths that come straight from the camera, by slot, if `first_hits` is not empty.
pub(super) fn note(first_hits: &mut [FirstHit], paths: &[Path], hits: &[Hit]) {
    if first_hits.is_empty() {
        return;
    }
    for (path, hit) in paths.iter().zip(hits) {
        if path.depth == 0 {
            first_hits[path.slot as usize] = FirstHit { ray: path.ray, hit: *hit };
        }
    }
}

impl Renderer {
    /// Adds the AOVs of samples to a tile, if first hits were recorded.
    pub(super) fn add_first_hits(&self, ids: &[SampleId], first_hits: &[FirstHit], tile: &mut FilmTile) {
        if first_hits.is_empty() {
            return;
        }
        let view_from_world = self.view.camera.world_from_view().inverse();
        for (id, first) in ids.iter().zip(first_hits) {
            let [x, y] = id.pixel;
            let aovs = first.hit.is_hit().then(|| self.aovs(first, &view_from_world));
            tile.add_first_hit(x, y, id.sample, aovs.as_ref());
        }
    }

    fn aovs(&self, first: &FirstHit, view_from_world: &DMat4) -> Aovs {
        let world = &self.world;
        let surface = world.surface(&first.ray, &first.hit);
        let point = world.texture_point(&surface);
        // The view space of the notes (u, v, w) has x to the left, that of AOVs to the right.
        let mirrored = |v: DVec3| [-v.x as f32, v.y as f32, v.z as f32];
        let toward_viewer = |n: Vec3| {
            let n = if n.dot(surface.wo) < 0.0 { -n } else { n };
            Vec3::from(mirrored(view_from_world.transform_vector3(n.as_dvec3())))
                .normalize_or_zero()
                .to_array()
        };
        let position = world.origin + DVec3::from_array(surface.point.position);
        Aovs {
            albedo: material::albedo(&world.materials, &world.textures, &surface, &point),
            ng: toward_viewer(surface.ng.as_vec3()),
            ns: toward_viewer(material::normal(&world.materials, &world.textures, &surface, &point)),
            position: mirrored(view_from_world.transform_point3(position)),
            uv: surface.uv.to_array(),
        }
    }
}
