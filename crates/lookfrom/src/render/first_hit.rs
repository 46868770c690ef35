//! First hits of camera rays, recorded once for AOVs and denoiser.
//!
//! No probe is needed, so that rendering is not slowed down: steps leave the surfaces that they have at hand; first hits
//! are recorded besides as they are traced, and evaluated after the batch where no step has left a surface. Where a ray
//! passes a surface as if it were not there, the hit behind it counts; but where chance decides that, by an alpha between
//! 0 and 1, all surfaces along the ray count by what they cover, so that features have no noise that light does not have.

use glam::Vec3;
use lookfrom_bvh::{Hit, Ray};
use lookfrom_simd::LaneMask;

use super::camera_space::CameraSpace;
use super::{Batch, Renderer, SampleId};
use crate::core::lanes::LANES;
use crate::film::{AovColumns, Aovs, FilmTile};
use crate::integrator::{FirstSurface, Path};

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

/// The part of a pixel, left behind surfaces that cover nearly all of it, below which nothing is looked at.
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
    pub(super) fn note<S>(&mut self, paths: &[Path<S>], hits: &[Hit]) {
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
        first_hits.aovs.resize(ids.len().div_ceil(LANES), AovColumns::MISSES);
        first_hits.aovs.iter_mut().for_each(|eight| eight.hits = 0);
        space.set_aovs(queues.first_surfaces.eights(), &mut first_hits.aovs);
        self.find_others(first_hits, &start.rays, &space);
        tile.add_first_hits(ids, &first_hits.aovs, first_hit_sums);
    }

    /// The AOVs of hits whose surfaces no step has left: of few, as those that light may pass as if they were not there.
    fn find_others(&self, first_hits: &mut FirstHits, rays: &[Ray], space: &CameraSpace) {
        let FirstHits { outermost, behind, aovs, .. } = first_hits;
        // Of the hits of a slot, the last one counts.
        behind.sort_by_key(|&(slot, _)| slot);
        for (block, (eight, hits)) in aovs.iter_mut().zip(outermost.chunks(LANES)).enumerate() {
            let left = !eight.hits & ((1 << hits.len()) - 1);
            for lane in LaneMask(left).filter(|lane| hits[*lane].is_hit()) {
                let slot = block * LANES + lane;
                let first = RayHit { ray: rays[slot], hit: hits[lane] };
                let end = behind.partition_point(|(of, _)| *of as usize <= slot);
                let further = behind[..end].last().filter(|(of, _)| *of as usize == slot);
                let seen = further.map_or(first, |(_, seen)| *seen);
                if let Some(aovs) = self.aovs_of_hit(first, seen, space) {
                    eight.set(lane, &aovs);
                }
            }
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
            let surface = || FirstSurface::of(&self.world, &self.world.surface(&ray, &hit), None);
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
                let aovs = space.aovs(&FirstSurface::of(world, &surface, None));
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
    use lookfrom_scene::settings::{ColorMode, Integrator, Layers, PixelBounds};

    use super::super::blocks;
    use super::*;
    use crate::film::Film;

    /// Compares the AOVs of a scene's film with those of each sample's first hits, evaluated one by one.
    fn test_scene(name: &str, integrator: Option<Integrator>, color: ColorMode) {
        let path = FilePath::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(name);
        let mut context = LoadContext::new(&lookfrom_scene::Disk);
        let mut scene = lookfrom_scene::load::scene(&path.with_extension("toml"), &mut context).unwrap();
        scene.render.integrator = integrator.unwrap_or(scene.render.integrator);
        scene.render.color = color;
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
            let ids: Vec<SampleId> =
                blocks(&[area]).into_iter().map(|pixel| SampleId { pixel, sample }).collect();
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
        for [x, y] in blocks(&[area]) {
            let aovs = |film: &Film| (film.aovs(x, y), film.denoiser_features(x, y));
            assert_eq!(aovs(&together), aovs(&each), "{name}, {integrator:?}, {color:?}, pixel {x} {y}");
        }
    }

    #[test]
    fn first_hits_of_eight_are_those_of_each() {
        for name in
            ["whitted1980", "many-lights", "materials", "textures", "instances", "cutouts", "still-life"]
        {
            test_scene(name, None, ColorMode::Rgb);
        }
    }

    #[test]
    fn those_of_whitteds_model_are_of_any_material_and_in_spectra() {
        for name in ["materials", "textures", "cutouts", "still-life"] {
            test_scene(name, Some(Integrator::Whitted), ColorMode::Rgb);
        }
        test_scene("textures", None, ColorMode::Spectral);
        test_scene("textures", Some(Integrator::Path), ColorMode::Rgb);
        test_scene("textures", Some(Integrator::Raycast), ColorMode::Rgb);
    }

    #[test]
    fn false_colours_and_occlusion_leave_them_too() {
        for integrator in [Integrator::Normals, Integrator::AmbientOcclusion { cosine: true }] {
            test_scene("cutouts", Some(integrator), ColorMode::Rgb);
        }
    }
}
