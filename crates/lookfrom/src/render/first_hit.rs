//! First hits of camera rays, recorded once for AOVs and denoiser.
//!
//! No probe is needed, so that rendering is not slowed down: first hits are recorded as they are traced, and evaluated
//! after the batch, unless a step had the surface at hand. Where a ray passes a surface as if it were not there, the hit
//! behind it counts; but where chance decides that, by an alpha between 0 and 1, all surfaces along the ray count by what
//! they cover, so that features have no noise that light does not have.

use glam::Vec3;
use lookfrom_bvh::{Hit, Ray};
use lookfrom_simd::LaneMask;

use super::camera_space::CameraSpace;
use super::{Batch, Renderer, SampleId};
use crate::core::lanes::LANES;
use crate::film::{AovColumns, Aovs, FilmTile};
use crate::integrator::{FirstMeshHit, FirstSurface, FirstSurfaces, Path};

/// The first hits of a batch, and their AOVs: memory that is reused.
#[derive(Debug, Default)]
pub(super) struct FirstHits {
    are_wanted: bool,
    /// The hits of the camera's rays, by slot.
    outermost: Vec<Hit>,
    /// Further hits of the paths that have passed surfaces, with their slots, in the order in which they were found.
    behind: Vec<(u32, RayHit)>,
    /// Whether paths may have passed surfaces.
    go_on: bool,
    /// By slot.
    aovs: Vec<AovColumns>,
}

#[derive(Clone, Copy, Debug)]
struct RayHit {
    ray: Ray,
    hit: Hit,
}

/// Number of surfaces of fractional alpha that are looked through.
const MOST_LAYERS: usize = 16;

/// What is left of a pixel behind surfaces that cover nearly all of it is not looked at.
const LEAST_PART: f32 = 1.0 / 256.0;

impl FirstHits {
    /// Prepares for another batch.
    pub(super) fn start(&mut self, are_wanted: bool) {
        self.are_wanted = are_wanted;
        self.outermost.clear();
        self.behind.clear();
        self.go_on = true;
    }

    /// Whether they are recorded.
    pub(super) fn are_wanted(&self) -> bool {
        self.are_wanted
    }

    /// Records the hits of the paths that come straight from the camera. The first call is with all of them, by slot.
    pub(super) fn note(&mut self, paths: &[Path], hits: &[Hit]) {
        if !self.are_wanted || !self.go_on {
            return;
        }
        if self.outermost.is_empty() {
            self.outermost.extend_from_slice(hits);
            return;
        }
        let count = self.behind.len();
        for (path, hit) in paths.iter().zip(hits) {
            if path.depth == 0 {
                self.behind.push((path.slot, RayHit { ray: path.ray, hit: *hit }));
            }
        }
        self.go_on = self.behind.len() > count;
    }
}

impl Renderer {
    /// Adds the AOVs of a sample of each pixel to a tile or to its sums, if first hits were recorded.
    pub(super) fn add_first_hits(&self, ids: &[SampleId], batch: &mut Batch, tile: &mut FilmTile) {
        let Batch { first_hits, first_hit_sums, queues, start, .. } = batch;
        if !first_hits.are_wanted {
            return;
        }
        let space = CameraSpace::of(self);
        let surfaces = &mut queues.first_surfaces;
        first_hits.aovs.resize(ids.len().div_ceil(LANES), AovColumns::MISSES);
        first_hits.aovs.iter_mut().for_each(|eight| eight.hits = 0);
        space.set_aovs(surfaces.eights(), &mut first_hits.aovs);
        let count = surfaces.eights().len();
        self.find_others(first_hits, &start.rays, &space, surfaces);
        space.set_aovs(&surfaces.eights()[count..], &mut first_hits.aovs);
        tile.add_first_hits(ids, &first_hits.aovs, first_hit_sums);
    }

