//! Environment maps in lanes against one by one.

use std::sync::Arc;

use glam::{DVec3, Mat3};
use lookfrom_scene::image::Image;
use lookfrom_scene::material::Color;
use lookfrom_scene::settings::ColorMode;

use super::*;
use crate::core::color::Wavelengths;
use crate::core::distribution::Piecewise2D;
use crate::core::hash;
use crate::core::lanes::gather_f64;
use crate::light::{EmissionSpectrum, Guide, GuidePoint, Light, LightSampleContext, Query};
use crate::shading::texture::SpectrumType;

struct Sample<'a> {
    mode: &'a SpectralMode,
    environment: &'a Environment,
    points: &'a [DVec3; LANES],
    textures: &'a Textures,
    u: [[f32; LANES]; 2],
}

impl Kernel for Sample<'_> {
    type Output = Option<SkySamples>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Option<SkySamples> {
        let points = gather_f64(simd, &by_lane!(lane => self.points[lane].to_array()));
        let n = Vector::splat(f32x8::splat(simd, 0.0), Vec3::Z.to_array());
        let modes = &[self.mode; LANES];
        self.environment.sample_lanes(simd, self.textures, (points, n), self.u, modes)
    }
}

#[test]
fn eight_at_once_are_eight_one_by_one() {
    let (bands, to_poles) = ([1.0, 0.0], [6.0 / 7.0, 0.5 / 7.0]);
    for mode in [SpectralMode::Rgb, spectral()] {
        compare(MapLayout::LatitudeLongitude, to_poles, &mode);
        compare(MapLayout::LatitudeLongitude, bands, &mode);
        compare(MapLayout::Octahedral, bands, &mode);
    }
}

fn spectral() -> SpectralMode {
    SpectralMode::Spectral(Wavelengths::new([450.0, 520.0, 580.0, 640.0], [1.0; 4]))
}

/// Mitsuba interpolates the spectrum and the brightness of its maps apart: the middle between the texels A and B is not their mean.
#[test]
fn brightness_and_spectrum_are_interpolated_apart_in_maps_to_the_poles() {
    let (dark, bright) = ([0.2, 0.02, 0.02], [4.0, 4.0, 2.0]);
    let radiance = |texels: Vec<[f32; 3]>, picture_v| {
        let image = Image::from_linear("", 4, 1, texels);
        let textures = Textures::new(&[], vec![image], Vec::new(), ColorMode::Spectral);
        let choice = Arc::new(Piecewise2D::new(&[1.0; 4], 4, 1));
        let sky = SkyImage { scale: [1.0; 3], picture_v, ..sky(MapLayout::LatitudeLongitude, choice) };
        sky.radiance_at(&textures, [0.5, 0.5], &spectral())
    };
    let [a, b] = [dark, bright].map(|rgb| radiance(vec![rgb; 4], [0.5, 0.25]));
    let between = |picture_v| radiance(vec![dark, dark, bright, bright], picture_v);
    for k in 0..4 {
        let apart = (0.5 * a.0[k] / 0.4 + 0.5 * b.0[k] / 8.0) * 4.2;
        assert!((between([0.5, 0.25]).0[k] / apart - 1.0).abs() < 1e-5);
        // Otherwise the colour is interpolated; at long wavelengths it is far from that.
        assert!(k < 3 || (between([1.0, 0.0]).0[k] / apart - 1.0).abs() > 0.1);
    }
}

/// A turned map of the first picture.
fn sky(layout: MapLayout, choice: Arc<Piecewise2D>) -> SkyImage {
    SkyImage {
        image: 0,
        scale: [1.0, 2.0, 0.5],
        layout,
        world_from_light: Mat3::from_rotation_x(0.7) * Mat3::from_rotation_y(2.0),
        complete: choice.clone(),
        compensated: choice,
        picture_v: [1.0, 0.0],
        mean: 0.0,
        sums: [0.0; 2],
    }
}

