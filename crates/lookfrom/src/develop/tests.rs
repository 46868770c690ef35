//! Are the bytes those of the curve?

use super::*;
use crate::hash::mix;

const ALL: [Tonemap; 3] = [Tonemap::Clamp, Tonemap::Reinhard, Tonemap::Filmic];

fn develop(rgb: [f32; 3], exposure: f32, tonemap: Tonemap) -> [u8; 3] {
    let bytes = srgb8(&Picture { width: 1, height: 1, pixels: vec![rgb] }, exposure, tonemap);
    bytes.try_into().unwrap()
}

#[test]
fn known_values() {
    let grey = |x: f32, exposure, tonemap| develop([x; 3], exposure, tonemap)[1];
    let clamp = |x| grey(x, 0.0, Tonemap::Clamp);
    // 18 % grey is 118, half the light 188; 10 lies where the line meets the curve.
    assert_eq!([0.0, 0.0031308, 0.18, 0.5, 1.0, 7.0].map(clamp), [0, 10, 118, 188, 255, 255]);
    assert_eq!(grey(0.09, 1.0, Tonemap::Clamp), 118);
    assert_eq!(grey(4.0, -3.0, Tonemap::Clamp), 188);
    assert_eq!(grey(1.0, 0.0, Tonemap::Reinhard), 188);
    // The filmic curve at 1 is 2.54 / 3.16 = 0.8038, and 255 times the curve of that 231.6.
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
    // Around each threshold, and anywhere by random exponents.
    for threshold in thresholds {
        for bits in threshold.to_bits() - 200..=(threshold.to_bits() + 200).min(1.0_f32.to_bits()) {
            let value = f32::from_bits(bits);
            assert_eq!(fast(value), encode(value), "{value}");
        }
    }
    for trial in 0..200_000 {
        let value = f32::from_bits(mix(trial) as u32 % (1.0_f32.to_bits() + 1));
        assert_eq!(fast(value), encode(value), "{value}");
    }
}

#[test]
fn more_light_is_never_darker() {
    for tonemap in ALL {
        let light: Vec<_> =
            (0..=0x7f80_0000_u32).step_by(50_021).map(|bits| [f32::from_bits(bits); 3]).collect();
        let picture = Picture { width: light.len() as u32, height: 1, pixels: light };
        for exposure in [-20.0, 0.0, 3.5, 200.0] {
            let bytes = srgb8(&picture, exposure, tonemap);
            assert!(bytes.is_sorted(), "{tonemap:?} {exposure}");
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