    /// The AOVs of hits whose surfaces no step has left, and the surfaces of those on meshes, eight by eight.
    fn find_others(
        &self,
        first_hits: &mut FirstHits,
        rays: &[Ray],
        space: &CameraSpace,
        surfaces: &mut FirstSurfaces,
    ) {
        let FirstHits { outermost, behind, aovs, .. } = first_hits;
        // Of the hits of a slot, the last one counts.
        behind.sort_by_key(|&(slot, _)| slot);
        let mut mesh_hits = Vec::with_capacity(LANES);
        for (block, (eight, hits)) in aovs.iter_mut().zip(outermost.chunks(LANES)).enumerate() {
            let left = !eight.hits & ((1 << hits.len()) - 1);
            for lane in LaneMask(left).filter(|lane| hits[*lane].is_hit()) {
                let slot = block * LANES + lane;
                let end = behind.partition_point(|(of, _)| *of as usize <= slot);
                let further = behind[..end].last().filter(|(of, _)| *of as usize == slot);
                let (ray, hit) = (&rays[slot], &hits[lane]);
                if further.is_none()
                    && let Some(mesh_hit) = FirstMeshHit::of(&self.world, slot as u32, ray, hit)
                    && (!self.world.has_gaps || mesh_hit.is_whole())
                {
                    mesh_hits.push(mesh_hit);
                    if mesh_hits.len() == LANES {
                        FirstMeshHit::surfaces(&self.world, &mesh_hits, surfaces.next());
                        mesh_hits.clear();
                    }
                    continue;
                }
                let first = RayHit { ray: *ray, hit: *hit };
                let seen = further.map_or(first, |(_, seen)| *seen);
                if let Some(aovs) = self.aovs_of_hit(first, seen, space) {
                    eight.set(lane, &aovs);
                }
            }
        }
        if !mesh_hits.is_empty() {
            FirstMeshHit::surfaces(&self.world, &mesh_hits, surfaces.next());
        }
    }

    /// The AOVs of a first hit, by the hit of the camera's ray and the one that it has not passed; `None` for a miss.
    fn aovs_of_hit(&self, outermost: RayHit, seen: RayHit, space: &CameraSpace) -> Option<Aovs> {
        let blended = match self.world.has_gaps {
            true => self.blended_aovs(outermost, space),
            false => None,
        };
        blended.or_else(|| {
            let RayHit { ray, hit } = seen;
            let surface = || FirstSurface::of(&self.world, &self.world.surface(&ray, &hit));
            hit.is_hit().then(|| space.aovs(&surface()))
        })
    }

    /// The mean albedo and shading normal of all surfaces along a camera ray by what each covers, and the place of the one
    /// that covers most; `None` where none has an alpha between 0 and 1. What nothing covers is white, as a miss is.
    fn blended_aovs(&self, outermost: RayHit, space: &CameraSpace) -> Option<Aovs> {
        let world = &self.world;
        let RayHit { mut ray, mut hit } = outermost;
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
                let aovs = space.aovs(&FirstSurface::of(world, &surface));
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
}

#[cfg(test)]
mod tests {
    use std::path::Path as FilePath;

    use lookfrom_scene::LoadContext;
    use lookfrom_scene::settings::{Layers, PixelBounds};

    use super::super::blocks;
    use super::*;
    use crate::film::Film;

    #[test]
    fn first_hits_of_eight_are_those_of_each() {
        let scenes = FilePath::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
        for name in
            ["whitted1980", "many-lights", "materials", "textures", "instances", "cutouts", "still-life"]
        {
            let mut context = LoadContext::new(&lookfrom_scene::Disk);
            let path = scenes.join(name).with_extension("toml");
            let mut scene = lookfrom_scene::load::scene(&path, &mut context).unwrap();
            let image = &mut scene.image;
            (image.width, image.height, image.crop) = (41, 27, None);
            (image.layers, image.denoise) = (Layers::Geometry, true);
            let image = image.clone();
            let renderer = Renderer::of_scene(scene, &mut Vec::new()).unwrap();
            let area = PixelBounds { x0: 0, y0: 0, x1: 41, y1: 27 };
            let tile = FilmTile::for_image(area, &image).unwrap();
            let (mut together, mut each) = (tile.clone(), tile);
            renderer.render_tile(0..3, &mut together).unwrap();
            let space = CameraSpace::of(&renderer);
            for sample in 0..3 {
                let ids: Vec<SampleId> = blocks(area).map(|pixel| SampleId { pixel, sample }).collect();
                let mut batch = Batch::default();
                batch.first_hits.start(true);
                renderer.integrator.trace(&renderer, &ids, &mut batch);
                let FirstHits { outermost, behind, .. } = &batch.first_hits;
                for (slot, id) in ids.iter().enumerate() {
                    let first = RayHit { ray: batch.start.rays[slot], hit: outermost[slot] };
                    let last = behind.iter().rfind(|(of, _)| *of as usize == slot);
                    let seen = last.map_or(first, |(_, seen)| *seen);
                    let aovs = renderer.aovs_of_hit(first, seen, &space);
                    each.add_first_hit(id.pixel[0], id.pixel[1], sample, aovs.as_ref());
                }
            }
            let [together, each] = [together, each].map(|tile| {
                let mut film = Film::for_image(&image).unwrap();
                film.add_tile(&tile).unwrap();
                film
            });
            for [x, y] in blocks(area) {
                assert_eq!(together.aovs(x, y), each.aovs(x, y), "{name}, pixel {x} {y}");
                let features = |film: &Film| film.denoiser_features(x, y);
                assert_eq!(features(&together), features(&each), "{name}, pixel {x} {y}");
            }
        }
    }
}
