use lookfrom_scene::spectrum::{CameraSensor, Curve, swatches};

use super::super::standard_illuminant;
use super::*;

/// The standard observer.
fn balanced(imaging_ratio: f32, white_balance: Option<f32>) -> Sensor {
    Sensor::new(&Settings { imaging_ratio, white_balance, ..Settings::default() })
}

fn camera(name: &str, white_balance: Option<f32>) -> Sensor {
    let camera = CameraSensor::named(name);
    assert!(camera.is_some(), "{name}");
    Sensor::new(&Settings { camera, white_balance, ..Settings::default() })
}

fn far(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f32::max)
}

/// The response of a sensor to a light, by sampled wavelengths.
fn seen(sensor: &Sensor, light: &DenselySampledSpectrum) -> [f32; 3] {
    let count = 20_000;
    let mut rgb = [0.0; 3];
    for u in (0..count).map(|i| (i as f32 + 0.5) / count as f32) {
        let wavelengths = Wavelengths::sample_visible(u);
        for (sum, value) in rgb.iter_mut().zip(sensor.rgb(light.at(&wavelengths.lambda), &wavelengths)) {
            *sum += value / count as f32;
        }
    }
    rgb
}

#[test]
fn sensors_balance_and_expose() {
    for kelvin in [2856.0, 5000.0, 6500.0, 12_000.0] {
        let sensor = balanced(2.0, Some(kelvin));
        let light = DenselySampledSpectrum::from(&daylight(kelvin));
        let light = light.scaled(1.0 / light.to_xyz()[1]);
        assert!(far(seen(&sensor, &light), [2.0; 3]) < 5e-3, "{kelvin}: {:?}", seen(&sensor, &light));
        // A colour of RGB mode is converted in the same way.
        assert!(far(sensor.balanced(light.to_rgb()), [2.0; 3]) < 1e-4, "{kelvin}");
    }
    let plain = balanced(1.5, None);
    assert!(far(plain.balanced([0.2, 0.7, 0.1]), [0.3, 1.05, 0.15]) < 1e-6);
    assert!(balanced(1.0, Some(1e-3)).balanced([0.5; 3]).iter().all(|value| value.is_finite()));
}

#[test]
fn cameras_are_calibrated_as_pbrts() {
    // Computed independently in f64, with other loops; tables go on with their first and last values.
    for (name, kelvin, expected) in [
        (
            "canon_eos_5d_mkiv",
            5000.0,
            [[1.634995, 0.001697, 0.283669], [0.580137, 1.068949, -0.450623], [0.18663, -0.729499, 2.657763]],
        ),
        (
            "nikon_d850",
            6500.0,
            [
                [1.618579, 0.262282, 0.164286],
                [0.701496, 1.065578, -0.254194],
                [0.190852, -0.437623, 1.994711],
            ],
        ),
    ] {
        let responses = CameraSensor::named(name).expect("a camera").responses();
        let responses = responses.map(|response| *DenselySampledSpectrum::from(&response).samples());
        let found = calibration::xyz_from_camera(&responses, kelvin);
        for (found, expected) in found.as_flattened().iter().zip(expected.as_flattened()) {
            assert!((found - expected).abs() < 2e-5, "{name}: {found} ≠ {expected}");
        }
    }
}

/// As [`seen`], without sampling: at each nm in four lanes.
fn integrated(sensor: &Sensor, light: &DenselySampledSpectrum) -> [f32; 3] {
    let at = |i: usize, channel: usize| f64::from(4.0 * sensor.responses[i][channel] * light.samples()[i]);
    [0, 1, 2].map(|channel| (0..SAMPLES).map(|i| at(i, channel)).sum::<f64>() as f32)
}

#[test]
fn cameras_show_the_swatches_as_the_eye_sees_them() {
    let lit = |swatch: &Curve, light: &DenselySampledSpectrum| {
        let swatch = DenselySampledSpectrum::from(swatch);
        DenselySampledSpectrum::from_samples(std::array::from_fn(|i| {
            swatch.samples()[i] * light.samples()[i]
        }))
    };
    for (name, kelvin) in
        CameraSensor::all().map(CameraSensor::name).zip([3200.0, 5000.0, 6500.0, 9000.0].into_iter().cycle())
    {
        let sensor = camera(name, Some(kelvin));
        let light = DenselySampledSpectrum::from(&daylight(kelvin));
        let light = light.scaled(1.0 / light.to_xyz()[1]);
        let mut error = 0.0;
        for swatch in swatches() {
            let expected = lit(&swatch, standard_illuminant()).to_rgb();
            error += far(integrated(&sensor, &lit(&swatch, &light)), expected) / 24.0;
        }
        assert!(error < 0.04, "{name}, {kelvin}: {error}");
    }
    // In RGB mode, where D65 is the white of the scene.
    let sensor = camera("nikon_d810", Some(6500.0));
    for grey in [0.2, 0.9] {
        assert!(far(sensor.balanced([grey; 3]), [grey; 3]) < 0.03 * grey, "{:?}", sensor.balanced([grey; 3]));
    }
}

#[test]
fn a_camera_without_a_white_balance_has_daylights() {
    let [said, silent, cold] = [Some(6500.0), None, Some(1e-3)].map(|kelvin| camera("sony_ilce_9", kelvin));
    assert_eq!((&said.responses, &said.channels_from_rgb), (&silent.responses, &silent.channels_from_rgb));
    assert_eq!(said.responses, cold.responses, "light too cold to be seen");
}

#[test]
fn channels_are_what_the_camera_measures() {
    let settings =
        Settings { camera: CameraSensor::named("canon_eos_m"), imaging_ratio: 3.0, ..Settings::default() };
    let sensor = Sensor::new(&settings);
    let responses = settings.camera.expect("one").responses();
    // A laser of luminous density 1 at 540 nm; only one lane is in use.
    let mut wavelengths = Wavelengths::new([540.0; 4], [1.0; 4]);
    wavelengths.terminate_secondary();
    let rgb = sensor.rgb(Spectrum([1.0, 0.0, 0.0, 0.0]), &wavelengths);
    assert!(rgb[0] < 0.0 && rgb[1] > 0.0, "{rgb:?}");
    let expected = responses.map(|response| 3.0 * response.at(540.0) / observer::Y_INTEGRAL as f32);
    assert!(far(sensor.channels(rgb), expected) < 1e-6, "{:?} ≠ {expected:?}", sensor.channels(rgb));
    // The standard observer's channels are X, Y and Z before the balance.
    assert_eq!(Sensor::default().variance_from_rgb(), &space::XYZ_FROM_RGB);
    let [plain, warm] = [None, Some(3000.0)].map(|kelvin| balanced(1.0, kelvin));
    let [a, b] =
        [plain, warm].map(|sensor| sensor.channels(sensor.rgb(Spectrum([1.0, 0.0, 0.0, 0.0]), &wavelengths)));
    assert!(far(a, b) < 1e-6, "{a:?} ≠ {b:?}");
}
