use lookfrom_scene::image::read_exr;
use lookfrom_scene::settings::Sensor as Settings;
use lookfrom_scene::spectrum::{Curve, named};
use lookfrom_scene::{Disk, LoadContext};
use proptest::prelude::*;

use super::table::Table;
use super::*;

/// The colour of a reflectance under D65, by summing over each nm.
fn color_of(at: impl Fn(&[f32; 4]) -> Spectrum) -> [f32; 3] {
    let light = standard_illuminant().samples();
    let lit = std::array::from_fn(|i| at(&[360.0 + i as f32; 4]).0[0] * light[i]);
    DenselySampledSpectrum::from_samples(lit).to_rgb()
}

/// The largest difference of two colours.
fn far(a: [f32; 3], b: [f32; 3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// A lattice over the cube including its faces.
fn cube(steps: usize) -> impl Iterator<Item = [f32; 3]> {
    let level = move |i: usize| i as f32 / (steps - 1) as f32;
    (0..steps.pow(3)).map(move |i| [level(i % steps), level(i / steps % steps), level(i / steps / steps)])
}

/// Evenly spaced numbers in [0, 1).
fn even(count: usize) -> impl Iterator<Item = f32> {
    (0..count).map(move |i| (i as f32 + 0.5) / count as f32)
}

#[test]
fn exact_spectra_have_their_colors() {
    let hard =
        [[1.0, 0.999, 0.9999], [0.99999, 1.0, 1.0], [1e-4, 0.0, 0.0], [0.0, 0.0, 1e-3], [0.02, 3e-4, 0.0]];
    for rgb in cube(13).chain(hard) {
        let sigmoid = Sigmoid::exact_from_rgb(rgb);
        let error = far(color_of(|lambda| sigmoid.at(lambda)), rgb);
        // Near white, the last digit of the coefficients has a larger effect.
        assert!(error < if rgb[0] < 0.999 { 1e-5 } else { 2e-5 }, "{rgb:?}: {error:e} by {sigmoid:?}");
    }
}

#[test]
fn spectra_by_the_table_have_nearly_their_colors() {
    // The errors are those of pbrt-v4's interpolation.
    let mut errors: Vec<f32> = cube(17)
        .map(|rgb| {
            let sigmoid = Sigmoid::from_rgb(rgb);
            far(color_of(|lambda| sigmoid.at(lambda)), rgb)
        })
        .collect();
    errors.sort_by(f32::total_cmp);
    let quantile = |part: f32| errors[(part * (errors.len() - 1) as f32) as usize];
    assert!(quantile(0.5) < 5e-4 && quantile(0.99) < 1.5e-3 && quantile(1.0) < 4e-3, "{:?}", errors.last());
}

#[test]
fn the_table_agrees_with_the_published_one() {
    // Interpolated from the coefficients that Jakob and Hanika's program finds, as Mitsuba 3.9 ships them
    for (rgb, expected) in [
        ([0.63, 0.065, 0.05], [6.544733, 6.2396736, -0.5033485]),
        ([0.14, 0.45, 0.091], [-8.320593, -3.6731198, -0.48030567]),
        ([1.0, 0.378676, 0.013473], [-0.798203, 3.5492032, 0.5728794]),
        ([0.725, 0.71, 0.68], [-0.10990808, 0.08398151, 0.48624846]),
        ([0.5, 0.5, 0.8], [2.5012627, 0.35493082, -0.039247837]),
        ([0.4, 0.2, 0.2], [1.8071774, 1.5455525, -0.47653157]),
        ([0.33, 0.258, 0.15], [-0.7056289, 0.37176955, -0.4380078]),
        ([0.8, 0.0, 0.0], [16.0217, 15.962912, -0.49526674]),
        ([0.0, 0.5, 0.0], [-22.828478, -10.350009, -1.0080937]),
        ([0.0, 0.0, 0.3], [-25.54254, -33.067642, -11.029785]),
        ([0.01, 0.002, 0.003], [15.288826, 11.040028, -8.234304]),
    ] {
        let found = Sigmoid::from_rgb(rgb).0;
        assert!(
            far(found, expected) < 3e-5 * expected[0].abs().max(1.0),
            "{rgb:?}: {found:?} ≠ {expected:?}"
        );
    }
}

#[test]
#[ignore = "needs LOOKFROM_SHARED"]
fn the_walls_of_the_cornell_box_are_those_of_pbrt() {
    let path = lookfrom_test_data::shared("reference/cornell-box.exr");
    let picture = read_exr(&path, &mut LoadContext::new(&Disk)).unwrap();
    // The mean of all pixels that are close to a colour; pbrt's albedo is seen under D65.
    let mean = |layer: &str, near: [f32; 3]| {
        let channels = ["R", "G", "B"].map(|name| picture.channel(&format!("{layer}{name}")).unwrap());
        let (mut sum, mut count) = ([0.0; 3], 0.0);
        for i in 0..channels[0].len() {
            let pixel = channels.map(|values| values[i]);
            if pixel.iter().zip(near).all(|(value, near)| (value / near - 1.0).abs() < 0.05) {
                sum = std::array::from_fn(|c| sum[c] + f64::from(pixel[c]));
                count += 1.0;
            }
        }
        assert!(count > 100.0, "{layer} {near:?}: {count} pixels");
        sum.map(|sum| (sum / count) as f32)
    };
    for rgb in [[0.63, 0.065, 0.05], [0.14, 0.45, 0.091], [0.725, 0.71, 0.68]] {
        let sigmoid = Sigmoid::from_rgb(rgb);
        let (ours, theirs) = (color_of(|lambda| sigmoid.at(lambda)), mean("Albedo.", rgb));
        for (ours, theirs) in ours.into_iter().zip(theirs) {
            assert!((ours / theirs - 1.0).abs() < 6e-4, "{rgb:?}: {ours} ≠ {theirs}");
        }
    }
    let light = Unbounded::from_rgb([17.0, 12.0, 4.0]);
    let (ours, theirs) = (color_of(|lambda| light.at(lambda)), mean("", [17.0, 12.0, 4.0]));
    assert!(far(ours, theirs) < 0.1, "{ours:?} ≠ {theirs:?}");
}

#[test]
fn greys_are_constant() {
    let lambda = [360.0, 500.0, 641.7, 830.0];
    for (v, tolerance) in [(0.0, 0.0), (1e-30, 1e-7), (1e-3, 1e-7), (0.5, 0.0), (0.893289, 1e-7), (1.0, 0.0)]
    {
        for sigmoid in [Sigmoid::from_rgb([v; 3]), Sigmoid::exact_from_rgb([v; 3]), Sigmoid::constant(v)] {
            assert!(
                sigmoid.at(&lambda).0.iter().all(|found| (found - v).abs() <= tolerance),
                "{v}: {sigmoid:?}"
            );
        }
    }
}

#[test]
fn the_table_has_no_seams() {
    let lambda = [420.0, 490.0, 560.0, 630.0];
    let seams =
        [[0.5, 0.5, 0.2], [0.5, 0.1, 0.5], [0.3, 0.9, 0.9], [0.7, 0.35, 0.35 * 22.0 / 63.0], [1.0, 0.6, 0.6]];
    for rgb in seams.into_iter().chain(cube(4)) {
        let near = |shift: usize| {
            let mut moved = rgb;
            moved[shift % 3] *= if shift < 3 { 1.0 - 1e-4 } else { 1.0 + 1e-4 };
            Sigmoid::from_rgb(moved).at(&lambda)
        };
        let here = Sigmoid::from_rgb(rgb).at(&lambda);
        // Greys are exact and their neighbours are not: a step of the size of the table's error is pbrt's, too.
        for shift in 0..6 {
            let step = here.zip(near(shift), |a, b| (a - b).abs()).max_lane();
            assert!(step < 2e-3, "{rgb:?} by {shift}: {step}");
        }
    }
}

#[test]
fn the_order_of_questions_does_not_matter() {
    let colors: Vec<[f32; 3]> = cube(5).filter(|[r, g, b]| r != g || g != b).collect();
    let (first, second) = (Table::new(), Table::new());
    let forwards: Vec<_> = colors.iter().map(|&rgb| first.coefficients(rgb)).collect();
    let mut backwards: Vec<_> = colors.iter().rev().map(|&rgb| second.coefficients(rgb)).collect();
    backwards.reverse();
    assert_eq!(forwards, backwards);
    // Neither do concurrent lookups, nor cached solutions.
    let third = Table::new();
    let ask = || colors.iter().map(|&rgb| third.coefficients(rgb)).collect::<Vec<_>>();
    let (a, b) = rayon::join(ask, ask);
    assert!(a == forwards && b == forwards && ask() == forwards);
}

#[test]
fn colors_have_the_same_bits_everywhere() {
    // FNV-1a over everything that reaches a pixel.
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut feed = |values: &[f32]| {
        for byte in values.iter().flat_map(|value| value.to_bits().to_le_bytes()) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    };
    let sensor = Sensor::new(&Settings { white_balance: Some(5000.0), ..Settings::default() });
    for (rgb, u) in cube(6).zip(even(216)) {
        let wavelengths = Wavelengths::sample_visible(u);
        feed(&wavelengths.lambda);
        let light =
            Unbounded::from_rgb(rgb).at(&wavelengths.lambda) * standard_illuminant().at(&wavelengths.lambda);
        feed(&light.0);
        feed(&Sigmoid::exact_from_rgb(rgb).at(&wavelengths.lambda).0);
        feed(&sensor.rgb(light, &wavelengths));
    }
    let lamp = DenselySampledSpectrum::from(&Curve::Blackbody { kelvin: 3000.0 });
    feed(lamp.samples());
    assert_eq!(hash, 0x74be_0dcf_1dd3_239a, "{hash:#018x}");
}

#[test]
fn unbounded_colors_keep_their_size() {
    for rgb in [[17.0, 12.0, 4.0], [0.200438, 0.924033, 1.102212], [3039.6353; 3], [0.0, 0.0, 2e-4]] {
        let size = rgb.iter().copied().fold(0.0, f32::max);
        let exact = Unbounded::exact_from_rgb(rgb);
        assert!(far(color_of(|lambda| exact.at(lambda)), rgb) < 1e-5 * size, "{rgb:?}");
        let table = Unbounded::from_rgb(rgb);
        assert!(far(color_of(|lambda| table.at(lambda)), rgb) < 1.5e-3 * size, "{rgb:?}");
        assert_eq!(table.scale, 2.0 * size);
    }
    assert!(Unbounded::from_rgb([0.0; 3]).at(&[500.0; 4]).is_black());
}

#[test]
fn wavelengths_have_their_densities() {
    let lambda_of = |u: f32| Wavelengths::sample_visible(u).lambda[0];
    assert!((lambda_of(0.0) - 360.0).abs() < 1e-2 && (lambda_of(0.999_999_94) - 830.0).abs() < 1e-2);
    const CELLS: u16 = 2048;
    for u in (0..CELLS).map(|cell| (f32::from(cell) + 0.5) / f32::from(CELLS)) {
        let wavelengths = Wavelengths::sample_visible(u);
        // The density is the inverse slope of the map from u to the wavelength, constant within a cell.
        let step = 0.4 / f32::from(CELLS);
        let stretched = (lambda_of(u + step) - lambda_of(u - step)) / (2.0 * step);
        assert!((wavelengths.pdf[0] * stretched - 1.0).abs() < 3e-3, "{u}: {wavelengths:?}");
        let cosh = libm::cosh(0.0072 * (f64::from(wavelengths.lambda[0]) - 538.0));
        // It follows the curve up to the width of a cell.
        assert!((f64::from(wavelengths.pdf[0]) * cosh * cosh / 0.003_939_804_2 - 1.0).abs() < 0.01);
        // The lanes are a quarter apart.
        for (lane, shift) in [0.25, 0.5, 0.75].into_iter().enumerate() {
            let other = Wavelengths::sample_visible((u + shift).fract());
            assert!((wavelengths.lambda[lane + 1] - other.lambda[0]).abs() < 2e-3);
        }
    }
    // The density integrates to one.
    let total: f32 = even(4096).map(|u| 1.0 / Wavelengths::sample_visible(u).pdf[0]).sum::<f32>() / 4096.0;
    assert!((total - 470.0).abs() < 0.1, "{total}");
}

#[test]
fn estimates_have_the_colors_of_the_light_as_their_mean() {
    let count = 20_000;
    let (light, sensor) = (standard_illuminant(), Sensor::default());
    for dispersed in [false, true] {
        let (mut xyz, mut rgb) = ([0.0; 3], [0.0; 3]);
        for u in even(count) {
            let mut wavelengths = Wavelengths::sample_visible(u);
            if dispersed {
                wavelengths.terminate_secondary();
                wavelengths.terminate_secondary();
                assert!(wavelengths.secondary_terminated());
            }
            let radiance = light.at(&wavelengths.lambda);
            for (sum, value) in xyz.iter_mut().zip(xyz_of(radiance, &wavelengths)) {
                *sum += value / count as f32;
            }
            for (sum, value) in rgb.iter_mut().zip(sensor.rgb(radiance, &wavelengths)) {
                *sum += value / count as f32;
            }
        }
        assert!(far(xyz, light.to_xyz()) < 1e-3, "{xyz:?} ≠ {:?}", light.to_xyz());
        assert!(far(rgb, [1.0; 3]) < 2e-3, "{rgb:?}");
        assert!(far(rgb_from_xyz(xyz), rgb) < 1e-4);
    }
}

#[test]
fn curves_are_sampled_at_the_nearest_nm() {
    let dense = DenselySampledSpectrum::from_samples(std::array::from_fn(|i| 360.0 + i as f32));
    assert_eq!(dense.at(&[360.0, 500.49, 500.5, 830.4]).0, [360.0, 500.0, 501.0, 830.0]);
    assert_eq!(dense.at(&[359.4, 830.5, f32::NAN, -1e30]).0, [0.0; 4]);
    assert_eq!(dense.max(), 830.0);
    assert_eq!(dense.scaled(2.0).at(&[400.0; 4]).0, [800.0; 4]);
}

#[test]
fn colors_of_curves_in_rgb_mode() {
    let dense = |name: &str| DenselySampledSpectrum::from(&named(name).unwrap());
    assert!(far(dense("stdillum-D65").to_rgb(), [1.0; 3]) < 1e-6);
    assert!((dense("stdillum-A").y_integral() - 106.856895).abs() < 1e-3);
    assert!(far(DenselySampledSpectrum::from(&Curve::Constant(0.3)).to_rgb_reflectance(), [0.3; 3]) < 1e-6);
    // A sketch of gold: little refraction and strong absorption of red.
    let (eta, k) = (dense("metal-Au-eta").to_rgb_reflectance(), dense("metal-Au-k").to_rgb_reflectance());
    assert!(far(eta, [0.08, 0.40, 1.56]) < 0.01 && far(k, [3.39, 2.50, 1.77]) < 0.01, "{eta:?} {k:?}");
    let xyz = xyz_from_rgb([1.0; 3]);
    assert!(far(xyz, [0.9505, 1.0, 1.0888]) < 2e-4, "{xyz:?}");
    assert!(far(rgb_from_xyz(xyz_from_rgb([0.1, 0.7, 0.3])), [0.1, 0.7, 0.3]) < 1e-6);
}

/// Any finite number, with all exponents equally likely, or one within [0, 1].
fn component() -> impl Strategy<Value = f32> {
    prop_oneof![any::<u32>().prop_map(f32::from_bits), 0.0..=1.0_f32, Just(0.0), Just(1.0)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn no_color_is_without_a_spectrum(rgb in prop::array::uniform3(component()), lambda in 360.0..=830.0_f32) {
        let lambda = [lambda, 360.0, 830.0, 555.0];
        for sigmoid in [Sigmoid::from_rgb(rgb), Sigmoid::exact_from_rgb(rgb)] {
            let values = sigmoid.at(&lambda).0;
            prop_assert!(values.iter().all(|value| (0.0..=1.0).contains(value)), "{:?}: {:?}", sigmoid, values);
        }
        for unbounded in [Unbounded::from_rgb(rgb), Unbounded::exact_from_rgb(rgb)] {
            let values = unbounded.at(&lambda).0;
            prop_assert!(values.iter().all(|value| value.is_finite() && *value >= 0.0), "{:?}", unbounded);
        }
    }

    #[test]
    fn exact_spectra_are_exact_anywhere(rgb in prop::array::uniform3(0.0..=1.0_f32), exponent in -12.0..=0.0_f32) {
        let size = libm::exp2f(exponent);
        let rgb = rgb.map(|component| component * size);
        let sigmoid = Sigmoid::exact_from_rgb(rgb);
        prop_assert!(far(color_of(|lambda| sigmoid.at(lambda)), rgb) < 2e-5, "{:?} {:?}", rgb, sigmoid);
    }
}
