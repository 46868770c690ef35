//! What the denoiser is told of the first samples of a pixel: what their camera rays met, by a look and no more.
//!
//! Nothing listens to the way of a batch, so it goes as fast as always; only the first hits are noted, and looked at again
//! afterwards. Where a surface lets a ray through as if it were not there, what comes behind it counts.

use glam::DVec3;
use lookfrom_bvh::{Hit, Ray};

use super::{Renderer, SampleId};
use crate::film::{FilmTile, Guide};
use crate::integrator::Path;
use crate::material;

/// What the camera's ray of a sample met.
#[derive(Clone, Copy, Debug)]
pub(super) struct First {
    ray: Ray,
    hit: Hit,
}

impl First {
    pub(super) const NOTHING: Self =
        Self { ray: Ray { origin: [0.0; 3], t_min: 0.0, direction: [0.0; 3], t_max: 0.0 }, hit: Hit::MISS };
}

/// Notes the hits of those of a batch's paths that come straight from the camera, by slot, where that is asked for.
pub(super) fn note_firsts(firsts: &mut [First], paths: &[Path], hits: &[Hit]) {
    if firsts.is_empty() {
        return;
    }
    for (path, hit) in paths.iter().zip(hits) {
        if path.depth == 0 {
            firsts[path.slot as usize] = First { ray: path.ray, hit: *hit };
        }
    }
}

impl Renderer {
    /// Tells a tile what the rays of samples met, where that was noted.
    pub(super) fn add_guides(&self, ids: &[SampleId], firsts: &[First], tile: &mut FilmTile) {
        for (id, first) in ids.iter().zip(firsts) {
            let [x, y] = id.pixel;
            let guide = first.hit.is_hit().then(|| self.guide(first));
            tile.add_guide(x, y, id.sample, guide.as_ref());
        }
    }

    fn guide(&self, first: &First) -> Guide {
        let world = &self.world;
        let surface = world.surface(&first.ray, &first.hit);
        let point = world.texture_point(&surface);
        let n = material::normal(&world.materials, &world.textures, &surface, &point);
        let facing = if surface.front { 1.0 } else { -1.0 };
        Guide {
            albedo: material::base_color(&world.materials, &world.textures, &surface, &point),
            n: (facing * n).to_array(),
            ng: surface.ng_facing().to_array(),
            place: DVec3::from_array(surface.point.position).as_vec3().to_array(),
        }
    }
}