fn compare(layout: MapLayout, picture_v: [f32; 2], mode: &SpectralMode) {
    let (width, height) = (13, 7);
    let number = |k: u64| (hash::pair(k, 5) >> 40) as f32 / 16_777_216.0;
    let texels: Vec<[f32; 3]> =
        (0..width * height).map(|k| [number(3 * k), number(3 * k + 1), number(3 * k + 2) - 0.2]).collect();
    let weights: Vec<f32> = texels.iter().map(|texel| (texel[0] - 0.3).max(0.0)).collect();
    let image = Image::from_linear("", width as u32, height as u32, texels);
    let textures = Textures::new(&[], vec![image], Vec::new(), ColorMode::Spectral);
    let choice = Arc::new(Piecewise2D::new(&weights, width as usize, height as usize));
    let sky = SkyImage { picture_v, ..sky(layout, choice) };
    let sky_alone = Sky::Image(Box::new(sky.clone()));
    let unguided = Environment { sky: sky_alone, portal: None, illuminates: true, guide: None };
    // A guide that has seen the half of the sky with x > 0 from one half of the points.
    let points: Vec<GuidePoint> = (0..2000)
        .map(|k| Vec3::new(number(k) - 0.5, number(k + 2000), 0.0))
        .map(|point| GuidePoint { point, n: Vec3::Z, facing: Vec3::Z, transmits: false })
        .collect();
    let visibility = |queries: &[Query]| {
        let is_seen = |(index, wi): &Query| points[*index as usize].point.x > 0.0 && wi.x > 0.9;
        queries.iter().map(|query| f32::from(u8::from(is_seen(query)))).collect()
    };
    let with_guide = |environment: &Environment| {
        let guide = Guide::learn(environment, &textures, &points, &visibility, 3.0).expect("a guide");
        Environment { guide: Some(Arc::new(guide)), ..environment.clone() }
    };
    let guided = with_guide(&unguided);
    let even = |value: f32| {
        let color = textures.spectrum_texture(Color::gray(value), SpectrumType::Illuminant);
        EmissionSpectrum { color, scale: 1.0 }
    };
    let gradient = Sky::Gradient { zenith: even(0.5), horizon: even(2.0), nadir: even(0.0) };
    let gradient = with_guide(&Environment { sky: gradient, ..unguided.clone() });
    let mut with_histogram = 0;
    for (environment, round) in
        [unguided, guided, gradient].iter().flat_map(|sky| (0..2000).map(move |round| (sky, round)))
    {
        let light = Light::Environment(environment.clone());
        let points = by_lane!(lane => DVec3::new(f64::from(number(8 * round + lane as u64)) - 0.5, 0.5, 0.0));
        let u = [0, 1].map(|axis| by_lane!(lane => number(1000 + 16 * round + 2 * lane as u64 + axis)));
        let samples = Sample { mode, environment, points: &points, textures: &textures, u };
        let samples = dispatch(level(), samples).expect("all are sampled in lanes");
        let directions = by_lane!(lane => Vec3::from_array(samples.wi[lane]));
        let seen = sky.seen(&textures, &directions, &[mode; LANES], 0xff);
        for lane in 0..LANES {
            let at = LightSampleContext { point: points[lane], n: Vec3::Z, time: 0.0 };
            let histogram = environment.histogram(&at);
            with_histogram += u32::from(histogram.is_some());
            let alone = light.sample(&textures, &at, [u[0][lane], u[1][lane]], mode, IncompletePdf::Allowed);
            assert_eq!(samples.is_usable(lane), alone.is_some());
            if let Some(alone) = alone {
                let one_of_eight = (samples.wi[lane], samples.li[lane], samples.pdf[lane]);
                assert_eq!(one_of_eight, (alone.wi.to_array(), alone.li, alone.pdf));
            }
            if environment.map_in_lanes().is_none() {
                continue;
            }
            let wi = directions[lane];
            let alone = environment.radiance(&textures, DVec3::ZERO, wi, mode);
            assert_eq!(
                (seen.li[lane], environment.mixed_pdf(histogram, wi, seen.pdf[lane])),
                (alone, light.pdf(&at, wi, None, IncompletePdf::Allowed))
            );
        }
    }
    // All of the guided lanes have one, and none of the others.
    assert_eq!(with_histogram, 2 * 8 * 2000);
}
