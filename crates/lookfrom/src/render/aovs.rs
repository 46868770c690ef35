//! AOVs of a picture: those of a batch, for the film.

use glam::{DMat4, DVec3};

use super::{Batch, Renderer, SampleId};
use crate::aov::{CameraSpace, RayHit};
use crate::core::lanes::LANES;
use crate::film::FilmTile;

impl Renderer {
    /// The space of AOVs.
    pub(super) fn camera_space(&self) -> CameraSpace {
        let space = CameraSpace::new(self.view.camera.world_from_view(), self.world.origin);
        match self.integrator.flies() && self.world.has_luminous_media() {
            true => space.in_media(self.interior),
            false => space,
        }
    }

    /// Adds the AOVs of a sample of each pixel to a tile or to its sums, where they are wanted.
    pub(super) fn add_aovs(&self, ids: &[SampleId], batch: &mut Batch, tile: &mut FilmTile) {
        let Batch { aov_sums, queues, start, .. } = batch;
        let Some(aovs) = queues.first_surfaces.aovs(&self.world, (&start.rays, &start.times)) else { return };
        tile.add_first_hits(ids, aovs, aov_sums);
        if tile.has_motion() {
            let hits: Vec<u32> = aovs.iter().map(|eight| eight.hits).collect();
            for (slot, id) in
                ids.iter().enumerate().filter(|(slot, _)| hits[slot / LANES] >> (slot % LANES) & 1 != 0)
            {
                let seen = queues.first_surfaces.seen(slot, start.rays[slot]);
                if let Some(motion) = self.motion_of(seen, start.times.of(slot)) {
                    tile.add_motion(id.pixel[0], id.pixel[1], motion);
                }
            }
        }
    }

    /// How far what a ray has hit at a time moves in the picture while the shutter is open: pixels to the right and upwards. `None` for
    /// cameras without an image plane, and for what is behind the camera at the opening or the closing.
    fn motion_of(&self, RayHit { ray, hit }: RayHit, time: f32) -> Option<[f32; 2]> {
        if !self.moves() || !hit.is_hit() {
            return Some([0.0; 2]);
        }
        let camera = &self.view.camera;
        let [opening, closing] = self.world.point_at(&ray, &hit, time, [0.0, 1.0]);
        let image_at = |point: DVec3, time: f64| {
            let motion = camera.motion.as_ref().map_or(DMat4::IDENTITY, |motion| motion.at(time));
            let view_from_world = (motion * camera.world_from_view()).inverse();
            camera.image_of(view_from_world.transform_point3(self.world.origin + point))
        };
        let ([x0, y0], [x1, y1]) = (image_at(opening, 0.0)?, image_at(closing, 1.0)?);
        Some([(x1 - x0) as f32, (y1 - y0) as f32])
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
        let space = renderer.camera_space();
        for sample in 0..3 {
            let ids: Vec<SampleId> =
                blocks(&[area]).into_iter().map(|pixel| SampleId { pixel, sample }).collect();
            let mut batch = Batch::default();
            batch.queues.first_surfaces.set_space(Some(space));
            renderer.integrator.trace(&renderer, &ids, &mut batch);
            let Batch { queues, start, .. } = &mut batch;
            queues.first_surfaces.aovs(&renderer.world, (&start.rays, &start.times));
            for (slot, id) in ids.iter().enumerate() {
                let aovs =
                    queues.first_surfaces.found_again(&renderer.world, &space, slot, (start.rays[slot], 0.0));
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
        for name in [
            "whitted1980",
            "many-lights",
            "materials",
            "textures",
            "instances",
            "cutouts",
            "still-life",
            "media",
        ] {
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
