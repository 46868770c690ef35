//! AOVs of a picture: those of a batch, for the film.

use glam::{DMat4, DVec3};

use super::{Batch, Renderer, SampleId};
use crate::aov::{CameraSpace, RayHit};
use crate::film::FilmTile;
use crate::shading::interior_stack::InteriorStack;

impl Renderer {
    /// The space of AOVs.
    pub(super) fn camera_space(&self) -> CameraSpace {
        CameraSpace::new(self.view.camera.world_from_view(), self.world.origin, self.luminous_media())
    }

    /// The bodies and the medium that the camera is in, if light is scattered or emitted in media.
    pub(super) fn luminous_media(&self) -> Option<InteriorStack> {
        (self.integrator.flies() && self.world.has_luminous_media()).then_some(self.interior)
    }

    /// Adds the AOVs of a sample of each pixel to a tile or to its sums, where they are wanted.
    pub(super) fn add_aovs(&self, ids: &[SampleId], batch: &mut Batch, tile: &mut FilmTile) {
        let Batch { aov_sums, queues, start, .. } = batch;
        let Some(aovs) = queues.first_surfaces.aovs(&self.world, (&start.rays, &start.times)) else { return };
        tile.add_first_hits(ids, aovs, aov_sums);
        if tile.has_motion() {
            self.add_motion(ids, batch, tile);
        }
    }

    /// Adds the motion vectors of a sample of each pixel whose AOVs have been added.
    fn add_motion(&self, ids: &[SampleId], batch: &Batch, tile: &mut FilmTile) {
        let Batch { queues, start, .. } = batch;
        let camera = &self.view.camera;
        let view_from_world = [0.0, 1.0].map(|time| {
            let motion = camera.motion.as_ref().map_or(DMat4::IDENTITY, |motion| motion.at(time));
            (motion * camera.world_from_view()).inverse()
        });
        for (slot, id) in ids.iter().enumerate() {
            let met = queues.first_surfaces.met(slot, start.rays[slot]);
            let motion = met.and_then(|met| self.motion_vector(met, start.times.of(slot), &view_from_world));
            motion.into_iter().for_each(|motion| tile.add_motion(id.pixel[0], id.pixel[1], motion));
        }
    }

    /// The motion vector of a hit at a time, in pixels to the right and upwards, by the view spaces of the camera at the opening and the
    /// closing of the shutter. `None` for cameras without an image plane, and for a point that is behind the camera at either time.
    fn motion_vector(&self, met: RayHit, time: f32, view_from_world: &[DMat4; 2]) -> Option<[f32; 2]> {
        let RayHit { ray, hit } = met;
        if !self.moves() || !hit.is_hit() {
            return Some([0.0; 2]);
        }
        let [opening, closing] = self.world.point_at(&ray, &hit, time, [0.0, 1.0]);
        let image_at = |point: DVec3, view_from_world: &DMat4| {
            self.view.camera.image_of(view_from_world.transform_point3(self.world.origin + point))
        };
        let [x0, y0] = image_at(opening, &view_from_world[0])?;
        let [x1, y1] = image_at(closing, &view_from_world[1])?;
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
