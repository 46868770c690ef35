//! The picture and the integrator, and what else a scene says of its rendering.

use super::Writer;
use super::color::plain_color;
use super::text::{Fields, Item};
use crate::light::{Light, LightKind};
use crate::scene::{Scene, VertexNormals};
use crate::settings::{
    Allocation, Background, Band, ColorMode, CryptomatteKind, Filter, FilterShape, ImageSettings, Integrator,
    Layers, LightPathLayer, LightSampler, PixelBounds, Portals, RenderSettings, Sampler, Sensor,
    SpectralFilm, Tonemap,
};
use crate::toml::settings::{BACKGROUNDS, VERTEX_NORMALS};
use crate::toml::word_of;

impl Writer<'_> {
    pub(super) fn image(&mut self) -> Fields {
        let ImageSettings {
            width,
            height,
            crop,
            filter,
            exposure,
            tonemap,
            sensor,
            layers,
            light_paths,
            cryptomattes,
            spectral_film,
            background,
            denoise,
        } = &self.scene.image;
        let mut fields = Fields::default();
        fields.put("width", *width);
        fields.put("height", *height);
        if let Some(PixelBounds { x0, y0, x1, y1 }) = *crop {
            fields.put("crop", [x0, y0, x1, y1]);
        }
        put_filter(&mut fields, filter);
        fields.put_unless("exposure", *exposure, 0.0);
        if *tonemap != Tonemap::default() {
            fields.put("tonemap", tonemap.word());
        }
        let Sensor { camera, imaging_ratio, white_balance, max_component } = *sensor;
        if let Some(camera) = camera {
            fields.put("sensor", camera.name());
        }
        fields.put_unless("imaging_ratio", imaging_ratio, 1.0);
        if let Some(kelvin) = white_balance {
            fields.put("white_balance", kelvin);
        }
        fields.put_unless("max_component", max_component, f32::INFINITY);
        if *layers != Layers::None {
            fields.put("layers", word_of(Layers::WORDS, layers));
        }
        if !light_paths.is_empty() {
            let mut paths = Fields::default();
            for LightPathLayer { name, expression, .. } in light_paths {
                paths.put(name, expression.as_str());
            }
            fields.put("light_paths", paths);
        }
        if !cryptomattes.is_empty() {
            let words = cryptomattes.iter().map(|kind| word_of(CryptomatteKind::WORDS, kind));
            fields.put("cryptomatte", Item::list(words));
        }
        if let Some(SpectralFilm { buckets, range, bands }) = spectral_film {
            fields.put_unless("spectral_buckets", *buckets, 0);
            if *range != SpectralFilm::ALL || (*buckets == 0 && bands.is_empty()) {
                fields.put("wavelengths", *range);
            }
            if !bands.is_empty() {
                let mut spectra = Fields::default();
                for Band { name, response } in bands {
                    spectra.put(name, self.spectrum(response));
                }
                fields.put("bands", spectra);
            }
        }
        match background {
            Background::Environment => {}
            Background::Transparent => fields.put("background", word_of(BACKGROUNDS, background)),
            Background::Color(rgb) => fields.put("background", plain_color(*rgb)),
        }
        fields.put_unless("denoise", *denoise, false);
        fields
    }

    pub(super) fn render(&self) -> Fields {
        let RenderSettings {
            integrator,
            samples,
            allocation,
            depth,
            min_contribution,
            sampler,
            seed,
            transparent_shadows,
            color,
            light_sampler,
            portals,
            regularize,
            occlusion_distance,
            media,
            endless_media,
            thin_passages_count,
            open_fronts,
            hide_lights,
        } = &self.scene.render;
        let usual = RenderSettings::default();
        let mut fields = Fields::default();
        fields.put("integrator", integrator.word());
        if *integrator == (Integrator::AmbientOcclusion { cosine: false }) {
            fields.put("occlusion_directions", "uniform");
        }
        fields.put("samples", *samples);
        if *allocation != Allocation::default() {
            fields.put("allocation", allocation.word());
        }
        fields.put_unless("depth", *depth, usual.depth);
        fields.put_unless("min_contribution", *min_contribution, usual.min_contribution);
        if *sampler != Sampler::default() {
            fields.put("sampler", sampler.word());
        }
        fields.put_unless("seed", *seed, usual.seed);
        fields.put_unless("transparent_shadows", *transparent_shadows, usual.transparent_shadows);
        if *color != ColorMode::default() {
            fields.put("color", color.word());
        }
        if *light_sampler != LightSampler::default() {
            fields.put("light_sampler", light_sampler.word());
        }
        if *portals != Portals::default() {
            fields.put("portals", portals.word());
        }
        fields.put_unless("regularize", *regularize, usual.regularize);
        fields.put_unless("occlusion_distance", *occlusion_distance, usual.occlusion_distance);
        fields.put_unless("media", *media, usual.media);
        fields.put_unless("endless_media", *endless_media, usual.endless_media);
        fields.put_unless("thin_passages_count", *thin_passages_count, usual.thin_passages_count);
        fields.put_unless("open_fronts", *open_fronts, usual.open_fronts);
        fields.put_unless("hide_lights", *hide_lights, usual.hide_lights);
        if self.scene.vertex_normals != VertexNormals::default() {
            fields.put("vertex_normals", word_of(VERTEX_NORMALS, &self.scene.vertex_normals));
        }
        fields
    }
}

/// Whether a light would be added that the scene is not to have.
pub(super) fn is_dark(scene: &Scene) -> bool {
    let is_backdrop = |light: &Light| matches!(light.kind, LightKind::Environment { illuminates: false, .. });
    let placed = scene.instances.iter().flat_map(|instance| &scene.objects[instance.object.index()].shapes);
    let mut shapes = scene.shapes.iter().chain(placed);
    !shapes.any(|shape| shape.emission.is_some()) && scene.lights.iter().all(is_backdrop)
}

fn put_filter(fields: &mut Fields, filter: &Filter) {
    if *filter == Filter::default() {
        return;
    }
    let Filter { shape, radius } = *filter;
    let word = shape.word();
    let usual = Filter::WORDS.iter().find(|(known, _)| *known == word).map(|(_, filter)| filter);
    if usual == Some(filter) {
        fields.put("filter", word);
        return;
    }
    let mut table = Fields::one("type", word);
    let [x, y] = radius;
    table.put("radius", if x == y { Item::from(x) } else { Item::from(radius) });
    match shape {
        FilterShape::Box | FilterShape::Triangle | FilterShape::BlackmanHarris => {}
        FilterShape::Gaussian { .. } | FilterShape::Mitchell { .. } | FilterShape::Sinc { .. } => {
            shape.parameters().into_iter().for_each(|(name, value)| table.put(name, value));
        }
    }
    fields.put("filter", table);
}
