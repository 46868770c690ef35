//! Scenes with each setting.

use glam::{DMat4, DVec3};
use lookfrom_scene::material::Scalar;
use lookfrom_scene::scene::VertexNormals;
use lookfrom_scene::settings::{
    Allocation, Background, Band, ColorMode, CryptomatteKind, FilterShape, ImageSettings, Integrator, Layers,
    LightPathLayer, LightSampler, PixelBounds, Portals, RenderSettings, Sampler, Sensor, SpectralFilm,
    Tonemap,
};
use lookfrom_scene::shape::{Emission, Shape};
use lookfrom_scene::spectrum::{CameraSensor, Curve};
use lookfrom_scene::{Location, Scene};

use super::{COLOR, TEXTURE, base, each};

pub(super) fn settings() -> Vec<(String, Scene)> {
    let filters = vec![
        FilterShape::Box.of_radius(0.7),
        FilterShape::Triangle.of_radius(1.0),
        FilterShape::Gaussian { sigma: 0.7 }.of_radius(2.0),
        FilterShape::Mitchell { b: 0.25, c: 0.5 }.of_radius(2.0),
        FilterShape::BlackmanHarris.of_radius(1.7),
        FilterShape::Sinc { tau: 2.5 }.of_radius(3.0),
    ];
    let of_filter = |filter: &lookfrom_scene::settings::Filter| match filter.shape {
        FilterShape::Box => 0,
        FilterShape::Triangle => 1,
        FilterShape::Gaussian { .. } => 2,
        FilterShape::Mitchell { .. } => 3,
        FilterShape::BlackmanHarris => 4,
        FilterShape::Sinc { .. } => 5,
    };
    let mut scenes = each("filter", filters, of_filter, |scene, mut filter| {
        filter.radius[1] *= 0.5;
        scene.image.filter = filter;
    });
    let mut integrators: Vec<Integrator> =
        Integrator::WORDS.iter().map(|(_, integrator)| *integrator).collect();
    integrators.push(Integrator::AmbientOcclusion { cosine: false });
    let of_integrator = |integrator: &Integrator| match integrator {
        Integrator::Raycast => 0,
        Integrator::Whitted => 1,
        Integrator::Path => 2,
        Integrator::SimplePath => 3,
        Integrator::RandomWalk => 4,
        Integrator::AmbientOcclusion { cosine: false } => 5,
        Integrator::AmbientOcclusion { cosine: true } => 6,
        Integrator::Normals => 7,
        Integrator::Depth => 8,
        Integrator::Uv => 9,
        Integrator::Id => 10,
    };
    scenes.extend(each("integrator", integrators, of_integrator, |scene, integrator| {
        scene.render = RenderSettings {
            integrator,
            samples: 3,
            allocation: Allocation::Adaptive,
            depth: 1000,
            min_contribution: 0.1,
            sampler: Sampler::Independent,
            seed: u64::MAX,
            transparent_shadows: false,
            color: ColorMode::Spectral,
            light_sampler: LightSampler::Power,
            portals: Portals::Auto,
            regularize: true,
            occlusion_distance: 1.5,
            media: false,
            endless_media: true,
            thin_passages_count: false,
            open_fronts: true,
            hide_lights: true,
        };
        scene.vertex_normals = VertexNormals::AsGiven;
    }));
    let backgrounds =
        vec![Background::Environment, Background::Transparent, Background::Color([0.1, 0.2, 0.3])];
    let of_background = |background: &Background| match background {
        Background::Environment => 0,
        Background::Transparent => 1,
        Background::Color(_) => 2,
    };
    scenes.extend(each("background", backgrounds, of_background, |scene, background| {
        let layer = LightPathLayer {
            name: "a b".to_owned(),
            expression: "C<RD>L".to_owned(),
            at: Location::default(),
        };
        scene.image = ImageSettings {
            width: 33,
            height: 21,
            crop: Some(PixelBounds { x0: 1, y0: 2, x1: 30, y1: 20 }),
            exposure: -1.5,
            tonemap: Tonemap::Agx,
            sensor: Sensor {
                camera: CameraSensor::named("nikon_d810"),
                imaging_ratio: 0.5,
                white_balance: Some(5000.0),
                max_component: 12.5,
            },
            layers: Layers::Motion,
            light_paths: vec![layer],
            cryptomattes: vec![CryptomatteKind::Material, CryptomatteKind::Object],
            spectral_film: Some(SpectralFilm { buckets: 7, range: [400.0, 700.5], bands: bands() }),
            background,
            denoise: true,
            ..ImageSettings::default()
        };
    }));
    scenes
}

/// A band with each kind of response.
fn bands() -> Vec<Band> {
    let table = |count: usize| Curve::Tabulated {
        wavelengths: (0..count).map(|k| 400.0 + 0.25 * k as f32).collect(),
        values: (0..count).map(|k| (k % 7) as f32 * 0.125).collect(),
    };
    let responses = [table(5), table(900), Curve::Constant(0.5), Curve::Blackbody { kelvin: 3000.0 }];
    let names = ["a", "b-1", "c_2", "d"].map(str::to_owned);
    names.into_iter().zip(responses).map(|(name, response)| Band { name, response }).collect()
}

/// Shapes with each of their other properties.
pub(super) fn looks() -> Vec<(String, Scene)> {
    let mut scene = base();
    scene.shapes[0] = Shape {
        name: Some("ball".to_owned()),
        alpha: Some(TEXTURE),
        reverse_orientation: true,
        single_sided: true,
        emission: Some(Emission::new(COLOR, false)),
        world_from_object: DMat4::from_translation(DVec3::Y) * DMat4::from_scale(DVec3::new(1.0, 2.0, 3.0)),
        ..scene.shapes[0].clone()
    };
    let mut clear = base();
    clear.shapes[0].alpha = Some(Scalar::Value(0.5));
    vec![("look".to_owned(), scene), ("alpha".to_owned(), clear)]
}
