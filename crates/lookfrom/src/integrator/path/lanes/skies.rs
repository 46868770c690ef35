//! Paths that leave the scene, up to eight at a time: the light of the environments.

use glam::Vec3;

use crate::core::lanes::{LANES, are_shaded_together, by_lane};
use crate::integrator::Probe;
use crate::integrator::path::PathTracer;
use crate::integrator::path::{HitBatch, Path, StepOutput};
use crate::integrator::wavefront::Eight;
use crate::light::Light;
use crate::world::World;

impl PathTracer {
    /// Adds the light of the environments to up to eight paths of a batch that hit nothing, in no medium.
    pub(super) fn escape_together<P: Probe>(
        &self,
        batch: &HitBatch<'_>,
        eight: &Eight<'_>,
        output: &mut StepOutput<'_, P>,
    ) {
        let indices = eight.paths;
        let paths = by_lane!(lane => &batch.paths[indices[lane.min(indices.len() - 1)] as usize]);
        self.escape(batch.world, (&paths, indices.len()), output);
    }

    /// Adds the light of the environments to a number of paths that leave the scene, attenuated on their way. Unused lanes repeat
    /// the last path.
    pub(in crate::integrator::path) fn escape<P: Probe>(
        &self,
        world: &World,
        (paths, count): (&[&Path; LANES], usize),
        output: &mut StepOutput<'_, P>,
    ) {
        let mut sees_sky = 0;
        for (lane, path) in paths.iter().enumerate().take(count) {
            sees_sky |= u32::from(!output.shows_background(path)) << lane;
        }
        let directions = by_lane!(lane => Vec3::from_array(paths[lane].ray.direction).normalize());
        for &index in &world.environments {
            let Light::Environment(environment) = &world.lights[index as usize] else { continue };
            // Some skies do not illuminate: they are only visible to the camera, in mirrors and through glass.
            let is_lit = |path: &Path| environment.illuminates || !path.blurred;
            let mut lanes = 0;
            for (lane, path) in paths.iter().enumerate() {
                lanes |= u32::from(is_lit(path)) << lane & sees_sky;
            }
            let Some(sky) = environment.map_in_lanes().filter(|_| are_shaded_together()) else {
                for (lane, path) in paths.iter().enumerate().filter(|(lane, _)| lanes & 1 << lane != 0) {
                    let radiance = world.sky_of(index, &path.ray, &output.mode(path));
                    let pdf =
                        || world.light_pdf(index, &path.state.light_context(0.0), directions[lane], None);
                    self.add_found(path, index, radiance, pdf, output);
                }
                continue;
            };
            let mut with_density = 0;
            for (lane, path) in paths.iter().enumerate() {
                let is_weighted = P::LISTENS || !path.state.pdf.is_infinite();
                with_density |= u32::from(is_weighted && environment.illuminates) << lane & lanes;
            }
            let modes = by_lane!(lane => &output.queues.modes[paths[lane].slot as usize]);
            let seen = sky.seen(&world.textures, &directions, &modes, with_density);
            for (lane, path) in paths.iter().enumerate().filter(|(lane, _)| lanes & 1 << lane != 0) {
                let pdf = || {
                    let at = path.state.light_context(0.0);
                    let histogram = environment.histogram(&at);
                    let of_direction = environment.mixed_pdf(histogram, directions[lane], seen.pdf[lane]);
                    world.light_choice.probability(&at, index) * of_direction
                };
                self.add_found(path, index, seen.li[lane], pdf, output);
            }
        }
    }
}
