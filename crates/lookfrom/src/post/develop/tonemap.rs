//! Tone maps: one function each, on linear Rec. 709.
//!
//! Khronos PBR Neutral (specification of 2024, github.com/KhronosGroup/ToneMapping); ACES 1.0 (the reference and output
//! transforms for sRGB as Stephen Hill fitted them); AgX (Troy Sobotka 2022; the matrices are those of Blender, in Rec.
//! 2020, and the curve of its default look is Benjamin Wrensch's polynomial); Reinhard, Stark, Shirley & Ferwerda 2002;
//! Narkowicz 2015 (a fit to the filmic curve of ACES).

use lookfrom_scene::settings::Tonemap;

/// The tone-mapped colour, linear, to be clamped to 0 … 1. Red, green and blue must be at least 0 and finite.
pub(super) fn mapped(rgb: [f64; 3], tonemap: Tonemap) -> [f64; 3] {
    match tonemap {
        Tonemap::Clamp => rgb,
        Tonemap::Reinhard => {
            let luminance = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
            rgb.map(|x| x / (1.0 + luminance))
        }
        Tonemap::Filmic => rgb.map(|x| (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14)),
        Tonemap::PbrNeutral => pbr_neutral(rgb),
        Tonemap::Aces => aces(rgb),
        Tonemap::Agx => agx(rgb),
    }
}

/// Reflectance at normal incidence of most dielectrics, which renderers add to the base colour and this map subtracts
/// again.
const F90: f64 = 0.04;
/// The value from which highlights are compressed.
const COMPRESSION_START: f64 = 0.8 - F90;
/// The rate of their desaturation.
const DESATURATION: f64 = 0.15;

fn pbr_neutral(rgb: [f64; 3]) -> [f64; 3] {
    // Subtract the specular reflection; less for dark colours, so that none becomes negative.
    let least = rgb.into_iter().fold(f64::INFINITY, f64::min);
    let offset = if least <= 2.0 * F90 { least - least * least / (4.0 * F90) } else { F90 };
    let rgb = rgb.map(|x| x - offset);
    let peak = rgb.into_iter().fold(0.0, f64::max);
    if peak <= COMPRESSION_START {
        return rgb;
    }

    // Compress the largest channel below 1, and desaturate by the amount of compression.
    let room = 1.0 - COMPRESSION_START;
    let lower_peak = 1.0 - room * room / (peak + room - COMPRESSION_START);
    let kept = 1.0 / (DESATURATION * (peak - lower_peak) + 1.0);
    rgb.map(|x| x * (lower_peak / peak) * kept + lower_peak * (1.0 - kept))
}

/// From Rec. 709 to the AP1 primaries, with the reference transform's desaturation.
const ACES_INPUT: [[f64; 3]; 3] =
    [[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]];
/// Back to Rec. 709.
const ACES_OUTPUT: [[f64; 3]; 3] =
    [[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]];

fn aces(rgb: [f64; 3]) -> [f64; 3] {
    let curve = |x: f64| (x * (x + 0.0245786) - 0.000090537) / (x * (0.983729 * x + 0.4329510) + 0.238081);
    times(&ACES_OUTPUT, times(&ACES_INPUT, rgb).map(curve))
}

const REC2020_FROM_REC709: [[f64; 3]; 3] =
    [[0.6274, 0.3293, 0.0433], [0.0691, 0.9195, 0.0113], [0.0164, 0.0880, 0.8956]];
const REC709_FROM_REC2020: [[f64; 3]; 3] =
    [[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]];
/// Moves primaries inward and rotates them.
const AGX_INSET: [[f64; 3]; 3] = [
    [0.856_627_153_315_983, 0.095_121_240_538_158_8, 0.048_251_606_145_858_3],
    [0.137_318_972_929_847, 0.761_241_990_602_591, 0.101_439_036_467_562],
    [0.111_898_212_999_95, 0.076_799_418_603_190_3, 0.811_302_368_396_859],
];
/// Moves them outward again, without the rotation.
const AGX_OUTSET: [[f64; 3]; 3] = [
    [1.127_100_581_814_436_8, -0.110_606_643_096_603_23, -0.016_493_938_717_834_573],
    [-0.141_329_763_498_438_3, 1.157_823_702_216_272, -0.016_493_938_717_834_257],
    [-0.141_329_763_498_438_26, -0.110_606_643_096_602_94, 1.251_936_406_595_040_5],
];
/// The range of the curve, in powers of two.
const AGX_RANGE: [f64; 2] = [-12.47393, 4.026069];

fn agx(rgb: [f64; 3]) -> [f64; 3] {
    let [least, most] = AGX_RANGE;
    let inset = times(&AGX_INSET, times(&REC2020_FROM_REC709, rgb));
    let curved = inset.map(|x| {
        let x = ((libm::log2(x.max(1e-10)) - least) / (most - least)).clamp(0.0, 1.0);
        let polynomial = [-0.00232, 0.1191, 0.4298, -6.868, 31.96, -40.14, 15.5];
        polynomial.into_iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient)
    });
    times(&REC709_FROM_REC2020, times(&AGX_OUTSET, curved).map(|x| libm::pow(x.max(0.0), 2.2)))
}

fn times(rows: &[[f64; 3]; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    rows.map(|[a, b, c]| a * x + b * y + c * z)
}
