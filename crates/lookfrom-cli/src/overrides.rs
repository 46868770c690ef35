//! From command-line arguments to the options of a session.

use lookfrom::render::StopCriteria;
use lookfrom::session::Options;
use lookfrom_scene::image::Image;

use crate::args::{Common, Overrides, RenderArguments};

impl RenderArguments {
    /// The session options of a render, with the environment map of `--environment`.
    pub(crate) fn options(&self, environment: Option<&Image>) -> Options {
        Options {
            stop: StopCriteria { time: self.time, noise: self.noise },
            fireflies: self.fireflies,
            film: self.keep.film,
            part: self.keep.part,
            ..self.overrides.options(&self.common, environment)
        }
    }
}

impl Overrides {
    /// The session options, with the environment map of `--environment`.
    pub(crate) fn options(&self, common: &Common, environment: Option<&Image>) -> Options {
        let [width, height] = match self.model.size {
            Some(size) => size.map(Some),
            None => [self.width, self.height],
        };
        Options {
            width,
            height,
            crop: self.crop,
            samples: self.samples.as_ref().map(|samples| samples.end),
            first_sample: self.samples.as_ref().map_or(0, |samples| samples.start),
            allocation: self.allocation,
            integrator: self.integrator,
            color: self.color,
            light_sampler: self.light_sampler,
            portals: self.portals,
            layers: self.layers,
            light_paths: self.light_path.clone(),
            cryptomattes: self.cryptomatte.clone(),
            spectral_buckets: self.spectral_buckets,
            wavelengths: self.wavelengths,
            denoise: self.denoise,
            depth: self.depth,
            min_contribution: self.min_contribution,
            sampler: self.sampler,
            seed: self.seed,
            filter: self.filter,
            exposure: self.exposure,
            tonemap: self.tonemap,
            background: self.model.background,
            lookfrom: self.lookfrom,
            lookat: self.lookat,
            up: self.up,
            fov: self.fov,
            view: self.model.view,
            azimuth: self.model.azimuth,
            elevation: self.model.elevation,
            bounds: self.model.bounds,
            environment: environment.cloned(),
            rotate_environment: self.model.rotate_environment,
            floor: self.model.floor,
            turn: self.model.turn,
            import: self.model.choice(&self.variables),
            variables: self.variables.variables(),
            threads: common.threads.map(usize::from),
            budget: common.memory.budget(),
            ..Options::default()
        }
    }
}
