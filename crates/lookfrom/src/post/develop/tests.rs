//! Tests of exposure, tone maps and encoding.

use super::*;
use crate::core::hash::mix;

const ALL: [Tonemap; 6] =
    [Tonemap::Clamp, Tonemap::Reinhard, Tonemap::Filmic, Tonemap::PbrNeutral, Tonemap::Aces, Tonemap::Agx];

fn develop(rgb: [f32; 3], exposure: f32, tonemap: Tonemap) -> [u8; 3] {
    let bytes =
        srgb8(&Picture { width: 1, height: 1, pixels: vec![rgb], alpha: Vec::new() }, exposure, tonemap);
    bytes.try_into().unwrap()
}

#[test]
fn known_values() {
    let grey = |x: f32, exposure, tonemap| develop([x; 3], exposure, tonemap)[1];
    let clamp = |x| grey(x, 0.0, Tonemap::Clamp);
    // 18 % grey is 118, half the light 188; 10 lies where the linear part meets the power function.
    assert_eq!([0.0, 0.0031308, 0.18, 0.5, 1.0, 7.0].map(clamp), [0, 10, 118, 188, 255, 255]);
    assert_eq!(grey(0.09, 1.0, Tonemap::Clamp), 118);
    assert_eq!(grey(4.0, -3.0, Tonemap::Clamp), 188);
    assert_eq!(grey(1.0, 0.0, Tonemap::Reinhard), 188);
    // The filmic curve at 1 is 2.54 / 3.16 = 0.8038, and 255 times the sRGB curve of that is 231.6.
    assert_eq!(grey(1.0, 0.0, Tonemap::Filmic), 232);
}

#[test]
fn every_byte_comes_back_from_its_own_light() {
    for byte in 0..=255_u8 {
        let bent = f64::from(byte) / 255.0;
        let linear = if bent <= 0.04045 { bent / 12.92 } else { ((bent + 0.055) / 1.055).powf(2.4) };
        assert_eq!(develop([linear as f32; 3], 0.0, Tonemap::Clamp), [byte; 3]);
    }
}

#[test]
fn reinhard_keeps_the_hue() {
    let [r, g, b] = display([0.2, 0.4, 0.1], scale(2.0), Tonemap::Reinhard);
    assert!((g / r - 2.0).abs() < 1e-6 && (r / b - 2.0).abs() < 1e-6);
}

#[test]
fn thresholds_agree_with_the_curve() {
    let thresholds = thresholds();
    let fast = |value: f32| thresholds.partition_point(|&t| t <= value) as u8;
    // Around each threshold, and at values of random exponents.
    for threshold in thresholds {
        for bits in threshold.to_bits() - 200..=(threshold.to_bits() + 200).min(1.0_f32.to_bits()) {
            let value = f32::from_bits(bits);
            assert_eq!(fast(value), encode(value), "{value}");
        }
    }
    for trial in 0..200_000_u64 {
        let value = f32::from_bits(mix(trial) as u32 % (1.0_f32.to_bits() + 1));
        assert_eq!(fast(value), encode(value), "{value}");
    }
}

#[test]
fn more_light_is_never_darker() {
    for tonemap in ALL {
        let light: Vec<_> =
            (0..=0x7f80_0000_u32).step_by(50_021).map(|bits| [f32::from_bits(bits); 3]).collect();
        let picture = Picture { width: light.len() as u32, height: 1, pixels: light, alpha: Vec::new() };
        for exposure in [-20.0, 0.0, 3.5, 200.0] {
            let bytes = srgb8(&picture, exposure, tonemap);
            for channel in 0..3 {
                let of_channel = bytes.iter().skip(channel).step_by(3);
                assert!(of_channel.is_sorted(), "{tonemap:?} {exposure} {channel}");
            }
        }
    }
}

#[test]
fn nonsense_is_black_or_white() {
    for tonemap in ALL {
        for exposure in [0.0, f32::INFINITY, f32::NEG_INFINITY, f32::NAN, 1e30] {
            let bytes = develop([f32::NAN, f32::NEG_INFINITY, -1.0], exposure, tonemap);
            assert_eq!(bytes, [0; 3], "{tonemap:?} {exposure}");
        }
        assert_eq!(develop([f32::INFINITY; 3], 0.0, tonemap), [255; 3]);
        assert_eq!(develop([f32::MAX; 3], f32::INFINITY, tonemap), [255; 3]);
        assert_eq!(develop([0.0; 3], f32::INFINITY, tonemap), [0; 3]);
    }
}

