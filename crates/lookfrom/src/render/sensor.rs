//! The sensor: from the light of traced samples to the colours that films add up.

use lookfrom_scene::settings::{Background, ColorMode, ImageSettings};

use super::{Batch, Renderer, Traced};
use crate::core::math;
use crate::core::spectrum::Spectrum;
use crate::integrator::{Alpha, Queues};
use crate::shading::texture::SpectralMode;

impl Renderer {
    /// The samples of a batch that was traced.
    pub(super) fn traced(&self, batch: &Batch) -> impl Iterator<Item = Traced> {
        let Batch { queues: Queues { radiance, modes, alpha, .. }, start, .. } = batch;
        let samples = radiance.iter().zip(alpha).zip(&start.weights).enumerate();
        samples.map(|(slot, ((&radiance, &alpha), &weight))| {
            let mode = modes[slot];
            let (rgb, alpha) = self.with_alpha(radiance, weight, &mode, alpha);
            Traced { rgb, radiance, mode, weight, filter_weight: start.filter_weights()[slot], alpha }
        })
    }

    /// The colours of the samples of a batch that was traced, as [`Traced::rgb`] has them.
    pub(super) fn light(&self, batch: &Batch, light: &mut Vec<[f32; 3]>) {
        let ImageSettings { background, sensor, .. } = self.image();
        let is_as_it_is = self.keeps_rgb
            && !self.is_spectral()
            && sensor.max_component == f32::INFINITY
            && *background == Background::Environment;
        light.clear();
        if is_as_it_is {
            let samples = batch.queues.radiance.iter().zip(&batch.start.weights);
            light.extend(samples.map(|(&radiance, &weight)| (radiance * weight).rgb()));
        } else {
            light.extend(self.traced(batch).map(|traced| traced.rgb));
        }
    }

    /// The colours of a sample's layers, by light-path expressions, as the film of its light has them: weighted, and with the
    /// sample's limit of brightness. Nothing of a sample that shows a shadow catcher on the view's own background.
    pub(super) fn light_by_paths<'a>(
        &'a self,
        batch: &'a Batch,
        slot: usize,
        traced: &'a Traced,
    ) -> impl Iterator<Item = [f32; 3]> + 'a {
        let Queues { layers, alpha, .. } = &batch.queues;
        let count = self.light_paths.as_ref().map_or(0, |light_paths| light_paths.count());
        let is_catcher = matches!(alpha[slot], Alpha::Shadow(_));
        let is_seen = !is_catcher || self.image().background == Background::Environment;
        let whole = self.measured(traced.radiance * traced.weight, &traced.mode);
        let limit = self.limit(whole);
        layers[slot * count..][..count].iter().map(move |light| match is_seen {
            true => self.measured(*light * traced.weight, &traced.mode).map(|c| c * limit),
            false => [0.0; 3],
        })
    }

    /// Whether the lanes of samples are wavelengths.
    pub(super) fn is_spectral(&self) -> bool {
        self.settings.color == ColorMode::Spectral && self.integrator.is_light()
    }

    /// The colour and alpha of a sample. Over the view's own background, a shadow catcher has only alpha, as has what is transparent, but for
    /// the light of media before them; single samples of a catcher may be outside of 0 … 1, but not their mean, up to noise.
    fn with_alpha(
        &self,
        radiance: Spectrum,
        weight: f32,
        mode: &SpectralMode,
        alpha: Alpha,
    ) -> ([f32; 3], f32) {
        match alpha {
            Alpha::Transparent(passed) => (self.rgb(radiance * weight, mode), 1.0 - passed),
            Alpha::Shadow(before) if self.image().background != Background::Environment => {
                let lit = math::luminance(self.rgb(radiance - before, mode));
                (self.rgb(before * weight, mode), 1.0 - lit)
            }
            Alpha::Shadow(_) | Alpha::Opaque => (self.rgb(radiance * weight, mode), 1.0),
        }
    }

    /// The colour that the sensor measures: linear Rec. 709.
    pub fn rgb(&self, light: Spectrum, mode: &SpectralMode) -> [f32; 3] {
        self.limited(self.measured(light, mode))
    }

    /// The sensor without the maximum component value.
    pub(crate) fn measured(&self, light: Spectrum, mode: &SpectralMode) -> [f32; 3] {
        match mode {
            SpectralMode::Rgb if self.keeps_rgb => light.rgb(),
            SpectralMode::Rgb => self.sensor.balanced(light.rgb()),
            SpectralMode::Spectral(wavelengths) => self.sensor.rgb(light, wavelengths),
        }
    }

    /// A colour scaled so that no channel of the sensor exceeds its limit (pbrt's `maxcomponentvalue`). The channels
    /// are those before the conversion to RGB, where single wavelengths are far outside of the gamut.
    fn limited(&self, rgb: [f32; 3]) -> [f32; 3] {
        let limit = self.limit(rgb);
        if limit < 1.0 { rgb.map(|c| c * limit) } else { rgb }
    }

    /// The factor of that scaling.
    pub(super) fn limit(&self, rgb: [f32; 3]) -> f32 {
        let most = self.image().sensor.max_component;
        if most == f32::INFINITY {
            return 1.0;
        }
        // Negative values, from a filter's negative lobes, are limited as well.
        let brightest = self.sensor.channels(rgb).into_iter().fold(0.0, |most, c| c.abs().max(most));
        if brightest > most { most / brightest } else { 1.0 }
    }
}