#[test]
fn pbr_neutral_takes_the_offset_away_and_leaves_the_rest_to_the_start_of_compression() {
    let map = |rgb| tonemap::mapped(rgb, Tonemap::PbrNeutral);
    let near = |a: [f64; 3], b: [f64; 3]| a.into_iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
    // Beyond 0.08 the offset is F90, and 0.8 − F90 is where compression starts.
    for rgb in [[0.5, 0.2, 0.1], [0.09; 3], [0.8, 0.79, 0.081]] {
        assert!(near(map(rgb), rgb.map(|x| x - 0.04)), "{rgb:?}");
    }
    // Below that it is x − x² / (4 F90): a colour in which one primary is 0 stays as it is.
    assert!(near(map([0.7, 0.3, 0.0]), [0.7, 0.3, 0.0]));
    assert!(near(map([0.04; 3]), [0.01; 3]) && near(map([0.08; 3]), [0.04; 3]));
    // A white of 1 by hand: p = 0.96, pₙ = 1 − 0.24² / 0.44 = 0.869091, and grey has no saturation to lose.
    assert!(near(map([1.0; 3]), [1.0 - 0.0576 / 0.44; 3]));
    // A red of 4: pₙ = 1 − 0.0576 / 3.48, g = 1 / (0.15 (4 − pₙ) + 1).
    let peak = 1.0 - 0.0576 / 3.48;
    let kept = 1.0 / (0.15 * (4.0 - peak) + 1.0);
    assert!(near(map([4.0, 0.0, 0.0]), [peak, peak * (1.0 - kept), peak * (1.0 - kept)]));
    // Continuous where compression starts.
    let [below, above] = [0.8 - 1e-9, 0.8 + 1e-9].map(|x| map([x, 0.3, 0.2]));
    assert!(below.into_iter().zip(above).all(|(a, b)| (a - b).abs() < 1e-8));
}

#[test]
fn aces_and_agx_at_points_of_their_curves() {
    let grey = |x: f64, tonemap| tonemap::mapped([x; 3], tonemap);
    // Hill's curve of 1 is (1.0245786 − 0.000090537) / 1.654761 = 0.619115, his matrices leave grey as it is.
    let near =
        |rgb: [f64; 3], expected: f64, slack: f64| rgb.into_iter().all(|x| (x - expected).abs() < slack);
    assert!(near(grey(1.0, Tonemap::Aces), 0.619115, 2e-4), "{:?}", grey(1.0, Tonemap::Aces));
    assert!(near(grey(1e9, Tonemap::Aces), 1.0 / 0.983729, 2e-3), "{:?}", grey(1e9, Tonemap::Aces));
    // The pivot of AgX's curve is middle grey, which it shows as half of what its 2.2 decodes; 16.29 is the end.
    assert!(near(grey(0.18, Tonemap::Agx), 0.217_638, 0.005), "{:?}", grey(0.18, Tonemap::Agx));
    assert!(near(grey(16.29, Tonemap::Agx), 1.0, 0.01), "{:?}", grey(16.29, Tonemap::Agx));
    assert!(near(grey(0.0001, Tonemap::Agx), 0.0, 1e-3));
    // Bright saturated light goes to white in both; clamped, it would stay saturated.
    for tonemap in [Tonemap::Aces, Tonemap::Agx] {
        let [r, g, b] = tonemap::mapped([0.02, 0.02, 50.0], tonemap);
        assert!(r > 0.2 && g > 0.2 && b > g, "{tonemap:?} {r} {g} {b}");
    }
}

#[test]
fn colours_of_a_transparent_picture_are_divided_by_their_alpha() {
    let pixels = vec![[0.25, 0.5, 0.0], [0.1; 3], [0.0; 3], [0.5; 3]];
    let picture = Picture { width: 2, height: 2, pixels, alpha: vec![0.5, 0.0, -0.01, 1.01] };
    let bytes = srgba8(&picture, 0.0, Tonemap::Clamp);
    assert_eq!(bytes, [188, 255, 0, 128, 0, 0, 0, 0, 0, 0, 0, 0, 188, 188, 188, 255]);
    // The background is composited by alpha, and not changed by the tone map.
    let before = |tonemap, exposure| srgb8_before(&picture, [1.0, 0.5, 0.0], exposure, tonemap);
    let bytes = before(Tonemap::Clamp, 0.0);
    assert_eq!(bytes, [225, 225, 0, 255, 188, 0, 255, 188, 0, 188, 188, 188]);
    assert_eq!(before(Tonemap::PbrNeutral, 3.0)[3..9], [255, 188, 0, 255, 188, 0]);
}
